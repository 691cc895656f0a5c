"""Which robots a zone can connect now, why others cannot take part, and how often a team has tried an event."""

from typing import Iterator, List, NamedTuple, Sequence, Tuple

from roah_rsbb.core.connections import Connections
from roah_rsbb.core.link.skew import THE_ROBOT
from roah_rsbb.core.robots import ActiveRobot, ActiveRobots
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.watches import Watches
from roah_rsbb.core.zones import Zone, Zones
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import cut_note, joined, say
from roah_rsbb.model.records import Phase, RunRecord
from roah_rsbb.rulebook.registry import BenchmarkKind
from roah_rsbb.scoring.book import FinishedRuns
from roah_rsbb.wording import times
from roah_rsbb.wording.suggestions import did_you_mean

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
        """Warn of robots that are not in the run of all robots, as long as that can be changed.

        A robot that cannot take part does not exclude the others (docs/benchmarks.md, "The table"). The referee sees
        who is left out and why, and can disconnect and connect again to include a late robot.
        """
        if zone.event.benchmark.kind is not BenchmarkKind.ALL_ROBOTS:
            return []
        if zone.run is not None and zone.run.phase is not Phase.CONNECTED:
            return []
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
