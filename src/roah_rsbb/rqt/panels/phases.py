"""The phases of a zone's run as the panels show them: words and a mark, never a colour alone."""

from typing import Dict, NamedTuple, Optional

from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording import sheets


class Phase(NamedTuple):
    """How a phase looks."""

    text: str
    tone: basic.Tone
    counts: str  # what the countdown counts


# By the phase in ZoneDetails.
PHASES: Dict[str, Phase] = {
    "idle": Phase("○ NOT CONNECTED", basic.IDLE, "Time limit"),
    "connected": Phase("● CONNECTED", basic.READY, "Time limit"),
    "running": Phase("▶ RUNNING", basic.RUNNING, "Time left"),
    "ended": Phase("■ ENDED", basic.ENDED, "Time left after the stop"),
}
UNKNOWN = Phase("–", basic.IDLE, "Time")


def shown(details: Optional[object]) -> Phase:
    """The phase of these ZoneDetails; with the reason where it has ended."""
    phase = PHASES.get(details.phase, UNKNOWN) if details else UNKNOWN
    if details and details.end_reason:
        return phase._replace(text=f"{phase.text}: {sheets.end_reason(details.end_reason)}")
    return phase
