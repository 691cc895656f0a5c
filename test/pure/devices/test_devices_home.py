"""The known state of the home devices."""

import json

import pytest

from roah_rsbb.devices.smartif import OUTPUTS, BadSetting, Changed, DeviceEvent, Home, Set, device_of, is_ring


@pytest.mark.parametrize("device, value, message", [
    ("switch_1", 1, Set("11", 1)), ("switch_2", 1, Set("33", 1)), ("switch_3", 0, Set("40", 0)),
    ("dimmer", 70, Set("58", 70)), ("dimmer", 100, Set("58", 100)),
    ("blinds", 35, Set("77", 3500)), ("blinds", 100, Set("77", 10000)), ("blinds", 0, Set("77", 0)),
])
def test_what_the_controller_receives(device, value, message):
    """Ids and scales of docs/devices.md, "The SmartIF protocol"."""
    home = Home()
    assert home.set(device, value) == message
    assert home.values[device] == value
    assert message in home.all()
    assert device_of(message) == (device, value)


def test_all_is_every_device_once():
    assert sorted(message.device_id for message in Home().all()) == ["11", "33", "40", "58", "77"]


@pytest.mark.parametrize("device, value", [
    ("dimmer", 101), ("blinds", 255), ("blinds", -1), ("switch_1", 2), ("dimmer", 10**12),
])
def test_other_values_are_refused_and_change_nothing(device, value):
    home = Home()
    with pytest.raises(BadSetting, match=f"{device} cannot be set to {value}: it takes 0 to {OUTPUTS[device].highest}"):
        home.set(device, value)
    assert home.values == Home().values


@pytest.mark.parametrize("message, rings", [
    (DeviceEvent("E", "47", "1"), True), (DeviceEvent("E", "47", "0"), False), (DeviceEvent("N", "47", "1"), False),
    (DeviceEvent("D", "47", "1"), False), (DeviceEvent("E", "11", "1"), False), (Changed("47", 1, 1), False),
])
def test_a_ring_is_one_message_only(message, rings):
    assert is_ring(message) is rings


@pytest.mark.parametrize("message", [Set("47", 1), Set("77", 10001), Set("77", 50), Set("58", 101), Set("11", 2)])
def test_messages_for_no_device(message):
    assert device_of(message) is None


def test_saved_state_is_restored():
    home, other = Home(), Home()
    home.set("blinds", 40)
    home.set("switch_2", 1)
    home.bell, home.door = (2**31 + 5, 999_999_999), True
    assert other.restore(json.loads(json.dumps(home.saved())))
    assert (other.values, other.bell, other.door) == (home.values, home.bell, home.door)


@pytest.mark.parametrize("saved", [
    None, 5, "x", {}, [], {"values": {"dimmer": 101}, "bell": ["0", "0"], "door": False},
    {"values": {"dimmer": float("inf")}, "bell": ["0", "0"], "door": False},
    {"values": {"radio": 1}, "bell": ["0", "0"], "door": False}, {"values": {}, "bell": ["x", "0"], "door": False},
    {"values": {}, "bell": ["-1", "0"], "door": False}, {"values": {"dimmer": 5}, "bell": ["0"], "door": False},
    {"values": {"dimmer": 5}, "bell": ["0", "0"]}, {"values": 3, "bell": ["0", "0"], "door": False},
])
def test_what_cannot_be_restored_changes_nothing(saved):
    home = Home()
    home.set("dimmer", 7)
    assert not home.restore(saved)
    assert home.values["dimmer"] == 7
