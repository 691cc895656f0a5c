"""The requests of a benchmarking module: a goal for the robot, manual operations, and switches to enter.

These are plain records of requests and their outcomes. The run decides what follows.
"""

from dataclasses import dataclass, field
from typing import List, Optional, Tuple

from roah_rsbb.core.runs.clock import Countdown, CountdownState
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import GoalMessage
from roah_rsbb.model.modules import Request
from roah_rsbb.model.reason import Refused, say

# Bytes for the rest of a datagram that carries a goal: frame, cipher, code, state, acknowledgement, a pose.
GOAL_OVERHEAD = 140
# No referee makes more changes. Something is lying on the keyboard.
MAX_CHANGES = 1000


@dataclass
class GoalState:
    """The progress of a goal."""

    clock: CountdownState = field(default_factory=CountdownState)
    told: Optional[Now] = None  # when the robot was first asked to execute


class RunningGoal:
    """A goal under way."""

    def __init__(self, request: Request, state: Optional[GoalState] = None) -> None:
        self.state = state or GoalState()
        self.request = request
        self.message = GoalMessage(request.goal, request.pose, request.initial_state, request.switches)
        self.clock = Countdown(request.timeout or float("inf"), self.state.clock)

    def start(self, now: Now) -> None:
        """Start the countdown if the goal has a timeout."""
        if self.request.timeout:
            self.clock.start(now)

    def executing_s(self, mono: float) -> float:
        """Return for how many seconds the robot has been executing the goal at `mono` (s); 0.0: not yet."""
        told = self.state.told
        return 0.0 if told is None else max(0.0, mono - told.mono)


@dataclass
class SwitchesState:
    """The referee's entries."""

    initial_state: Tuple[bool, ...]
    changed: List[int] = field(default_factory=list)
    damaged: int = 0


class NumberedSwitches:
    """The switches as the referee sees them, numbered from 1."""

    def __init__(self, state: SwitchesState) -> None:
        self.state = state

    @property
    def changed(self) -> List[int]:
        """The switches that changed, in order. A switch that changed twice occurs twice."""
        return self.state.changed

    @property
    def damaged(self) -> int:
        """How many switches were damaged."""
        return self.state.damaged

    def press(self, switch: int) -> None:
        """Note that the referee saw a switch change. Raises `Refused`."""
        count = len(self.state.initial_state)
        if not 1 <= switch <= count:
            raise Refused([say("there is no switch {switch}: they are numbered 1 to {count}")(
                switch=switch, count=count)])
        if len(self.changed) >= MAX_CHANGES:
            raise Refused([say("no more than {most} changes of switches can be entered")(most=MAX_CHANGES)])
        self.changed.append(switch)

    @property
    def on(self) -> Tuple[int, ...]:
        """The switches that are on now."""
        states = enumerate(self.state.initial_state, 1)
        return tuple(number for number, on in states if on ^ (self.changed.count(number) % 2 == 1))
