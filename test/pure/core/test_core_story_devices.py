"""Devices and the tablet: the robots' commands, and the beacon."""

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import competition, event
from roah_rsbb.core import effects
from roah_rsbb.core.effects import Level, SendBeacon, SetDevice
from roah_rsbb.core.settings import Settings
from roah_rsbb.model import run_log
from roah_rsbb.model.messages import Beacon, BenchmarkingRobot, DevicesState, TabletState
from roah_rsbb.protocol import RobotState


def _catering(code="HCFGAC"):
    driver = BoxDriver(competition(tbm=[code, "HCFGAC"]), Settings(auto_next=False))
    return driver, driver.connected()


def test_a_robot_operates_devices_in_any_state_of_its_run():
    driver, robot = _catering()
    robot.says(switch_1=True)
    driver.command("start")
    robot.says(RobotState.PREPARING, switch_1=True, dimmer=70)
    assert driver.taken(SetDevice) == [("tbm", "switch_1", 1), ("tbm", "dimmer", 70)]


def test_a_repeated_value_never_undoes_what_the_referee_did_since():
    driver, robot = _catering()
    robot.says(switch_1=True, display_map=True)
    driver.event(driver.box.on_devices, DevicesState(switch_1=True))
    driver.event(driver.box.on_devices, DevicesState(switch_1=False))  # by the referee's hand
    driver.taken()
    robot.says(switch_1=True, display_map=True)
    robot.says(display_map=True)
    robot.says(switch_1=True, display_map=True)
    assert driver.taken(SetDevice, SendBeacon) == []


@pytest.mark.parametrize("first_run_code", ["HCFGAC", "HGTKMH"])
@pytest.mark.parametrize("box_restarts", [False, True])
def test_the_left_over_of_a_2015_clients_previous_run_is_not_obeyed(first_run_code, box_restarts):
    driver, robot = _catering(first_run_code)
    robot.fields = {
        "switch_1": True, "switch_2": False, "switch_3": False, "dimmer": 70, "blinds": 0, "display_map": True
    }
    robot.says()
    driver.command("disconnect")
    if box_restarts:
        driver = BoxDriver(competition(tbm=["HCFGAC"]), last_port=robot.port)
        robot.driver = driver
    else:
        driver.command("next")
    driver.taken()
    robot.beacon()
    driver.command("connect")
    robot.port = driver.run_in().port
    shows_map = driver.box.tablet.state.display_map
    robot.says()
    robot.fields = {}
    robot.says()
    assert driver.taken(SetDevice) == []
    assert driver.box.tablet.state.display_map is shows_map
    robot.says(dimmer=70)
    assert driver.taken(SetDevice) == [("tbm", "dimmer", 70)]


@pytest.mark.parametrize("code", ["HGTKMH", "HWV"])
def test_in_other_benchmarks_devices_are_ignored_with_one_warning(code):
    driver, robot = _catering(code)
    for value in (True, False, True):
        robot.says(switch_1=value, display_map=value)
    assert driver.box.tablet.state.display_map is False
    taken = driver.taken()
    assert not any(isinstance(effect, SetDevice) for effect in taken)
    warnings = [e.text for e in taken if isinstance(e, effects.Notice) and e.level is Level.WARNING]
    assert warnings == [f"Robot commands devices or tablet, which {code} does not use: ignored"]
    assert driver.view().log.count("ignored") == 1


def test_the_beacon_shows_the_tablets_view_at_once():
    driver, robot = _catering()
    driver.taken()
    robot.says(display_map=True)
    assert driver.box.beacon().tablet.display_map is True
    assert driver.taken(SendBeacon) == [SendBeacon()]
    robot.says(display_map=False)
    assert driver.box.beacon().tablet.display_map is False
    assert driver.taken(SendBeacon) == [SendBeacon()]


def test_a_view_that_a_robot_repeats_is_logged_only_when_it_changes():
    """Original clients send "call button" with every message."""
    driver, robot = _catering()
    driver.taken()
    robot.says(display_map=False)
    assert (driver.notices(), driver.logged(robot.port, run_log.DISPLAY_MAP)) == ([], [0]), "the run's log has all"
    for view in (True, True, False, False):
        robot.says(display_map=view)
    assert driver.notices() == ["Robot switches the tablet to the map", "Robot switches the tablet to the call button"]
    assert driver.view().log.count("switches the tablet") == 2
    assert driver.logged(robot.port, run_log.DISPLAY_MAP) == [0, 1, 0]


def test_a_tablet_says_where_it_was_touched_but_not_which_view_it_shows():
    driver, robot = _catering()
    robot.says(display_map=True)
    driver.taken()
    reported = TabletState(False, (12, 5), (13, 6), 1.5, -2.5)
    driver.event(driver.box.on_tablet, "10.0.0.3", reported)
    assert driver.box.beacon().tablet == reported._replace(display_map=True)
    assert driver.box.tablet.heard == driver.now
    assert driver.taken(SendBeacon) == [SendBeacon()]
    driver.run(1.0)
    driver.event(driver.box.on_tablet, "10.0.0.3", reported)
    assert driver.box.tablet.heard == driver.now
    assert driver.taken(SendBeacon) == []


@pytest.mark.parametrize("change", [
    {"bell": (12, 5)}, {"switch_1": True}, {"switch_2": True}, {"switch_3": True}, {"dimmer": 100}, {"blinds": 1},
    {"door_win_detect": True},
])
def test_every_change_of_the_devices_is_in_the_beacon_at_once_and_once(change):
    driver = BoxDriver()
    driver.taken()
    for _ in range(3):
        driver.event(driver.box.on_devices, DevicesState(**change))
    assert driver.box.beacon().devices == DevicesState(**change)
    assert driver.taken(SendBeacon) == [SendBeacon()]


def test_the_beacon_lists_the_robots_in_runs():
    driver = BoxDriver(competition(a=["HWV"], b=[event("HWV", team="Beta")]))
    assert driver.box.beacon() == Beacon((), DevicesState(), TabletState())
    driver.taken()
    driver.connected("a")
    driver.connected("b", team="Beta", name="r2")
    assert driver.taken(SendBeacon) == [SendBeacon()] * 2
    assert driver.box.beacon().robots == (
        BenchmarkingRobot("Alpha", "r1", 6667), BenchmarkingRobot("Beta", "r2", 6668)
    )
    driver.command("disconnect", "a")
    assert driver.taken(SendBeacon) == [SendBeacon()]
    assert driver.box.beacon().robots == (BenchmarkingRobot("Beta", "r2", 6668),)


def test_a_device_that_refuses_is_shown_to_the_referee():
    driver, robot = _catering()
    robot.says(dimmer=70)
    driver.taken()
    driver.event(driver.box.on_device_refused, "tbm", "dimmer", 70, "no devices node answers")
    text = "dimmer was not set to 70 as the robot commanded: no devices node answers"
    assert f"WARNING: {text}" in driver.view().log
    assert text in driver.box.warnings(driver.now)
    assert effects.Notice(Level.WARNING, text, "tbm") in driver.taken()
    driver.run(11.0)
    assert text not in driver.box.warnings(driver.now)


def test_a_refusal_that_comes_after_the_run_is_reported_nevertheless():
    driver, robot = _catering()
    driver.command("disconnect")
    driver.taken()
    driver.event(driver.box.on_device_refused, "tbm", "blinds", 5, "too late")
    text = "blinds was not set to 5 as the robot commanded: too late"
    assert driver.taken() == [effects.Notice(Level.WARNING, text, "tbm")]
    assert text in driver.box.warnings(driver.now)


def test_a_controller_that_is_not_reached_is_a_warning_where_devices_are_needed():
    driver, _ = _catering()
    reported = ["Home devices: the controller does not answer"]
    other = BoxDriver(competition(tbm=["HWV"]))
    for which, warned in ((driver, True), (other, False)):
        if which is driver:
            driver.command("disconnect")
            driver.command("next")
        before = which.box.warnings(which.now)
        which.event(which.box.on_devices_status, False, "the controller does not answer")
        assert [w for w in which.box.warnings(which.now) if w not in before] == (reported if warned else [])
        which.run(1000.0)
        assert (reported[0] in which.box.warnings(which.now)) is warned
        which.event(which.box.on_devices_status, True, "connected")
        assert not any("Home devices" in warning for warning in which.box.warnings(which.now))
