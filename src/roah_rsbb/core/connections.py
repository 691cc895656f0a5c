"""Opens each run on its own private port, leaves it, and reopens its channel after a restart.

Ports are used in rising order, and never twice in a competition. If a port cannot be opened for a new run, the next
one is tried. A run that continues after a restart keeps its port, because its robot knows it; if that port cannot be
opened, it is tried again.
"""

import functools
from typing import Callable, Container, Dict, Iterable, List, Optional, Sequence, Tuple, Union

from roah_rsbb.core import effects
from roah_rsbb.core.capacity import LAST_PORT, Capacity, ports_warning
from roah_rsbb.core.copies import Copies
from roah_rsbb.core.effects import How, Level, Outbox
from roah_rsbb.core.link.heard import Heard
from roah_rsbb.core.modules.presence import Modules
from roah_rsbb.core.robots import MAX_ROBOTS, ActiveRobot, ActiveRobots, RobotId
from roah_rsbb.core.runs.all_robots import AllRobotsRun
from roah_rsbb.core.runs.by_hand import HandRun
from roah_rsbb.core.runs.functionality import FunctionalityRun, FunctionalityState
from roah_rsbb.core.runs.run import Assignment, Run, RunContext, RunState, port_of
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.tablet import Tablet
from roah_rsbb.core.watches import Watches
from roah_rsbb.core.zones import Zone, Zones, ZoneState
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import Beacon, BenchmarkingRobot
from roah_rsbb.model.records import NOBODY, By
from roah_rsbb.rulebook.registry import TABLET, BenchmarkKind
from roah_rsbb.scoring.book import FinishedRuns

# More failures than robots to connect mean that no port can be opened. This is how many more.
MAX_PORTS_TRIED = 20
# A private port that cannot be opened after a restart is tried again after this long.
REOPEN_S = 1.0


class Connections:
    """All runs' private channels."""

    def __init__(
        self,
        settings: Settings,
        zones: Zones,
        robots: ActiveRobots,
        modules: Modules,
        tablet: Tablet,
        watches: Watches,
        finished: FinishedRuns,
        heard: Heard,
        copies: Copies,
        outbox: Outbox,
        beacon_size: Callable[[Beacon], int],
        last_port: Optional[int],
    ) -> None:
        """For `beacon_size` and `last_port`, see `Box`."""
        self._settings = settings
        self._zones = zones
        self._robots = robots
        self._modules = modules
        self._tablet = tablet
        self._watches = watches
        self._finished = finished
        self._heard = heard
        self._copies = copies
        self._outbox = outbox
        self._beacon_size = beacon_size
        self._last_port = max(settings.rsbb_port, last_port or 0)
        self.version = 0  # of the configuration with which runs are connected
        self.hears_beacons = True  # False: a replay, which does not know them
        self._failures_left: Dict[str, int] = {}  # by zone, of channels of the run being connected
        self._reopen_at: Dict[int, float] = {}  # port -> monotonic time (s)
        self._listed: Tuple[BenchmarkingRobot, ...] = ()
        self._listed_of: List[Run] = []
        self._off: Dict[Tuple[RobotId, ...], List[str]] = {}  # what `off` returns besides the runs of `_listed_of`

    # -- looking ------------------------------------------------------------------------------------

    def listed(self) -> Tuple[BenchmarkingRobot, ...]:
        """The robots in runs, as the beacon lists them. `Zones.members` returns another list when a zone's run is set,
        which happens whenever a port is taken."""
        members = self._zones.members()
        if members is not self._listed_of:
            self._listed_of, self._off = members, {}
            self._listed = tuple(BenchmarkingRobot(r.robot.team, r.robot.robot, r.port) for r in members)
        return self._listed

    def off(self, robots: Sequence[RobotId]) -> List[str]:
        """Return why a run of these robots is not possible besides the present runs; empty: it is."""
        listed, key = self.listed(), tuple(robots)
        if len(self._off) > MAX_ROBOTS:
            self._off.clear()
        if key not in self._off:
            capacity = Capacity(self._beacon_size, self._settings.max_datagram, self._last_port, listed)
            self._off[key] = capacity.off(robots)
        return self._off[key]

    def warnings(self) -> List[str]:
        """Return the warnings about ports for every referee."""
        return ports_warning(self._settings.rsbb_port, self._last_port)

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) at which `tick` tries a port again; None: no port is waiting."""
        return min(self._reopen_at.values(), default=None)

    # -- opening and leaving ------------------------------------------------------------------------

    def connect(self, now: Now, zone: Zone, robots: Sequence[ActiveRobot]) -> None:
        """Open a run with these robots in a zone whose *connect* is allowed."""
        assert robots, "connect was checked before"
        self._watches.release()
        self._failures_left[zone.name] = MAX_PORTS_TRIED + len(robots) - 1
        for robot in robots:
            self._open_run(now, zone, robot)

    def open_sheet(self, now: Now, zone: Zone) -> HandRun:
        """Begin a run without a robot in a zone. It takes the next port as its number, and opens no channel."""
        self._last_port += 1
        self._outbox.emit(effects.PortTaken(self._last_port))
        zone.version = self.version
        zone.run = run = HandRun(now, zone.name, zone.event, self._context(zone.name), self._last_port)
        run.open(now)
        return run

    def leave(self, now: Now, zone: Zone, by: By = NOBODY) -> None:
        """Disconnect the run in a zone."""
        run = zone.run
        assert run is not None, "disconnect was checked before"
        run.close(now, by)
        self._finished.add(run.record(now))
        zone.leave(self._settings.auto_next, lambda: {
            place for name, place in self._zones.over(self._finished.records()) if name == zone.name})
        self._outbox.emit(effects.SendBeacon())

    def on_failed(self, now: Now, port: int, error: str) -> None:
        """Take the next port if the channel on `port` could not be opened, or give up this robot's run."""
        run = self._zones.run_at(port)
        if run is None:
            return
        if run.resumed:
            self._reopen_later(now, run, error)
            return
        zone = self._zones[run.zone]
        text = f"UDP port {port} cannot be used for the private channel: {error}"
        self._outbox.notice(Level.WARNING, text, zone.name)
        run.close(now)
        assert zone.run is not None, "this run is in it"
        zone.run = zone.run.without(run)
        self._failures_left[zone.name] -= 1
        robot = self._robots.find(run.robot)
        if robot is not None and self._failures_left[zone.name] > 0 and self._last_port < LAST_PORT:
            self._open_run(now, zone, robot)
            return
        given_up = "the run was not begun" if zone.run is None else f"{run.robot} does not take part"
        self._outbox.notice(Level.ERROR, f"No private channel could be opened: {given_up}", zone.name)
        self._outbox.emit(effects.SendBeacon())

    def _open_run(self, now: Now, zone: Zone, robot: ActiveRobot) -> None:
        self._last_port += 1
        port, context = self._last_port, self._context(zone.name)
        zone.version = self.version
        assignment = Assignment(zone.name, zone.event, robot.id, port)
        self._outbox.emit(effects.PortTaken(port))
        self._outbox.emit(effects.OpenChannel(port, robot.id.team, robot.host, zone.version))
        if zone.event.benchmark.kind is BenchmarkKind.ALL_ROBOTS:
            whole = zone.run or AllRobotsRun(now, assignment, context)
            assert isinstance(whole, AllRobotsRun), "its event is one of all robots"
            whole.add(now, assignment)
            zone.run = whole
        else:
            zone.run = run = self._make_run(now, assignment, context)
            run.open(now)
        if TABLET in zone.event.benchmark.profile.uses:
            self._tablet.display_map = False  # the view that the previous run's robot selected ends with its run
        self._outbox.emit(effects.SendBeacon())

    def _make_run(
        self, now: Now, assignment: Assignment, context: RunContext,
        state: Optional[RunState] = None, of_module: Optional[FunctionalityState] = None,
    ) -> Run:
        if assignment.event.benchmark.kind is BenchmarkKind.FUNCTIONALITY:
            return FunctionalityRun(now, assignment, context, self._modules, state, of_module)
        return Run(now, assignment, context, state)

    def _context(self, zone: str) -> RunContext:
        last_beacon = self._robots.last_beacon if self.hears_beacons else None
        return RunContext(self._settings, self._outbox.of_zone(zone), functools.partial(self._outbox.revision_of, zone),
                          self._show_map, last_beacon, self._heard, self._copies.may_be_replaced)

    def _show_map(self, display_map: bool) -> bool:
        is_change = display_map != self._tablet.display_map
        if is_change:
            self._tablet.display_map = display_map
            self._outbox.emit(effects.SendBeacon())
        return is_change

    # -- after a restart ----------------------------------------------------------------------------

    def leave_out(self, identities: Iterable[str]) -> None:
        """Give no port again that is in the identity of an earlier run, even if the record of used ports is lost."""
        ports = [port for port in map(port_of, identities) if port <= LAST_PORT]
        self._last_port = max(self._last_port, *ports, 0)

    def reopen(self, now: Now, zone: Zone, state: ZoneState, teams: Optional[Container[str]] = None) -> None:
        """Continue the run in a zone's saved state, if any. Raises ValueError if it cannot have its channels.

        `teams`: those of the earlier configuration with which the run was connected; None: the present one.
        """
        zone.version = self.version if teams is None else state.version
        if state.by_hand is not None:
            self.leave_out([state.by_hand.identity])
            zone.run = HandRun(now, zone.name, zone.event, self._context(zone.name), state=state.by_hand)
            return
        runs: Sequence[RunState] = () if state.all_robots is None else state.all_robots.members
        runs = runs if state.run is None else (state.run,)
        if not runs:
            return
        self._check_channels(runs, teams)
        for run in runs:
            self._last_port = max(self._last_port, run.port)
            self._outbox.emit(effects.PortTaken(run.port))
            self._outbox.emit(effects.OpenChannel(run.port, run.robot.team, run.link.host, zone.version))
        first = Assignment(zone.name, zone.event, runs[0].robot, runs[0].port)
        context = self._context(zone.name)
        continued: Union[Run, AllRobotsRun]
        if state.run is not None:
            continued = self._make_run(now, first, context, state.run, state.for_module)
        else:
            continued = AllRobotsRun(now, first, context, state.all_robots)
        zone.run = continued
        continued.resume()

    def _check_channels(self, runs: Sequence[RunState], teams: Optional[Container[str]]) -> None:
        """Raise ValueError if these runs cannot have private channels."""
        ports = [run.port for run in runs]
        for run in runs:
            if not (self._robots.has_password(run.robot.team) if teams is None else run.robot.team in teams):
                raise ValueError(f"team {run.robot.team} has no password any more")
            if not 0 < run.port <= LAST_PORT or ports.count(run.port) > 1 or self._zones.run_at(run.port) is not None:
                raise ValueError(f"its port {run.port} cannot be used")

    def _reopen_later(self, now: Now, run: Run, error: str) -> None:
        """Keep the run's port, which its robot knows, and try it again: another program uses it at the moment."""
        self._reopen_at[run.port] = now.mono + REOPEN_S
        text = (f"UDP port {run.port} of the run in zone {run.zone} cannot be opened after the restart: {error}. "
                "It is tried again every second: end the program that uses it")
        if self._watches.trouble(now, text):
            self._outbox.notice(Level.ERROR, text)

    def tick(self, now: Now) -> None:
        """Retry the ports that are due."""
        due = [port for port, mono in self._reopen_at.items() if mono <= now.mono]
        for port in due:
            del self._reopen_at[port]
            run = self._zones.run_at(port)
            if run is not None:
                version = self._zones[run.zone].version
                self._outbox.emit(effects.OpenChannel(port, run.robot.team, run.link.host, version))
                run.send(How.CHANGE)
