"""Checks whether more runs are possible: free private ports, and space in the beacon to list the robots."""

from typing import Callable, List, NamedTuple, Sequence

from roah_rsbb.core.robots import RobotId
from roah_rsbb.model.messages import Beacon, BenchmarkingRobot, DevicesState, TabletState
from roah_rsbb.model.reason import joined, say
from roah_rsbb.protocol import WireTime

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
