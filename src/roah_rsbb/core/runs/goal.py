"""A goal under way in a functionality benchmark: what the robot is sent, and how long it may take."""

from typing import NamedTuple, Optional

from roah_rsbb.core.clock import Now
from roah_rsbb.core.messages import GoalMessage
from roah_rsbb.core.modules.messages import Request
from roah_rsbb.core.runs.clock import Countdown, CountdownState

# What else is in a datagram that carries a goal: frame, cipher, code, state, acknowledgement, a pose.
GOAL_OVERHEAD = 140


class GoalState(NamedTuple):
    """The saved state of a goal under way."""

    clock: CountdownState
    told: Optional[Now] = None


class Goal:
    """A goal under way."""

    def __init__(self, request: Request) -> None:
        self.request = request
        self.message = GoalMessage(request.goal, request.pose, request.initial_state, request.switches)
        self.clock = Countdown(request.timeout or float("inf"))
        self.told: Optional[Now] = None  # when the robot was first told to execute

    def start(self, now: Now) -> None:
        """From now on its time counts, if it has a timeout."""
        if self.request.timeout:
            self.clock.start(now)

    def saved(self) -> GoalState:
        """The state for the journal."""
        return GoalState(self.clock.saved(), self.told)

    @classmethod
    def restored(cls, request: Request, state: GoalState) -> "Goal":
        """The goal of this request, as it was saved."""
        goal = cls(request)
        goal.clock.restore(state.clock)
        goal.told = state.told
        return goal

    def executing_s(self, mono: float) -> float:
        """Seconds that the robot has executed it until `mono` (s); 0.0: it was not told to yet."""
        return 0.0 if self.told is None else max(0.0, mono - self.told.mono)
