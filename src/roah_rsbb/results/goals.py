"""The goals of a run: when the robot received each, how long it executed it, and what it reported."""

import json
from typing import Dict, List, NamedTuple, Optional

from roah_rsbb.journal.reader import JournalEntry
from roah_rsbb.model import run_log
from roah_rsbb.results.runs import RunResult
from roah_rsbb.wording.texts import value_text

# The box's states that end a goal on which the robot works.
_ENDS = ("PREPARE", "STOP")
_WORKING = "WAITING_RESULT"


class SentGoal(NamedTuple):
    """A goal that the box sent, such as a waypoint."""

    number: int  # 1, 2, … within the run
    port: Optional[int]  # of the robot
    text: str
    timeout_s: Optional[float]
    utc: float  # when it was given, UTC seconds
    # From the robot's begin to its end, which the box took, or the timeout; None: it did not end.
    seconds: Optional[float] = None
    result: str = ""  # as the robot reported it


def goals(result: RunResult) -> List[SentGoal]:
    """Return the goals of a run in their order."""
    found: List[SentGoal] = []
    current: Dict[Optional[int], int] = {}  # places in `found` by port
    begun: Dict[int, JournalEntry] = {}  # by place
    for entry in result.entries:
        if entry.kind == run_log.GOAL:
            _end(found, begun, current.get(entry.port), entry)  # the next goal ends the one before
            current[entry.port] = len(found)
            found.append(_goal(len(found) + 1, entry.port, entry.value, entry.utc))
        place = current.get(entry.port)
        if place is None:
            continue
        if entry.kind == run_log.RESULT:
            found[place] = found[place]._replace(result=value_text(entry.value))
        elif entry.kind == run_log.STATE_NAME and entry.value == _WORKING:
            begun.setdefault(place, entry)
        elif entry.kind == run_log.STATE_NAME and entry.value in _ENDS:
            _end(found, begun, place, entry)
    return found


def _end(found: List[SentGoal], begun: Dict[int, JournalEntry], place: Optional[int], end: JournalEntry) -> None:
    """End a goal on which the robot works."""
    if place in begun and found[place].seconds is None:
        begin = begun[place]
        # UTC may have been set in between. The monotonic clocks of two starts of the core may have nothing in common.
        seconds = end.mono - begin.mono if end.session == begin.session else end.utc - begin.utc
        found[place] = found[place]._replace(seconds=seconds)


def _goal(number: int, port: Optional[int], value: object, utc: float) -> SentGoal:
    try:
        parts = json.loads(value) if isinstance(value, str) else value
    except ValueError:
        parts = None
    if not isinstance(parts, dict):
        return SentGoal(number, port, value_text(value), None, utc)
    timeout = parts.get("timeout")
    is_number = isinstance(timeout, (int, float)) and timeout > 0
    return SentGoal(number, port, value_text(parts.get("text") or ""), float(timeout) if is_number else None, utc)
