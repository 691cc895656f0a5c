"""Calls that clients of the door offer, such as those that pair devices, which the web gateway answers.

An offer names some calls. If another client offers one of them, it waits until that client has gone. The door passes a
call on to the client that offers it, and the answer back. Meanwhile the loop does other things. Few calls wait at
the same time, and each is answered within `ASKED_S`.
"""

import asyncio
from typing import Any, Callable, Dict, Mapping, NamedTuple, Optional, Protocol, Sequence

from roah_rsbb.document.calls import DEVICES, SET_DEVICE, WEB_CALLS, Answered, Caller
from roah_rsbb.model.reason import encoded, say
from roah_rsbb.wording.device import NO_WEB
from roah_rsbb.wording.whole_box import NO_DEVICES

MAX_OFFERS, MAX_CALLS, MAX_NAME = 16, 16, 40  # clients that offer; calls of each; characters of a name
MAX_ASKED = 64  # calls that wait for their answer
# Seconds that an answer may take. Whoever asks waits a little longer, and so gets to know why there is none.
ASKED_S = 4.0

# What to do if nobody offers a call that programs of this version offer.
REMEDIES: Dict[str, str] = {**dict.fromkeys(WEB_CALLS, NO_WEB), **dict.fromkeys((DEVICES, SET_DEVICE), NO_DEVICES)}
NOBODY = say("No program offers {what} now: start the one that does")
NO_ANSWER = say("no answer: {why} ({error})")
ENDED = say("its connection ended. It may have been done")
LATE = say("{what}: no answer within {time} s: {why}")
BUSY = say("{what}: not sent, because too many calls wait for an answer. Try again in a moment")
STRANGE = say("{what}: malformed answer from the program that offers it. Install the same version there as on the box")


class Offering(Protocol):
    """A client of the door, which may offer calls."""

    caller: Caller


class _Offer(NamedTuple):
    calls: Sequence[str]
    by: str


class _Asked(NamedTuple):
    """A call that was passed on."""

    name: str
    to: Offering
    answer: Callable[[Answered], None]
    late: asyncio.TimerHandle


class Offers:
    """Who offers which call, and the calls that wait for their answer. Call everything in the loop's thread."""

    def __init__(self, loop: asyncio.AbstractEventLoop, is_own: Callable[[str], bool],
                 send: Callable[[Any, Dict[str, Any]], None]) -> None:
        """`is_own`: whether the box has a call of that name; `send` sends a client a message."""
        self._loop, self._is_own, self._send = loop, is_own, send
        self._offers: Dict[Offering, _Offer] = {}  # oldest first
        self._in_force: Dict[str, Offering] = {}
        self._asked: Dict[int, _Asked] = {}
        self._last = 0

    def knows(self, name: str) -> bool:
        """Whether a call can be offered: others are those of another version."""
        return name in REMEDIES or name in self._in_force

    def offer(self, client: Offering, calls: Any, node: Any) -> None:
        """Take the offer of a client instead of its last one. It is sent whether that is in force, and why not."""
        self._withdraw(client)
        offer = _Offer(calls, f"{node} at {client.caller.address}" if _is_name(node) else client.caller.address)
        if not isinstance(calls, list) or len(calls) > MAX_CALLS or not all(map(_is_name, calls)):
            self._refuse(client, f"an offer has at most {MAX_CALLS} names of calls, of at most {MAX_NAME} characters")
        elif any(map(self._is_own, calls)):
            own = next(filter(self._is_own, calls))
            self._refuse(client, f"{own} is a call of the box itself, which no other program can offer")
        elif calls and len(self._offers) >= MAX_OFFERS:
            self._refuse(client, f"{MAX_OFFERS} programs offer calls to this box already: end one of them")
        elif calls:
            self._offers[client] = offer
            if not self._put_in_force(client):
                taken = next(name for name in calls if name in self._in_force)
                self._refuse(client, f"{self._offers[self._in_force[taken]].by} offers {taken} already")
        self._settle()

    def _refuse(self, client: Offering, reason: str) -> None:
        self._send(client, {"offer": [], "refused": [reason]})

    def _put_in_force(self, client: Offering) -> bool:
        calls = self._offers[client].calls
        if any(name in self._in_force for name in calls):
            return False
        self._in_force.update((name, client) for name in calls)
        self._send(client, {"offer": calls})
        return True

    def _settle(self) -> None:
        """Put offers in force that waited for one that has gone."""
        for client in [one for one in self._offers if one not in self._in_force.values()]:
            if client in self._offers:  # a client that takes no messages may be ended while others are sent theirs
                self._put_in_force(client)

    def _withdraw(self, client: Offering) -> None:
        self._offers.pop(client, None)
        self._in_force = {name: one for name, one in self._in_force.items() if one is not client}

    def gone(self, client: Offering) -> None:
        """Withdraw what a client offered, and answer the calls that it leaves."""
        if client not in self._offers:
            return
        self._withdraw(client)
        for number in [number for number, asked in self._asked.items() if asked.to is client]:
            self._end(number, lambda name: NO_ANSWER(why=_remedy(name), error=ENDED))
        self._settle()

    def pass_on(self, name: str, arguments: Mapping[str, Any], caller: Caller,
                answer: Callable[[Answered], None]) -> None:
        """Pass a call on to who offers it. `answer` is called with the answer, or why there is none."""
        offering = self._in_force.get(name)
        if offering is None:
            answer(_refused(_remedy(name)))
        elif len(self._asked) >= MAX_ASKED:
            answer(_refused(BUSY(what=name)))
        else:
            self._last += 1
            self._asked[self._last] = _Asked(name, offering, answer, self._loop.call_later(
                ASKED_S, self._end, self._last, lambda name: LATE(what=name, time=f"{ASKED_S:g}", why=_remedy(name))))
            self._send(offering, {"asked": self._last, "call": name, "face": caller.face, "address": caller.address,
                                  "arguments": arguments})

    def answered(self, client: Offering, number: Any, found: Mapping[str, Any]) -> None:
        """Pass an answer back, unless it is not that of a call that the client was asked and has not answered yet."""
        asked = self._asked.get(number) if type(number) is int else None
        if asked is not None and asked.to is client:
            is_right = isinstance(found.get("refused", []), list) and isinstance(found.get("error", ""), str)
            given = {name: found[name] for name in ("answer", "refused", "known", "error") if name in found}
            self._end(number, lambda name: STRANGE(what=name), given if is_right and given else None)

    def _end(self, number: int, why: Callable[[str], str], answer: Optional[Answered] = None) -> None:
        asked = self._asked.pop(number)
        asked.late.cancel()
        asked.answer(answer or _refused(why(asked.name)))


def _is_name(found: Any) -> bool:
    return isinstance(found, str) and 0 < len(found) <= MAX_NAME


def _remedy(name: str) -> str:
    return REMEDIES[name] if name in REMEDIES else NOBODY(what=name)


def _refused(reason: str) -> Answered:
    return {"refused": encoded([reason])}
