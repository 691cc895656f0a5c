"""The phases of a run, as referees see them.

Theory of operation. A run begins in phase *connected*, when its channel or its score sheet was opened. `TABLE` has the
phase that follows each pair of phase and event. An event without an entry is not possible: `following` raises, and
nothing changes. Why a referee cannot do something now, also besides the phase, is in `core/actions`. A run that is left
while it runs ends first. What the box sends in a phase is another table (`core/runs/machine.py`).

docs/protocol.md, "Phases of a run", shows the table.
"""

import enum
from typing import Dict, Tuple

from roah_rsbb.model.records import Phase


class RunEvent(enum.Enum):
    """What changes the phase of a run."""

    START = "start"  # also again, after an end
    END = "end"  # it has an `EndReason`: the referee, the robots, a time limit, saved data, a module
    GIVE_UP = "no-show or withdrawal"
    LEAVE_OUT = "left out"  # the other robots of the run start without this one


class WrongPhase(RuntimeError):
    """An event is not possible in the phase of the run."""


TABLE: Dict[Tuple[Phase, RunEvent], Phase] = {
    (Phase.CONNECTED, RunEvent.START): Phase.RUNNING,
    (Phase.CONNECTED, RunEvent.GIVE_UP): Phase.ENDED,
    (Phase.CONNECTED, RunEvent.LEAVE_OUT): Phase.CONNECTED,
    (Phase.RUNNING, RunEvent.END): Phase.ENDED,
    (Phase.ENDED, RunEvent.START): Phase.RUNNING,
    # A team can still withdraw after a stop.
    (Phase.ENDED, RunEvent.GIVE_UP): Phase.ENDED,
    (Phase.ENDED, RunEvent.LEAVE_OUT): Phase.CONNECTED,
}


def is_possible(phase: Phase, event: RunEvent) -> bool:
    """Whether an event has an entry in a phase."""
    return (phase, event) in TABLE


def following(phase: Phase, event: RunEvent) -> Phase:
    """Return the phase after an event. Raises `WrongPhase`."""
    if not is_possible(phase, event):
        raise WrongPhase(f"'{event.value}' in phase {phase.value}")
    return TABLE[phase, event]
