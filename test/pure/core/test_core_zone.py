"""A zone's way through its schedule."""

from types import SimpleNamespace

import pytest

from helpers.competition import competition
from roah_rsbb.core.zones import Zone
from roah_rsbb.model.records import EndReason


def _zone(*codes):
    return Zone(competition(tbm=codes).zones[0])


def test_a_zone_begins_at_its_first_event():
    zone = _zone("HGTKMH", "HWV", "HCFGAC")
    assert (zone.event.benchmark.code, zone.at_first, zone.at_last) == ("HGTKMH", True, False)
    zone.move(1)
    assert (zone.event.benchmark.code, zone.at_first, zone.at_last) == ("HWV", False, False)
    zone.move(1)
    assert (zone.event.benchmark.code, zone.at_first, zone.at_last) == ("HCFGAC", False, True)
    zone.move(-1)
    assert zone.event.benchmark.code == "HWV"


def test_a_zone_with_one_event_is_at_both_ends():
    zone = _zone("HWV")
    assert zone.at_first and zone.at_last


@pytest.mark.parametrize("auto_next", [True, False])
@pytest.mark.parametrize("reason", [None, *EndReason])
def test_only_a_run_that_ran_to_its_end_moves_the_zone_on(auto_next, reason):
    zone = _zone("HGTKMH", "HWV")
    text = "12:00:00Z STOP\n"
    zone.run = SimpleNamespace(end_reason=reason, log=text, online_data=text)
    zone.leave(auto_next)
    moved = auto_next and reason in (
        EndReason.COMPLETED, EndReason.GOALS_TIMED_OUT, EndReason.NO_SHOW, EndReason.WITHDRAWN)
    assert (zone.index, zone.run) == (int(moved), None)
    # The log of the last run stays to be read, until the zone shows another event.
    assert zone.last_run == (None if moved else (reason, text, text))


def test_the_last_event_has_no_next_event():
    zone = _zone("HGTKMH")
    text = ""
    zone.run = SimpleNamespace(end_reason=EndReason.COMPLETED, log=text, online_data=text)
    zone.leave(auto_next=True)
    assert (zone.index, zone.run) == (0, None)
