"""What the referee must do now in a zone, in one line.

The core reports the facts; this module chooses the most urgent one.
"""

import enum
from typing import NamedTuple, Sequence

from roah_rsbb.model.zone import CONNECTED, ENDED, RUNNING, ZoneSeen
from roah_rsbb.wording.language import tr, tr_said


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

    @property
    def more(self) -> str:
        """How many warnings there are beside the text; empty: none."""
        number = self.warnings - (self.urgency is Urgency.LOOK)
        return tr("⚠ {n} more", n=number) if number > 0 else ""


def todo(zone: ZoneSeen) -> Todo:
    """Return what to do now in a zone."""
    found = zone.unsaid
    if zone.manual_operation:
        return Todo(Urgency.DO, zone.manual_operation, len(found))
    if zone.switches is not None and zone.switches.to_confirm:
        return Todo(
            Urgency.DO, tr("Enter and confirm the switches that the robot changed (OMF Switches)"), len(found))
    if found:
        return Todo(Urgency.LOOK, tr_said(found[0]), len(found))
    if zone.held:
        return Todo(Urgency.LOOK, tr("The benchmarking module is not running: the run is paused"))
    return _step(zone)


def _step(zone: ZoneSeen) -> Todo:
    """Return what the run's phase requires."""
    if zone.phase == RUNNING:
        working = tr("The run is in progress") if zone.by_hand else tr("The robot is working")
        return Todo(Urgency.NONE, zone.module_status or working)
    if zone.phase == CONNECTED:
        return _when(tr("Start is possible"), zone.off("start"))
    if zone.phase == ENDED:
        return Todo(Urgency.POSSIBLE, tr("Score the run, then disconnect"))
    question = zone.action("connect").question
    if question:
        return Todo(Urgency.NONE, tr_said(question))
    return _when(tr("Connect is possible"), zone.off("connect"))


def _when(possible: str, reasons: Sequence[str]) -> Todo:
    """Return what is possible, or for what to wait."""
    if not reasons:
        return Todo(Urgency.POSSIBLE, possible)
    return Todo(Urgency.NONE, tr("Wait: {reasons}", reasons="; ".join(map(tr_said, reasons))))
