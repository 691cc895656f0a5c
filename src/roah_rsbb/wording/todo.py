"""What the referee must do now in a zone, in one line.

The core reports the facts; this module chooses the most urgent one. Works on anything with the fields of ZoneState and
ZoneDetails; ROS is not imported.
"""

import enum
from typing import Any, Iterable, NamedTuple

from roah_rsbb.model import shown
from roah_rsbb.wording.language import tr
from roah_rsbb.wording.said import tr_said

# How the core marks a line of a zone's state that is a warning.
WARNING = "WARNING: "


class Urgency(enum.IntEnum):
    """How much a zone needs its referee."""

    NONE = 0  # nothing to do
    POSSIBLE = 1  # the next step of a run is possible
    LOOK = 2  # something is wrong
    DO = 3  # the run is waiting for the referee


class Todo(NamedTuple):
    """What to do, and how urgent it is."""

    urgency: Urgency
    text: str
    warnings: int = 0  # number of warnings, also if something else is more urgent


def todo(zone: Any, details: Any) -> Todo:
    """Return what to do now in `zone` (ZoneState). `details` (ZoneDetails): None if they are not known."""
    found = [line[len(WARNING):] for line in zone.state.splitlines() if line.startswith(WARNING)]
    if zone.manual_operation:
        return Todo(Urgency.DO, zone.manual_operation, len(found))
    if zone.omf_complete:
        return Todo(
            Urgency.DO, tr("Enter and confirm the switches that the robot changed (OMF Switches)"), len(found))
    if found:
        return Todo(Urgency.LOOK, tr_said(found[0]), len(found))
    if details is not None and details.held:
        return Todo(Urgency.LOOK, tr("The benchmarking module is not running: the run is paused"))
    return _step(zone, details)


def _step(zone: Any, details: Any) -> Todo:
    """Return what the run's phase requires."""
    phase = "" if details is None else details.phase
    if phase == "running":
        return Todo(Urgency.NONE, details.module_status or tr("The robot is working"))
    if phase == "connected":
        return _when(zone.start_enabled, tr("Start is possible"), shown.off(details, "start"))
    if phase == "ended":
        return Todo(Urgency.POSSIBLE, tr("Score the run, then disconnect"))
    if phase == "idle":
        return _when(zone.connect_enabled, tr("Connect is possible"), shown.off(details, "connect"))
    return Todo(Urgency.NONE, tr_said(zone.state.partition("\n")[0]))


def _when(possible: bool, text: str, reasons: Iterable[str]) -> Todo:
    if possible:
        return Todo(Urgency.POSSIBLE, text)
    return Todo(Urgency.NONE, tr("Wait: {reasons}", reasons="; ".join(map(tr_said, reasons))))
