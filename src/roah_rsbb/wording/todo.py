"""What a referee must do now in a zone, in one line: for panels that show several zones at a glance.

The core says what is the matter; this only chooses what comes first. Works on anything with the fields of
ZoneState and ZoneDetails: neither ROS nor Qt is needed.
"""

import enum
from typing import NamedTuple

# So the core marks a line of a zone's state that calls for attention.
WARNING = "WARNING: "


class Urgency(enum.IntEnum):
    """How much a zone needs its referee."""

    NONE = 0  # nothing can be done
    POSSIBLE = 1  # the next step of a run is possible
    LOOK = 2  # something is wrong
    DO = 3  # the run waits for the referee's hand


class Todo(NamedTuple):
    """What is to be done, and how urgent that is."""

    urgency: Urgency
    text: str
    warnings: int = 0  # how many there are, also if something else comes first


def todo(zone, details) -> Todo:
    """What must be done now in `zone` (ZoneState); `details` (ZoneDetails): None where they are not known."""
    found = [line[len(WARNING):] for line in zone.state.splitlines() if line.startswith(WARNING)]
    if zone.manual_operation:
        return Todo(Urgency.DO, zone.manual_operation, len(found))
    if zone.omf_complete:
        return Todo(Urgency.DO, "Enter which switches the robot changed, and confirm (OMF Switches)", len(found))
    if found:
        return Todo(Urgency.LOOK, found[0], len(found))
    if details is not None and details.held:
        return Todo(Urgency.LOOK, "The benchmarking module is gone: time stands still")
    return _step(zone, details)


def _step(zone, details) -> Todo:
    """What the run's phase calls for."""
    phase = "" if details is None else details.phase
    if phase == "running":
        return Todo(Urgency.NONE, details.module_status or "The robot is at work")
    if phase == "connected":
        return _when(zone.start_enabled, "Start is possible", details.start_off)
    if phase == "ended":
        return Todo(Urgency.POSSIBLE, "Score the run, then disconnect")
    if phase == "idle":
        return _when(zone.connect_enabled, "Connect is possible", details.connect_off)
    return Todo(Urgency.NONE, zone.state.partition("\n")[0])


def _when(possible: bool, text: str, reasons) -> Todo:
    return Todo(Urgency.POSSIBLE, text) if possible else Todo(Urgency.NONE, f"Wait: {'; '.join(reasons)}")
