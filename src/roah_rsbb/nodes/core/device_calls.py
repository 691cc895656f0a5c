"""Home devices of another node: their state as a plain value, and robots' commands as service calls.

A service call may take long, or hang with its node. So each device has its own thread, off the core's loop. During a
call only the latest command waits; commands that it replaces are never carried out.
"""

import threading
from typing import Callable, Dict, Optional

import rospy

from roah_rsbb.core.effects import SetDevice
from roah_rsbb.core.runs.reported import FIELDS
from roah_rsbb.model.messages import DevicesState
from roah_rsbb.msg import DevicesState as DevicesStateMsg
from roah_rsbb.protocol import SWITCHES, WireTime
from roah_rsbb.ros import refusals
from roah_rsbb.srv import Bool, Percentage

# The devices node answers within milliseconds. After this time the referee is warned.
ANSWER_TIMEOUT_S = 3.0

Refused = Callable[[SetDevice, str], None]


class DeviceCalls:
    """Carries out the effect `SetDevice`. `refused(wish, reason)` is called in another thread."""

    def __init__(self, refused: Refused) -> None:
        self._callers: Dict[str, _Caller] = {
            device: _Caller(device, refused) for device in FIELDS if device != "display_map"
        }

    def set(self, wish: SetDevice) -> None:
        """Carry out a command soon; returns immediately."""
        rospy.loginfo("zone %s: the robot sets %s to %d", wish.zone, wish.device, wish.value)
        self._callers[wish.device].set(wish)


class _Caller:
    """Calls the service of one device, in its own thread."""

    def __init__(self, device: str, refused: Refused) -> None:
        self._name = f"/devices/{device}/set"
        self._kind = Bool if device in SWITCHES else Percentage
        self._refused = refused
        self._news = threading.Condition()
        self._next: Optional[SetDevice] = None
        threading.Thread(target=self._run, name=self._name, daemon=True).start()

    def set(self, wish: SetDevice) -> None:
        with self._news:
            self._next = wish
            self._news.notify()

    def _run(self) -> None:
        while True:
            with self._news:
                while self._next is None:
                    self._news.wait()
                wish, self._next = self._next, None
            self._call(wish)

    def _call(self, wish: SetDevice) -> None:
        late = f"{self._name} has not answered within {ANSWER_TIMEOUT_S:.0f} s: check the devices node"
        watch = threading.Timer(ANSWER_TIMEOUT_S, self._refused, (wish, late))
        watch.daemon = True
        watch.start()
        try:
            value = bool(wish.value) if self._kind is Bool else wish.value
            rospy.ServiceProxy(self._name, self._kind)(value)
        except Exception as error:  # a broken connection must not end this thread
            if rospy.is_shutdown():
                return
            text = str(error)
            answered = refusals.was_answered(text)
            self._refused(wish, refusals.reason(text) if answered else f"no devices node answers ({text})")
        finally:
            watch.cancel()


def devices_of(message: DevicesStateMsg) -> DevicesState:
    """Convert the devices' state to the core's value."""
    bell: WireTime = (message.bell.secs, message.bell.nsecs)
    return DevicesState(
        bell, message.switch_1, message.switch_2, message.switch_3, message.dimmer, message.blinds,
        message.door_win_detect,
    )
