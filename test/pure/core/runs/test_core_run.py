"""Runs as a referee would describe them: start, stop, restart, timeout, completion, saved offline data."""

import pytest

from helpers.box_driver import BoxDriver, ended
from helpers.competition import competition, event
from roah_rsbb.core import effects
from roah_rsbb.core.effects import Level
from roah_rsbb.core.settings import Settings
from roah_rsbb.model import run_log
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState


def _minute(settings=None):
    """A box whose run may take 60 s."""
    return BoxDriver(competition(tbm=[event(timeout=60.0), event("HWV", timeout=60.0)]), settings)


@pytest.mark.parametrize("code", ["HGTKMH", "HWV", "HCFGAC"])
def test_a_whole_task_benchmark(code):
    driver = BoxDriver(competition(tbm=[code]))
    robot = driver.robot()
    robot.beacon(3)
    driver.command("connect")
    robot.port = driver.run_in().port
    robot.lives(3)
    assert driver.run_in().phase is Phase.CONNECTED
    driver.command("start")
    robot.executes()
    robot.lives(100)
    assert driver.run_in().phase is Phase.RUNNING
    robot.completes()
    assert ended(driver) is EndReason.COMPLETED
    assert driver.taken(effects.TimeoutRung) == []
    driver.command("disconnect")
    assert driver.run_in() is None
    assert driver.logged(robot.port, run_log.STATE_NAME) == ["STOP", "PREPARE", "WAITING_RESULT", "STOP"]


def test_a_run_times_out_exactly_at_its_deadline():
    driver = _minute()
    robot = driver.connected()
    driver.command("start")
    robot.executes()
    passed = driver.now.mono - driver.run_in().clock.deadline() + 60
    robot.lives(59)
    driver.run(1 - passed - 1e-6)
    assert ended(driver) is None
    driver.run(1e-6)
    assert ended(driver) is EndReason.TIMEOUT
    assert driver.taken(effects.TimeoutRung) == [effects.TimeoutRung("tbm")]
    assert driver.states[robot.port][-1].state is BoxState.STOP


def test_the_box_wants_to_be_ticked_at_the_deadline():
    driver = _minute()
    driver.connected()
    driver.command("start")
    deadline = driver.now.mono + 60
    assert driver.run_in().clock.deadline() == deadline
    driver.run(10)  # the silence was reported
    assert driver.box.timers.deadline() == deadline


@pytest.mark.parametrize("late, end", [
    (-1e-3, EndReason.COMPLETED), (0.0, EndReason.TIMEOUT), (0.05, EndReason.TIMEOUT), (10.0, EndReason.TIMEOUT),
])
def test_a_result_counts_until_the_deadline_also_without_a_tick_between(late, end):
    driver = _minute()
    robot = driver.executing()
    driver.jump(driver.run_in().clock.deadline() - driver.now.mono + late)
    robot.state = RobotState.RESULT_TX
    robot.send(robot.report())
    driver.run(10)
    assert ended(driver) is end
    assert driver.taken(effects.TimeoutRung) == [effects.TimeoutRung("tbm")] * (end is EndReason.TIMEOUT)


def test_after_a_timeout_only_a_new_run_is_possible():
    driver = _minute()
    robot = driver.executing()
    robot.lives(60)
    robot.says(RobotState.STOP)
    with pytest.raises(Refused) as refused:
        driver.command("start")
    assert refused.value.reasons == ["The run ended by timeout: disconnect, and connect for a new run"]
    driver.command("disconnect")
    assert driver.view().event.code == "HGTKMH"  # the same event again
    again = driver.connected()
    assert again.port == robot.port + 1
    driver.command("start")
    assert driver.run_in().timer(driver.now) == 60.0


def test_a_stopped_run_continues_and_its_clock_kept_running():
    driver = _minute()
    robot = driver.executing()
    robot.lives(20)
    driver.command("stop")
    assert driver.box_state() is BoxState.STOP
    robot.says(RobotState.STOP)
    robot.lives(15)
    driver.command("start")
    assert driver.run_in().phase is Phase.RUNNING
    assert driver.run_in().end_reason is None
    assert driver.box_state() is BoxState.PREPARE
    assert driver.run_in().timer(driver.now) == pytest.approx(60 - 35, abs=0.1)
    robot.executes()
    robot.lives(26)
    assert ended(driver) is EndReason.TIMEOUT


def test_a_run_that_was_stopped_is_not_started_after_its_time():
    driver = _minute()
    robot = driver.executing()
    driver.command("stop")
    robot.says(RobotState.STOP)
    robot.lives(61)
    assert ended(driver) is EndReason.STOPPED  # stopped runs do not time out
    assert driver.taken(effects.TimeoutRung) == []
    with pytest.raises(Refused, match="time is up .the clock kept running after the stop.: disconnect, and connect"):
        driver.command("start")


def test_the_time_after_a_stop_is_shown():
    driver = _minute(Settings(after_stop_duration=120.0))
    robot = driver.executing()
    driver.command("stop")
    assert driver.view().timer == 120.0
    robot.lives(50)
    assert driver.view().timer == pytest.approx(70.0)
    robot.lives(100)
    assert driver.view().timer == 0.0


def test_a_robot_that_restarts_in_the_middle_is_prepared_again():
    driver = _minute()
    robot = driver.executing()
    for state in (RobotState.STOP, RobotState.PREPARING):
        robot.says(state)
        assert driver.box_state() is BoxState.PREPARE
        robot.executes()
    assert any("fell back to STOP" in text for text in driver.notices(Level.INFO))
    robot.completes()
    assert ended(driver) is EndReason.COMPLETED


def test_a_robot_that_did_not_hear_of_the_start_of_its_task_is_waited_for():
    driver = _minute()
    robot = driver.connected()
    driver.command("start")
    robot.says(RobotState.WAITING_GOAL)
    for _ in range(5):
        robot.says(RobotState.WAITING_GOAL)
        assert driver.box_state() is BoxState.WAITING_RESULT


def test_disconnect_in_the_middle_of_a_run():
    driver = _minute()
    robot = driver.executing()
    run = driver.run_in()
    driver.command("disconnect")
    assert driver.run_in() is None
    assert (run.phase, run.end_reason) == (Phase.ENDED, EndReason.STOPPED)
    assert driver.view().event.code == "HGTKMH"
    robot.says(RobotState.RESULT_TX)  # nobody listens any more
    driver.run(100)
    assert driver.taken(effects.TimeoutRung) == []
    assert driver.bags[robot.port][-1] == (run_log.END, None)


def test_a_completed_run_that_is_disconnected_moves_the_zone_on():
    driver = _minute()
    driver.executing().completes()
    assert driver.view().event.code == "HGTKMH"
    driver.command("disconnect")
    assert driver.view().event.code == "HWV"
    driver.executing().completes()
    driver.command("disconnect")
    assert driver.view().event.code == "HWV"  # it was the last one


def test_scores_are_marked_from_connect_to_disconnect():
    driver = _minute()
    robot = driver.connected()

    def mark(value):
        driver.score("Penalized", "bumps", value)
        return [item.value for item in driver.view().items if item.desc == "bumps"]

    assert mark(1) == [1]
    driver.command("start")
    assert mark(2) == [2]
    robot.executes()
    robot.completes()
    assert mark(5) == [5]
    driver.command("disconnect")
    with pytest.raises(Refused):
        mark(6)
    assert driver.logged(robot.port, run_log.SCORE) == [("Penalized", "bumps", v) for v in (1, 2, 5)]


def test_a_score_that_is_refused_is_not_logged():
    driver = _minute()
    robot = driver.connected()
    driver.taken()
    for group, desc, value in (("Penalized", "bumps", -1), ("Penalized", "bump", 1), ("x", "bumps", 1)):
        with pytest.raises(Refused):
            driver.score(group, desc, value)
    assert {type(effect) for effect in driver.taken()} == {effects.Recorded}
    assert driver.logged(robot.port, run_log.SCORE) == []


def test_a_new_run_begins_with_an_empty_sheet_and_log():
    driver = _minute(Settings(auto_next=False))
    robot = driver.connected()
    driver.score("Penalized", "bumps", 3)
    robot.says(notifications=("hello",))
    driver.command("disconnect")
    assert "hello" in driver.view().online_data  # still to be read
    driver.connected()
    assert "hello" not in driver.view().online_data
    assert {item.value for item in driver.view().items} == {0}


def test_every_string_is_logged_once():
    driver = BoxDriver(competition(tbm=["HWV"]))
    robot = driver.executing()
    for texts in (["ring"], ["ring"], ["ring", "deli"], ["deli"], [], ["deli"]):
        robot.says(notifications=tuple(texts), visitor=tuple(texts))
    for topic in ("/notification", "/visitor"):
        assert driver.logged(robot.port, topic) == ["ring", "deli", "deli"]
    robot.send(robot.last._replace(notifications=("new",)))  # the same time: a duplicate
    assert driver.logged(robot.port, "/notification") == ["ring", "deli", "deli"]


def test_the_panels_texts_are_bounded():
    driver = BoxDriver(settings=Settings(display_log_size=500))
    robot = driver.executing()
    for i in range(50):
        robot.says(notifications=(f"{i} " + "x" * 100,))
        driver.score("Penalized", "bumps", i)
    view = driver.view()
    assert len(view.log) <= 500
    assert len(view.online_data) <= 500
    assert "49 x" in view.online_data
    assert "48 -> 49" in view.log


def test_a_robot_that_stays_where_it_is_after_the_start_is_reported():
    """A robot that does not know the benchmark's code."""
    driver = _minute()
    robot = driver.connected()
    driver.command("start")
    robot.lives(9.0)
    assert not _hint(driver)
    robot.lives(1.5)
    assert "may not know benchmark HGTKMH" in _hint(driver)
    robot.says(RobotState.PREPARING)
    robot.lives(20.0)
    assert not _hint(driver)


def test_a_robot_that_is_silent_after_the_start_is_reported_as_silent_only():
    driver = _minute()
    driver.connected()
    driver.command("start")
    driver.run(12.0)
    assert driver.view().warnings and not _hint(driver)


def _hint(driver):
    return "".join(warning for warning in driver.view().warnings if "has stayed in STOP" in warning)


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


@pytest.mark.parametrize("settings, seconds, end", [
    (Settings(check_messages_saved=False), 60, None), (Settings(check_messages_saved_timeout=20.0), 19, None),
    (Settings(check_messages_saved_timeout=20.0), 21, EndReason.NO_MESSAGES_SAVED),
])
def test_its_timeout_is_a_setting_and_it_can_be_switched_off(settings, seconds, end):
    driver, robot = _executing(settings=settings)
    robot.lives(seconds)
    assert ended(driver) is end


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
    driver.event(driver.box.timers.tick)
    assert ended(driver) is reason
    assert bool(driver.taken(effects.TimeoutRung)) is (reason is EndReason.TIMEOUT)
