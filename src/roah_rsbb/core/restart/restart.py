"""What a restart of the core does not lose: the saved state of the box, and going on from it.

Theory of operation. Whatever changes the state of a zone marks it; whoever drives the box takes the marked ones
with `take_changed`, and puts their saved state on record before it carries any effect out. After a restart
`resume` builds every zone from its state: each run goes on in its state, with its clocks, scores, strings and
private port. Robots notice a gap of some seconds, and nothing else.

Active robots and nodes of benchmarking modules are not saved: both say all that matters again within a second.
"""

import abc
from typing import Callable, Dict, List, NamedTuple, Optional, Set, Tuple

from roah_rsbb.core import effects
from roah_rsbb.core.capacity import LAST_PORT
from roah_rsbb.core.clock import Now, clock_text
from roah_rsbb.core.effects import Effect, How
from roah_rsbb.core.messages import DevicesState, TabletState
from roah_rsbb.core.robots import ActiveRobots
from roah_rsbb.core.runs.all_robots import AllRobotsRun, AllRobotsState
from roah_rsbb.core.runs.functionality import FunctionalityRun, FunctionalityState
from roah_rsbb.core.runs.run import Entry, Run, RunState, Surroundings
from roah_rsbb.core.runs.zone_run import ZoneRun
from roah_rsbb.core.scoring.finished_runs import FinishedRuns, left_behind
from roah_rsbb.core.scoring.records import RunRecord
from roah_rsbb.core.zone import LastRun, Zone
from roah_rsbb.rulebook.benchmarks import Event

# The name under which `take_changed` has what belongs to no zone.
BOX = ""
# A private port that cannot be opened after a restart is tried again after this long.
REOPEN_S = 1.0
# For so long a run that went on after a restart is marked.
MARK_S = 60.0


class EventKey(NamedTuple):
    """What an event of a schedule is known by; the rest of it is in the benchmarks file."""

    benchmark: str  # code
    team: str
    round: int
    run: int
    scheduled: float  # UTC seconds


class ZoneState(NamedTuple):
    """The saved state of a zone. At most one of the runs' states is there; of modules only with `run`."""

    event: EventKey
    run: Optional[RunState] = None
    for_module: Optional[FunctionalityState] = None
    all_robots: Optional[AllRobotsState] = None
    last_run: Optional[LastRun] = None


class BoxSaved(NamedTuple):
    """The saved state of what belongs to no zone."""

    devices: DevicesState = DevicesState()
    tablet: TabletState = TabletState()


class Saved(NamedTuple):
    """All that a restart goes on from, and when it was saved."""

    utc: float  # UTC seconds of the last record before the restart
    box: BoxSaved
    zones: Dict[str, ZoneState]
    records: Tuple[RunRecord, ...] = ()  # of runs that are over, or were going on


def key_of(event: Event) -> EventKey:
    """The key of an event."""
    return EventKey(event.benchmark.code, event.team, event.round, event.run, event.scheduled)


def _matters(effect: Effect) -> bool:
    """Whether a state that is worth saving changed with this effect."""
    if isinstance(effect, effects.SendState):
        return effect.how is How.CHANGE
    return not isinstance(effect, effects.AimChannel)


class Restart(abc.ABC):
    """A part of `roah_rsbb.core.box.Box`, which has the zones."""

    finished: FinishedRuns
    zones: Dict[str, Zone]
    robots: ActiveRobots
    devices: DevicesState
    _effects: List[Effect]

    def __init__(self) -> None:
        super().__init__()
        self._changed: Set[str] = set()
        self._reopen_at: Dict[int, float] = {}  # port -> monotonic time (s)
        self._restarted: Optional[Tuple[float, str]] = None  # monotonic time (s), and what is said of it

    @abc.abstractmethod
    def _emit(self, effect: Effect) -> None: ...

    @abc.abstractmethod
    def _make_run(self, now: Now, entry: Entry) -> Run: ...

    @abc.abstractmethod
    def _surroundings(self, zone: str) -> Surroundings: ...

    # -- saving -------------------------------------------------------------------------------------

    def take_changed(self) -> Set[str]:
        """The names of zones whose state changed since the last call, and `BOX` if what belongs to none did."""
        changed, self._changed = self._changed, set()
        return changed

    def saved_zone(self, name: str) -> ZoneState:
        """The state of a zone."""
        zone = self.zones[name]
        state = ZoneState(key_of(zone.event))
        run = zone.run
        if isinstance(run, AllRobotsRun):
            return state._replace(all_robots=run.saved())
        if isinstance(run, Run):
            for_module = run.saved_for_module() if isinstance(run, FunctionalityRun) else None
            return state._replace(run=run.saved(), for_module=for_module)
        return state._replace(last_run=zone.last_run)

    def saved_box(self) -> BoxSaved:
        """The state of what belongs to no zone."""
        return BoxSaved(self.devices, self.tablet.state)

    def _emit_in(self, zone: str) -> Callable[[Effect], None]:
        """Emit effects of a run in this zone."""

        def emit(effect: Effect) -> None:
            if _matters(effect):
                self._changed.add(zone)
            self._emit(effect)

        return emit

    # -- going on -----------------------------------------------------------------------------------

    def resume(self, now: Now, saved: Saved) -> None:
        """Go on from what was saved before a restart. To be called once, before any other event."""
        self.devices = saved.box.devices
        self.tablet.restore(saved.box.tablet)
        self.finished.restore(saved.records)
        for name, state in saved.zones.items():
            zone = self.zones.get(name)
            if zone is None:
                self._lost(now, state, f"zone '{name}' is not in the schedule any more")
            else:
                self._try_to_resume(now, zone, state)
        runs = self._zone_runs()
        going_on = {run.identity for run in runs}
        for record in saved.records:
            if not record.closed_utc and record.identity not in going_on:
                self._give_up(record, saved.utc)
        if runs:
            down = max(0.0, now.utc - saved.utc)
            text = f"The core was restarted at {clock_text(now.utc)}, {down:.0f} s after its last record"
            for run in runs:
                run.warn(now, f"{text}: the run goes on")
            self._restarted = (now.mono, text)
            self.watches.restarted(now, text)
            self._emit(effects.SendBeacon())
        self.tick(now)

    def _give_up(self, record: RunRecord, utc: float) -> None:
        """A run does not go on: it was left when the core was last there, and can be corrected and signed off."""
        record = left_behind(record, utc)
        self.finished.add(record)
        self._emit(effects.RecordChanged(record))

    def _try_to_resume(self, now: Now, zone: Zone, state: ZoneState) -> None:
        done_before = len(self._effects)
        try:
            self._resume_zone(now, zone, state)
        except Exception as error:
            # A state that makes no sense must not keep the other zones, and every new start, from their work.
            del self._effects[done_before:]
            zone.run = None
            self._lost(now, state, f"its saved state makes no sense ({type(error).__name__}: {error})")

    def _resume_zone(self, now: Now, zone: Zone, state: ZoneState) -> None:
        index = _find(zone, state.event)
        if index is None:
            zone.index = _next_after(zone, state.event.scheduled)
            self._lost(now, state, f"its event is not in the schedule of zone '{zone.name}' any more")
            return
        zone.index = index
        zone.last_run = state.last_run
        self._resume_run(now, zone, state)

    def _resume_run(self, now: Now, zone: Zone, state: ZoneState) -> None:
        runs = () if state.all_robots is None else state.all_robots.members
        runs = runs if state.run is None else (state.run,)
        if not runs:
            return
        self._check_channels(runs)
        entries = [Entry(zone.name, zone.event, run.robot, run.port) for run in runs]
        for run in runs:
            self._last_port = max(self._last_port, run.port)
            self._emit(effects.PortTaken(run.port))
            self._emit(effects.OpenChannel(run.port, run.robot.team, run.robot.robot, run.link.host))
        if state.all_robots is not None:
            zone.run = AllRobotsRun(entries[0], self.settings, self._surroundings(zone.name), now)
            zone.run.resume(now, state.all_robots)
            return
        zone.run = self._make_run(now, entries[0])
        zone.run.resume(now, state.run)
        if isinstance(zone.run, FunctionalityRun) and state.for_module is not None:
            zone.run.resume_for_module(state.for_module)

    def _check_channels(self, runs: Tuple[RunState, ...]) -> None:
        """Raise ValueError if these runs could have no private channels."""
        ports = [run.port for run in runs]
        for run in runs:
            if not self.robots.has_password(run.robot.team):
                raise ValueError(f"team {run.robot.team} has no password any more")
            if not 0 < run.port <= LAST_PORT or ports.count(run.port) > 1 or self.run_at(run.port) is not None:
                raise ValueError(f"its port {run.port} cannot be used")

    def _lost(self, now: Now, state: ZoneState, why: str) -> None:
        """A run cannot go on: what it scored is on record."""
        if state.run is None and state.all_robots is None:
            return
        event = state.event
        self.on_trouble(
            now, f"The run of {event.benchmark}, team {event.team}, that was connected before the restart cannot go "
            f"on: {why}. Its scores are in the journal: see 'rosrun roah_rsbb results'",
        )

    def restart_warnings(self, now: Now, run: ZoneRun) -> List[str]:
        """What the referee of a run should know of a restart, for a while."""
        if self._restarted is None or now.mono - self._restarted[0] > MARK_S:
            return []
        was_there = any(member.resumed for member in run.members())
        return [f"{self._restarted[1]}: the run went on"] if was_there else []

    # -- ports that cannot be opened ----------------------------------------------------------------

    def _reopen_later(self, now: Now, run: Run, error: str) -> None:
        """The run keeps its port, which its robot knows; somebody else has it for the moment."""
        self._reopen_at[run.port] = now.mono + REOPEN_S
        self.on_trouble(
            now, f"UDP port {run.port} of the run in zone {run.zone} cannot be opened after the restart: {error}. "
            "It is tried again every second: end what uses it",
        )

    def _reopen_deadline(self) -> Optional[float]:
        return min(self._reopen_at.values(), default=None)

    def _reopen(self, now: Now) -> None:
        due = [port for port, mono in self._reopen_at.items() if mono <= now.mono]
        for port in due:
            del self._reopen_at[port]
            run = self.run_at(port)
            if run is not None:
                self._emit(effects.OpenChannel(port, run.robot.team, run.robot.robot, run.link.host))
                self._emit(effects.SendState(port, run.message, How.CHANGE))


def _find(zone: Zone, key: EventKey) -> Optional[int]:
    """Where the event is in the zone's schedule; one that was only moved in time is found, too."""
    keys = [key_of(event) for event in zone.events]
    if key in keys:
        return keys.index(key)
    return next((i for i, other in enumerate(keys) if other[:-1] == key[:-1]), None)


def _next_after(zone: Zone, scheduled: float) -> int:
    """The first event that is not earlier; the last one if all are."""
    later: List[int] = [i for i, event in enumerate(zone.events) if event.scheduled >= scheduled]
    return later[0] if later else len(zone.events) - 1
