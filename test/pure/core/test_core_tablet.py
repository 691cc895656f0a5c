"""The tablet: which of its beacons are new, which host it is, and the referee's warnings."""

import itertools

import pytest

from helpers.box_driver import BoxDriver, wire
from helpers.competition import competition
from roah_rsbb.core.effects import Level, SendBeacon
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.tablet import (
    CHANGES_AT_ONCE,
    CHANGES_PER_S,
    LAST_SECOND,
    MAX_DISTANCE_M,
    MEANT_S,
    REMEMBER_SILENT_S,
    SILENT_S,
)
from roah_rsbb.core.views import document
from roah_rsbb.model.messages import NEVER, TabletState

HOST, OTHER = "10.0.0.3", "10.0.0.4"
CALL, PLACE, EARLIER, LATER = (100, 0), (200, 0), (50, 0), (300, 0)


def said(call=NEVER, place=NEVER, x=0.0, y=0.0):
    return TabletState(False, call, place, x, y)


class Driven(BoxDriver):
    """A box that hears tablets."""

    def hear(self, beacon, host=HOST, after=0.0):
        if after:
            self.run(after)
        self.event(self.box.arrivals.on_tablet, host, beacon)

    @property
    def shown(self):
        return self.box.beacon().tablet


@pytest.fixture
def box():
    driver = Driven()
    driver.hear(said(CALL, PLACE, 1.0, 2.0))
    driver.taken()
    return driver


def test_news_leave_at_once_and_what_is_repeated_does_not(box):
    box.hear(said(LATER, PLACE, 1.0, 2.0), after=0.01)
    assert box.shown == said(LATER, PLACE, 1.0, 2.0)
    assert box.taken(SendBeacon) == [SendBeacon()]
    box.hear(said(LATER, PLACE, 1.0, 2.0), after=1.0)
    assert box.taken(SendBeacon) == []


@pytest.mark.parametrize("overtaken", [
    said(EARLIER, PLACE, 1.0, 2.0), said(CALL, EARLIER, 8.0, 9.0), said(EARLIER, EARLIER, 8.0, 9.0),
    said((99, 999_999_999), PLACE, 1.0, 2.0),
])
def test_an_overtaken_datagram_undoes_nothing_however_often_it_is_doubled(box, overtaken):
    for _ in range(5):
        box.hear(overtaken, after=0.05)
    assert box.shown == said(CALL, PLACE, 1.0, 2.0)
    assert box.taken(SendBeacon) == []
    for _ in range(5):  # one now and then, between true ones
        box.hear(said(CALL, PLACE, 1.0, 2.0), after=MEANT_S)
        box.hear(overtaken, after=MEANT_S)
    assert box.shown == said(CALL, PLACE, 1.0, 2.0)


def test_call_and_position_are_judged_apart(box):
    box.hear(said(EARLIER, LATER, 8.0, 9.0))
    assert box.shown == said(CALL, LATER, 8.0, 9.0)
    box.hear(said((301, 0), EARLIER, 1.0, 2.0))
    assert box.shown == said((301, 0), LATER, 8.0, 9.0)


@pytest.mark.parametrize("order", list(itertools.permutations(range(4))))
def test_whatever_the_order_of_datagrams_the_newest_stays(order):
    driver = Driven()
    beacons = [said((10 + n, n), (20 + n, 0), float(n), -float(n)) for n in range(4)]
    for number in order:
        driver.hear(beacons[number], after=0.01)
    assert driver.shown == beacons[3]
    assert len(driver.taken(SendBeacon)) <= 4


def test_a_clock_that_was_set_back_is_believed_with_the_second_beacon(box):
    box.hear(said(EARLIER, PLACE, 1.0, 2.0), after=1.0)
    assert box.shown.call_time == CALL
    box.hear(said(EARLIER, PLACE, 1.0, 2.0), after=1.0)
    assert box.shown == said(EARLIER, PLACE, 1.0, 2.0)
    box.hear(said(EARLIER, (20, 0), 5.0, 6.0), after=1.0)
    box.hear(said(EARLIER, (20, 0), 5.0, 6.0), after=1.0)
    assert box.shown == said(EARLIER, (20, 0), 5.0, 6.0)


def test_after_silence_a_set_back_clock_is_believed_at_once(box):
    box.hear(said(EARLIER, EARLIER, 5.0, 6.0), after=SILENT_S + 0.1)
    assert box.shown == said(EARLIER, EARLIER, 5.0, 6.0)


def test_a_tablet_that_was_started_again_and_was_never_touched_since_undoes_nothing(box):
    for seconds in (0.5, 1.0, 1.0, 1.0, SILENT_S + 1):
        box.hear(said(), after=seconds)
    assert box.shown == said(CALL, PLACE, 1.0, 2.0)
    assert box.taken(SendBeacon) == []


def test_a_second_tablet_is_reported_and_does_not_count(box):
    for _ in range(3):
        box.hear(said(CALL, PLACE, 1.0, 2.0), after=1.0)
        box.hear(said(LATER, LATER, 8.0, 9.0), OTHER)
    assert box.shown == said(CALL, PLACE, 1.0, 2.0)
    reported = f"Two tablets are on: {HOST} counts, {OTHER} is ignored. Switch off the wrong one"
    assert box.notices(Level.WARNING) == [reported]
    assert reported in document.box_status(box.box, box.now)


def test_another_tablet_takes_over_from_a_silent_one(box):
    box.hear(said(EARLIER, EARLIER, 8.0, 9.0), OTHER, after=SILENT_S + 0.1)
    assert box.shown == said(EARLIER, EARLIER, 8.0, 9.0)
    box.hear(said(LATER, LATER, 1.0, 2.0), HOST)
    assert box.shown == said(EARLIER, EARLIER, 8.0, 9.0)


@pytest.mark.parametrize(("absurd", "reported"), [
    (said((-1, 0)), "set its clock"), (said((LAST_SECOND + 1, 0)), "set its clock"),
    (said((2**63 - 1, -(2**63))), "set its clock"), (said((5, 1_000_000_000)), "set its clock"),
    (said(CALL, (-(2**63), 0)), "set its clock"), (said(CALL, (5, -1)), "set its clock"),
    (said(CALL, LATER, float("nan")), "correct its map"), (said(CALL, LATER, 0.0, float("-inf")), "correct its map"),
    (said(CALL, LATER, 1e300), "correct its map"), (said(CALL, LATER, 0.0, -MAX_DISTANCE_M * 1.01), "correct its map"),
])
def test_absurd_values_are_ignored_whole_and_reported_once(box, absurd, reported):
    heard = box.box.tablet.heard
    for _ in range(3):
        box.hear(absurd, after=1.0)
    assert box.shown == said(CALL, PLACE, 1.0, 2.0)
    assert box.box.tablet.heard == heard
    (notice,) = box.notices(Level.WARNING)
    assert reported in notice and HOST in notice
    assert notice in document.box_status(box.box, box.now)


def test_the_last_time_that_ros_can_hold_is_accepted(box):
    box.hear(said((LAST_SECOND, 999_999_999), (LAST_SECOND, 0), MAX_DISTANCE_M, -MAX_DISTANCE_M))
    assert box.shown.call_time == (LAST_SECOND, 999_999_999)


def test_a_flood_from_many_hosts_causes_few_reports(box):
    for number in range(1000):
        box.hear(said(LATER), f"10.0.1.{number}")
        box.hear(said((-1, 0)), f"10.0.2.{number}")
    assert len(box.notices()) == 2
    assert len(box.box.warnings(box.now)) == 2


def silent(driver):
    return [text for text in driver.box.warnings(driver.now) if "silent" in text]


def test_a_tablet_that_was_never_heard_is_not_missed():
    driver = Driven(competition(tbm=["HCFGAC"]))
    driver.run(1000.0)
    assert driver.box.warnings(driver.now) == []


def test_a_silent_tablet_is_reported_until_it_is_heard(box):
    box.run(SILENT_S)
    assert silent(box) == []
    box.run(1.0)
    assert silent(box) == ["The tablet has been silent for 6 s: check that it is on, connected, and showing its page"]
    assert "The tablet has been silent" in document.box_status(box.box, box.now)
    box.hear(said())
    assert silent(box) == []


@pytest.mark.parametrize(("code", "is_reported"), [("HCFGAC", True), ("HGTKMH", False)])
def test_a_tablet_that_went_long_ago_is_missed_where_it_is_needed(code, is_reported):
    driver = Driven(competition(tbm=[code]))
    driver.hear(said(CALL))
    driver.run(REMEMBER_SILENT_S)
    assert silent(driver)
    driver.run(1.0)
    assert bool(silent(driver)) is is_reported


def test_a_run_begins_with_the_call_button_and_leaves_the_tablet_as_it_was():
    driver = Driven(competition(tbm=["HCFGAC", "HCFGAC", "HWV"]), Settings(auto_next=False))
    robot = driver.connected()
    robot.says(display_map=True)
    assert driver.shown.display_map is True
    for command in ("disconnect", "next"):
        driver.command(command)
        assert driver.shown.display_map is True
    robot = driver.connected()
    assert driver.shown.display_map is False
    robot.says(display_map=True)
    driver.command("disconnect")
    driver.command("next")
    driver.connected()
    assert driver.shown.display_map is True, "no other benchmark touches the tablet"


def test_times_of_the_robots_clock_play_no_part(box):
    """Tablet and box need not agree on the time."""
    box.hear(said(wire(box.now.utc + 1e6)))
    assert box.shown.call_time == wire(box.now.utc + 1e6)


def test_a_flood_of_changes_is_accepted_only_a_few_times_a_second(box):
    for number in range(2000):
        box.hear(said((1000, number), (1000, number), float(number), 0.0), after=0.001)
    changes = len(box.taken(SendBeacon))
    assert CHANGES_AT_ONCE <= changes <= CHANGES_AT_ONCE + 2 * CHANGES_PER_S
    for _ in range(2):  # the tablet repeats its last state each second
        box.hear(said((1000, 1999), (1000, 1999), 1999.0, 0.0), after=1.0)
    assert box.shown == said((1000, 1999), (1000, 1999), 1999.0, 0.0)
