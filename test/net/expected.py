"""Checks of a run after it has ended, for any quality of the network."""

import itertools
from typing import Any, Dict, List, Tuple

from crew import Robot

from referee import Result
from roah_rsbb.protocol import BoxState, RobotState

BOX_STATES, CLIENT_STATES = "/rsbb_log/rsbb_state", "/rsbb_log/client_state"
_GOALS = {"HOPF": 2, "HNF": 2, "HPPF": 2, "HPFF": 1, "HGMF": 2, "HOMF": 2, "STB": 2}
# These goals are sent to the robot; the others know theirs.
_EXPLICIT = ("HNF", "HGMF", "HOMF", "STB")
_STRINGS = {
    "HWV": {
        "/activation_event": ["the bell rang"],
        "/notification": ["going to the door", "guiding the visitor", "going to the door"],
        "/visitor": ["Deli Man"],
    },
    "HCFGAC": {"/command": ["close the blinds, light, and show me the map"]},
    "HNF": {"/notification": ["on my way"] * 2},
    "HOMF": {"/notification": ["switching"] * 2},
}
# Those that do not depend on where things are: many benchmarks at once share the one dummy world.
_SCORES: Dict[str, Dict[str, Any]] = {
    "HOPF": {"class_accuracy": 1.0, "instance_accuracy": 0.5},
    "HNF": {"reached": 2, "timed_out": 0},
    "HPPF": {"detected": 2, "recognised": 1},
    "HPFF": {"failed_run": False},
    "HGMF": {"objects": 2},
    "HOMF": {"right": 3, "wrong": 1, "damaged": 1},
    "STB": {"completed": 2},
}
_DEVICES = {"switch_1": [1], "switch_2": [1], "switch_3": [1, 0], "dimmer": [70], "blinds": [100, 0]}


def box_states(code: str, reboots: int = 0) -> List[BoxState]:
    """The box's states, of a robot that was rebooted so many times while it had its first goal."""
    cycle = [BoxState.PREPARE, BoxState.WAITING_RESULT]
    if code in _EXPLICIT:
        cycle.insert(1, BoxState.GOAL_TX)
    begin = [BoxState.STOP] * (2 if code in _GOALS else 1)
    return begin + cycle * (_GOALS.get(code, 1) + reboots) + [BoxState.STOP]


def faults(result: Result, robot: Robot, reboots: int = 0) -> List[str]:
    """All that is wrong with a run.

    All messages that say that a robot executes a goal may be lost, in an outage or where a flood fills the box's
    buffers. The box then hears the result first, or a robot that has forgotten the goal, and is never in
    WAITING_RESULT.
    """
    found = []

    def same(what: str, is_so: Any, should: Any) -> None:
        if is_so != should:
            found.append(f"{result.code}, {what}: {is_so}, but it should be {should}")

    same("end", result.end_reason, "completed")
    # The box may have heard that the robot halted, or not.
    of_states = [_state_faults(result, reboots + count) for count in range(late_stops(robot) + 1)]
    if all(of_states):
        found += of_states[0]
    for what, is_so, should in _logged_strings(result):
        if not (is_so == should or (reboots and is_so[-len(should):] == should and _again(is_so, should))):
            found.append(f"{result.code}, {what}: {is_so}, but it should be {should}")
    same("scores in the log", _logged_scores(result), result.marked)
    for name, value in _SCORES.get(result.code, {}).items():
        same(f"module's {name}", result.module_scores.get(("", name)), value)
    if result.code == "HCFGAC":
        for device, values in _DEVICES.items():
            same(device, _settled(result.values(f"/rsbb_log/devices/{device}"), values), values[-1])
    found += _robot_faults(result.code, robot, reboots)
    return found


def late_stops(robot: Robot) -> int:
    """How often a STOP from before the start came after the start's PREPARE (README.md)."""
    states = robot.states
    return sum(state in ("PREPARING", "WAITING_GOAL") and after == ["STOP", "PREPARING"]
               for state, *after in zip(states, states[1:], states[2:]))


def _state_faults(result: Result, cycles: int) -> List[str]:
    """All that is wrong with the box's states, if it began the first goal so many times more than once."""
    found = []
    seen, should = [BoxState(state) for state in result.values(BOX_STATES)], box_states(result.code, cycles)
    # The log has an entry for each message that differs, so a goal may have several.
    heard = [state for state, _ in itertools.groupby(result.values(CLIENT_STATES))]
    heard_executing = heard.count(RobotState.EXECUTING)
    if result.code in _EXPLICIT and heard_executing < should.count(BoxState.WAITING_RESULT):
        if seen.count(BoxState.WAITING_RESULT) != heard_executing:
            found.append(f"{result.code}: {seen.count(BoxState.WAITING_RESULT)} times in WAITING_RESULT, but it should "
                         f"be {heard_executing}")
        seen, should = ([s for s in states if s is not BoxState.WAITING_RESULT] for states in (seen, should))
    if seen != should:
        found.append(f"{result.code}, box's states: {[state.name for state in seen]}, but it should be "
                     f"{[state.name for state in should]}")
    return found


def _logged_strings(result: Result) -> List[Tuple[str, List[str], List[str]]]:
    topics = ("/activation_event", "/notification", "/visitor", "/command")
    should = _STRINGS.get(result.code, {})
    return [(topic, result.values(topic), should.get(topic, [])) for topic in topics]


def _again(is_so: List[str], should: List[str]) -> bool:
    """Whether the strings before the last restart are the beginning of those of an earlier life."""
    before = is_so[:-len(should)] if should else is_so
    return before == should[:len(before)]


def _settled(logged: List[int], commanded: List[int]) -> Any:
    """The last value, if all were commanded and none is repeated."""
    changes = all(one != next_one for one, next_one in zip(logged, logged[1:]))
    return logged[-1] if logged and changes and set(logged) <= set(commanded) else logged


def _logged_scores(result: Result) -> Dict[Tuple[str, str], int]:
    return {(score.group, score.desc): score.value for score in result.values("/rsbb_log/score")}


def _robot_faults(code: str, robot: Robot, reboots: int) -> List[str]:
    """The robot must have gone through each goal once, whatever arrived late."""
    goals = _GOALS.get(code, 1)
    ended = len(robot.did("RESULT_TX"))
    begun = len(robot.did("EXECUTING"))
    should_end = 0 if code == "HPFF" else goals
    if ended != should_end or begun != goals + reboots:
        return [f"{code}: the robot began {begun} and ended {ended} goals: {robot.states}"]
    return []
