"""Subscriptions that keep the newest message until a Qt timer, a loop or a terminal takes it.

rospy calls back in its own threads; a callback only stores the message. Registering with the master blocks while the
master cannot be reached, so a worker thread does that.
"""

import collections
import queue
import threading
import time
from typing import Any, Deque, Dict, NamedTuple, Optional

import rospy

# rospy drops old messages only among those that it has read at once. One read must therefore hold several whole
# messages, or a slow panel falls behind. Logs of many zones make messages of some 100 kB.
BUFFER_BYTES = 4 * 1024 * 1024


class Received(NamedTuple):
    """A message and when it arrived (monotonic seconds)."""

    mono: float
    message: Any


class Feed:
    """Subscribes to topics (name: message class) from `start` to `stop`."""

    def __init__(self, topics: Dict[str, type]) -> None:
        self._topics = topics
        self._newest: Dict[str, Deque[Received]] = {name: collections.deque(maxlen=1) for name in topics}
        self._subscribers: Dict[str, rospy.Subscriber] = {}
        self._wishes: queue.Queue[bool] = queue.Queue()  # True: subscribe (again), False: end
        self._worker = threading.Thread(target=self._work, name="feed", daemon=True)

    def start(self) -> None:
        """Subscribe in the background."""
        self._wishes.put(True)
        self._worker.start()

    def stop(self, timeout_s: float = 2.0) -> None:
        """Unsubscribe. Does not wait for a master that does not answer."""
        self._wishes.put(False)
        self._worker.join(timeout_s)

    def renew(self) -> None:
        """Subscribe again, in the background.

        This is the only way to find a core again whose computer lost its power (its connections stay half open), or
        whose master was restarted (it has no record of this subscriber).
        """
        if self._wishes.empty():
            self._wishes.put(True)

    def take(self, topic: str) -> Optional[Received]:
        """Return the newest message that arrived since the last call, or None."""
        try:
            return self._newest[topic].pop()
        except IndexError:
            return None

    def has_publisher(self, topic: str) -> bool:
        """Whether a publisher is connected. If messages only come on changes, nothing else shows this."""
        subscriber = self._subscribers.get(topic)
        # rospy keeps broken connections in its list to reconnect them. Only a connection with a socket counts.
        impl = None if subscriber is None else subscriber.impl
        return impl is not None and any(connection.socket is not None for connection in impl.connections)

    def _work(self) -> None:
        wish = True
        while wish:
            wish = self._wishes.get()
            try:
                for subscriber in self._subscribers.values():
                    subscriber.unregister()
                self._subscribers = {name: self._subscribe(name) for name in self._topics} if wish else {}
            except Exception as e:  # the master is gone; the feed's user calls `renew` when messages stop
                rospy.logdebug("subscribing to %s failed: %s", ", ".join(self._topics), e)

    def _subscribe(self, name: str) -> rospy.Subscriber:
        newest = self._newest[name]
        return rospy.Subscriber(
            name, self._topics[name], lambda message: newest.append(Received(time.monotonic(), message)), queue_size=1,
            buff_size=BUFFER_BYTES, tcp_nodelay=True)
