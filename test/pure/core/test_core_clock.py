"""Two clocks, wire times, and steps of the box's own clock."""

import pytest

from roah_rsbb.core.watches import ClockWatch
from roah_rsbb.model.clock import MAX_READINGS, Now, one_moment
from roah_rsbb.protocol import wire_ns, wire_seconds
from roah_rsbb.wording import times

MIN, MAX = -(2**63), 2**63 - 1


def test_time_passes_on_both_clocks():
    assert Now(1.0, 100.0).later(2.5) == Now(3.5, 102.5)


@pytest.mark.parametrize("wire_time, ns", [
    ((1, 2), 1_000_000_002),
    ((0, -1), -1),
    ((-1, 0), -1_000_000_000),
    ((5, 3_000_000_000), 8_000_000_000),
    ((2**32, 0), 2**32 * 10**9),
    ((MAX, MAX), MAX * 10**9 + MAX),
    ((MIN, MIN), MIN * 10**9 + MIN),
])
def test_wire_times_of_any_size_are_exact(wire_time, ns):
    assert wire_ns(wire_time) == ns
    assert wire_seconds(wire_time) == pytest.approx(ns / 1e9)


def test_a_time_for_the_referee():
    assert times.time_with_zone(1_800_000_000.9) == "08:00:00Z"


class PausedClocks:
    """Both clocks of a process that pauses each time it has read UTC."""

    def __init__(self, pauses):
        self.mono, self.pauses = 10.0, list(pauses)

    def read_utc(self):
        utc = 1000.0 + self.mono
        self.mono += self.pauses.pop(0)
        return utc


def test_a_pause_between_both_readings_is_no_step_of_the_clock():
    clocks = PausedClocks([0.3, 0.2, 0.0])
    assert one_moment(lambda: clocks.mono, clocks.read_utc) == Now(10.5, 1010.5)


def test_a_machine_that_always_pauses_gets_its_last_reading():
    clocks = PausedClocks([0.3] * MAX_READINGS)
    now = one_moment(lambda: clocks.mono, clocks.read_utc)
    assert (now.mono, clocks.pauses) == (clocks.mono, [])


def test_a_step_of_the_clock_is_reported_once_and_with_its_sign():
    watch = ClockWatch()
    assert watch.look(Now(10.0, 1000.0)) == 0.0
    assert watch.look(Now(20.0, 1010.0)) == 0.0
    assert watch.look(Now(21.0, 1014.0)) == pytest.approx(3.0)
    assert watch.look(Now(22.0, 1015.0)) == 0.0
    assert watch.look(Now(23.0, 916.0)) == pytest.approx(-100.0)
    assert watch.look(Now(24.0, 917.0)) == 0.0


def test_slewing_by_ntp_is_not_a_step():
    watch = ClockWatch()
    assert {watch.look(Now(i / 10, 1000 + i / 10 * 1.0005)) for i in range(36_000)} == {0.0}
