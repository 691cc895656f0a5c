"""HSUF: all robots at once. One robot's trouble is not the others'; the referee's commands are for all."""

import pytest

from helpers.all_robots import all_robots_box, connect_all, live_all, robots_of, start_all, take_ports
from helpers.competition import event
from roah_rsbb.core import effects, run_log, views
from roah_rsbb.core.effects import Level
from roah_rsbb.core.refused import Refused
from roah_rsbb.core.run import EndReason, Phase
from roah_rsbb.core.settings import Settings
from roah_rsbb.states import BoxState, RobotState

R1, R2, R3 = "r1 of team Alpha", "r2 of team Beta", "r3 of team Gamma"
SKEW = "Clock skew of the robot is +0.500 s, it must be below 0.100 s: synchronise the robot's clock"
NO_ANSWER = "Robot has not answered on the private channel yet"


def _connected(*more, **of_box):
    driver = all_robots_box(*more, **of_box)
    return driver, connect_all(driver, robots_of(driver))


def _running(*more, **of_box):
    driver, robots = _connected(*more, **of_box)
    return driver, start_all(driver, robots)


def _box_states(driver, robots):
    return [driver.box.run_at(robot.port).message.state for robot in robots]


def _ends(driver):
    return [member.end_reason for member in driver.run_in().members()]


def _counts(driver):
    return tuple(driver.run_in().counts())


def _state(driver):
    return driver.view().state.splitlines()


# -- connect ------------------------------------------------------------------------------------------


def test_all_active_robots_get_a_channel_each():
    driver, robots = _connected()
    assert [robot.port for robot in robots] == [6667, 6668, 6669]
    assert driver.box.beacon().robots == (
        ("Alpha", "r1", 6667), ("Beta", "r2", 6668), ("Gamma", "r3", 6669),
    )
    assert driver.channels == {6667: "10.0.0.2", 6668: "10.0.0.3", 6669: "10.0.0.4"}
    assert {message.benchmark for port in driver.channels for message in driver.states[port]} == {"HSUF"}
    assert [run.robot.team for run in driver.box.runs()] == ["Alpha", "Beta", "Gamma"]


def test_one_robot_alone_is_all_robots():
    driver = all_robots_box()
    robot, = start_all(driver, connect_all(driver, robots_of(driver, ["Beta"])))
    robot.completes()
    assert driver.run_in().end_reason is EndReason.COMPLETED


def test_connect_needs_a_robot():
    driver = all_robots_box()
    assert driver.off("connect") == ["No robot is active: no beacon arrives on UDP port 6666"]
    assert _state(driver) == driver.off("connect")


def test_who_could_be_connected_is_shown():
    driver = all_robots_box()
    robots_of(driver)
    assert _state(driver) == [f"3 robots ready to accept connection: {R1}, {R2}, {R3}"]


def test_robots_that_cannot_take_part_are_named_and_keep_nobody_from_it():
    driver = all_robots_box()
    gone = driver.robot("Gamma", "gone", "10.0.0.9")
    gone.beacon()
    driver.run(4.0)
    robots = robots_of(driver)
    driver.command("connect", "other")  # takes r1 of Alpha
    skewed = driver.robot("Beta", "late clock", skew=0.5)
    skewed.beacon()
    stranger = driver.robot("Nobody", "r9")
    stranger.beacon()
    names = [
        f"{R1} cannot take part: it is in a run in zone other",
        f"late clock of team Beta cannot take part: {SKEW}",
        "gone of team Gamma cannot take part: it was not heard for 4 s",
        "r9 of team Nobody cannot take part: its team has no password in the passwords file",
    ]
    assert driver.off("connect") == []
    view = driver.view()
    assert view.warnings == tuple(names)
    assert view.state.splitlines() == [
        f"2 robots ready to accept connection: {R2}, {R3}", *(f"WARNING: {name}" for name in names)
    ]
    driver.command("connect")
    take_ports(driver, [*robots, skewed, gone, stranger])
    assert [robot.port for robot in robots] == [6667, 6668, 6669]
    assert [robot.port for robot in (skewed, gone, stranger)] == [None] * 3
    assert driver.view().warnings == tuple(names)


def test_every_reason_of_a_robot_is_told():
    driver = all_robots_box()
    driver.robot("Nobody", "r9", skew=0.5).beacon()
    driver.run(5.0)
    reason, = driver.off("connect")
    assert reason == (
        "r9 of team Nobody cannot take part: its team has no password in the passwords file; it was not heard for "
        f"5 s; {SKEW}"
    )
    with pytest.raises(Refused, match="has no password"):
        driver.command("connect")
    assert _state(driver) == [reason]  # and not a second time, as a warning
    assert driver.view("other").warnings == ()


def test_while_the_box_listens_nobody_is_connected():
    driver = all_robots_box(listening=True)
    robots_of(driver)
    assert driver.off("connect") == ["The box is still listening for another box, for 5 s"]


def test_a_late_robot_is_named_until_the_start_and_comes_with_the_next_connect():
    driver, robots = _connected()
    late = driver.robot("Gamma", "late", "10.0.0.9")
    late.beacon()
    text = "late of team Gamma is active, but not in this run: disconnect and connect again to have it"
    assert driver.view().warnings == (text,)
    driver.command("start")
    assert driver.view().warnings == ()
    driver.command("stop")
    assert driver.view().warnings == ()
    driver.command("disconnect")
    for robot in robots:
        robot.beacon()
    driver.command("connect")
    assert [r.robot for r in driver.box.beacon().robots] == ["r1", "r2", "late", "r3"]


def test_a_robot_in_it_is_in_no_other_run():
    driver, _ = _connected()
    assert driver.off("connect", "other") == [f"Robot {R1} is in a run in zone tbm"]
    driver.command("disconnect")
    assert driver.off("connect", "other") == []


def test_robots_of_one_team_have_channels_and_logs_of_their_own():
    driver = all_robots_box()
    robots = [driver.robot("Alpha", name, f"10.0.0.{i}") for i, name in enumerate("ab", 2)]
    for robot in robots:
        robot.beacon()
    start_all(driver, connect_all(driver, robots))
    opened = driver.taken(effects.RunOpened)
    assert opened == [
        effects.RunOpened(6667, "Alpha", 1, 1, "a"), effects.RunOpened(6668, "Alpha", 1, 1, "b"),
    ]
    robots[1].says(notifications=("heard it",))
    assert driver.logged(6667, run_log.NOTIFICATION) == []
    assert driver.logged(6668, run_log.NOTIFICATION) == ["heard it"]


def test_other_runs_logs_have_no_robots_name():
    driver = all_robots_box()
    driver.connected("other")
    assert driver.taken(effects.RunOpened) == [effects.RunOpened(6667, "Alpha", 1, 1)]


# -- start --------------------------------------------------------------------------------------------


def test_start_waits_a_moment_for_robots_that_have_not_answered():
    driver = all_robots_box()
    robots = robots_of(driver)
    driver.command("connect")
    take_ports(driver, robots)
    robots[0].says()
    assert driver.off("start") == [f"{R2}: {NO_ANSWER}", f"{R3}: {NO_ANSWER}"]
    assert _state(driver)[-1] == "Robots connected: 3 / ready: 1"
    assert driver.view().all_robots.robots == (
        f"{R1}: ready", f"{R2}: not ready: {NO_ANSWER}", f"{R3}: not ready: {NO_ANSWER}",
    )
    robots[1].says()
    robots[2].says()
    assert driver.off("start") == []
    assert _state(driver) == ["All OK for start", "Robots connected: 3 / ready: 3"]


def test_a_robot_that_never_answers_blocks_nobody():
    driver = all_robots_box()
    robots = robots_of(driver)
    driver.command("connect")
    take_ports(driver, robots)
    live_all(driver, robots[:2], 2)
    assert driver.off("start") == [f"{R3}: {NO_ANSWER}"]
    live_all(driver, robots[:2], 1)
    assert driver.off("start") == []
    warning = f"{R3}: will be left out until it is ready: {NO_ANSWER}"
    assert driver.view().warnings == (warning,)
    assert _state(driver)[-1] == f"WARNING: {warning}"
    driver.command("start")
    assert _box_states(driver, robots) == [BoxState.PREPARE, BoxState.PREPARE, BoxState.STOP]
    warning = f"{R3}: left out until it is ready: {NO_ANSWER}"
    assert driver.view().warnings == (warning,)
    assert warning in driver.notices(Level.WARNING)
    assert driver.run_in().desc == "Started with 2 of 3 robots"


def test_a_robot_that_was_left_out_joins_as_soon_as_it_is_ready():
    driver = all_robots_box()
    robots = robots_of(driver)
    driver.command("connect")
    take_ports(driver, robots)
    live_all(driver, robots[:2], 3)
    driver.command("start")
    robots[2].skew = 0.5
    robots[2].says(RobotState.STOP)
    assert _box_states(driver, robots)[2] is BoxState.STOP
    assert driver.view().warnings == (f"{R3}: left out until it is ready: {SKEW}",)
    robots[2].skew = 0.0
    live_all(driver, robots, 4)
    assert _box_states(driver, robots)[2] is BoxState.PREPARE
    assert driver.view().warnings == ()
    assert f"{R3} is ready now, and joins the run" in driver.notices(Level.INFO)
    for robot in robots:
        robot.executes()
    assert _counts(driver) == (0, 3, 0)
    for robot in robots:
        robot.completes()
    assert driver.run_in().end_reason is EndReason.COMPLETED


def test_who_joins_late_has_the_same_clock():
    driver = all_robots_box(timeout=60.0)
    robots = robots_of(driver)
    driver.command("connect")
    take_ports(driver, robots)
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
    assert _ends(driver) == [EndReason.COMPLETED, EndReason.COMPLETED, EndReason.TIMEOUT]
    assert driver.run_in().end_reason is EndReason.TIMEOUT


def test_a_robot_out_of_skew_blocks_nobody_either():
    driver, robots = _connected()
    robots[1].skew = 0.5
    live_all(driver, robots, 4)
    assert driver.off("start") == []
    warnings = driver.view().warnings
    assert warnings == (f"{R2}: will be left out until it is ready: {SKEW}",)
    driver.command("start")
    assert _box_states(driver, robots) == [BoxState.PREPARE, BoxState.STOP, BoxState.PREPARE]


def test_without_any_robot_that_is_ready_there_is_no_start():
    driver = all_robots_box()
    robots_of(driver)
    driver.command("connect")
    driver.run(10)
    assert driver.off("start") == [f"{name}: {NO_ANSWER}" for name in (R1, R2, R3)]
    driver.event(driver.box.on_unreadable, 6668, "10.0.0.3: wrong password?")
    assert f"{R2}: {NO_ANSWER}; 10.0.0.3: wrong password?" in driver.off("start")


def test_it_is_started_once():
    driver, _ = _running()
    assert driver.off("start") == ["Already started"]


# -- the run ------------------------------------------------------------------------------------------


def test_the_referee_sees_how_many_prepare_execute_and_have_stopped():
    driver, robots = _connected()
    driver.command("start")
    robots[1].executes()
    robots[2].executes()
    robots[2].completes()
    assert _counts(driver) == (1, 1, 1)
    assert "Robots preparing: 1 / executing: 1 / stopped: 1" in _state(driver)
    assert driver.view().all_robots == views.AllRobotsView(6667, (1, 1, 1), (
        f"{R1}: preparing, messages saved: 1", f"{R2}: executing, messages saved: 1",
        f"{R3}: completed, messages saved: 1",
    ))


def test_it_is_complete_with_the_last_robot():
    driver, robots = _running()
    for robot in robots[:2]:
        robot.completes()
        assert driver.run_in().phase is Phase.RUNNING
    live_all(driver, robots, 10)
    assert _box_states(driver, robots) == [BoxState.STOP, BoxState.STOP, BoxState.WAITING_RESULT]
    robots[2].says(RobotState.RESULT_TX)
    run = driver.run_in()
    assert (run.phase, run.end_reason) == (Phase.ENDED, EndReason.COMPLETED)
    assert run.desc == "All robots have ended (3 completed)"
    assert driver.view().log.endswith(" All robots have ended (3 completed)\n")
    assert driver.taken(effects.TimeoutRung) == []


def test_what_one_robot_does_is_told_to_no_other():
    driver, robots = _running()
    before = len(driver.states[robots[1].port])
    robots[0].says(notifications=("hello",))
    robots[0].completes()
    assert len(driver.states[robots[1].port]) == before


def test_one_clock_is_for_all_and_rings_once():
    driver, robots = _running(timeout=120.0)
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
    assert _ends(driver) == [EndReason.COMPLETED, EndReason.TIMEOUT, EndReason.TIMEOUT]
    assert driver.off("start")[0] == "The run ended by timeout: disconnect, and connect for a new run"
    assert driver.view().timer == 120.0  # after_stop_duration
    driver.run(5)
    assert not any("will be left out" in warning for warning in driver.view().warnings)


def test_a_robot_that_dies_ends_nobody_elses_run():
    driver, robots = _running()
    live_all(driver, robots[1:], 20)
    run = driver.run_in()
    assert run.phase is Phase.RUNNING
    assert _counts(driver) == (0, 3, 0)
    assert driver.view().warnings == (f"{R1}: No message from the robot for 20 s",)
    for robot in robots[1:]:
        robot.completes()
    assert run.phase is Phase.RUNNING  # it may come back
    live_all(driver, robots[1:], 110)
    assert run.end_reason is EndReason.TIMEOUT
    assert _ends(driver) == [EndReason.TIMEOUT, EndReason.COMPLETED, EndReason.COMPLETED]


def test_a_robot_that_is_switched_on_again_begins_anew():
    driver, robots = _running()
    live_all(driver, robots[1:], 10)
    robots[0].says(RobotState.STOP)
    assert _box_states(driver, robots) == [BoxState.PREPARE, BoxState.WAITING_RESULT, BoxState.WAITING_RESULT]
    robots[0].executes()
    for robot in robots:
        robot.completes()
    assert driver.run_in().end_reason is EndReason.COMPLETED


def test_a_robot_that_saves_nothing_ends_only_itself():
    driver, robots = _running()
    robots[1].saved = 0
    live_all(driver, robots, 6)
    assert _ends(driver) == [None, EndReason.NO_MESSAGES_SAVED, None]
    assert _box_states(driver, robots) == [BoxState.WAITING_RESULT, BoxState.STOP, BoxState.WAITING_RESULT]
    assert driver.view().warnings == (f"{R2}: {EndReason.NO_MESSAGES_SAVED.value}",)
    robots[1].says(RobotState.STOP)
    assert _box_states(driver, robots)[1] is BoxState.STOP  # it is not started again by itself
    robots[0].completes()
    robots[2].completes()
    run = driver.run_in()
    assert run.end_reason is EndReason.COMPLETED
    assert run.desc == "All robots have ended (2 completed, 1 saved no offline data)"


def test_where_no_robot_saves_anything_nothing_is_completed():
    driver, robots = _running()
    for robot in robots:
        robot.saved = 0
    live_all(driver, robots, 6)
    run = driver.run_in()
    assert run.end_reason is EndReason.NO_MESSAGES_SAVED
    assert run.desc == "Stopped: no robot saves offline data (3 saved no offline data)"
    assert run.phase is Phase.ENDED


def test_of_saving_and_timeout_the_first_that_was_due_counts():
    driver, robots = _running(timeout=20.0)
    robots[0].saved = 0
    live_all(driver, robots, 4)  # then nobody ticks the box until long after both
    driver.jump(60)
    driver.event(driver.box.tick)
    assert _ends(driver) == [EndReason.NO_MESSAGES_SAVED, EndReason.TIMEOUT, EndReason.TIMEOUT]
    assert driver.run_in().end_reason is EndReason.TIMEOUT


def test_a_robot_left_out_does_not_keep_the_run_from_its_end():
    driver = all_robots_box()
    robots = robots_of(driver)
    driver.command("connect")
    take_ports(driver, robots)
    live_all(driver, robots[:2], 4)
    driver.command("start")
    for robot in robots[:2]:
        robot.executes()
        robot.completes()
    assert driver.run_in().end_reason is EndReason.COMPLETED
    robots[2].says(RobotState.STOP)
    assert _box_states(driver, robots) == [BoxState.STOP] * 3


@pytest.mark.parametrize("reached", [None, *RobotState])
def test_stop_ends_all_in_every_state(reached):
    driver, robots = _connected()
    driver.command("start")
    path = [RobotState.PREPARING, RobotState.WAITING_GOAL, RobotState.EXECUTING, RobotState.RESULT_TX]
    for state in path[:path.index(reached) + 1] if reached in path else []:
        robots[0].says(state)
    robots[1].executes()
    driver.command("stop")
    run = driver.run_in()
    assert (run.phase, run.end_reason) == (Phase.ENDED, EndReason.STOPPED)
    assert _box_states(driver, robots) == [BoxState.STOP] * 3
    assert {driver.states[robot.port][-1].state for robot in robots} == {BoxState.STOP}
    completed = reached is RobotState.RESULT_TX
    assert run.desc == "Benchmark stopped by the referee (" + (
        "1 completed, 2 stopped by the referee)" if completed else "3 stopped by the referee)"
    )
    driver.command("stop")
    assert driver.run_in() is None


def test_after_a_stop_all_start_again_and_the_clock_went_on():
    driver, robots = _running(timeout=120.0)
    deadline = driver.run_in().clock.deadline()
    robots[2].completes()
    driver.command("stop")
    assert driver.off("start") == [
        f"{name}: Robot has not stopped yet: it reports EXECUTING" for name in (R1, R2)
    ]
    for robot in robots:
        robot.says(RobotState.STOP)
    live_all(driver, robots, 10)
    assert "May be started again: its time went on" in _state(driver)
    start_all(driver, robots)
    run = driver.run_in()
    assert (run.phase, run.end_reason, _ends(driver)) == (Phase.RUNNING, None, [None] * 3)
    assert run.clock.deadline() == deadline
    assert _counts(driver) == (0, 3, 0)


def test_a_robot_that_does_not_stop_blocks_the_next_start_only_for_a_moment():
    driver, robots = _running()
    live_all(driver, robots, 10)
    driver.command("stop")
    robots[0].says(RobotState.STOP)
    robots[1].says(RobotState.STOP)
    live_all(driver, robots, 2)
    assert driver.off("start") == [f"{R3}: Robot has not stopped yet: it reports EXECUTING"]
    assert driver.view().warnings == ()
    live_all(driver, robots, 1)
    assert driver.off("start") == []
    assert driver.view().warnings == (
        f"{R3}: will be left out until it is ready: Robot has not stopped yet: it reports EXECUTING",
    )
    driver.command("start")
    assert _box_states(driver, robots) == [BoxState.PREPARE, BoxState.PREPARE, BoxState.STOP]
    assert [m.end_reason for m in driver.run_in().members()] == [None] * 3
    robots[2].says(RobotState.STOP)
    assert _box_states(driver, robots) == [BoxState.PREPARE] * 3


def test_time_that_is_up_after_a_stop_is_up():
    driver, robots = _running(timeout=60.0)
    driver.command("stop")
    for robot in robots:
        robot.says(RobotState.STOP)
    live_all(driver, robots, 61)
    assert driver.off("start") == [
        "The run's time is up (it went on after the stop): disconnect, and connect for a new run"
    ]


def test_disconnect_closes_all_channels_without_a_last_message():
    driver, robots = _running()
    driver.taken()
    run = driver.run_in()
    driver.command("disconnect")
    assert (run.phase, run.end_reason) == (Phase.ENDED, EndReason.STOPPED)
    taken = driver.taken()
    assert not any(isinstance(effect, effects.SendState) for effect in taken)
    assert [e.port for e in taken if isinstance(e, effects.CloseChannel)] == [6667, 6668, 6669]
    assert [e.port for e in taken if isinstance(e, effects.RunClosed)] == [6667, 6668, 6669]
    assert driver.box.beacon().robots == ()
    assert (driver.channels, driver.run_in(), driver.box.deadline()) == ({}, None, None)
    assert "Disconnected" in driver.view().log  # of the last run


def test_after_a_completed_run_the_next_event_follows():
    driver, robots = _running(event("HWV"))
    for robot in robots:
        robot.completes()
    driver.command("disconnect")
    assert driver.view().event.benchmark.code == "HWV"


@pytest.mark.parametrize("command", ["stop", "disconnect"])
def test_after_any_other_end_it_does_not(command):
    driver, robots = _running(event("HWV"))
    robots[0].completes()
    driver.command(command)
    if command == "stop":
        driver.command("disconnect")
    assert driver.view().event.benchmark.code == "HSUF"


# -- what is shown and logged -------------------------------------------------------------------------


def test_log_and_online_data_of_all_are_shown_with_the_robots_names():
    driver, robots = _running()
    robots[0].says(notifications=("one",))
    robots[2].says(notifications=("three",))
    view = driver.view()
    assert [line.split(" ", 1)[1] for line in view.online_data.splitlines()] == [
        f"{R1}: notifications: one", f"{R3}: notifications: three",
    ]
    assert f"{R2}: WAITING_RESULT: Robot prepared, executing" in view.log
    assert view.log.count("Started with 3 of 3 robots") == 1


def test_notices_name_robot_and_zone():
    driver, robots = _running()
    driver.taken()
    driver.run(4)
    notices = driver.taken(effects.Notice)
    assert {(n.text, n.zone) for n in notices} == {
        (f"{name}: No message from the robot for 3 s", "tbm") for name in (R1, R2, R3)
    }


def test_the_score_sheet_is_the_runs_and_every_robots_log_has_it():
    scored = event("HSUF", team="ALL", timeout=120.0)
    driver, robots = _connected(scored)
    driver.command("disconnect")
    driver.command("next")
    connect_all(driver, robots_of(driver))
    driver.score("Penalized", "bumps", 2)
    assert [(item.desc, value) for item, value in driver.view().scoring[1].items] == [("bumps", 2)]
    ports = [run.port for run in driver.box.runs()]
    assert [driver.logged(port, run_log.SCORE) for port in ports] == [[("Penalized", "bumps", 2)]] * 3
    assert driver.view().log.count("Score: Penalized: bumps 0 -> 2") == 1
    with pytest.raises(Refused, match="no scoring group"):
        driver.score("Nothing", "bumps", 2)


def test_device_commands_are_ignored_and_said_once_a_robot():
    driver, robots = _running()
    driver.taken()
    for _ in range(3):
        robots[1].says(switch_1=True)
    warnings = driver.notices(Level.WARNING)
    assert len(warnings) == 1
    assert warnings[0].startswith(R2)


def test_manual_operations_and_switches_are_refused():
    driver, _ = _running()
    with pytest.raises(Refused, match="no manual operation is asked for in zone 'tbm'"):
        driver.event(driver.box.manual_operation_complete, "tbm")
    with pytest.raises(Refused, match="only HOMF has switches"):
        driver.event(driver.box.omf_complete, "tbm")


def test_a_step_of_the_boxs_clock_measures_all_skews_anew():
    driver, robots = _connected()
    driver.set_clock(100)
    driver.event(driver.box.tick)
    assert all(member.link.skew is None for member in driver.run_in().members())
    for robot in robots:
        robot.says()
    assert driver.off("start") == []


def test_robots_in_it_stay_active():
    driver, robots = _running()
    live_all(driver, robots, 40)
    assert [view.robot for view in views.robots(driver.box, driver.now)] == ["r1", "r2", "r3"]


def test_it_is_in_the_publics_schedule():
    driver, _ = _connected()
    assert [line.running for line in views.schedule(driver.box)] == [True, False]


# -- room ---------------------------------------------------------------------------------------------


THIRTY = [f"Team{i:02}" for i in range(30)]


def test_thirty_robots_run_at_once():
    driver = all_robots_box(teams=["Alpha", *THIRTY], settings=Settings(max_datagram=2000))
    robots = start_all(driver, connect_all(driver, robots_of(driver, THIRTY)))
    assert _counts(driver) == (0, 30, 0)
    live_all(driver, robots[5:], 20)  # five die
    for robot in robots[5:]:
        robot.completes()
    assert _counts(driver) == (0, 5, 25)
    assert len(driver.view().warnings) == 5
    driver.command("stop")
    assert driver.run_in().desc == "Benchmark stopped by the referee (25 completed, 5 stopped by the referee)"
    driver.command("disconnect")
    assert driver.channels == {}


def test_robots_that_the_beacon_has_no_room_for_refuse_connect_with_how_many_fit():
    driver = all_robots_box(teams=["Alpha", *THIRTY])
    robots = robots_of(driver, THIRTY)
    assert driver.off("connect") == [
        f"The beacon may need {100 + 32 * 30} bytes with 30 more robots, and robots may read only 1024: leave only "
        f"{(1024 - 100) // 32} of them switched on, or raise max_datagram if all robots are known to read more"
    ]
    driver.run(31)
    for robot in robots[:28]:
        robot.beacon()
    connect_all(driver, robots[:28])
    assert len(driver.box.runs()) == 28
    driver.robot("Alpha", "r0").beacon()
    assert driver.off("connect", "other")[0].startswith("The beacon may need")


@pytest.mark.parametrize("bytes_left, fit", [(-1, 2), (0, 3), (1, 3), (-32, 2), (-33, 1), (-64, 1), (-65, 0)])
def test_the_beacons_room_is_used_to_the_last_byte(bytes_left, fit):
    driver = all_robots_box(settings=Settings(max_datagram=100 + 32 * 3 + bytes_left))
    robots_of(driver)
    if fit == 3:
        assert driver.off("connect") == []
        return
    reason, = driver.off("connect")
    remedy = f"leave only {fit} of them switched on" if fit else "end another run first"
    assert f": {remedy}, or raise max_datagram" in reason


def test_robots_of_other_runs_take_room_too():
    driver = all_robots_box(teams=["Alpha", *THIRTY])
    driver.connected("other")
    robots_of(driver, THIRTY[:28])
    reason, = driver.off("connect")
    assert "leave only 27 of them switched on, end another run first, or raise max_datagram" in reason


def test_one_port_is_not_enough_for_two():
    driver = all_robots_box(last_port=65534)
    robots_of(driver, ["Alpha", "Beta"])
    reason, = driver.off("connect")
    assert reason.startswith("All UDP ports up to 65535 but 1 are used up, and 2 robots need one each")


def test_every_robot_needs_a_port():
    driver = all_robots_box(last_port=65533)
    robots = robots_of(driver)
    reason, = driver.off("connect")
    assert reason.startswith("All UDP ports up to 65535 but 2 are used up, and 3 robots need one each: start the box")
    driver.run(31)
    robots[0].beacon()
    robots[1].beacon()
    connect_all(driver, robots[:2])
    assert [robot.port for robot in robots[:2]] == [65534, 65535]


def test_a_channel_that_cannot_be_opened_for_one_robot_takes_the_next_port():
    driver = all_robots_box()
    driver.unusable_ports = {6668}
    robots = start_all(driver, connect_all(driver, robots_of(driver)))
    assert [robot.port for robot in robots] == [6667, 6670, 6669]
    assert _counts(driver) == (0, 3, 0)
    assert set(driver.channels) == {6667, 6669, 6670}


def test_a_robot_without_a_channel_does_not_take_part_and_the_others_do():
    driver = all_robots_box(last_port=65532)
    driver.unusable_ports = {65534}
    robots = connect_all(driver, robots_of(driver))
    assert [robot.port for robot in robots] == [65533, None, 65535]
    assert f"No private channel could be opened: {R2} does not take part" in driver.notices(Level.ERROR)
    assert driver.view().warnings == (f"{R2} is active, but not in this run: disconnect and connect again to have it",)
    start_all(driver, [robots[0], robots[2]])
    assert _counts(driver) == (0, 2, 0)


def test_where_no_channel_can_be_opened_the_run_is_not_begun():
    driver = all_robots_box()
    driver.unusable_ports = set(range(6667, 8000))
    robots_of(driver)
    driver.command("connect")
    assert driver.run_in() is None
    taken = driver.taken()
    tried = [e.port for e in taken if isinstance(e, effects.OpenChannel)]
    assert tried == list(range(6667, 6667 + len(tried)))
    assert 20 <= len(tried) <= 30
    errors = [e.text for e in taken if isinstance(e, effects.Notice) and e.level is Level.ERROR]
    assert errors[-1] == "No private channel could be opened: the run was not begun"
    assert driver.box.beacon().robots == ()
    assert driver.view().phase == "idle"
