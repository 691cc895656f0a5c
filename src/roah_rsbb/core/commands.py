"""The referee's commands to a zone: what each does, and every reason why it is refused now.

The reasons that disable a panel's button also refuse the command itself, because the state may have changed since the
panel was drawn.
"""

import contextlib
from typing import Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.core import effects
from roah_rsbb.core.clock import Now
from roah_rsbb.core.connections import Connections
from roah_rsbb.core.effects import Outbox
from roah_rsbb.core.referee import MAX_NOTE, Refused, RunName, checked_who, cut_note
from roah_rsbb.core.robots import ActiveRobot, ActiveRobots
from roah_rsbb.core.runs.run import ZoneRun
from roah_rsbb.core.scoring.book import FinishedRuns
from roah_rsbb.core.scoring.records import By, EndReason, Phase, RunRecord
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.watches import Watches
from roah_rsbb.core.zones import NO_RUN, EventKey, Zone, Zones
from roah_rsbb.rulebook.benchmarks import Restarts
from roah_rsbb.rulebook.registry import BenchmarkKind
from roah_rsbb.wording.suggestions import did_you_mean

DISCONNECT_FIRST = "A run is connected: disconnect it first"
NOT_RUNNING = "No run is running"

# Commands that the original box does not have.
OWN_COMMANDS = ("pause", "resume", "next_phase", "previous_phase", "open_sheet", "no_show", "withdrawn")
# Those of them that hit a team without its robot. A caller names the team, so that no other one is hit.
OF_TEAM = ("open_sheet", "no_show", "withdrawn")
# Those that also record a result at once.
FINAL = ("no_show", "withdrawn")
# All commands, in the order in which panels have them.
COMMANDS = ("connect", "disconnect", "start", "stop", "previous", "next", *OWN_COMMANDS)


class CommandRecord:
    """Records every command of a referee, including refused ones."""

    def __init__(self, zones: Zones, outbox: Outbox, kind: str = "command") -> None:
        """`kind`: of the journal's entries."""
        self._zones = zones
        self._outbox = outbox
        self._kind = kind
        self._closed: List[str] = []  # see `close`; shared by all kinds

    def of_kind(self, kind: str) -> "CommandRecord":
        """Return a record for another kind of entries, which is closed when this one is."""
        made = CommandRecord(self._zones, self._outbox, kind)
        made._closed = self._closed
        return made

    @property
    def closed(self) -> str:
        """Why every command is refused; empty: it is not."""
        return self._closed[0] if self._closed else ""

    def close(self, reason: str) -> None:
        """Refuse every command from now on, for this reason."""
        self._closed[:] = [reason]

    @contextlib.contextmanager
    def of(self, name: RunName, who: str, command: str, **arguments: object) -> Iterator[None]:
        """Record a command before its effects, or with the reasons why it is refused."""
        value: Dict[str, object] = {"command": command, **{k: _short(v) for k, v in arguments.items() if v != ""}}
        zone = self._zones.get(name.zone)
        run = None if zone is None else zone.run
        place = self._outbox.place()
        try:
            if self.closed:
                raise Refused([self.closed])
            yield
        except Refused as refused:
            value["refused"] = [_short(reason) for reason in refused.reasons]
            raise
        finally:
            if run is None and zone is not None:
                run = zone.run  # connected just now
            identity = name.identity or ("" if run is None else run.identity)
            port = _only_port(run, identity)
            self._outbox.insert(place, effects.Recorded(
                _short(name.zone), _short(identity), port, self._kind, value, checked_who(who)
            ))


def _short(value: object) -> object:
    """Shorten a text that is recorded: a wrong name must not fill the disk."""
    return value[:MAX_NOTE] if isinstance(value, str) else value


def _only_port(run: Optional[ZoneRun], identity: str) -> Optional[int]:
    if run is None or run.identity != identity or len(run.members()) != 1:
        return None
    return run.members()[0].port


class Candidates(NamedTuple):
    """All active robots that are not in the zone's run, by team and name."""

    fit: Tuple[ActiveRobot, ...]
    unfit: Tuple[str, ...]  # for each robot that cannot take part: its name and why


class OfTeam(NamedTuple):
    """Whom a command hits."""

    team: str = ""  # empty: whatever team is current
    event: str = ""  # id of the current event; empty: any of this team


class Commands:
    """Decides which commands are allowed, and carries them out."""

    def __init__(
        self,
        settings: Settings,
        zones: Zones,
        robots: ActiveRobots,
        watches: Watches,
        connections: Connections,
        finished: FinishedRuns,
        record: CommandRecord,
        outbox: Outbox,
    ) -> None:
        self._settings = settings
        self._zones = zones
        self._robots = robots
        self._watches = watches
        self._connections = connections
        self._finished = finished
        self._record = record
        self._outbox = outbox
        self._reasons_off: Dict[str, Callable[[Now, Zone], List[str]]] = {
            "connect": self._connect_off, "disconnect": self._disconnect_off, "start": self._start_off,
            "stop": self._stop_off, "previous": self._previous_off, "next": self._next_off,
            "pause": self._pause_off, "resume": self._resume_off,
            "next_phase": lambda now, zone: self._phase_off(zone, 1),
            "previous_phase": lambda now, zone: self._phase_off(zone, -1),
            "open_sheet": self._open_sheet_off, "no_show": self._no_show_off, "withdrawn": self._withdrawn_off,
        }
        self._execute: Dict[str, Callable[[Now, Zone, By], None]] = {
            "connect": lambda now, zone, by: connections.connect(now, zone, self.robots_to_connect(now, zone)),
            "disconnect": connections.leave,
            "start": lambda now, zone, by: zone.run.start(now),
            "stop": lambda now, zone, by: zone.run.stop(now, by),
            "previous": lambda now, zone, by: zone.move(-1),
            "next": lambda now, zone, by: zone.move(1),
            "pause": lambda now, zone, by: zone.run.pause(now, True),
            "resume": lambda now, zone, by: zone.run.pause(now, False),
            "next_phase": lambda now, zone, by: zone.run.go_to_phase(now, zone.run.times.state.phase + 1),
            "previous_phase": lambda now, zone, by: zone.run.go_to_phase(now, zone.run.times.state.phase - 1),
            "open_sheet": lambda now, zone, by: connections.open_sheet(now, zone),
            "no_show": lambda now, zone, by: self._give_up(now, zone, EndReason.NO_SHOW, by),
            "withdrawn": lambda now, zone, by: self._give_up(now, zone, EndReason.WITHDRAWN, by),
        }

    def give(
        self, now: Now, zone_name: str, command: str, who: str = "", reason: str = "", of: Optional[OfTeam] = None,
    ) -> None:
        """Carry out one of `COMMANDS`; raises `Refused`. `reason`: why the referee stops the run. `of`: whom it hits,
        for those of `OF_TEAM`."""
        of = of or OfTeam()
        with self._record.of(RunName(zone_name), who, command, reason=reason, team=of.team):
            zone = self._zones.named(zone_name)
            reasons = self._not_of(zone, command, of) or self.reasons_off(now, zone, command)
            if reasons and command == "stop" and zone.run is not None:
                return  # nothing to stop: scripts for the original box rely on no error here
            if reasons:
                raise Refused(reasons)
            by = By(checked_who(who), cut_note(reason))  # an overlong reason must not prevent a stop
            self._outbox.mark_changed(zone.name)
            self._execute[command](now, zone, by)

    @staticmethod
    def _not_of(zone: Zone, command: str, of: OfTeam) -> List[str]:
        """Return why a command does not hit the team that its caller means; empty: it does."""
        event = zone.event
        if command in FINAL and not of.team:
            return ["Name the team: the zone may have gone to the event of another one"]
        if of.team and of.team != event.team:
            return [f"The current event of zone '{zone.name}' is of team {event.team}, not of team "
                    f"{cut_note(of.team)}: choose the event first"]
        if of.event and of.event != event.id:
            return [f"Zone '{zone.name}' is at another event of team {event.team} now: choose the event first"]
        return []

    def connect_robot(self, now: Now, zone_name: str, robot: str, who: str = "") -> None:
        """Connect this robot of the event's team; raises `Refused`."""
        with self._record.of(RunName(zone_name), who, "connect", robot=robot):
            zone = self._zones.named(zone_name)
            if zone.event.benchmark.kind is BenchmarkKind.ALL_ROBOTS:
                raise Refused([f"{zone.event.benchmark.code} is for all robots at once: connect without a robot"])
            reasons = self._connect_off(now, zone, robot)
            if reasons:
                raise Refused(reasons)
            self._outbox.mark_changed(zone.name)
            self._connections.connect(now, zone, self.robots_to_connect(now, zone, robot))

    def _give_up(self, now: Now, zone: Zone, reason: EndReason, by: By) -> None:
        """End the zone's event without a score, and leave it."""
        run = zone.run or self._connections.open_sheet(now, zone)
        run.give_up(now, reason, by)
        self._connections.leave(now, zone, by)

    def leave_run(self, now: Now, name: RunName, who: str = "") -> None:
        """Disconnect the named run. Raises `Refused` if it is running or no longer connected."""
        with self._record.of(name, who, "disconnect"):
            zone = self._zones.named(name.zone)
            if zone.run is None or zone.run.identity != name.identity:
                raise Refused([f"run {name.identity} is not connected in zone '{name.zone}'"])
            if zone.run.phase is Phase.RUNNING:
                raise Refused([f"run {name.identity} is running: stop it first"])
            self._outbox.mark_changed(zone.name)
            self._connections.leave(now, zone, By(checked_who(who)))

    def choose_event(self, now: Now, zone_name: str, key: EventKey, unsigned: bool, who: str = "") -> None:
        """Make this event of the schedule the zone's current one; raises `Refused`.

        A run that has ended is disconnected. `unsigned`: the referee confirmed to leave a run whose score sheet is not
        signed off. It can still be signed off later.
        """
        name = RunName(zone_name)
        with self._record.of(name, who, "choose_event", event=f"{key.benchmark} {key.team} {key.round} {key.run}"):
            zone = self._zones.named(zone_name)
            index = zone.find(key)
            if index is not None and key.id and zone.events[index].team != key.team:
                raise Refused([f"The event is of team {zone.events[index].team} now: choose it again"])
            if index is None:
                raise Refused([f"zone '{zone_name}' has no event {key.benchmark}, team {key.team}, round {key.round}, "
                               f"run {key.run} at this time"])
            if index == zone.index and zone.run is None:
                return
            reasons = self._choose_off(now, zone, unsigned)
            if reasons:
                raise Refused(reasons)
            self._outbox.mark_changed(zone.name)
            if zone.run is not None:
                self._connections.leave(now, zone, By(checked_who(who)))
                index = zone.find(key)  # the event of the run may have been removed with it
            if index is not None:
                zone.move(index - zone.index)

    def _choose_off(self, now: Now, zone: Zone, unsigned: bool) -> List[str]:
        if zone.run is not None and zone.run.phase is Phase.CONNECTED:
            return [DISCONNECT_FIRST]
        if zone.run is not None and zone.run.phase is Phase.RUNNING:
            return ["A run is running: stop it first"]
        if unsigned or not self._is_unsigned(zone):
            return []
        event = zone.event
        moving = [] if zone.run is None else zone.run.ignores_stop(now)
        return moving + [f"The run of {event.benchmark.code}, team {event.team}, round {event.round}, run {event.run} "
                         "is not signed off: confirm to leave it"]

    def _is_unsigned(self, zone: Zone) -> bool:
        """Whether the run that a zone shows, or showed last, is over and not signed off."""
        if zone.run is not None:
            return True
        last = next(self._runs_of(zone), None)
        return last is not None and last.sign_off is None

    def reasons_off(self, now: Now, zone: Zone, command: str) -> List[str]:
        """Return every reason why a command to a zone would be refused now; empty: it is allowed."""
        return [self._record.closed] if self._record.closed else self._reasons_off[command](now, zone)

    # -- connect ------------------------------------------------------------------------------------

    def robots_to_connect(self, now: Now, zone: Zone, name: str = "") -> Sequence[ActiveRobot]:
        """Return the robots that *connect* would take: all that can take part, or one robot of the team that is in no
        run. Of several, it is the one of that name; without a name, one that was heard recently, and of these the one
        known longest."""
        if zone.event.benchmark.kind is BenchmarkKind.ALL_ROBOTS:
            return self._candidates(now, zone).fit
        return [robot for robot in self._idle(now, zone) if name in ("", robot.id.robot)][:1]

    def robots_to_choose(self, now: Now, zone: Zone) -> Tuple[str, ...]:
        """Return the names of the team's robots if the referee must choose one of several, in the order of preference;
        else none."""
        if zone.run is not None or zone.event.benchmark.kind is BenchmarkKind.ALL_ROBOTS:
            return ()
        names = tuple(robot.id.robot for robot in self._idle(now, zone))
        return names if len(names) > 1 else ()

    def _idle(self, now: Now, zone: Zone) -> List[ActiveRobot]:
        """Return the robots of the event's team that are in no run, in the order of preference."""
        of_team = self._robots.of_team(now, zone.event.team)
        return [robot for robot in of_team if self._zones.run_of(robot.id) is None]

    def outsiders(self, now: Now, zone: Zone) -> List[str]:
        """Warn of robots that are not in the run of all robots, as long as that can be changed.

        A robot that cannot take part does not exclude the others (docs/benchmarks.md, "The table"). The referee sees
        who is left out and why, and can disconnect and connect again to include a late robot.
        """
        if zone.event.benchmark.kind is not BenchmarkKind.ALL_ROBOTS:
            return []
        if zone.run is not None and zone.run.phase is not Phase.CONNECTED:
            return []
        candidates = self._candidates(now, zone)
        if zone.run is None:
            return list(candidates.unfit)
        again = "is active, but not in this run: disconnect and connect again to include it"
        return [f"{robot.id} {again}" for robot in candidates.fit] + list(candidates.unfit)

    def _connect_off(self, now: Now, zone: Zone, name: str = "") -> List[str]:
        if zone.run is not None:
            return ["Already connected"]
        reasons = self._attempts_off(zone)
        listening = self._watches.listening_left(now)
        if listening > 0:
            reasons.append(f"The box is still listening for another box, for {listening:.0f} s")
        robots = self.robots_to_connect(now, zone, name)
        if zone.event.benchmark.kind is BenchmarkKind.ALL_ROBOTS:
            reasons += self._nobody_off(now, zone)
        else:
            reasons += self._robot_off(now, zone, robots, name)
        return reasons + self._connections.off([robot.id for robot in robots])

    def attempt(self, zone: Zone) -> int:
        """Return the number of the attempt that the zone's run is, or that the next one will be."""
        return sum(bool(record.started_utc) for record in self._runs_of(zone)) + 1

    def _runs_of(self, zone: Zone) -> Iterator[RunRecord]:
        """Return the runs of the team at the zone's event that are over, the newest first."""
        return filter(zone.is_of, self._finished.records())

    def _attempts_off(self, zone: Zone) -> List[str]:
        most = zone.event.benchmark.rules.attempts
        if not most or self.attempt(zone) <= most:
            return []
        made = "The only attempt" if most == 1 else f"The last of {most} attempts"
        return [f"{made} at this event was made: go to the next event. To allow more, raise 'attempts' in "
                "benchmarks.yaml"]

    def _robot_off(self, now: Now, zone: Zone, robots: Sequence[ActiveRobot], name: str) -> List[str]:
        team = zone.event.team
        if not robots and name:
            names = [robot.id.robot for robot in self._idle(now, zone)]
            return [f"No robot '{cut_note(name)}' of team {team} is ready to connect{did_you_mean(name, names)}"]
        if not robots:
            busy = [(r, self._zones.run_of(r.id)) for r in self._robots.of_team(now, team)]
            if not busy:
                return [f"No robot of team {team} is active: none of its beacons arrives on UDP port "
                        f"{self._settings.rsbb_port}"]
            return [f"Robot {r.id} is in a run in zone {run.zone}" for r, run in busy if run is not None]
        return robots[0].skew_off(f"robot {robots[0].id}")

    def _nobody_off(self, now: Now, zone: Zone) -> List[str]:
        """Return why a run of all robots would have no robots; empty: it would have some."""
        candidates = self._candidates(now, zone)
        if candidates.fit:
            return []
        return list(candidates.unfit) or [
            f"No robot is active: no beacon arrives on UDP port {self._settings.rsbb_port}"
        ]

    def _candidates(self, now: Now, zone: Zone) -> Candidates:
        """Return the robots that could be connected to a zone's run of all robots now, and why others cannot."""
        inside = () if zone.run is None else tuple(member.robot for member in zone.run.members())
        fit: List[ActiveRobot] = []
        unfit: List[str] = []
        for robot in self._robots.all(now):
            if robot.id in inside:
                continue
            reasons = self._unfit_for(now, robot)
            if reasons:
                unfit.append(f"{robot.id} cannot take part: {'; '.join(reasons)}")
            else:
                fit.append(robot)
        return Candidates(tuple(fit), tuple(unfit))

    def _unfit_for(self, now: Now, robot: ActiveRobot) -> List[str]:
        run = self._zones.run_of(robot.id)
        if run is not None:
            return [f"it is in a run in zone {run.zone}"]
        reasons: List[str] = []
        if not self._robots.has_password(robot.id.team):
            reasons.append("its team has no password in the passwords file")
        if robot.is_late(now):
            reasons.append(f"it was not heard for {now.mono - robot.last_heard.mono:.0f} s")
        return reasons + robot.skew_off("the robot")

    # -- start, stop, disconnect --------------------------------------------------------------------

    def _start_off(self, now: Now, zone: Zone) -> List[str]:
        run = zone.run
        if run is None:
            return [NO_RUN]
        if run.phase is Phase.RUNNING:
            return ["Already started"]
        reasons: List[str] = []
        if run.phase is Phase.ENDED and run.times.rules.restarts is Restarts.NOT_ALLOWED:
            return ["The rules of this benchmark do not allow a restart: disconnect, and connect for a new run"]
        if run.end_reason is EndReason.TIMEOUT:
            reasons.append("The run ended by timeout: disconnect, and connect for a new run")
        elif run.clock.is_over(now):
            reasons.append(
                "The run's time is up (the clock kept running after the stop): disconnect, and connect for a new run"
            )
        return reasons + run.start_off(now)

    def _stop_off(self, now: Now, zone: Zone) -> List[str]:
        if zone.run is None:
            return ["No run is connected, so there is nothing to stop"]
        if zone.run.phase is Phase.CONNECTED:
            return ["The run is not started: disconnect to leave it"]
        if zone.run.phase is Phase.RUNNING:
            return []
        if zone.run.ignores_stop(now):
            return ["The run is over, but the robot did not answer STOP: stop it by hand"]
        return ["The run is over: disconnect to leave it"]

    def _disconnect_off(self, _now: Now, zone: Zone) -> List[str]:
        return [] if zone.run is not None else ["No run is connected"]

    # -- pause, phases ------------------------------------------------------------------------------

    def _pause_off(self, _now: Now, zone: Zone) -> List[str]:
        if not zone.event.benchmark.rules.pause:
            return ["The rules of this benchmark do not allow a pause"]
        if zone.run is None or zone.run.phase is not Phase.RUNNING:
            return [NOT_RUNNING]
        return ["The clock is paused"] if zone.run.times.state.paused else []

    def _resume_off(self, _now: Now, zone: Zone) -> List[str]:
        return [] if zone.run is not None and zone.run.times.state.paused else ["The clock is not paused"]

    def _phase_off(self, zone: Zone, by: int) -> List[str]:
        """Return why the run cannot move by `by` phases; empty: it can."""
        phases = zone.event.benchmark.rules.phases
        if not phases:
            return ["This benchmark has no phases"]
        if zone.run is None or zone.run.phase is not Phase.RUNNING:
            return [NOT_RUNNING]
        if 1 <= zone.run.times.state.phase + by <= len(phases):
            return []
        return ["This is the last phase"] if by > 0 else ["This is the first phase"]

    # -- without a robot ----------------------------------------------------------------------------

    def _open_sheet_off(self, _now: Now, zone: Zone) -> List[str]:
        if zone.run is not None:
            return [DISCONNECT_FIRST]
        return self._attempts_off(zone) + self._connections.off([])

    def _no_show_off(self, _now: Now, zone: Zone) -> List[str]:
        if zone.run is not None and zone.run.phase is not Phase.CONNECTED:
            return ["The run was started, so its team appeared"]
        return list(self._connections.off([])) if zone.run is None else []

    def _withdrawn_off(self, _now: Now, zone: Zone) -> List[str]:
        if zone.run is not None and zone.run.phase is Phase.RUNNING:
            return ["A run is running: stop it first"]
        return list(self._connections.off([])) if zone.run is None else []

    # -- previous, next -----------------------------------------------------------------------------

    def _previous_off(self, _now: Now, zone: Zone) -> List[str]:
        off = [DISCONNECT_FIRST] if zone.run is not None else []
        return off + (["This is the zone's first event"] if zone.at_first else [])

    def _next_off(self, _now: Now, zone: Zone) -> List[str]:
        off = [DISCONNECT_FIRST] if zone.run is not None else []
        return off + (["This is the zone's last event"] if zone.at_last else [])
