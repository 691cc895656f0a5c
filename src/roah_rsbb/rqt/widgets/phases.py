"""The phases of a run as panels show them: with words and a mark, never with colour alone."""

from typing import Dict, NamedTuple, Optional, Tuple

from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording import sheets
from roah_rsbb.wording.clock import Clock


class PhaseLook(NamedTuple):
    """How a phase looks."""

    text: str
    tone: basic.Tone


# By the phase in ZoneDetails: its mark and its colours.
_LOOKS: Dict[str, Tuple[str, basic.Tone]] = {
    "idle": ("○", basic.IDLE),
    "connected": ("●", basic.READY),
    "running": ("▶", basic.RUNNING),
    "ended": ("■", basic.ENDED),
}
UNKNOWN = PhaseLook("–", basic.IDLE)


def shown(details: Optional[object], clock: Optional[Clock] = None) -> PhaseLook:
    """Return the phase of these ZoneDetails, with the reason if the run has ended or its `clock` is paused."""
    if details is None or details.phase not in _LOOKS:
        return UNKNOWN
    if clock is not None and clock.pause:
        return PhaseLook(f"‖ {clock.pause}", basic.OLD)
    mark, tone = _LOOKS[details.phase]
    return PhaseLook(f"{mark} {sheets.phase(details.phase, details.end_reason)}", tone)
