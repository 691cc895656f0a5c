"""What all panels of a process share: one subscription, one zone, one queue of calls."""

from typing import Optional

from roah_rsbb.ros.feed import Feed
from roah_rsbb.rqt.model.calls import Calls
from roah_rsbb.rqt.model.model import TOPICS, Model
from roah_rsbb.rqt.model.referee_name import RefereeName
from roah_rsbb.rqt.model.zone_parameter import ZoneParameter
from roah_rsbb.rqt.widgets.presses import DoublePress


class Client:
    """A referee's client. rospy.init_node must have been called."""

    _shared: Optional["Client"] = None
    _users = 0

    def __init__(self) -> None:
        self.model = Model(Feed(TOPICS), ZoneParameter())
        self.calls = Calls()
        self.presses = DoublePress()
        self.referee = RefereeName()

    @classmethod
    def acquire(cls) -> "Client":
        """The client of this process; the first call makes it. To each call belongs one of `release`."""
        if cls._shared is None:
            cls._shared = Client()
            cls._shared.model.start()
        cls._users += 1
        return cls._shared

    @classmethod
    def release(cls) -> None:
        """A panel ends; with the last one the client ends."""
        cls._users -= 1
        if cls._users == 0 and cls._shared is not None:
            cls._shared.model.stop()
            cls._shared = None
