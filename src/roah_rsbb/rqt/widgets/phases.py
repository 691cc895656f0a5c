"""The phases of a run as panels show them: with words and a mark, never with colour alone."""

from typing import NamedTuple, Optional

from roah_rsbb.model.zone import CONNECTED, ENDED, IDLE, RUNNING, ZoneSeen
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording import sheets
from roah_rsbb.wording.times import Clock


class PhaseLook(NamedTuple):
    """How a phase looks."""

    text: str
    tone: basic.Tone


_TONES = {IDLE: basic.IDLE, CONNECTED: basic.READY, RUNNING: basic.RUNNING, ENDED: basic.ENDED}


def shown(zone: ZoneSeen, clock: Optional[Clock] = None) -> PhaseLook:
    """Return the phase of a zone, with the reason if the run has ended or its `clock` is paused."""
    if clock is not None and clock.pause and zone.phase in _TONES:
        return PhaseLook(f"‖ {clock.pause}", basic.OLD)
    return PhaseLook(sheets.marked_phase(zone.phase, zone.end_reason), _TONES.get(zone.phase, basic.IDLE))
