"""Reads goals and writes results (docs/protocol.md, "Goals and results").

Robots and boxes of 2014 and 2015 use special fields, those of 2019 YAML texts. Goals are accepted in either form, and
results are sent in both. No YAML library is needed: goals are lists of three numbers, in flow or block style, and
results are written as JSON, which is valid YAML.
"""

import json
import math
import re
from typing import List, NamedTuple, Optional, Tuple, Union

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.rulebook.registry import GoalForm, ResultForm, profile_of


class BadGoal(Exception):
    """The goal cannot be read. The text says what was found and what was expected."""


class Pose(NamedTuple):
    """A pose in the plane: metres and radians."""

    x: float
    y: float
    theta: float


class Goal(NamedTuple):
    """One goal. Fields that the benchmark does not use are None or empty."""

    text: Optional[str] = None  # as YAML: all goals of a 2019 box
    pose: Optional[Pose] = None  # a waypoint, or the target of an object (then theta is 0)
    object_id: Optional[int] = None  # the object to grasp
    initial_state: Tuple[bool, ...] = ()  # states of the switches
    switches: Tuple[int, ...] = ()  # switches to toggle, in this order


class HopfResult(NamedTuple):
    """The result of Object Perception: the object that the robot sees."""

    object_class: str
    object_name: str  # the instance
    pose: Pose


class HppfResult(NamedTuple):
    """The result of People Perception: the person that the robot sees."""

    person_name: str
    pose: Pose


# A text is sent unchanged as `generic_result`.
Result = Union[None, str, HopfResult, HppfResult]

# Largest size of a result. With aes-128-cbc a message has 987 bytes (docs/protocol.md, "Frame"), of which everything
# but result and strings takes less than 80.
RESULT_BUDGET_BYTES = 900


def read_goal(message: pb.BenchmarkState) -> Goal:
    """Read the goal in a GOAL_TX message; `BadGoal` if the benchmark needs one and it cannot be read."""
    text = message.generic_goal if message.HasField("generic_goal") else None
    form = profile_of(message.benchmark_type).goal
    if form is GoalForm.WAYPOINT:
        return Goal(text=text, pose=_waypoint(message, text))
    if form is GoalForm.PLACEMENT:
        x, y, object_id = _three_numbers(text, "[x, y, object_id]")
        if not object_id.is_integer() or not 0 <= object_id <= 65535:
            raise BadGoal(f"the object in {text!r} is not a number from 0 to 65535")
        return Goal(text=text, pose=Pose(x, y, 0.0), object_id=int(object_id))
    return Goal(text=text, initial_state=tuple(message.initial_state), switches=tuple(message.switches))


def _waypoint(message: pb.BenchmarkState, text: Optional[str]) -> Pose:
    """Read the waypoint in the form of 2015 if present, else in that of 2019."""
    if all(message.HasField(field) for field in ("target_pose_x", "target_pose_y", "target_pose_theta")):
        pose = Pose(message.target_pose_x, message.target_pose_y, message.target_pose_theta)
        if all(map(math.isfinite, pose)):
            return pose
        raise BadGoal(f"the waypoint {tuple(pose)} is not finite")
    return Pose(*_three_numbers(text, "[x, y, theta]"))


_LONGEST_LIST = 200  # characters; limits the time that the pattern needs
_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?"
_FLOW_LIST = re.compile(rf"\[\s*({_NUMBER})\s*,\s*({_NUMBER})\s*,\s*({_NUMBER})\s*,?\s*\]")
_BLOCK_LIST = re.compile(rf"-[ \t]+({_NUMBER})\s*\n\s*-[ \t]+({_NUMBER})\s*\n\s*-[ \t]+({_NUMBER})")


def _three_numbers(text: Optional[str], expected: str) -> List[float]:
    """Read a YAML sequence of three finite numbers, ``[1, 2, 3]`` or a line ``- 1`` for each."""
    if text is None:
        raise BadGoal(f"the message has no goal: expected {expected} as generic_goal")
    body = text.strip()
    if body.startswith("---"):  # the beginning of a YAML document
        body = body[3:].lstrip()
    short = len(body) <= _LONGEST_LIST
    match = (_FLOW_LIST.fullmatch(body) or _BLOCK_LIST.fullmatch(body)) if short else None
    numbers = [float(number) for number in match.groups()] if match else []
    if not numbers or not all(map(math.isfinite, numbers)):
        raise BadGoal(f"the goal is {text[:80]!r}: expected {expected}, in numbers")
    return numbers


def check_result(benchmark: str, result: Result) -> None:
    """Raise ValueError, with the remedy, for a result that does not fit `benchmark` or a message."""
    fitting = {ResultForm.OBJECT: HopfResult, ResultForm.PERSON: HppfResult}.get(profile_of(benchmark).result)
    if isinstance(result, (HopfResult, HppfResult)) and not (fitting and isinstance(result, fitting)):
        raise ValueError(f"a {type(result).__name__} is not a result of {benchmark}")
    if not isinstance(result, (type(None), str, HopfResult, HppfResult)):
        raise ValueError(f"a result must be None, a text, a HopfResult or a HppfResult, not {result!r}")
    try:
        size = result_size(result)
    except (UnicodeEncodeError, TypeError) as error:
        raise ValueError(f"the result {result!r} cannot be sent: {error}") from None
    if size > RESULT_BUDGET_BYTES:
        raise ValueError(
            f"the result has {size} bytes, "
            f"but at most {RESULT_BUDGET_BYTES} fit into a message: shorten its texts"
        )


def result_size(result: Result) -> int:
    """The size of a result in a message (bytes). Raises what `write_result` raises."""
    trial = pb.RobotState()
    write_result(trial, result)
    return len(trial.SerializePartialToString())


def write_result(message: pb.RobotState, result: Result) -> None:
    """Write `result` to `message` in all forms that boxes read."""
    if isinstance(result, str):
        message.generic_result = result
    elif isinstance(result, HopfResult):
        message.object_class = result.object_class
        message.object_name = result.object_name
        message.object_pose_x, message.object_pose_y, message.object_pose_theta = result.pose
        message.generic_result = _flow_map(
            ("class", result.object_class), ("instance", result.object_name), *zip(Pose._fields, result.pose)
        )
    elif isinstance(result, HppfResult):
        message.generic_result = _flow_map(
            ("person_name", result.person_name), *zip(Pose._fields, result.pose)
        )


def _flow_map(*items: Tuple[str, Union[str, float]]) -> str:
    return "{" + ", ".join(f"{key}: {_scalar(value)}" for key, value in items) + "}"


def _scalar(value: Union[str, float]) -> str:
    """Format a YAML scalar so that all YAML libraries read the same text or number."""
    if isinstance(value, str):
        if not value.isprintable():
            raise ValueError(f"{value!r} contains unprintable characters")
        return json.dumps(value, ensure_ascii=False)
    if not math.isfinite(value):
        raise ValueError(f"{value} is not valid in a pose: use finite numbers of metres and radians")
    number = repr(float(value))
    # PyYAML reads 1e-07 as text, because YAML 1.1 requires a point in a number.
    return number if "." in number else number.replace("e", ".0e")
