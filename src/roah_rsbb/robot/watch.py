"""What a robot watches beside its run: silences, other participants, the home in the box's beacons."""

from typing import Hashable, List, NamedTuple, Optional, Set, Tuple

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.robot.effects import (
    BellRang,
    Devices,
    Effect,
    PositionSelected,
    Report,
    Tablet,
    TabletCalled,
    Trouble,
)

# A box that was not heard for so long is silent: it sends once a second on each channel.
SILENCE_S = 5.0

# Boxes send once a second: where this long nothing came, nobody could be heard.
_GAP_S = 3.0

# So many beacons in a row with an older time are no stragglers.
_MEANT = 5

# Reports made once are remembered; forged datagrams must not let that grow for ever.
_MAX_TOLD = 100


class Silence:
    """Notices, once, that nothing was heard for `limit_s` seconds."""

    def __init__(self, limit_s: float, now_mono: float) -> None:
        self._limit_s = limit_s
        self._heard_mono = now_mono
        self._told = False

    @property
    def deadline(self) -> float:
        """The moment from which `begins` is True, if nothing is heard; infinity once it was told."""
        return float("inf") if self._told else self._heard_mono + self._limit_s

    def heard(self, now_mono: float) -> bool:
        """Something was heard. True when this ends a silence that was told."""
        ended, self._told = self._told, False
        self._heard_mono = now_mono
        return ended

    def begins(self, now_mono: float) -> bool:
        """True once, when it has been silent for the limit."""
        if now_mono < self.deadline:
            return False
        self._told = True
        return True

    def lasts(self, now_mono: float) -> bool:
        """Whether nothing was heard for the limit."""
        return now_mono >= self._heard_mono + self._limit_s


class Alone:
    """For how long other boxes were heard while the robot's own was not, without a gap in which nobody was."""

    def __init__(self) -> None:
        self._since_mono = 0.0
        self._last_mono = float("-inf")

    def heard(self, now_mono: float) -> float:
        """Another box was heard; returns since how many seconds that is so."""
        if now_mono - self._last_mono > _GAP_S:
            self._since_mono = now_mono
        self._last_mono = now_mono
        return now_mono - self._since_mono

    def end(self) -> None:
        """The robot's own box was heard."""
        self._last_mono = float("-inf")


class Reports:
    """Reports of what would otherwise be told with every datagram: once for each key."""

    def __init__(self) -> None:
        self._told: Set[Tuple[Trouble, Hashable]] = set()

    def once(self, trouble: Trouble, key: Hashable, text: str) -> List[Report]:
        """The report, unless it was made before for this `trouble` and `key`."""
        if (trouble, key) in self._told or len(self._told) >= _MAX_TOLD:
            return []
        self._told.add((trouble, key))
        return [Report(trouble, text)]


class _Seen(NamedTuple):
    devices: Devices
    tablet: Tablet


class _Moments:
    """Tells a new moment (of a ring, say) from those that were told before, by its time alone.

    A time that goes back is a beacon that was overtaken: the next one brings the newer time again, which is
    no second ring. Where it stays older, the box started again, or its clock was set back.
    """

    def __init__(self) -> None:
        self._newest: Optional[Tuple[int, int]] = None
        self._older = 0  # times in a row

    def is_new(self, time: Tuple[int, int]) -> bool:
        """Whether the time in a beacon is a new moment; that in the first beacon is none."""
        before = self._newest
        self._older = self._older + 1 if before is not None and time < before else 0
        if before is None or time > before or self._older >= _MEANT:
            self._newest = time
        return before is not None and time > before


class Home:
    """The devices and the tablet as the box's beacons show them.

    The bell, the call button and a selected position are known by their times only. The first beacon
    tells when they last were, not that they are now.
    """

    def __init__(self) -> None:
        self._seen: Optional[_Seen] = None
        self._bell, self._call, self._position = _Moments(), _Moments(), _Moments()

    def see(self, beacon: pb.RoahRsbbBeacon) -> List[Effect]:
        """The news in a beacon."""
        now = _Seen(
            Devices(
                _wire_time(beacon.devices_bell),
                beacon.devices_switch_1, beacon.devices_switch_2, beacon.devices_switch_3,
                beacon.devices_dimmer, beacon.devices_blinds,
                beacon.devices_door_win_detect,
            ),
            Tablet(
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
