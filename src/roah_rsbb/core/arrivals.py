"""What arrives from the network: beacons and reports of robots, the tablet, other boxes, and what nobody can read."""

from typing import Optional

from roah_rsbb.core import effects
from roah_rsbb.core.connections import Connections
from roah_rsbb.core.effects import How, Level, Outbox
from roah_rsbb.core.link.freshness import Heard
from roah_rsbb.core.robots import ActiveRobots, RobotId
from roah_rsbb.core.runs.run import Consequence
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.tablet import Tablet
from roah_rsbb.core.timers import Timers
from roah_rsbb.core.watches import Watches
from roah_rsbb.core.zones import Zones
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import BoxMessage, RobotReport, TabletState
from roah_rsbb.protocol import WireTime


class Arrivals:
    """Takes each datagram to whom it concerns. `received_utc`: see `Timers.arrive`."""

    def __init__(
        self, settings: Settings, timers: Timers, zones: Zones, robots: ActiveRobots, heard: Heard, tablet: Tablet,
        watches: Watches, connections: Connections, outbox: Outbox,
    ) -> None:
        self._settings = settings
        self._timers = timers
        self._zones = zones
        self._robots = robots
        self._heard = heard
        self._tablet = tablet
        self._watches = watches
        self._connections = connections
        self._outbox = outbox

    def on_channel_failed(self, now: Now, port: int, error: str) -> None:
        """The channel on `port` could not be opened."""
        self._timers.moved()
        self._connections.on_failed(now, port, error)

    def on_robot_beacon(
        self, now: Now, host: str, team: str, robot: str, time: WireTime, received_utc: Optional[float] = None,
        has_route: bool = True,
    ) -> None:
        """A RobotBeacon arrived from `host`. `has_route`: whether the box can reach it."""
        arrival, now = self._timers.arrive(now, received_utc)
        robot_id = RobotId(team, robot)
        known = self._robots.find(robot_id)
        heard = self._robots.hear(arrival, robot_id, host, time, has_route=has_route)
        if heard is None:
            self._watches.not_listed(now, host)
        elif known is None:
            self._outbox.notice(Level.INFO, f"Robot {robot_id} is active at {host}")
        else:
            self._watches.rivals(now, heard)
            self._watches.two_clocks(now, heard)
            rivals, run = heard.rivals(now), self._zones.run_of(robot_id)
            if rivals and run is not None and not heard.is_here(rivals):
                self._outbox.mark_shown(run.zone)  # the robot's next report shows that there are two
        squatter = self._robots.take_squatter()
        if squatter is not None:
            self._watches.squatter(now, squatter)

    def on_robot_report(
        self, now: Now, port: int, host: str, report: RobotReport, received_utc: Optional[float] = None,
    ) -> Optional[BoxMessage]:
        """A RobotState arrived on the private channel `port` from `host`.

        Return what the box says to the robot from now on, if nothing else came of the report: there are no effects, and
        nothing is due earlier than before. Return None otherwise.
        """
        ticks = self._timers.ticks
        arrival, now = self._timers.arrive(now, received_utc)
        run = self._zones.run_at(port)
        if run is None:
            return None
        taken = run.on_report(now, host, report, arrival)
        if taken is not Consequence.NONE:
            heard = self._robots.hear(arrival, run.robot, host, report.time, certain=True)
            if heard is not None:
                self._watches.rivals(now, heard)
        is_due = self._heard.take_due()
        if is_due:
            self._outbox.mark_box_changed()
        if taken is Consequence.LINK_ONLY:
            if self._timers.ticks == ticks and self._outbox.is_empty() and not is_due:
                return run.message
            self._outbox.emit(effects.SendState(port, run.message, How.QUIET))
        due = run.deadline()
        if due is not None:
            self._timers.expect(due)
        return None

    def on_robot_copy(self, now: Now, port: int, host: str, count: int = 1) -> None:
        """Handle copies of datagrams that arrived on the private channel `port` before. `host` sent the last copy."""
        self._timers.tick_if_due(now)
        run = self._zones.run_at(port)
        if run is not None:
            run.on_copy(now, host, count)

    def on_robot_overload(self, now: Now, port: int, count: int) -> None:
        """Handle `count` datagrams on the private channel `port` that were not read because the robot sends too
        much."""
        self._timers.tick_if_due(now)
        run = self._zones.run_at(port)
        if run is not None:
            run.on_overload(now, count)

    def on_unreadable(self, now: Now, port: int, text: str) -> None:
        """Handle unreadable datagrams on the private channel `port`. `text` says from whom and why."""
        run = self._zones.run_at(port)
        if run is not None:
            run.link.on_bad_datagram(now, text)
            self._outbox.mark_shown(run.zone)

    def on_complaint(self, now: Now, text: str) -> None:
        """Handle unreadable datagrams on the public channel, or one that could not be sent. `text` says why."""
        self._watches.complaint(now, text)

    def on_foreign_box(self, now: Now, host: str) -> None:
        """Another box's beacon (or state on a private channel) arrived from `host`."""
        self._timers.tick(now)
        is_listening = self._watches.listening_left(now) > 0 and not self._settings.take_over
        if self._watches.held_by or is_listening:
            # Anybody can forge the beacon of a box, so the referee decides.
            self._outbox.emit(effects.AnotherBox(host))
            self._watches.hold(host)
        else:
            self._watches.foreign_box(now, host)

    def on_tablet(self, now: Now, host: str, beacon: TabletState) -> None:
        """A TabletBeacon arrived from `host`. The box, not the tablet, decides which view is shown."""
        self._timers.tick(now)
        before = self._tablet.state
        self._watches.tablet(now, host, self._tablet.hear(now, host, beacon))
        if self._tablet.state != before:
            self._outbox.emit(effects.SendBeacon())

