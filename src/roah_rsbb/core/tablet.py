"""The tablet: its last beacon, whether that is new, and the view that it must show.

TabletBeacons are not encrypted, and come over a network that loses, duplicates and reorders them. What the box forwards
matters: an original robot takes every change of `tablet_call_time` in the beacon as a call, even a change back to an
older time. A time that a ROS message cannot hold crashes such a robot.

So only one tablet counts: the host that was heard first. Another host takes over when the first becomes silent. A time
that is older than the forwarded one belongs to a delayed datagram. If the tablet keeps sending it, its clock was set
back. A time of zero means "never" and changes nothing: the tablet or its program was restarted.

Only a few changes a second are accepted. Each one is saved and sent to all robots, so a flood of tablet beacons would
otherwise fill the disk and the network.
"""

import math
from typing import Any, List, NamedTuple, Optional

from roah_rsbb.core.settings import Budget
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import NEVER, TabletState
from roah_rsbb.protocol import WireTime, wire_ns

# The tablet sends a beacon each second. Without one for this long, it is gone.
SILENT_S = 5.0
# If no zone needs the tablet, the warning that it is silent ends after this long.
REMEMBER_SILENT_S = 300.0
# A delayed datagram is late by milliseconds. If the tablet still sends a value after this long, the value is valid.
MEANT_S = 0.5
# Every change is saved and sent to all robots. People press and move less often, and a tablet repeats its values.
CHANGES_AT_ONCE = 5
CHANGES_PER_S = 4.0
# Range of a ROS time, in seconds.
LAST_SECOND = 2**32 - 1
# Farther from the map's origin than any test bed reaches, in metres.
MAX_DISTANCE_M = 10_000.0


class HeardTablet(NamedTuple):
    """The problem with a TabletBeacon: at most one field is set."""

    absurd: Optional[str] = None  # what is wrong with its values
    rival_of: Optional[str] = None  # the host of the tablet that counts instead


class _Said(NamedTuple):
    """A value, with its time by the tablet's clock."""

    time: WireTime
    value: Any


class _Newest:
    """The newest of the values that the tablet repeats, with its time."""

    def __init__(self, value: Any) -> None:
        self.said = _Said(NEVER, value)
        self._older: Optional[_Said] = None
        self._older_since = 0.0

    def take(self, now: Now, said: _Said, is_certain: bool) -> None:
        """`is_certain`: this datagram cannot be a delayed one, because nothing was heard for a while."""
        if said.time == NEVER:
            return
        if is_certain or wire_ns(said.time) >= wire_ns(self.said.time):
            self.said, self._older = said, None
        elif said != self._older:
            self._older, self._older_since = said, now.mono
        elif now.mono - self._older_since >= MEANT_S:
            self.said, self._older = said, None


class Tablet:
    """The last known state of the tablet."""

    def __init__(self) -> None:
        self.display_map = False  # the view that it must show. True: map, False: call button
        self.heard: Optional[Now] = None
        self._host = ""
        self._changes = Budget(CHANGES_AT_ONCE, CHANGES_PER_S)
        self._call = _Newest(None)
        self._position = _Newest((0.0, 0.0))

    @property
    def state(self) -> TabletState:
        """Return the tablet's part of the beacon."""
        position = self._position.said
        return TabletState(self.display_map, self._call.said.time, position.time, *position.value)

    def restore(self, state: TabletState) -> None:
        """Take the state from the beacon before a restart: robots would take any other time as a call."""
        self.display_map = state.display_map
        self._call.said = _Said(state.call_time, None)
        self._position.said = _Said(state.position_time, (state.position_x, state.position_y))

    def hear(self, now: Now, host: str, beacon: TabletState) -> HeardTablet:
        """Take a TabletBeacon from `host`. The box decides which view is shown, not the tablet."""
        absurd = _absurd(beacon)
        if absurd:
            return HeardTablet(absurd=absurd)
        is_certain = self.heard is None or self.silence(now) > SILENT_S
        if host != self._host and not is_certain:
            return HeardTablet(rival_of=self._host)
        self._host = host
        self.heard = now
        before = self._call.said, self._position.said
        self._call.take(now, _Said(beacon.call_time, None), is_certain)
        place = (beacon.position_x, beacon.position_y)
        self._position.take(now, _Said(beacon.position_time, place), is_certain)
        if before != (self._call.said, self._position.said) and not self._changes.take(now.mono, 1):
            self._call.said, self._position.said = before  # the tablet repeats it
        return HeardTablet()

    def silence(self, now: Now) -> float:
        """Return for how many seconds a tablet that was heard has been silent; 0.0 if none was heard yet."""
        return 0.0 if self.heard is None else now.mono - self.heard.mono

    def warnings(self, now: Now, is_needed: bool) -> List[str]:
        """Return the warnings for every referee. `is_needed`: a zone is at the benchmark that uses the tablet."""
        silence = self.silence(now)
        if silence <= SILENT_S or (silence > REMEMBER_SILENT_S and not is_needed):
            return []
        return [f"The tablet has been silent for {silence:.0f} s: check that it is on, connected, and showing its page"]


def _absurd(beacon: TabletState) -> Optional[str]:
    """Describe the invalid value in a beacon; None: all are valid."""
    for seconds, nanoseconds in (beacon.call_time, beacon.position_time):
        if not (0 <= seconds <= LAST_SECOND and 0 <= nanoseconds < 1_000_000_000):
            return f"a time of {seconds} s {nanoseconds} ns: set its clock"
    for metres in (beacon.position_x, beacon.position_y):
        if not (math.isfinite(metres) and abs(metres) <= MAX_DISTANCE_M):
            return f"a position at {metres:g} m: correct its map"
    return None
