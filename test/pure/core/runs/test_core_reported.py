"""What a robot reports besides its state: commands to devices and tablet, repeated strings; and texts for panels."""

import dataclasses

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import benchmark, competition, event
from roah_rsbb.core import effects
from roah_rsbb.core.effects import Level, SendBeacon, SetDevice
from roah_rsbb.core.runs.reported import DeviceCommands, Taken, receive, with_line
from roah_rsbb.core.settings import Settings
from roah_rsbb.model import run_log
from roah_rsbb.model.messages import Beacon, BenchmarkingRobot, DevicesState, RobotReport, TabletState
from roah_rsbb.protocol import RobotState
from roah_rsbb.rulebook.registry import PROFILES, BenchmarkKind, new_profile

NOTHING = Taken([], None, [])
ALL_OFF = {"switch_1": False, "switch_2": False, "switch_3": False, "dimmer": 0, "blinds": 0, "display_map": False}


def _report(**fields):
    return RobotReport((0, 0), 1, RobotState.EXECUTING, **fields)


@pytest.fixture
def devices():
    """The commands of a robot in HCFGAC that has sent its first message."""
    devices = DeviceCommands(benchmark("HCFGAC"))
    assert devices.take(_report()) == NOTHING
    return devices


@pytest.mark.parametrize("field, value, command", [
    ("switch_1", True, 1), ("switch_2", False, 0), ("switch_3", True, 1), ("dimmer", 70, 70), ("blinds", 0, 0),
    ("blinds", 100, 100),
])
def test_the_first_value_is_a_command(devices, field, value, command):
    assert devices.take(_report(**{field: value})) == Taken([(field, command)], None, [])


@pytest.mark.parametrize("shows_map", [True, False])
def test_the_tablet_is_switched(devices, shows_map):
    assert devices.take(_report(display_map=shows_map)) == Taken([], shows_map, [])
    assert devices.take(_report(display_map=shows_map)) == NOTHING
    assert devices.take(_report(display_map=not shows_map)) == Taken([], not shows_map, [])


def test_a_robot_that_says_everything_at_first_is_obeyed_in_everything(devices):
    commands, shows_map, problems = devices.take(_report(**ALL_OFF))
    assert commands == [("switch_1", 0), ("switch_2", 0), ("switch_3", 0), ("dimmer", 0), ("blinds", 0)]
    assert shows_map is False
    assert problems == []


def test_a_command_is_obeyed_once_per_change(devices):
    assert devices.take(_report(dimmer=70)).commands == [("dimmer", 70)]
    assert [devices.take(_report(dimmer=70)) for _ in range(3)] == [NOTHING] * 3
    assert devices.take(_report(dimmer=71, switch_1=True)).commands == [("switch_1", 1), ("dimmer", 71)]
    assert devices.take(_report(dimmer=70, switch_1=True)).commands == [("dimmer", 70)]


@pytest.mark.parametrize("in_between", [{}, {"blinds": 5}])
def test_a_field_left_out_for_a_while_is_not_a_change(devices, in_between):
    devices.take(_report(dimmer=70, blinds=5))
    assert devices.take(_report(**in_between)) == NOTHING
    assert devices.take(_report(dimmer=70, blinds=5)) == NOTHING


@pytest.mark.parametrize("value", [101, 255, 2**32 - 1])
@pytest.mark.parametrize("field", ["dimmer", "blinds"])
def test_more_than_100_per_cent_is_reported_once_and_not_obeyed(devices, field, value):
    taken = devices.take(_report(**{field: value, "switch_1": True}))
    assert taken.commands == [("switch_1", 1)]
    assert taken.problems == [f"Robot sets {field} to {value}: ignored, because the range is 0 to 100 per cent"]
    assert devices.take(_report(**{field: value, "switch_1": True})) == NOTHING
    assert devices.take(_report(**{field: 50})).commands == [(field, 50)]


def test_the_first_message_on_a_channel_is_of_the_previous_run():
    """As original clients do it: docs/protocol.md, "Device commands"."""
    devices = DeviceCommands(benchmark("HCFGAC"))
    assert devices.take(_report(**{**ALL_OFF, "switch_1": True, "dimmer": 70})) == NOTHING
    assert devices.take(_report()) == NOTHING
    assert devices.take(_report(switch_1=True)).commands == [("switch_1", 1)]


def test_what_the_second_message_repeats_of_the_first_counts():
    """Original robots send everything from their first message on: their first values count as a change."""
    devices = DeviceCommands(benchmark("HCFGAC"))
    wishes = {**ALL_OFF, "switch_2": True, "dimmer": 70}
    devices.take(_report(**wishes))
    taken = devices.take(_report(**wishes))
    assert taken.commands == [("switch_1", 0), ("switch_2", 1), ("switch_3", 0), ("dimmer", 70), ("blinds", 0)]
    assert taken.display_map is False
    assert devices.take(_report(**wishes)) == NOTHING


@pytest.mark.parametrize("code", sorted(set(PROFILES) - {"HCFGAC"}))
def test_in_every_other_benchmark_they_are_ignored_and_that_is_said_once(code):
    devices = DeviceCommands(benchmark(code))
    devices.take(_report(switch_1=True))
    taken = devices.take(_report(switch_1=True, display_map=True))
    assert (taken.commands, taken.display_map) == ([], None)
    assert taken.problems == [f"Robot commands devices or tablet, which {code} does not use: ignored"]
    assert devices.take(_report(switch_1=False, blinds=3, display_map=False)) == NOTHING


def test_a_leftover_command_in_another_benchmark_gives_no_warning():
    devices = DeviceCommands(benchmark("HGTKMH"))
    assert devices.take(_report(**ALL_OFF)) == NOTHING
    assert devices.take(_report()) == NOTHING


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
    driver.event(driver.box.devices.on_state, DevicesState(switch_1=True))
    driver.event(driver.box.devices.on_state, DevicesState(switch_1=False))  # by the referee's hand
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
    driver.event(driver.box.arrivals.on_tablet, "10.0.0.3", reported)
    assert driver.box.beacon().tablet == reported._replace(display_map=True)
    assert driver.box.tablet.heard == driver.now
    assert driver.taken(SendBeacon) == [SendBeacon()]
    driver.run(1.0)
    driver.event(driver.box.arrivals.on_tablet, "10.0.0.3", reported)
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
        driver.event(driver.box.devices.on_state, DevicesState(**change))
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
    driver.event(driver.box.devices.on_refused, "tbm", "dimmer", 70, "no devices node answers")
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
    driver.event(driver.box.devices.on_refused, "tbm", "blinds", 5, "too late")
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
        which.event(which.box.devices.on_status, False, "the controller does not answer")
        assert [w for w in which.box.warnings(which.now) if w not in before] == (reported if warned else [])
        which.run(1000.0)
        assert (reported[0] in which.box.warnings(which.now)) is warned
        which.event(which.box.devices.on_status, True, "connected")
        assert not any("Home devices" in warning for warning in which.box.warnings(which.now))


def _received(*messages):
    last = {}
    return [receive(last, "visitor", texts) for texts in messages]


@pytest.mark.parametrize("messages, new", [
    ([["a"], ["a"], ["a", "b"], ["b"], ["b"]], [["a"], [], ["b"], [], []]),
    # The same text is new again after a message without it.
    ([["a"], [], ["a"], ["b"], ["a"]], [["a"], [], ["a"], ["b"], ["a"]]),
    ([["a", "b", "a"]], [["a", "b"]]), ([["c", "a", "b"]], [["c", "a", "b"]]),
])
def test_a_string_that_is_repeated_is_new_once(messages, new):
    assert _received(*messages) == new


def test_no_more_is_remembered_than_one_message_holds():
    last = {}
    for i in range(100):
        receive(last, "visitor", [str(i)])
    assert last == {"visitor": ("99",)}


def test_fields_are_apart():
    last = {}
    assert [receive(last, field, ["a"]) for field in ("visitor", "final_command", "visitor")] == [["a"], ["a"], []]


def test_a_panel_shows_the_last_lines_that_fit():
    text = ""
    for line in ("one", "two", "three"):
        text = with_line(text, line, 10)
    assert text == "two\nthree\n"


def test_a_line_longer_than_the_panel_keeps_its_end():
    assert with_line("", "0123456789", 5) == "6789\n"


@pytest.mark.parametrize("size", [1, 7, 100])
@pytest.mark.parametrize("line", ["", "x", "\n\n\n", "x" * 99, "a\nb\nc", "é" * 50])
def test_a_panels_text_is_bounded_whatever_comes(size, line):
    text = ""
    for _ in range(300):
        text = with_line(text, line, size)
        assert len(text) <= size
        assert text.endswith("\n")


def test_what_a_robot_says_forges_no_line():
    shown = with_line("", "notifications: \x1b[2Jdone\n12:00:00 STOP: Benchmark completed\u202e", 1000)
    assert shown == "notifications: \\x1b[2Jdone\\n12:00:00 STOP: Benchmark completed\\u202e\n"


def run_of(code, uses=None):
    """A box with a robot in a benchmark; `uses` are those of benchmarks.yaml."""
    planned = event(code)
    profile = PROFILES.get(code) or new_profile(BenchmarkKind.TASK)
    if uses is not None:
        profile = dataclasses.replace(profile, uses=frozenset(uses))
    benchmark = dataclasses.replace(planned.benchmark, own=profile)
    driver = BoxDriver(competition(tbm=[dataclasses.replace(planned, benchmark=benchmark)]))
    robot = driver.connected()
    driver.taken()
    return driver, robot


@pytest.mark.parametrize("code, uses, warned", [
    ("HGTKMH", None, 0),  # as ever: robots have always sent strings in any benchmark
    ("HWV", None, 0),
    ("HWV", ["visitor"], 1),
    ("HGTKMH", ["notifications"], 0),
    ("SetTable", ["notifications"], 0),
    ("SetTable", [], 1),
    ("SetTable", None, 1),
])
def test_a_notification_that_is_not_used(code, uses, warned):
    driver, robot = run_of(code, uses)
    robot.says(RobotState.STOP, notifications=("hello",))
    robot.says(RobotState.STOP, notifications=("hello", "again"))
    assert driver.logged(robot.port, run_log.NOTIFICATION) == ["hello", "again"]
    texts = [text for text in driver.notices(Level.WARNING) if "'notifications'" in text]
    assert len(texts) == warned
    if warned:
        assert f"which {code} does not use" in texts[0]
