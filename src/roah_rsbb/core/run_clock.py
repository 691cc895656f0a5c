"""The times of a run: its countdown, and the watch on the robot's offline data.

Both use the monotonic clock only (architecture, rule 4).
"""

from typing import Optional

from roah_rsbb.core.clock import Now
from roah_rsbb.core.messages import RobotReport
from roah_rsbb.core.settings import Settings
from roah_rsbb.states import BoxState, RobotState


class RunClock:
    """Counts from the first start to the timeout. Stopped time counts (wire protocol, State machines)."""

    def __init__(self, timeout: float, after_stop: float) -> None:
        self._timeout = timeout
        self._after_stop = after_stop
        self._deadline: Optional[float] = None
        self._stopped_at: Optional[float] = None

    def start(self, now: Now) -> None:
        """The first start sets the deadline, a later one keeps it."""
        if self._deadline is None:
            self._deadline = now.mono + self._timeout
        self._stopped_at = None

    def stop(self, now: Now) -> None:
        """The run was stopped; the deadline stays."""
        self._stopped_at = now.mono

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) of the timeout; None: not started yet."""
        return self._deadline

    def is_over(self, now: Now) -> bool:
        """Whether the run's time is up."""
        return self._deadline is not None and now.mono >= self._deadline

    def left(self, now: Now, ended: bool) -> float:
        """Seconds left until the timeout or, in a run that ended, of the time after the stop; at least 0."""
        if ended and self._stopped_at is not None:
            return max(0.0, self._stopped_at + self._after_stop - now.mono)
        if self._deadline is None:
            return self._timeout
        return max(0.0, self._deadline - now.mono)


class SavingWatch:
    """Ends a run whose robot executes for some time with `messages_saved` at 0 (manual, section 1)."""

    def __init__(self, settings: Settings) -> None:
        self._timeout = settings.check_messages_saved_timeout if settings.check_messages_saved else None
        self._since: Optional[float] = None

    def see(self, now: Now, box: BoxState, report: RobotReport) -> None:
        """Take a fresh message of the robot."""
        executing = box is BoxState.WAITING_RESULT and report.state is RobotState.EXECUTING
        if not executing or report.messages_saved > 0:
            self._since = None
        elif self._since is None:
            self._since = now.mono

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) at which the run ends if nothing is saved before."""
        if self._timeout is None or self._since is None:
            return None
        return self._since + self._timeout

    def is_over(self, now: Now) -> bool:
        """Whether the robot has saved nothing for too long."""
        deadline = self.deadline()
        return deadline is not None and now.mono >= deadline
