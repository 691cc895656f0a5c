"""The times of a run: its countdowns, and the check that the robot saves offline data.

Both use the monotonic clock only (docs/architecture.md, "Two clocks").
"""

from dataclasses import dataclass
from typing import Optional

from roah_rsbb.core.settings import Settings
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.model.saved import Mono
from roah_rsbb.model.zone import Count
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.rulebook.benchmarks import NO_LIMIT


@dataclass
class CountdownState:
    """The state of a countdown."""

    deadline: Optional[Mono] = None  # without further pauses; without a limit, the start; None: not started
    paused_at: Optional[Mono] = None
    stopped_at: Optional[Mono] = None  # of a run's clock only


class Countdown:
    """Counts from its start to its end, except while it is paused. Without a limit (`NO_LIMIT`) it has no end."""

    def __init__(self, seconds: float, state: Optional[CountdownState] = None) -> None:
        self._seconds = seconds
        self._span = 0.0 if seconds == NO_LIMIT else seconds  # from the start to `state.deadline`
        self.state = state or CountdownState()

    def start(self, now: Now) -> None:
        """Start counting. Later calls have no effect."""
        if self.state.deadline is None:
            self.state.deadline = now.mono + self._span

    def pause(self, now: Now) -> None:
        """Stop counting until `resume`."""
        if self.state.deadline is not None and self.state.paused_at is None:
            self.state.paused_at = now.mono

    def resume(self, now: Now) -> None:
        """Continue counting."""
        if self.state.paused_at is not None and self.state.deadline is not None:
            self.state.deadline += now.mono - self.state.paused_at
            self.state.paused_at = None

    def set_paused(self, now: Now, paused: bool) -> None:
        """Pause or resume, whichever state it is in."""
        (self.pause if paused else self.resume)(now)

    @property
    def limit(self) -> float:
        """Seconds from its start to its end, without pauses."""
        return self._seconds

    @property
    def counting(self) -> bool:
        """Whether it was started and is not paused."""
        return self.state.deadline is not None and not self.paused

    @property
    def paused(self) -> bool:
        """Whether the countdown is paused."""
        return self.state.paused_at is not None

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) of the end; None: not started, paused, or without a limit."""
        return None if self._seconds == NO_LIMIT else self.moment(self._seconds)

    def moment(self, elapsed: float) -> Optional[float]:
        """Monotonic time (s) at which `elapsed` seconds are counted; None: not started, or paused."""
        if self.state.deadline is None or self.paused:
            return None
        return self.state.deadline + (elapsed - self._span)

    def is_over(self, now: Now) -> bool:
        """Whether the time is up."""
        deadline = self.deadline()
        return deadline is not None and self._at(now) >= deadline

    def left(self, now: Now) -> float:
        """Seconds left, at least 0."""
        if self.state.deadline is None or self._seconds == NO_LIMIT:
            return self._seconds
        return max(0.0, self.state.deadline - self._at(now))

    def elapsed(self, now: Now) -> float:
        """Seconds counted so far, at most the whole countdown."""
        if self._seconds == NO_LIMIT:
            return 0.0 if self.state.deadline is None else self._at(now) - self.state.deadline
        return self._seconds - self.left(now)

    def count(self, now: Now) -> Count:
        """Return the seconds counted so far, as a value that stays the same while they count."""
        began = self.moment(0.0)
        return Count(self.elapsed(now)) if began is None else Count(0.0, began)

    def _at(self, now: Now) -> float:
        """Return the monotonic time (s) up to which it has counted."""
        return now.mono if self.state.paused_at is None else self.state.paused_at


class RunCountdown(Countdown):
    """Counts from the first start to the timeout. It keeps counting after a stop (docs/protocol.md, "State
    machines"), unless the rules say otherwise."""

    def __init__(
        self, timeout: float, after_stop: float, state: Optional[CountdownState] = None, stops: bool = False
    ) -> None:
        """`stops`: it does not count from a stop to the next start."""
        super().__init__(timeout, state)
        self._after_stop = after_stop
        self._stops = stops

    def start(self, now: Now) -> None:
        """Set the deadline at the first start. Later starts keep it, or move it by the time since the stop."""
        super().start(now)
        if self._stops and self.state.stopped_at is not None:
            assert self.state.deadline is not None, "it was set just now"
            self.state.deadline += now.mono - self.state.stopped_at
        self.state.stopped_at = None

    def stop(self, now: Now) -> None:
        """Note that the run was stopped. The deadline stays, and a pause ends."""
        self.resume(now)
        self.state.stopped_at = now.mono

    def _at(self, now: Now) -> float:
        return self.state.stopped_at if self._stops and self.state.stopped_at is not None else super()._at(now)

    def after_stop(self, now: Now) -> float:
        """Seconds left of the time after the stop, at least 0."""
        return 0.0 if self.state.stopped_at is None else max(0.0, self.state.stopped_at + self._after_stop - now.mono)

    @property
    def after_stop_until(self) -> Optional[float]:
        """Monotonic time (s) at which the time after the stop is over; None: it was not stopped."""
        return None if self.state.stopped_at is None else self.state.stopped_at + self._after_stop

    def shown(self, now: Now, ended: bool) -> float:
        """Return the seconds left until the timeout or, if the run ended, of the time after the stop; at least 0."""
        return self.after_stop(now) if ended and self.state.stopped_at is not None else self.left(now)


class SavingWatch:
    """Ends a run if its robot executes for some time with `messages_saved` at 0 (docs/protocol.md, "Timing")."""

    def __init__(self, settings: Settings, is_required: bool = True) -> None:
        """`is_required`: whether robots must save offline data in this benchmark."""
        checks = settings.check_messages_saved and is_required
        self._timeout = settings.check_messages_saved_timeout if checks else None
        self._since: Optional[float] = None

    def see(self, now: Now, box: BoxState, report: RobotReport) -> None:
        """Take a fresh message from the robot."""
        executing = box is BoxState.WAITING_RESULT and report.state is RobotState.EXECUTING
        if not executing or report.messages_saved > 0:
            self._since = None
        elif self._since is None:
            self._since = now.mono

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) at which the run ends unless the robot saves something before."""
        if self._timeout is None or self._since is None:
            return None
        return self._since + self._timeout

    def is_over(self, now: Now) -> bool:
        """Whether the robot has saved nothing for too long."""
        deadline = self.deadline()
        return deadline is not None and now.mono >= deadline
