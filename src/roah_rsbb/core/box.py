"""The box: all zones, all robots and the content of the beacon. All events enter here.

Every public method that takes an event also takes `now`, and leaves its effects for `take_effects`. A command of the
referee that is not possible now raises `Refused` and changes nothing.
"""

import math
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Set, Tuple

from roah_rsbb.core import effects
from roah_rsbb.core.actions.table import NOTHING, Actions, Entries, Target
from roah_rsbb.core.connections import Candidates, Connections
from roah_rsbb.core.continuing import BoxSaved, Reload, Restart, Saved
from roah_rsbb.core.copies import Copies, CopyReport
from roah_rsbb.core.desks import CommandRecord, JudgeDesk, ModuleDesk, ScoreDesk
from roah_rsbb.core.effects import Effect, How, Level, Outbox
from roah_rsbb.core.link.freshness import Heard
from roah_rsbb.core.modules import Modules
from roah_rsbb.core.robots import ActiveRobots, RobotId
from roah_rsbb.core.runs.run import Consequence, Run
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.tablet import Tablet
from roah_rsbb.core.watches import ClockWatch, Watches
from roah_rsbb.core.zones import Zones, ZoneState
from roah_rsbb.model.actions import ENTRIES
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import Beacon, BoxMessage, DevicesState, LinkSample, RobotReport, TabletState
from roah_rsbb.model.reason import Refused, cut_note, say
from roah_rsbb.protocol import WireTime
from roah_rsbb.rulebook.benchmarks import Config
from roah_rsbb.rulebook.event_ids import EventKey
from roah_rsbb.rulebook.registry import DEVICES, TABLET
from roah_rsbb.scoring.book import FinishedRuns

REPLAY = say("This is a replay of {run}: nothing here is live, and commands have no effect")
SUPERSEDED = say("This box is superseded: the box at {address} has taken over. Nothing is sent to robots, and commands "
                 "are refused. Use the panels of the other box")


class Box:
    """The referee, scoring and benchmarking box, without its sockets, clocks and files."""

    def __init__(
        self,
        config: Config,
        settings: Settings,
        beacon_size: Callable[[Beacon], int],
        last_port: Optional[int] = None,
        version: int = 0,
    ) -> None:
        """`beacon_size`: bytes of the datagram that carries a beacon. `last_port`: the highest private port that this
        competition has used, from the journal; None: no port was used yet. `version`: of the configuration."""
        self.settings = settings
        self._outbox = outbox = Outbox()
        # Runs: in zones, and finished.
        self.zones = zones = Zones(config.zones)
        self.finished = FinishedRuns(config.benchmarks, config.ranking)
        # Robots, devices and warnings.
        self.robots = ActiveRobots(
            settings.robot_timeout, config.passwords, lambda: {run.robot for run in zones.members()},
            settings.allowed_skew)
        self.devices = DevicesState()
        self.tablet = Tablet()
        self.watches = Watches(settings.listen_duration)
        self.copies = Copies()
        self.copies.use(config)
        self.heard = Heard(settings.allowed_skew)
        self._modules = Modules()
        # What changes runs.
        self._connections = Connections(
            settings, zones, self.robots, self._modules, self.tablet, self.watches, self.finished, self.heard,
            self.copies, outbox, beacon_size, last_port,
        )
        self._connections.version = version
        self._reload = Reload(zones, self.robots, self.finished, self._connections, self.copies, outbox,
                              config.time_zone)
        self._restart = Restart(zones, self.finished, self._connections, self.watches, outbox)
        self._record = record = CommandRecord(zones, outbox)
        self.candidates = Candidates(settings, zones, self.robots, self.watches, self._connections, self.finished)
        self.scores = ScoreDesk(self.tick, zones, self.finished, record, outbox)
        self.actions = Actions(self.candidates, self._connections, self.scores, zones, record, outbox)
        self.judges = JudgeDesk(self.scores, outbox)
        self.modules = ModuleDesk(self.tick, zones, self._modules, record)
        self.entries = Entries(zones, self.scores, self.judges, record)
        # Time.
        self._clock = ClockWatch()
        self._clock_set_mono = -math.inf  # when a step of the box's clock was noticed last
        self._latest_mono = -math.inf  # of the latest event
        self._calm_until: Optional[float] = None  # see `tick_if_due`
        self._ticks = 0
        self._replay = ""  # see `begin_replay`
        self.superseded_by = ""  # address of the box that took over; see `supersede`
        self._superseded = ""  # what panels say then

    # -- driving ------------------------------------------------------------------------------------

    def take_effects(self) -> List[Effect]:
        """Return the effects since the last call, in the order in which to carry them out."""
        return self._outbox.take()

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) at which `tick` must be called at the latest; None: nothing is due.

        After a robot's report, it may be earlier than needed. `tick` then has nothing to do.
        """
        if self._superseded:
            return None
        runs = self._runs_deadline() if self._calm_until is None else self._calm_until
        ports = self._connections.deadline()
        deadline = runs if ports is None else min(runs, ports)
        return None if deadline == math.inf else deadline

    def tick(self, now: Now) -> None:
        """Do what is due by now. Every other event does this first, so that timeouts keep their order."""
        if self._superseded:
            return  # the runs continue in another box
        self._latest_mono = now.mono
        self._calm_until = None
        self._ticks += 1
        self._look_at_clock(now)
        self.modules.tick(now)
        self._connections.tick(now)
        for run in self.zones.runs():
            run.tick(now)

    def tick_if_due(self, now: Now) -> None:
        """Like `tick`, for beacons, reports and views, which are too frequent to check every run each time.

        Nothing in a run is due until `_calm_until` (monotonic, s). A report only moves the deadline of its own run, a
        beacon none. Every other event sets `_calm_until` to None; then all runs are checked again.
        """
        if self.is_calm(now.mono):
            self._latest_mono = now.mono
            self._look_at_clock(now)
        else:
            self._tick_until_calm(now)

    def is_calm(self, mono: float) -> bool:
        """Whether nothing in a run is due at a monotonic time (s); False: it must be looked at, see `tick_if_due`."""
        return self._calm_until is not None and mono < self._calm_until

    def _tick_until_calm(self, now: Now) -> None:
        self.tick(now)
        self._calm_until = self._runs_deadline()

    def _runs_deadline(self) -> float:
        """Return the monotonic time (s) at which the next run or module has something to do; infinity if none has."""
        times = [self.modules.deadline(), *(run.deadline() for run in self.zones.runs())]
        return min((t for t in times if t is not None), default=math.inf)

    def _look_at_clock(self, now: Now) -> None:
        self.watches.start(now)
        step = self._clock.look(now)
        if step:
            self._clock_set_mono = now.mono
            self.robots.restart_skews()
            for run in self.zones.members():
                run.link.restart_skew()
            self._outbox.notice(Level.WARNING, self.watches.clock_stepped(now, step))

    def arrival(self, now: Now, received_utc: Optional[float]) -> Now:
        """Return when a datagram that is handled `now` arrived. `received_utc`: when the system received it, by the
        same clock as `now` (s); None: unknown, so now.

        On a busy computer the box reads a datagram late. That delay must not look like a robot's wrong clock, nor like
        its silence.
        """
        if received_utc is None:
            return now
        mono = now.mono - (now.utc - received_utc)
        # Before a step of the clock, `received_utc` was on another clock.
        return Now(mono, received_utc) if self._clock_set_mono < mono < now.mono else now

    def _take_arrival(self, now: Now, received_utc: Optional[float]) -> Tuple[Now, Now]:
        """Do what is due before a datagram. Return when it arrived, and when it takes effect: then, but not before the
        latest event, because the box's own times never go back.

        A result that arrived within the run's time counts, even if the box was busy when the time was over.
        """
        self._look_at_clock(now)
        arrival = self.arrival(now, received_utc)
        latest = self._latest_mono
        effective = arrival if arrival.mono >= latest else now.later(min(0.0, latest - now.mono))
        if self.is_calm(effective.mono):
            self._latest_mono = effective.mono
        else:
            self._tick_until_calm(effective)
        return arrival, effective

    # -- looking ------------------------------------------------------------------------------------

    @property
    def revision(self) -> int:
        """A number that rises whenever the state of a zone, or the record of a run, changes.

        A report of a robot that only repeats its state does not raise it, nor does time that only passes.
        """
        return self._outbox.revision

    @property
    def revisions(self) -> Mapping[str, int]:
        """What `revision_of` returns, for all zones that had any change; it stays current."""
        return self._outbox.revisions

    def revision_of(self, zone_name: str) -> int:
        """Return a number that rises whenever the state of a zone changes, or what is shown of it but with time."""
        return self._outbox.revision_of(zone_name)

    @property
    def happenings(self) -> int:
        """A number that rises with all that happens. Time that passes, robots that repeat what they said, and beacons
        of known robots do not raise it."""
        return self._ticks + self._outbox.emitted + self._outbox.revision + self.robots.changes

    def listening_left(self, now: Now) -> float:
        """Return for how many more seconds the box only listens (docs/protocol.md, "Timing"); 0.0: it transmits."""
        if self._superseded:
            return 0.0
        return self.watches.listening_left(now)

    @property
    def time_zone(self) -> str:
        """Name of the venue's time zone; empty: not known."""
        return self._reload.time_zone

    @property
    def is_held(self) -> bool:
        """Whether it sends nothing because of another box, until a referee connects a robot."""
        return bool(self.watches.held_by)

    def beacon(self) -> Beacon:
        """Return the current content of the beacon."""
        return Beacon(self._connections.listed(), self.devices, self.tablet.state)

    def warnings(self, now: Now) -> List[str]:
        """Return the current warnings for every referee."""
        if self._replay or self._superseded:
            return [self._replay or self._superseded]
        uses = frozenset().union(*(zone.event.benchmark.profile.uses for zone in self.zones.values()))
        devices = self.watches.devices_warnings() if DEVICES in uses else []
        ports = self._connections.warnings()
        tablet = self.tablet.warnings(now, TABLET in uses)
        return self.watches.warnings(now) + self.copies.warnings(now) + devices + tablet + ports

    def warnings_of(self, now: Now, zone_name: str) -> List[str]:
        """Return the current warnings for the referee of a zone. Some faces show the first one only: those of a robot
        that may still be moving come first."""
        if self._superseded:
            return []
        zone = self.zones[zone_name]
        of_run = [] if zone.run is None else zone.run.warnings(now) + zone.run.times.warnings()
        return of_run + self.candidates.outsiders(now, zone)

    def link_samples(self, now: Now, unreadable: Mapping[int, int]) -> Tuple[Tuple[int, LinkSample], ...]:
        """Return the port of each robot in a run, and its link's quality since the last call. Call this once a second.

        `unreadable`: by port, the number of all datagrams so far that could not be read. Missing ports have none.
        """
        return tuple((run.port, run.link.sample(now, unreadable.get(run.port, 0))) for run in self.zones.members())

    # -- restarts -----------------------------------------------------------------------------------

    def take_changed(self) -> Set[str]:
        """The names of zones whose state changed since the last call, and `effects.BOX` for the rest."""
        return self._outbox.take_changed()

    def saved(self) -> BoxSaved:
        """Return the state that belongs to no zone."""
        return BoxSaved(self.devices, self.tablet.state, self.heard.state)

    def resume(self, now: Now, saved: Saved) -> None:
        """Continue from the state that was saved before a restart. Call it once, before any other event."""
        self.devices = saved.box.devices
        self.tablet.restore(saved.box.tablet)
        self.heard.restore(saved.box.heard)
        self._restart.resume(now, saved, self.superseded_by)
        self._outbox.revision += 1  # whoever looked before must look again, also at what no event of a run reports
        self.tick(now)

    # -- replays ------------------------------------------------------------------------------------

    def begin_replay(self, run: str) -> None:
        """Show only earlier states of a run from now on. The only warning says so, and every command is refused."""
        self._replay = REPLAY(run=run)
        self._record.close(self._replay)
        self._connections.hears_beacons = False

    def show(self, now: Now, zone_name: str, state: Optional[ZoneState]) -> None:
        """Put an earlier state into a zone; None: the zone had no run. Raises ValueError. Do not call `tick`."""
        self._restart.show(now, self.zones[zone_name], state)

    # -- another box takes over ---------------------------------------------------------------------

    @property
    def is_superseded(self) -> bool:
        """Whether another box took over."""
        return bool(self._superseded)

    def supersede(self, epoch: int, cut: int, by: str) -> None:
        """A standby took over, with this epoch: stop at once. `cut`: see `effects.Superseded`; `by`: its address."""
        if not self._superseded:
            self._outbox.emit(effects.Superseded(epoch, cut, by))
            self.stay_superseded(by)
            self._outbox.notice(Level.ERROR, self._superseded)

    def stay_superseded(self, by: str) -> None:
        """A standby took over before the restart. Nothing is sent, and the runs stay as they were."""
        self.superseded_by = by
        self._superseded = SUPERSEDED(address=by)
        self._record.close(self._superseded)

    # -- the organiser ------------------------------------------------------------------------------

    def reload_off(self, config: Config) -> List[str]:
        """Return why a configuration cannot be taken now; empty: it can."""
        return [self._superseded] if self._superseded else self._reload.off(config)

    def ran(self) -> List[EventKey]:
        """Return the events of all runs, as they were when the runs were connected."""
        return self._reload.ran()

    def reload(self, now: Now, config: Config, version: int, changes: Sequence[str], who: str = "") -> None:
        """Put another configuration into force; raises `Refused`. `changes` lists what it changes."""
        self.tick(now)
        if self._superseded:
            raise Refused([self._superseded])
        self._reload.take(config, version, changes, who)

    # -- the referee --------------------------------------------------------------------------------

    def act(self, now: Now, target: Target, action: str, who: str = "", given: Mapping[str, Any] = NOTHING) -> None:
        """Do one of `model.actions.EVERY`; see `Actions.do`. Raises `Refused`."""
        self.tick(now)
        (self.entries if action in ENTRIES else self.actions).do(now, target, action, who, given)

    def outcome(self, target: Target, action: str, given: Mapping[str, Any]) -> Dict[str, Any]:
        """Return what the answer to an action that was done says besides, as JSON; see `Entries.outcome`."""
        return self.entries.outcome(target, action, given)

    # -- the network --------------------------------------------------------------------------------

    def on_channel_failed(self, now: Now, port: int, error: str) -> None:
        """The channel on `port` could not be opened."""
        self._calm_until = None
        self._connections.on_failed(now, port, error)

    def on_robot_beacon(
        self, now: Now, host: str, team: str, robot: str, time: WireTime, received_utc: Optional[float] = None,
        has_route: bool = True,
    ) -> None:
        """A RobotBeacon arrived from `host`. `received_utc`: see `arrival`. `has_route`: whether the box can reach it.
        """
        arrival, now = self._take_arrival(now, received_utc)
        robot_id = RobotId(team, robot)
        known = self.robots.find(robot_id)
        heard = self.robots.hear(arrival, robot_id, host, time, has_route=has_route)
        texts: List[Optional[str]] = []
        if heard is None:
            texts.append(self.watches.not_listed(now, host))
        elif known is None:
            self._outbox.notice(Level.INFO, f"Robot {robot_id} is active at {host}")
        else:
            texts += [self.watches.rivals(now, heard), self.watches.two_clocks(now, heard)]
            rivals, run = heard.rivals(now), self.zones.run_of(robot_id)
            if rivals and run is not None and not heard.is_here(rivals):
                self._outbox.mark_shown(run.zone)  # the robot's next report shows that there are two
        squatter = self.robots.take_squatter()
        if squatter is not None:
            texts.append(self.watches.squatter(now, squatter))
        for text in filter(None, texts):
            self._outbox.notice(Level.WARNING, text)

    def on_robot_report(
        self, now: Now, port: int, host: str, report: RobotReport, received_utc: Optional[float] = None,
    ) -> Optional[BoxMessage]:
        """A RobotState arrived on the private channel `port` from `host`. `received_utc`: see `arrival`.

        Return what the box says to the robot from now on, if nothing else came of the report: there are no effects, and
        nothing is due earlier than before. Return None otherwise.
        """
        ticks = self._ticks
        arrival, now = self._take_arrival(now, received_utc)
        run = self.zones.run_at(port)
        if run is None:
            return None
        taken = run.on_report(now, host, report, arrival)
        if taken is not Consequence.NONE:
            heard = self.robots.hear(arrival, run.robot, host, report.time, certain=True)
            rivals = heard and self.watches.rivals(now, heard)
            if rivals:
                self._outbox.notice(Level.WARNING, rivals)
        is_due = self.heard.take_due()
        if is_due:
            self._outbox.mark_box_changed()
        if taken is Consequence.LINK_ONLY:
            if self._ticks == ticks and self._outbox.is_empty() and not is_due:
                return run.message
            self._outbox.emit(effects.SendState(port, run.message, How.QUIET))
        due = run.deadline()
        assert self._calm_until is not None, "`_take_arrival` sets it"
        self._calm_until = self._calm_until if due is None else min(self._calm_until, due)
        return None

    def on_robot_copy(self, now: Now, port: int, host: str, count: int = 1) -> None:
        """Handle copies of datagrams that arrived on the private channel `port` before. `host` sent the last copy."""
        self.tick_if_due(now)
        run = self.zones.run_at(port)
        if run is not None:
            run.on_copy(now, host, count)

    def on_robot_overload(self, now: Now, port: int, count: int) -> None:
        """Handle `count` datagrams on the private channel `port` that were not read because the robot sends too
        much."""
        self.tick_if_due(now)
        run = self.zones.run_at(port)
        if run is not None:
            run.on_overload(now, count)

    def on_unreadable(self, now: Now, port: int, text: str) -> None:
        """Handle unreadable datagrams on the private channel `port`. `text` says from whom and why."""
        run = self.zones.run_at(port)
        if run is not None:
            run.link.on_bad_datagram(now, text)
            self._outbox.mark_shown(run.zone)

    def on_complaint(self, now: Now, text: str) -> None:
        """Handle unreadable datagrams on the public channel, or one that could not be sent. `text` says why."""
        self.watches.complaint(now, text)
        self._outbox.notice(Level.WARNING, text)

    def on_foreign_box(self, now: Now, host: str) -> None:
        """Another box's beacon (or state on a private channel) arrived from `host`."""
        self.tick(now)
        if self.is_held or (self.listening_left(now) > 0 and not self.settings.take_over):
            # Anybody can forge the beacon of a box, so the referee decides.
            self._outbox.emit(effects.AnotherBox(host))
            text = self.watches.hold(host)
        else:
            text = self.watches.foreign_box(now, host)
        if text:
            self._outbox.notice(Level.ERROR, text)

    def on_tablet(self, now: Now, host: str, beacon: TabletState) -> None:
        """A TabletBeacon arrived from `host`. The box, not the tablet, decides which view is shown."""
        self.tick(now)
        before = self.tablet.state
        heard = self.tablet.hear(now, host, beacon)
        text = self.watches.tablet(now, host, heard)
        if text:
            self._outbox.notice(Level.WARNING, text)
        if self.tablet.state != before:
            self._outbox.emit(effects.SendBeacon())

    def on_devices(self, now: Now, devices: DevicesState) -> None:
        """The devices reported their state."""
        self.tick(now)
        if devices != self.devices:
            self.devices = devices
            self._outbox.emit(effects.SendBeacon())

    def on_devices_status(self, now: Now, connected: bool, text: str) -> None:
        """The devices' controller is reached, or not. `text` gives details or the reason."""
        self.tick(now)
        self.watches.devices(connected, cut_note(text))

    def on_device_refused(self, now: Now, zone_name: str, device: str, value: int, reason: str) -> None:
        """A robot's command to a device (`SetDevice`) could not be carried out."""
        self.tick(now)
        text = self.watches.device_refused(now, device, value, cut_note(reason))
        run = self.zones[zone_name].run
        if isinstance(run, Run) and DEVICES in run.event.benchmark.profile.uses:
            run.warn(now, text)
        else:  # the run that commanded it has been left
            self._outbox.notice(Level.WARNING, text, zone_name)

    def on_notice(self, now: Now, text: str) -> None:
        """Warn of something that was over before this start. Referees see the warning for a minute."""
        self.tick(now)
        if self.watches.notice(now, text):
            self._outbox.notice(Level.WARNING, text)

    def on_trouble(self, now: Now, text: str) -> None:
        """Warn every referee that something on this computer does not work. `text` names the remedy."""
        self.tick(now)
        if self.watches.trouble(now, text):
            self._outbox.notice(Level.ERROR, text)

    def on_repaired(self, now: Now, trouble: str, text: str) -> None:
        """End the warning of a reported trouble. `text` says that it is over."""
        self.tick(now)
        self.watches.repaired(trouble)
        self._outbox.notice(Level.INFO, text)

    def on_journal(self, now: Now, trouble: str) -> None:
        """Warn of a journal that cannot be written. `trouble` names the remedy; empty: everything is written again."""
        self.tick(now)
        if self.watches.journal(trouble):
            level, text = (Level.ERROR, trouble) if trouble else (Level.INFO, "The journal is written again")
            self._outbox.notice(level, text)

    def on_copy_report(self, now: Now, report: CopyReport) -> None:
        """The node that copies the journal reports how complete the copy is."""
        self.tick_if_due(now)
        change = self.copies.report(now, report)
        if change is not None and not self.is_superseded:
            level, text = (Level.ERROR, change) if change else (
                Level.INFO, f"The copy of the journal ({report.place}) is complete again")
            self._outbox.notice(level, text)

    def on_copy_answer(self, now: Now, ticket: int) -> None:
        """The standby has everything up to this ticket of the journal (`Copies.ask`)."""
        self.tick(now)
        if self.copies.answer(ticket):
            self._outbox.notice(Level.INFO, "The standby has all entries again")

    def on_copy_given_up(self, now: Now, ticket: int) -> None:
        """A referee's entry is reported as not confirmed (`Copies.give_up`)."""
        self.tick(now)
        text = self.copies.give_up(now, ticket)
        if text is not None:
            self._outbox.notice(Level.WARNING, text)
