"""Warnings for every referee; and the public channel: other boxes, robots, floods, unreadable datagrams."""

import pytest

from helpers.box_driver import BoxDriver, wire
from helpers.competition import competition
from roah_rsbb.core import effects
from roah_rsbb.core.effects import AnotherBox, Level, Outbox
from roah_rsbb.core.robots import MAX_NAME, MAX_STRANGERS, ActiveRobot, RobotId, Squatter
from roah_rsbb.core.runs.reported import StringsBudget
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.views import document
from roah_rsbb.core.watches import (
    CLOCK_REMEMBER_S,
    MAX_KEPT,
    NOTICE_REMEMBER_S,
    REMEMBER_S,
    TROUBLE_REMEMBER_S,
    Watches,
)
from roah_rsbb.model import run_log
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import RobotSeen
from roah_rsbb.protocol import RobotState


class Logged(Watches):
    """Warnings, and what is logged of them."""

    def __init__(self):
        self._lines = Outbox()
        super().__init__(5.0, self._lines)

    def new(self, note, now):
        """The line after something was noted; None: it is not new."""
        note(self, now)
        return next((line.text for line in self._lines.take()), None)


@pytest.fixture
def watches():
    return Logged()


def at(mono):
    return Now(float(mono), 1e9 + mono)


def test_the_box_listens_for_a_while_from_its_first_moment_on():
    watches = Logged()
    assert watches.listening_left(at(100)) == 5.0
    watches.start(at(100))
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
    first = watches.new(note, at(10))
    assert text in first
    assert watches.new(note, at(10 + remembered / 2)) is None
    assert watches.warnings(at(10 + 1.5 * remembered)) == [first]
    assert watches.warnings(at(10 + 1.5 * remembered + 0.1)) == []
    assert watches.new(note, at(10 + 2 * remembered)) == first


def test_a_step_of_the_clock_is_reported_each_time(watches):
    assert "set by +3.000 s" in watches.new(lambda w, now: w.clock_stepped(now, 3.0), at(10))
    second = watches.new(lambda w, now: w.clock_stepped(now, -0.5), at(11))
    assert watches.warnings(at(11 + CLOCK_REMEMBER_S)) == [second]
    assert watches.warnings(at(12 + CLOCK_REMEMBER_S)) == []


def test_the_last_complaint_stays_a_while(watches):
    watches.complaint(at(1), "bad frame from x")
    watches.complaint(at(2), "bad frame from y")
    assert watches.warnings(at(2 + REMEMBER_S)) == ["bad frame from y"]
    assert watches.warnings(at(3 + REMEMBER_S)) == []


@pytest.mark.parametrize("flood", [
    lambda i: lambda w, now: w.rivals(now, rivals("A", f"r{i}", now)),
    lambda i: lambda w, now: w.foreign_box(now, f"10.0.{i // 256}.{i % 256}"),
    lambda i: lambda w, now: w.trouble(now, f"trouble {i}"),
])
def test_a_flood_of_one_kind_is_bounded_hides_no_other_kind_and_passes(watches, flood):
    reported = [watches.new(flood(i), at(10)) for i in range(1000)]
    assert sum(text is not None for text in reported) == MAX_KEPT
    assert len(watches.warnings(at(10))) == MAX_KEPT
    others = [note for note, _, _ in CASES if watches.new(note, at(10)) is not None]
    assert len(others) >= len(CASES) - 1
    assert watches.new(flood(5000), at(10)) is None
    later = at(11 + TROUBLE_REMEMBER_S)
    assert watches.new(lambda w, now: w.trouble(now, "something new"), later) == "something new"
    assert watches.warnings(later) == ["something new"]


def hears_another(driver, seconds=1, host="10.0.0.99"):
    """Another box, or somebody who forges its beacons, is heard each second."""
    for _ in range(seconds):
        driver.event(driver.box.arrivals.on_foreign_box, host)
        driver.run(1)


HELD = ("ANOTHER RSBB was heard at 10.0.0.99, so this box sends nothing until you press connect. Stop the other box "
        "first, or take that computer off the network if it is none of yours")


@pytest.mark.parametrize("after", [0.0, 2.5, 4.999])
def test_a_box_that_hears_another_one_at_first_names_it_and_waits_for_a_referee(after):
    driver = BoxDriver(listening=True)
    driver.run(after)
    driver.taken()
    hears_another(driver, 10)
    taken = driver.taken()
    assert [effect.text for effect in taken if isinstance(effect, effects.Notice)] == [HELD]
    assert {effect.host for effect in taken if isinstance(effect, AnotherBox)} == {"10.0.0.99"}
    assert driver.box.watches.held_by
    assert document.box_status(driver.box, driver.now) == HELD
    driver.run(1000)
    assert driver.box.watches.held_by, "a pause of the network must not make two boxes transmit"
    assert document.box_status(driver.box, driver.now) == HELD


def test_a_forged_beacon_of_a_box_prevents_no_run():
    driver = BoxDriver(competition(tbm=["HGTKMH", "HGTKMH"]), listening=True)
    hears_another(driver, 6)
    robot = driver.robot()
    robot.beacon()
    assert driver.off("connect") == []
    driver.command("connect")
    assert not driver.box.watches.held_by
    robot.port = driver.run_in().port
    hears_another(driver, 2)
    assert not driver.box.watches.held_by
    assert document.box_status(driver.box, driver.now) == (
        "ANOTHER RSBB is transmitting from 10.0.0.99, and robots obey both: stop it, or take that computer off the "
        "network")
    robot.says(RobotState.STOP)
    driver.command("start")
    robot.executes()
    robot.completes()


def test_the_address_of_the_latest_box_is_shown():
    driver = BoxDriver(listening=True)
    hears_another(driver)
    hears_another(driver, host="10.0.0.98")
    assert "heard at 10.0.0.98" in document.box_status(driver.box, driver.now)
    assert len(driver.notices(Level.ERROR)) == 2


@pytest.mark.parametrize("after", [5.0, 1000.0])
def test_a_box_that_hears_another_one_later_warns_every_referee_and_continues(after):
    driver = BoxDriver(competition(a=["HWV"], b=["HGTKMH"]), listening=True)
    driver.run(after)
    robot = driver.executing("a")
    driver.taken()
    for _ in range(5):
        driver.event(driver.box.arrivals.on_foreign_box, "10.0.0.99")
        driver.run(1)
    taken = driver.taken(AnotherBox, effects.Notice)
    assert not any(isinstance(effect, AnotherBox) for effect in taken)
    errors = [e for e in taken if isinstance(e, effects.Notice) and e.level is Level.ERROR]
    assert [(e.text, e.zone) for e in errors] == [
        ("ANOTHER RSBB is transmitting from 10.0.0.99, and robots obey both: stop it, or take that computer off the "
         "network", "")
    ]
    assert "ANOTHER RSBB" in document.box_status(driver.box, driver.now)
    robot.completes()
    driver.run(20)
    assert document.box_status(driver.box, driver.now) == "OK"


def test_a_box_with_take_over_starts_beside_another_one():
    driver = BoxDriver(settings=Settings(take_over=True), listening=True)
    for _ in range(10):
        driver.event(driver.box.arrivals.on_foreign_box, "10.0.0.99")
        driver.run(1)
    assert driver.taken(AnotherBox) == []
    assert not driver.box.watches.held_by
    driver.robot().beacon()
    assert driver.off("connect") == []
    assert "ANOTHER RSBB is transmitting from 10.0.0.99" in document.box_status(driver.box, driver.now)


def test_a_host_with_too_many_robots_is_reported_and_another_teams_robot_is_connected():
    driver = BoxDriver()
    driver.taken()
    for i in range(250):
        driver.event(driver.box.arrivals.on_robot_beacon, "10.0.0.66", "Beta", f"ghost {i}", (0, 0))
        driver.run(0.04)
    assert any("10.0.0.66 announces at least 25 robots, the last of team Beta" in text
               for text in driver.notices(Level.WARNING))
    driver.robot().beacon()
    assert driver.off("connect") == []


def test_a_robot_that_the_box_cannot_reach_is_not_connected():
    driver = BoxDriver()
    robot = driver.robot()

    def beacon(host, has_route):
        driver.event(driver.box.arrivals.on_robot_beacon, host, robot.team, robot.name, robot.time(), None, has_route)

    beacon("10.2.0.7", False)
    (why,) = driver.off("connect")
    assert why.startswith("The box cannot reach robot r1 of team Alpha at 10.2.0.7: it has no route to this network")
    beacon(robot.host, True)
    assert driver.off("connect") == [], "a beacon may have a forged address: that takes no other address away"
    driver.run(1)
    beacon("10.2.0.7", False)
    assert driver.off("connect") == []


def test_the_status_says_that_the_box_listens():
    driver = BoxDriver(listening=True)
    assert document.box_status(driver.box, driver.now) == "Listening for another box before transmitting: 5 s"
    driver.run(5)
    assert document.box_status(driver.box, driver.now) == "OK"


def test_a_robot_is_reported_when_it_appears():
    driver = BoxDriver()
    driver.taken()
    driver.robot().beacon(5)
    assert driver.notices() == ["Robot r1 of team Alpha is active at 10.0.0.2"]
    assert document.robots(driver.box, driver.now) == {"r1 of team Alpha": RobotSeen("Alpha", "r1", 0.0)}


def test_two_hosts_with_one_name_are_reported_to_every_referee():
    driver = BoxDriver()
    one, two = driver.robot(host="10.0.0.2"), driver.robot(host="10.0.0.3", skew=5.0)
    one.beacon()
    driver.taken()
    for _ in range(5):
        driver.run(1)
        one.beacon()
        two.beacon()
    text = ("Two robots call themselves r1 of team Alpha: 10.0.0.2 and 10.0.0.3. Connect and start use the one that "
            "knows the password. Give the other one another robot_name, or take it off the network. Their clocks "
            "differ: +0.000 s and +5.000 s")
    assert driver.notices(Level.WARNING) == [text]
    assert text in document.box_status(driver.box, driver.now)
    assert driver.off("connect") == []  # the first one's clock is right
    driver.command("connect")
    assert driver.channels == {6667: "10.0.0.2"}


def test_a_robot_with_a_new_address_in_its_run_is_not_reported_as_two():
    driver = BoxDriver()
    robot = driver.executing()
    robot.host = "10.0.0.77"
    robot.says()
    assert driver.channels == {robot.port: "10.0.0.2"}  # it may be another one of the team
    robot.lives(3)
    assert driver.channels == {robot.port: "10.0.0.77"}
    driver.command("disconnect")
    robot.beacon()
    assert document.box_status(driver.box, driver.now) == "OK"
    driver.command("connect")
    assert driver.channels == {robot.port + 1: "10.0.0.77"}


@pytest.mark.parametrize("both_s", [0, 2])
def test_a_robot_that_is_restarted_at_another_address_in_its_run_is_not_to_be_taken_off_the_network(both_s):
    driver = BoxDriver()
    old = driver.executing()
    new = driver.robot(host="10.0.0.33")
    new.port = old.port
    for _ in range(both_s):
        old.says(after=1.0)
        new.beacon()
    seen = []
    for _ in range(5):
        driver.run(0.9)
        new.beacon()
        seen.append("Two robots" in document.box_status(driver.box, driver.now))
    new.says()
    assert driver.channels == {new.port: "10.0.0.33"}
    assert (seen[0], any(seen[4:])) == (both_s > 0, False)
    assert "Two robots" not in document.box_status(driver.box, driver.now)


def test_a_recording_of_an_earlier_run_is_refused_before_the_robot_says_a_word():
    driver = BoxDriver(competition(tbm=["HWV", "HWV"]))
    robot = driver.executing()
    robot.says(notifications=("of the first run",))
    recorded = [robot.last]
    driver.command("disconnect")
    robot.beacon()
    driver.command("connect")
    robot.port = driver.run_in().port
    for report in recorded * 5:
        driver.run(0.1)
        robot.send(report)
    assert driver.run_in().robot_state is None
    assert driver.logged(robot.port, "/notification") == []
    robot.says(RobotState.STOP)
    assert driver.run_in().robot_state is RobotState.STOP
    driver.command("start")


def test_a_flood_of_robots_is_bounded_and_the_run_continues():
    driver = BoxDriver(competition(a=["HWV"], b=["HGTKMH"]))
    robot = driver.executing("a")
    driver.taken()
    for i in range(1000):
        driver.event(driver.box.arrivals.on_robot_beacon, f"10.1.{i // 250}.{i % 250}", f"Team {i}", "x", (2**62, -i))
        if i % 100 == 0:
            robot.says()
    assert len(document.robots(driver.box, driver.now)) == 1 + MAX_STRANGERS
    assert sum("announce robots" in text for text in driver.notices(Level.WARNING)) == 1
    late = driver.robot(name="r2", host="10.0.0.3")
    late.beacon()
    assert driver.off("connect", "b") == []
    robot.completes()
    driver.run(60)
    assert len(document.robots(driver.box, driver.now)) == 0


@pytest.mark.parametrize("team, name, is_listed", [
    ("", "", False), ("", "r", False), ("Alpha", "", False), ("x" * (MAX_NAME + 1), "r", False),
    ("Alpha", "x" * (MAX_NAME + 1), False), ("Alpha", "x" * MAX_NAME, True),
])
def test_names_that_no_robot_has_are_reported_and_not_listed(team, name, is_listed):
    driver = BoxDriver()
    driver.taken()
    driver.event(driver.box.arrivals.on_robot_beacon, "10.0.0.5", team, name, (0, 0))
    ignored = ["Beacons from 10.0.0.5 are ignored: too many robots, or the name is empty or too long"]
    assert (driver.notices() == ignored, bool(document.robots(driver.box, driver.now))) == (not is_listed, is_listed)


def test_complaints_of_the_public_channel_are_shown_for_a_while():
    driver = BoxDriver()
    driver.event(driver.box.arrivals.on_complaint, "10.0.0.9 sends frames of version 1")
    assert driver.notices(Level.WARNING)[-1] == "10.0.0.9 sends frames of version 1"
    assert document.box_status(driver.box, driver.now) == "10.0.0.9 sends frames of version 1"
    driver.run(11)
    assert document.box_status(driver.box, driver.now) == "OK"


def test_trouble_of_this_computer_is_reported_once():
    driver = BoxDriver()
    driver.taken()
    for _ in range(3):
        driver.event(driver.box.watches.trouble, "the disk is full: free it")
    assert driver.notices(Level.ERROR) == ["the disk is full: free it"]
    assert document.box_status(driver.box, driver.now) == "the disk is full: free it"
    driver.event(driver.box.watches.trouble, "another trouble")
    driver.event(driver.box.watches.repaired, "the disk is full: free it", "all is written")
    assert driver.notices(Level.INFO)[-1] == "all is written"
    assert driver.box.watches.warnings(driver.now) == ["another trouble"]


def test_a_copy_of_what_the_robot_said_changes_nothing_and_is_reported_if_it_comes_from_elsewhere():
    driver = BoxDriver()
    robot = driver.executing()
    driver.run(5)
    driver.taken()
    for _ in range(5):
        driver.run(0.1)
        driver.event(driver.box.arrivals.on_robot_copy, robot.port, "10.0.0.66")
        driver.event(driver.box.arrivals.on_robot_copy, robot.port, robot.host)
    driver.event(driver.box.arrivals.on_robot_copy, 9999, "10.0.0.66")
    reported, = driver.notices(Level.WARNING)
    assert reported.startswith("Messages for this run also come from 10.0.0.66")
    assert driver.run_in().link.sample(driver.now, 0).duplicates == 10


def test_a_robot_whose_messages_are_not_read_is_reported():
    driver = BoxDriver()
    robot = driver.executing()
    driver.taken()
    for _ in range(9):
        driver.event(driver.box.arrivals.on_robot_overload, robot.port, 100)
        driver.run(1)
    first, = (text for text in driver.notices(Level.WARNING) if "sends too much" in text)
    assert first.startswith("Robot sends too much: 0 new strings were not logged, 100 messages were not read")


@pytest.mark.long
def test_a_robot_that_always_says_something_new_is_logged_as_far_as_its_budget_goes():
    driver = BoxDriver(competition(a=["HWV"], b=["HGTKMH"]))
    robot = driver.executing("a")
    driver.taken()
    for i in range(100):
        robot.says(after=0.002, notifications=[f"{i} {j}" for j in range(300)])
    logged = [value for topic, value in driver.bags[robot.port] if topic == run_log.NOTIFICATION]
    assert logged[:300] == [f"0 {j}" for j in range(300)]
    assert len(logged) == pytest.approx(StringsBudget.STRINGS_AT_ONCE + 0.2 * StringsBudget.STRINGS_PER_SECOND, abs=2)
    reported, = (text for text in driver.notices(Level.WARNING) if "sends too much" in text)
    assert reported.startswith("Robot sends too much: 100 new strings were not logged")
    driver.run(2)
    robot.says(notifications=["at last"])
    assert driver.bags[robot.port][-1] != logged[-1]
    assert "at last" in [value for topic, value in driver.bags[robot.port] if topic == run_log.NOTIFICATION]


def test_long_texts_use_up_the_budget_too():
    driver = BoxDriver(competition(a=["HWV"]))
    robot = driver.executing("a")
    for i in range(100):
        robot.says(after=0.002, notifications=[f"{i}" + "x" * 1000])
    logged = [value for topic, value in driver.bags[robot.port] if topic == run_log.NOTIFICATION]
    assert 40 <= len(logged) <= 60
