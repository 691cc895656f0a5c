"""The times of a run."""

import pytest

from roah_rsbb.core.runs.times import RunCountdown, SavingWatch
from roah_rsbb.core.settings import Settings
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.protocol import BoxState, RobotState


def at(mono):
    return Now(mono, 0.0)


def test_a_run_counts_from_its_start():
    clock = RunCountdown(timeout=600.0, after_stop=120.0)
    assert clock.shown(at(50.0), ended=False) == 600.0
    assert clock.deadline() is None
    assert not clock.is_over(at(1e9))
    clock.start(at(100.0))
    assert clock.deadline() == 700.0
    assert clock.shown(at(150.0), ended=False) == 550.0
    assert not clock.is_over(at(699.999))
    assert clock.is_over(at(700.0))
    assert clock.shown(at(800.0), ended=False) == 0.0


def test_stopped_time_counts():
    clock = RunCountdown(timeout=600.0, after_stop=120.0)
    clock.start(at(100.0))
    clock.stop(at(200.0))
    clock.start(at(300.0))
    assert clock.deadline() == 700.0
    assert clock.shown(at(300.0), ended=False) == 400.0
    clock.stop(at(400.0))
    assert clock.is_over(at(700.0))


def test_after_a_stop_the_time_after_the_stop_is_left():
    clock = RunCountdown(timeout=600.0, after_stop=120.0)
    clock.start(at(100.0))
    clock.stop(at(200.0))
    assert clock.shown(at(200.0), ended=True) == 120.0
    assert clock.shown(at(250.0), ended=True) == 70.0
    assert clock.shown(at(400.0), ended=True) == 0.0


def _report(saved, state=RobotState.EXECUTING):
    return RobotReport((0, 0), saved, state)


@pytest.fixture
def watch():
    return SavingWatch(Settings(check_messages_saved_timeout=5.0))


def test_a_robot_that_executes_and_saves_nothing(watch):
    watch.see(at(10.0), BoxState.WAITING_RESULT, _report(0))
    watch.see(at(14.0), BoxState.WAITING_RESULT, _report(0))
    assert watch.deadline() == 15.0
    assert not watch.is_over(at(14.999))
    assert watch.is_over(at(15.0))


def test_a_robot_that_saves_in_time(watch):
    watch.see(at(10.0), BoxState.WAITING_RESULT, _report(0))
    watch.see(at(14.9), BoxState.WAITING_RESULT, _report(1))
    assert watch.deadline() is None
    assert not watch.is_over(at(1000.0))


@pytest.mark.parametrize("box, robot", [
    (box, robot) for box in BoxState for robot in RobotState
    if (box, robot) != (BoxState.WAITING_RESULT, RobotState.EXECUTING)
])
def test_only_executing_counts(watch, box, robot):
    watch.see(at(10.0), BoxState.WAITING_RESULT, _report(0))
    watch.see(at(11.0), box, _report(0, robot))
    assert watch.deadline() is None


def test_a_robot_that_executes_again_is_watched_again(watch):
    watch.see(at(10.0), BoxState.WAITING_RESULT, _report(0))
    watch.see(at(12.0), BoxState.STOP, _report(0))
    watch.see(at(20.0), BoxState.WAITING_RESULT, _report(0))
    assert watch.deadline() == 25.0


def test_the_check_can_be_switched_off():
    watch = SavingWatch(Settings(check_messages_saved=False))
    watch.see(at(10.0), BoxState.WAITING_RESULT, _report(0))
    assert watch.deadline() is None
    assert not watch.is_over(at(1000.0))
