"""Calls from other threads into a loop."""

import asyncio
import concurrent.futures
from typing import Callable, TypeVar

T = TypeVar("T")

# A referee's command takes milliseconds. A longer wait would only hide that the box is stuck.
ANSWER_TIMEOUT_S = 5.0


def call_in_loop(loop: asyncio.AbstractEventLoop, function: Callable[[], T]) -> T:
    """Run a function in the thread of a loop, from another one, and return its result or raise its exception.

    Raises concurrent.futures.TimeoutError if the loop does not answer within `ANSWER_TIMEOUT_S`.
    """
    done: concurrent.futures.Future[T] = concurrent.futures.Future()

    def run() -> None:
        if not done.set_running_or_notify_cancel():
            return
        try:
            done.set_result(function())
        except Exception as error:
            done.set_exception(error)

    loop.call_soon_threadsafe(run)
    try:
        return done.result(ANSWER_TIMEOUT_S)
    finally:
        done.cancel()
