"""Active robots: who was heard within `robot_timeout`, from where, and with which clock skew.

Beacons come in the clear from anybody, so nothing here grows without bound, and a second sender
under a robot's name takes nothing over while the first is still heard.
"""

from typing import Container, Dict, List, NamedTuple, Optional

from roah_rsbb.core.clock import Now
from roah_rsbb.core.link.skew import SkewEstimate
from roah_rsbb.core.messages import NEVER
from roah_rsbb.protocol import WireTime, wire_seconds

# A robot sends every second; one that was not heard for this long is late.
LATE_S = 3.0
# Names longer than this are no robot's; both are repeated to every panel ten times a second.
MAX_NAME = 100
# More robots than any competition has.
MAX_ROBOTS = 250


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
        self.rival: Optional[str] = None  # another host that uses the same name
        self._rival_heard = 0.0

    def is_late(self, now: Now) -> bool:
        """Whether it has missed several beacons."""
        return now.mono - self.last_heard.mono > LATE_S

    def has_rival(self, now: Now) -> bool:
        """Whether another host uses the same name right now."""
        return self.rival is not None and now.mono - self._rival_heard <= LATE_S

    def hear(self, now: Now, host: str, time: WireTime, certain: bool) -> None:
        """Take a message from `host`. Unless that is `certain` (it decrypted with the team's password), one
        from another host than before is a rival's and counts for nothing while the first is heard."""
        if host != self.host and not certain and not self.is_late(now):
            self.rival, self._rival_heard = host, now.mono
            return
        if host == self.rival:
            self.rival = None
        self.host = host
        self.last_heard = now
        self.time = time
        self.skew.sample(now.mono, wire_seconds(time) - now.utc)


class ActiveRobots:
    """All robots that were heard within `timeout` seconds; `teams` are those of the competition."""

    def __init__(self, timeout: float, teams: Container[str]) -> None:
        self._timeout = timeout
        self._teams = teams
        self._robots: Dict[RobotId, ActiveRobot] = {}

    def hear(
        self, now: Now, robot_id: RobotId, host: str, time: WireTime, certain: bool = False
    ) -> Optional[ActiveRobot]:
        """Take a robot's message (`certain`: it came on its private channel); None: there is no room for
        another robot, or it has no usable name."""
        robot = self._robots.get(robot_id)
        if robot is None:
            self.forget(now)
            name_fits = 0 < len(robot_id.team) <= MAX_NAME and 0 < len(robot_id.robot) <= MAX_NAME
            if not name_fits or not self._make_room(robot_id):
                return None
            robot = self._robots[robot_id] = ActiveRobot(robot_id, host, now)
        robot.hear(now, host, time, certain)
        return robot

    def _make_room(self, robot_id: RobotId) -> bool:
        """Whether the list takes one more robot; those of unknown teams give way to those of known ones."""
        if len(self._robots) < MAX_ROBOTS:
            return True
        stranger = next((i for i in self._robots if i.team not in self._teams), None)
        if stranger is None or robot_id.team not in self._teams:
            return False
        del self._robots[stranger]
        return True

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
