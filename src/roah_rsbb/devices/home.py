"""The home devices as the box holds them: what they are set to, checked, and how that is said to the controller.

The hardware's state cannot be read: what is held here is what counts, and is sent anew whenever the controller
is reached again.
"""

from typing import Dict, NamedTuple, Optional, Tuple

from roah_rsbb.devices.smartif import Event, Message, Set

BELL_ID = "47"
RING = Event("E", BELL_ID, "1")


class Output(NamedTuple):
    """A device that can be set."""

    device_id: str
    highest: int  # values from 0; per cent, or 1 of a switch
    scale: int = 1  # what the controller takes is so many times the value


OUTPUTS: Dict[str, Output] = {
    "switch_1": Output("11", 1),
    "switch_2": Output("33", 1),
    "switch_3": Output("40", 1),
    "dimmer": Output("58", 100),
    "blinds": Output("77", 100, scale=100),
}
BY_ID = {output.device_id: name for name, output in OUTPUTS.items()}


class BadValue(ValueError):
    """A device does not take this value."""


class Home:
    """What is held. Times are exact (sec, nsec) pairs of UTC."""

    def __init__(self) -> None:
        self.values: Dict[str, int] = dict.fromkeys(OUTPUTS, 0)
        self.bell: Tuple[int, int] = (0, 0)  # last ring
        self.door: bool = False

    def set(self, device: str, value: int) -> Set:
        """Hold a value; returns what the controller is to be told. Raises `BadValue`."""
        highest = OUTPUTS[device].highest
        if not 0 <= value <= highest:
            unit = "per cent" if highest == 100 else "(off or on)"
            raise BadValue(f"{device} cannot be set to {value}: it takes 0 to {highest} {unit}")
        self.values[device] = int(value)
        return self._said(device)

    def all(self) -> Tuple[Set, ...]:
        """What a controller is told when it is reached: everything that is held."""
        return tuple(self._said(device) for device in OUTPUTS)

    def _said(self, device: str) -> Set:
        output = OUTPUTS[device]
        return Set(output.device_id, self.values[device] * output.scale)

    def saved(self) -> Dict[str, object]:
        """All that is held, as numbers and texts, for `restore`."""
        return {"values": dict(self.values), "bell": [str(part) for part in self.bell], "door": self.door}

    def restore(self, saved: object) -> bool:
        """Hold what an earlier one held; False: it is not what `saved` made, and nothing changed."""
        restored = _restored(saved)
        if restored is None:
            return False
        self.values, self.bell, self.door = restored.values, restored.bell, restored.door
        return True


def is_ring(message: Message) -> bool:
    """Whether a message of the controller says that the bell was rung."""
    return message == RING


def device_of(message: Set) -> Optional[Tuple[str, int]]:
    """The device and value that a controller is told to set; None: it has no such device or value."""
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
