"""Runs of functionality benchmarks: goal by goal, as the module asks; their clocks, stop, and start again."""

import json

import pytest

from helpers.forms import answer_in, form
from helpers.module_player import does_goal, functionality, started
from roah_rsbb.bmbox.framework.results import MAX_RESULT, BadResult, read_record
from roah_rsbb.core import effects
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.settings import Settings
from roah_rsbb.model import run_log
from roah_rsbb.model.messages import NO_GOAL, GoalMessage
from roah_rsbb.model.modules import OutcomeKind, RequestKind, ScoreValue
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState

WAYPOINT = {"goal": "[1.0, 2.0, 0.5]", "pose": (1.0, 2.0, 0.5)}
NO_SAVING = Settings(check_messages_saved=False)


def sent(driver, robot):
    """The states that the box sent, without repetitions."""
    states = [message.state for message in driver.states[robot.port]]
    return [state for i, state in enumerate(states) if i == 0 or states[i - 1] is not state]


def test_a_module_that_is_not_there_keeps_start_off_and_connect_on():
    driver, _, robot = functionality()
    driver.run(2.1)
    robot.says()
    reasons = driver.off("start")
    assert len(reasons) == 1
    assert reasons[0].startswith("Benchmarking module not connected: nothing drives HNF")
    driver.command("disconnect")
    robot.beacon()
    assert driver.off("connect") == []


def test_a_whole_run_with_waypoints_and_manual_operations():
    driver, modules, robot = started()
    assert driver.box_state() is BoxState.STOP, "manual operations before the first goal leave the robot alone"
    modules.asks(RequestKind.REFEREE, text="Place the robot")
    assert driver.run_in().asked.text == "Place the robot"
    assert driver.box_state() is BoxState.STOP
    driver.event(driver.box.act, Target("tbm"), "operation")
    assert modules.outcome().kind is OutcomeKind.DONE
    modules.asks(timeout=120.0, **WAYPOINT)
    assert driver.box_state() is BoxState.PREPARE
    robot.says(RobotState.PREPARING)
    assert modules.run().told_utc == 0.0
    robot.says(RobotState.WAITING_GOAL, after=3.0)
    assert modules.run().told_utc == driver.now.utc
    message = driver.run_in().message
    assert (message.state, message.goal) == (BoxState.GOAL_TX, GoalMessage("[1.0, 2.0, 0.5]", (1.0, 2.0, 0.5)))
    robot.says(RobotState.EXECUTING)
    message = driver.run_in().message
    assert (message.state, message.goal) == (BoxState.WAITING_RESULT, NO_GOAL)
    modules.lives(20.0, robot)
    robot.says(RobotState.RESULT_TX)
    outcome = modules.outcome()
    assert outcome.kind is OutcomeKind.DONE
    assert modules.run().told_utc == 0.0
    assert outcome.executing_s == pytest.approx(20.0, abs=0.01), "from the goal on, without the preparation"
    assert outcome.ended_utc == driver.now.utc
    assert driver.box_state() is BoxState.WAITING_RESULT, "until the module asks for the next thing"
    modules.asks(timeout=120.0, **WAYPOINT)
    assert driver.box_state() is BoxState.PREPARE
    does_goal(robot)
    modules.says(finished=True)
    assert (driver.run_in().phase, driver.run_in().end_reason) == (Phase.ENDED, EndReason.COMPLETED)
    states = [BoxState.STOP] + [BoxState.PREPARE, BoxState.GOAL_TX, BoxState.WAITING_RESULT] * 2 + [BoxState.STOP]
    assert sent(driver, robot) == states


def test_without_an_explicit_goal_the_robot_only_executes():
    driver, modules, robot = started("HOPF")
    modules.asks(timeout=10.0)
    robot.says(RobotState.PREPARING)
    robot.says(RobotState.WAITING_GOAL)
    assert driver.box_state() is BoxState.WAITING_RESULT
    robot.says(RobotState.WAITING_GOAL)
    assert driver.box_state() is BoxState.WAITING_RESULT, "it has not heard of it yet"
    robot.says(RobotState.EXECUTING)
    robot.says(RobotState.RESULT_TX, generic_result="{class: a}")
    assert modules.outcome().result == "{class: a}"
    assert driver.logged(robot.port, run_log.HOPF_RESULT, run_log.RESULT) == ["{class: a}"] * 2
    assert BoxState.GOAL_TX not in sent(driver, robot)


@pytest.mark.parametrize("result", [{"generic_result": "[" * 60_000}, {"object_class": "m" * 60_000}])
def test_a_result_that_no_module_reads_is_not_kept_whole(result):
    """It is sent to modules and recorded with every further step."""
    _, modules, robot = started("HOPF")
    modules.asks()
    does_goal(robot, **result)
    kept = modules.outcome().result
    assert MAX_RESULT < len(kept) <= 4000
    with pytest.raises(BadResult):
        read_record(kept, {"class": str})


def test_a_goal_of_homf_carries_switches():
    driver, modules, robot = started("HOMF")
    modules.asks(initial_state=(True, False, False), switches=(2, 3))
    robot.says(RobotState.PREPARING)
    robot.says(RobotState.WAITING_GOAL)
    goal = driver.run_in().message.goal
    assert (goal.initial_state, goal.switches) == ((True, False, False), (2, 3))
    box = driver.box
    driver.event(box.act, Target("tbm"), "switch", "", {"number": 2})
    robot.says(RobotState.EXECUTING)
    with pytest.raises(Refused, match="the robot has not finished"):
        driver.event(box.act, Target("tbm"), "confirm_switches")
    robot.says(RobotState.RESULT_TX)
    modules.asks(RequestKind.SWITCHES, text="Enter the switches")
    driver.event(box.act, Target("tbm"), "switch", "", {"number": 1})
    driver.event(box.act, Target("tbm"), "damaged", "", {"number": 1})
    assert driver.run_in().switches.on == (2,)
    with pytest.raises(Refused, match="numbered 1 to 3"):
        driver.event(box.act, Target("tbm"), "switch", "", {"number": 4})
    before = driver.run_in().clock.left(driver.now)
    modules.lives(30.0, robot)
    assert driver.run_in().clock.left(driver.now) == before, "the referee's time does not count"
    driver.event(box.act, Target("tbm"), "confirm_switches")
    driver.command("stop")
    with pytest.raises(Refused, match="zone 'tbm' has no switches to enter"):
        driver.event(box.act, Target("tbm"), "switch", "", {"number": 2})
    assert (modules.outcome().changed, modules.outcome().damaged) == ((2, 1), 1)


def test_switches_can_be_asked_for_only_after_a_goal_with_switches():
    driver, modules, _ = started("HOMF")
    modules.asks(RequestKind.SWITCHES)
    assert driver.run_in().end_reason is EndReason.MODULE_FAILED


def test_a_robot_that_loses_its_goal_is_asked_to_prepare_again_for_the_same_one():
    driver, modules, robot = started()
    modules.asks(timeout=120.0, **WAYPOINT)
    robot.executes()
    robot.says(RobotState.STOP, after=5.0)
    assert driver.box_state() is BoxState.PREPARE
    assert modules.outcome() is None
    for state in (RobotState.PREPARING, RobotState.WAITING_GOAL):
        robot.says(state)
    assert driver.run_in().message.goal.pose == (1.0, 2.0, 0.5)
    robot.says(RobotState.EXECUTING)
    robot.says(RobotState.WAITING_GOAL)
    assert driver.box_state() is BoxState.PREPARE, "with an explicit goal it must be executing"
    robot.says(RobotState.WAITING_GOAL)
    robot.says(RobotState.EXECUTING)
    robot.says(RobotState.RESULT_TX, after=1.0)
    assert modules.outcome().executing_s == pytest.approx(6.0, abs=0.01), "from the first time on"


def test_a_robot_that_answers_at_once_has_its_result_taken_in_goal_tx():
    driver, modules, robot = started()
    modules.asks(**WAYPOINT)
    robot.says(RobotState.PREPARING)
    robot.says(RobotState.WAITING_GOAL)
    robot.says(RobotState.RESULT_TX)
    assert modules.outcome().kind is OutcomeKind.DONE


def test_between_goals_nothing_that_the_robot_says_moves_the_state():
    driver, modules, robot = started()
    modules.asks(**WAYPOINT)
    does_goal(robot)
    for state in (*RobotState, RobotState.RESULT_TX):
        robot.says(state)
        assert driver.box_state() is BoxState.WAITING_RESULT
    assert len(modules.run().steps) == 1
    robot.says(RobotState.RESULT_TX)
    modules.asks(**WAYPOINT)
    robot.says(RobotState.RESULT_TX)
    assert driver.box_state() is BoxState.PREPARE, "that is the result of the goal before"
    assert modules.outcome() is None


def test_what_the_referee_does_not_know_is_refused():
    driver, modules, _ = started()
    with pytest.raises(Refused, match="has no manual operation now"):
        driver.event(driver.box.act, Target("tbm"), "operation")
    modules.asks(RequestKind.REFEREE, text="Try again?", form=form("try again", "skip"))
    with pytest.raises(Refused, match="Answer: choose one of try again, skip"):
        driver.event(driver.box.act, Target("tbm"), "operation", "", {"operation": 1, "answer": "perhaps"})
    with pytest.raises(Refused, match="is over; the current one is: Try again"):
        driver.event(driver.box.act, Target("tbm"), "operation", "", {"operation": 7, "answer": "skip"})
    driver.event(driver.box.act, Target("tbm"), "operation", "", {"operation": 1, "answer": "skip"})
    assert answer_in(modules.outcome()) == "skip"
    with pytest.raises(Refused):
        driver.event(driver.box.act, Target("tbm"), "operation", "", {"operation": 1, "answer": "skip"})
    modules.asks(RequestKind.REFEREE, text="Again?", form=form("try again", "skip"))
    driver.event(driver.box.act, Target("tbm"), "operation")
    assert answer_in(modules.outcome()) == "try again", "no answer is the usual one"
    modules.asks(RequestKind.REFEREE, text="Place it")
    with pytest.raises(Refused, match="The command has no field 'answer': it has none"):
        driver.event(driver.box.act, Target("tbm"), "operation", "", {"answer": "done"})
    driver.event(driver.box.act, Target("tbm"), "operation")
    modules.asks(RequestKind.REFEREE, text="Which one?", form=form(asks_text=True))
    with pytest.raises(Refused, match="at most 1000 are allowed"):
        driver.event(driver.box.act, Target("tbm"), "operation", "", {"answer": "x" * 1001})
    driver.event(driver.box.act, Target("tbm"), "operation", "", {"answer": "the blue one"})
    assert answer_in(modules.outcome()) == "the blue one"


# -- score and what else the module says --------------------------------------------------------------


def test_scores_are_logged_only_when_they_grow():
    driver, modules, robot = started()
    scores = (ScoreValue("waypoint 1", "time", "12.5", "s", "Time"), ScoreValue("", "note", '"x"', ""))
    modules.says(scores=scores)
    modules.says(status="and so on")
    logged = driver.logged(robot.port, run_log.MODULE_SCORE)
    assert [json.loads(text) for text in logged] == [[
        {"group": "waypoint 1", "name": "time", "value": 12.5, "unit": "s", "desc": "Time"},
        {"group": "", "name": "note", "value": "x", "unit": "", "desc": ""},
    ]]


def test_the_module_reads_the_referees_scores():
    driver, modules, _ = started()
    driver.taken()
    driver.score("Penalized", "bumps", 3)
    assert driver.taken(effects.ModuleRunsChanged)
    assert {item.desc: value for group in modules.run().sheet for item, value in group.items}["bumps"] == 3


def test_the_referee_sees_what_is_asked_and_what_the_module_says():
    driver, modules, _ = started()
    modules.asks(RequestKind.REFEREE, text="Place it")
    modules.says(status="Waypoint 1 of 3", warnings=("frame robot is 3 s old",))
    state = driver.view().state
    assert "Manual operation: Place it" in state
    assert "Benchmark timeout: 10:00 (paused)" in state
    assert "Waypoint 1 of 3" in state
    assert "WARNING: frame robot is 3 s old" in state
    assert [n for n in driver.notices() if "3 s old" in n] == ["Benchmarking module: frame robot is 3 s old"]
    modules.says(status="Waypoint 2 of 3")
    assert not [n for n in driver.notices() if "3 s old" in n], "it is reported once"
    driver.command("stop")
    driver.command("start")
    assert "Waypoint" not in driver.view().state
    assert driver.view().warnings == ()


# -- requests that make no sense ------------------------------------------------------------------------


def test_repeated_late_or_foreign_messages_change_nothing():
    driver, modules, robot = started()
    modules.asks(RequestKind.REFEREE, text="first")
    first = dict(modules.progress)
    driver.event(driver.box.act, Target("tbm"), "operation")
    modules.asks(RequestKind.REFEREE, text="second")
    steps = modules.run().steps
    identity, last = next(iter(modules.progress.items()))
    for progress in (
        first[identity],
        last._replace(attempt=2, finished=True),
        last._replace(run="HNF-1-1", finished=True),
        last._replace(request=last.request._replace(number=3)),
        last._replace(request=last.request._replace(number=4)),
        last._replace(finished=True),
    ):
        modules.progress = {progress.run: progress}
        modules.beat()
        assert modules.run().steps == steps
        assert driver.run_in().phase is Phase.RUNNING


def test_a_goal_that_no_datagram_can_carry_ends_the_run():
    driver, modules, _ = started()
    modules.asks(goal="x" * 900)
    run = driver.run_in()
    assert run.end_reason is EndReason.MODULE_FAILED
    assert "its goal takes 900 bytes" in run.desc
    assert modules.run().end_reason == "module_failed"


def test_a_module_that_cannot_continue_ends_the_run_with_what_was_scored():
    driver, modules, _ = started()
    score = ScoreValue("", "reached", "1", "")
    modules.says(scores=(score,), failed="its rules changed")
    run = driver.run_in()
    assert (run.end_reason, run.scores) == (EndReason.MODULE_FAILED, (score,))
    assert "its rules changed" in run.desc


@pytest.mark.long
def test_a_module_that_asks_without_end_is_stopped():
    driver, modules, _ = started()
    for _ in range(2000):
        modules.asks(RequestKind.NOTE, note="1")
    assert driver.run_in().phase is Phase.RUNNING
    modules.asks(RequestKind.NOTE, note="1")
    assert "more than 2000" in driver.run_in().desc


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
    assert driver.box.timers.deadline() <= driver.now.mono + 2.0, "the modules must be heard until then"
    modules.lives(29.0)
    due = driver.now.utc + 0.998
    assert driver.box.timers.deadline() == pytest.approx(driver.now.mono + 0.998)
    driver.jump(1.7)
    driver.event(driver.box.timers.tick)
    outcome = modules.outcome()
    assert (outcome.ended_utc, outcome.executing_s) == (pytest.approx(due, abs=0.01), pytest.approx(29.998))


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


@pytest.mark.parametrize("timeout, is_over", [(60.0, True), (61.0, False)])
def test_a_goal_that_ends_with_the_run_is_over_first_and_one_that_ends_later_is_not(timeout, is_over):
    driver, modules, _ = started(total=60.0)
    modules.asks(timeout=timeout, **WAYPOINT)
    modules.lives(59.0)
    driver.jump(10.0)
    driver.event(driver.box.timers.tick)
    outcome = modules.outcome()
    assert (None if outcome is None else outcome.kind) is (OutcomeKind.TIMED_OUT if is_over else None)
    assert driver.run_in().end_reason is EndReason.TIMEOUT, "that was due before the module was gone"


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
    assert "START would begin the benchmark again: what was measured so far would not count" in driver.view().state
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
