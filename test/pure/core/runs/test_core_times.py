"""Rules about time and attempts: no limit, setup time, restarts, pauses, phases, attempts."""

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import UTC0, competition, event
from helpers.module_player import FakeModules
from roah_rsbb.core import effects
from roah_rsbb.model import run_log
from roah_rsbb.model.modules import RequestKind
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.rulebook.benchmarks import NO_LIMIT, EventRules, PhaseRule, Restarts

PHASES = EventRules(phases=(PhaseRule("Take the order", 30.0), PhaseRule("Serve"), PhaseRule("Clear", 20.0)))


def box_with(code="HGTKMH", timeout=600.0, second=None, **rules):
    """A box whose zone has one event with these rules, or two."""
    events = [event(code, timeout=timeout, rules=EventRules(**rules))]
    return BoxDriver(competition(tbm=events + ([event(second)] if second else [])))


def clock(driver, zone="tbm"):
    return driver.view(zone).clock


# -- no limit -----------------------------------------------------------------------------------------


def test_a_run_without_a_limit_ends_by_the_robot_only():
    driver = box_with(timeout=NO_LIMIT)
    assert (driver.view().timeout, driver.view().timer) == (0.0, 0.0)
    robot = driver.executing()
    robot.lives(100)
    started = driver.box.finished
    assert driver.run_in().phase is Phase.RUNNING
    assert (clock(driver).limit, clock(driver).counting) == (0.0, True)
    assert clock(driver).elapsed == pytest.approx(100.0, abs=0.5)
    assert driver.view().timer == clock(driver).elapsed
    robot.completes()
    assert driver.run_in().end_reason is EndReason.COMPLETED
    driver.command("disconnect")
    assert started.records()[0].elapsed_s == pytest.approx(100.0, abs=0.5)


def test_goals_without_a_limit():
    driver = BoxDriver(competition(tbm=[event("HNF", timeout=NO_LIMIT, total_timeout=60.0)]))
    modules = FakeModules(driver, "HNF")
    modules.beat()
    driver.connected()
    modules.beat()
    driver.command("start")
    modules.asks(RequestKind.GOAL, goal="[1]", timeout=0.0)
    assert next(run for run in driver.box.modules.runs()).goal_timeout == 0.0
    assert (clock(driver).goal, driver.view().timeout) == (0, 60.0)


# -- setup time ---------------------------------------------------------------------------------------


def test_setup_time_counts_from_connect_to_start():
    driver = box_with(setup_time=60.0)
    assert (clock(driver).setup_limit, clock(driver).setup_counting) == (60.0, False)
    robot = driver.connected()
    robot.lives(20)
    assert driver.view().timer == pytest.approx(40.0, abs=0.5)
    assert clock(driver).setup_counting and clock(driver).setup_elapsed == pytest.approx(20.0, abs=0.5)
    driver.command("start")
    assert driver.view().timer == 600.0
    assert not clock(driver).setup_counting
    robot.lives(100)
    assert "setup" not in driver.view().log


def test_the_end_of_the_setup_time_is_a_warning_only():
    driver = box_with(setup_time=60.0)
    robot = driver.connected()
    robot.lives(59)
    assert driver.view().warnings == ()
    robot.lives(2)
    assert driver.view().warnings == ("The setup time of 1:00 is over",)
    assert driver.view().log.count("WARNING: The setup time of 1:00 is over") == 1
    assert driver.view().timer == 0.0
    driver.run(3)
    assert [text[:21] for text in driver.view().warnings] == ["No message from the r", "The setup time of 1:0"]
    robot.lives(27)
    assert clock(driver).setup_elapsed == pytest.approx(91.0, abs=0.5)
    driver.command("start")
    assert driver.view().warnings == ()
    assert driver.view().log.count("setup time") == 1


def test_a_run_of_all_robots_has_one_setup_time():
    driver = BoxDriver(competition(all=[event("HSUF", team="ALL", rules=EventRules(setup_time=10.0, pause=True))]))
    robots = [driver.robot(team, "r") for team in ("Alpha", "Beta")]
    for robot in robots:
        robot.beacon()
    driver.command("connect", "all")
    driver.run(11.0)
    assert driver.view("all").log.count("The setup time of 0:10 is over") == 1
    for robot, member in zip(robots, driver.run_in("all").members()):
        robot.port = member.port
        robot.says(RobotState.STOP)
    driver.command("start", "all")
    driver.command("pause", "all")
    before = clock(driver, "all")
    driver.run(5.0)
    assert clock(driver, "all").elapsed == before.elapsed
    assert (before.paused, before.counting) == ("by the referee", False)
    driver.command("resume", "all")
    driver.run(5.0)
    assert clock(driver, "all").elapsed == pytest.approx(before.elapsed + 5.0)


@pytest.mark.parametrize("is_paused", [False, True])
def test_the_clock_of_a_run_of_all_robots_does_not_change_when_the_first_completes(is_paused):
    rules = EventRules(restarts=Restarts.CLOCK_STOPS, pause=True)
    driver = BoxDriver(competition(all=[event("HSUF", team="ALL", timeout=60.0, rules=rules)]))
    robots = [driver.robot(team, "r") for team in ("Alpha", "Beta")]
    for robot in robots:
        robot.beacon()
    driver.command("connect", "all")
    for robot, member in zip(robots, driver.run_in("all").members()):
        robot.port = member.port
        robot.says(RobotState.STOP)
    driver.command("start", "all")
    robots[0].executes()
    if is_paused:
        driver.command("pause", "all")
    before = clock(driver, "all").elapsed
    robots[0].says(RobotState.RESULT_TX)
    driver.run(5.0)
    after, run, most = clock(driver, "all"), driver.run_in("all"), before if is_paused else before + 5.0
    assert ([each.phase for each in run.members()], run.phase) == ([Phase.ENDED, Phase.RUNNING], Phase.RUNNING)
    assert (bool(after.paused), after.counting) == (is_paused, not is_paused)
    assert run.record(driver.now).elapsed_s == pytest.approx(after.elapsed) == pytest.approx(most, abs=0.5)


# -- restarts -----------------------------------------------------------------------------------------


def test_the_clock_stops_with_the_run():
    driver = box_with(timeout=60.0, restarts=Restarts.CLOCK_STOPS)
    robot = driver.executing()
    robot.lives(20)
    driver.command("stop")
    robot.says(RobotState.STOP)
    robot.lives(100)
    assert "Can be restarted. The clock is stopped" in driver.view().state
    driver.command("start")
    assert driver.view().timer == pytest.approx(40.0, abs=0.5)
    robot.executes()
    robot.lives(45)
    assert driver.run_in().end_reason is EndReason.TIMEOUT
    driver.command("disconnect")
    assert driver.box.finished.records()[0].elapsed_s == 60.0


def test_no_restart():
    driver = box_with(restarts=Restarts.NOT_ALLOWED)
    robot = driver.executing()
    driver.command("stop")
    robot.says(RobotState.STOP)
    expected = "The rules of this benchmark do not allow a restart: disconnect, and connect for a new run"
    assert driver.off("start") == [expected]
    with pytest.raises(Refused, match="do not allow a restart"):
        driver.command("start")
    assert "Can be restarted" not in driver.view().state
    driver.command("disconnect")
    driver.connected()
    assert driver.off("start") == []


# -- pauses -------------------------------------------------------------------------------------------


def test_a_pause_stops_the_clock_and_not_the_robot():
    driver = box_with(timeout=60.0, pause=True)
    robot = driver.executing()
    robot.lives(20)
    driver.command("pause")
    assert driver.off("pause") == ["The clock is paused"]
    robot.lives(100)
    assert (clock(driver).paused, driver.run_in().phase) == ("by the referee", Phase.RUNNING)
    assert "Clock paused by the referee" in driver.view().state.splitlines()
    assert driver.box_state() is BoxState.WAITING_RESULT
    driver.command("resume")
    assert driver.view().timer == pytest.approx(40.0, abs=0.5)
    robot.lives(41)
    assert driver.run_in().end_reason is EndReason.TIMEOUT


def started_hnf():
    """A running benchmark whose runs may be paused, and its module."""
    driver = BoxDriver(competition(tbm=[event("HNF", timeout=60.0, total_timeout=600.0, rules=EventRules(pause=True))]))
    modules = FakeModules(driver, "HNF")
    modules.beat()
    driver.connected()
    modules.beat()
    driver.command("start")
    return driver, modules


def test_a_pause_also_pauses_the_goal():
    driver, modules = started_hnf()
    modules.asks(RequestKind.GOAL, goal="[1]", timeout=60.0)
    driver.command("pause")
    for _ in range(50):
        driver.run(2.0)
        modules.beat()
    assert clock(driver).goal_elapsed == pytest.approx(0.0, abs=0.1)
    assert clock(driver).elapsed == pytest.approx(0.0, abs=0.1)
    driver.command("resume")
    assert clock(driver).goal_counting and clock(driver).counting


@pytest.mark.parametrize("command", ["pause", "resume", "next_phase", "previous_phase"])
def test_without_such_rules_there_are_no_such_commands(command):
    driver = BoxDriver()
    driver.executing()
    with pytest.raises(Refused):
        driver.command(command)


# -- phases -------------------------------------------------------------------------------------------


def phased(**rules):
    driver = BoxDriver(competition(tbm=[event(rules=PHASES)]))
    assert clock(driver).phases == 3
    return driver, driver.executing()


def test_the_referee_moves_the_run_through_its_phases():
    driver, robot = phased()
    descs = driver.logged(robot.port, run_log.STATE_DESC)
    assert descs[-1] == "Phase 1 of 3, Take the order: Robot prepared, executing (no explicit goal)"
    robot.lives(10)
    sent = len(driver.states[robot.port])
    driver.command("next_phase")
    assert driver.logged(robot.port, run_log.STATE_DESC)[-1] == "Phase 2 of 3, Serve: begun by the referee"
    assert driver.states[robot.port][sent].state is BoxState.WAITING_RESULT  # the robot's state does not change
    assert driver.view().state.splitlines()[0] == "Phase 2 of 3, Serve: begun by the referee"
    assert (clock(driver).phase_number, clock(driver).phase_name, clock(driver).phase_limit) == (2, "Serve", 0.0)
    robot.lives(25)
    assert clock(driver).phase_elapsed == pytest.approx(25.0, abs=0.5)
    driver.command("next_phase")
    assert driver.off("next_phase") == ["This is the last phase"]
    robot.lives(5)
    robot.completes()
    assert driver.logged(robot.port, run_log.STATE_DESC)[-1] == "Benchmark completed by the robot"
    record = driver.run_in().record(driver.now)
    assert [p.name for p in record.phases] == ["Take the order", "Serve", "Clear"]
    assert [round(p.elapsed_s) for p in record.phases] == [10, 25, 5]
    assert [round(p.began_utc - record.started_utc) for p in record.phases] == [0, 10, 35]
    driver.run(50.0)
    assert driver.run_in().record(driver.now).phases == record.phases
    assert clock(driver).phase_number == 0


def test_a_phase_whose_limit_is_over_continues_with_a_warning():
    driver, robot = phased()
    robot.lives(31)
    text = "The 0:30 of phase 1 of 3, Take the order are over"
    assert driver.view().warnings == (text,)
    robot.lives(30)
    assert driver.view().log.count(f"WARNING: {text}") == 1
    assert clock(driver).phase_elapsed == pytest.approx(61.0, abs=0.5)
    assert driver.run_in().phase is Phase.RUNNING
    driver.command("next_phase")
    assert driver.view().warnings == ()


def test_back_to_the_phase_before_a_mistake():
    driver, robot = phased()
    assert driver.off("previous_phase") == ["This is the first phase"]
    robot.lives(10)
    driver.command("next_phase")
    robot.lives(3)
    driver.command("previous_phase")
    assert clock(driver).phase_elapsed == pytest.approx(10.0, abs=0.5)
    robot.lives(19)
    assert driver.view().warnings == ()
    robot.lives(2)
    assert len(driver.view().warnings) == 1
    driver.command("next_phase")
    assert clock(driver).phase_elapsed == pytest.approx(3.0, abs=0.5)
    assert [p.name for p in driver.run_in().record(driver.now).phases] == ["Take the order", "Serve"]


def test_a_restart_of_the_run_begins_with_the_first_phase():
    driver, robot = phased()
    driver.command("next_phase")
    driver.command("stop")
    assert driver.off("next_phase") == ["No run is running"]
    robot.says(RobotState.STOP)
    driver.command("start")
    assert (clock(driver).phase_number, clock(driver).phase_elapsed) == (1, 0.0)
    assert [p.name for p in driver.run_in().record(driver.now).phases] == ["Take the order"]


def test_a_pause_pauses_the_phase():
    rules = EventRules(phases=PHASES.phases, pause=True)
    driver = BoxDriver(competition(tbm=[event(rules=rules)]))
    robot = driver.executing()
    robot.lives(10)
    driver.command("pause")
    driver.command("next_phase")
    robot.lives(10)
    assert clock(driver).phase_elapsed == 0.0
    driver.command("previous_phase")
    robot.lives(30)
    assert clock(driver).phase_elapsed == pytest.approx(10.0, abs=0.5)
    driver.command("resume")
    robot.lives(19)
    assert driver.view().warnings == ()
    robot.lives(2)
    assert len(driver.view().warnings) == 1


# -- attempts -----------------------------------------------------------------------------------------


def attempted(driver):
    """One more attempt that is stopped and left."""
    driver.executing()
    driver.command("stop")
    driver.command("disconnect")


def test_attempts_are_counted_and_limited():
    driver = box_with(attempts=2, second="HWV")
    assert "Attempt 1 of 2" in driver.view().state
    attempted(driver)
    assert (driver.view().attempt, "Attempt 2 of 2" in driver.view().state) == (2, True)
    attempted(driver)
    expected = ("The last of 2 attempts at this event was made: go to the next event. To allow more, raise 'attempts' "
                "in benchmarks.yaml")
    assert driver.off("connect") == [expected]
    assert driver.off("open_sheet") == [expected]
    with pytest.raises(Refused, match="2 attempts"):
        driver.connected()
    driver.command("next")
    assert driver.off("open_sheet") == []


@pytest.mark.parametrize("attempts, moves", [(0, [True]), (1, [True]), (2, [False, True])])
def test_the_zone_stays_at_its_event_while_the_team_has_another_attempt(attempts, moves):
    driver = box_with(attempts=attempts, second="HWV")
    for is_moved in moves:
        driver.executing().completes()
        driver.command("disconnect")
        assert (driver.view().event.code == "HWV") == is_moved


def test_a_team_that_withdrew_makes_no_other_attempt():
    driver = box_with(attempts=2, second="HWV")
    driver.command("withdrawn", team="Alpha")
    assert driver.view().event.code == "HWV"


def test_a_run_that_was_never_started_is_no_attempt():
    driver = box_with(attempts=1)
    driver.connected()
    driver.command("disconnect")
    assert driver.off("connect") == []
    attempted(driver)
    assert driver.off("connect")[0].startswith("The only attempt at this event was made")


def test_attempts_at_another_event_do_not_count():
    rules = EventRules(attempts=1)
    driver = BoxDriver(competition(tbm=[event(rules=rules), event(rules=rules, run=2, scheduled=UTC0 + 600)]))
    attempted(driver)
    driver.command("next")
    assert driver.off("connect") == []


def test_effects_of_a_pause_reach_the_journal():
    driver = box_with(pause=True)
    driver.executing()
    driver.taken()
    driver.command("pause")
    assert [e.value["command"] for e in driver.taken(effects.Recorded)] == ["pause"]
