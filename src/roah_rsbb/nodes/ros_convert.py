"""From the core's views to the messages of the ROS interface."""

import time

from roah_rsbb.core import views
from roah_rsbb.core.box import Box
from roah_rsbb.core.clock import Now, WireTime
from roah_rsbb.core.messages import DevicesState
from roah_rsbb.msg import CoreToPublic, ScheduleInfo
from roah_rsbb.msg import DevicesState as DevicesStateMsg


def devices_of(message: DevicesStateMsg) -> DevicesState:
    """A DevicesState as the core takes it."""
    bell: WireTime = (message.bell.secs, message.bell.nsecs)
    return DevicesState(
        bell, message.switch_1, message.switch_2, message.switch_3, message.dimmer, message.blinds,
        message.door_win_detect,
    )


def to_public(box: Box, now: Now) -> CoreToPublic:
    """The public display's message; times are local, the public's."""
    return CoreToPublic(
        clock=_local(now.utc),
        schedule=[
            ScheduleInfo(
                line.event.team, line.event.benchmark.desc, line.event.round, line.event.run,
                _local(line.event.scheduled), line.running,
            )
            for line in views.schedule(box)
        ],
    )


def _local(utc: float) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(utc))
