"""The phases of a run as panels show them: with words and a mark, never with colour alone."""

from typing import Dict, NamedTuple, Optional, Tuple

from roah_rsbb.model.zone import CONNECTED, ENDED, IDLE, RUNNING, ZoneSeen
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording import sheets
from roah_rsbb.wording.clock import Clock


class PhaseLook(NamedTuple):
    """How a phase looks."""

    text: str
    tone: basic.Tone


# Marks and colours.
_LOOKS: Dict[str, Tuple[str, basic.Tone]] = {
    IDLE: ("○", basic.IDLE),
    CONNECTED: ("●", basic.READY),
    RUNNING: ("▶", basic.RUNNING),
    ENDED: ("■", basic.ENDED),
}
UNKNOWN = PhaseLook("–", basic.IDLE)


def shown(zone: ZoneSeen, clock: Optional[Clock] = None) -> PhaseLook:
    """Return the phase of a zone, with the reason if the run has ended or its `clock` is paused."""
    if zone.phase not in _LOOKS:
        return UNKNOWN
    if clock is not None and clock.pause:
        return PhaseLook(f"‖ {clock.pause}", basic.OLD)
    mark, tone = _LOOKS[zone.phase]
    return PhaseLook(f"{mark} {sheets.phase(zone.phase, zone.end_reason)}", tone)
