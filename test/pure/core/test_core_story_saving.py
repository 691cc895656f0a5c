"""A robot must save offline data while it executes (docs/protocol.md, "Timing")."""

import pytest

from helpers.box_driver import BoxDriver, ended
from helpers.competition import competition, event
from roah_rsbb.core import effects
from roah_rsbb.core.settings import Settings
from roah_rsbb.model.records import EndReason
from roah_rsbb.protocol import BoxState, RobotState


def _executing(saved=0, settings=None, config=None):
    driver = BoxDriver(config, settings)
    robot = driver.connected()
    robot.saved = saved
    driver.command("start")
    robot.executes()
    return driver, robot


def test_a_robot_that_saves_nothing_is_stopped():
    driver, robot = _executing()
    driver.run(4.99)
    assert ended(driver) is None
    driver.run(0.01)
    assert ended(driver) is EndReason.NO_MESSAGES_SAVED
    assert driver.states[robot.port][-1].state is BoxState.STOP
    assert driver.taken(effects.TimeoutRung) == []
    assert "saves no offline data" in driver.view().state


def test_a_robot_that_saves_nothing_is_stopped_also_while_it_talks():
    driver, robot = _executing()
    for _ in range(49):
        robot.says(after=0.1)
    assert ended(driver) is None
    robot.says(after=0.1)
    assert ended(driver) is EndReason.NO_MESSAGES_SAVED


def test_a_robot_that_saves_in_time_continues():
    driver, robot = _executing()
    robot.lives(4)
    robot.saved = 1
    robot.says(after=0.9)
    robot.lives(60)
    assert ended(driver) is None


def test_a_count_that_stays_above_0_is_enough():
    driver, robot = _executing(saved=1)
    robot.lives(60)
    assert ended(driver) is None


@pytest.mark.parametrize("state", [RobotState.PREPARING, RobotState.STOP, RobotState.EXECUTING])
def test_only_a_robot_that_executes_must_save(state):
    driver = BoxDriver()
    robot = driver.connected()
    robot.saved = 0
    robot.lives(20)
    driver.command("start")
    for _ in range(20):
        robot.says(state, after=1.0)
    assert ended(driver) is None


def test_the_check_can_be_switched_off():
    driver, robot = _executing(settings=Settings(check_messages_saved=False))
    robot.lives(60)
    assert ended(driver) is None


def test_its_timeout_is_a_setting():
    driver, robot = _executing(settings=Settings(check_messages_saved_timeout=20.0))
    robot.lives(19)
    assert ended(driver) is None
    robot.lives(2)
    assert ended(driver) is EndReason.NO_MESSAGES_SAVED


def test_the_referee_may_start_again_and_the_watch_restarts():
    driver, robot = _executing()
    driver.run(5)
    robot.says(RobotState.STOP)
    driver.command("start")
    robot.executes()
    driver.run(4.9)
    assert ended(driver) is None
    driver.run(0.1)
    assert ended(driver) is EndReason.NO_MESSAGES_SAVED
    robot.says(RobotState.STOP)
    driver.command("start")
    robot.saved = 1
    robot.executes()
    robot.completes()
    assert ended(driver) is EndReason.COMPLETED


def test_the_time_in_which_a_robot_falls_back_does_not_count():
    driver, robot = _executing()
    driver.run(4)
    robot.says(RobotState.STOP)
    robot.executes()
    driver.run(4)
    assert ended(driver) is None


@pytest.mark.parametrize("timeout, reason", [
    (5.5, EndReason.NO_MESSAGES_SAVED), (4.5, EndReason.TIMEOUT),
])
def test_of_two_time_outs_the_first_counts_even_if_the_box_was_ticked_late(timeout, reason):
    driver, _ = _executing(config=competition(tbm=[event(timeout=timeout)]))
    driver.jump(100)
    driver.event(driver.box.tick)
    assert ended(driver) is reason
    assert bool(driver.taken(effects.TimeoutRung)) is (reason is EndReason.TIMEOUT)


def test_the_count_is_shown():
    driver, robot = _executing(saved=7)
    assert "Messages saved: 7" in driver.view().state
    robot.says(messages_saved=2**32 - 1)
    assert f"Messages saved: {2**32 - 1}" in driver.view().state
