"""From the message of the home devices to the core's plain value."""

from roah_rsbb.core.messages import DevicesState
from roah_rsbb.msg import DevicesState as DevicesStateMsg
from roah_rsbb.protocol import WireTime


def devices_of(message: DevicesStateMsg) -> DevicesState:
    """A DevicesState as the core takes it."""
    bell: WireTime = (message.bell.secs, message.bell.nsecs)
    return DevicesState(
        bell, message.switch_1, message.switch_2, message.switch_3, message.dimmer, message.blinds,
        message.door_win_detect,
    )
