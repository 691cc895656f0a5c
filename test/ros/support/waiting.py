"""Waiting for events: a ROS message, a datagram or a program's line wakes all waiting tests."""

import threading
import time
from typing import Callable, TypeVar, Union

T = TypeVar("T")

# A guard against hanging, not a measure: nothing that is waited for takes long, but the machine may be busy.
LIMIT_S = 60.0
# Some events cannot be waited for (a file is complete, a process has ended): they are checked this often.
LOOK_S = 0.1

_news = threading.Condition()
_count = 0


def happened() -> None:
    """Wake all waiting tests after an event. May be called from any thread."""
    global _count
    with _news:
        _count += 1
        _news.notify_all()


def wait_until(condition: Callable[[], T], what: Union[str, Callable[[], str]], limit_s: float = LIMIT_S) -> T:
    """Wait until `condition()` is true, and return what it gave.

    AssertionError with `what` (or with what it returns then) if it is not true within `limit_s` seconds.
    """
    deadline = time.monotonic() + limit_s
    while True:
        seen = _count
        found = condition()
        if found:
            return found
        left = deadline - time.monotonic()
        if left <= 0:
            raise AssertionError(f"after {limit_s:.0f} s still not: {what if isinstance(what, str) else what()}")
        with _news:
            if _count == seen:
                _news.wait(min(left, LOOK_S))
