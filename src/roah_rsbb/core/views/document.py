"""The document of a box: everything that the faces show of it, made of the box's own objects."""

from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, TypeVar

from roah_rsbb.core.box import Box
from roah_rsbb.core.robots import ActiveRobot
from roah_rsbb.core.runs.all_robots import AllRobotsRun
from roah_rsbb.core.runs.by_hand import HandRun
from roah_rsbb.core.runs.functionality import FunctionalityRun
from roah_rsbb.core.runs.run import Run, ZoneRun
from roah_rsbb.core.views import sheets
from roah_rsbb.core.views.public import NOTHING_ALLOWED, Publicity, PublicViews
from roah_rsbb.core.views.schedule import EventLine, ScheduleView, events_shown
from roah_rsbb.core.views.sheets import sheet_items
from roah_rsbb.core.zones import Zone
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import BoxSeen, Document, RobotSeen, TabletSeen
from roah_rsbb.model.modules import RequestKind
from roah_rsbb.model.reason import joined, say
from roah_rsbb.model.records import RAN_TO_THE_END, Phase, RunRecord
from roah_rsbb.model.results import Judging, RunLine, RunTimeline, UnsavedParts
from roah_rsbb.model.zone import LATELY_S, AllRobots, Count, Event, RobotInRun, RunClock, SheetItem, Switches, ZoneSeen
from roah_rsbb.protocol import wire_seconds
from roah_rsbb.rulebook.benchmarks import NO_LIMIT, Benchmark, Restarts, ScheduledEvent
from roah_rsbb.scoring.counting import Why
from roah_rsbb.scoring.points import CountedSheet
from roah_rsbb.scoring.timeline import run_timeline

LISTENS = say("Listening for another box before transmitting: {time} s")
SEVERAL = say("Several robots of team {team} are active ({robots}): choose which one connects")
ALL_OK = say("All OK for start")
STOPPED = say("Can be restarted. The clock is stopped")
KEPT_RUNNING = say("Can be restarted. The clock kept running")
# Where START would replace something: what a benchmarking module measured, or the end that the robot reported.
FROM_BEGINNING = say("START would begin the benchmark again: what was measured so far would not count")
NEXT_END = say("START would continue the run: its next end would count instead of this one")
PAUSED = say("Clock paused by the referee")
ATTEMPT = say("Attempt {number} of {all}")
ONE_READY = say("Robot ready to accept connection: {robot}")
BY_HAND = say("No robot of team {team} is heard: people start it and stop it, with the clock")
READY = say("{number} robots ready to accept connection: {robots}")

# A skew is shown in steps of this many seconds: it changes with each message, and nobody reads more.
SKEW_STEP_S = 0.01
NO_FILES: Mapping[int, str] = {}


class ScheduleLine(NamedTuple):
    """An event of the schedule, for panels and the public display."""

    event: ScheduledEvent
    running: bool


def box_state(
    box: Box, now: Now, uuid: str, host: str, unsaved: Sequence[UnsavedParts] = (),
) -> BoxSeen:
    """Return the box itself. `uuid`: identity of this start of the core; `host`: broadcast address in use."""
    tablet = box.tablet.state
    return BoxSeen(
        uuid=uuid,
        host=host,
        port=box.settings.rsbb_port,
        status=box_status(box, now),
        warnings=tuple(box.warnings(now)),
        zones=tuple(box.zones),
        tablet=TabletSeen(
            box.tablet.heard is not None, _silent_since(box.tablet.heard, now), tablet.display_map,
            wire_seconds(tablet.call_time), wire_seconds(tablet.position_time), tablet.position_x, tablet.position_y),
        superseded_by=box.authority.superseded_by,
        unsaved=tuple(unsaved),
    )


def box_status(box: Box, now: Now) -> str:
    """Return the box's state in one line: OK, what it is doing, or its warnings."""
    left = box.watches.listening_left(now)
    if left > 0 and not box.watches.held_by:
        return LISTENS(time=f"{left:.0f}")
    return joined(box.warnings(now)) or "OK"


def robots(box: Box, now: Now, before: Mapping[str, RobotSeen] = {}) -> Dict[str, RobotSeen]:
    """Return all active robots, by team and name. `before`: what was returned last."""
    found: Dict[str, RobotSeen] = {}
    for robot in box.robots.all(now):
        name = str(robot.id)
        last = before.get(name)
        skew = stepped(robot.skew.seconds or 0.0, None if last is None else last.skew)
        seen = RobotSeen(robot.id.team, robot.id.robot, skew, _silent_since(robot.last_heard, now))
        found[name] = last if last is not None and last == seen else seen
    return found


def stepped(seconds: float, before: Optional[float]) -> float:
    """Return a skew in steps. One between two steps does not change `before`, the step that was shown last."""
    if before is not None and abs(seconds - before) < SKEW_STEP_S:
        return before
    return round(round(seconds / SKEW_STEP_S) * SKEW_STEP_S, 6)


def _silent_since(heard: Optional[Now], now: Now) -> Optional[float]:
    return None if heard is None or now.mono - heard.mono <= LATELY_S else heard.mono


class ZoneViews:
    """All zones, for a caller that needs them often. What is equal to the zone before is the same object.

    A box may have many runs of task benchmarks in progress, which hardly change. Such a zone is only made again when an
    event raised its revision, another box took over, or its warnings changed, which also depend on time. A report that
    says something new is logged, which raises the revision.

    A zone without a run is made again when an event changed anything in the box, when what is shown of the active
    robots changed, and otherwise once a second. All other zones are made each time.
    """

    def __init__(self, box: Box) -> None:
        self._box = box
        self._kept: Dict[str, Tuple[object, ZoneSeen]] = {}
        self._idle: Tuple[object, ...] = ()  # of what the zones without a run were made
        self._sheets: Dict[str, Tuple[CountedSheet, Tuple[SheetItem, ...]]] = {}

    def look(
        self, now: Now, active: Optional[Mapping[str, RobotSeen]] = None, log_files: Mapping[int, str] = NO_FILES,
    ) -> Dict[str, ZoneSeen]:
        """Return all zones by their names, in the order of the schedule file. `active`: the active robots; None: they
        may have changed. `log_files`: path of each run's log by its port."""
        before, self._kept = self._kept, {}
        box = self._box
        idle = (active, box.outbox.revision, int(now.mono), box.watches.listening_left(now) > 0.0,
                box.watches.held_by, box.authority.is_superseded)
        if active is None or not self._idle or self._idle[0] is not active or self._idle[1:] != idle[1:]:
            self._idle = idle
        found: Dict[str, ZoneSeen] = {}
        for zone in self._box.zones.values():
            found[zone.name] = self._look(zone, before.get(zone.name), now, log_files)
        return found

    def _look(
        self, zone: Zone, before: Optional[Tuple[object, ZoneSeen]], now: Now, log_files: Mapping[int, str],
    ) -> ZoneSeen:
        run, last = zone.run, None if before is None else before[1]
        made_of: object = None
        if run is None:
            made_of = self._idle
            if before is not None and before[0] is made_of:
                self._kept[zone.name] = before
                return before[1]
        elif type(run) is Run and run.phase is Phase.RUNNING:
            made_of = (self._box.outbox.revision_of(zone.name), self._box.warnings_of(now, zone.name),
                       self._box.authority.is_superseded)
        robot = _robot(run, now, None if last is None else last.robot)
        log_file = "" if robot is None else log_files.get(robot.port, "")
        if before is not None and last is not None and made_of is not None and before[0] == made_of:
            shown = last if (robot, log_file) == (last.robot, last.log_file) else last._replace(
                robot=robot, log_file=log_file)
        else:
            shown = self._make(zone, now)._replace(robot=robot, log_file=log_file)
            if last is not None and shown == last:
                shown = last
        self._kept[zone.name] = made_of, shown
        return shown

    def _make(self, zone: Zone, now: Now) -> ZoneSeen:
        box, run = self._box, zone.run
        event, rules = zone.event, zone.event.benchmark.rules
        found = ZoneSeen(
            zone=zone.name,
            event=event_shown(event),
            warnings=tuple(box.warnings_of(now, zone.name)),
            actions=box.actions.shown(now, zone),
            timeout=_finite(event.benchmark.limit if run is None else run.limit()),
            clock=clock_of(run, event.benchmark, now),
            attempt=box.candidates.attempt(zone) if rules.attempts else 0,
            attempts=rules.attempts,
        )
        if run is None:
            last = zone.last_run
            log, online_data = ("", "") if last is None else (last.log, last.online_data)
            return found._replace(state=tuple(_idle_lines(box, zone, found, now)), log=log, online_data=online_data)
        counted, items = self._sheet(zone.name, run)
        found = found._replace(
            phase=run.phase.value,
            identity=run.identity,
            end_reason=_end(run),
            state=tuple(_run_lines(run, found, now)),
            by_hand=isinstance(run, HandRun),
            all_robots=_all_robots(run, now) if isinstance(run, AllRobotsRun) else None,
            not_stopped=run.not_stopped(),
            items=items,
            points=counted.points,
            log=run.log,
            online_data=run.online_data,
        )
        return _with_module(found, run) if isinstance(run, FunctionalityRun) else found

    def _sheet(self, name: str, run: ZoneRun) -> Tuple[CountedSheet, Tuple[SheetItem, ...]]:
        """Return the score sheet of a run, and its items as they are shown."""
        counted, kept = run.book.counted(_end(run)), self._sheets.get(name)
        if kept is None or kept[0] is not counted:
            form = None if run.book.form.is_plain else run.book.form
            kept = self._sheets[name] = counted, sheet_items(counted.items, form, run.sheet.history)
        return kept


def event_shown(event: ScheduledEvent) -> Event:
    """Return the event at which a zone is."""
    benchmark = event.benchmark
    return Event(event.id, benchmark.code, benchmark.name, benchmark.desc, event.team, event.round, event.run,
                 event.scheduled)


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


def _end(run: ZoneRun) -> str:
    return "" if run.end_reason is None else run.end_reason.name.lower()


def _finite(seconds: float) -> float:
    return 0.0 if seconds == NO_LIMIT else seconds


def clock_of(run: Optional[ZoneRun], benchmark: Benchmark, now: Now) -> RunClock:
    """Return the times of a zone's run; None: there is no run."""
    clock = RunClock(
        _finite(benchmark.total_timeout),
        goal_limit=0.0 if benchmark.limit == benchmark.total_timeout else _finite(benchmark.limit),
        setup_limit=benchmark.rules.setup_time, phases=len(benchmark.rules.phases),
    )
    if run is None:
        return clock
    clock = clock._replace(limit=_finite(run.clock.limit), setup_elapsed=run.times.setup_elapsed(now))
    if run.phase is Phase.CONNECTED:
        return clock
    if run.phase is Phase.ENDED:
        return clock._replace(elapsed=Count(run.book.state.elapsed_s), after_stop_until=run.clock.after_stop_until)
    clock = clock._replace(elapsed=run.clock.count(now), paused=run.why_paused)
    phase, goal = run.times.phase(now), run.goal
    if phase is not None:
        clock = clock._replace(phase_number=phase.number, phase_name=phase.name, phase_limit=_finite(phase.limit),
                               phase_elapsed=phase.elapsed)
    return clock if goal is None else clock._replace(
        goal_limit=_finite(goal.clock.limit), goal=goal.request.number, goal_elapsed=goal.clock.count(now))


def _robot(run: Optional[ZoneRun], now: Now, before: Optional[RobotInRun]) -> Optional[RobotInRun]:
    """Return the robot of a run of one robot; None: another kind of run, or no run."""
    if not isinstance(run, Run):
        return None
    link = run.link
    last = before.skew if before is not None and before.port == run.port else None
    return RobotInRun(
        robot=run.robot.robot,
        port=run.port,
        box_state=run.message.state.name,
        robot_state="" if run.robot_state is None else run.robot_state.name,
        messages_saved=run.messages_saved,
        skew=None if link.skew is None else stepped(link.skew, last),
        heard=link.last_heard is not None,
        silent_since=_silent_since(link.last_heard, now),
    )


def _all_robots(run: AllRobotsRun, now: Now) -> AllRobots:
    return AllRobots(run.members()[0].port, *run.counts(), tuple(run.robots(now)))


def _with_module(found: ZoneSeen, run: FunctionalityRun) -> ZoneSeen:
    """Return a zone with what its benchmarking module asks for and reports."""
    asked = run.asked
    switches = run.switches if run.phase is Phase.RUNNING else None
    is_operation = asked is not None and asked.kind is RequestKind.REFEREE
    return found._replace(
        operation=asked.number if asked is not None and is_operation else 0,
        manual_operation=asked.text if asked is not None and is_operation else "",
        switches=None if switches is None else Switches(
            tuple(switches.on), switches.damaged, asked is not None and asked.kind is RequestKind.SWITCHES),
        held=run.held,
        module_status=run.module_status,
        module_scores=run.scores,
    )


def _idle_lines(box: Box, zone: Zone, view: ZoneSeen, now: Now) -> List[str]:
    """Return the lines for the referee of a zone without a run, without warnings."""
    asked = view.action("connect").question
    lines: List[str] = [asked] if asked else []
    lines += view.off("connect") or [_ready(zone, box.candidates.to_connect(now, zone))]
    if view.robots_to_choose:
        lines.append(SEVERAL(team=zone.event.team, robots=", ".join(view.robots_to_choose)))
    return lines + _attempt_lines(view)


def _run_lines(run: ZoneRun, view: ZoneSeen, now: Now) -> List[str]:
    """Return the lines for the referee of a run, without warnings."""
    lines: List[str] = [] if run.phase is Phase.CONNECTED else [run.desc]
    if run.phase is not Phase.RUNNING:
        reasons = view.off("start")
        if run.phase is Phase.CONNECTED:
            lines.extend(reasons or (ALL_OK,))
        elif not reasons:
            stops = run.times.rules.restarts is Restarts.CLOCK_STOPS
            lines.append(STOPPED if stops else KEPT_RUNNING)
            if isinstance(run, FunctionalityRun):
                lines.append(FROM_BEGINNING)
            elif run.end_reason in RAN_TO_THE_END:
                lines.append(NEXT_END)
    elif run.times.state.paused:
        lines.append(PAUSED)
    return lines + run.status_lines(now) + _attempt_lines(view)


def _attempt_lines(view: ZoneSeen) -> List[str]:
    return [ATTEMPT(number=view.attempt, all=view.attempts)] if 0 < view.attempt <= view.attempts else []


def _ready(zone: Zone, robots: Sequence[ActiveRobot]) -> str:
    if not robots:
        return BY_HAND(team=zone.event.team)
    if len(robots) == 1:
        return ONE_READY(robot=str(robots[0].id))
    return READY(number=len(robots), robots=joined([str(robot.id) for robot in robots], ", "))


# Until an end of a run is on all disks on which it must be.
END_UNSAVED = say("The end of the run is not recorded yet: write it down until this line is gone")

V = TypeVar("V")


class Documents:
    """Makes the document of one box again and again. What is equal to the part before is the same object."""

    def __init__(self, box: Box, uuid: str, host: str, publicity: Publicity = NOTHING_ALLOWED) -> None:
        """`uuid`: identity of this start of the core; `host`: broadcast address in use; `publicity`: what the public
        may see."""
        self._box, self._uuid, self._host = box, uuid, host
        self._views, self._schedule, self._public = ZoneViews(box), ScheduleView(box), PublicViews(box, publicity)
        self.last = Document(BoxSeen(uuid, host, 0), {}, {}, {}, {}, {})
        self.fault: Optional[Exception] = None  # why the last look has nothing new for the public
        self._events: Optional[Sequence[EventLine]] = None  # of which the last schedule was made
        self._revision: Optional[int] = None  # of the box, to which the sections belong that only events change
        self._lines: Dict[str, Tuple[RunRecord, Why, RunLine]] = {}  # by identity
        self._timelines: Dict[str, Tuple[Tuple[int, ZoneRun], RunTimeline]] = {}  # by zone, with what it is made of

    def look(
        self, now: Now, log_files: Mapping[int, str] = NO_FILES, unsaved: Sequence[UnsavedParts] = (),
    ) -> Document:
        """Return the document of this moment. `log_files`: path of each run's log by its port; `unsaved`: what is not
        on the disk yet."""
        box, last = self._box, self.last
        revision, events = box.outbox.revision, self._schedule.look(now)
        heard = _kept(last.robots, robots(box, now, last.robots))
        ended = {parts.identity for parts in unsaved if parts.stops}
        zones = _kept(last.zones, {
            name: zone._replace(warnings=(*zone.warnings, END_UNSAVED)) if zone.identity in ended else zone
            for name, zone in self._views.look(now, heard, log_files).items()})
        document = last._replace(
            box=box_state(box, now, self._uuid, self._host, unsaved), robots=heard, zones=zones,
            schedule=last.schedule if events is self._events else _kept(last.schedule, events_shown(events)))
        has_changed = revision != self._revision
        if has_changed:
            document = document._replace(
                results=_kept(last.results, self._results(now)), judging=_kept(last.judging, self._judging(now)),
                timelines=_kept(last.timelines, self._timelines_of(now)))
        if has_changed or zones is not last.zones or document.schedule is not last.schedule:
            document = self._publicly(document, now, has_changed)
        self._revision, self._events = revision, events
        if document.box == last.box:
            document = document._replace(box=last.box)
        if document.public == last.public:
            document = document._replace(public=last.public)
        if any(part is not before for part, before in zip(document, last)):
            self.last = document
        return self.last

    def _publicly(self, document: Document, now: Now, has_changed: bool) -> Document:
        """Return the document with what the public may see. If that cannot be made, which is an error of this program,
        the public sees what it saw before, and the referees see all else."""
        last = self.last
        try:
            found = document._replace(public_runs=_kept(last.public_runs, self._public.runs(document.zones)))
            if has_changed or document.schedule is not last.schedule:
                found = found._replace(public=self._public.others(now, document.schedule.values()),
                                       public_results=_kept(last.public_results, self._public.results(now)))
        except Exception as error:
            self.fault = error
            return document
        self.fault = None
        return found

    def _results(self, now: Now) -> Dict[str, RunLine]:
        scores, before = self._box.scores, self._lines
        why = {ruling.record.identity: ruling.why for ruling in scores.rulings(now)}
        self._lines = {}
        for record in map(sheets.timeless, scores.records(now)):
            known, counts = before.get(record.identity), why[record.identity]
            if known is None or known[1] is not counts or known[0] != record:
                known = record, counts, sheets.run_line(record, counts)
            self._lines[record.identity] = known
        return {identity: line for identity, (_, _, line) in self._lines.items()}

    def _timelines_of(self, now: Now) -> Dict[str, RunTimeline]:
        """Return what happened in the runs in the zones. A timeline is made again only if its zone changed."""
        before, self._timelines = self._timelines, {}
        for zone in self._box.zones.values():
            if zone.run is not None:
                made_of, known = (self._box.outbox.revision_of(zone.name), zone.run), before.get(zone.name)
                self._timelines[zone.name] = known if known is not None and known[0] == made_of else (
                    made_of, run_timeline(zone.run.record(now)))
        return {name: timeline for name, (_, timeline) in self._timelines.items()}

    def _judging(self, now: Now) -> Dict[str, Judging]:
        return {one.record.identity: sheets.judging(one) for one in self._box.judges.waiting(now)}


def _kept(before: Dict[str, V], now: Dict[str, V]) -> Dict[str, V]:
    """Return the entries of a section, as the same objects as before where they are equal."""
    found = {key: before[key] if key in before and before[key] == value else value for key, value in now.items()}
    if len(found) == len(before) and all(before.get(key) is value for key, value in found.items()):
        return before
    return found
