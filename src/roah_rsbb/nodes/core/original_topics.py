"""The original's topics that the core publishes for panels and for the public display."""

from typing import Any, Callable, List, Optional

import rospy

from roah_rsbb.core.box import Box
from roah_rsbb.core.views import document
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document
from roah_rsbb.msg import CoreToGui, CoreToPublic, ScheduleInfo
from roah_rsbb.nodes.core.latched import LatchedTopic
from roah_rsbb.nodes.core.to_gui import ToGui
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.wording.times import formatted

# Instead of the time. The original's public display shows it.
NOT_LIVE = "not live"


class ToPublic:
    """Makes the message for the original's public display, with local times."""

    def __init__(self, box: Box, prefix: str = "") -> None:
        """`prefix`: of the clock; marks a replay."""
        self._box, self._prefix = box, prefix
        self._revision: Optional[int] = None  # of the box, to which the lines belong
        self._lines: List[ScheduleInfo] = []

    def message(self, now: Now) -> CoreToPublic:
        """Return the message of this moment. A box that is superseded has no schedule."""
        if self._box.is_superseded:
            return CoreToPublic(clock=NOT_LIVE)
        if self._revision != self._box.revision:
            self._revision = self._box.revision
            self._lines = [
                ScheduleInfo(
                    line.event.team, line.event.benchmark.desc, line.event.round, line.event.run,
                    _local(line.event.scheduled), line.running,
                )
                for line in document.coming_events(self._box)
            ]
        return CoreToPublic(clock=f"{self._prefix}{_local(now.utc)}", schedule=self._lines)


def _local(utc: float) -> str:
    return formatted(utc, "%Y-%m-%d %H:%M:%S", in_utc=False)


class OriginalTopics:
    """The topics for panels and the public display; they are made only while somebody subscribes. All methods but the
    constructor are called in the loop's thread."""

    def __init__(
        self, ros: RosLoop, box: Box, now: Callable[[], Now], look: Callable[[], Document], prefix: str = "",
    ) -> None:
        """`now` returns the box's clocks; `look` sends clients of the door what has changed, and returns the document;
        `prefix`: see `ToPublic`."""
        self._now, self._look = now, look
        self._to_gui, self._to_public = ToGui(box), ToPublic(box, prefix)
        self._gui = LatchedTopic("/core/to_gui", CoreToGui, lambda: ros.post(self.publish_to_gui))
        self._public = LatchedTopic("/core/to_public", CoreToPublic, lambda: ros.post(self.publish_to_public))

    @property
    def are_wanted(self) -> bool:
        """Whether anybody subscribes to one of them."""
        return self._gui.is_wanted or self._public.is_wanted

    def publish_to_gui(self) -> None:
        """Look at the box, for clients of the door too, and publish for panels; they expect it ten times a second."""
        document = self._look()
        if self._gui.is_wanted:
            publish(self._gui, self._to_gui.message(self._now(), document))

    def publish_to_public(self) -> None:
        """Publish for the public display, twice a second."""
        if self._public.is_wanted:
            publish(self._public, self._to_public.message(self._now()))


def publish(topic: Any, message: object) -> None:
    """Publish a message; logs why that is not possible."""
    try:
        topic.publish(message)
    except rospy.ROSException as error:
        if not rospy.core.is_shutdown_requested():
            rospy.logerr_throttle(1.0, f"{topic.name} could not be published: {error}")
