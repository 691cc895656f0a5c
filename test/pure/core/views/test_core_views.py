"""The box as referees and the public see it; the schedule: states and times of the events, the choice of one."""

import pytest

from helpers.box_driver import BoxDriver
from helpers.commands import COMMANDS
from helpers.competition import UTC0, competition, event
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.views import document
from roah_rsbb.core.views.schedule import NO_LIMIT_S, SETUP_S, events_shown, schedule, slot_lengths
from roah_rsbb.model.document import RobotSeen
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.model.zone import LATELY_S, RunClock
from roah_rsbb.protocol import RobotState
from roah_rsbb.rulebook.benchmarks import NO_LIMIT, EventRules, ZonePlan


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
        "Benchmark completed by the robot\nCan be restarted. The clock kept running\n"
        "START would continue the run: its next end would count instead of this one\nMessages saved: 1",
    ]
    assert phases == ["idle", "connected", "connected", "running", "running", "ended", "ended", "ended"]


def test_a_view_says_why_each_button_is_off():
    driver = BoxDriver()
    driver.connected()
    view = driver.view()
    assert {command: list(view.off(command)) for command in COMMANDS} == {
        command: driver.off(command) for command in COMMANDS
    }


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


MINUTE = 60.0
T0 = UTC0 - UTC0 % MINUTE + 10 * MINUTE  # some minutes after the driver's beginning


def day(*minutes, code="HGTKMH", timeout=600.0):
    """Events at so many minutes after T0, in turns of the teams."""
    return [event(code, team, 1, run, T0 + minute * MINUTE, timeout=timeout)
            for run, (minute, team) in enumerate(zip(minutes, ["Alpha", "Beta", "Gamma"] * len(minutes)), 1)]


def lines(driver, zone="tbm"):
    return [line for line in schedule(driver.box, driver.now) if line.zone == zone]


def states(driver, zone="tbm"):
    return [line.state.value for line in lines(driver, zone)]


def minutes(driver, zone="tbm"):
    """Minutes after T0 at which the events begin."""
    return [(line.begins - T0) / MINUTE for line in lines(driver, zone)]


def at(driver, minute):
    """Advance the time to this many minutes after T0."""
    driver.run(T0 + minute * MINUTE - driver.now.utc)


def choose(driver, index, zone="tbm", unsigned=False):
    driver.choose(index, zone, unsigned, "Anna")


def a_run(driver, end=True):
    robot = driver.connected()
    driver.command("start")
    robot.executes()
    if end:
        driver.command("stop")
    return robot


# -- what became of the events ----------------------------------------------------------------------


def test_an_event_from_next_to_done():
    driver = BoxDriver(competition(tbm=day(0, 15, 30)))
    assert states(driver) == ["next", "later", "later"]
    driver.connected()
    assert states(driver) == ["connected", "later", "later"]
    driver.command("disconnect")
    assert states(driver)[0] == "next", "a run that was never started is none"
    a_run(driver, end=False)
    assert states(driver)[0] == "running"
    driver.command("stop")
    assert states(driver)[0] == "ended"
    driver.command("disconnect")
    assert states(driver)[0] == "next", "after a stop the zone stays, for another attempt"
    assert lines(driver)[0].last.end_reason == "stopped"
    driver.command("next")
    assert states(driver) == ["done", "next", "later"]
    assert [line.current for line in lines(driver)] == [False, True, False]
    driver.command("next")
    assert states(driver) == ["done", "skipped", "next"]


def test_the_last_run_counts_and_its_sign_off_shows():
    driver = BoxDriver(competition(tbm=day(0, 15)))
    for _ in range(2):
        a_run(driver)
        driver.command("disconnect")
    last = lines(driver)[0].last
    assert last.identity == driver.box.finished.records()[0].identity != driver.box.finished.records()[1].identity
    driver.enter("sign_off", RunName("tbm", last.identity), "Anna")
    assert lines(driver)[0].last.sign_off.who == "Anna"


def test_the_score_of_the_attempt_before_is_not_shown_beside_a_run():
    driver = BoxDriver(competition(tbm=day(0, 15)))
    a_run(driver)
    driver.command("disconnect")
    (first, _) = events_shown(lines(driver)).values()
    a_run(driver, end=False)
    (again, _) = events_shown(lines(driver)).values()
    assert first.score
    assert (again.state, again.identity, again.score) == ("running", first.identity, "")


# -- estimated times --------------------------------------------------------------------------------


def test_a_slot_is_what_the_schedule_gives():
    plan = ZonePlan("z", tuple(day(0, 15, 30, 90) + day(100, code="HWV")))
    assert slot_lengths([plan]) == {"HGTKMH": 10 * MINUTE, "HWV": 600.0 + SETUP_S}
    a_day_each = ZonePlan("z", tuple(day(0, 24 * 60)))
    assert slot_lengths([a_day_each]) == {"HGTKMH": 600.0 + SETUP_S}, "the night is no slot"
    twice = ZonePlan("z", tuple(day(0, 0, 20)))
    assert slot_lengths([twice]) == {"HGTKMH": 20 * MINUTE}, "events at the same time say nothing"
    assert slot_lengths([]) == {}


def test_a_slot_without_a_limit_and_with_a_setup_time_of_its_own():
    def plan(**rules):
        return ZonePlan("z", (event(timeout=NO_LIMIT, rules=EventRules(**rules)),))

    assert slot_lengths([plan()]) == {"HGTKMH": NO_LIMIT_S + SETUP_S}
    assert slot_lengths([plan(setup_time=60.0)]) == {"HGTKMH": NO_LIMIT_S + 60.0}


def test_nothing_begins_before_its_time():
    driver = BoxDriver(competition(tbm=day(0, 15, 30)))
    assert minutes(driver) == [0, 15, 30]
    a_run(driver)
    assert minutes(driver)[1:] == [15, 30]


def test_a_late_event_delays_the_later_ones_and_a_break_absorbs_the_delay():
    driver = BoxDriver(competition(tbm=day(0, 15, 30, 90), other=day(0, 15)))
    at(driver, 12.5)
    assert minutes(driver) == [13, 28, 43, 90]
    at(driver, 80)
    assert minutes(driver) == [80, 95, 110, 125]
    choose(driver, 2)
    assert minutes(driver) == [0, 15, 80, 95], "skipped events take no time"


def test_a_run_delays_by_when_it_began_and_by_its_length():
    driver = BoxDriver(competition(tbm=day(0, 15, 30, timeout=3600.0)))
    at(driver, 7)
    a_run(driver, end=False)
    begins = minutes(driver)
    assert begins[0] == pytest.approx(7.0, abs=0.1), "it began then"
    assert begins[1:] == [23, 38], "whole minutes"
    driver.robot().beacon()
    robot = driver.box.zones["tbm"].run
    assert robot is not None
    at(driver, 28)
    assert minutes(driver)[1:] == [28, 43], "it takes longer than its slot: the next one begins now, for all we know"


def test_estimates_change_once_a_minute():
    driver = BoxDriver(competition(tbm=day(0, 15, 30)))
    at(driver, 20.1)
    before = lines(driver)
    driver.run(30.0)
    assert lines(driver) == before
    driver.run(30.0)
    assert lines(driver) != before


def test_a_delay_over_midnight():
    midnight = T0 - T0 % 86400 + 86400
    events = [event(run=run, scheduled=midnight - 20 * MINUTE + run * 15 * MINUTE) for run in (0, 1, 2)]
    driver = BoxDriver(competition(tbm=events))
    driver.run(midnight - 2 * MINUTE - driver.now.utc)
    assert [round((line.begins - midnight) / MINUTE) for line in lines(driver)] == [-2, 13, 28]


# -- the choice of an event -------------------------------------------------------------------------


def test_an_event_is_chosen():
    driver = BoxDriver(competition(tbm=day(0, 15, 30)))
    driver.taken()
    choose(driver, 2)
    assert driver.box.zones["tbm"].index == 2
    assert driver.box.outbox.take_changed() == {"tbm"}
    [record] = [effect.value for effect in driver.taken() if type(effect).__name__ == "Recorded"]
    assert record == {"command": "choose_event", "event": "HGTKMH Gamma 1 3"}
    choose(driver, 0)
    assert driver.box.zones["tbm"].index == 0


def test_a_run_in_the_zone_is_left_only_if_that_is_confirmed():
    driver = BoxDriver(competition(tbm=day(0, 15, 30)))
    driver.connected()
    with pytest.raises(Refused, match="disconnect it first"):
        choose(driver, 1, unsigned=True)
    driver.command("disconnect")
    a_run(driver, end=False)
    with pytest.raises(Refused, match="is running: stop it first"):
        choose(driver, 1, unsigned=True)
    driver.command("stop")
    with pytest.raises(Refused, match="HGTKMH, team Alpha, round 1, run 1 is not signed off: confirm"):
        choose(driver, 1)
    assert driver.run_in() is not None
    choose(driver, 1, unsigned=True)
    assert driver.run_in() is None
    assert driver.box.zones["tbm"].index == 1
    assert driver.box.finished.records()[0].team == "Alpha", "its sheet can be signed off later"


def test_a_run_that_was_left_counts_until_it_is_signed_off():
    driver = BoxDriver(competition(tbm=day(0, 15, 30)))
    a_run(driver)
    driver.command("disconnect")
    with pytest.raises(Refused, match="not signed off"):
        choose(driver, 1)
    choose(driver, 0)  # it is there already
    driver.event(driver.box.scores.sign_off, RunName("tbm", driver.box.finished.records()[0].identity), "Anna")
    choose(driver, 1)
    assert driver.box.zones["tbm"].index == 1


def test_a_completed_run_is_left_for_the_event_that_was_chosen():
    driver = BoxDriver(competition(tbm=day(0, 15, 30)), Settings(auto_next=True))
    a_run(driver)
    choose(driver, 2, unsigned=True)
    assert driver.box.zones["tbm"].index == 2


def test_an_event_that_the_schedule_does_not_have():
    driver = BoxDriver(competition(tbm=day(0, 15)))
    with pytest.raises(Refused, match="zone 'tbm' has no event 'x' any more: choose it again"):
        driver.choose_id("x")
    with pytest.raises(Refused, match="no zone 'tmb': did you mean 'tbm'"):
        driver.choose_id("x", "tmb")
    assert driver.box.zones["tbm"].index == 0
