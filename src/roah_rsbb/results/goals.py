"""The goals of a run: when a robot got each, how long it worked on it, and its result."""

import json
from typing import Dict, List, NamedTuple, Optional

from roah_rsbb.core import run_log
from roah_rsbb.results.runs import RunResult
from roah_rsbb.wording.texts import value_text

# The box's states that end a goal on which the robot works.
_ENDS = ("PREPARE", "STOP")
_WORKING = "WAITING_RESULT"


class Goal(NamedTuple):
    """A goal that the box sent, such as a waypoint."""

    number: int  # 1, 2, … within the run
    port: Optional[int]  # of the robot
    text: str
    timeout_s: Optional[float]
    utc: float  # when it was given, UTC seconds
    begun_utc: Optional[float] = None  # when the robot began to execute it; None: never
    ended_utc: Optional[float] = None  # when the box took its end, or it timed out; None: never
    result: str = ""  # as the robot reported it


def goals(result: RunResult) -> List[Goal]:
    """Return the goals of a run in their order."""
    found: List[Goal] = []
    current: Dict[Optional[int], int] = {}  # places in `found` by port
    for entry in result.entries:
        if entry.kind == run_log.GOAL:
            _end(found, current.get(entry.port), entry.utc)  # the next goal ends the one before
            current[entry.port] = len(found)
            found.append(_goal(len(found) + 1, entry.port, entry.value, entry.utc))
        place = current.get(entry.port)
        if place is None:
            continue
        goal = found[place]
        if entry.kind == run_log.RESULT:
            found[place] = goal._replace(result=value_text(entry.value))
        elif entry.kind == run_log.STATE_NAME and entry.value == _WORKING and goal.begun_utc is None:
            found[place] = goal._replace(begun_utc=entry.utc)
        elif entry.kind == run_log.STATE_NAME and entry.value in _ENDS:
            _end(found, place, entry.utc)
    return found


def _end(found: List[Goal], place: Optional[int], utc: float) -> None:
    """End a goal on which the robot works."""
    if place is not None and found[place].begun_utc is not None and found[place].ended_utc is None:
        found[place] = found[place]._replace(ended_utc=utc)


def _goal(number: int, port: Optional[int], value: object, utc: float) -> Goal:
    try:
        parts = json.loads(value) if isinstance(value, str) else value
    except ValueError:
        parts = None
    if not isinstance(parts, dict):
        return Goal(number, port, value_text(value), None, utc)
    timeout = parts.get("timeout")
    is_number = isinstance(timeout, (int, float)) and timeout > 0
    return Goal(number, port, value_text(parts.get("text") or ""), float(timeout) if is_number else None, utc)
