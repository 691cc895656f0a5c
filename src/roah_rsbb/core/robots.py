"""Active robots: which ones were heard within `robot_timeout`, their addresses and clock skews.

Anybody can send beacons, because they are not encrypted. Therefore nothing here grows without limit, and a second
sender under a robot's name takes nothing over while the first is still heard. A robot is confirmed once one of its
messages was decrypted with its team's password. Robots that are not confirmed have quotas by address and by team, so
invented robots only use up the quota of their sender.

A sender's address can be forged, too. Therefore beacons only suggest. While a robot is heard with the password, its
beacons only say that it is there; and a clock keeps a robot from *connect* only if no beacon under its name shows a
better one.
"""

import collections
import math
from typing import Callable, Container, Dict, List, Mapping, NamedTuple, Optional, Tuple

from roah_rsbb.core.link.skew import WINDOW_S, SkewEstimate, skew_off, within
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import NEVER
from roah_rsbb.model.reason import say
from roah_rsbb.protocol import WireTime, wire_seconds

# A robot sends every second. After this many seconds without a message, it is late.
LATE_S = 3.0
# If the times in beacons from a robot's address go back by this much (s) twice within `LATE_S`, they show two clocks.
BACK_S = 1.0
# This many other addresses under a robot's name are remembered.
MAX_RIVALS = 8
# No robot has a longer name. Panels receive all names ten times a second.
MAX_NAME = 100
# More robots than any competition has.
MAX_ROBOTS = 250
# Quotas of robots that are not confirmed: per address (a computer may simulate many), per team, and for all teams that
# are not in the competition (misspelled names).
MAX_AT_HOST = 25
MAX_OF_TEAM = 30
MAX_STRANGERS = 50
# Finding the robot to drop takes time. An address or team above its quota therefore gets at most one new robot in this
# many seconds.
DROP_OF_HOST_S = 0.1
DROP_OF_TEAM_S = 0.02
# Maximum number of addresses and teams that are remembered as above their quota.
MAX_PAUSES = 500

OF_TEAM = say("{robot} of team {team}")
NO_ROUTE = say("The box cannot reach {robot} at {host}: it has no route to this network. Give the robot an address in "
               "the box's network")


class RobotId(NamedTuple):
    """A robot: its team and its own name."""

    team: str
    robot: str

    def __str__(self) -> str:
        return OF_TEAM(robot=self.robot, team=self.team)


class Rival(NamedTuple):
    """Another address that uses a robot's name."""

    since: float  # monotonic time (s) when it was heard first
    mono: float  # when it was heard last
    skew: float  # seconds


class ActiveRobot:
    """One robot that was heard."""

    def __init__(self, robot_id: RobotId, host: str, now: Now, allowed_skew: float) -> None:
        """`allowed_skew`: with which a run can start (s)."""
        self.id = robot_id
        self._allowed_skew = allowed_skew
        self.host = host
        self.first_heard = now
        self.last_heard = now
        # Monotonic time (s), of a beacon that may be its own: once an address used the password, from there. A robot in
        # a run sends none.
        self.last_beacon: Optional[float] = None
        self.has_moved = False  # the message before its last one came from another address
        self.time: WireTime = NEVER  # the robot's own, from its last message
        self.skew = SkewEstimate()
        self.confirmed_host: Optional[str] = None  # the last host that used the team's password
        self._rivals: Dict[str, Rival] = {}  # by address
        self._confirmed_mono = -math.inf  # when it used the password last
        self._beacon_mono = -math.inf  # of the last beacon of any address, and of the last one with a good clock
        self._good_clock_mono = -math.inf
        self._reached_mono = -math.inf  # when it was heard from an address that the box can reach
        self._back: List[float] = []  # when times of its beacons went back

    def is_late(self, now: Now) -> bool:
        """Whether it has missed several beacons."""
        return now.mono - self.last_heard.mono > LATE_S

    def rivals(self, now: Now) -> Dict[str, Rival]:
        """Return the other addresses that use the same name right now."""
        return {host: rival for host, rival in self._rivals.items() if now.mono - rival.mono <= LATE_S}

    def is_here(self, rivals: Mapping[str, Rival]) -> bool:
        """Whether it was heard at its own address since one of its rivals was. Otherwise, it may have moved."""
        return any(rival.since <= self.last_heard.mono for rival in rivals.values())

    def has_two_clocks(self, now: Now) -> bool:
        """Whether beacons from its own address show two clocks: somebody forges that address."""
        return len(self._back) > 1 and now.mono - self._back[-2] <= LATE_S

    def skew_off(self, whose: str) -> List[str]:
        """Return why its clock prevents *connect*; empty: it does not. `whose` names it.

        Any address may forge a beacon with a wrong clock, and none can take the good one of the robot's away. Before a
        start, the clock in its encrypted messages counts.
        """
        is_good = self._good_clock_mono >= self._beacon_mono - WINDOW_S
        return [] if is_good else skew_off(whose, self.skew.seconds, self._allowed_skew)

    def off(self, whose: str) -> List[str]:
        """Return every reason against *connect*, as `skew_off` does. Here, too, a forged address takes no other away.
        """
        is_reached = self._reached_mono >= self.last_heard.mono - LATE_S
        return ([] if is_reached else [NO_ROUTE(robot=whose, host=self.host)]) + self.skew_off(whose)

    def restart_skew(self) -> None:
        """Drop all samples of its clock, because the box's clock was set."""
        self.skew.restart()
        self._good_clock_mono = -math.inf

    def hear(self, now: Now, host: str, time: WireTime, certain: bool, has_route: bool = True) -> None:
        """Take a message from `host` that arrived `now`. It is `certain` if it was decrypted with the team's password.
        `has_route`: whether the box can reach the host.

        A beacon from another host than before is a rival's, and changes nothing while the first host is heard. The
        exception: the first host never used the password, and the other did.
        """
        if has_route:
            self._reached_mono = now.mono
        skew = wire_seconds(time) - now.utc
        if not certain and now.mono - self._confirmed_mono <= LATE_S:
            if host == self.host:  # it is there; but its clock is that of its messages
                self.last_beacon, self.last_heard, self.has_moved = now.mono, now, False
            else:
                self._note_rival(now, host, skew)
            return
        self._beacon_mono = now.mono
        if within(skew, self._allowed_skew):
            self._good_clock_mono = now.mono
        if certain:
            self.confirmed_host = host
            self._confirmed_mono = now.mono
        elif host != self.host and host != self.confirmed_host and not self.is_late(now):
            self._note_rival(now, host, skew)
            return
        self._rivals.pop(host, None)
        if host != self.host and not certain and not self.is_late(now):
            self._note_rival(now, self.host, self.skew.seconds or 0.0)
            self.skew.restart()  # the samples so far are of the other host's clock
        elif host == self.host and not certain and wire_seconds(self.time) - wire_seconds(time) > BACK_S:
            self._back = [*self._back[-1:], now.mono]
        if not certain and self.confirmed_host in (None, host):
            self.last_beacon = now.mono
        self.has_moved = host != self.host
        self.host = host
        self.last_heard = now
        self.time = time
        self.skew.sample(now.mono, skew)

    def _note_rival(self, now: Now, host: str, skew: float) -> None:
        self._rivals = self.rivals(now)
        if host in self._rivals or len(self._rivals) < MAX_RIVALS:
            known = self._rivals.get(host)
            self._rivals[host] = Rival(now.mono if known is None else known.since, now.mono, skew)


class _Pauses:
    """The addresses and teams that must wait before they get another robot, each with the end of its wait."""

    def __init__(self) -> None:
        self._until: Dict[Tuple[str, str], float] = {}

    def begin(self, now: Now, who: Tuple[str, str], seconds: float) -> None:
        if len(self._until) >= MAX_PAUSES:
            self._until.clear()
        self._until[who] = now.mono + seconds

    def holds(self, now: Now, who: Tuple[str, str]) -> bool:
        return now.mono < self._until.get(who, -math.inf)


class Squatter(NamedTuple):
    """A host that announces more robots than the list accepts."""

    host: str
    team: str
    robots: int  # not confirmed, in the list, from this host


class ActiveRobots:
    """All robots that were heard within `timeout` seconds; `teams` are those of the competition."""

    def __init__(
        self, timeout: float, teams: Container[str], in_runs: Callable[[], Container[RobotId]] = frozenset,
        allowed_skew: float = 0.1,
    ) -> None:
        """`in_runs`: the robots that are in runs. They are never dropped for others. `allowed_skew`: with which a run
        can start (s)."""
        self._timeout = timeout
        self._allowed_skew = allowed_skew
        self._teams = teams
        self._in_runs = in_runs
        self._robots: Dict[RobotId, ActiveRobot] = {}
        self._by_team: Dict[str, List[ActiveRobot]] = {}
        self._forgot_mono = -math.inf  # when robots that were not heard were dropped last
        self._squatter: Optional[Squatter] = None
        self._full = _Pauses()
        self.changes = 0
        """Rises with each robot that is added or removed."""

    def hear(
        self, now: Now, robot_id: RobotId, host: str, time: WireTime, certain: bool = False, has_route: bool = True,
    ) -> Optional[ActiveRobot]:
        """Take a robot's message (`certain`: it came on its private channel). Return None if the list is full, or the
        robot's name is unusable. `has_route`: see `ActiveRobot.hear`."""
        robot = self._robots.get(robot_id)
        if robot is None:
            name_fits = 0 < len(robot_id.team) <= MAX_NAME and 0 < len(robot_id.robot) <= MAX_NAME
            if not name_fits or not self._make_room(now, robot_id, host, certain):
                return None
            robot = self._robots[robot_id] = ActiveRobot(robot_id, host, now, self._allowed_skew)
            self._by_team.setdefault(robot_id.team, []).append(robot)
            self.changes += 1
        robot.hear(now, host, time, certain, has_route)
        return robot

    def take_squatter(self) -> Optional[Squatter]:
        """Return the host whose robot was dropped for the one heard last; None: none was dropped."""
        squatter, self._squatter = self._squatter, None
        return squatter

    def _make_room(self, now: Now, robot_id: RobotId, host: str, certain: bool) -> bool:
        """Whether the list takes one more robot. Another one may be dropped for it."""
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
        """Drop the robot of the group that was heard longest ago, of the host that announces most."""
        at_host = collections.Counter(robot.host for robot in loose)
        dropped = max(group, key=lambda robot: (at_host[robot.host], -robot.last_heard.mono))
        self._squatter = Squatter(dropped.host, dropped.id.team, at_host[dropped.host])
        self._remove(dropped.id)

    def forget(self, now: Now) -> None:
        """Drop the robots that were not heard within the timeout."""
        if now.mono == self._forgot_mono:
            return
        self._forgot_mono = now.mono
        gone = [i for i, r in self._robots.items() if now.mono - r.last_heard.mono > self._timeout]
        for robot_id in gone:
            self._remove(robot_id)

    def _remove(self, robot_id: RobotId) -> None:
        self.changes += 1
        self._by_team[robot_id.team].remove(self._robots.pop(robot_id))
        if not self._by_team[robot_id.team]:
            del self._by_team[robot_id.team]

    def use_teams(self, teams: Container[str]) -> None:
        """Take other teams. The robots that were heard stay."""
        self._teams = teams

    def has_password(self, team: str) -> bool:
        """Whether a team takes part in the competition: only those teams have passwords."""
        return team in self._teams

    def find(self, robot_id: RobotId) -> Optional[ActiveRobot]:
        """Return the robot of that name, or None if it was not heard."""
        return self._robots.get(robot_id)

    def last_beacon(self, robot_id: RobotId) -> Optional[float]:
        """Return when the last beacon of a robot arrived, in monotonic seconds; None: not lately."""
        robot = self._robots.get(robot_id)
        return None if robot is None else robot.last_beacon

    def restart_skews(self) -> None:
        """Drop all skew samples, because the box's clock was set."""
        for robot in self._robots.values():
            robot.restart_skew()

    def all(self, now: Now) -> List[ActiveRobot]:
        """Return the active robots, by team and name."""
        self.forget(now)
        return [self._robots[robot_id] for robot_id in sorted(self._robots)]

    def of_team(self, now: Now, team: str) -> List[ActiveRobot]:
        """Return a team's active robots in the order of preference: heard recently, then known by the password, then
        known longest."""
        self.forget(now)
        return sorted(self._by_team.get(team, ()),
                      key=lambda r: (r.is_late(now), r.confirmed_host is None, r.first_heard.mono, r.id))
