"""Lets the answers to referees wait until the standby has their entries (docs/standby.md, "No entry is lost").

The core's loop never waits. It asks the node that copies the journal, continues, and ends the wait of the thread that
serves the referee: when the standby has the entry, or after `SYNC_S` seconds, and then the entry is not confirmed. It
is saved on this computer in both cases.

A question may get lost, such as when the node that copies starts again, so it is repeated with each of its reports.
"""

import asyncio
import concurrent.futures
from typing import Callable, List, Optional, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.core.copies import SYNC_S, unconfirmed, unconfirmed_by_old_box
from roah_rsbb.model.clock import Now

# The result says that the entry is not confirmed, why, and what to do; empty: it is confirmed.
Answer = concurrent.futures.Future
# For a loop that has ended. Otherwise it ends each wait itself.
LIMIT_S = 5.0
ENDED = "the box has ended"


class StandbyAnswers:
    """The answers that wait for the standby. Call everything in the loop's thread, except `wait`."""

    def __init__(self, loop: asyncio.AbstractEventLoop, box: Box, now: Callable[[], Now],
                 event: Callable[..., object], publish: Callable[[int], None], written: Callable[[], int]) -> None:
        """`event` calls a method of the box with arguments. `publish` asks the node that copies the journal to answer
        with a ticket when the standby has everything that is in the file now, and `written` returns that ticket."""
        self._loop = loop
        self._box = box
        self._now = now
        self._event = event
        self._publish = publish
        self._written = written
        self._waiting: List[Tuple[int, Answer]] = []

    def ask(self, ticket: int) -> Optional[Answer]:
        """Ask whether the standby has everything up to a ticket of the journal; None: that is not demanded."""
        if not self._box.copies.are_two:
            return None
        answer: Answer = concurrent.futures.Future()
        waiting = ticket, answer
        self._waiting.append(waiting)
        self._ask()
        if self._box.copies.is_worth_waiting(self._now()):
            self._loop.call_later(SYNC_S, self._give_up, waiting)
        else:
            self._give_up(waiting)
        return answer

    def look(self) -> None:
        """Call this with each report of the node that copies: ask again for what the standby lacks."""
        if self._box.copies.are_two and self._written() > self._box.copies.answered:
            self._ask()

    def saved(self, ticket: int) -> int:
        """The newest ticket that is everywhere it must be, of those up to `ticket`, which are on the own disk."""
        return min(ticket, self._box.copies.answered) if self._box.copies.are_two else ticket

    def on_answer(self, ticket: int) -> None:
        """The standby has everything up to this ticket."""
        self._event(self._box.copies.answer, ticket)
        done = [answer for earlier, answer in self._waiting if earlier <= ticket]
        self._waiting = [waiting for waiting in self._waiting if waiting[0] > ticket]
        for answer in done:
            answer.set_result("")

    def _ask(self) -> None:
        ticket = self._written()
        self._box.copies.ask(ticket)
        self._publish(ticket)

    def _give_up(self, waiting: Tuple[int, Answer]) -> None:
        if waiting not in self._waiting:
            return
        self._waiting.remove(waiting)
        ticket, answer = waiting
        copies = self._box.copies
        if not copies.are_two:  # a reload ended it
            answer.set_result("")
            return
        if self._box.authority.is_superseded:
            answer.set_result(unconfirmed_by_old_box(self._box.authority.superseded_by))
            return
        why = copies.why_not_confirmed(self._now())
        self._event(self._box.copies.give_up, ticket)
        answer.set_result(unconfirmed(why))


def wait(answer: Optional[Answer]) -> str:
    """Wait, in the thread that serves a referee, for the end of a question; None: there is none. Returns what to answer
    if the entry is not confirmed; empty: it is."""
    try:
        return "" if answer is None else answer.result(LIMIT_S)
    except concurrent.futures.TimeoutError:
        return unconfirmed(ENDED)
