"""The box as referees and the public see it."""

import pytest

from helpers.box_driver import BoxDriver
from helpers.commands import COMMANDS
from helpers.competition import UTC0, competition, event
from roah_rsbb.core.views import document
from roah_rsbb.model.document import RobotSeen
from roah_rsbb.model.zone import LATELY_S, RunClock
from roah_rsbb.protocol import RobotState


def test_a_zone_without_a_robot():
    driver = BoxDriver(competition(tbm=[event(timeout=60.0)]))
    view = driver.view()
    assert (view.zone, view.phase, view.timer, view.items, view.log) == ("tbm", "idle", 60.0, (), "")
    assert (view.identity, view.end_reason, view.robot, view.all_robots) == ("", "", None, None)
    assert view.state == "No robot of team Alpha is active: none of its beacons arrives on UDP port 6666"


def test_the_state_text_of_a_run_from_beginning_to_end():
    driver = BoxDriver(competition(tbm=[event(timeout=60.0)]))
    states, phases = [], []

    def note():
        states.append(driver.view().state)
        phases.append(driver.view().phase)

    robot = driver.robot()
    robot.beacon()
    note()
    driver.command("connect")
    note()
    robot.port = driver.run_in().port
    robot.says()
    note()
    driver.command("start")
    note()
    robot.executes()
    note()
    driver.command("stop")
    note()
    robot.says(RobotState.STOP)
    note()
    driver.command("start")
    robot.executes()
    robot.completes()
    note()
    assert states == [
        "Robot ready to accept connection: r1 of team Alpha",
        "Robot has not answered on the private channel yet",
        "All OK for start",
        "Robot preparing for the task\nMessages saved: 1",
        "Robot prepared, executing (no explicit goal)\nMessages saved: 1",
        "Benchmark stopped by the referee\nMessages saved: 1",
        "Benchmark stopped by the referee\nCan be restarted. The clock kept running\nMessages saved: 1",
        "Benchmark completed by the robot\nCan be restarted. The clock kept running\nMessages saved: 1",
    ]
    assert phases == ["idle", "connected", "connected", "running", "running", "ended", "ended", "ended"]


def test_the_state_text_after_a_timeout():
    driver = BoxDriver(competition(tbm=[event(timeout=10.0)]))
    robot = driver.executing()
    robot.lives(10)
    assert driver.view().state == "Stopped due to timeout\nMessages saved: 1"


def test_a_view_says_why_each_button_is_off():
    driver = BoxDriver()
    driver.connected()
    view = driver.view()
    assert {command: list(view.off(command)) for command in COMMANDS} == {
        command: driver.off(command) for command in COMMANDS
    }


def test_the_timer_counts_down():
    driver = BoxDriver(competition(tbm=[event(timeout=60.0)]))
    robot = driver.connected()
    driver.command("start")
    robot.lives(10)
    assert driver.view().timer == pytest.approx(50.0, abs=0.1)


def test_active_robots_with_their_skew():
    driver = BoxDriver()
    driver.robot("Beta", "b", skew=-0.25).beacon()
    driver.robot("Alpha", "a", skew=0.5).beacon()
    seen = document.robots(driver.box, driver.now)
    assert list(seen.values()) == [RobotSeen("Alpha", "a", 0.5), RobotSeen("Beta", "b", -0.25)]
    heard = driver.now
    driver.run(LATELY_S)
    again = document.robots(driver.box, driver.now, seen)
    assert all(again[name] is robot for name, robot in seen.items())
    driver.run(0.1)
    assert {robot.silent_since for robot in document.robots(driver.box, driver.now, seen).values()} == {heard.mono}


def test_a_skew_between_two_steps_stays_at_the_one_before():
    shown, steps = None, []
    for seconds in (0.0, 0.006, 0.004, 0.009, 0.0101, 0.006, 0.0001, -0.001, -0.02):
        shown = document.stepped(seconds, shown)
        steps.append(shown)
    assert steps == [0.0, 0.0, 0.0, 0.0, 0.01, 0.01, 0.01, 0.0, -0.02]


def test_the_schedule_shows_what_runs_and_what_comes_by_time():
    driver = BoxDriver(competition(
        a=[event("HWV", run=1, scheduled=UTC0), event("HWV", run=3, scheduled=UTC0 + 200)],
        b=[event("HCFGAC", team="Beta", run=2, scheduled=UTC0 + 100)],
    ))
    driver.connected("a")

    def shown():
        return [(line.event.run, line.running) for line in document.coming_events(driver.box)]

    assert shown() == [(1, True), (2, False), (3, False)]
    driver.command("disconnect", "a")
    driver.command("next", "a")
    assert shown() == [(2, False), (3, False)]


def test_the_log_shows_times_levels_and_what_happened():
    driver = BoxDriver()
    robot = driver.executing()
    robot.says(switch_1=True)
    driver.score("Penalized", "bumps", 2)
    lines = driver.view().log.splitlines()
    assert all(line[8] == "Z" and line[2] == ":" for line in lines)
    texts = [line[10:] for line in lines]
    assert texts == [
        "STOP: Connected: waiting for the robot's first message",
        "PREPARE: Robot preparing for the task",
        "WAITING_RESULT: Robot prepared, executing (no explicit goal)",
        "WARNING: Robot commands devices or tablet, which HGTKMH does not use: ignored",
        "Score: Penalized: bumps 0 -> 2",
    ]


def test_the_final_time_of_a_run_is_the_recorded_one():
    driver = BoxDriver(competition(tbm=[event(timeout=60.0)]))
    assert driver.view().shown.clock == RunClock(60.0)
    driver.executing()
    driver.run(12.5)
    during = driver.view().clock
    assert during.counting
    driver.command("stop")
    driver.run(5.0)
    clock = driver.view().clock
    assert (clock.elapsed, clock.counting) == (pytest.approx(during.elapsed), False)
    assert clock.elapsed == driver.run_in().record(driver.now).elapsed_s
    assert clock.after_stop == pytest.approx(driver.view().timer)


def test_time_that_passes_alone_changes_no_clock():
    driver = BoxDriver(competition(tbm=[event(timeout=60.0)]))
    driver.executing()
    before = driver.view()
    driver.run(1.0)
    after = driver.view()
    assert after.clock.elapsed == pytest.approx(before.clock.elapsed + 1.0)
    assert after.shown.clock == before.shown.clock
