"""Continues the runs from the saved state of the box after a restart of the core, and with another configuration.

Theory of operation of a restart. Whatever changes the state of a zone marks the zone. The driver of the box takes the
marked zones with `Outbox.take_changed`, and records their state before it carries out any effect. After a restart,
`Restart.resume` builds every zone from its state: each run continues with its state, clocks, scores, strings and
private port. Robots only notice a gap of a few seconds.

Active robots and nodes of benchmarking modules are not saved. Both repeat everything important each second.

Theory of operation of another configuration (docs/organiser.md, "Changes during the competition"). Each configuration
has a *version*, a rising number. A run keeps the event, and so the benchmark, of the version with which it was
connected, and its channel keeps that version's password. Its zone saves the version, so that the run also keeps them
after a restart of the core. When the run is left, its zone takes the present schedule.

Results belong to their runs, not to the schedule, so they stay whatever happens to their events. The list of changes
says what becomes of them.
"""

from types import MappingProxyType
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.core import effects
from roah_rsbb.core.authority import Authority
from roah_rsbb.core.connections import Connections
from roah_rsbb.core.copies import Copies
from roah_rsbb.core.devices import ReportedDevices
from roah_rsbb.core.effects import Level, Outbox
from roah_rsbb.core.link.freshness import Heard, HeardState
from roah_rsbb.core.robots import ActiveRobots
from roah_rsbb.core.runs.run import UnrecordedStop
from roah_rsbb.core.tablet import Tablet
from roah_rsbb.core.timers import Timers
from roah_rsbb.core.watches import Watches
from roah_rsbb.core.zones import Zone, Zones, ZoneState, is_same, key_of_record
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import DevicesState, TabletState
from roah_rsbb.model.reason import Refused, checked_who, say
from roah_rsbb.model.records import Phase, RunRecord, SignOff
from roah_rsbb.rulebook.benchmarks import Config, ScheduledEvent, ZonePlan
from roah_rsbb.rulebook.event_ids import EventKey, key_of
from roah_rsbb.scoring.book import FinishedRuns, Rescored, left_behind, rescored
from roah_rsbb.scoring.counting import with_events
from roah_rsbb.wording import sheets, times

REPLAY = say("This is a replay of {run}: nothing here is live, and commands have no effect")
RESTARTED = say("The box was restarted at {time}, {down} s after its last record")
CONTINUES, CONTINUES_AT = say("{text}: the run continues if its robot does"), say(
    "{text}: the run continues on the box at {address}")
LOST = say("The run of {benchmark}, team {team}, that was connected before the restart cannot continue: {why}. Its "
           "scores are in the journal: the program 'results' shows them")
ZONE_GONE = say("zone '{zone}' is no longer in the schedule")
EVENT_GONE = say("its event is no longer in the schedule of zone '{zone}'")
GOES_BACK = say("The schedule was changed while no box ran: the zone goes to {code}, team {team}")
INVALID = say("its saved state is invalid ({error})")


class BoxSaved(NamedTuple):
    """The saved state that belongs to no zone."""

    devices: DevicesState = DevicesState()
    tablet: TabletState = TabletState()
    heard: HeardState = {}  # up to which of their times robots were heard


class Saved(NamedTuple):
    """Everything from which a restarted core continues, and when it was saved."""

    utc: float  # UTC seconds of the last record before the restart
    box: BoxSaved
    zones: Dict[str, ZoneState]
    records: Tuple[RunRecord, ...] = ()  # of runs that are over, or were in progress
    earlier: Mapping[int, Config] = MappingProxyType({})  # configurations with which runs were connected, by version
    # By the identity of the run: the box before sent STOP, and its journal does not have it.
    stopped: Mapping[str, UnrecordedStop] = MappingProxyType({})
    mono: Optional[float] = None  # as `utc`, on the present monotonic clock (s); None: only UTC is known
    planned: Tuple[ZonePlan, ...] = ()  # the schedule that was in force, if another one is now


class Restart:
    """Continues the previous core's runs."""

    def __init__(
        self, timers: Timers, zones: Zones, finished: FinishedRuns, connections: Connections, devices: ReportedDevices,
        tablet: Tablet, heard: Heard, watches: Watches, authority: Authority, outbox: Outbox,
    ) -> None:
        self._timers = timers
        self._zones = zones
        self._finished = finished
        self._connections = connections
        self._devices = devices
        self._tablet = tablet
        self._heard = heard
        self._watches = watches
        self._authority = authority
        self._outbox = outbox

    def saved(self) -> BoxSaved:
        """Return the state that belongs to no zone."""
        return BoxSaved(self._devices.state, self._tablet.state, self._heard.state)

    def resume(self, now: Now, saved: Saved) -> None:
        """Continue from the state that was saved before a restart: all runs that can be continued. A box from which
        another one took over only shows them. Call it once, before any other event."""
        by = self._authority.superseded_by
        self._devices.state = saved.box.devices
        self._tablet.restore(saved.box.tablet)
        self._heard.restore(saved.box.heard)
        plans = [ZonePlan(zone.name, zone.planned) for zone in self._zones.values()]
        self._finished.restore(with_events(saved.records, plans))
        self._connections.leave_out(record.identity for record in saved.records)
        for name, state in saved.zones.items():
            zone = self._zones.get(name)
            if zone is None:
                self._lost(now, state, ZONE_GONE(zone=name))
            else:
                self._try_to_resume(now, zone, state, saved.earlier.get(state.version))
        self._follow_changes(saved)
        runs = self._zones.runs()
        for run in runs:
            if run.identity in saved.stopped and run.phase is Phase.RUNNING:
                run.take_stop(saved.stopped[run.identity])
        continuing = {run.identity for run in runs}
        for record in saved.records:
            if not record.closed_utc and record.identity not in continuing:
                self._give_up(record, saved.utc)
        if runs:
            down = max(0.0, now.utc - saved.utc if saved.mono is None else now.mono - saved.mono)
            text = RESTARTED(time=times.at_venue(now.utc), down=f"{down:.0f}")
            continuing_text = CONTINUES_AT(text=text, address=by) if by else CONTINUES(text=text)
            for run in runs:
                if run.phase is Phase.RUNNING and not by:
                    run.note_outage(now, down)
                run.warn(now, continuing_text if run.phase is Phase.RUNNING else text)
            self._watches.restarted(now, text)
            self._outbox.emit(effects.SendBeacon())
        self._outbox.revision += 1  # whoever looked before must look again, also at what no event of a run reports
        self._timers.tick(now)

    def begin_replay(self, run: str) -> None:
        """Show only earlier states of a run from now on. The only warning says so, and every command is refused."""
        self._authority.closed = REPLAY(run=run)
        self._connections.hears_beacons = False

    def show(self, now: Now, zone_name: str, state: Optional[ZoneState]) -> None:
        """Put an earlier state into a zone, to look at it; None: the zone had no run. Raises ValueError. Let no timer
        tick."""
        zone = self._zones[zone_name]
        self._outbox.mark_changed(zone.name)
        if state is None:
            if zone.run is not None:
                zone.leave(auto_next=False)
            return
        zone.run = None
        if not zone.resume_at(state):
            raise ValueError(f"the schedule of zone '{zone.name}' has no event {state.event.benchmark}, team "
                             f"{state.event.team}, round {state.event.round}, run {state.event.run} at this time")
        place = self._outbox.place()
        self._connections.reopen(now, zone, state)
        self._outbox.drop_since(place)

    def _follow_changes(self, saved: Saved) -> None:
        """Do in each zone what a reload does, if the schedule was changed while no box ran."""
        later = {}
        for plan in saved.planned:
            was = Zone(plan)
            if plan.name in self._zones and plan.name in saved.zones and was.resume_at(saved.zones[plan.name]):
                later[plan.name] = was.later()
        for zone in self._zones.go_back(later, self._finished.records()):
            self._outbox.mark_changed(zone.name)
            self._outbox.notice(Level.INFO, GOES_BACK(code=zone.event.benchmark.code, team=zone.event.team), zone.name)

    def _give_up(self, record: RunRecord, utc: float) -> None:
        """Close a run that cannot continue, at the time when the previous core ended. It can still be corrected."""
        record = left_behind(record, utc)
        self._finished.add(record)
        self._outbox.emit(effects.RecordChanged(record))

    def _try_to_resume(self, now: Now, zone: Zone, state: ZoneState, earlier: Optional[Config]) -> None:
        """`earlier`: the configuration with which the zone's run was connected, if it is no longer in force."""
        place = self._outbox.place()
        try:
            is_there = zone.resume_at(state)
            event = None if earlier is None else _event_of(earlier, zone.name, state)
            if earlier is not None and event is not None:
                zone.hold(event)
                zone.last_run = state.last_run
                self._connections.reopen(now, zone, state, earlier.passwords)
            elif is_there:
                self._connections.reopen(now, zone, state)
            else:
                self._lost(now, state, EVENT_GONE(zone=zone.name))
        except Exception as error:
            # One zone's invalid state must stop neither the other zones nor every new start.
            self._outbox.drop_since(place)
            zone.run = None
            self._lost(now, state, INVALID(error=f"{type(error).__name__}: {error}"))

    def _lost(self, now: Now, state: ZoneState, why: str) -> None:
        """Report a run that cannot continue. Its scores are in the journal."""
        if not state.has_run:
            return
        event = state.event
        text = LOST(benchmark=event.benchmark, team=event.team, why=why)
        self._watches.trouble(now, text)


def _event_of(config: Config, zone: str, state: ZoneState) -> Optional[ScheduledEvent]:
    """Return the event of a zone's run in an earlier configuration; None: there is no run, or no such event."""
    if not state.has_run:
        return None
    events = (event for plan in config.zones if plan.name == zone for event in plan.events)
    return next((event for event in events if is_same(state.event, event)), None)


# The journal records at most this many changes of a reload.
MAX_RECORDED = 500

CONNECTED = say("zone '{zone}' is no longer in the schedule, but a run of {code} is connected in it: disconnect it "
                "first")


NO_SIGNER = say("to score signed sheets by other rules needs the name of who decided it: enter it, in the terminal "
                "with --by")


class Reload:
    """Puts another configuration into force."""

    def __init__(
        self, timers: Timers, zones: Zones, robots: ActiveRobots, finished: FinishedRuns, connections: Connections,
        copies: Copies, authority: Authority, outbox: Outbox, time_zone: str
    ) -> None:
        self._timers = timers
        self._authority = authority
        self._zones = zones
        self._robots = robots
        self._finished = finished
        self._connections = connections
        self._copies = copies
        self._outbox = outbox
        self._use_zone(time_zone)

    def _use_zone(self, name: str) -> None:
        self.time_zone = name
        times.use_zone(name)

    def off(self, config: Config) -> List[str]:
        """Return why a configuration cannot be taken now; empty: it can."""
        if self._authority.closed:
            return [self._authority.closed]
        names = {zone.name for zone in config.zones}
        why = self._copies.why_not(config)
        return ([why] if why else []) + [
            CONNECTED(zone=zone.name, code=zone.event.benchmark.code)
            for zone in self._zones.values() if zone.run is not None and zone.name not in names
        ]

    def ran(self) -> List[EventKey]:
        """Return the events of all runs, also of those in the zones, as they were when the runs were connected."""
        return [key_of_record(record) for record in self._finished.records()] + [
            key_of(run.event) for run in self._zones.runs()]

    def rescoring(self, config: Config) -> Callable[[], List[Rescored]]:
        """Return what finds the runs that are over and whose sheets a configuration would score in another way. It is
        for another thread than the loop's: see `rescored`."""
        records = self._over()
        return lambda: rescored(records, config.benchmarks)

    def take(
        self, now: Now, config: Config, version: int, changes: Sequence[str], who: str = "",
        found: Optional[Sequence[Rescored]] = None, edit: Optional[Mapping[str, Any]] = None,
    ) -> None:
        """Put a configuration into force. `changes` lists what it changes; `found`: the runs that are over are scored
        by its sheets, too, as these are; None: they keep theirs. `edit`: what an organiser did to the schedule of the
        day, for the journal. Raises `Refused`."""
        self._timers.tick(now)
        reasons = self.off(config)
        if reasons:
            raise Refused(reasons)
        recorded = list(changes[:MAX_RECORDED])
        if len(changes) > MAX_RECORDED:
            recorded.append(f"… and {len(changes) - MAX_RECORDED} more")
        runs = [] if found is None else self._as_now(found, config)
        if any(run.before.sign_off is not None for run in runs) and sheets.person(who) in ("", sheets.NO_NAME):
            raise Refused([NO_SIGNER])
        value = {"version": version, "changes": recorded, **({} if edit is None else {"edit": dict(edit)})}
        self._outbox.emit(effects.Recorded("", "", None, "reload", value, checked_who(who)))
        self._robots.use_teams(config.passwords)
        self._finished.use(config.benchmarks, config.ranking)
        for run in runs:
            record = run.signed(SignOff(now.utc, checked_who(who)), "scored by another sheet")
            self._finished.add(record)
            self._outbox.emit(effects.RecordChanged(record))
        self._copies.use(config)
        self._use_zone(config.time_zone)
        self._connections.version = version
        self._zones.reschedule(config.zones, self._finished.records())
        self._outbox.emit(effects.ModuleRunsChanged())  # a module may be needed from now on
        for zone in self._zones.values():
            self._outbox.mark_changed(zone.name)
            if zone.run is not None and zone.event not in zone.planned:
                self._outbox.notice(Level.INFO, "The configuration was changed. This run keeps what it began with",
                                    zone.name)
        if edit is None:
            self._outbox.notice(Level.INFO, f"The configuration was changed ({len(changes)} changes)")

    def _as_now(self, found: Sequence[Rescored], config: Config) -> List[Rescored]:
        """Return the runs scored by the sheets of a configuration: those that changed since they were found, again."""
        known = {run.before.identity: run for run in found}
        new = [record for record in self._over()
               if record.identity not in known or known[record.identity].before is not record]
        gone = {record.identity for record in new}
        return [*(run for run in found if run.before.identity not in gone), *rescored(new, config.benchmarks)]

    def _over(self) -> List[RunRecord]:
        """Return the records of the runs that are over and can be corrected, the oldest first."""
        return [run.record for run in reversed(self._finished.newest_runs())]
