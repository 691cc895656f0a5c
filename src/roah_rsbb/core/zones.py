"""Zones: their scheduled events, the current event, and the run in it (docs/organiser.md, "schedule.yaml")."""

from dataclasses import dataclass
from typing import Callable, Container, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Set, Tuple

from roah_rsbb.core.robots import RobotId
from roah_rsbb.core.runs.all_robots import AllRobotsRun
from roah_rsbb.core.runs.by_hand import HandRun
from roah_rsbb.core.runs.functionality import FunctionalityRun, FunctionalityState
from roah_rsbb.core.runs.run import AllRobotsState, Run, RunState, ZoneRun, ZoneRunState
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import LinkSample
from roah_rsbb.model.reason import Refused, say
from roah_rsbb.model.records import RAN_TO_THE_END, EndReason, RunRecord
from roah_rsbb.rulebook.benchmarks import ScheduledEvent, ZonePlan
from roah_rsbb.rulebook.event_ids import EventKey, key_of, known_by
from roah_rsbb.scoring.counting import is_attempt
from roah_rsbb.wording.texts import did_you_mean

# A scheduled time that was sent and converted may differ by less than this.
SAME_TIME_S = 0.001
NO_RUN = say("No run is connected: press connect first")
NOTHING_TO_STOP = say("No run is connected, so there is nothing to stop")
NO_EVENT = say("zone '{zone}' has no event '{event}' any more: choose it again")
NO_ZONE = say("no zone '{zone}'{hint}")
_THE_END = frozenset(reason.name.lower() for reason in RAN_TO_THE_END)


class LastRun(NamedTuple):
    """What a zone still shows of its last run."""

    end_reason: Optional[EndReason]  # None: it was never started
    log: str
    online_data: str


def key_of_record(record: RunRecord) -> EventKey:
    """Return the key of the event of a run."""
    return EventKey(record.benchmark, record.team, record.round, record.run, record.scheduled, record.event)


def is_same(key: EventKey, event: ScheduledEvent) -> bool:
    """Return whether a key is that of an event. A key without an id, such as one of an old journal, has its time."""
    if key.id and event.id:
        return key.id == event.id
    return key_of(event).turn == key.turn and abs(event.scheduled - key.scheduled) < SAME_TIME_S


@dataclass
class ZoneState:
    """The state of a zone. It has the state of at most one run, and `for_module` only if it has `run`."""

    event: EventKey
    run: Optional[RunState] = None
    for_module: Optional[FunctionalityState] = None
    all_robots: Optional[AllRobotsState] = None
    last_run: Optional[LastRun] = None
    by_hand: Optional[ZoneRunState] = None
    version: int = 0  # of the configuration with which the run was connected

    @property
    def has_run(self) -> bool:
        """Whether the zone has a run."""
        return self.run is not None or self.all_robots is not None or self.by_hand is not None


class Zone:
    """One zone. Its schedule is in the order of the scheduled times.

    If the configuration is changed, a connected run keeps its event. It then stands in `events` instead of the one in
    `planned`, until the run is left (`roah_rsbb.core.continuing`).
    """

    def __init__(self, plan: ZonePlan, run_set: Callable[[], None] = lambda: None) -> None:
        """`run_set` is called whenever `run` is set."""
        self.name = plan.name
        self.planned = plan.events
        self.index = 0
        self._run: Optional[ZoneRun] = None
        self._run_set = run_set
        self.version = 0  # of the configuration with which the run was connected
        self._set_events(plan.events)
        self.last_run: Optional[LastRun] = None  # until the zone shows another event

    @property
    def run(self) -> Optional[ZoneRun]:
        """The run in the zone. Set it again when its members change."""
        return self._run

    @run.setter
    def run(self, run: Optional[ZoneRun]) -> None:
        self._run = run
        self._run_set()

    @property
    def event(self) -> ScheduledEvent:
        """The zone's current event."""
        return self.events[self.index]

    @property
    def at_first(self) -> bool:
        """Whether there is no previous event."""
        return self.index == 0

    @property
    def at_last(self) -> bool:
        """Whether there is no next event."""
        return self.index == len(self.events) - 1

    def find(self, key: EventKey) -> Optional[int]:
        """Return the place of an event in the schedule; None: the zone has no such event."""
        return next((index for index, event in enumerate(self.events) if is_same(key, event)), None)

    def place_of(self, key: EventKey) -> Optional[int]:
        """Return the place of an event in the schedule, even if its time was changed; None: it was removed.

        Without an id, it is the event of that team, round and run.
        """
        if key.id and key.id in self._places_by_id:
            return self._places_by_id[key.id]
        place = self._places.get(key[:5])
        return self._places_by_turn.get(key.turn) if place is None and not key.id else place

    def place_of_id(self, event_id: str) -> Optional[int]:
        """Return the place of the event with this id in the schedule; None: the zone does not have it."""
        return self._places_by_id.get(event_id)

    def is_of(self, record: RunRecord) -> bool:
        """Return whether a run was an attempt at the current event, perhaps in another zone."""
        event = self.event
        if record.event and event.id:
            return record.event == event.id and is_attempt(record, event)
        return (record.zone == self.name and self.place_of(key_of_record(record)) == self.index
                and is_attempt(record, event))

    def place_named(self, name: str) -> Optional[int]:
        """Return the place of the event of that id; None: the zone has no such event. One that is not from a file has
        the id that it would get in one."""
        return next((place for place, event in enumerate(self.events) if name == (event.id or known_by(event, ()))),
                    None)

    def move(self, by: int) -> None:
        """Go to another event of the schedule. Drop the last run's log, which belongs to the event before."""
        self.index += by
        self.last_run = None

    def saved(self) -> ZoneState:
        """Return the state for the journal."""
        run = self.run
        return ZoneState(
            key_of(self.event),
            run=run.state if isinstance(run, Run) else None,
            for_module=run.of_module if isinstance(run, FunctionalityRun) else None,
            all_robots=run.state if isinstance(run, AllRobotsRun) else None,
            last_run=self.last_run,
            by_hand=run.state if isinstance(run, HandRun) else None,
            version=0 if run is None else self.version,
        )

    def resume_at(self, state: ZoneState) -> bool:
        """Go to the event at which the zone was before a restart. Return False if the schedule no longer has it; the
        zone is then at the event that follows it."""
        is_there = self._use_plan(state.event)
        if is_there:
            self.last_run = state.last_run
        return is_there

    # -- another schedule ---------------------------------------------------------------------------

    def later(self) -> List[EventKey]:
        """Return the events that come after the current one."""
        return [key_of(event) for event in self.events[self.index + 1:]]

    def reschedule(self, plan: ZonePlan) -> None:
        """Take another schedule, and stay at the current event, or go to the event that follows it."""
        self.planned = plan.events
        if self.run is not None:
            self.hold(self.run.event)
        elif not self._use_plan(key_of(self.event)):
            self.last_run = None

    def hold(self, event: ScheduledEvent) -> None:
        """Go to the event of a run, and keep it as it is until the run is left."""
        events = list(self.planned)
        self._set_events(self.planned)
        place = self.place_of(key_of(event))
        if place is None:
            events.append(event)
        else:
            events[place] = event
        self._set_events(tuple(sorted(events, key=lambda each: each.scheduled)))
        self.index = next(index for index, each in enumerate(self.events) if each is event)

    def _use_plan(self, current: EventKey) -> bool:
        """Go to an event of the planned schedule. Return False if it is not there; the zone is then at the event that
        follows it."""
        self._set_events(self.planned)
        place = self.place_of(current)
        later = (i for i, event in enumerate(self.events) if event.scheduled >= current.scheduled)
        self.index = next(later, len(self.events) - 1) if place is None else place
        return place is not None

    def _set_events(self, events: Tuple[ScheduledEvent, ...]) -> None:
        self.events = events
        numbered = list(enumerate(events))
        self._places = {key_of(event)[:5]: index for index, event in reversed(numbered)}
        self._places_by_turn = {key_of(event).turn: index for index, event in reversed(numbered)}
        self._places_by_id = {event.id: index for index, event in numbered if event.id}

    # -- the run ------------------------------------------------------------------------------------

    def leave(self, auto_next: bool, over: Callable[[], Container[int]] = tuple) -> None:
        """Remove the closed run. After a run that was completed, the zone moves to the next event. `over` returns the
        places of events that need no run any more."""
        run, self.run = self.run, None
        assert run is not None, "there is a run to leave"
        self.last_run = LastRun(run.end_reason, run.log, run.online_data)
        if self.events is not self.planned and not self._use_plan(key_of(run.event)):
            self.last_run = None
            return
        if auto_next and run.end_reason in RAN_TO_THE_END:
            skipped = over()
            later = [place for place in range(self.index + 1, len(self.events)) if place not in skipped]
            if later:
                self.move(later[0] - self.index)


class _Runs:
    """The runs in all zones. They are needed for each datagram, and change rarely."""

    def __init__(self, zones: Iterable[Zone]) -> None:
        self.runs = [zone.run for zone in zones if zone.run is not None]
        self.members = [member for run in self.runs for member in run.members()]
        self.at = {member.port: member for member in self.members}
        self.of = {member.robot: member for member in reversed(self.members)}


class Zones(Dict[str, Zone]):
    """All zones by name, in the order of the schedule file, and the runs in them."""

    def __init__(self, plans: Iterable[ZonePlan]) -> None:
        super().__init__((plan.name, Zone(plan, self._forget_runs)) for plan in plans)
        self._runs: Optional[_Runs] = None

    def _forget_runs(self) -> None:
        self._runs = None

    def _known(self) -> _Runs:
        if self._runs is None:
            self._runs = _Runs(self.values())
        return self._runs

    def reschedule(self, plans: Sequence[ZonePlan], records: Iterable[RunRecord] = ()) -> None:
        """Take another schedule. No zone with a run may be missing in it. An event that was moved to a later time waits
        until those that now come before it are over. `records`: of the finished runs, the newest first."""
        before, later = dict(self), {}
        self.clear()
        for plan in plans:
            zone = self[plan.name] = before.get(plan.name) or Zone(plan, self._forget_runs)
            later[plan.name] = zone.later()
            zone.reschedule(plan)
        self._forget_runs()
        self.go_back(later, records)

    def go_back(self, later: Mapping[str, Sequence[EventKey]], records: Iterable[RunRecord]) -> List[Zone]:
        """Go to the first event that is not over, of those that came `later` than the current one, and come before it
        now; by zone. A zone with a run stays. Return those that went."""
        moved = []
        overtaking = {name: sorted(place for place in map(self[name].place_of, keys) if place is not None
                                   and place < self[name].index) for name, keys in later.items()}
        over = self.over(records) if any(overtaking.values()) else ()
        for name, places in overtaking.items():
            place = next((place for place in places if (name, place) not in over), None)
            if place is not None and self[name].run is None:
                self[name].move(place - self[name].index)
                moved.append(self[name])
        return moved

    def places_of(self, record: RunRecord) -> List[Tuple[str, int]]:
        """Return the zone and the place in its schedule of the event at which a run is an attempt. There is none if the
        event was removed, or has another team or benchmark now. There are two while a run of it is connected and it was
        moved to another zone."""
        places = [(zone.name, zone.place_of_id(record.event)) for zone in self.values()] if record.event else []
        found = [(name, place) for name, place in places if place is not None]
        if not found and record.zone in self:
            place = self[record.zone].place_of(key_of_record(record))
            found = [] if place is None else [(record.zone, place)]
        return [(name, place) for name, place in found if is_attempt(record, self[name].events[place])]

    def event_named(self, name: str) -> Optional[Tuple[str, ScheduledEvent]]:
        """Return the event of that id with its zone; None: there is none."""
        places = ((zone, zone.place_named(name)) for zone in self.values())
        return next(((zone.name, zone.events[place]) for zone, place in places if place is not None), None)

    def last_runs(self, records: Iterable[RunRecord]) -> Dict[Tuple[str, int], RunRecord]:
        """Return the last run of each event, by zone and place in its schedule. `records`: the newest first."""
        last: Dict[Tuple[str, int], RunRecord] = {}
        seen: Set[Tuple[object, ...]] = set()
        for record in records:
            event = record.event, record.zone, key_of_record(record)
            if event not in seen and not record.is_annulled:
                seen.add(event)
                for place in self.places_of(record):
                    last.setdefault(place, record)
        return last

    def over(self, records: Iterable[RunRecord]) -> Set[Tuple[str, int]]:
        """Return the events that need no run any more: the last one was completed, or the team withdrew or did not
        appear. By zone and place; `records`: the newest first."""
        return {place for place, record in self.last_runs(records).items() if record.end_reason in _THE_END}

    def named(self, name: str) -> Zone:
        """Return the zone of that name. Raises `Refused` with the existing names if there is none."""
        zone = self.get(name)
        if zone is None:
            raise Refused([NO_ZONE(zone=name, hint=did_you_mean(name, self))])
        return zone

    def run_in(self, name: str, without: str = NO_RUN) -> ZoneRun:
        """Return the run in the zone of that name. Raises `Refused` if the zone or the run (`without`) does not
        exist."""
        run = self.named(name).run
        if run is None:
            raise Refused([without])
        return run

    def runs(self) -> List[ZoneRun]:
        """Return the runs in all zones."""
        return self._known().runs

    def members(self) -> List[Run]:
        """Return all runs of single robots. Each has a private channel. The list stays the same until one changes."""
        return self._known().members

    def link_samples(self, now: Now, unreadable: Mapping[int, int]) -> Tuple[Tuple[int, LinkSample], ...]:
        """Return the port of each robot in a run, and its link's quality since the last call. Call this once a second.

        `unreadable`: by port, the number of all datagrams so far that could not be read. Missing ports have none.
        """
        return tuple((run.port, run.link.sample(now, unreadable.get(run.port, 0))) for run in self.members())

    def run_of(self, robot_id: RobotId) -> Optional[Run]:
        """Return the run that a robot is in. A robot is in at most one run of the box."""
        return self._known().of.get(robot_id)

    def run_at(self, port: int) -> Optional[Run]:
        """Return the run whose private channel has this port."""
        return self._known().at.get(port)
