"""Runs of functionality benchmarks: their clocks, stop, and start again."""


import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import competition, event
from helpers.module_player import does_goal, started
from roah_rsbb.core import effects
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.settings import Settings
from roah_rsbb.model.modules import OutcomeKind, RequestKind, ScoreValue
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState

WAYPOINT = {"goal": "[1.0, 2.0, 0.5]", "pose": (1.0, 2.0, 0.5)}
NO_SAVING = Settings(check_messages_saved=False)


def test_manual_operations_do_not_count_and_goals_do():
    driver, modules, robot = started()
    modules.asks(RequestKind.REFEREE, text="Place it")
    modules.lives(100.0, robot)
    assert driver.run_in().clock.left(driver.now) == pytest.approx(600.0)
    driver.event(driver.box.act, Target("tbm"), "operation")
    modules.lives(10.0, robot)
    assert driver.run_in().clock.left(driver.now) == pytest.approx(590.0)
    modules.asks(timeout=120.0, **WAYPOINT)
    modules.lives(10.0, robot)
    assert driver.run_in().clock.left(driver.now) == pytest.approx(580.0)
    assert driver.view().timer == pytest.approx(110.0), "the goal's, while there is one"


def test_the_referee_sees_the_limit_that_applies():
    driver, modules, robot = started("STB", goal=30.0, total=120.0)
    assert driver.view().timeout == 30.0, "of the benchmarks file"
    modules.asks(RequestKind.REFEREE, text="Place it")
    driver.event(driver.box.act, Target("tbm"), "operation")
    assert driver.view().timeout == 30.0
    modules.asks(timeout=15.0, goal="GOAL 1")
    assert driver.view().timeout == 15.0, "the module's parameters say otherwise"
    does_goal(robot, generic_result="x")
    assert driver.view().timeout == 15.0
    modules.asks(goal="GOAL 2")
    assert driver.view().timeout == 120.0, "without a timeout the goal may last as long as the run"


def test_the_limit_of_a_task_is_the_limit_of_its_run():
    driver = BoxDriver(competition(tbm=[event("HGTKMH", timeout=300.0, total_timeout=420.0)]))
    assert driver.view().timeout == driver.view().timer == 420.0
    driver.executing()
    assert driver.view().timeout == 420.0


@pytest.mark.parametrize("states, executing", [
    ((), 0.0), ((RobotState.PREPARING,), 0.0), ((RobotState.PREPARING, RobotState.WAITING_GOAL), 30.0),
    ((RobotState.PREPARING, RobotState.WAITING_GOAL, RobotState.EXECUTING), 30.0),
])
def test_a_goals_timeout_ends_the_goal_and_not_the_run(states, executing):
    driver, modules, robot = started(settings=NO_SAVING)
    modules.asks(timeout=30.0, **WAYPOINT)
    for state in states:
        robot.says(state)
    before = driver.box_state()
    modules.lives(29.9 - 0.001 * len(states), robot)
    assert modules.outcome() is None
    modules.lives(0.2, robot)
    outcome = modules.outcome()
    assert outcome.kind is OutcomeKind.TIMED_OUT
    assert outcome.executing_s == pytest.approx(executing, abs=0.01)
    assert outcome.ended_utc == pytest.approx(driver.now.utc - 0.1, abs=0.001), "when it was due"
    assert (driver.run_in().phase, driver.box_state()) == (Phase.RUNNING, before)
    modules.asks(timeout=30.0, **WAYPOINT)
    assert driver.box_state() is BoxState.PREPARE
    assert not driver.taken(effects.TimeoutRung)


def test_a_goals_timeout_that_is_noticed_late_counts_from_when_it_was_due():
    driver, modules, robot = started()
    modules.asks(timeout=30.0, **WAYPOINT)
    robot.says(RobotState.PREPARING)
    robot.says(RobotState.WAITING_GOAL)
    assert driver.box.deadline() <= driver.now.mono + 2.0, "the modules must be heard until then"
    modules.lives(29.0)
    due = driver.now.utc + 0.998
    assert driver.box.deadline() == pytest.approx(driver.now.mono + 0.998)
    driver.jump(1.7)
    driver.event(driver.box.tick)
    outcome = modules.outcome()
    assert (outcome.ended_utc, outcome.executing_s) == (pytest.approx(due, abs=0.01), pytest.approx(29.998))


def test_a_goal_without_a_timeout_ends_with_the_run_only():
    driver, modules, robot = started(total=60.0)
    modules.asks(**WAYPOINT)
    modules.lives(59.0, robot)
    assert driver.view().timer == pytest.approx(1.0)
    modules.lives(1.1, robot)
    assert driver.run_in().end_reason is EndReason.TIMEOUT


def test_the_total_timeout_ends_the_run_and_rings():
    driver, modules, robot = started(total=60.0)
    modules.asks(timeout=120.0, **WAYPOINT)
    modules.lives(60.1, robot)
    assert driver.run_in().end_reason is EndReason.TIMEOUT
    assert driver.taken(effects.TimeoutRung)
    run = modules.run()
    assert (run.running, run.end_reason, run.elapsed_s) == (False, "timeout", pytest.approx(60.0))
    assert run.steps[-1].outcome is None
    assert driver.off("start")[0].startswith("The run ended by timeout")


def test_a_goal_that_ends_with_the_run_is_over_first():
    driver, modules, _ = started(total=60.0)
    modules.asks(timeout=60.0, **WAYPOINT)
    modules.lives(59.0)
    driver.jump(10.0)
    driver.event(driver.box.tick)
    assert modules.outcome().kind is OutcomeKind.TIMED_OUT
    assert driver.run_in().end_reason is EndReason.TIMEOUT


def test_a_goals_timeout_after_the_runs_end_means_nothing():
    driver, modules, _ = started(total=60.0)
    modules.asks(timeout=61.0, **WAYPOINT)
    modules.lives(59.0)
    driver.jump(10.0)
    driver.event(driver.box.tick)
    assert modules.outcome() is None
    assert driver.run_in().end_reason is EndReason.TIMEOUT, "that was due before the module was gone"


def test_a_robot_that_saves_nothing_is_stopped_here_too():
    driver, modules, robot = started()
    modules.asks(**WAYPOINT)
    robot.saved = 0
    robot.executes()
    modules.lives(5.1, robot)
    assert driver.run_in().end_reason is EndReason.NO_MESSAGES_SAVED
    assert modules.run().end_reason == "no_messages_saved"


# -- stop and start again ---------------------------------------------------------------------------


def _asking(modules, robot):
    modules.asks(RequestKind.REFEREE, text="Place it")


def _preparing(modules, robot):
    modules.asks(**WAYPOINT)


def _executing(modules, robot):
    modules.asks(timeout=50.0, **WAYPOINT)
    robot.executes()


def _between(modules, robot):
    modules.asks(**WAYPOINT)
    does_goal(robot)


@pytest.mark.parametrize("reach", [lambda *_: None, _asking, _preparing, _executing, _between])
def test_stop_and_start_again_anywhere(reach):
    driver, modules, robot = started()
    reach(modules, robot)
    modules.says(scores=(ScoreValue("", "reached", "1", ""),))
    driver.command("stop")
    assert (driver.box_state(), driver.run_in().end_reason) == (BoxState.STOP, EndReason.STOPPED)
    assert driver.run_in().asked is None
    assert driver.view().timer == pytest.approx(120.0), "of the time after the stop, not of a goal"
    run = modules.run()
    assert (run.attempt, run.running, run.end_reason) == (1, False, "stopped")
    with pytest.raises(Refused):
        driver.event(driver.box.act, Target("tbm"), "operation")
    left = driver.run_in().clock.left(driver.now)
    modules.says(scores=(ScoreValue("", "reached", "2", ""),), finished=True)
    assert driver.run_in().scores[0].value == "2", "the last score of a module comes after the stop"
    assert driver.run_in().end_reason is EndReason.STOPPED
    modules.lives(7.0)
    robot.says(RobotState.STOP)
    assert driver.run_in().clock.left(driver.now) == pytest.approx(left - 7.0, abs=0.01), "stopped time counts"
    driver.command("start")
    run = modules.run()
    assert (run.attempt, run.running, run.end_reason, run.steps, run.kept) == (2, True, "", (), "")
    assert driver.run_in().scores == ()
    modules.beat()
    assert modules.run().steps == (), "what it says of the attempt before is not for this one"
    modules.asks(**WAYPOINT)
    assert driver.box_state() is BoxState.PREPARE


@pytest.mark.parametrize("completed, reason, desc", [
    (0, EndReason.GOALS_TIMED_OUT, "Benchmark over: every goal timed out"),
    (1, EndReason.COMPLETED, "Benchmark complete: 1 of 2 goals timed out"),
    (2, EndReason.COMPLETED, "Benchmark complete"),
])
def test_a_run_of_goals_that_timed_out_is_not_completed_by_the_robot(completed, reason, desc):
    driver, modules, robot = started(settings=NO_SAVING)
    for number in range(2):
        modules.asks(timeout=30.0, **WAYPOINT)
        if number < completed:
            does_goal(robot)
        else:
            modules.lives(30.1, robot)
    modules.says(finished=True)
    run = driver.run_in()
    assert (run.phase, run.end_reason, run.desc) == (Phase.ENDED, reason, desc)
    assert run.record(driver.now).end_reason == reason.name.lower()


def test_run_time_goal_time_and_pause_are_shown_side_by_side():
    driver, modules, robot = started()
    modules.asks(RequestKind.REFEREE, text="Place it")
    modules.lives(100.0, robot)
    clock = driver.view().clock
    assert (clock.limit, clock.elapsed, clock.counting, clock.paused) == (600.0, 0.0, False, "manual operation")
    assert (clock.goal, clock.goal_limit) == (0, 120.0)
    driver.event(driver.box.act, Target("tbm"), "operation")
    modules.asks(timeout=60.0, **WAYPOINT)
    modules.lives(10.0, robot)
    clock = driver.view().clock
    assert (clock.elapsed, clock.counting, clock.paused) == (pytest.approx(10.0), True, "")
    assert (clock.goal, clock.goal_limit, clock.goal_elapsed) == (2, 60.0, pytest.approx(10.0))
    driver.command("stop")
    driver.run(30.0)
    clock = driver.view().clock
    assert (clock.elapsed, clock.counting, clock.goal) == (pytest.approx(10.0), False, 0)
    assert clock.after_stop == pytest.approx(90.0)


def test_a_run_without_its_module_is_paused_and_so_is_its_goal():
    driver, modules, robot = started()
    modules.asks(timeout=60.0, **WAYPOINT)
    modules.lives(10.0, robot)
    driver.run(50.0)
    clock = driver.view().clock
    assert (clock.counting, clock.goal_counting, clock.paused) == (False, False, "the benchmarking module is missing")
    assert clock.elapsed == pytest.approx(clock.goal_elapsed) == pytest.approx(12.0)
    assert clock.elapsed == driver.run_in().clock.elapsed(driver.now.later(9.0))
