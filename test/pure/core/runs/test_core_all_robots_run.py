"""HSUF: start, one robot's trouble that is not the others', and the end."""

import pytest

from helpers.all_robots import (
    NO_ANSWER,
    R1,
    R2,
    R3,
    SKEW,
    all_robots_box,
    box_states,
    connected,
    counts,
    ends,
    listed,
    live_all,
    robots_of,
    running,
    start_all,
    state_lines,
)
from roah_rsbb.core import effects
from roah_rsbb.core.effects import Level
from roah_rsbb.core.runs.all_robots import SETTLE_S
from roah_rsbb.core.runs.run import IGNORES_STOP
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.model.zone import AllRobots
from roah_rsbb.protocol import BoxState, RobotState

# -- start --------------------------------------------------------------------------------------------


def test_start_waits_a_moment_for_robots_that_have_not_answered():
    driver = all_robots_box()
    robots = listed(driver, robots_of(driver))
    robots[0].says()
    assert driver.off("start") == [f"{R2}: {NO_ANSWER}", f"{R3}: {NO_ANSWER}"]
    assert state_lines(driver)[-1] == "Robots connected: 3 / ready: 1"
    assert driver.view().all_robots.robots == (
        f"{R1}: ready", f"{R2}: not ready: {NO_ANSWER}", f"{R3}: not ready: {NO_ANSWER}",
    )
    robots[1].says()
    robots[2].says()
    assert driver.off("start") == []
    assert state_lines(driver) == ["All OK for start", "Robots connected: 3 / ready: 3"]


def test_a_robot_that_never_answers_blocks_nobody():
    driver = all_robots_box()
    robots = listed(driver, robots_of(driver))
    live_all(driver, robots[:2], 2)
    assert driver.off("start") == [f"{R3}: {NO_ANSWER}"]
    live_all(driver, robots[:2], 1)
    assert driver.off("start") == []
    warning = f"{R3}: will be left out until it is ready: {NO_ANSWER}"
    assert driver.view().warnings == (warning,)
    assert state_lines(driver)[-1] == f"WARNING: {warning}"
    driver.command("start")
    assert box_states(driver, robots) == [BoxState.PREPARE, BoxState.PREPARE, BoxState.STOP]
    warning = f"{R3}: left out until it is ready: {NO_ANSWER}"
    assert driver.view().warnings == (warning,)
    assert warning in driver.notices(Level.WARNING)
    assert driver.run_in().desc == "Started with 2 of 3 robots"


def test_a_robot_that_was_left_out_joins_as_soon_as_it_is_ready():
    driver = all_robots_box()
    robots = listed(driver, robots_of(driver))
    live_all(driver, robots[:2], 3)
    driver.command("start")
    robots[2].skew = 0.5
    robots[2].says(RobotState.STOP)
    assert box_states(driver, robots)[2] is BoxState.STOP
    assert driver.view().warnings == (f"{R3}: left out until it is ready: {SKEW}",)
    robots[2].skew = 0.0
    live_all(driver, robots, 4)
    assert box_states(driver, robots)[2] is BoxState.PREPARE
    assert driver.view().warnings == ()
    assert f"{R3} is ready now, and joins the run" in driver.notices(Level.INFO)
    for robot in robots:
        robot.executes()
    assert counts(driver) == (0, 3, 0)
    for robot in robots:
        robot.completes()
    assert driver.run_in().end_reason is EndReason.COMPLETED


def test_a_robot_that_joins_late_has_the_same_clock():
    driver = all_robots_box(timeout=60.0)
    robots = listed(driver, robots_of(driver))
    live_all(driver, robots[:2], 4)
    driver.command("start")
    deadline = driver.run_in().clock.deadline()
    live_all(driver, robots[:2], 30)
    robots[2].says(RobotState.STOP)
    for robot in robots:
        robot.executes()
    for robot in robots[:2]:
        robot.completes()
    driver.run(deadline - driver.now.mono)
    assert ends(driver) == [EndReason.COMPLETED, EndReason.COMPLETED, EndReason.TIMEOUT]
    assert driver.run_in().end_reason is EndReason.TIMEOUT


def test_without_a_ready_robot_the_run_does_not_start():
    driver = all_robots_box()
    robots_of(driver)
    driver.command("connect")
    driver.run(10)
    assert driver.off("start") == [f"{name}: {NO_ANSWER}" for name in (R1, R2, R3)]
    driver.event(driver.box.arrivals.on_unreadable, 6668, "10.0.0.3: wrong password?")
    assert f"{R2}: {NO_ANSWER}; 10.0.0.3: wrong password?" in driver.off("start")


# -- the run ------------------------------------------------------------------------------------------


def test_the_referee_sees_how_many_prepare_execute_and_have_stopped():
    driver, robots = connected()
    driver.command("start")
    robots[1].executes()
    robots[2].executes()
    robots[2].completes()
    assert counts(driver) == (1, 1, 1)
    assert "Robots preparing: 1 / executing: 1 / stopped: 1" in state_lines(driver)
    assert driver.view().all_robots == AllRobots(6667, 1, 1, 1, (
        f"{R1}: preparing, messages saved: 1", f"{R2}: executing, messages saved: 1",
        f"{R3}: completed, messages saved: 1",
    ))


def test_it_is_complete_with_the_last_robot():
    driver, robots = running()
    for robot in robots[:2]:
        robot.completes()
        assert driver.run_in().phase is Phase.RUNNING
    live_all(driver, robots, 10)
    assert box_states(driver, robots) == [BoxState.STOP, BoxState.STOP, BoxState.WAITING_RESULT]
    robots[2].says(RobotState.RESULT_TX)
    run = driver.run_in()
    assert (run.phase, run.end_reason) == (Phase.ENDED, EndReason.COMPLETED)
    assert run.desc == "All robots have ended (3 completed)"
    assert driver.view().log.endswith(" All robots have ended (3 completed)\n")
    assert driver.taken(effects.TimeoutRung) == []


def test_the_state_of_one_robot_is_sent_to_no_other():
    driver, robots = running()
    before = len(driver.states[robots[1].port])
    robots[0].says(notifications=("hello",))
    robots[0].completes()
    assert len(driver.states[robots[1].port]) == before


def test_one_clock_is_for_all_and_rings_once():
    driver, robots = running(timeout=120.0)
    started = driver.run_in().clock.deadline() - 120.0
    robots[0].completes()
    live_all(driver, robots, 60)
    assert driver.view().timer == pytest.approx(120.0 - (driver.now.mono - started))
    driver.run(started + 120.0 - driver.now.mono - 1e-6)
    assert driver.run_in().phase is Phase.RUNNING
    driver.taken()
    driver.run(1e-6)
    run = driver.run_in()
    assert (run.phase, run.end_reason) == (Phase.ENDED, EndReason.TIMEOUT)
    assert run.desc == "Stopped due to timeout (1 completed, 2 out of time)"
    assert driver.taken(effects.TimeoutRung) == [effects.TimeoutRung("tbm")]
    assert ends(driver) == [EndReason.COMPLETED, EndReason.TIMEOUT, EndReason.TIMEOUT]
    assert driver.off("start")[0] == "The run ended by timeout: disconnect, and connect for a new run"
    assert driver.view().timer == 120.0  # after_stop_duration
    driver.run(5)
    assert not any("will be left out" in warning for warning in driver.view().warnings)


def test_a_robot_that_dies_does_not_end_the_run_of_the_others():
    driver, robots = running()
    live_all(driver, robots[1:], 20)
    run = driver.run_in()
    assert run.phase is Phase.RUNNING
    assert counts(driver) == (0, 3, 0)
    assert driver.view().warnings == (
        f"{R1}: The robot has disappeared: no message for 20 s, and no beacon from its address. It may still be "
        "moving, and STOP may not reach it: check it",)
    for robot in robots[1:]:
        robot.completes()
    assert run.phase is Phase.RUNNING  # it may come back
    live_all(driver, robots[1:], 110)
    assert run.end_reason is EndReason.TIMEOUT
    assert ends(driver) == [EndReason.TIMEOUT, EndReason.COMPLETED, EndReason.COMPLETED]


def test_a_robot_that_saves_nothing_ends_only_itself():
    driver, robots = running()
    robots[1].saved = 0
    live_all(driver, robots, 6)
    assert ends(driver) == [None, EndReason.NO_MESSAGES_SAVED, None]
    assert box_states(driver, robots) == [BoxState.WAITING_RESULT, BoxState.STOP, BoxState.WAITING_RESULT]
    assert driver.view().warnings == (f"{R2}: {EndReason.NO_MESSAGES_SAVED.value}",)
    robots[1].says(RobotState.STOP)
    assert box_states(driver, robots)[1] is BoxState.STOP  # it is not started again by itself
    robots[0].completes()
    robots[2].completes()
    run = driver.run_in()
    assert run.end_reason is EndReason.COMPLETED
    assert run.desc == "All robots have ended (2 completed, 1 saved no offline data)"


def test_where_no_robot_saves_anything_nothing_is_completed():
    driver, robots = running()
    for robot in robots:
        robot.saved = 0
    live_all(driver, robots, 6)
    run = driver.run_in()
    assert run.end_reason is EndReason.NO_MESSAGES_SAVED
    assert run.desc == "Stopped: no robot saves offline data (3 saved no offline data)"
    assert run.phase is Phase.ENDED


def test_of_saving_and_timeout_the_first_that_was_due_counts():
    driver, robots = running(timeout=20.0)
    robots[0].saved = 0
    live_all(driver, robots, 4)  # then nobody ticks the box until long after both
    driver.jump(60)
    driver.event(driver.box.timers.tick)
    assert ends(driver) == [EndReason.NO_MESSAGES_SAVED, EndReason.TIMEOUT, EndReason.TIMEOUT]
    assert driver.run_in().end_reason is EndReason.TIMEOUT


@pytest.mark.parametrize("reached", [None, *RobotState])
def test_stop_ends_all_in_every_state(reached):
    driver, robots = connected()
    driver.command("start")
    path = [RobotState.PREPARING, RobotState.WAITING_GOAL, RobotState.EXECUTING, RobotState.RESULT_TX]
    for state in path[:path.index(reached) + 1] if reached in path else []:
        robots[0].says(state)
    robots[1].executes()
    driver.command("stop")
    run = driver.run_in()
    assert (run.phase, run.end_reason) == (Phase.ENDED, EndReason.STOPPED)
    assert box_states(driver, robots) == [BoxState.STOP] * 3
    assert {driver.states[robot.port][-1].state for robot in robots} == {BoxState.STOP}
    completed = reached is RobotState.RESULT_TX
    assert run.desc == "Benchmark stopped by the referee (" + (
        "1 completed, 2 stopped by the referee)" if completed else "3 stopped by the referee)"
    )
    driver.command("stop")
    assert driver.run_in() is run


def test_after_a_stop_all_start_again_and_the_clock_kept_running():
    driver, robots = running(timeout=120.0)
    deadline = driver.run_in().clock.deadline()
    robots[2].completes()
    driver.command("stop")
    assert driver.off("start") == [
        f"{name}: Robot has not stopped yet: it reports EXECUTING" for name in (R1, R2)
    ]
    for robot in robots:
        robot.says(RobotState.STOP)
    live_all(driver, robots, 10)
    assert "Can be restarted. The clock kept running" in state_lines(driver)
    start_all(driver, robots)
    run = driver.run_in()
    assert (run.phase, run.end_reason, ends(driver)) == (Phase.RUNNING, None, [None] * 3)
    assert run.clock.deadline() == deadline
    assert counts(driver) == (0, 3, 0)


def test_a_robot_that_does_not_stop_blocks_the_next_start_only_for_a_moment():
    driver, robots = running()
    live_all(driver, robots, 10)
    driver.command("stop")
    robots[0].says(RobotState.STOP)
    robots[1].says(RobotState.STOP)
    live_all(driver, robots, 2)
    assert driver.off("start") == [f"{R3}: Robot has not stopped yet: it reports EXECUTING"]
    ignored = f"{R3}: {IGNORES_STOP}"
    assert driver.view().warnings == (ignored,)
    live_all(driver, robots, 1)
    assert driver.off("start") == []
    assert driver.view().warnings == (
        ignored, f"{R3}: will be left out until it is ready: Robot has not stopped yet: it reports EXECUTING",
    )
    driver.command("start")
    assert box_states(driver, robots) == [BoxState.PREPARE, BoxState.PREPARE, BoxState.STOP]
    assert [m.end_reason for m in driver.run_in().members()] == [None] * 3
    robots[2].says(RobotState.STOP)
    assert box_states(driver, robots) == [BoxState.PREPARE] * 3


def test_the_box_is_looked_at_when_the_robots_have_had_their_time_to_stop():
    """What is against a start changes then, and whoever shows it looks after each tick."""
    driver, robots = running()
    driver.command("stop")
    due = driver.now.mono + SETTLE_S
    driver.run(2.0)
    for robot in robots:
        robot.says()
    assert driver.box.timers.deadline() == due


def test_disconnect_stops_all_robots_and_closes_all_channels():
    driver, robots = running()
    driver.taken()
    run = driver.run_in()
    driver.command("disconnect")
    assert (run.phase, run.end_reason) == (Phase.ENDED, EndReason.STOPPED)
    taken = driver.taken()
    assert [e.port for e in taken if isinstance(e, effects.SendState)] == [6667, 6668, 6669]
    assert [e.port for e in taken if isinstance(e, effects.CloseChannel)] == [6667, 6668, 6669]
    assert [e.port for e in taken if isinstance(e, effects.RunClosed)] == [6667, 6668, 6669]
    assert driver.box.beacon().robots == ()
    assert (driver.channels, driver.run_in(), driver.box.timers.deadline()) == ({}, None, None)
    assert "Disconnected" in driver.view().log  # of the last run
