"""Carries robots' commands to the home devices out, by the services of the devices node.

A service call may take long, or hang with the node that serves it: so each device has a thread of its own,
off the core's loop. While it calls, only the latest wish waits: what was overtaken meanwhile is never done.
"""

import threading
from typing import Callable, Dict, Optional

import rospy

from roah_rsbb.core.effects import SetDevice
from roah_rsbb.core.runs.device_commands import FIELDS, SWITCHES
from roah_rsbb.ros import refusals
from roah_rsbb.srv import Bool, Percentage

# The devices node answers in milliseconds: who takes longer hangs, and the referee should know.
ANSWER_TIMEOUT_S = 3.0

Refused = Callable[[SetDevice, str], None]


class DeviceCalls:
    """The hands for the effect `SetDevice`; `refused(wish, reason)` is called in some other thread."""

    def __init__(self, refused: Refused) -> None:
        self._callers: Dict[str, _Caller] = {
            device: _Caller(device, refused) for device in FIELDS if device != "display_map"
        }

    def set(self, wish: SetDevice) -> None:
        """Carry out a wish soon; returns at once."""
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
        late = f"{self._name} has not answered within {ANSWER_TIMEOUT_S:.0f} s: look at the devices node"
        watch = threading.Timer(ANSWER_TIMEOUT_S, self._refused, (wish, late))
        watch.daemon = True
        watch.start()
        try:
            value = bool(wish.value) if self._kind is Bool else wish.value
            rospy.ServiceProxy(self._name, self._kind)(value)
        except Exception as error:  # whatever a broken connection makes of it, the next wish has its chance
            if rospy.is_shutdown():
                return
            text = str(error)
            answered = refusals.was_answered(text)
            self._refused(wish, refusals.reason(text) if answered else f"no devices node answers ({text})")
        finally:
            watch.cancel()
