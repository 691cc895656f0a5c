"""Which robots a zone can connect now, and their private channels.

`Candidates` says why robots cannot take part, and how often a team has tried an event; `Capacity`, whether more runs
are possible: free private ports, and space in the beacon to list the robots. `Connections` opens each run on its own
private port, leaves it, and reopens its channel after a restart.

Ports are used in rising order, and never twice in a competition. If a port cannot be opened for a new run, the next
one is tried. A run that continues after a restart keeps its port, because its robot knows it; if that port cannot be
opened, it is tried again.
"""

import functools
from typing import (
    Callable,
    Container,
    Dict,
    Iterable,
    Iterator,
    List,
    NamedTuple,
    Optional,
    Sequence,
    Set,
    Tuple,
    Union,
)

from roah_rsbb.core import effects
from roah_rsbb.core.copies import Copies
from roah_rsbb.core.effects import How, Level, Outbox
from roah_rsbb.core.link.freshness import Heard
from roah_rsbb.core.link.skew import THE_ROBOT
from roah_rsbb.core.modules import Modules
from roah_rsbb.core.robots import MAX_ROBOTS, ActiveRobot, ActiveRobots, RobotId
from roah_rsbb.core.runs.all_robots import AllRobotsRun
from roah_rsbb.core.runs.by_hand import HandRun
from roah_rsbb.core.runs.functionality import FunctionalityRun, FunctionalityState
from roah_rsbb.core.runs.run import Assignment, Run, RunContext, RunState, ZoneRun, port_of
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.tablet import Tablet
from roah_rsbb.core.watches import Watches
from roah_rsbb.core.zones import Zone, Zones, ZoneState
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import Beacon, BenchmarkingRobot, DevicesState, TabletState
from roah_rsbb.model.reason import cut_note, joined, say
from roah_rsbb.model.records import NOBODY, NOT_RUN, By, EndReason, Phase, RunRecord
from roah_rsbb.protocol import WireTime
from roah_rsbb.rulebook.benchmarks import ScheduledEvent
from roah_rsbb.rulebook.registry import TABLET, BenchmarkKind
from roah_rsbb.scoring.book import FinishedRuns
from roah_rsbb.wording import times
from roah_rsbb.wording.texts import did_you_mean

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
        """Open a run with these robots in a zone whose *connect* is allowed; without robots, one that people start."""
        if not robots:
            self.open_sheet(now, zone)
            return
        self._watches.release()
        self._failures_left[zone.name] = MAX_PORTS_TRIED + len(robots) - 1
        for robot in robots:
            self._open_run(now, zone, robot)

    def open_sheet(self, now: Now, zone: Zone) -> HandRun:
        """Begin a run without a robot in a zone."""
        zone.version = self.version
        zone.run = run = self._by_hand(now, zone, zone.event)
        run.open(now)
        return run

    def _by_hand(self, now: Now, zone: Zone, event: ScheduledEvent) -> HandRun:
        """Make a run without a robot. It takes the next port as its number, and opens no channel."""
        self._last_port += 1
        self._outbox.emit(effects.PortTaken(self._last_port))
        return HandRun(now, zone.name, event, self._context(zone.name), self._last_port)

    def leave(self, now: Now, zone: Zone, by: By = NOBODY) -> None:
        """Disconnect the run in a zone."""
        run = zone.run
        assert run is not None, "disconnect was checked before"
        run.close(now, by)
        self._finished.add(run.record(now))
        zone.leave(self._settings.auto_next and not self._may_repeat(zone, run), lambda: self._over(zone))
        self._outbox.emit(effects.SendBeacon())

    def withdraw(self, now: Now, zone: Zone, place: int, by: By) -> str:
        """Record that the team of an event of a zone withdrew, whatever run the zone has. Return the identity of the
        run that says so."""
        if place == zone.index:
            run = zone.run or self.open_sheet(now, zone)
            run.give_up(now, EndReason.WITHDRAWN, by)
            self.leave(now, zone, by)
            return run.identity
        away = self._by_hand(now, zone, zone.events[place])
        away.open(now)
        away.give_up(now, EndReason.WITHDRAWN, by)
        away.close(now, by)
        self._finished.add(away.record(now))
        return away.identity

    def _over(self, zone: Zone) -> Set[int]:
        return {place for name, place in self._zones.over(self._finished.records()) if name == zone.name}

    def _may_repeat(self, zone: Zone, run: ZoneRun) -> bool:
        """Whether the rules give the team another attempt, for which the zone stays at its event."""
        most = run.event.benchmark.rules.attempts
        return run.end_reason not in NOT_RUN and most > sum(
            bool(record.started_utc) for record in filter(zone.is_of, self._finished.records()))

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
        self._watches.trouble(now, text)

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


LAST_PORT = 65535
NO_PORTS = say("All UDP ports up to {port} are used up: start the box with another log_dir, whose record of used ports "
               "is empty, and if need be with a lower rsbb_port")
FEW_PORTS = say("All UDP ports up to {port} but {left} are used up, and {number} robots need one each: start the box "
                "with another log_dir, whose record of used ports is empty, and if need be with a lower rsbb_port")
BIG_BEACON = say("The beacon may need {size} bytes with {more}, and robots may read only {most}: {remedies}, or raise "
                 "max_datagram if all robots are known to read more")
ONE_MORE, SEVERAL_MORE = say("one more robot"), say("{number} more robots")
LEAVE_ONLY, END_A_RUN = say("leave only {number} of them switched on"), say("end another run first")
# The documented firewall rules allow this many UDP ports from rsbb_port: 6666 to 7000.
PORTS = 335
# Every referee is warned when no more than this many runs are possible before the last port.
PORTS_LEFT = 10

# A beacon must still fit after the bell rings. Negative times are the longest on the wire.
LONGEST_TIME: WireTime = (-1, -1)
LONGEST_DEVICES = DevicesState(bell=LONGEST_TIME, dimmer=100, blinds=100)
LONGEST_TABLET = TabletState(call_time=LONGEST_TIME, position_time=LONGEST_TIME)


def ports_warning(rsbb_port: int, last_port: int) -> List[str]:
    """Return a warning if the next private ports are beyond those that firewalls allow; empty: no warning."""
    end = rsbb_port + PORTS - 1
    if last_port + PORTS_LEFT <= end:
        return []
    return [
        f"{max(0, end - last_port)} UDP ports are left of {rsbb_port} to {end}, which firewalls allow if they were "
        "set up as documented. Open more on the box and on the robots, or start the box with another log_dir"
    ]


class Capacity(NamedTuple):
    """The capacity of a box for further runs."""

    beacon_size: Callable[[Beacon], int]  # bytes of the datagram that carries a beacon
    max_datagram: int  # bytes that every robot can read
    last_port: int  # the highest private port that was ever used
    listed: Sequence[BenchmarkingRobot]  # robots that are in runs

    def off(self, robots: Sequence[RobotId]) -> List[str]:
        """Return why a run of each of these robots is not possible besides the present runs; empty: it is."""
        return self._ports_off(max(1, len(robots))) + self._beacon_off(robots)

    def _ports_off(self, count: int) -> List[str]:
        left = LAST_PORT - self.last_port
        if count <= left:
            return []
        if left <= 0:
            return [NO_PORTS(port=LAST_PORT)]
        return [FEW_PORTS(port=LAST_PORT, left=left, number=count)]

    def _beacon_off(self, robots: Sequence[RobotId]) -> List[str]:
        size = self._size(robots) if robots else 0
        if size <= self.max_datagram:
            return []
        more = ONE_MORE if len(robots) == 1 else SEVERAL_MORE(number=len(robots))
        fitting = self._fitting(robots)
        remedies: List[str] = [LEAVE_ONLY(number=fitting)] if fitting else []
        remedies += [END_A_RUN] if self.listed or not fitting else []
        return [BIG_BEACON(size=size, more=more, most=self.max_datagram, remedies=joined(remedies, ", "))]

    def _size(self, robots: Sequence[RobotId]) -> int:
        entries = (
            BenchmarkingRobot(robot.team, robot.robot, min(self.last_port + number, LAST_PORT))
            for number, robot in enumerate(robots, 1)
        )
        return self.beacon_size(Beacon((*self.listed, *entries), LONGEST_DEVICES, LONGEST_TABLET))

    def _fitting(self, robots: Sequence[RobotId]) -> int:
        """Return how many of the first robots fit. Bisection, because computing each size takes time."""
        fits, too_many = 0, len(robots)
        while too_many - fits > 1:
            middle = (fits + too_many) // 2
            if self._size(robots[:middle]) <= self.max_datagram:
                fits = middle
            else:
                too_many = middle
        return fits


ALREADY = say("Already connected")
LISTENING = say("The box is still listening for another box, for {time} s")
THE_ONLY = say("The only attempt at this event was made: go to the next event. To allow more, raise 'attempts' in "
               "benchmarks.yaml")
THE_LAST = say("The last of {number} attempts at this event was made: go to the next event. To allow more, raise "
               "'attempts' in benchmarks.yaml")
NO_SUCH_ROBOT = say("No robot '{robot}' of team {team} is ready to connect{hint}")
NO_ROBOT = say("No robot of team {team} is active: none of its beacons arrives on UDP port {port}")
NO_ROBOTS = say("No robot is active: no beacon arrives on UDP port {port}")
IN_A_RUN = say("Robot {robot} is in a run in zone {zone}")
NAMED = say("robot {robot}")
UNFIT = say("{robot} cannot take part: {why}")
BUSY = say("it is in a run in zone {zone}")
NO_PASSWORD = say("its team has no password in the passwords file")
NOT_HEARD = say("it was not heard for {time} s")
OUTSIDE = say("{robot} is active, but not in this run: disconnect and connect again to include it")


class Outsiders(NamedTuple):
    """All active robots that are not in the zone's run, by team and name."""

    fit: Tuple[ActiveRobot, ...]
    unfit: Tuple[str, ...]  # for each robot that cannot take part: its name and why


class Candidates:
    """Decides which robots *connect* takes."""

    def __init__(
        self, settings: Settings, zones: Zones, robots: ActiveRobots, watches: Watches, connections: Connections,
        finished: FinishedRuns,
    ) -> None:
        self._settings = settings
        self._zones = zones
        self._robots = robots
        self._watches = watches
        self._connections = connections
        self._finished = finished

    def to_connect(self, now: Now, zone: Zone, name: str = "") -> Sequence[ActiveRobot]:
        """Return the robots that *connect* would take: all that can take part, or one robot of the team that is in no
        run. Of several, it is the one of that name; without a name, one that was heard recently, and of these the one
        known longest."""
        if zone.event.benchmark.kind is BenchmarkKind.ALL_ROBOTS:
            return self._outsiders(now, zone).fit
        return [robot for robot in self._idle(now, zone) if name in ("", robot.id.robot)][:1]

    def to_choose(self, now: Now, zone: Zone) -> Tuple[str, ...]:
        """Return the names of the team's robots if the referee must choose one of several, in the order of preference;
        else none."""
        if zone.run is not None or zone.event.benchmark.kind is BenchmarkKind.ALL_ROBOTS:
            return ()
        names = tuple(robot.id.robot for robot in self._idle(now, zone))
        return names if len(names) > 1 else ()

    def outsiders(self, now: Now, zone: Zone) -> List[str]:
        """Warn of robots that are not in the run of all robots, or in one for which no robot was heard, as long as that
        can be changed.

        A robot that cannot take part does not exclude the others (docs/benchmarks.md, "The table"). The referee sees
        who is left out and why, and can disconnect and connect again to include a late robot.
        """
        if zone.run is not None and zone.run.phase is not Phase.CONNECTED:
            return []
        if zone.event.benchmark.kind is not BenchmarkKind.ALL_ROBOTS:
            # A robot that was heard only after *connect*.
            is_late = isinstance(zone.run, HandRun) and not zone.event.benchmark.profile.beacon
            return [OUTSIDE(robot=str(robot.id)) for robot in self._idle(now, zone)] if is_late else []
        found = self._outsiders(now, zone)
        if zone.run is None:
            return list(found.unfit)
        return [OUTSIDE(robot=str(robot.id)) for robot in found.fit] + list(found.unfit)

    def off(self, now: Now, zone: Zone, name: str = "") -> List[str]:
        """Return every reason why *connect* is off. `name`: of the robot to connect; empty: any."""
        if zone.run is not None:
            return [ALREADY]
        reasons = self.attempts_off(zone)
        listening = self._watches.listening_left(now)
        if listening > 0:
            reasons.append(LISTENING(time=f"{listening:.0f}"))
        robots = self.to_connect(now, zone, name)
        if zone.event.benchmark.kind is BenchmarkKind.ALL_ROBOTS:
            reasons += self._nobody_off(now, zone)
        else:
            reasons += self._robot_off(now, zone, robots, name)
        return reasons + self._connections.off([robot.id for robot in robots])

    # -- attempts -----------------------------------------------------------------------------------

    def attempt(self, zone: Zone) -> int:
        """Return the number of the attempt that the zone's run is, or that the next one will be."""
        return sum(bool(record.started_utc) for record in self._runs_of(zone)) + 1

    def is_unsigned(self, zone: Zone) -> bool:
        """Whether the run that a zone shows, or showed last, is over and not signed off."""
        if zone.run is not None:
            return True
        last = next(self._runs_of(zone), None)
        return last is not None and last.sign_off is None

    def attempts_off(self, zone: Zone) -> List[str]:
        """Return why the rules allow no further attempt at the zone's event; empty: they do."""
        most = zone.event.benchmark.rules.attempts
        if not most or self.attempt(zone) <= most:
            return []
        return [THE_ONLY if most == 1 else THE_LAST(number=most)]

    def _runs_of(self, zone: Zone) -> Iterator[RunRecord]:
        """Return the runs of the team at the zone's event that are over, the newest first."""
        return filter(zone.is_of, self._finished.records())

    # -- robots -------------------------------------------------------------------------------------

    def _idle(self, now: Now, zone: Zone) -> List[ActiveRobot]:
        """Return the robots of the event's team that are in no run, in the order of preference."""
        of_team = self._robots.of_team(now, zone.event.team)
        return [robot for robot in of_team if self._zones.run_of(robot.id) is None]

    def _robot_off(self, now: Now, zone: Zone, robots: Sequence[ActiveRobot], name: str) -> List[str]:
        team = zone.event.team
        if not robots and name:
            names = [robot.id.robot for robot in self._idle(now, zone)]
            return [NO_SUCH_ROBOT(robot=cut_note(name), team=team, hint=did_you_mean(name, names))]
        if not robots:
            busy = [(r, self._zones.run_of(r.id)) for r in self._robots.of_team(now, team)]
            if not busy and not zone.event.benchmark.profile.beacon:
                return []  # the run has no robot that the box hears
            if not busy:
                return [NO_ROBOT(team=team, port=self._settings.rsbb_port)]
            return [IN_A_RUN(robot=str(r.id), zone=run.zone) for r, run in busy if run is not None]
        return robots[0].off(NAMED(robot=str(robots[0].id)))

    def _nobody_off(self, now: Now, zone: Zone) -> List[str]:
        """Return why a run of all robots would have no robots; empty: it would have some."""
        found = self._outsiders(now, zone)
        if found.fit:
            return []
        return list(found.unfit) or [NO_ROBOTS(port=self._settings.rsbb_port)]

    def _outsiders(self, now: Now, zone: Zone) -> Outsiders:
        """Return the robots that could be connected to a zone's run of all robots now, and why others cannot."""
        inside = () if zone.run is None else tuple(member.robot for member in zone.run.members())
        fit: List[ActiveRobot] = []
        unfit: List[str] = []
        for robot in self._robots.all(now):
            if robot.id in inside:
                continue
            reasons = self._unfit_for(now, robot)
            if reasons:
                unfit.append(UNFIT(robot=str(robot.id), why=joined(reasons)))
            else:
                fit.append(robot)
        return Outsiders(tuple(fit), tuple(unfit))

    def _unfit_for(self, now: Now, robot: ActiveRobot) -> List[str]:
        run = self._zones.run_of(robot.id)
        if run is not None:
            return [BUSY(zone=run.zone)]
        reasons: List[str] = []
        if not self._robots.has_password(robot.id.team):
            reasons.append(NO_PASSWORD)
        if robot.is_late(now):
            reasons.append(NOT_HEARD(time=times.in_sentence(now.mono - robot.last_heard.mono)))
        return reasons + robot.off(THE_ROBOT)
