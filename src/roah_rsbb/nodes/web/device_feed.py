"""The topics for paired devices. Their messages come ten times a second, so the node subscribes to them only while such
a device is connected or a team's page asks."""

from typing import Callable, Optional

from roah_rsbb.msg import CoreDetails, CoreToGui, Judgings, Results, RunClocks, Schedule
from roah_rsbb.ros.feed import Feed
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.web.desk import Desk

GUI, DETAILS, CLOCKS, RESULTS, SCHEDULE, JUDGING = (
    "/core/to_gui", "/core/details", "/core/clocks", "/core/results", "/core/schedule", "/core/judging")
TOPICS = {GUI: CoreToGui, DETAILS: CoreDetails, CLOCKS: RunClocks, RESULTS: Results, SCHEDULE: Schedule,
          JUDGING: Judgings}


class DeviceFeed:
    """Feeds the desk. All methods are called in the loop's thread."""

    def __init__(self, ros: RosLoop, desk: Desk, publish: Callable[[], None]) -> None:
        self._ros = ros
        self._desk = desk
        self._publish = publish
        self._feed: Optional[Feed] = None

    def want(self, is_wanted: bool) -> None:
        """Start or end the subscriptions."""
        if is_wanted and self._feed is None:
            self._feed = Feed(TOPICS, lambda: self._ros.post(self._take))
            self._feed.start()
        elif not is_wanted and self._feed is not None:
            self._feed.stop(0.0)
            self._feed = None
            self._desk.forget()

    def renew(self) -> None:
        """Subscribe again: the core is silent."""
        if self._feed is not None:
            self._feed.renew()

    def _take(self) -> None:
        """Take the newest messages. The zones come last, because their message is what publishes the documents."""
        if self._feed is None:
            return
        desk, feed = self._desk, self._feed
        results, judging, clocks, schedule, details, gui = map(
            feed.take, (RESULTS, JUDGING, CLOCKS, SCHEDULE, DETAILS, GUI))
        if schedule is not None:
            desk.on_schedule(schedule.message)
        if results is not None:
            desk.on_results(results.message)
        if judging is not None:
            desk.on_judging(judging.message)
        if clocks is not None:
            desk.on_clocks(clocks.message)
        if details is not None:
            desk.on_details(details.message)
        if gui is not None:
            desk.on_gui(gui.mono, gui.message)
        if gui is not None or details is not None:
            self._publish()
