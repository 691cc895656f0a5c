"""The times of a run: its countdowns, the check that the robot saves offline data, and what the rules say besides the
timeout: setup time, pauses, phases (docs/organiser.md, "Time and attempts").

All of them use the monotonic clock only (docs/architecture.md, "Two clocks"). Setup time counts from *connect* to the
first *start*. A phase counts while the run's clock does, also beyond its limit: the referee is warned, and decides when
the next phase begins. Each start begins with the first phase.
"""

from dataclasses import dataclass, field
from typing import List, NamedTuple, Optional, Tuple

from roah_rsbb.core.settings import Settings
from roah_rsbb.model.clock import Mono, Now
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.model.reason import say
from roah_rsbb.model.records import PhaseTime
from roah_rsbb.model.zone import Count
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.rulebook.benchmarks import NO_LIMIT, EventRules, PhaseRule
from roah_rsbb.wording import times


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


# Why the clock is paused.
BY_REFEREE = say("by the referee")
SETUP_OVER = say("The setup time of {time} is over")
PHASE_OVER = say("The {time} of {phase} are over")
PHASE = say("phase {number} of {all}, {name}")
IN_PHASE = say("Phase {number} of {all}, {name}: {desc}")


@dataclass
class PhaseState:
    """The state of a phase that has begun."""

    began_utc: float  # UTC seconds
    clock: CountdownState = field(default_factory=CountdownState)
    is_over: bool = False  # its limit is over, and the referee was warned


@dataclass
class TimesState:
    """The state of the rules' times."""

    setup: CountdownState = field(default_factory=CountdownState)
    setup_is_over: bool = False  # the referee was warned
    paused: bool = False  # by the referee
    phase: int = 0  # number of the current phase, from 1; 0: none, or the run is not in progress
    phases: List[PhaseState] = field(default_factory=list)  # those that have begun since the last start


class PhaseView(NamedTuple):
    """The current phase as the referee sees it."""

    number: int  # from 1
    name: str
    limit: float  # seconds; `NO_LIMIT`: none
    elapsed: Count


class RunTimes:
    """Setup time, pauses and phases of one run."""

    def __init__(self, rules: EventRules, state: TimesState) -> None:
        self.state = state
        self.rules = rules
        self._setup = Countdown(NO_LIMIT, state.setup)
        self._clocks = [Countdown(NO_LIMIT, phase.clock) for phase in state.phases]

    # -- events -------------------------------------------------------------------------------------

    def connected(self, now: Now) -> None:
        """Begin the setup time, if the rules have one."""
        if self.rules.setup_time:
            self._setup.start(now)

    def started(self, now: Now) -> None:
        """End the setup time, and begin the first phase."""
        self._setup.pause(now)
        self.state.paused = False
        self.state.phase, self.state.phases, self._clocks = 0, [], []
        if self.rules.phases:
            self.go_to(now, 1)

    def ended(self, now: Now) -> None:
        """The run ended: nothing counts any more."""
        self._setup.pause(now)
        self.state.paused = False
        self.set_paused(now, True)
        self.state.phase = 0

    def set_paused(self, now: Now, paused: bool) -> None:
        """Pause or resume the current phase, together with the run's clock."""
        if self.state.phase:
            self._clocks[self.state.phase - 1].set_paused(now, paused)

    def go_to(self, now: Now, number: int) -> None:
        """Make a phase the current one: the next one, or an earlier one, which continues its time."""
        is_paused = bool(self.state.phase) and self._clocks[self.state.phase - 1].paused
        self.set_paused(now, True)
        self.state.phase = number
        if number > len(self.state.phases):
            phase = PhaseState(now.utc)
            self.state.phases.append(phase)
            self._clocks.append(Countdown(NO_LIMIT, phase.clock))
            self._clocks[-1].start(now)
        self.set_paused(now, is_paused)

    # -- time ---------------------------------------------------------------------------------------

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) at which the next limit is over; None: no limit is counted."""
        found = (self._setup_deadline(), self._phase_deadline())
        return min((t for t in found if t is not None), default=None)

    def tick(self, now: Now) -> List[str]:
        """Return the warnings about limits that are over since the last call."""
        found = []
        deadline = self._setup_deadline()
        if deadline is not None and now.mono >= deadline:
            self.state.setup_is_over = True
            found.append(self._setup_text())
        deadline = self._phase_deadline()
        if deadline is not None and now.mono >= deadline:
            self.state.phases[self.state.phase - 1].is_over = True
            found.append(self._phase_text())
        return found

    def _setup_deadline(self) -> Optional[float]:
        return None if self.state.setup_is_over else self._setup.moment(self.rules.setup_time)

    def _phase_deadline(self) -> Optional[float]:
        number = self.state.phase
        if not number or self.state.phases[number - 1].is_over or self._rule.limit == NO_LIMIT:
            return None
        return self._clocks[number - 1].moment(self._rule.limit)

    # -- looking ------------------------------------------------------------------------------------

    @property
    def _rule(self) -> PhaseRule:
        return self.rules.phases[self.state.phase - 1]

    @property
    def in_setup(self) -> bool:
        """Whether the setup time counts."""
        return self._setup.counting

    def setup_elapsed(self, now: Now) -> Count:
        """Seconds of the setup time so far, also beyond its limit."""
        return self._setup.count(now)

    def setup_left(self, now: Now) -> float:
        """Seconds left of the setup time, at least 0."""
        return max(0.0, self.rules.setup_time - self._setup.elapsed(now))

    def warnings(self) -> List[str]:
        """Return what the referee should know now: which limits are over."""
        found = [self._setup_text()] if self.state.setup_is_over and self._setup.counting else []
        number = self.state.phase
        is_over = bool(number) and self.state.phases[number - 1].is_over and self._clocks[number - 1].counting
        return found + ([self._phase_text()] if is_over else [])

    def _setup_text(self) -> str:
        return SETUP_OVER(time=times.countdown(self.rules.setup_time))

    def _phase_text(self) -> str:
        return PHASE_OVER(time=times.countdown(self._rule.limit), phase=self.phase_name())

    def phase_name(self) -> str:
        """Return the current phase in words; empty: none."""
        number = self.state.phase
        return PHASE(number=number, all=len(self.rules.phases), name=self._rule.name) if number else ""

    def described(self, desc: str) -> str:
        """Return the description of a state, with the current phase."""
        number = self.state.phase
        return IN_PHASE(number=number, all=len(self.rules.phases), name=self._rule.name, desc=desc) if number else desc

    def phase(self, now: Now) -> Optional[PhaseView]:
        """Return the current phase; None: there is none."""
        number = self.state.phase
        if not number:
            return None
        return PhaseView(number, self._rule.name, self._rule.limit, self._clocks[number - 1].count(now))

    def record(self, now: Now) -> Tuple[PhaseTime, ...]:
        """Return the times of the phases so far."""
        return tuple(
            PhaseTime(rule.name, phase.began_utc, clock.elapsed(now))
            for rule, phase, clock in zip(self.rules.phases, self.state.phases, self._clocks)
        )
