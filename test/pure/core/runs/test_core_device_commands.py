"""A robot's commands to devices and tablet."""

import pytest

from helpers.competition import benchmark
from roah_rsbb.core.runs.reported import DeviceCommands, Taken
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.protocol import RobotState
from roah_rsbb.rulebook.registry import PROFILES

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
