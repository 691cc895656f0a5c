"""What all panels of a process share: one connection to the box, one zone, one queue of calls, the referee's name."""

from typing import Callable, Optional

from roah_rsbb.rqt import language
from roah_rsbb.rqt.model.calls import Calls, RefereeName
from roah_rsbb.rqt.model.failures import log_failures
from roah_rsbb.rqt.model.garbage import collect_here
from roah_rsbb.rqt.model.model import Model
from roah_rsbb.rqt.model.presses import DoublePress
from roah_rsbb.rqt.model.stops import Stops
from roah_rsbb.rqt.qt import QMainWindow, QWidget
from roah_rsbb.rqt.widgets.focus_ring import FocusRing
from roah_rsbb.rqt.widgets.keep_clear import KeepClear
from roah_rsbb.rqt.widgets.keys_page import KeysKey
from roah_rsbb.rqt.widgets.stop_keys import StopKeys
from roah_rsbb.rqt.widgets.stop_strip import StopStrip, add_strip
from roah_rsbb.rqt.widgets.stop_window import StopWindow
from roah_rsbb.rqt.with_ros.host import HostWithRos
from roah_rsbb.wording.times import Moments


class RefereeClient:
    """A referee's client. Its host has begun."""

    _shared: Optional["RefereeClient"] = None
    _users = 0

    def __init__(self, host: HostWithRos) -> None:
        self.host = host
        self.model = Model(host)
        self.referee = RefereeName()
        self.calls = Calls(self.model.afar, self.referee, lambda: host.node)
        self.presses = DoublePress()
        self.stops = Stops(self.model, self.calls)
        self.stop_keys = StopKeys(self.model, self.stops)
        self.stop_window = StopWindow(self.model, self.stops)
        self.keep_clear = KeepClear()
        self.keys_key = KeysKey()
        self.focus_ring = FocusRing(_is_ours)
        self.moments = Moments(host.times_in_utc())

    def add_strip(self, window: QMainWindow) -> StopStrip:
        """Put the STOP strip into a main window, once. It ends with the client."""
        return add_strip(window, self.model, self.stops)

    @classmethod
    def acquire(cls, make_host: Callable[[], HostWithRos]) -> "RefereeClient":
        """Return the client of this process; the first call creates it, in the host that `make_host` returns. Call
        `release` once for each call."""
        if cls._shared is None:
            # In rqt, whose application is not ours.
            log_failures()
            collect_here()
            language.install()
            cls._shared = RefereeClient(make_host())
            cls._shared.model.start()
        cls._users += 1
        return cls._shared

    @classmethod
    def release(cls) -> None:
        """Release the client; the last call ends it."""
        cls._users -= 1
        if cls._users == 0 and cls._shared is not None:
            for strip in list(StopStrip.shown):
                strip.end()
            cls._shared.stop_window.end()
            cls._shared.keep_clear.end()
            cls._shared.stop_keys.end()
            cls._shared.stops.end()
            cls._shared.keys_key.end()
            cls._shared.focus_ring.end()
            cls._shared.model.stop()
            cls._shared = None


def _is_ours(widget: QWidget) -> bool:
    """Whether a widget is in one of our panels or dialogs: in rqt others may be beside them."""
    while widget is not None:
        if type(widget).__module__.startswith("roah_rsbb."):
            return True
        widget = widget.parentWidget()
    return False
