"""After a restart or a takeover, a robot that was stopped stays stopped until a referee says otherwise.

The box before may have sent STOP after the last state that this one knows: to a robot of any state, without a trace.
So may a box that took over while this one lives on.
"""

import itertools

import pytest

from helpers.box_driver import MONO0, BoxDriver
from helpers.competition import competition, event
from helpers.module_player import FakeModules
from roah_rsbb.core import effects
from roah_rsbb.core.continuing import Saved
from roah_rsbb.core.copies import REPLACED_S, STANDBY, CopyReport
from roah_rsbb.core.runs.run import SETTLED_S, UnrecordedStop
from roah_rsbb.model.clock import Now
from roah_rsbb.model.modules import OutcomeKind, RequestKind
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.records import By, EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot.machine import box_transition
from roah_rsbb.rulebook.benchmarks import EventRules

TASK, GOALS, ALL = "HGTKMH", "HNF", "HSUF"
MOVES = (RobotState.PREPARING, RobotState.WAITING_GOAL, RobotState.EXECUTING, RobotState.RESULT_TX)
GOAL = {"timeout": 60.0, "goal": "[1.0, 2.0, 0.5]", "pose": (1.0, 2.0, 0.5)}
STOPPED_ITSELF, UNHEARD = "The robot reports STOP, and the box cannot know", "The box was restarted, and has not heard"


def config(code):
    timeouts = {GOALS: {"timeout": 100.0, "total_timeout": 300.0}}.get(code, {"timeout": 300.0})
    team, rules = "ALL" if code == ALL else "Alpha", EventRules(pause=True)
    return competition(teams=("Alpha", "Beta"), tbm=[event(code, team=team, rules=rules, **timeouts)])


class NextBox(BoxDriver):
    """A box that continues from another one's state. It hears the same robots."""

    def __init__(self, before, code, down=1.0, **saved):
        self._before, self._down, self._saved = before, down, saved
        self.sent = []  # (port, state), in order
        super().__init__(config(code), before.settings)

    def _begin(self, listening):
        before = self._before
        self.now = before.now.later(self._down)
        state = Saved(before.now.utc, before.box.restart.saved(), {n: z.saved() for n, z in before.box.zones.items()},
                      tuple(before.box.scores.records(before.now)), **self._saved)
        self.event(self.box.restart.resume, state)

    def _carry_out(self, effect):
        super()._carry_out(effect)
        if isinstance(effect, effects.SendState):
            self.sent.append(effect.message.state)

    def taken_over(self, robot):
        """The robot, which hears this box from now on."""
        robot.driver = self
        return robot


def saved_in(code, state):
    """A box that sends `state` in a run in progress, its robot and its modules."""
    driver = BoxDriver(config(code))
    modules = FakeModules(driver, GOALS)
    modules.beat()
    robot = driver.robot()
    robot.beacon()
    driver.command("connect")
    robot.port = driver.run_in().members()[0].port
    robot.says(RobotState.STOP)
    driver.command("start")
    if code == GOALS and state is not BoxState.STOP:
        modules.asks(RequestKind.GOAL, **GOAL)
    reached = {BoxState.GOAL_TX: (RobotState.PREPARING, RobotState.WAITING_GOAL),
               BoxState.WAITING_RESULT: (RobotState.PREPARING, RobotState.WAITING_GOAL, RobotState.EXECUTING)}
    for said in reached.get(state, ()):
        robot.says(said)
    assert driver.run_in().members()[0].message.state is state
    return driver, robot, modules


SAVED = [(TASK, BoxState.PREPARE), (TASK, BoxState.WAITING_RESULT), (ALL, BoxState.WAITING_RESULT),
         (GOALS, BoxState.STOP), (GOALS, BoxState.PREPARE), (GOALS, BoxState.GOAL_TX), (GOALS, BoxState.WAITING_RESULT)]


@pytest.mark.parametrize("code, state", SAVED)
def test_nothing_is_sent_before_the_robot_was_heard(code, state):
    driver, _, modules = saved_in(code, state)
    box = NextBox(driver, code)
    modules.driver = box
    for _ in range(100):
        modules.beat()
        box.run(0.5)
    assert set(box.sent) <= {BoxState.STOP}
    assert UNHEARD in box.view().warnings[0]
    assert box.off("stop") == [] == box.off("continue")


@pytest.mark.parametrize("code", [TASK, ALL])
@pytest.mark.parametrize("is_paused", [False, True])
def test_a_robot_that_reports_stop_changes_nothing_of_a_pause(code, is_paused):
    driver, robot, _ = saved_in(code, BoxState.WAITING_RESULT)
    if is_paused:
        driver.command("pause")
    box = NextBox(driver, code)
    before = box.view().clock.elapsed
    box.taken_over(robot).says(RobotState.STOP)
    box.run(2.0)
    box.command("continue")
    box.run(3.0)
    clock = box.view().clock
    assert (bool(clock.paused), clock.counting) == (is_paused, not is_paused)
    assert clock.elapsed == pytest.approx(before if is_paused else before + 5.0, abs=0.1)


@pytest.mark.parametrize("code, state", SAVED)
@pytest.mark.parametrize("last", MOVES)
def test_a_robot_that_was_stopped_stays_stopped(code, state, last):
    """Its last word before STOP arrived may reach the next box, too."""
    driver, robot, modules = saved_in(code, state)
    box = NextBox(driver, code)
    modules.driver = box
    box.taken_over(robot).says(last)
    seen = len(box.sent)
    assert all(box_transition(code, sent, RobotState.STOP).state is RobotState.STOP for sent in box.sent)
    for _ in range(20):
        robot.says(RobotState.STOP, after=0.05)
    if code == GOALS:
        modules.asks(RequestKind.GOAL, **GOAL)  # if it still drives the run
    for _ in range(40):
        modules.beat()
        robot.lives(1.0)
    assert all(sent is BoxState.STOP for sent in box.sent[seen:])
    run = box.run_in()
    if run.phase is Phase.RUNNING:  # else the robot had completed its task before
        assert STOPPED_ITSELF in box.view().warnings[0]
        box.command("stop")
        assert run.end_reason is EndReason.STOPPED
    assert not any("reports STOP" in text for text in box.view().warnings)
    with pytest.raises(Refused, match="not in doubt"):
        box.command("continue")


@pytest.mark.parametrize("code", [TASK, GOALS, ALL])
def test_a_robot_that_executes_continues(code):
    driver, robot, modules = saved_in(code, BoxState.WAITING_RESULT)
    box = NextBox(driver, code)
    modules.driver = box
    modules.beat()
    assert box.sent == []
    box.taken_over(robot).says()
    assert box.sent == [BoxState.WAITING_RESULT]
    assert not box.view().warnings and not box.view().action("continue").shown
    robot.lives(10.0)
    robot.says(RobotState.RESULT_TX)
    if code == GOALS:
        modules.asks(RequestKind.GOAL, **GOAL)
        modules.beat()
        assert box.sent[-1] is BoxState.PREPARE
    else:
        assert box.run_in().end_reason is EndReason.COMPLETED


@pytest.mark.parametrize("said, sent", [(RobotState.PREPARING, BoxState.PREPARE), (RobotState.RESULT_TX, None)])
def test_prepare_waits_until_a_stop_of_the_box_before_has_arrived(said, sent):
    driver, robot, modules = saved_in(GOALS, BoxState.WAITING_RESULT)
    box = NextBox(driver, GOALS)
    modules.driver = box
    box.taken_over(robot).says(said)
    if said is RobotState.RESULT_TX:
        modules.asks(RequestKind.GOAL, **GOAL)
    assert box.box_state() is BoxState.PREPARE, "the robot prepares already, or its next goal follows"
    while box.now.mono - driver.now.mono - 1.0 < SETTLED_S - 0.2:
        robot.says(after=0.1)
        assert BoxState.PREPARE not in box.sent
    robot.says(after=0.5)
    robot.says(after=0.1)
    assert box.sent[-1] is BoxState.PREPARE


@pytest.mark.parametrize("code, state", SAVED)
def test_the_referee_continues_it(code, state):
    driver, robot, modules = saved_in(code, state)
    box = NextBox(driver, code)
    modules.driver = box
    modules.beat()
    box.taken_over(robot).says(RobotState.STOP)
    assert box.view().action("continue").shown
    box.command("continue")
    assert not box.view().warnings
    if state is BoxState.STOP:
        modules.asks(RequestKind.GOAL, **GOAL)
    assert box.sent[-1] is BoxState.PREPARE
    robot.executes()
    robot.says(RobotState.STOP)
    assert box.sent[-1] is BoxState.PREPARE, "the robot's own program was restarted: as in any run"


def test_the_referee_continues_a_run_whose_robot_is_silent():
    driver, robot, _ = saved_in(TASK, BoxState.WAITING_RESULT)
    box = NextBox(driver, TASK)
    box.run(4.0)
    box.command("continue")
    assert box.sent == [BoxState.WAITING_RESULT]
    box.taken_over(robot).says(RobotState.STOP)
    assert box.sent[-1] is BoxState.PREPARE


def test_the_time_of_the_run_counts_while_the_referee_decides_and_that_of_the_goal_does_not():
    driver, robot, modules = saved_in(GOALS, BoxState.WAITING_RESULT)
    box = NextBox(driver, GOALS)
    modules.driver = box
    modules.beat()
    box.taken_over(robot).says(RobotState.STOP)
    left = box.run_in().goal.clock.left(box.now)
    modules.lives(150.0, robot)
    assert modules.outcome() is None
    assert box.run_in().goal.clock.left(box.now) == pytest.approx(left)
    box.command("continue")
    modules.lives(left + 1.0, robot)
    assert modules.outcome().kind is OutcomeKind.TIMED_OUT


def test_the_next_restart_knows_that_the_referee_has_not_decided():
    driver, robot, _ = saved_in(TASK, BoxState.WAITING_RESULT)
    second = NextBox(driver, TASK)
    second.taken_over(robot).says(RobotState.STOP)
    third = NextBox(second, TASK)
    assert STOPPED_ITSELF in third.view().warnings[0]
    third.taken_over(robot).lives(10.0)
    assert set(third.sent) == {BoxState.STOP}


@pytest.mark.parametrize("has_copy", [True, False])
@pytest.mark.parametrize("code, state", SAVED)
def test_a_standby_that_may_have_taken_over_may_have_stopped_the_robot(code, state, has_copy):
    """A robot that hears both boxes obeys both, as the original ones do."""
    driver, robot, _ = saved_in(code, state)
    driver.event(driver.box.copies.report, CopyReport(STANDBY, True, 0.1, 0, ""))
    robot.says(RobotState.PREPARING if state is BoxState.PREPARE else RobotState.EXECUTING)
    robot.lives(REPLACED_S)
    driver.event(driver.box.copies.report, CopyReport(STANDBY, True, 0.1 if has_copy else REPLACED_S, 0, ""))
    robot.says(RobotState.STOP)
    robot.lives(10.0)
    run, = driver.run_in().members()
    asks = not has_copy and state is not BoxState.STOP  # which is this box's own
    assert any(STOPPED_ITSELF in text for text in driver.view().warnings) == asks
    if asks:
        assert run.message.state is BoxState.STOP
        driver.command("continue")
    assert run.message.state is (BoxState.STOP if state is BoxState.STOP else BoxState.PREPARE)
    if asks:
        robot.says(RobotState.PREPARING)
        robot.says(RobotState.STOP)
        assert run.message.state is BoxState.STOP


def test_a_robot_that_was_left_out_does_not_join_the_others_after_a_restart():
    """It may have joined them before, and been stopped with them."""
    driver = BoxDriver(config(ALL))
    first, late = driver.robot(), driver.robot("Beta", "r2", "10.0.0.3")
    first.beacon()
    late.beacon()
    driver.command("connect")
    first.port, late.port = (member.port for member in driver.run_in().members())
    first.says(RobotState.STOP)
    driver.run(4.0)
    first.says()
    driver.command("start")
    assert [member.phase for member in driver.run_in().members()] == [Phase.RUNNING, Phase.CONNECTED]
    box = NextBox(driver, ALL)
    for robot in (first, late):
        box.taken_over(robot).says(RobotState.STOP)
        robot.says()
    assert set(box.sent) == {BoxState.STOP}
    assert len([text for text in box.view().warnings if STOPPED_ITSELF in text]) == 2
    box.command("continue")
    for robot in (first, late):
        robot.says()
    assert [member.message.state for member in box.run_in().members()] == [BoxState.PREPARE] * 2


STOPS = [(UnrecordedStop(Now(MONO0 + 6.0, 0.0), EndReason.STOPPED, By("Anna")), "stopped by the referee"),
         (UnrecordedStop(Now(MONO0 + 6.0, 0.0), EndReason.TIMEOUT), "timeout")]


@pytest.mark.parametrize("code, state, sent", [(*saved, sent[0]) for saved, sent in itertools.product(SAVED, STOPS)])
def test_a_stop_that_was_sent_and_not_recorded_has_ended_the_run(code, state, sent):
    driver, robot, _ = saved_in(code, state)
    sent = sent._replace(at=driver.now.later(0.5))
    box = NextBox(driver, code, stopped={driver.run_in().identity: sent})
    run = box.run_in()
    assert (run.phase, run.end_reason) == (Phase.ENDED, sent.reason)
    assert set(box.sent) == {BoxState.STOP}
    stop, = run.record(box.now).stops
    assert stop.who == sent.by.who and stop.utc == sent.at.utc
    assert code == ALL or "recorded after a restart" in stop.desc
    assert run.record(box.now).elapsed_s == pytest.approx(driver.run_in().clock.elapsed(driver.now) + 0.5)
    box.taken_over(robot).says(RobotState.EXECUTING)
    assert set(box.sent) == {BoxState.STOP}
    assert not any("in doubt" in text for text in box.view().warnings)


def test_a_stop_of_a_run_that_the_journal_shows_as_ended_changes_nothing():
    driver, _, _ = saved_in(TASK, BoxState.WAITING_RESULT)
    driver.command("stop")
    identity = driver.run_in().identity
    box = NextBox(driver, TASK, stopped={identity: UnrecordedStop(driver.now, EndReason.TIMEOUT), "another run": None})
    assert box.run_in().end_reason is EndReason.STOPPED and len(box.run_in().record(box.now).stops) == 1


# -- the time in which the box was away -----------------------------------------------------------------


def test_the_time_in_which_the_box_was_away_is_not_that_of_a_goal_that_ended_meanwhile():
    driver, robot, modules = saved_in(GOALS, BoxState.WAITING_RESULT)
    robot.lives(2.0)
    box = NextBox(driver, GOALS, down=4.5)
    modules.driver = box
    modules.beat()
    box.taken_over(robot).says(RobotState.RESULT_TX)
    assert modules.outcome().executing_s == pytest.approx(2.0, abs=0.01)
    text = ("The box was away for 4.5 s of goal 1. The robot was done meanwhile, so 4.5 s are not counted: the true "
            "time is up to 4.5 s longer. Check it")
    assert text in box.view().state and f"WARNING: {text}" in box.run_in().log
    outage, = box.run_in().record(box.now).outages
    assert (outage.seconds, outage.left_out_s, outage.goal) == (pytest.approx(4.5), pytest.approx(4.5), 1)


def test_a_robot_that_executes_on_needed_the_time_in_which_the_box_was_away():
    driver, robot, modules = saved_in(GOALS, BoxState.WAITING_RESULT)
    robot.lives(2.0)
    box = NextBox(driver, GOALS, down=4.5)
    modules.driver = box
    modules.beat()
    box.taken_over(robot).says()
    robot.lives(1.0)
    robot.says(RobotState.RESULT_TX)
    assert modules.outcome().executing_s == pytest.approx(7.5, abs=0.01)
    outage, = box.run_in().record(box.now).outages
    assert (outage.goal, outage.left_out_s) == (1, 0.0)
    assert "The box was away for 4.5 s of goal 1" in box.view().state


def test_a_goal_that_the_robot_begins_again_counts_from_the_new_request():
    driver, robot, modules = saved_in(GOALS, BoxState.WAITING_RESULT)
    robot.lives(2.0)
    box = NextBox(driver, GOALS, down=4.5)
    modules.driver = box
    modules.beat()
    box.taken_over(robot).lives(3.0, state=RobotState.STOP)
    box.command("continue")
    robot.executes()
    robot.lives(3.0)
    robot.says(RobotState.RESULT_TX)
    assert modules.outcome().executing_s == pytest.approx(3.0, abs=0.01)


@pytest.mark.parametrize("code", [TASK, ALL])
@pytest.mark.parametrize("restarts", [1, 2])
def test_a_task_that_ended_while_the_box_was_away(code, restarts):
    driver, robot, _ = saved_in(code, BoxState.WAITING_RESULT)
    robot.lives(2.0)
    elapsed_s, box = driver.run_in().clock.elapsed(driver.now), driver
    for _ in range(restarts):
        box = NextBox(box, code, down=4.5)
    box.taken_over(robot).says(RobotState.RESULT_TX)
    record = box.run_in().record(box.now)
    assert record.end_reason == "completed" and record.elapsed_s == pytest.approx(elapsed_s, abs=0.01)
    assert [outage.left_out_s for outage in record.outages][-1] == pytest.approx(4.5 * restarts)
    box.command("disconnect")
    finished, = box.box.finished.records()
    assert finished.outages == record.outages
