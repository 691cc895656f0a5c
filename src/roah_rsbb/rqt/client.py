"""What all panels of a process share: one connection to the box, one zone, one queue of calls, the referee's name."""

from typing import Callable, Optional

from roah_rsbb.rqt.calls import Calls, RefereeName
from roah_rsbb.rqt.keys import DoublePress, FocusRing, WindowKeys
from roah_rsbb.rqt.model import Model
from roah_rsbb.rqt.node import WindowNode
from roah_rsbb.rqt.process import prepare
from roah_rsbb.rqt.qt import QMainWindow, QWidget
from roah_rsbb.rqt.stop_strip import KeepClear, StopStrip, add_strip
from roah_rsbb.rqt.stop_window import StopWindow
from roah_rsbb.rqt.stops import Stops
from roah_rsbb.wording.times import Moments


class RefereeClient:
    """A referee's client. Its node has begun."""

    _shared: Optional["RefereeClient"] = None
    _users = 0

    def __init__(self, node: WindowNode) -> None:
        self.node = node
        self.model = Model(node)
        self.referee = RefereeName()
        self.calls = Calls(self.model.afar, self.referee, lambda: node.name)
        self.presses = DoublePress()
        self.stops = Stops(self.model, self.calls)
        self.keys = WindowKeys(self.model, self.stops)
        self.stop_window = StopWindow(self.model, self.stops)
        self.keep_clear = KeepClear()
        self.focus_ring = FocusRing(_is_ours)
        self.moments = Moments(node.times_in_utc())

    def add_strip(self, window: QMainWindow) -> StopStrip:
        """Put the STOP strip into a main window, once. It ends with the client."""
        return add_strip(window, self.model, self.stops)

    @classmethod
    def acquire(cls, make_node: Callable[[], WindowNode]) -> "RefereeClient":
        """Return the client of this process; the first call creates it, with the node that `make_node` returns. Call
        `release` once for each call."""
        if cls._shared is None:
            prepare()  # in rqt, whose application is not ours
            cls._shared = RefereeClient(make_node())
            cls._shared.model.start()
        cls._users += 1
        return cls._shared

    @classmethod
    def release(cls) -> None:
        """Release the client; the last call ends it."""
        cls._users -= 1
        client = cls._shared
        if cls._users == 0 and client is not None:
            for part in (*StopStrip.shown, client.stop_window, client.keep_clear, client.keys, client.stops,
                         client.focus_ring, client.model):
                part.end()
            cls._shared = None


def _is_ours(widget: QWidget) -> bool:
    """Whether a widget is in one of our panels or dialogs: in rqt others may be beside them."""
    while widget is not None:
        if type(widget).__module__.startswith("roah_rsbb."):
            return True
        widget = widget.parentWidget()
    return False
