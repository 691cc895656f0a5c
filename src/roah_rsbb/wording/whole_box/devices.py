"""What faces say of the home devices: names, states and commands, the bell, the controller (docs/devices.md)."""

from typing import Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.model.reason import say
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.times import Moments


class TwoStates(NamedTuple):
    """The states 0 and 1 of a device that has only these, and the commands that set them."""

    states: Tuple[str, str]
    commands: Tuple[str, str]


_SWITCH = TwoStates((tr_later("off"), tr_later("ON")), (tr_later("Turn off"), tr_later("Turn on")))
_DOOR = TwoStates((tr_later("closed"), tr_later("OPEN")), (tr_later("Close"), tr_later("Open")))
# All devices that are set, by the names of `DevicesState`, in the order of the faces. Those without states are
# percentages.
DEVICES: Dict[str, Optional[TwoStates]] = {
    "switch_1": _SWITCH, "switch_2": _SWITCH, "switch_3": _SWITCH, "dimmer": None, "blinds": None,
    "door_win_detect": _DOOR}
_NAMES = {"dimmer": tr_later("Dimmer"), "blinds": tr_later("Blinds"), "door_win_detect": tr_later("Door")}
BELL, RING = tr_later("Bell"), tr_later("♪ Ring")
# Marks a value that nobody has confirmed.
WAITING = " …"
PERCENT = 100
# How long a ring is highlighted.
RINGS_S = 5.0

AWAY = tr_later("What you set here takes effect when the controller is connected again.")
NO_DEVICES = say("this box controls no home devices: start it with devices:=true")


def name_of(device: str) -> str:
    """Return the name of a device."""
    return tr(_NAMES[device]) if device in _NAMES else tr("Switch {number}", number=device[-1])


def states_of(device: str) -> List[str]:
    """Return the texts of the states 0 and 1 of a device; none: it is a percentage."""
    kind = DEVICES[device]
    return [] if kind is None else [f"{mark} {tr(state)}" for mark, state in zip("○●", kind.states)]


def commands(device: str) -> List[Tuple[str, int]]:
    """Return the commands that set a device to a certain value, each with that."""
    kind = DEVICES[device]
    if kind is None:
        return [("0 %", 0), (f"{PERCENT} %", PERCENT)]
    return [(tr(kind.commands[value]), value) for value in (1, 0)]


def bell_text(rang_s: float, now_s: float, moments: Moments) -> Tuple[str, bool]:
    """Return when the bell rang last, and whether it rings now."""
    text, rings = tr("Last ring: {time}", time=moments.and_age(rang_s, now_s)), 0 < rang_s > now_s - RINGS_S
    return f"{tr('♪ RINGS')}  ·  {text}" if rings else text, rings


def controller_text(is_connected: bool, text: str) -> Tuple[str, str]:
    """Return whether the controller is connected, and what else is to be known. `text`: details, or the reason."""
    if is_connected:
        return tr("● connected"), text
    return tr("NOT CONNECTED"), f"{text}\n{tr(AWAY)}".strip()
