"""A run: one robot, one event of the schedule, from *connect* to *disconnect*.

`ZoneRun` is the interface of a run for zones, commands and views. `Run` implements it for a single robot,
`roah_rsbb.core.runs.all_robots.AllRobotsRun` for many members, and `roah_rsbb.core.runs.by_hand.HandRun` for none.

A `Run` contains the box's state machine, the run's clock, the score sheet and the robot's messages, and turns events
into effects. `roah_rsbb.core.commands` decides who may start or stop it, and when.
"""

import abc
import enum
import functools
from dataclasses import dataclass, field
from typing import Callable, List, NamedTuple, Optional, Sequence, Tuple, Union

from roah_rsbb.core import effects
from roah_rsbb.core.effects import Effect, How, Level
from roah_rsbb.core.link.freshness import Heard
from roah_rsbb.core.link.link import LinkState, RobotLink, TakenReport
from roah_rsbb.core.modules import RunningGoal
from roah_rsbb.core.robots import RobotId
from roah_rsbb.core.runs.machine import Reaction, RunEvent, following, react
from roah_rsbb.core.runs.reported import (
    MAX_SAID,
    DeviceCommands,
    DeviceCommandsState,
    Said,
    Strings,
    StringsBudget,
    receive,
    said,
    with_line,
)
from roah_rsbb.core.runs.times import BY_REFEREE, CountdownState, RunCountdown, RunTimes, SavingWatch, TimesState
from roah_rsbb.core.settings import Settings
from roah_rsbb.model import run_log
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import NO_GOAL, BoxMessage, GoalMessage, RobotReport
from roah_rsbb.model.reason import say
from roah_rsbb.model.records import (
    NOBODY,
    By,
    EndReason,
    ItemRecord,
    Occurred,
    Outage,
    Phase,
    RunRecord,
    ScoreValue,
)
from roah_rsbb.model.scoring import WHOLE
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, Restarts, ScheduledEvent
from roah_rsbb.scoring.book import BookState, Marked, Note, RunBook
from roah_rsbb.scoring.sheet import Mark, ScoreSheet, value_text
from roah_rsbb.wording import sheets, stop, times

# Types whose values are whole numbers, which `Score` holds.
WHOLE_WORDS = frozenset(kind.word for kind in WHOLE)
# See `Run.settled_at`.
NO_REVISION = -1
# The least interval between two warnings that messages of a robot were dropped.
DROPPED_PERIOD_S = 10.0
# For states of the box, the state that a robot leaves when it receives them. If it does not leave it for `STUCK_S`
# seconds, the referee gets a hint.
STUCK = {BoxState.PREPARE: RobotState.STOP, BoxState.GOAL_TX: RobotState.WAITING_GOAL}
STUCK_S = 10.0
# After a restart, no robot is asked to prepare before it reports, after this long, that it did not stop: until then, a
# STOP of the box before may be on its way to it, and that box may still hear that this one took over.
SETTLED_S = 2.0
IGNORES_STOP = say("The robot did not answer STOP: stop it by hand. The box repeats STOP until the disconnect")
STAYS_IN_STOP = say("The robot has stayed in STOP for {time} s after the start. Its program may not know benchmark "
                    "{code}, or may not be ready: check the robot's log")
NO_GOAL_TAKEN = say("The robot has not taken its goal for {time} s. Its program may be too old for the goals of "
                    "{code}: check the robot's log")
WAITING = say("Connected: waiting for the robot's first message")
PREPARING = say("Robot preparing for the task")
EXECUTING = say("Robot prepared, executing (no explicit goal)")
FELL_BACK = say("Robot fell back to {state}: preparing again")
ASKS = say("The robot reports STOP, and the box cannot know why: the referee decides")
STOPPED_ITSELF = say("The robot reports STOP, and the box cannot know why: it was restarted, or does not reach its "
                     "standby. If the run was stopped, press STOP. If it was not, continue the run: then the robot "
                     "prepares again, and may move")
UNHEARD = say("The box was restarted, and has not heard the robot since: it may have been stopped, or still be moving. "
              "If the run was stopped, press STOP. If it was not, continue the run: then the robot may move")
CONTINUED = say("The referee continues the run")
ALREADY_SENT = say("{end} (recorded after a restart)")
SAVED = say("Messages saved: {number}")


class OnlineField(NamedTuple):
    """A field of repeated strings: its name in the message, its topic in the log."""

    name: str
    topic: str


ONLINE_FIELDS = (
    OnlineField("notifications", run_log.NOTIFICATION),
    OnlineField("activation_event", run_log.ACTIVATION_EVENT),
    OnlineField("visitor", run_log.VISITOR),
    OnlineField("final_command", run_log.COMMAND),
)


class UnrecordedStop(NamedTuple):
    """A STOP that the box before sent, and did not record."""

    at: Now
    reason: EndReason = EndReason.STOPPED
    by: By = NOBODY


class Consequence(enum.Enum):
    """What came of a robot's message."""

    NONE = enum.auto()  # it was stale
    LINK_ONLY = enum.auto()  # what concerns the link, and the acknowledgement: it repeats the one before
    ANY = enum.auto()


class Assignment(NamedTuple):
    """The robot, the event and the place of a run."""

    zone: str
    event: ScheduledEvent
    robot: RobotId
    port: int  # UDP port of the private channel; it identifies the run in the whole competition

    def identity(self, now: Now) -> str:
        """Return the identity of the run that begins now. It is unique among all competitions."""
        return identity_of(self.event, self.port, now)


def identity_of(event: ScheduledEvent, port: int, now: Now) -> str:
    """Return the identity of a run that begins now; `port` is not used by another run of the competition."""
    return f"{event.benchmark.code}-{port}-{now.utc:.3f}"


def port_of(identity: str) -> int:
    """Return the port in the identity of a run; 0: it has none."""
    port = identity.rsplit("-", 2)[-2:][0]
    return int(port) if port.isdecimal() else 0


@dataclass
class RunState:
    """The state and the results of a run so far."""

    port: int
    robot: RobotId
    identity: str  # unique among all competitions
    opened_utc: float  # UTC seconds of *connect*
    phase: Phase
    end_reason: Optional[EndReason]
    desc: str  # describes the state of the run in one line
    message: BoxMessage  # what the box sends
    link: LinkState
    clock: CountdownState
    book: BookState
    log: str = ""
    online_data: str = ""
    devices: DeviceCommandsState = field(default_factory=DeviceCommandsState)
    strings: Strings = field(default_factory=dict)
    said: List[Said] = field(default_factory=list)  # the newest texts of the robot since the start of the run
    times: TimesState = field(default_factory=TimesState)
    # In progress since before a restart, or another box may command it: a robot that stopped is not asked to prepare
    # again.
    doubted: bool = False
    away_s: float = 0.0  # for so long the box was away since the robot's last message (s)
    asks: bool = False  # the robot reported STOP in such a run: the referee decides


def new_state(now: Now, assignment: Assignment) -> RunState:
    """Return the state of a run that is connected now."""
    return RunState(
        assignment.port, assignment.robot, assignment.identity(now), now.utc, Phase.CONNECTED, None, "",
        BoxMessage(assignment.event.benchmark.code, BoxState.STOP), LinkState(), CountdownState(), BookState(),
    )


@dataclass
class ZoneRunState:
    """The state of a run besides its robots."""

    identity: str
    opened_utc: float
    phase: Phase
    end_reason: Optional[EndReason]
    desc: str
    clock: CountdownState
    book: BookState
    log: str = ""
    online_data: str = ""
    times: TimesState = field(default_factory=TimesState)


@dataclass
class AllRobotsState(ZoneRunState):
    """The state of a run of all robots."""

    members: List[RunState] = field(default_factory=list)


class RunContext(NamedTuple):
    """The parts of the box that a run uses."""

    settings: Settings

    emit: Callable[[Effect], None]
    revision: Callable[[], int]  # rises with everything that happens to the run, but for reports that say nothing new
    show_map: Callable[[bool], bool]  # sets the tablet's view (True: map); returns whether it showed the other one
    last_beacon: Optional[Callable[[RobotId], Optional[float]]]  # see `ActiveRobots.last_beacon`; None: not known
    heard: Heard
    may_be_replaced: Callable[[Now], bool]  # see `Copies`


class ZoneRun(abc.ABC):
    """The run in a zone. It is scored, ended and recorded as a whole."""

    def __init__(
        self, zone: str, event: ScheduledEvent, context: RunContext, state: Union[RunState, ZoneRunState]
    ) -> None:
        settings, rules = context.settings, event.benchmark.rules
        self.state = state
        self.zone = zone
        self.event = event
        self.clock = RunCountdown(event.benchmark.total_timeout, settings.after_stop_duration, state.clock,
                                  stops=rules.restarts is Restarts.CLOCK_STOPS)
        self.times = RunTimes(rules, state.times)
        self.book = RunBook(event.benchmark.form, state.book)
        self._display_size = settings.display_log_size
        self._emit = context.emit
        self._closed_utc = 0.0

    # -- looking ------------------------------------------------------------------------------------

    @property
    def identity(self) -> str:
        """The identity of the run, unique among all competitions."""
        return self.state.identity

    @property
    def opened_utc(self) -> float:
        """UTC seconds of *connect*."""
        return self.state.opened_utc

    @property
    def phase(self) -> Phase:
        """The phase of the run."""
        return self.state.phase

    @property
    def end_reason(self) -> Optional[EndReason]:
        """Why the run ended; None: it has not ended."""
        return self.state.end_reason

    @property
    def desc(self) -> str:
        """A description of the run's state in one line."""
        return self.state.desc

    @property
    def log(self) -> str:
        """The last lines of the log, for panels."""
        return self.state.log

    @property
    def online_data(self) -> str:
        """The last lines of the robots' online data, for panels."""
        return self.state.online_data

    @property
    def sheet(self) -> ScoreSheet:
        """The referee's marks."""
        return self.book.sheet

    @abc.abstractmethod
    def members(self) -> Sequence["Run"]:
        """The runs of single robots in it, each with its own private channel."""

    def not_stopped(self) -> Tuple[str, ...]:
        """Return the names of the robots that do not report STOP."""
        return tuple(str(member.robot) for member in self.members() if member.robot_state is not RobotState.STOP)

    def ignores_stop(self, now: Now) -> List[str]:
        """Return a warning of each robot that should have reported STOP by now."""
        return [text for member in self.members() for text in member.ignores_stop(now)]

    @abc.abstractmethod
    def without(self, member: "Run") -> Optional["ZoneRun"]:
        """Return the run without one of its members, which was closed; None: no member is left."""

    @abc.abstractmethod
    def start_off(self, now: Now) -> List[str]:
        """Return why the run cannot be started. The reasons of its clock are not included."""

    @abc.abstractmethod
    def warnings(self, now: Now) -> List[str]:
        """Return the referee's current warnings."""

    @abc.abstractmethod
    def status_lines(self, now: Now) -> List[str]:
        """Return the status lines for the referee besides `desc` and the warnings."""

    def limit(self) -> float:
        """Seconds that the referee sees as the limit: of a goal, or of the run."""
        return self.event.benchmark.limit

    def timer(self, now: Now) -> float:
        """Seconds left until the timeout; before the start, of the setup time; once ended, of the time after the
        stop."""
        if self.times.in_setup:
            return self.times.setup_left(now)
        return self.clock.shown(now, ended=self.phase is Phase.ENDED)

    def doubt(self, now: Now) -> Optional[str]:
        """Return why the box cannot know, after a restart, whether the run continues; None: it knows."""
        return next((text for text in (member.doubt(now) for member in self.members()) if text), None)

    @property
    def is_doubted(self) -> bool:
        """Whether `doubt` has, or may soon have, a reason."""
        return any(member.is_doubted for member in self.members())

    @property
    def goal(self) -> Optional[RunningGoal]:
        """The goal under way; None: the robot has no goal with a time of its own."""
        return None

    @property
    def scores(self) -> Tuple[ScoreValue, ...]:
        """The scores of a benchmarking module."""
        return ()

    @property
    def why_paused(self) -> str:
        """Why the time of a run in progress does not count; empty: it counts."""
        return BY_REFEREE if self.times.state.paused else ""

    # -- time ---------------------------------------------------------------------------------------

    @abc.abstractmethod
    def deadline(self) -> Optional[float]:
        """The monotonic time (s) at which `tick` has something to do unless an event comes first."""

    @abc.abstractmethod
    def tick(self, now: Now) -> None:
        """Do what is due by now, in all members."""

    def _tick_times(self, now: Now) -> None:
        """Warn about time limits of the rules that are over."""
        for text in self.times.tick(now):
            self.say(now, Level.WARNING, text)

    # -- the referee's commands; the caller has checked that they are allowed --------------------------

    @abc.abstractmethod
    def start(self, now: Now, by: By = NOBODY) -> None:
        """Start, or start again after a stop. Since the stop the clock kept running, unless the rules say otherwise."""

    @abc.abstractmethod
    def stop(self, now: Now, by: By = NOBODY) -> None:
        """Stop the run."""

    @abc.abstractmethod
    def take_stop(self, sent: UnrecordedStop) -> None:
        """End a run in progress as the box before ended it."""

    def continue_run(self, now: Now, by: By = NOBODY) -> None:
        """Continue a run of which the box could not know whether it continues: see `doubt`."""
        for member in self.members():
            if member.doubt(now):
                member.continue_run(now)
        self.happened(now, Occurred.CONTINUE, by.who)

    @abc.abstractmethod
    def close(self, now: Now, by: By = NOBODY) -> None:
        """Leave the run. This closes all its channels."""

    def pause(self, now: Now, paused: bool, by: By = NOBODY) -> None:
        """Pause the clock of a run in progress, or resume it. The robot does not notice."""
        self.times.state.paused = paused
        self._set_pauses(now, by)
        self.say(now, Level.INFO, "Clock paused by the referee" if paused else "Clock resumed by the referee")

    def go_to_phase(self, now: Now, number: int, by: By = NOBODY) -> None:
        """Make a phase of the run in progress the current one."""
        self.times.go_to(now, number)
        self._describe(now, "begun by the referee")
        self.happened(now, Occurred.PHASE, by.who, self.times.rules.phases[number - 1].name)
        self._record_changed(now)

    def give_up(self, now: Now, reason: EndReason, by: By) -> None:
        """End a run that is not in progress because its team did not appear or withdrew."""
        self._enter(RunEvent.GIVE_UP, reason)
        self.times.ended(now)
        self.state.desc = reason.value
        self.book.ended(now, reason.name.lower(), reason.value, by, self.book.state.elapsed_s)
        self.say(now, Level.INFO, reason.value)
        self._record_changed(now)

    def _enter(self, event: RunEvent, reason: Optional[EndReason] = None) -> None:
        """Go to the phase after an event. `reason`: why the run ended. Raises `WrongPhase`, and changes nothing."""
        self.state.phase, self.state.end_reason = following(self.phase, event), reason

    def _set_pauses(self, now: Now, by: By = NOBODY) -> None:
        """Pause or resume what counts."""
        why, was_paused = self.why_paused, self.clock.paused
        self.clock.set_paused(now, bool(why))
        self.times.set_paused(now, bool(why))
        if self.phase is Phase.RUNNING and self.clock.paused is not was_paused:
            self.happened(now, Occurred.PAUSE if why else Occurred.RESUME, by.who, "" if by.who else why)

    def _describe(self, now: Now, desc: str) -> None:
        """Describe the state of the run, and the phase."""
        self.state.desc = self.times.described(desc)
        self.say(now, Level.INFO, self.state.desc)

    def warn(self, now: Now, text: str) -> None:
        """Log a problem of this run."""
        self.say(now, Level.WARNING, text)

    def mark(self, now: Now, who: str, mark: Mark) -> None:
        """Mark a scoring item. Raises `Refused` if the item or the value does not exist."""
        end = "" if self.end_reason is None else self.end_reason.name.lower()
        marked = self.book.mark(now, who, mark, self._counted_s(now), self.opened_utc, end)
        if marked.text:
            self._score_changed(now, marked)

    def note(self, now: Now, who: str, note: Note) -> None:
        """See `RunBook.note`. Raises `Refused`."""
        text = self.book.note(now, who, note, self._counted_s(now), self.opened_utc)
        if text:
            self.say(now, Level.INFO, text)
            self._record_changed(now)

    def happened(self, now: Now, what: Occurred, who: str = "", text: str = "") -> None:
        """See `RunBook.happened`."""
        self.book.happened(now, what, self._counted_s(now), who, text)

    def _counted_s(self, now: Now) -> Optional[float]:
        """Return the counted seconds of the run in progress; None: it is not."""
        return self.clock.elapsed(now) if self.phase is Phase.RUNNING else None

    def withdraw_score(self, now: Now, by: By, number: int) -> None:
        """Withdraw an entry of the score sheet. Raises `Refused`."""
        self._score_changed(now, self.book.withdraw(now, by, number))

    def say_in_time(self, now: Now, by: By, number: int, in_time: bool) -> None:
        """See `ScoreSheet.say_in_time`. Raises `Refused`."""
        self._score_changed(now, self.book.say_in_time(by.who, number, in_time))

    def take_back(self, now: Now, by: By, mark_id: str, _ago_ms: int = 0) -> None:
        """Take back a mark of the score sheet. Raises `Refused`."""
        marked = self.book.take_back(now, by, mark_id)
        if marked.text:
            self._score_changed(now, marked)

    def change_book(self, now: Now, change: Callable[[RunBook], str]) -> None:
        """Apply what judges did to the book, and enter what they agree on into the sheet. Raises `Refused`.

        `change` returns the text for the referees; empty: only the judge may know.
        """
        before = {item.key: item for item in self.sheet.items()}
        text = change(self.book)
        self.book.take_verdicts(now)
        if text:
            self.say(now, Level.INFO, text)
        for item in self.sheet.items():
            if item != before[item.key]:
                self._log_score(item)
        self._record_changed(now)

    def give_stop_reason(self, now: Now, by: By, number: int) -> None:
        """Set the reason why the run was stopped. Raises `Refused`."""
        self.say(now, Level.INFO, self.book.give_reason(number, by))
        self._record_changed(now)

    def _score_changed(self, now: Now, marked: Marked) -> None:
        if marked.item is not None:
            self._log_score(marked.item)
        self.say(now, Level.INFO, marked.text)
        self._record_changed(now)

    def _log_score(self, item: ItemRecord) -> None:
        for member in self.members():
            self._emit(effects.RunLogged(member.port, run_log.SCORE, (item.group, item.desc, item.value)))
            if item.kind not in WHOLE_WORDS:
                text = f"{item.group}: {item.desc}: {value_text(item)}"
                self._emit(effects.RunLogged(member.port, run_log.SCORE_TEXT, text))

    # -- texts --------------------------------------------------------------------------------------

    def say(self, now: Now, level: Level, text: str) -> None:
        """Log a line for the referee, in the log of the run and in the node's log."""
        mark = "" if level is Level.INFO else f"{level.name}: "
        self.state.log = with_line(self.state.log, f"{times.time_with_zone(now.utc)} {mark}{text}", self._display_size)
        self._emit(effects.Notice(level, text, self.zone))

    def show_online(self, now: Now, text: str) -> None:
        """Show online data to the referee."""
        line = f"{times.time_with_zone(now.utc)} {text}"
        self.state.online_data = with_line(self.state.online_data, line, self._display_size)

    # -- the record ---------------------------------------------------------------------------------

    @abc.abstractmethod
    def _robot_names(self) -> Sequence[str]: ...

    def record(self, now: Now) -> RunRecord:
        """Return the record of the run as if it ended now."""
        event = self.event
        record = self.book.into(RunRecord(
            self.identity, self.zone, event.benchmark.code, event.team, event.round, event.run, event.scheduled,
            self.opened_utc, closed_utc=self._closed_utc,
            end_reason="" if self.end_reason is None else self.end_reason.name.lower(),
            module_scores=self.scores, robots=tuple(self._robot_names()), phases=self.times.record(now), event=event.id,
        ))
        return record._replace(elapsed_s=self.clock.elapsed(now)) if self.phase is Phase.RUNNING else record

    def _note_start(self, now: Now, by: By) -> None:
        self.times.started(now)
        self.book.started(now)
        self.happened(now, Occurred.START, by.who)
        self._record_changed(now)

    def note_outage(self, now: Now, down_s: float) -> None:
        """Note that the box was away, during a run in progress, until now."""
        self.book.state.outages.append(Outage(now.utc - down_s, down_s, self._goal_number()))
        self._record_changed(now)

    def _leave_out_outage(self, now: Now, away_s: float) -> float:
        """A robot has completed its goal or task. `away_s`: for how long the box was away just before: the robot was
        done at some moment of it, which does not count as its time. Return it."""
        outages = self.book.state.outages
        if away_s and outages:
            outages[-1] = outages[-1]._replace(left_out_s=away_s)
            self.warn(now, sheets.outage_text(outages[-1]))
        return away_s

    def _goal_number(self) -> int:
        return 0

    def _note_end(self, now: Now, desc: str, by: By, left_out_s: float = 0.0) -> None:
        """Record that the run ended just now. `end_reason` must be set already. `left_out_s` do not count."""
        assert self.end_reason is not None, "it ended"
        self.times.ended(now)
        elapsed_s = max(0.0, self.clock.elapsed(now) - left_out_s)
        self.book.ended(now, self.end_reason.name.lower(), desc, by, elapsed_s)
        self._record_changed(now)

    def _note_close(self, now: Now, by: By) -> None:
        """Record that the run is left. This also stops a run in progress."""
        self._closed_utc = now.utc
        self.times.ended(now)
        if self.phase is Phase.RUNNING:
            self._enter(RunEvent.END, EndReason.STOPPED)
            self.book.ended(now, "stopped", EndReason.STOPPED.value, by, self.clock.elapsed(now))
        self._record_changed(now)

    def _record_changed(self, now: Now) -> None:
        self._emit(effects.RecordChanged(self.record(now)))


class Run(ZoneRun):
    """A run of a task benchmark: the robot gets no explicit goal."""

    state: RunState

    def __init__(
        self, now: Now, assignment: Assignment, context: RunContext, state: Optional[RunState] = None
    ) -> None:
        """`state` belongs to a run that continues after a restart of the core."""
        super().__init__(
            assignment.zone, assignment.event, context, new_state(now, assignment) if state is None else state)
        self.robot = assignment.robot
        self.port = assignment.port
        self.resumed = state is not None
        last_beacon = context.last_beacon
        self.link = RobotLink(context.settings.allowed_skew, now, self.state.link,
                              None if last_beacon is None else functools.partial(last_beacon, assignment.robot),
                              context.heard.begin(now, assignment.robot, self.state.link.clock(now)))
        self.saving = SavingWatch(context.settings, self.event.benchmark.profile.offline_data)
        self.devices = DeviceCommands(self.event.benchmark, self.state.devices)
        self._is_replayed = last_beacon is None
        self._show_map = context.show_map
        self._may_be_replaced = context.may_be_replaced
        self._strings_budget = StringsBudget()
        self._unused_strings = assignment.event.benchmark.unused_strings  # the referee was not warned about these yet
        self._dropped_strings = self._unread = 0
        self._say_dropped_from = float("-inf")  # monotonic time (s)
        # When the box's state changed last, or the core was restarted. A robot that a restarted core finds moving after
        # STOP has had its time to answer.
        self._state_mono = float("-inf") if self.resumed and self.phase is Phase.ENDED else now.mono
        self._hint_mono: Optional[float] = None  # when a warning that depends on time may begin: see `_hints_from`
        # Of a doubted run: the robot was heard, it continued after `SETTLED_S`, and what it has not been sent yet.
        self._opened_mono, self._is_heard, self._continued, self._is_withheld = now.mono, False, False, False
        self._last_logged: Optional[Tuple[RobotReport, bool]] = None
        self._revision = context.revision
        self._settled_at = NO_REVISION  # when the last report was taken again, and changed nothing

    @property
    def message(self) -> BoxMessage:
        """The message that the box currently sends."""
        return self.state.message

    def open(self, now: Now) -> None:
        """Begin a new run. A run from a saved state begins with `resume` instead."""
        # A run of all robots may include several robots of a team.
        name = self.robot.robot if self.event.team == ALL_TEAMS else ""
        self._emit(effects.RunOpened(self.port, self.robot.team, self.event.round, self.event.run, name))
        self.times.connected(now)
        self._record_changed(now)
        self._set_state(now, BoxState.STOP, WAITING)

    def resume(self) -> None:
        """Continue in the saved state. Nothing is sent to the robot of a run in progress before it was heard: the box
        before may have stopped it."""
        self._emit(effects.RunResumed(self.port))
        self.state.doubted = self._is_in_progress
        self.send(How.CHANGE)

    @property
    def _is_in_progress(self) -> bool:
        return self.phase is Phase.RUNNING

    def send(self, how: How) -> None:
        """Send the robot what the box says, if it may be sent: in a doubted run only what the robot already does."""
        is_prepare = self.message.state is BoxState.PREPARE
        if (self.state.doubted and self.message.state is not BoxState.STOP
                and not (self._continued if is_prepare else self._is_heard)):
            self._is_withheld = True
            return
        how, self._is_withheld = How.CHANGE if self._is_withheld else how, False
        self._emit(effects.SendState(self.port, self.message, how))

    def members(self) -> Tuple["Run", ...]:
        """See `ZoneRun`: this run is its only member."""
        return (self,)

    def without(self, member: "Run") -> None:
        """See `ZoneRun`: without its robot the run ends."""

    # -- the referee's commands; the caller has checked that they are allowed ------------------------

    def start(self, now: Now, by: By = NOBODY) -> None:
        """See `ZoneRun`."""
        self.state.doubted = self.state.asks = False
        self.clock.start(now)
        self.state.said.clear()
        self._enter(RunEvent.START)
        self._note_start(now, by)
        self._begin(now)

    def _begin(self, now: Now) -> None:
        self._set_state(now, BoxState.PREPARE, PREPARING)

    def stop(self, now: Now, by: By = NOBODY) -> None:
        """See `ZoneRun`."""
        self._end(now, EndReason.STOPPED, by=by)

    def take_stop(self, sent: UnrecordedStop) -> None:
        """See `ZoneRun`."""
        self._end(sent.at, sent.reason, ALREADY_SENT(end=sent.reason.value), sent.by)
        self._state_mono = float("-inf")  # the robot had its time to answer

    def continue_run(self, now: Now, by: By = NOBODY) -> None:
        """See `ZoneRun`."""
        self.happened(now, Occurred.CONTINUE, by.who)
        self.state.doubted, was_asked, self.state.asks = False, self.state.asks, False
        self._set_pauses(now)
        self.say(now, Level.INFO, CONTINUED)
        if was_asked:
            self._begin_again(now)
        else:
            self.send(How.CHANGE)

    def _begin_again(self, now: Now) -> None:
        """Let a robot that stopped prepare again."""
        self._begin(now)

    def close(self, now: Now, by: By = NOBODY) -> None:
        """Leave the run. The box sends no last message but STOP, if the run was in progress: robots do not believe the
        beacon alone, which anybody can forge."""
        self._note_close(now, by)
        if self.message.state is not BoxState.STOP:
            self._set_state(now, BoxState.STOP, EndReason.STOPPED.value)
        self.say(now, Level.INFO, "Disconnected")
        self._emit(effects.RunLogged(self.port, run_log.END, None))
        self._emit(effects.CloseChannel(self.port))
        self._emit(effects.RunClosed(self.port))

    # -- time ---------------------------------------------------------------------------------------

    def deadline(self) -> Optional[float]:
        """The monotonic time (s) at which `tick` has something to do unless an event comes first."""
        found = [self.link.deadline(), self.times.deadline(), self._hint_mono]
        if self.phase is Phase.RUNNING:
            found += [self.clock.deadline(), self.saving.deadline()]
        return min((t for t in found if t is not None), default=None)

    def tick(self, now: Now) -> None:
        """End the run if it has timed out or the robot saves nothing. If both are due, the earlier one counts."""
        if self._hint_mono is not None and now.mono >= self._hint_mono:
            self._hint_mono = None  # whoever shows the warnings looks after each tick
        for notice in self.link.tick(now):
            self.say(now, Level.WARNING, notice)
        self._tick_times(now)
        if self.phase is not Phase.RUNNING:
            return
        out_of_time, saves_nothing = self.clock.is_over(now), self.saving.is_over(now)
        if saves_nothing and not (out_of_time and self.clock.deadline() == min(self._ends())):
            self._end(now, EndReason.NO_MESSAGES_SAVED)
        elif out_of_time:
            self._time_out(now)

    def _ends(self) -> List[float]:
        """Return the monotonic times (s) at which the run ends by itself."""
        return [t for t in (self.clock.deadline(), self.saving.deadline()) if t is not None]

    def _time_out(self, now: Now) -> None:
        self._end(now, EndReason.TIMEOUT)
        self._emit(effects.TimeoutRung(self.zone))

    # -- the robot ----------------------------------------------------------------------------------

    def on_report(self, now: Now, host: str, report: RobotReport, arrival: Now) -> Consequence:
        """Take a message of the robot from `host`.

        `arrival`: when it arrived, for everything about the link. It takes effect `now`, which may be later.

        Three of four messages repeat the one before, but for their time. Their content is not taken if it had no
        consequence the last time that it was taken, and nothing has happened to the run since (`_settled_at`).
        """
        repeats = report[1:] == (self.link.last or ())[1:]
        heard = self.link.hear(arrival, host, report)
        for notice in heard.notices:
            self.say(now, Level.WARNING, notice)
        if not heard.fresh:
            return Consequence.NONE
        message = self.state.message
        self.state.message = BoxMessage(message.benchmark, message.state, report.time, message.goal)
        if heard.new_host:
            self._emit(effects.AimChannel(self.port, host))
        elif repeats and self._settled_at == self._revision():
            return Consequence.LINK_ONLY
        revision = self._revision()
        has_strings = self._take_content(now, report, heard)
        # The first time, a run may only note something. Strings are acknowledged at once each time.
        is_unsure = self.state.doubted and not self._continued
        is_settled = repeats and not has_strings and not is_unsure and revision == self._revision()
        self._settled_at = revision if is_settled else NO_REVISION
        return Consequence.ANY

    @property
    def settled_at(self) -> int:
        """The revision of the zone with which a report that repeats the last one has no consequence but for the link;
        `NO_REVISION`: it may have one."""
        return self._settled_at

    def _take_content(self, now: Now, report: RobotReport, heard: TakenReport) -> bool:
        """Take what a message says. Return whether it has strings."""
        before = self.message
        self._log_report(report)
        has_strings = self._take_strings(now, report)
        self._take_commands(now, report)
        if (report.state is RobotState.STOP and heard.state_changed and self._is_in_progress
                and before.state is not BoxState.STOP and self._may_be_replaced(now)):
            self.state.doubted = self._is_heard = True
        if self.state.doubted:
            self._look_whether_it_continues(now, report)
        self._step(now, report)
        self.state.away_s = 0.0
        self.saving.see(now, self.message.state, report)
        if self.message.state == before.state:
            urgent = has_strings or heard.state_changed
            self.send(How.REPLY if urgent else How.QUIET)
        return has_strings

    def note_outage(self, now: Now, down_s: float) -> None:
        """See `ZoneRun`."""
        self.state.away_s += down_s
        super().note_outage(now, down_s)

    def _look_whether_it_continues(self, now: Now, report: RobotReport) -> None:
        """Take what a robot reports in a doubted run. If it stopped, the box before may have stopped it, so the box
        sends it what it already does, and the referee decides."""
        arrived = self.link.last_heard
        self._is_heard = True
        if report.state is not RobotState.STOP:
            assert arrived is not None, "this report"
            self._continued = self._continued or arrived.mono >= self._opened_mono + SETTLED_S
        elif not self.state.asks:
            self.state.asks = True
            self._set_pauses(now)
            self._set_state(now, BoxState.STOP, ASKS)

    @property
    def is_doubted(self) -> bool:
        """See `ZoneRun`."""
        is_unheard = self.state.doubted and not self._is_heard and not self._is_replayed
        return self._is_in_progress and (self.state.asks or is_unheard)

    def doubt(self, now: Now) -> Optional[str]:
        """See `ZoneRun`."""
        if self.state.asks or not self.is_doubted:
            return STOPPED_ITSELF if self.is_doubted else None
        return UNHEARD if self.link.is_silent(now) else None

    def on_copy(self, now: Now, host: str, count: int) -> None:
        """Handle copies of datagrams of the robot, the last from `host`. They change nothing in the run."""
        for notice in self.link.hear_copy(now, host, count):
            self.say(now, Level.WARNING, notice)

    def _step(self, now: Now, report: RobotReport) -> None:
        reaction = react(self.message.state, report.state, explicit_goal=False)
        if reaction is Reaction.EXECUTE:
            self._set_state(now, BoxState.WAITING_RESULT, EXECUTING)
        elif reaction is Reaction.RETRY:
            self._set_state(now, BoxState.PREPARE, FELL_BACK(state=report.state.name))
        elif reaction is Reaction.GOAL_DONE:
            left_out_s = 0.0 if self.clock.paused else self._leave_out_outage(now, self.state.away_s)
            self._end(now, EndReason.COMPLETED, left_out_s=left_out_s)

    def _take_strings(self, now: Now, report: RobotReport) -> bool:
        any_text, dropped, strings = False, 0, self.state.strings
        mark = "" if self.link.times_valid else " (robot's time invalid: clock skew)"
        for online in ONLINE_FIELDS:
            texts = getattr(report, online.name)
            any_text = any_text or bool(texts)
            if texts and online.name in self._unused_strings:
                self._unused_strings -= {online.name}
                code = self.event.benchmark.code
                self.warn(now, f"The robot sends '{online.name}', which {code} does not use. It is logged all the "
                               "same. If robots may send it, add it to 'uses' in benchmarks.yaml")
            for text in receive(strings, online.name, texts):
                if not self._strings_budget.take(now, text):
                    dropped += 1
                    continue
                self._emit(effects.RunLogged(self.port, online.topic, text))
                self.show_online(now, f"{online.name}: {text}{mark}")
                self.state.said = [*self.state.said, said(now, online.name, text)][-MAX_SAID:]
        if dropped:
            self._dropped_strings += dropped
            self._say_dropped(now)
        return any_text

    def on_overload(self, now: Now, count: int) -> None:
        """Handle `count` datagrams of the robot that were not read."""
        self._unread += count
        self._say_dropped(now)

    def _say_dropped(self, now: Now) -> None:
        """Warn about dropped messages, at most once in `DROPPED_PERIOD_S`."""
        if now.mono < self._say_dropped_from:
            return
        self._say_dropped_from = now.mono + DROPPED_PERIOD_S
        self.say(now, Level.WARNING,
                 f"Robot sends too much: {self._dropped_strings} new strings were not logged, {self._unread} messages "
                 "were not read. Its program must send each text only once")

    def _take_commands(self, now: Now, report: RobotReport) -> None:
        taken = self.devices.take(report)
        for problem in taken.problems:
            self.say(now, Level.WARNING, problem)
        for device, value in taken.commands:
            self._emit(effects.RunLogged(self.port, run_log.device_topic(device), value))
            self._emit(effects.SetDevice(self.zone, device, value))
            self.say(now, Level.INFO, f"Robot sets {device} to {value}")
        if taken.display_map is not None:
            self._emit(effects.RunLogged(self.port, run_log.DISPLAY_MAP, int(taken.display_map)))
            # Many robots send "call button" in each message, which is the view at the start.
            if self._show_map(taken.display_map):
                view = "the map" if taken.display_map else "the call button"
                self.say(now, Level.INFO, f"Robot switches the tablet to {view}")

    # -- shared ------------------------------------------------------------------------------------

    def _end(
        self, now: Now, reason: EndReason, desc: str = "", by: By = NOBODY, left_out_s: float = 0.0,
    ) -> None:
        self._enter(RunEvent.END, reason)
        self.state.doubted = self.state.asks = False
        self._stop_clock(now)
        self._note_end(now, desc or reason.value, by, left_out_s)
        self._set_state(now, BoxState.STOP, desc or reason.value)

    def _stop_clock(self, now: Now) -> None:
        self.clock.stop(now)

    def _set_state(self, now: Now, state: BoxState, desc: str, goal: GoalMessage = NO_GOAL) -> None:
        desc = self.state.desc = self.times.described(desc)
        self.state.message = self.message._replace(state=state, goal=goal)
        self._state_mono = now.mono
        self._hint_mono = self._hints_from()
        for topic, value in (
            (run_log.STATE, int(state)), (run_log.STATE_NAME, state.name), (run_log.STATE_DESC, desc),
            (run_log.BOX_STATE, int(state)), (run_log.BOX_PAYLOAD, self.message.lines()),
        ):
            self._emit(effects.RunLogged(self.port, topic, value))
        self.say(now, Level.INFO, f"{state.name}: {desc}")
        self.link.record.box_says(now, state)
        self.send(How.CHANGE)

    def _describe(self, now: Now, desc: str) -> None:
        """See `ZoneRun._describe`. The robot receives the same state again."""
        self._set_state(now, self.message.state, desc, self.message.goal)

    def _log_report(self, report: RobotReport) -> None:
        """Log a report of the robot if it differs from the last, or if its times become valid or invalid."""
        said = (report._replace(time=(0, 0)), self.link.times_valid)
        if said == self._last_logged:
            return
        self._last_logged = said
        valid = "" if self.link.times_valid else "\ntime_valid: false"
        self._emit(effects.RunLogged(self.port, run_log.CLIENT_STATE, int(report.state)))
        self._emit(effects.RunLogged(self.port, run_log.CLIENT_PAYLOAD, report.lines() + valid))

    def _robot_names(self) -> Tuple[str, ...]:
        return (self.robot.robot,)

    # -- for the referee -----------------------------------------------------------------------------

    @property
    def robot_state(self) -> Optional[RobotState]:
        """The state that the robot reported last; None: no report yet."""
        return self.link.robot_state

    def start_off(self, now: Now) -> List[str]:
        """Return why the run cannot be started. The reasons of its clock are not included."""
        return self.link.not_ready(now)

    def warnings(self, now: Now) -> List[str]:
        """Return the referee's current warnings."""
        doubt = self.doubt(now)
        return ([doubt] if doubt else []) + self.ignores_stop(now) + self.link.warnings(now) + self._stuck(now)

    def _hints_from(self) -> Optional[float]:
        """Return the monotonic time (s) from which a robot that does not follow the box's state gets a warning; None:
        it gets none in this state."""
        if self.phase is Phase.ENDED:
            return self._state_mono + stop.NOT_DELIVERED_S
        return self._state_mono + STUCK_S if self.message.state in STUCK else None

    def ignores_stop(self, now: Now) -> List[str]:
        """See `ZoneRun`."""
        is_late = self.phase is Phase.ENDED and now.mono - self._state_mono >= stop.NOT_DELIVERED_S
        return [IGNORES_STOP] if is_late and self.robot_state is not RobotState.STOP else []

    def _stuck(self, now: Now) -> List[str]:
        """Warn of a robot that does not follow the box's state, with the likely cause."""
        state, waited_s = self.message.state, now.mono - self._state_mono
        if state not in STUCK or STUCK[state] is not self.robot_state or waited_s < STUCK_S or self.link.is_silent(now):
            return []
        code = self.event.benchmark.code
        if state is BoxState.PREPARE:
            return [STAYS_IN_STOP(time=times.in_sentence(waited_s), code=code)]
        return [NO_GOAL_TAKEN(time=times.in_sentence(waited_s), code=code)]

    @property
    def messages_saved(self) -> int:
        """The number of saved messages of offline data. Before the start, a robot reports that of its run before."""
        return self.link.messages_saved if self.book.state.started_utc else 0

    def status_lines(self, now: Now) -> List[str]:
        """Return the status lines for the referee besides `desc` and the warnings."""
        saved = [SAVED(number=self.messages_saved)] if self.book.state.started_utc else []
        return saved + [sheets.outage_text(outage) for outage in self.book.state.outages[-1:]]
