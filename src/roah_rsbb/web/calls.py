"""Carries out the commands of paired devices, with calls through the door of the box."""

import asyncio
import functools
from concurrent.futures import Future
from typing import Any, Dict, Protocol, Tuple

from roah_rsbb.client.client import Answer
from roah_rsbb.document.calls import DEVICES
from roah_rsbb.document.written import read
from roah_rsbb.model.messages import DevicesSeen
from roah_rsbb.model.results import JudgedRun, RunSheet
from roah_rsbb.web.commands import JUDGING, OF_BOX, SHEET, STOP, Command, Outcome
from roah_rsbb.web.numbered import BoxShown

_RESULTS: Dict[str, Any] = {SHEET: RunSheet, JUDGING: JudgedRun, DEVICES: DevicesSeen}


class BoxCommanded(BoxShown, Protocol):
    """A box that is shown and commanded: a `client.Client`, or what stands for one in the box's process."""

    def start(self) -> None:
        """Begin to connect."""

    def close(self) -> None:
        """End the connection."""

    def call(self, name: str, **arguments: Any) -> "Future[Answer]":
        """Make a call."""

    def stop(self, zone: str, run: str, **arguments: Any) -> "Future[Answer]":
        """Stop a run."""


class PageCalls:
    """Makes the calls. STOP has a connection of its own, so it waits for no other."""

    def __init__(self, client: BoxCommanded, node: str) -> None:
        """`node`: the name of this program, for the records."""
        self._client, self._node = client, node

    async def carry_out(self, command: Command) -> Outcome:
        """Carry a command out. Without an answer within some seconds, its outcome is not known; a later one is ignored.
        The page of a device waits a little longer."""
        name, arguments = call_of(command)
        call = self._client.stop if name == STOP else functools.partial(self._client.call, name)
        answer = await asyncio.wrap_future(call(**arguments, node=self._node))
        if not answer.is_answered:
            return Outcome((self._client.why,) if self._client.why else (), is_known=False)
        kind = _RESULTS.get(command.name)
        result = answer.answer if kind is None or answer.reasons else read(kind, answer.answer)
        return Outcome(answer.reasons, is_confirmed=answer.is_known, result=result)


def call_of(command: Command) -> Tuple[str, Dict[str, Any]]:
    """Return the call of a command, and its arguments (docs/door.md, "Calls")."""
    fields, session = command.fields, command.session
    if command.name in OF_BOX:
        return command.name, {**fields, "by": session.who}
    run = {"zone": command.zone, "run": fields["identity"], "by": session.who}
    if command.name == JUDGING:
        return "judges", {**run, "judge": session.person}
    if command.name in (STOP, SHEET):
        return command.name, run
    # A mark has the device in a field of its own; of all else it is a part of the name.
    by = session.person if "device" in fields["given"] else session.who
    return "act", {**run, "by": by, "action": command.name, "event": fields["event_id"], "given": fields["given"]}
