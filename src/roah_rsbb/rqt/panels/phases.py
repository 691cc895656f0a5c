"""The phases of a run as panels show them: with words and a mark, never with colour alone."""

from typing import Dict, NamedTuple, Optional

from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording import sheets


class PhaseLook(NamedTuple):
    """How a phase looks."""

    text: str
    tone: basic.Tone
    counts: str  # label of the countdown


# By the phase in ZoneDetails.
PHASES: Dict[str, PhaseLook] = {
    "idle": PhaseLook("○ NOT CONNECTED", basic.IDLE, "Time limit"),
    "connected": PhaseLook("● CONNECTED", basic.READY, "Time limit"),
    "running": PhaseLook("▶ RUNNING", basic.RUNNING, "Time left"),
    "ended": PhaseLook("■ ENDED", basic.ENDED, "Time left after the stop"),
}
UNKNOWN = PhaseLook("–", basic.IDLE, "Time")


def shown(details: Optional[object]) -> PhaseLook:
    """Returns the phase of these ZoneDetails, with the reason if the run has ended."""
    phase = PHASES.get(details.phase, UNKNOWN) if details else UNKNOWN
    if details and details.end_reason:
        return phase._replace(text=f"{phase.text}: {sheets.end_reason(details.end_reason)}")
    return phase
