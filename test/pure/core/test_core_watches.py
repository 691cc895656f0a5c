"""Warnings for every referee."""

import pytest

from helpers.box_driver import wire
from roah_rsbb.core.robots import ActiveRobot, RobotId, Squatter
from roah_rsbb.core.watches import (
    CLOCK_REMEMBER_S,
    MAX_KEPT,
    NOTICE_REMEMBER_S,
    REMEMBER_S,
    TROUBLE_REMEMBER_S,
    Watches,
)
from roah_rsbb.model.clock import Now


@pytest.fixture
def watches():
    watches = Watches(listen_duration=5.0)
    watches.start(at(0))
    return watches


def at(mono):
    return Now(float(mono), 1e9 + mono)


def test_the_box_listens_for_a_while_from_its_first_moment_on():
    watches = Watches(listen_duration=5.0)
    assert watches.listening_left(at(100)) == 5.0
    watches.start(at(100))
    watches.start(at(102))
    assert [watches.listening_left(at(t)) for t in (100, 102, 105, 200)] == [5.0, 3.0, 0.0, 0.0]


def rivals(team, name, now):
    """A robot whose name another host uses, too."""
    robot = ActiveRobot(RobotId(team, name), "h1", now, 0.1)
    robot.hear(now, "h1", wire(now.utc), certain=False)
    robot.hear(now, "h2", wire(now.utc + 3600), certain=False)
    return robot


CASES = [
    (lambda w, now: w.foreign_box(now, "10.0.0.9"), "ANOTHER RSBB is transmitting from 10.0.0.9", REMEMBER_S),
    (lambda w, now: w.rivals(now, rivals("A", "r", now)),
     "Two robots call themselves r of team A: h1 and h2. Connect and start use the one that knows the password. Give "
     "the other one another robot_name, or take it off the network. Their clocks differ: +0.000 s and +3.6e+03 s",
     REMEMBER_S),
    (lambda w, now: w.squatter(now, Squatter("10.0.0.9", "A", 25)), "10.0.0.9 announces at least 25 robots",
     REMEMBER_S),
    (lambda w, now: w.squatter(now, Squatter("10.0.0.9", "A", 1)), "Many addresses, such as 10.0.0.9", REMEMBER_S),
    (lambda w, now: w.not_listed(now, "10.0.0.9"), "Beacons from 10.0.0.9 are ignored", REMEMBER_S),
    (lambda w, now: w.trouble(now, "disk full"), "disk full", TROUBLE_REMEMBER_S),
    (lambda w, now: w.notice(now, "journal not continued"), "journal not continued", NOTICE_REMEMBER_S),
]


@pytest.mark.parametrize("note, text, remembered", CASES)
def test_a_warning_is_new_once_and_stays_a_while_after_its_last_cause(watches, note, text, remembered):
    first = note(watches, at(10))
    assert text in first
    assert note(watches, at(10 + remembered / 2)) is None
    assert watches.warnings(at(10 + 1.5 * remembered)) == [first]
    assert watches.warnings(at(10 + 1.5 * remembered + 0.1)) == []
    assert note(watches, at(10 + 2 * remembered)) == first


def test_a_step_of_the_clock_is_reported_each_time(watches):
    assert "set by +3.000 s" in watches.clock_stepped(at(10), 3.0)
    second = watches.clock_stepped(at(11), -0.5)
    assert watches.warnings(at(11 + CLOCK_REMEMBER_S)) == [second]
    assert watches.warnings(at(12 + CLOCK_REMEMBER_S)) == []


def test_the_last_complaint_stays_a_while(watches):
    watches.complaint(at(1), "bad frame from x")
    watches.complaint(at(2), "bad frame from y")
    assert watches.warnings(at(2 + REMEMBER_S)) == ["bad frame from y"]
    assert watches.warnings(at(3 + REMEMBER_S)) == []


@pytest.mark.parametrize("flood", [
    lambda w, i: w.rivals(at(10), rivals("A", f"r{i}", at(10))),
    lambda w, i: w.foreign_box(at(10), f"10.0.{i // 256}.{i % 256}"),
    lambda w, i: w.trouble(at(10), f"trouble {i}"),
])
def test_a_flood_of_one_kind_is_bounded_hides_no_other_kind_and_passes(watches, flood):
    reported = [flood(watches, i) for i in range(1000)]
    assert sum(text is not None for text in reported) == MAX_KEPT
    assert len(watches.warnings(at(10))) == MAX_KEPT
    others = [note for note, _, _ in CASES if note(watches, at(10)) is not None]
    assert len(others) >= len(CASES) - 1
    assert flood(watches, 5000) is None
    later = at(11 + TROUBLE_REMEMBER_S)
    assert watches.trouble(later, "something new") == "something new"
    assert watches.warnings(later) == ["something new"]
