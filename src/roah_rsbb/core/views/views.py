"""What the referees see of the box at one moment, as plain values."""

from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.core.robots import ActiveRobot
from roah_rsbb.core.runs.all_robots import AllRobotsRun, Counts
from roah_rsbb.core.runs.by_hand import HandRun
from roah_rsbb.core.runs.functionality import FunctionalityRun
from roah_rsbb.core.runs.requests import Switches
from roah_rsbb.core.runs.run import Run, ZoneRun
from roah_rsbb.core.scoring.points import Counted
from roah_rsbb.core.zones import Zone
from roah_rsbb.model.actions import ACTIONS
from roah_rsbb.model.clock import Now
from roah_rsbb.model.fields import Choice
from roah_rsbb.model.modules import Request, RequestKind
from roah_rsbb.model.reason import is_made, joined, say
from roah_rsbb.model.records import Phase, ScoreValue
from roah_rsbb.model.scoring import ScoreGroup, SheetForm
from roah_rsbb.model.shown import Shown
from roah_rsbb.rulebook.benchmarks import NO_LIMIT, Benchmark, Restarts, ScheduledEvent

# The phase of a zone without a run.
IDLE = "idle"

_INDEX = {name: index for index, name in enumerate(ACTIONS)}

LISTENS = say("Listening for another box before transmitting: {time} s")
SEVERAL = say("Several robots of team {team} are active ({robots}): choose which one connects")
ALL_OK = say("All OK for start")
STOPPED = say("Can be restarted. The clock is stopped")
KEPT_RUNNING = say("Can be restarted. The clock kept running")
PAUSED = say("Clock paused by the referee")
ATTEMPT = say("Attempt {number} of {all}")
ONE_READY = say("Robot ready to accept connection: {robot}")
READY = say("{number} robots ready to accept connection: {robots}")


class RobotView(NamedTuple):
    """An active robot."""

    team: str
    robot: str
    skew: float  # seconds, robot's clock minus the box's; 0.0 while it is not known
    last_heard: float  # UTC seconds


class ModuleView(NamedTuple):
    """The part of a run's view that concerns its benchmarking module."""

    operation: Optional[Request] = None  # the current manual operation
    switches: Optional[Switches] = None  # from the first goal for switches on
    switches_asked: bool = False  # the referee must confirm them
    held: bool = False
    status: str = ""
    scores: Tuple[ScoreValue, ...] = ()


NO_MODULE = ModuleView()
NO_FORM, NO_SHEET = SheetForm(), Counted((), None)


class ClockView(NamedTuple):
    """The times of the run in a zone, in seconds. They do not include pauses. Limits may be `NO_LIMIT`."""

    limit: float  # from the start to the timeout
    elapsed: float = 0.0  # after the end: the final time
    counting: bool = False
    paused: str = ""  # why the time of a run in progress does not count
    goal_limit: float = 0.0  # of the present goal, or of each goal to come; 0.0: the benchmark has no goals
    goal: int = 0  # number of the present goal; 0: none with a timeout
    goal_elapsed: float = 0.0
    goal_counting: bool = False
    after_stop: float = 0.0  # after the end: left
    setup_limit: float = 0.0  # 0.0: the rules have no setup time
    setup_elapsed: float = 0.0  # also beyond the limit
    setup_counting: bool = False
    phases: int = 0  # how many phases the benchmark has
    phase_number: int = 0  # of the current phase; 0: none
    phase_name: str = ""
    phase_limit: float = NO_LIMIT
    phase_elapsed: float = 0.0  # also beyond the limit; counts with the run's clock

    def without_time(self) -> "ClockView":
        """The same, but for the time that passes."""
        elapsed, phase_elapsed = (0.0, 0.0) if self.counting else (self.elapsed, self.phase_elapsed)
        goal_elapsed = 0.0 if self.goal_counting else self.goal_elapsed
        setup_elapsed = 0.0 if self.setup_counting else self.setup_elapsed
        return self._replace(elapsed=elapsed, goal_elapsed=goal_elapsed, after_stop=0.0, setup_elapsed=setup_elapsed,
                             phase_elapsed=phase_elapsed)


class RobotInRunView(NamedTuple):
    """The robot of a run and its private channel."""

    robot: str
    port: int
    box_state: str  # sent by the box
    robot_state: str  # last reported by the robot; empty: not yet
    messages_saved: int
    skew: Optional[float]  # seconds, robot's clock minus the box's; None: not known
    last_heard: Optional[float]  # UTC seconds; None: never

    def without_time(self) -> "RobotInRunView":
        """Return the view without values that change with each message. Whether they are known is kept."""
        return self._replace(
            skew=None if self.skew is None else 0.0, last_heard=None if self.last_heard is None else 0.0
        )


class AllRobotsView(NamedTuple):
    """The part of the view of a run of all robots that other runs do not have."""

    first_port: int
    counts: Counts
    robots: Tuple[str, ...]  # each robot and what it is doing


class ZoneView(NamedTuple):
    """A zone, its event and the run in it."""

    zone: str
    event: ScheduledEvent
    timeout: float  # seconds: of a goal or of the run; may be `NO_LIMIT`
    timer: float  # seconds left; without a limit, seconds counted
    state: str  # for the referee, one or more lines
    actions: Tuple[Shown, ...]  # for each of ACTIONS, in their order
    log: str
    online_data: str
    scoring: Tuple[ScoreGroup, ...]
    form: SheetForm  # of the items that `scoring` has
    sheet: Counted
    warnings: Tuple[str, ...]
    phase: str
    identity: str  # of the run; empty: no run
    end_reason: str  # empty: it has not ended
    module: ModuleView
    clock: ClockView
    robot: Optional[RobotInRunView]  # of a run of one robot
    all_robots: Optional[AllRobotsView]  # of a run of all robots
    by_hand: bool = False  # the run has no robot
    attempt: int = 0  # number of this or the next run of the event; 0: the rules do not count attempts
    not_stopped: Tuple[str, ...] = ()  # robots of the run that do not report STOP
    said: Tuple[str, ...] = ()  # the reasons among `state` and `warnings` that are made of values

    def reasons_off(self, action: str) -> Tuple[str, ...]:
        """Return why the button of an action is off; empty: it is on."""
        return self.actions[_INDEX[action]].off

    @property
    def robots_to_choose(self) -> Tuple[str, ...]:
        """Names of the team's robots if the referee must choose one; else none."""
        field = self.actions[_INDEX["connect"]].fields[0]
        return field.choices if isinstance(field, Choice) else ()

    def without_time(self) -> "ZoneView":
        """Return the view without values that change even when nothing happens."""
        robot = None if self.robot is None else self.robot.without_time()
        return self._replace(timer=0.0, clock=self.clock.without_time(), robot=robot)


class ScheduleLine(NamedTuple):
    """An event of the schedule, for panels and the public display."""

    event: ScheduledEvent
    running: bool


def robots(box: Box, now: Now) -> List[RobotView]:
    """Return all active robots, by team and name."""
    return [
        RobotView(r.id.team, r.id.robot, r.skew.seconds or 0.0, r.last_heard.utc) for r in box.robots.all(now)
    ]


def box_status(box: Box, now: Now) -> str:
    """Return the box's state in one line: OK, what it is doing, or its warnings."""
    left = box.listening_left(now)
    if left > 0 and not box.is_held:
        return LISTENS(time=f"{left:.0f}")
    return joined(box.warnings(now)) or "OK"


class ZoneViews:
    """The views of all zones, for a caller that needs them often.

    A box may have many runs of task benchmarks in progress, which hardly change. The view of such a run is only made
    again when more than its times changed: an event raised the zone's revision, another box took over, or the warnings
    changed, which also depend on time. A report that says something new is logged, which raises the revision. All other
    views are made each time.
    """

    def __init__(self, box: Box) -> None:
        self._box = box
        self._kept: Dict[str, Tuple[object, ZoneView]] = {}  # by zone, of runs in progress

    def look(self, now: Now) -> List[ZoneView]:
        """Return all zones, in the order of the schedule file. Without their times, they are as they are now.

        For the present times, see `timer_of`, `clock_of` and `robot_of`.
        """
        before, self._kept = self._kept, {}
        return [self._look(zone, before.get(zone.name), now) for zone in self._box.zones.values()]

    def _look(self, zone: Zone, before: Optional[Tuple[object, ZoneView]], now: Now) -> ZoneView:
        run = zone.run
        if type(run) is not Run or run.phase is not Phase.RUNNING:
            return _zone(self._box, zone, now)
        made_of = self._box.revision_of(zone.name), self._box.warnings_of(now, zone.name), self._box.is_superseded
        if before is None or before[0] != made_of:
            before = made_of, _zone(self._box, zone, now)
        self._kept[zone.name] = before
        return before[1]


def coming_events(box: Box) -> List[ScheduleLine]:
    """Return the current and coming events of all zones, by scheduled time, without later ones that need no run any
    more."""
    over = box.scores.events_over()
    lines = [
        ScheduleLine(event, running=zone.run is not None and index == zone.index)
        for zone in box.zones.values()
        for index, event in enumerate(zone.events)
        if index == zone.index or (index > zone.index and (zone.name, index) not in over)
    ]
    return sorted(lines, key=lambda line: line.event.scheduled)


def _zone(box: Box, zone: Zone, now: Now) -> ZoneView:
    run = zone.run
    log, online_data = _texts(zone)
    view = ZoneView(
        zone=zone.name,
        event=zone.event,
        timeout=zone.event.benchmark.limit if run is None else run.limit(),
        timer=timer_of(zone, now),
        state="",
        actions=box.actions.shown(now, zone),
        log=log,
        online_data=online_data,
        scoring=() if run is None else run.sheet.groups(),
        form=NO_FORM if run is None else run.book.form,
        sheet=NO_SHEET if run is None else run.book.counted(_end(run)),
        warnings=tuple(box.warnings_of(now, zone.name)),
        phase=IDLE if run is None else run.phase.value,
        identity="" if run is None else run.identity,
        end_reason="" if run is None else _end(run),
        module=_module(run) if isinstance(run, FunctionalityRun) else NO_MODULE,
        clock=clock_of(run, zone.event.benchmark, now),
        robot=robot_of(run),
        all_robots=_all_robots(run, now) if isinstance(run, AllRobotsRun) else None,
        by_hand=isinstance(run, HandRun),
        attempt=box.candidates.attempt(zone) if zone.event.benchmark.rules.attempts else 0,
        not_stopped=() if run is None else run.not_stopped(),
    )
    lines = _state_lines(box, zone, view, now)
    said = [*lines, *view.warnings]
    return view._replace(state="\n".join(lines), said=tuple(text for text in said if is_made(text)))


def _end(run: ZoneRun) -> str:
    return "" if run.end_reason is None else run.end_reason.name.lower()


def timer_of(zone: Zone, now: Now) -> float:
    """Return the timer of a zone's view."""
    left = zone.event.benchmark.total_timeout if zone.run is None else zone.run.timer(now)
    if left != NO_LIMIT:
        return left
    return 0.0 if zone.run is None else zone.run.clock.elapsed(now)


def _texts(zone: Zone) -> Tuple[str, str]:
    """Return the log and online data of the run, or of the last run."""
    if zone.run is not None:
        return zone.run.log, zone.run.online_data
    last = zone.last_run
    return ("", "") if last is None else (last.log, last.online_data)


def _module(run: FunctionalityRun) -> ModuleView:
    asked, running = run.asked, run.phase is Phase.RUNNING
    return ModuleView(
        operation=asked if asked is not None and asked.kind is RequestKind.REFEREE else None,
        switches=run.switches if running else None,
        switches_asked=asked is not None and asked.kind is RequestKind.SWITCHES,
        held=run.held,
        status=run.module_status,
        scores=run.scores,
    )


def clock_of(run: Optional[ZoneRun], benchmark: Benchmark, now: Now) -> ClockView:
    """Return the times of a zone's run; None: there is no run."""
    limits = ClockView(
        benchmark.total_timeout, goal_limit=0.0 if benchmark.limit == benchmark.total_timeout else benchmark.limit,
        setup_limit=benchmark.rules.setup_time, phases=len(benchmark.rules.phases),
    )
    if run is None:
        return limits
    limits = limits._replace(setup_elapsed=run.times.setup_elapsed(now), setup_counting=run.times.in_setup)
    if run.phase is Phase.CONNECTED:
        return limits
    if run.phase is Phase.ENDED:
        return limits._replace(elapsed=run.book.state.elapsed_s, after_stop=run.clock.after_stop(now))
    clock = limits._replace(elapsed=run.clock.elapsed(now), counting=run.clock.counting, paused=run.why_paused)
    phase, goal = run.times.phase(now), run.goal
    if phase is not None:
        clock = clock._replace(phase_number=phase.number, phase_name=phase.name, phase_limit=phase.limit,
                               phase_elapsed=phase.elapsed)
    return clock if goal is None else clock._replace(
        goal_limit=goal.clock.limit, goal=goal.request.number, goal_elapsed=goal.clock.elapsed(now),
        goal_counting=goal.clock.counting,
    )


def robot_of(run: Optional[ZoneRun]) -> Optional[RobotInRunView]:
    """Return the robot of a run of one robot; None: another kind of run, or no run."""
    if not isinstance(run, Run):
        return None
    link = run.link
    return RobotInRunView(
        robot=run.robot.robot,
        port=run.port,
        box_state=run.message.state.name,
        robot_state="" if run.robot_state is None else run.robot_state.name,
        messages_saved=link.messages_saved,
        skew=link.skew,
        last_heard=None if link.last_heard is None else link.last_heard.utc,
    )


def _all_robots(run: AllRobotsRun, now: Now) -> AllRobotsView:
    return AllRobotsView(run.members()[0].port, run.counts(), tuple(run.robots(now)))


def _state_lines(box: Box, zone: Zone, view: ZoneView, now: Now) -> List[str]:
    """Return the lines for the referee: warnings and requests first."""
    run = zone.run
    if run is None:
        lines = list(view.reasons_off("connect")) or [_ready(box.candidates.to_connect(now, zone))]
        if view.robots_to_choose:
            names = ", ".join(view.robots_to_choose)
            lines.append(SEVERAL(team=zone.event.team, robots=names))
        return lines + _attempt_lines(view) + _warning_lines(view, lines)
    lines = [] if run.phase is Phase.CONNECTED else [run.desc]
    if run.phase is not Phase.RUNNING:
        reasons = view.reasons_off("start")
        if run.phase is Phase.CONNECTED:
            lines.extend(reasons or (ALL_OK,))
        elif not reasons:
            stops = run.times.rules.restarts is Restarts.CLOCK_STOPS
            lines.append(STOPPED if stops else KEPT_RUNNING)
    elif run.times.state.paused:
        lines.append(PAUSED)
    lines += run.status_lines(now) + _attempt_lines(view)
    return lines + _warning_lines(view, lines)


def _attempt_lines(view: ZoneView) -> List[str]:
    most = view.event.benchmark.rules.attempts
    return [ATTEMPT(number=view.attempt, all=most)] if 0 < view.attempt <= most else []


def _ready(robots: Sequence[ActiveRobot]) -> str:
    if len(robots) == 1:
        return ONE_READY(robot=str(robots[0].id))
    return READY(number=len(robots), robots=", ".join(str(robot.id) for robot in robots))


def _warning_lines(view: ZoneView, lines: List[str]) -> List[str]:
    return [f"WARNING: {warning}" for warning in view.warnings if warning not in lines]
