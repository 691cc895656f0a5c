"""The messages that simulate the box in tests of a robot (`Session.override`), from a caller's numbers and texts."""

from typing import Iterable, Optional

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import WireTime
from roah_rsbb.robot.goals import BadGoal, read_goal
from roah_rsbb.robot.machine import IllegalEvent
from roah_rsbb.rulebook.registry import PROFILES


def override_message(
    number: int, state: int, acknowledgement: WireTime, initial_state: Iterable[bool], switches: Iterable[int]
) -> Optional[pb.BenchmarkState]:
    """Return the message that replaces the box's, for a benchmark's number; None (number 0) ends the override.

    Raises IllegalEvent, which names the known numbers.
    """
    if number == 0:
        return None
    codes = {profile.number: code for code, profile in PROFILES.items()}
    code = codes.get(number)
    if code is None:
        known = ", ".join(f"{number} {code}" for number, code in sorted(codes.items()))
        raise IllegalEvent(f"unknown benchmark number {number}: choose from {known}")
    message = _state_message(code, state, acknowledgement)
    message.initial_state.extend(initial_state)
    message.switches.extend(switches)
    return message


def override_goal_message(
    code: str, state: int, acknowledgement: WireTime, goal: str
) -> Optional[pb.BenchmarkState]:
    """Return the message that replaces the box's, with a goal (empty: none); None (empty code) ends the override.

    Raises IllegalEvent for an unknown state or an unreadable goal.
    """
    if not code:
        return None
    message = _state_message(code, state, acknowledgement)
    if goal:
        message.generic_goal = goal
        try:
            read_goal(message)
        except BadGoal as bad:
            raise IllegalEvent(str(bad)) from None
    return message


def _state_message(code: str, state: int, acknowledgement: WireTime) -> pb.BenchmarkState:
    if state not in pb.BenchmarkState.State.values():
        known = ", ".join(f"{number} {name}" for name, number in pb.BenchmarkState.State.items())
        raise IllegalEvent(f"unknown benchmark state {state}: choose from {known}")
    message = pb.BenchmarkState(benchmark_type=code, benchmark_state=state)
    message.acknowledgement.sec, message.acknowledgement.nsec = acknowledgement
    return message
