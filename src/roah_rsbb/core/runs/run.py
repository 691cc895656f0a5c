"""A run: one robot, one event of the schedule, from *connect* to *disconnect*.

A `Run` is what the referee starts and stops. It holds the box's state machine, the run's clock, the
score sheet and all that the robot said, and turns events into effects. Who may start or stop it, and
when, is decided in `roah_rsbb.core.commands`.
"""

from typing import Callable, Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.core import effects, run_log
from roah_rsbb.core.clock import Now, clock_text
from roah_rsbb.core.effects import Effect, How, Level
from roah_rsbb.core.link.link import LinkState, RobotLink
from roah_rsbb.core.messages import NO_GOAL, BoxMessage, GoalMessage, RobotReport
from roah_rsbb.core.robots import RobotId
from roah_rsbb.core.runs import machine
from roah_rsbb.core.runs.clock import CountdownState, RunClock, SavingWatch
from roah_rsbb.core.runs.device_commands import DeviceCommands, DeviceCommandsState
from roah_rsbb.core.runs.online_data import DisplayText, RepeatedStrings, StringsBudget
from roah_rsbb.core.runs.phases import EndReason, Phase
from roah_rsbb.core.runs.run_book import BookState
from roah_rsbb.core.runs.scored_run import ScoredRun
from roah_rsbb.core.scoring.records import NOBODY, By
from roah_rsbb.core.settings import Settings
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, Event

# So often the referee is told what was dropped of a robot that sends too much.
DROPPED_PERIOD_S = 10.0
# The robot state that a robot leaves as soon as it hears the box's state, and after how long a hint is given.
STUCK = {BoxState.PREPARE: RobotState.STOP, BoxState.GOAL_TX: RobotState.WAITING_GOAL}
STUCK_S = 10.0


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


class Entry(NamedTuple):
    """Who runs what, where."""

    zone: str
    event: Event
    robot: RobotId
    port: int  # UDP port of the private channel; it identifies the run in the whole competition

    def identity(self, now: Now) -> str:
        """The name of the run that begins now with this entry: no other run of this or another competition has it."""
        return f"{self.event.benchmark.code}-{self.port}-{now.utc:.3f}"


class RunState(NamedTuple):
    """The saved state of a `Run`; see its attributes."""

    port: int
    robot: RobotId
    identity: str
    opened_utc: float
    phase: Phase
    end_reason: Optional[EndReason]
    desc: str
    message: BoxMessage
    link: LinkState
    clock: CountdownState
    book: BookState
    log: str = ""
    online_data: str = ""
    devices: DeviceCommandsState = DeviceCommandsState()
    strings: Dict[str, Tuple[str, ...]] = {}


class Surroundings(NamedTuple):
    """What a run reaches of the box around it."""

    emit: Callable[[Effect], None]
    show_map: Callable[[bool], None]  # switch the tablet: True: map, False: call button


def said_in(log: DisplayText, now: Now, level: Level, text: str, zone: str) -> effects.Notice:
    """Add what is told to the referee to the log shown; returns the notice that is to be emitted, too."""
    mark = "" if level is Level.INFO else f"{level.name}: "
    log.add(f"{clock_text(now.utc)} {mark}{text}")
    return effects.Notice(level, text, zone)


class Run(ScoredRun):
    """One run of a task benchmark: its robot has no explicit goal."""

    def __init__(self, entry: Entry, settings: Settings, surroundings: Surroundings, now: Now) -> None:
        super().__init__(entry.event)
        self.event = event = entry.event
        self.identity = entry.identity(now)
        self.opened_utc = now.utc
        self.zone = entry.zone
        self.robot = entry.robot
        self.port = entry.port
        self.phase = Phase.CONNECTED
        self.end_reason: Optional[EndReason] = None
        self.link = RobotLink(settings.allowed_skew, now)
        self.clock = RunClock(event.benchmark.total_timeout, settings.after_stop_duration)
        self.saving = SavingWatch(settings)
        self.log = DisplayText(settings.display_log_size)
        self.online_data = DisplayText(settings.display_log_size)
        self.devices = DeviceCommands(event.benchmark.code)
        self._strings = {field.name: RepeatedStrings() for field in ONLINE_FIELDS}
        self._strings_budget = StringsBudget()
        self._dropped_strings = self._unread = 0
        self._say_dropped_from = float("-inf")  # monotonic time (s)
        self._emit = surroundings.emit
        self._show_map = surroundings.show_map
        self.resumed = False  # after a restart of the core
        self.desc = ""  # what is the matter, in one line
        self._last_logged: Optional[Tuple[RobotReport, bool]] = None
        self.message = BoxMessage(event.benchmark.code, BoxState.STOP)
        self._state_mono = now.mono  # when the box's state changed last, or the core was restarted

    def open(self, now: Now) -> None:
        """Begin: `resume` is the other way to."""
        # Where all robots run at once, a team may have several.
        name = self.robot.robot if self.event.team == ALL_TEAMS else ""
        self._emit(effects.RunOpened(self.port, self.robot.team, self.event.round, self.event.run, name))
        self._record_changed(now)
        self._set_state(now, BoxState.STOP, "Connected: waiting for the robot's first message")

    # -- restart of the core ------------------------------------------------------------------------

    def saved(self) -> RunState:
        """The state for the journal."""
        return RunState(
            self.port, self.robot, self.identity, self.opened_utc, self.phase, self.end_reason, self.desc,
            self.message, self.link.saved(), self.clock.saved(), self.book.saved(), self.log.text,
            self.online_data.text, self.devices.saved(),
            {name: strings.saved() for name, strings in self._strings.items()},
        )

    def resume(self, now: Now, state: RunState) -> None:
        """Instead of `open`: go on where the run was when the core ended."""
        self.resumed = True
        self._take_back(state)
        self.message = state.message
        self.link.restore(state.link)
        self.devices.restore(state.devices)
        for name, strings in state.strings.items():
            self._strings[name].restore(strings)
        self._emit(effects.RunResumed(self.port))
        self._emit(effects.SendState(self.port, self.message, How.CHANGE))

    def members(self) -> Tuple["Run", ...]:
        """See `ZoneRun`: this run is its only member."""
        return (self,)

    def without(self, member: "Run") -> None:
        """See `ZoneRun`: nothing is left of a run without its robot."""

    # -- the referee's commands; whether they are allowed was checked before -----------------------

    def start(self, now: Now) -> None:
        """Start, or start again after a stop: then the run's clock has gone on."""
        self.clock.start(now)
        self.phase = Phase.RUNNING
        self.end_reason = None
        self._note_start(now)
        self._begin(now)

    def _begin(self, now: Now) -> None:
        self._set_state(now, BoxState.PREPARE, "Robot preparing for the task")

    def stop(self, now: Now, by: By = NOBODY) -> None:
        """The referee ends the run."""
        self._end(now, EndReason.STOPPED, by=by)

    def warn(self, now: Now, text: str) -> None:
        """What goes wrong around this run: its referee reads it in the log."""
        self._say(now, Level.WARNING, text)

    def close(self, now: Now, by: By = NOBODY) -> None:
        """Leave the run. The box sends no last message: its state simply ends."""
        self._note_close(now, by)
        self._say(now, Level.INFO, "Disconnected")
        self._emit(effects.RunLogged(self.port, run_log.END, None))
        self._emit(effects.CloseChannel(self.port))
        self._emit(effects.RunClosed(self.port))

    # -- time ---------------------------------------------------------------------------------------

    def deadline(self) -> Optional[float]:
        """The monotonic time (s) at which `tick` has something to do, if nothing happens before."""
        times = [self.link.deadline()]
        if self.phase is Phase.RUNNING:
            times += [self.clock.deadline(), self.saving.deadline()]
        return min((t for t in times if t is not None), default=None)

    def tick(self, now: Now) -> None:
        """Do what is due by now: end by timeout, or because nothing is saved, whatever was due first."""
        for notice in self.link.tick(now):
            self._say(now, Level.WARNING, notice)
        if self.phase is not Phase.RUNNING:
            return
        out_of_time, saves_nothing = self.clock.is_over(now), self.saving.is_over(now)
        if saves_nothing and not (out_of_time and self.clock.deadline() <= self.saving.deadline()):
            self._end(now, EndReason.NO_MESSAGES_SAVED)
        elif out_of_time:
            self._time_out(now)

    def _time_out(self, now: Now) -> None:
        self._end(now, EndReason.TIMEOUT)
        self._emit(effects.TimeoutRung(self.zone))

    # -- the robot ----------------------------------------------------------------------------------

    def on_report(self, now: Now, host: str, report: RobotReport) -> bool:
        """Take a message of the robot that arrived from `host`; False: it was stale, nothing changed."""
        heard = self.link.hear(now, host, report)
        for notice in heard.notices:
            self._say(now, Level.WARNING, notice)
        if not heard.fresh:
            return False
        if heard.new_host:
            self._emit(effects.AimChannel(self.port, host))
        before = self.message
        self.message = before._replace(acknowledgement=report.time)
        self._log_report(report)
        has_strings = self._take_strings(now, report)
        self._take_commands(now, report)
        self._step(now, report)
        self.saving.see(now, self.message.state, report)
        if self.message.state == before.state:
            urgent = has_strings or heard.state_changed
            self._emit(effects.SendState(self.port, self.message, How.REPLY if urgent else How.QUIET))
        return True

    def on_copy(self, now: Now, host: str) -> None:
        """A copy of a datagram of the robot arrived from `host`: it changes nothing."""
        for notice in self.link.hear_copy(now, host):
            self._say(now, Level.WARNING, notice)

    def _step(self, now: Now, report: RobotReport) -> None:
        step = machine.step(self.message.state, report.state, explicit_goal=False)
        if step is machine.Step.EXECUTE:
            self._set_state(now, BoxState.WAITING_RESULT, "Robot prepared, executing (no explicit goal)")
        elif step is machine.Step.RETRY:
            self._set_state(now, BoxState.PREPARE,
                            f"Robot fell back to {report.state.name}: asked to prepare again")
        elif step is machine.Step.GOAL_DONE:
            self._end(now, EndReason.COMPLETED)

    def _take_strings(self, now: Now, report: RobotReport) -> bool:
        any_text, dropped = False, 0
        mark = "" if self.link.times_valid else " (robot's time invalid: clock skew)"
        for field in ONLINE_FIELDS:
            texts = getattr(report, field.name)
            any_text = any_text or bool(texts)
            for text in self._strings[field.name].receive(texts):
                if not self._strings_budget.take(now, text):
                    dropped += 1
                    continue
                self._emit(effects.RunLogged(self.port, field.topic, text))
                self._tell_online(now, f"{field.name}: {text}{mark}")
        if dropped:
            self._dropped_strings += dropped
            self._say_dropped(now)
        return any_text

    def on_overload(self, now: Now, count: int) -> None:
        """So many datagrams of the robot were not read."""
        self._unread += count
        self._say_dropped(now)

    def _say_dropped(self, now: Now) -> None:
        """Report what was dropped, once in a while."""
        if now.mono < self._say_dropped_from:
            return
        self._say_dropped_from = now.mono + DROPPED_PERIOD_S
        self._say(now, Level.WARNING,
                  f"Robot sends too much: {self._dropped_strings} new strings were not logged, {self._unread} messages "
                  "not read. Its program must send each text once")

    def _take_commands(self, now: Now, report: RobotReport) -> None:
        taken = self.devices.take(report)
        for problem in taken.problems:
            self._say(now, Level.WARNING, problem)
        for device, value in taken.commands:
            self._emit(effects.RunLogged(self.port, run_log.device_topic(device), value))
            self._emit(effects.SetDevice(self.zone, device, value))
            self._say(now, Level.INFO, f"Robot sets {device} to {value}")
        if taken.display_map is not None:
            self._emit(effects.RunLogged(self.port, run_log.DISPLAY_MAP, int(taken.display_map)))
            self._show_map(taken.display_map)
            view = "the map" if taken.display_map else "the call button"
            self._say(now, Level.INFO, f"Robot switches the tablet to {view}")

    # -- shared ------------------------------------------------------------------------------------

    def _end(self, now: Now, reason: EndReason, desc: str = "", by: By = NOBODY) -> None:
        self.phase = Phase.ENDED
        self.end_reason = reason
        self.clock.stop(now)
        self._note_end(now, desc or reason.value, by)
        self._set_state(now, BoxState.STOP, desc or reason.value)

    def _set_state(self, now: Now, state: BoxState, desc: str, goal: GoalMessage = NO_GOAL) -> None:
        self.desc = desc
        self.message = self.message._replace(state=state, goal=goal)
        self._state_mono = now.mono
        for topic, value in (
            (run_log.STATE, int(state)), (run_log.STATE_NAME, state.name), (run_log.STATE_DESC, desc),
            (run_log.BOX_STATE, int(state)), (run_log.BOX_PAYLOAD, self.message.lines()),
        ):
            self._emit(effects.RunLogged(self.port, topic, value))
        self._say(now, Level.INFO, f"{state.name}: {desc}")
        self.link.record.box_says(now, state)
        self._emit(effects.SendState(self.port, self.message, How.CHANGE))

    def _log_report(self, report: RobotReport) -> None:
        """Log what the robot says whenever it says something else than before, or its times mean
        something no longer, or again."""
        said = (report._replace(time=(0, 0)), self.link.times_valid)
        if said == self._last_logged:
            return
        self._last_logged = said
        valid = "" if self.link.times_valid else "\ntime_valid: false"
        self._emit(effects.RunLogged(self.port, run_log.CLIENT_STATE, int(report.state)))
        self._emit(effects.RunLogged(self.port, run_log.CLIENT_PAYLOAD, report.lines() + valid))

    def _tell_online(self, now: Now, text: str) -> None:
        """Show online data to the referee."""
        self.online_data.add(f"{clock_text(now.utc)} {text}")

    def _log_ports(self) -> Tuple[int, ...]:
        return (self.port,)

    def _robot_names(self) -> Tuple[str, ...]:
        return (self.robot.robot,)

    def _say(self, now: Now, level: Level, text: str) -> None:
        self._emit(said_in(self.log, now, level, text, self.zone))

    # -- for the referee's eyes --------------------------------------------------------------------

    @property
    def robot_state(self) -> Optional[RobotState]:
        """What the robot last reported; None: nothing yet."""
        return self.link.robot_state

    def timer(self, now: Now) -> float:
        """Seconds left: until the timeout; once ended, of the time after the stop."""
        return self.clock.shown(now, ended=self.phase is Phase.ENDED)

    def start_off(self, now: Now) -> List[str]:
        """Why the run cannot be started, apart from its clock's reasons."""
        return self.link.not_ready(now)

    def warnings(self, now: Now) -> List[str]:
        """What the referee should look at now."""
        return self.link.warnings(now) + self._stuck(now)

    def _stuck(self, now: Now) -> List[str]:
        """What may keep the robot from following the box's state."""
        state, waited_s = self.message.state, now.mono - self._state_mono
        if state not in STUCK or STUCK[state] is not self.robot_state or waited_s < STUCK_S or self.link.is_silent(now):
            return []
        code = self.event.benchmark.code
        if state is BoxState.PREPARE:
            return [f"The robot has stayed in STOP for {waited_s:.0f} s after the start. Its program may not know "
                    f"benchmark {code}, or may not be ready: check the robot's own log"]
        return [f"The robot has not taken its goal for {waited_s:.0f} s. Its program may be too old for the goals of "
                f"{code}: check the robot's own log"]

    def status_lines(self, now: Now) -> List[str]:
        """What the referee should know of the run, besides what is the matter and the warnings."""
        return [] if self.robot_state is None else [f"Messages saved: {self.link.messages_saved}"]
