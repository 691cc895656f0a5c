"""The box: all zones, all robots, what the beacon says; the one place where events come in.

Every public method that takes an event takes `now` too, and leaves its effects for `take_effects`. A
command of the referee that makes no sense raises `Refused` and changes nothing.
"""

import math
from typing import Callable, Dict, List, Mapping, Optional, Tuple

from roah_rsbb.core import effects
from roah_rsbb.core.capacity import LAST_PORT, Capacity, ports_warning
from roah_rsbb.core.clock import ClockWatch, Now
from roah_rsbb.core.commands import COMMANDS, NO_RUN, robots_to_connect
from roah_rsbb.core.effects import Effect, Level
from roah_rsbb.core.link.record import LinkSample
from roah_rsbb.core.messages import Beacon, BenchmarkingRobot, DevicesState, RobotReport, TabletState
from roah_rsbb.core.modules.events import ModuleEvents
from roah_rsbb.core.referee_record import RunName, checked_who, cut_note
from roah_rsbb.core.refused import Refused
from roah_rsbb.core.restart.restart import BOX, Restart
from roah_rsbb.core.robots import ActiveRobot, ActiveRobots, RobotId
from roah_rsbb.core.runs.all_robots import AllRobotsRun
from roah_rsbb.core.runs.device_commands import CATERING
from roah_rsbb.core.runs.functionality import FunctionalityRun
from roah_rsbb.core.runs.run import Entry, Run, Surroundings
from roah_rsbb.core.runs.zone_run import ZoneRun
from roah_rsbb.core.scoring.events import ScoreEvents
from roah_rsbb.core.scoring.finished_runs import FinishedRuns
from roah_rsbb.core.scoring.records import NOBODY, By
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.tablet import Tablet
from roah_rsbb.core.watches import Watches
from roah_rsbb.core.zone import Zone
from roah_rsbb.protocol import WireTime
from roah_rsbb.rulebook.benchmarks import Config, Kind
from roah_rsbb.wording.suggestions import did_you_mean

# So many ports that cannot be opened, more than there are robots to connect, mean that no port can.
MAX_PORTS_TRIED = 20


class Box(ModuleEvents, ScoreEvents, Restart):
    """The referee, scoring and benchmarking box, without its sockets, clocks and files."""

    def __init__(
        self,
        config: Config,
        settings: Settings,
        beacon_size: Callable[[Beacon], int],
        last_port: Optional[int] = None,
    ) -> None:
        """`beacon_size`: bytes of the datagram that carries a beacon. `last_port`: the highest private port
        that this competition ever used, from the record; None: none yet."""
        super().__init__()
        self.settings = settings
        self.robots = ActiveRobots(
            settings.robot_timeout, config.passwords, lambda: {run.robot for run in self.runs()})
        self.zones: Dict[str, Zone] = {plan.name: Zone(plan) for plan in config.zones}
        self.devices = DevicesState()
        self.tablet = Tablet()
        self.watches = Watches(settings.listen_duration)
        self.finished = FinishedRuns(config.benchmarks)
        self._clock = ClockWatch()
        self._beacon_size = beacon_size
        self._last_port = max(settings.rsbb_port, last_port or 0)
        self._effects: List[Effect] = []
        self._failures_left: Dict[str, int] = {}  # by zone, of channels of the run being connected
        self._calm_until: Optional[float] = None  # see `_tick_if_due`
        self._run_at: Dict[int, Run] = {}  # see `run_at`

    # -- driving ------------------------------------------------------------------------------------

    def take_effects(self) -> List[Effect]:
        """What is to be done since the last call, in this order."""
        taken, self._effects = self._effects, []
        return taken

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) at which `tick` must be called at the latest; None: nothing is due.

        After a robot's report it may be somewhat earlier than needed: `tick` finds nothing to do then.
        """
        runs = self._runs_deadline() if self._calm_until is None else self._calm_until
        modules = self.modules.deadline()
        deadline = min(t for t in (runs, modules, self._reopen_deadline()) if t is not None)
        return None if deadline == math.inf else deadline

    def tick(self, now: Now) -> None:
        """Do what is due by now. Every other event does this first, so that time-outs come in order."""
        self._calm_until = None
        self._look_at_clock(now)
        self._miss_modules(now)
        self._reopen(now)
        for run in self._zone_runs():
            run.tick(now)

    def _tick_if_due(self, now: Now) -> None:
        """As `tick`, for reports: they come far more often than all else, and must not cost a look at every run
        each. Until `_calm_until` (monotonic, s) no run has anything to do: a report only moves the deadline of its
        own run, and every other event has all runs looked at again (None)."""
        modules = self.modules.deadline()
        calm = self._calm_until is not None and now.mono < self._calm_until and (modules is None or now.mono < modules)
        if calm:
            self._look_at_clock(now)
        else:
            self.tick(now)
            self._calm_until = self._runs_deadline()

    def _runs_deadline(self) -> float:
        """Monotonic time (s) at which the next run has something to do; infinity: none has."""
        times = [run.deadline() for run in self._zone_runs()]
        return min((t for t in times if t is not None), default=math.inf)

    def _look_at_clock(self, now: Now) -> None:
        self.watches.start(now)
        step = self._clock.look(now)
        if step:
            self.robots.restart_skews()
            for run in self.runs():
                run.link.restart_skew()
            self._notice(Level.WARNING, self.watches.clock_stepped(now, step))

    # -- looking ------------------------------------------------------------------------------------

    def runs(self) -> List[Run]:
        """All runs of single robots, in the order of the zones; each has a private channel."""
        return [member for run in self._zone_runs() for member in run.members()]

    def run_of(self, robot_id: RobotId) -> Optional[Run]:
        """The run that a robot is in; a robot is in one at most in the whole box."""
        return next((run for run in self.runs() if run.robot == robot_id), None)

    def run_at(self, port: int) -> Optional[Run]:
        """The run whose private channel has this port."""
        run = self._run_at.get(port)
        if run is None or not self._is_in_zone(run):
            # Each datagram asks: what was found stays true until a zone's run changes, which is seldom.
            self._run_at = {member.port: member for member in self.runs()}
            run = self._run_at.get(port)
        return run

    def _is_in_zone(self, run: Run) -> bool:
        whole = self.zones[run.zone].run
        return whole is run or (whole is not None and run in whole.members())

    def listening_left(self, now: Now) -> float:
        """For how many seconds the box still only listens (docs/protocol.md, "Timing"); 0.0: it transmits."""
        return self.watches.listening_left(now)

    def beacon(self) -> Beacon:
        """What the beacon says now."""
        robots = tuple(BenchmarkingRobot(r.robot.team, r.robot.robot, r.port) for r in self.runs())
        return Beacon(robots, self.devices, self.tablet.state)

    def warnings(self, now: Now) -> List[str]:
        """What every referee should know now."""
        catering = any(zone.event.benchmark.code == CATERING for zone in self.zones.values())
        devices = self.watches.devices_warnings() if catering else []
        ports = ports_warning(self.settings.rsbb_port, self._last_port)
        return self.watches.warnings(now) + devices + self.tablet.warnings(now, catering) + ports

    def reasons_off(self, now: Now, zone: Zone, command: str) -> List[str]:
        """Every reason why a command to a zone would be refused now; empty: it is allowed."""
        return COMMANDS[command].reasons_off(self, zone, now)

    def capacity(self) -> Capacity:
        """What there is room for besides the runs that there are."""
        return Capacity(self._beacon_size, self.settings.max_datagram, self._last_port, self.beacon().robots)

    def link_samples(self, now: Now, unreadable: Mapping[int, int]) -> Tuple[Tuple[int, LinkSample], ...]:
        """The port of each robot in a run, and how its link was since the last call: to be called once a second.

        `unreadable`: by port, all datagrams so far that could not be read; a port that is not there has none.
        """
        return tuple((run.port, run.link.sample(now, unreadable.get(run.port, 0))) for run in self.runs())

    # -- the referee --------------------------------------------------------------------------------

    def command(self, now: Now, zone_name: str, command: str, who: str = "", reason: str = "") -> None:
        """Carry out connect, disconnect, start, stop, previous or next; raises `Refused`.

        `reason`: why the run is stopped, if it is by this command.
        """
        self.tick(now)
        with self._recording(RunName(zone_name), who, command, reason=reason):
            zone = self.zone(zone_name)
            reasons = self.reasons_off(now, zone, command)
            if reasons:
                raise Refused(reasons)
            by = By(checked_who(who), cut_note(reason))  # no stop is refused for many words
            self._changed.add(zone.name)
            COMMANDS[command].execute(self, zone, now, by)

    def zone(self, name: str) -> Zone:
        """The zone of that name; raises `Refused` with the names that there are."""
        zone = self.zones.get(name)
        if zone is None:
            raise Refused([f"no zone '{name}'{did_you_mean(name, self.zones)}"])
        return zone

    def connect(self, now: Now, zone: Zone) -> None:
        """Begin a run in a zone whose *connect* is allowed."""
        robots = robots_to_connect(self, zone, now)
        assert robots, "connect was checked before"
        self._failures_left[zone.name] = MAX_PORTS_TRIED + len(robots) - 1
        for robot in robots:
            self._open_run(now, zone, robot)

    def leave(self, now: Now, zone: Zone, by: By = NOBODY) -> None:
        """Disconnect the run in a zone."""
        run = zone.run
        assert run is not None, "disconnect was checked before"
        run.close(now, by)
        self.finished.add(run.record(now))
        zone.leave(self.settings.auto_next)
        self._emit(effects.SendBeacon())

    def _zone_runs(self) -> List[ZoneRun]:
        return [zone.run for zone in self.zones.values() if zone.run is not None]

    def _run_in(self, zone_name: str) -> ZoneRun:
        run = self.zone(zone_name).run
        if run is None:
            raise Refused([NO_RUN])
        return run

    def _open_run(self, now: Now, zone: Zone, robot: ActiveRobot) -> None:
        self._last_port += 1
        entry = Entry(zone.name, zone.event, robot.id, self._last_port)
        self._emit(effects.PortTaken(entry.port))
        self._emit(effects.OpenChannel(entry.port, robot.id.team, robot.id.robot, robot.host))
        if zone.event.benchmark.kind is Kind.REFEREE_ONLY:
            zone.run = zone.run or AllRobotsRun(entry, self.settings, self._surroundings(zone.name), now)
            zone.run.add(now, entry)
        else:
            zone.run = run = self._make_run(now, entry)
            run.open(now)
        self.run_at(entry.port).link.expect_after(robot.last_heard, robot.time)
        if zone.event.benchmark.code == CATERING:
            self.tablet.display_map = False  # what the run before left on the tablet is not this robot's
        self._emit(effects.SendBeacon())

    def _make_run(self, now: Now, entry: Entry) -> Run:
        surroundings = self._surroundings(entry.zone)
        if entry.event.benchmark.kind is Kind.FUNCTIONALITY:
            return FunctionalityRun(entry, self.settings, surroundings, self.modules, now)
        return Run(entry, self.settings, surroundings, now)

    def _surroundings(self, zone: str) -> Surroundings:
        return Surroundings(self._emit_in(zone), self._show_map)

    # -- the network --------------------------------------------------------------------------------

    def on_channel_failed(self, now: Now, port: int, error: str) -> None:
        """The channel on `port` could not be opened: take the next port, or give this robot's run up."""
        run = self.run_at(port)
        if run is None:
            return
        self._calm_until = None
        if run.resumed:
            self._reopen_later(now, run, error)
            return
        zone = self.zones[run.zone]
        text = f"UDP port {port} cannot be used for the private channel: {error}"
        self._notice(Level.WARNING, text, zone.name)
        run.close(now)
        zone.run = zone.run.without(run)
        self._failures_left[zone.name] -= 1
        robot = self.robots.find(run.robot)
        if robot is not None and self._failures_left[zone.name] > 0 and self._last_port < LAST_PORT:
            self._open_run(now, zone, robot)
            return
        given_up = "the run was not begun" if zone.run is None else f"{run.robot} does not take part"
        self._notice(Level.ERROR, f"No private channel could be opened: {given_up}", zone.name)
        self._emit(effects.SendBeacon())

    def on_robot_beacon(self, now: Now, host: str, team: str, robot: str, time: WireTime) -> None:
        """A RobotBeacon arrived from `host`."""
        self.tick(now)
        robot_id = RobotId(team, robot)
        known = self.robots.find(robot_id)
        heard = self.robots.hear(now, robot_id, host, time)
        text = None
        if heard is None:
            text = self.watches.not_listed(now, host)
        elif known is None:
            self._notice(Level.INFO, f"Robot {robot_id} is active at {host}")
        elif heard.has_rival(now):
            text = self.watches.rivals(now, heard)
        if text:
            self._notice(Level.WARNING, text)
        squatter = self.robots.take_squatter()
        text = self.watches.squatter(now, squatter) if squatter is not None else None
        if text:
            self._notice(Level.WARNING, text)

    def on_robot_report(self, now: Now, port: int, host: str, report: RobotReport) -> None:
        """A RobotState arrived on the private channel `port` from `host`."""
        self._tick_if_due(now)
        run = self.run_at(port)
        if run is None:
            return
        calm_until, self._calm_until = self._calm_until, None
        if run.on_report(now, host, report):
            self.robots.hear(now, run.robot, host, report.time, certain=True)
        due = run.deadline()
        self._calm_until = calm_until if due is None else min(calm_until, due)

    def on_unreadable(self, now: Now, port: int, text: str) -> None:
        """Unreadable datagrams arrived on the private channel `port`; `text` says from whom and why."""
        run = self.run_at(port)
        if run is not None:
            run.link.on_bad_datagram(now, text)

    def on_complaint(self, now: Now, text: str) -> None:
        """Unreadable datagrams arrived on the public channel, or one could not be sent; `text` says why."""
        self.watches.complaint(now, text)
        self._notice(Level.WARNING, text)

    def on_foreign_box(self, now: Now, host: str) -> None:
        """Another box's beacon (or state on a private channel) arrived from `host`."""
        self.tick(now)
        if self.listening_left(now) > 0 and not self.settings.take_over:
            self._emit(effects.GiveUp(
                f"Another RSBB is running at {host}: stop that one, or give this one another rsbb_host or "
                "rsbb_port. If no box of yours is there, somebody forges its beacons: start with take_over:=true, "
                f"and take {host} off the network"
            ))
            return
        text = self.watches.foreign_box(now, host)
        if text:
            self._notice(Level.ERROR, text)

    def on_tablet(self, now: Now, host: str, beacon: TabletState) -> None:
        """A TabletBeacon arrived from `host`; which view it shows is not its to say."""
        self.tick(now)
        before = self.tablet.state
        heard = self.tablet.hear(now, host, beacon)
        text = self.watches.tablet(now, host, heard)
        if text:
            self._notice(Level.WARNING, text)
        if self.tablet.state != before:
            self._emit(effects.SendBeacon())

    def on_devices(self, now: Now, devices: DevicesState) -> None:
        """The devices told their state."""
        self.tick(now)
        if devices != self.devices:
            self.devices = devices
            self._emit(effects.SendBeacon())

    def on_devices_status(self, now: Now, connected: bool, text: str) -> None:
        """The devices node says whether it reaches the devices' controller; `text` says how, or why not."""
        self.tick(now)
        self.watches.devices(connected, text)

    def on_device_refused(self, now: Now, zone_name: str, device: str, value: int, reason: str) -> None:
        """A robot's command to a device (`SetDevice`) could not be carried out."""
        self.tick(now)
        text = self.watches.device_refused(now, device, value, reason)
        run = self.zones[zone_name].run
        if isinstance(run, Run) and run.event.benchmark.code == CATERING:
            run.warn(now, text)
        else:  # the run that it came from was left since
            self._notice(Level.WARNING, text, zone_name)

    def on_trouble(self, now: Now, text: str) -> None:
        """Something on this computer does not work; `text` names the remedy. Every referee is told."""
        self.tick(now)
        if self.watches.trouble(now, text):
            self._notice(Level.ERROR, text)

    def on_mended(self, now: Now, trouble: str, text: str) -> None:
        """A trouble that was told is over, and `text` says so."""
        self.tick(now)
        self.watches.mended(trouble)
        self._notice(Level.INFO, text)

    def on_journal(self, now: Now, trouble: str) -> None:
        """What keeps the journal from the disk, with the remedy; empty: all of it is written now."""
        self.tick(now)
        if self.watches.journal(trouble):
            level, text = (Level.ERROR, trouble) if trouble else (Level.INFO, "The journal is written again")
            self._notice(level, text)

    def _show_map(self, display_map: bool) -> None:
        if display_map != self.tablet.display_map:
            self.tablet.display_map = display_map
            self._emit(effects.SendBeacon())

    # -- shared -------------------------------------------------------------------------------------

    def _emit(self, effect: Effect) -> None:
        if isinstance(effect, effects.SendBeacon):
            self._changed.add(BOX)
        self._effects.append(effect)

    def _notice(self, level: Level, text: str, zone: str = "") -> None:
        self._emit(effects.Notice(level, text, zone))
