"""Messages that say all there is to know: of those that come faster than they are taken, the newest is enough."""

import threading
from typing import Callable, Dict, Generic, TypeVar

T = TypeVar("T")


class Newest(Generic[T]):
    """Between rospy's threads and the loop: the newest message of each sender, whatever the pace they come at."""

    def __init__(self, post: Callable[[Callable[[], None]], None], take: Callable[[T], None], most: int) -> None:
        """`post` has a function called in the loop's thread; `take` gets the messages there; of `most` senders."""
        self._post = post
        self._take = take
        self._most = most
        self._lock = threading.Lock()
        self._waiting: Dict[str, T] = {}

    def put(self, sender: str, message: T) -> None:
        """From any thread."""
        with self._lock:
            is_first = not self._waiting
            if sender in self._waiting or len(self._waiting) < self._most:
                self._waiting[sender] = message
        if is_first:
            self._post(self._hand_over)

    def _hand_over(self) -> None:
        with self._lock:
            waiting, self._waiting = self._waiting, {}
        for message in waiting.values():
            self._take(message)
