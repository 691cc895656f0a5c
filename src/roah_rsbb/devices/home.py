"""The home devices as the box knows them: checked values, and their messages to the controller.

The state of the hardware cannot be read. The values here are authoritative, and are sent again after each connection.
"""

from typing import Dict, NamedTuple, Optional, Tuple

from roah_rsbb.devices.smartif import DeviceEvent, Message, Set
from roah_rsbb.model.messages import NEVER, DevicesState
from roah_rsbb.protocol import SWITCHES, WireTime

BELL_ID = "47"
RING = DeviceEvent("E", BELL_ID, "1")


class OutputDevice(NamedTuple):
    """A device that can be set."""

    device_id: str
    highest: int  # values start at 0; per cent, or 1 for a switch
    scale: int = 1  # factor from the value to the controller's value


OUTPUTS: Dict[str, OutputDevice] = {
    "switch_1": OutputDevice("11", 1),
    "switch_2": OutputDevice("33", 1),
    "switch_3": OutputDevice("40", 1),
    "dimmer": OutputDevice("58", 100),
    "blinds": OutputDevice("77", 100, scale=100),
}
BY_ID = {output.device_id: name for name, output in OUTPUTS.items()}


class BadSetting(ValueError):
    """The device does not accept this value."""


class Home:
    """The present values. Times are exact (sec, nsec) pairs of UTC."""

    def __init__(self) -> None:
        self.values: Dict[str, int] = dict.fromkeys(OUTPUTS, 0)
        self.bell: WireTime = NEVER  # last ring
        self.door: bool = False

    def set(self, device: str, value: int) -> Set:
        """Set a value; returns the message to the controller. Raises `BadSetting`."""
        highest = OUTPUTS[device].highest
        if not 0 <= value <= highest:
            unit = "per cent" if highest == 100 else "(off or on)"
            raise BadSetting(f"{device} cannot be set to {value}: it takes 0 to {highest} {unit}")
        self.values[device] = int(value)
        return self._message(device)

    def all(self) -> Tuple[Set, ...]:
        """The messages to a controller after connecting: all values."""
        return tuple(self._message(device) for device in OUTPUTS)

    def _message(self, device: str) -> Set:
        output = OUTPUTS[device]
        return Set(output.device_id, self.values[device] * output.scale)

    def saved(self) -> Dict[str, object]:
        """All values as numbers and texts, for `restore`."""
        return {"values": dict(self.values), "bell": [str(part) for part in self.bell], "door": self.door}

    def restore(self, saved: object) -> bool:
        """Restore saved values; returns False, without changes, if they are invalid."""
        restored = _restored(saved)
        if restored is None:
            return False
        self.values, self.bell, self.door = restored.values, restored.bell, restored.door
        return True


def devices_state(home: Home) -> DevicesState:
    """The values as the box and the robots receive them."""
    values = {name: bool(value) if name in SWITCHES else value for name, value in home.values.items()}
    return DevicesState(bell=home.bell, door_win_detect=home.door, **values)


def is_ring(message: Message) -> bool:
    """Whether a message of the controller reports a ring of the bell."""
    return message == RING


def device_of(message: Set) -> Optional[Tuple[str, int]]:
    """The device and value in a message to a controller; None if unknown."""
    name = BY_ID.get(message.device_id)
    if name is None:
        return None
    output = OUTPUTS[name]
    value, rest = divmod(message.value, output.scale)
    return (name, value) if rest == 0 and value <= output.highest else None


def _restored(saved: object) -> Optional[Home]:
    home = Home()
    try:
        for device, value in saved["values"].items():
            home.set(device, int(value))
        sec, nsec = (int(part) for part in saved["bell"])
        home.bell, home.door = (sec, nsec), bool(saved["door"])
    except (TypeError, KeyError, AttributeError, ValueError, OverflowError):
        return None
    return home if 0 <= sec < 2**32 and 0 <= nsec < 10**9 else None
