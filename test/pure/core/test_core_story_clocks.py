"""Clocks that are wrong, stale and replayed datagrams, robots that fall silent."""

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import competition, event
from roah_rsbb.core.effects import Level
from roah_rsbb.model import run_log
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState


def _minute():
    return BoxDriver(competition(tbm=[event(timeout=60.0)]))


@pytest.mark.parametrize("step", [-1e6, -30.0, +30.0, +1e6])
def test_a_step_of_the_boxs_clock_does_not_touch_the_run(step):
    driver = _minute()
    robot = driver.executing()
    robot.lives(30)
    before = driver.run_in().timer(driver.now)
    driver.set_clock(step)
    robot.skew = -step  # the robot's clock was not set
    driver.taken()
    robot.says()
    assert f"The clock of this computer was set by {step:+.3f} s" in driver.notices(Level.WARNING)[0]
    assert any("clock of this computer was set" in text for text in driver.box.watches.warnings(driver.now))
    assert driver.run_in().timer(driver.now) == pytest.approx(before, abs=0.01)
    assert driver.run_in().phase is Phase.RUNNING
    for _ in range(40):
        driver.run(1)
    assert driver.run_in().end_reason is EndReason.TIMEOUT


def test_after_a_step_of_the_boxs_clock_skews_are_measured_again():
    driver = BoxDriver(competition(a=["HWV"], b=[event("HWV", team="Beta")]))
    robot = driver.connected("a")
    other = driver.robot("Beta", "r2")
    other.beacon()
    driver.set_clock(10)
    robot.skew = other.skew = -10
    driver.run(0.1)
    assert driver.run_in("a").link.skew is None
    assert driver.off("connect", "b") == ["Clock skew of robot r2 of team Beta is not known yet"]
    robot.says()
    other.beacon()
    assert driver.run_in("a").link.skew == pytest.approx(-10, abs=0.01)
    assert "is -10.000 s" in driver.off("connect", "b")[0]


def test_a_robot_whose_clock_is_set_right_in_a_run_continues_and_the_referee_is_warned():
    driver = _minute()
    robot = driver.executing()
    robot.skew = +1000
    robot.lives(10)
    robot.skew = 0.0
    robot.lives(3)
    driver.taken()
    assert any("Robot's clock was set back by 1000" in text for text in driver.view().warnings)
    assert "WARNING: Robot's clock was set back" in driver.view().state
    robot.completes()
    assert driver.run_in().end_reason is EndReason.COMPLETED


def test_recorded_datagrams_have_no_effect_while_the_robot_lives():
    driver = BoxDriver(competition(tbm=["HCFGAC"]))
    robot = driver.connected()
    recorded = []

    def says(*args, **fields):
        robot.says(*args, **fields)
        recorded.append(robot.last)

    driver.command("start")
    for state in (RobotState.PREPARING, RobotState.WAITING_GOAL, RobotState.EXECUTING, RobotState.RESULT_TX):
        says(state, notifications=(state.name,), dimmer=state.value)
    says(RobotState.STOP, dimmer=0)
    driver.command("start")
    robot.executes()
    before = (driver.box_state(), driver.run_in().robot_state, len(driver.bags[robot.port]))
    for _ in range(5):
        for report in recorded + recorded[::-1]:
            driver.run(0.02)
            robot.send(report)
        robot.says(notifications=("EXECUTING",))
        before = before[:2] + (len(driver.bags[robot.port]),)
        robot.says(notifications=("EXECUTING",))
        assert (driver.box_state(), driver.run_in().robot_state, len(driver.bags[robot.port])) == before
    assert driver.box_state() is BoxState.WAITING_RESULT


@pytest.mark.parametrize("time", [
    (2**63 - 1, 0), (2**63 - 1, 2**63 - 1), (-(2**63), -(2**63)), (-1, 0), (0, 0), (2**32, 0), (0, 2**63 - 1),
])
def test_absurd_times_do_not_harm_the_box_and_pass(time):
    driver = _minute()
    robot = driver.executing()
    driver.event(driver.box.on_robot_beacon, "10.0.0.5", "Beta", "r2", time)
    robot.says(time=time)
    assert driver.view().state
    for _ in range(6):
        robot.says(after=1.0)
        assert driver.view().state
    assert driver.run_in().link.times_valid
    robot.completes()
    assert driver.run_in().end_reason is EndReason.COMPLETED


def test_a_robot_that_always_sends_an_absurd_time_cannot_be_started():
    driver = _minute()
    robot = driver.connected()
    for i in range(5):
        robot.says(after=1.0, time=(2**62, i))
    assert "Clock skew of the robot is" in driver.off("start")[0]
    driver.command("disconnect")


@pytest.mark.parametrize("skew", [0.15, -0.15])
def test_times_that_arrive_while_the_skew_is_out_of_bounds_are_marked_in_state_and_log(skew):
    driver = BoxDriver(competition(tbm=["HWV"]))
    robot = driver.executing()
    robot.lives(5)
    payloads = driver.logged(robot.port, run_log.CLIENT_PAYLOAD)
    assert not any("time_valid" in text for text in payloads)
    assert "INVALID" not in driver.view().state

    robot.skew = skew
    robot.lives(4)
    robot.says(notifications=("doorbell",))
    assert "WARNING: Robot's times are INVALID: clock skew" in driver.view().state
    marked = driver.logged(robot.port, run_log.CLIENT_PAYLOAD)[len(payloads):]
    assert marked and all("time_valid: false" in text for text in marked)
    assert "doorbell (robot's time invalid: clock skew)" in driver.view().online_data

    robot.skew = 0.0
    robot.lives(4)
    assert "INVALID" not in driver.view().state
    assert "time_valid" not in driver.logged(robot.port, run_log.CLIENT_PAYLOAD)[-1]


def test_a_robot_that_falls_silent_is_reported_once_and_its_run_continues():
    driver = _minute()
    robot = driver.executing()
    driver.taken()
    driver.run(30)
    assert driver.notices(Level.WARNING) == [
        "No message from the robot for 3 s",
        "The robot has disappeared: no message for 10 s, and no beacon from its address. It may still be moving, "
        "and STOP may not reach it: check it",
    ]
    assert "WARNING: The robot has disappeared: no message for 30 s" in driver.view().state
    assert driver.run_in().phase is Phase.RUNNING
    robot.says()
    assert "No message" not in driver.view().state and "disappeared" not in driver.view().state


BEACONS_ONLY = (", but its beacons arrive: its program was restarted, or a firewall blocks the private channel. Check "
                "whether it moves")


def test_a_robot_that_sends_beacons_only_has_not_disappeared():
    driver = _minute()
    robot = driver.executing()
    driver.taken()
    driver.run(2)
    robot.beacon(19)
    assert driver.view().warnings == (f"No message from the robot for 20 s{BEACONS_ONLY}",)
    notices = driver.notices(Level.WARNING)
    assert [text.endswith(BEACONS_ONLY) for text in notices] == [True], notices
    driver.run(5)
    assert driver.view().warnings == ("No message from the robot for 20 s",), "the beacons may only be late"
    driver.run(5)
    assert driver.view().warnings[0].startswith(
        "The robot has disappeared: no message for 30 s, and no beacon from its address.")
    robot.beacon()
    assert driver.view().warnings == (f"No message from the robot for 30 s{BEACONS_ONLY}",)
    driver.run(30)
    later = driver.notices(Level.WARNING)
    assert [text[:46] for text in later] == ["The robot has disappeared: no message for 30 s"], "once in a silence"
    robot.says()
    assert driver.view().warnings == ()


def test_a_beacon_of_before_the_run_says_nothing_about_its_silence():
    driver = _minute()
    robot = driver.connected()
    driver.run(5)
    assert driver.view().warnings == ("No message from the robot for 5 s",)
    assert robot.port is not None


def test_a_robot_whose_messages_are_old_has_not_disappeared():
    driver = _minute()
    robot = driver.executing()
    for _ in range(30):
        driver.run(1.0)
        robot.send(robot.last)
    assert driver.view().warnings[0].startswith("No message from the robot for 30 s but old ones: its clock")


def test_what_cannot_be_read_on_the_private_channel_is_before_the_referees_eyes():
    driver = _minute()
    driver.robot().beacon()
    driver.command("connect")
    port = driver.run_in().port
    driver.event(driver.box.on_unreadable, port, "10.0.0.2 sends what does not decrypt: wrong password?")
    driver.event(driver.box.on_unreadable, port + 1, "nobody's")
    assert "10.0.0.2 sends what does not decrypt: wrong password?" in driver.view().state
    assert "nobody's" not in driver.view().state
