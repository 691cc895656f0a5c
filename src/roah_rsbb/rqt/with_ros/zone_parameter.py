"""The zone that a client shows: the parameter `current_zone` in the client's namespace.

All panels of a client follow it, also those in other processes. Reading and writing a parameter needs the master and
the network, so a thread does it.
"""

import queue
import threading
from typing import Optional

import rospy

NAME = "current_zone"
POLL_S = 0.5


class ZoneParameter:
    """Follows the parameter from `start` to `stop`."""

    def __init__(self) -> None:
        self._value = ""
        self._unwritten: Optional[str] = None
        self._lock = threading.Lock()
        self._wake: queue.Queue[bool] = queue.Queue()  # True: write now, False: end
        self._worker = threading.Thread(target=self._work, name=NAME, daemon=True)

    @property
    def value(self) -> str:
        """The zone's name; empty while none is chosen."""
        return self._value

    def start(self) -> None:
        """Follow the parameter, in the background."""
        self._worker.start()

    def stop(self, timeout_s: float = 2.0) -> None:
        """Stop, after writing the last choice if the master answers."""
        self._wake.put(False)
        self._worker.join(timeout_s)

    def choose(self, zone: str) -> None:
        """Set the parameter: at once for this process, soon for others."""
        with self._lock:
            self._value = self._unwritten = zone
        self._wake.put(True)

    def _work(self) -> None:
        continues = True
        while continues:
            try:
                self._exchange()
            except Exception as e:  # the master is gone: try again soon
                rospy.logdebug("parameter %s: %s", NAME, e)
            try:
                continues = self._wake.get(timeout=POLL_S)
            except queue.Empty:
                continues = True
        try:
            self._exchange()
        except Exception as e:
            rospy.logdebug("parameter %s: %s", NAME, e)

    def _exchange(self) -> None:
        """Write the last choice, or else read. A choice made meanwhile takes precedence over the value read."""
        with self._lock:
            unwritten = self._unwritten
        if unwritten is not None:
            rospy.set_param(NAME, unwritten)
            with self._lock:
                if self._unwritten == unwritten:
                    self._unwritten = None
            return
        read = rospy.get_param(NAME, None)
        with self._lock:
            if self._unwritten is not None:
                return
            if read is None and self._value:  # the master was restarted, and lost it
                self._unwritten = self._value
                self._wake.put(True)
            else:
                self._value = "" if read is None else str(read)
