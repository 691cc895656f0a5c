"""Lets the answers to referees wait until the standby has their entries (docs/standby.md, "No entry is lost").

The core's loop never waits. It asks the node that copies the journal, continues, and ends the wait of the thread that
serves the referee: when the standby has the entry, or after `SYNC_S` seconds with a warning on every panel. The entry
is saved in both cases.
"""

import asyncio
import concurrent.futures
import contextlib
from typing import Callable, Dict, Optional

from roah_rsbb.core.box import Box
from roah_rsbb.core.clock import Now
from roah_rsbb.core.copies import SYNC_S

# The result is whether the standby has the entry.
Answer = concurrent.futures.Future
# For a loop that has ended. Otherwise it ends each wait itself.
LIMIT_S = 5.0


class StandbyAnswers:
    """The questions that wait for the standby. Call everything in the loop's thread, except `wait`."""

    def __init__(self, loop: asyncio.AbstractEventLoop, box: Box, now: Callable[[], Now],
                 event: Callable[..., object], publish: Callable[[int], None]) -> None:
        """`event` calls a method of the box with arguments. `publish` sends the number of a question to the node that
        copies the journal."""
        self._loop = loop
        self._box = box
        self._now = now
        self._event = event
        self._publish = publish
        self._waiting: Dict[int, Answer] = {}

    def ask(self) -> Answer:
        """Ask whether the standby has everything that is in the journal now."""
        answer: Answer = concurrent.futures.Future()
        number = self._box.copies.ask()
        self._publish(number)
        self._waiting[number] = answer
        if self._box.copies.is_worth_waiting(self._now()):
            self._loop.call_later(SYNC_S, self._give_up, number)
        else:
            self._give_up(number)
        return answer

    def on_answer(self, number: int) -> None:
        """The standby has everything up to this question."""
        self._event(self._box.on_copy_answer, number)
        for earlier in [earlier for earlier in self._waiting if earlier <= number]:
            self._waiting.pop(earlier).set_result(True)

    def _give_up(self, number: int) -> None:
        answer = self._waiting.pop(number, None)
        if answer is not None:
            self._event(self._box.on_copy_given_up, number)
            answer.set_result(False)


def wait(answer: Optional[Answer]) -> None:
    """Wait, in the thread that serves a referee, for the end of a question; None: there is none."""
    if answer is not None:
        with contextlib.suppress(concurrent.futures.TimeoutError):
            answer.result(LIMIT_S)
