"""Measures how late each side learned of the other's changes of state."""

import bisect
from typing import Iterable, List, NamedTuple, Optional, Tuple

from crew import Robot
from expected import BOX_STATES, CLIENT_STATES

from referee import Result
from roah_rsbb.protocol import BoxState, RobotState

# The robot's state that shows that it has heard of the box's.
_HEARD = {
    BoxState.PREPARE: RobotState.PREPARING.name, BoxState.GOAL_TX: RobotState.EXECUTING.name,
    BoxState.WAITING_RESULT: RobotState.EXECUTING.name,
}


class Late(NamedTuple):
    """One change that was heard."""

    seconds: float  # after the change, or after the end of the outage in which it happened
    what: str


def of_run(result: Result, robot: Robot, outages: Iterable[Tuple[float, float]] = ()) -> List[Late]:
    """All changes of one run. `outages`: in which nobody could hear anything, UTC from and to."""
    outages = list(outages)
    found = []
    entries = [(entry.utc, BoxState(entry.value)) for entry in result.logs[0] if entry.topic == BOX_STATES]
    for place, (utc, state) in enumerate(entries):
        if state is BoxState.WAITING_RESULT and place and entries[place - 1][1] is BoxState.GOAL_TX:
            continue  # the robot executes already
        heard = _first(robot.did(_HEARD[state]), utc) if state in _HEARD else None
        if heard is not None:
            found.append(Late(_since(utc, heard, outages), f"{result.code}: box {state.name} to robot"))
    heard_of = [(entry.utc, RobotState(entry.value).name) for entry in result.logs[0] if entry.topic == CLIENT_STATES]
    for moment in robot.moments:
        if moment.what not in (RobotState.WAITING_GOAL.name, RobotState.RESULT_TX.name):
            continue  # the others are answers, and may be over before they are heard
        heard = _first([utc for utc, name in heard_of if name == moment.what], moment.utc)
        if heard is not None:
            found.append(Late(_since(moment.utc, heard, outages), f"{result.code}: robot {moment.what} to box"))
    return found


def _first(moments: List[float], utc: float) -> Optional[float]:
    # What is logged, or noted, may be slightly older than what it describes.
    place = bisect.bisect_left(moments, utc - 0.002)
    return moments[place] if place < len(moments) else None


def _since(changed: float, heard: float, outages: List[Tuple[float, float]]) -> float:
    for began, ended in outages:
        if began <= heard and changed <= ended:
            changed = max(changed, min(heard, ended))
    return max(0.0, heard - changed)


def summary(late: List[Late]) -> str:
    """Median, 95 % and the worst one, in one line."""
    seconds = sorted(each.seconds for each in late)
    worst = max(late)
    return (f"{len(late)} changes heard after {seconds[len(seconds) // 2] * 1e3:.0f} ms (median), "
            f"{seconds[int(len(seconds) * 0.95)] * 1e3:.0f} ms (95 %), {worst.seconds * 1e3:.0f} ms ({worst.what})")
