"""What is due in the box, and when. Every event does first what is due before it, so that timeouts keep their order."""

import math
from typing import Optional, Sequence, Tuple, Union

from roah_rsbb.core.authority import Authority
from roah_rsbb.core.connections import Connections
from roah_rsbb.core.desks import ModuleDesk
from roah_rsbb.core.robots import ActiveRobots
from roah_rsbb.core.watches import Watches
from roah_rsbb.core.zones import Zones
from roah_rsbb.model.clock import Now

# If the offset between the clocks changes by this much between two calls, somebody has set UTC: NTP slews by at most
# 0.5 ms a second.
STEP_S = 0.05


class ClockWatch:
    """Detects steps of the box's own UTC clock by comparing it with the monotonic one."""

    def __init__(self) -> None:
        self._offset: Optional[float] = None

    def look(self, now: Now) -> float:
        """Return by how many seconds UTC was stepped since the last call; 0.0: it was not."""
        offset = now.utc - now.mono
        step = 0.0 if self._offset is None else offset - self._offset
        self._offset = offset
        return step if abs(step) > STEP_S else 0.0


class Timers:
    """The clocks of the box, and the deadlines of its runs and of its other parts."""

    def __init__(self, zones: Zones, robots: ActiveRobots, watches: Watches, authority: Authority) -> None:
        self._zones = zones
        self._robots = robots
        self._watches = watches
        self._authority = authority
        self.parts: Sequence[Union[ModuleDesk, Connections]] = ()
        """What has deadlines besides the runs, in the order in which it takes its turn."""
        self.ticks = 0
        """Rises with each tick."""
        self._has_begun = False
        self._clock = ClockWatch()
        self._clock_set_mono = -math.inf  # when a step of the box's clock was noticed last
        self._latest_mono = -math.inf  # of the latest event
        self._calm_until: Optional[float] = None  # see `tick_if_due`

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) at which `tick` must be called at the latest; None: nothing is due.

        After a robot's report, it may be earlier than needed. `tick` then has nothing to do.
        """
        if self._authority.is_superseded:
            return None
        due = self._next_due() if self._calm_until is None else self._calm_until
        return None if due == math.inf else due

    def tick(self, now: Now) -> None:
        """Do what is due by now."""
        if self._authority.is_superseded:
            return  # the runs continue in another box
        self._latest_mono = now.mono
        self._calm_until = None
        self.ticks += 1
        self._look_at_clock(now)
        for part in self.parts:
            part.tick(now)
        for run in self._zones.runs():
            run.tick(now)

    def tick_if_due(self, now: Now) -> None:
        """Like `tick`, for beacons, reports and views, which are too frequent to check every run each time.

        Nothing is due until `_calm_until` (monotonic, s). A report only moves the deadline of its own run, a beacon
        none. Every other event sets `_calm_until` to None; then all runs are checked again.
        """
        if self.is_calm(now.mono):
            self._latest_mono = now.mono
            self._look_at_clock(now)
        else:
            self._tick_until_calm(now)

    def is_calm(self, mono: float) -> bool:
        """Whether nothing is due at a monotonic time (s); False: it must be looked at, see `tick_if_due`."""
        return self._calm_until is not None and mono < self._calm_until

    def moved(self) -> None:
        """Note that any deadline may be another one now."""
        self._calm_until = None

    def expect(self, due: float) -> None:
        """Note that a deadline may be earlier now: at `due` (monotonic, s)."""
        if self._calm_until is not None:
            self._calm_until = min(self._calm_until, due)

    def arrive(self, now: Now, received_utc: Optional[float]) -> Tuple[Now, Now]:
        """Do what is due before a datagram. Return when it arrived, and when it takes effect: then, but not before the
        latest event, because the box's own times never go back. `received_utc`: when the system received it, by the
        same clock as `now` (s); None: unknown, so now.

        A result that arrived within the run's time counts, even if the box was busy when the time was over.
        """
        self._look_at_clock(now)
        arrival = self.arrival(now, received_utc)
        latest = self._latest_mono
        effective = arrival if arrival.mono >= latest else now.later(min(0.0, latest - now.mono))
        if self.is_calm(effective.mono):
            self._latest_mono = effective.mono
        else:
            self._tick_until_calm(effective)
        return arrival, effective

    def arrival(self, now: Now, received_utc: Optional[float]) -> Now:
        """Return when a datagram that is handled `now` arrived.

        On a busy computer the box reads a datagram late. That delay must not look like a robot's wrong clock, nor like
        its silence.
        """
        if received_utc is None:
            return now
        mono = now.mono - (now.utc - received_utc)
        # Before a step of the clock, `received_utc` was on another clock.
        return Now(mono, received_utc) if self._clock_set_mono < mono < now.mono else now

    def _tick_until_calm(self, now: Now) -> None:
        self.tick(now)
        self._calm_until = self._next_due()

    def _next_due(self) -> float:
        """Return the monotonic time (s) at which the next run or part has something to do; infinity if none has."""
        times = [each.deadline() for each in (*self.parts, *self._zones.runs())]
        return min((t for t in times if t is not None), default=math.inf)

    def _look_at_clock(self, now: Now) -> None:
        if not self._has_begun:
            self._has_begun = True
            self._watches.start(now)
        step = self._clock.look(now)
        if step:
            self._clock_set_mono = now.mono
            self._robots.restart_skews()
            for run in self._zones.members():
                run.link.restart_skew()
            self._watches.clock_stepped(now, step)
