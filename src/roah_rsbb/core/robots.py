"""Active robots: who was heard within `robot_timeout`, from where, and with which clock skew.

Anybody can send beacons, in the clear. So nothing here grows without bound, and a second sender under a robot's
name takes nothing over while the first is still heard. A robot is confirmed once a message of it decrypted with its
team's password. Robots that are not confirmed have quotas, by address and by team, so that whoever invents robots
fills only a quota of their own.
"""

import collections
import math
from typing import Callable, Container, Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.core.clock import Now
from roah_rsbb.core.link.skew import SkewEstimate
from roah_rsbb.core.messages import NEVER
from roah_rsbb.protocol import WireTime, wire_seconds

# A robot sends every second. One that was not heard for this long is late.
LATE_S = 3.0
# No robot has a longer name. Names are repeated to every panel ten times a second.
MAX_NAME = 100
# More robots than any competition has.
MAX_ROBOTS = 250
# Robots that are not confirmed: of one address (a computer that simulates many), of one team, and of all teams that
# are not in the competition (misspelled names).
MAX_AT_HOST = 25
MAX_OF_TEAM = 30
MAX_STRANGERS = 50
# To find the robot that gives way takes a while. So an address or a team above its quota gets no more than one new
# robot in this time.
DROP_OF_HOST_S = 0.1
DROP_OF_TEAM_S = 0.02
# So many addresses and teams are remembered to be above their quota.
MAX_PAUSES = 500


class RobotId(NamedTuple):
    """A robot: its team and its own name."""

    team: str
    robot: str

    def __str__(self) -> str:
        return f"{self.robot} of team {self.team}"


class ActiveRobot:
    """One robot that was heard."""

    def __init__(self, robot_id: RobotId, host: str, now: Now) -> None:
        self.id = robot_id
        self.host = host
        self.first_heard = now
        self.last_heard = now
        self.time: WireTime = NEVER  # that it said last
        self.skew = SkewEstimate()
        self.confirmed_host: Optional[str] = None  # the last one that knew the team's password
        self.rival: Optional[str] = None  # another host that uses the same name
        self.rival_skew = 0.0  # seconds
        self._rival_heard = 0.0

    def is_late(self, now: Now) -> bool:
        """Whether it has missed several beacons."""
        return now.mono - self.last_heard.mono > LATE_S

    def has_rival(self, now: Now) -> bool:
        """Whether another host uses the same name right now."""
        return self.rival is not None and now.mono - self._rival_heard <= LATE_S

    def hear(self, now: Now, host: str, time: WireTime, certain: bool) -> None:
        """Take a message from `host`, which is `certain` if it decrypted with the team's password.

        A beacon from another host than before is a rival's, and changes nothing while the first is heard; unless
        the first never knew the password and the other did.
        """
        if certain:
            self.confirmed_host = host
        elif host != self.host and host != self.confirmed_host and not self.is_late(now):
            self._note_rival(now, host, wire_seconds(time) - now.utc)
            return
        if host == self.rival:
            self.rival = None
        if host != self.host and not certain and not self.is_late(now):
            self._note_rival(now, self.host, self.skew.seconds or 0.0)
            self.skew.restart()  # the samples so far are of the other one's clock
        self.host = host
        self.last_heard = now
        self.time = time
        self.skew.sample(now.mono, wire_seconds(time) - now.utc)


    def _note_rival(self, now: Now, host: str, skew: float) -> None:
        self.rival, self.rival_skew, self._rival_heard = host, skew, now.mono


class _Pauses:
    """Who has to wait before the next robot, and until when."""

    def __init__(self) -> None:
        self._until: Dict[Tuple[str, str], float] = {}

    def begin(self, now: Now, who: Tuple[str, str], seconds: float) -> None:
        if len(self._until) >= MAX_PAUSES:
            self._until.clear()
        self._until[who] = now.mono + seconds

    def holds(self, now: Now, who: Tuple[str, str]) -> bool:
        return now.mono < self._until.get(who, -math.inf)


class Squatter(NamedTuple):
    """Who announces more robots than the list holds."""

    host: str
    team: str
    robots: int  # not confirmed, listed at this host


class ActiveRobots:
    """All robots that were heard within `timeout` seconds; `teams` are those of the competition."""

    def __init__(
        self, timeout: float, teams: Container[str], in_runs: Callable[[], Container[RobotId]] = frozenset
    ) -> None:
        """`in_runs`: the robots that are in runs, which never give way to others."""
        self._timeout = timeout
        self._teams = teams
        self._in_runs = in_runs
        self._robots: Dict[RobotId, ActiveRobot] = {}
        self._squatter: Optional[Squatter] = None
        self._full = _Pauses()

    def hear(
        self, now: Now, robot_id: RobotId, host: str, time: WireTime, certain: bool = False
    ) -> Optional[ActiveRobot]:
        """Take a robot's message (`certain`: it came on its private channel); None: there is no room for
        another robot, or it has no usable name."""
        robot = self._robots.get(robot_id)
        if robot is None:
            name_fits = 0 < len(robot_id.team) <= MAX_NAME and 0 < len(robot_id.robot) <= MAX_NAME
            if not name_fits or not self._make_room(now, robot_id, host, certain):
                return None
            robot = self._robots[robot_id] = ActiveRobot(robot_id, host, now)
        robot.hear(now, host, time, certain)
        return robot

    def take_squatter(self) -> Optional[Squatter]:
        """Whose robot had to give way to the one heard last; None: none had to."""
        squatter, self._squatter = self._squatter, None
        return squatter

    def _make_room(self, now: Now, robot_id: RobotId, host: str, certain: bool) -> bool:
        """Whether the list takes one more robot, for which another one may have to go."""
        stranger = robot_id.team not in self._teams
        team_name = "" if stranger else robot_id.team
        if not certain and (self._full.holds(now, ("host", host)) or self._full.holds(now, ("team", team_name))):
            return False
        self.forget(now)
        in_runs = self._in_runs()
        loose = [r for r in self._robots.values() if r.confirmed_host is None and r.id not in in_runs]
        strangers = [r for r in loose if r.id.team not in self._teams]
        team, limit = (strangers, MAX_STRANGERS) if stranger else (
            [r for r in loose if r.id.team == team_name], MAX_OF_TEAM)
        at_host = [r for r in loose if r.host == host]
        if not certain and len(at_host) >= MAX_AT_HOST:
            self._full.begin(now, ("host", host), DROP_OF_HOST_S)
            self._drop_one(at_host, loose)
        elif not certain and len(team) >= limit:
            self._full.begin(now, ("team", team_name), DROP_OF_TEAM_S)
            self._drop_one(team, loose)
        elif len(self._robots) >= MAX_ROBOTS:
            self._full.begin(now, ("team", team_name), DROP_OF_TEAM_S)
            if not loose or (stranger and not strangers):
                return False
            self._drop_one(strangers or loose, loose)
        return True

    def _drop_one(self, group: List[ActiveRobot], loose: List[ActiveRobot]) -> None:
        """Drop a robot of the group: one of the host that announces most, there the one heard longest ago."""
        at_host = collections.Counter(robot.host for robot in loose)
        dropped = max(group, key=lambda robot: (at_host[robot.host], -robot.last_heard.mono))
        self._squatter = Squatter(dropped.host, dropped.id.team, at_host[dropped.host])
        del self._robots[dropped.id]

    def forget(self, now: Now) -> None:
        """Drop the robots that were not heard for the time-out."""
        gone = [i for i, r in self._robots.items() if now.mono - r.last_heard.mono > self._timeout]
        for robot_id in gone:
            del self._robots[robot_id]

    def has_password(self, team: str) -> bool:
        """Whether a team is one of the competition's: only those have passwords."""
        return team in self._teams

    def find(self, robot_id: RobotId) -> Optional[ActiveRobot]:
        """The robot of that name, if it was heard at all."""
        return self._robots.get(robot_id)

    def restart_skews(self) -> None:
        """The box's clock was set: all samples so far mean nothing."""
        for robot in self._robots.values():
            robot.skew.restart()

    def all(self, now: Now) -> List[ActiveRobot]:
        """Active robots, by team and name."""
        self.forget(now)
        return [self._robots[robot_id] for robot_id in sorted(self._robots)]

    def of_team(self, now: Now, team: str) -> List[ActiveRobot]:
        """A team's active robots, the one to take first: those heard just now, longest known first."""
        self.forget(now)
        robots = [robot for robot in self._robots.values() if robot.id.team == team]
        return sorted(robots, key=lambda r: (r.is_late(now), r.first_heard.mono, r.id))
