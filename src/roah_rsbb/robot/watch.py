"""What a robot monitors besides its run: silences, other boxes, and the home in the box's beacons."""

from typing import Hashable, List, NamedTuple, Optional, Set, Tuple

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.robot.effects import (
    BellRang,
    Devices,
    Effect,
    PositionSelected,
    Problem,
    ProblemIs,
    TabletCalled,
    TabletIs,
)

# A box counts as silent after this time; it sends once a second on each channel.
SILENCE_S = 5.0
# A box that is started together with the robot loads its files and listens first. Until then, its silence is no fault.
BOX_STARTS_S = 15.0

# Boxes send once a second: a longer gap means that the network was down.
_GAP_S = 3.0

# After this many beacons in a row with an older time, the time was set back.
_SET_BACK_BEACONS = 5

# Limits the memory of reports, because datagrams can be forged.
_MAX_REPORTED = 100


class Silence:
    """Detects, once, that nothing was received for `limit_s` seconds."""

    def __init__(self, limit_s: float, now_mono: float) -> None:
        self._limit_s = limit_s
        self._heard_mono = now_mono
        self._reported = False

    @property
    def deadline(self) -> float:
        """When `begins` becomes True if nothing is received; infinity after it was reported."""
        return float("inf") if self._reported else self._heard_mono + self._limit_s

    def heard(self, now_mono: float) -> bool:
        """Note that something was received. Returns whether this ends a reported silence."""
        ended, self._reported = self._reported, False
        self._heard_mono = now_mono
        return ended

    def begins(self, now_mono: float) -> bool:
        """True once, when the limit is reached."""
        if now_mono < self.deadline:
            return False
        self._reported = True
        return True

    def lasts(self, now_mono: float) -> bool:
        """Whether nothing was received for `limit_s` seconds."""
        return now_mono >= self._heard_mono + self._limit_s


class OtherBoxes:
    """Measures how long only other boxes were received, without a gap."""

    def __init__(self) -> None:
        self._since_mono = 0.0
        self._last_mono = float("-inf")

    def heard(self, now_mono: float) -> float:
        """Note that another box was received. Returns for how many seconds only other boxes were received."""
        if now_mono - self._last_mono > _GAP_S:
            self._since_mono = now_mono
        self._last_mono = now_mono
        return now_mono - self._since_mono

    def end(self) -> None:
        """Note that the robot's box was received."""
        self._last_mono = float("-inf")


class Reports:
    """Makes each report once per key, not with every datagram."""

    def __init__(self) -> None:
        self._reported: Set[Tuple[Problem, Hashable]] = set()

    def once(self, problem: Problem, key: Hashable, text: str) -> List[ProblemIs]:
        """The report; empty if it was made before for this `problem` and `key`."""
        if (problem, key) in self._reported or len(self._reported) >= _MAX_REPORTED:
            return []
        self._reported.add((problem, key))
        return [ProblemIs(problem, text)]


class _Seen(NamedTuple):
    devices: Devices
    tablet: TabletIs


class _Moments:
    """Detects a new event (such as a ring of the bell) by its time alone.

    An older time means that a beacon arrived out of order: the next one has the newer time again, which is not a second
    ring. If it stays older, the box restarted or its clock was set back.
    """

    def __init__(self) -> None:
        self._newest: Optional[Tuple[int, int]] = None
        self._older = 0  # times in a row

    def is_new(self, time: Tuple[int, int]) -> bool:
        """Whether the time in a beacon is that of a new event. The first beacon has none."""
        before = self._newest
        self._older = self._older + 1 if before is not None and time < before else 0
        if before is None or time > before or self._older >= _SET_BACK_BEACONS:
            self._newest = time
        return before is not None and time > before


class HomeWatch:
    """The devices and the tablet as the box's beacons show them.

    Beacons contain only the times of the latest ring, call and selected position. The first beacon gives old times, not
    new events.
    """

    def __init__(self) -> None:
        self._seen: Optional[_Seen] = None
        self._bell, self._call, self._position = _Moments(), _Moments(), _Moments()

    def see(self, beacon: pb.RoahRsbbBeacon) -> List[Effect]:
        """Return the changes in a beacon."""
        now = _Seen(
            Devices(
                _wire_time(beacon.devices_bell),
                beacon.devices_switch_1, beacon.devices_switch_2, beacon.devices_switch_3,
                beacon.devices_dimmer, beacon.devices_blinds,
                beacon.devices_door_win_detect,
            ),
            TabletIs(
                beacon.tablet_display_map,
                _wire_time(beacon.tablet_call_time), _wire_time(beacon.tablet_position_time),
                beacon.tablet_position_x, beacon.tablet_position_y,
            ),
        )
        before, self._seen = self._seen, now
        news: List[Effect] = [new for old, new in zip(before or (None, None), now) if old != new]
        if self._bell.is_new(now.devices.bell):
            news.append(BellRang())
        if self._call.is_new(now.tablet.call_time):
            news.append(TabletCalled())
        if self._position.is_new(now.tablet.position_time):
            news.append(PositionSelected(now.tablet.position_x, now.tablet.position_y))
        return news


def _wire_time(time: pb.Time) -> Tuple[int, int]:
    return time.sec, time.nsec
