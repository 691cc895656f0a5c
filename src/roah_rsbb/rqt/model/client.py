"""What all panels of a process share: one subscription, one zone, one queue of calls, the referee's name."""

from typing import Optional

from roah_rsbb.ros.feed import Feed
from roah_rsbb.rqt.model.calls import Calls
from roah_rsbb.rqt.model.model import TOPICS, Model
from roah_rsbb.rqt.model.presses import DoublePress
from roah_rsbb.rqt.model.zone_parameter import ZoneParameter
from roah_rsbb.rqt.qt import QObject, Signal
from roah_rsbb.rqt.widgets.stop_keys import StopKeys


class RefereeName(QObject):
    """The name of the referee at this client. It is recorded with every score, note and sign-off."""

    changed = Signal(str)

    def __init__(self, parent: Optional[QObject] = None) -> None:
        super().__init__(parent)
        self.name = ""

    def set(self, name: str) -> None:
        """Set the name, in all panels."""
        if name != self.name:
            self.name = name
            self.changed.emit(name)


class Client:
    """A referee's client. Call rospy.init_node first."""

    _shared: Optional["Client"] = None
    _users = 0

    def __init__(self) -> None:
        self.model = Model(Feed(TOPICS), ZoneParameter())
        self.calls = Calls()
        self.presses = DoublePress()
        self.stop_keys = StopKeys(self.model, self.calls)
        self.referee = RefereeName()

    @classmethod
    def acquire(cls) -> "Client":
        """Returns the client of this process; the first call creates it. Call `release` once for each call."""
        if cls._shared is None:
            cls._shared = Client()
            cls._shared.model.start()
        cls._users += 1
        return cls._shared

    @classmethod
    def release(cls) -> None:
        """Release the client; the last call ends it."""
        cls._users -= 1
        if cls._users == 0 and cls._shared is not None:
            cls._shared.stop_keys.end()
            cls._shared.model.stop()
            cls._shared = None
