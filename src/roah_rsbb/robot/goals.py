"""Goals as robots read them and results as they write them (docs/protocol.md, "Goals and results").

The generations differ: robots and boxes of 2014 and 2015 have fields of their own, those of 2019 YAML
texts. A goal is accepted in either form, a result is sent in both. The YAML is so small that no YAML
library is needed: three numbers in a list are read here, in flow and in block style, and a map is
written as JSON, which YAML contains.
"""

import json
import math
import re
from typing import List, NamedTuple, Optional, Tuple, Union

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb


class BadGoal(Exception):
    """A goal that cannot be read; str() says what was found and what was expected."""


class Pose(NamedTuple):
    """A place on the plane: metres and radians."""

    x: float
    y: float
    theta: float


class Goal(NamedTuple):
    """What is to be done in one goal. Fields that the benchmark does not use are None or empty."""

    text: Optional[str] = None  # the goal as YAML: any goal of a 2019 box, the only form in STB
    pose: Optional[Pose] = None  # HNF: the waypoint. HGMF: where the object goes (theta is 0)
    object_id: Optional[int] = None  # HGMF: the object to grasp
    initial_state: Tuple[bool, ...] = ()  # HOMF: of the switches
    switches: Tuple[int, ...] = ()  # HOMF: to toggle, in this order


class HopfResult(NamedTuple):
    """What the robot perceived in HOPF."""

    object_class: str
    object_name: str  # the instance
    pose: Pose


class HppfResult(NamedTuple):
    """Whom the robot saw in HPPF, and where."""

    person_name: str
    pose: Pose


# A plain text is sent as it is, as `generic_result` (STB).
Result = Union[None, str, HopfResult, HppfResult]

# Bytes that a result may take in a message, of the 987 that there are (docs/protocol.md, "Frame").
RESULT_BUDGET_BYTES = 400


def read_goal(message: pb.BenchmarkState) -> Goal:
    """The goal in a GOAL_TX message; `BadGoal` where the benchmark needs one and it cannot be read."""
    text = message.generic_goal if message.HasField("generic_goal") else None
    if message.benchmark_type == "HNF":
        return Goal(text=text, pose=_waypoint(message, text))
    if message.benchmark_type == "HGMF":
        x, y, object_id = _three_numbers(text, "[x, y, object_id]")
        if not object_id.is_integer() or not 0 <= object_id <= 65535:
            raise BadGoal(f"the object in {text!r} is no number from 0 to 65535")
        return Goal(text=text, pose=Pose(x, y, 0.0), object_id=int(object_id))
    return Goal(text=text, initial_state=tuple(message.initial_state), switches=tuple(message.switches))


def _waypoint(message: pb.BenchmarkState, text: Optional[str]) -> Pose:
    """The waypoint of 2015 if it is there, or else that of 2019."""
    if all(message.HasField(field) for field in ("target_pose_x", "target_pose_y", "target_pose_theta")):
        pose = Pose(message.target_pose_x, message.target_pose_y, message.target_pose_theta)
        if all(map(math.isfinite, pose)):
            return pose
        raise BadGoal(f"the waypoint {tuple(pose)} is not finite")
    return Pose(*_three_numbers(text, "[x, y, theta]"))


_LONGEST_LIST = 200  # characters: three numbers need no more, and a pattern's work stays small
_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?"
_FLOW_LIST = re.compile(rf"\[\s*({_NUMBER})\s*,\s*({_NUMBER})\s*,\s*({_NUMBER})\s*,?\s*\]")
_BLOCK_LIST = re.compile(rf"-[ \t]+({_NUMBER})\s*\n\s*-[ \t]+({_NUMBER})\s*\n\s*-[ \t]+({_NUMBER})")


def _three_numbers(text: Optional[str], expected: str) -> List[float]:
    """Read a YAML sequence of three finite numbers, ``[1, 2, 3]`` or a line ``- 1`` for each."""
    if text is None:
        raise BadGoal(f"there is no goal in the message: expected {expected} as generic_goal")
    body = text.strip()
    if body.startswith("---"):  # the mark of a YAML document's beginning
        body = body[3:].lstrip()
    short = len(body) <= _LONGEST_LIST
    match = (_FLOW_LIST.fullmatch(body) or _BLOCK_LIST.fullmatch(body)) if short else None
    numbers = [float(number) for number in match.groups()] if match else []
    if not numbers or not all(map(math.isfinite, numbers)):
        raise BadGoal(f"the goal is {text[:80]!r}: expected {expected}, in numbers")
    return numbers


def check_result(benchmark: str, result: Result) -> None:
    """Raise ValueError, with the remedy, for a result that does not fit `benchmark` or a message."""
    fitting = {"HOPF": HopfResult, "HPPF": HppfResult}.get(benchmark)
    if isinstance(result, (HopfResult, HppfResult)) and not (fitting and isinstance(result, fitting)):
        raise ValueError(f"a {type(result).__name__} is no result of {benchmark}")
    if not isinstance(result, (type(None), str, HopfResult, HppfResult)):
        raise ValueError(f"a result is None, a text, a HopfResult or a HppfResult, not {result!r}")
    trial = pb.RobotState()
    try:
        write_result(trial, result)
    except (UnicodeEncodeError, TypeError) as error:
        raise ValueError(f"the result {result!r} cannot be sent: {error}") from None
    if len(trial.SerializePartialToString()) > RESULT_BUDGET_BYTES:
        raise ValueError(
            f"the result takes {len(trial.SerializePartialToString())} bytes of a message, "
            f"at most {RESULT_BUDGET_BYTES} fit: shorten its texts"
        )


def write_result(message: pb.RobotState, result: Result) -> None:
    """Put `result` into `message`, in every form that boxes read."""
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
    """A YAML scalar that every YAML library reads back as the same text or number."""
    if isinstance(value, str):
        if not value.isprintable():
            raise ValueError(f"{value!r} holds characters that cannot be printed")
        return json.dumps(value, ensure_ascii=False)
    if not math.isfinite(value):
        raise ValueError(f"{value} is no place: a pose has finite numbers of metres and radians")
    number = repr(float(value))
    # PyYAML takes 1e-07 for a text, as YAML 1.1 wants a point in a number.
    return number if "." in number else number.replace("e", ".0e")
