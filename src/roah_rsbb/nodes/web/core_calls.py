"""The calls to the core that paired devices ask for. They are made in threads, because rospy's calls block."""

import asyncio
import json
import threading
from typing import Any, Callable, Dict, NamedTuple, Tuple

import genpy
import rospy

from roah_rsbb.core.copies import is_unconfirmed
from roah_rsbb.model.actions import EVERY
from roah_rsbb.model.fields import given_text
from roah_rsbb.ros import refusals
from roah_rsbb.ros.connections import REFEREE_HEADER
from roah_rsbb.ros.known_services import KnownService
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.srv import (
    Act,
    GetJudging,
    GetRunSheet,
    StopRun,
)
from roah_rsbb.web.commands import STOP, Command, Outcome

# A later answer is ignored. The page of a device waits a little longer.
TIMEOUT_S = 5.0
# Maximum number of waiting calls (True: of STOP; False: of all others), so that a core that hangs does not fill this
# process with threads.
MAX_WAITING = {True: 8, False: 24}
TOO_MANY = "too many commands are waiting for an answer: check that the core is running"


class _Call(NamedTuple):
    """How a command becomes a call."""

    service: str
    kind: type
    request: Callable[[Command], Tuple[Any, ...]]


def _action(command: Command) -> Tuple[Any, ...]:
    fields = command.fields
    # Who marks with several devices is one person; of all else the device is a part of the name.
    referee = command.session.person if "device" in fields["given"] else ""
    return command.name, command.zone, fields["identity"], fields["event_id"], given_text(fields["given"]), referee


def _run(command: Command) -> Tuple[Any, ...]:
    return command.zone, command.fields["identity"]


CALLS: Dict[str, _Call] = {
    **{name: _Call("act", Act, _action) for name in EVERY},
    "stop": _Call("stop_run", StopRun, _run),
    "sheet": _Call("run_sheet", GetRunSheet, _run),
    "judging": _Call("judges", GetJudging, lambda c: (c.zone, c.fields["identity"], c.session.person)),
}


class CoreCalls:
    """Carries commands out."""

    def __init__(self, ros: RosLoop) -> None:
        self._ros = ros
        self._waiting = {True: 0, False: 0}  # by whether it is a STOP

    async def carry_out(self, command: Command) -> Outcome:
        """Call the core's service. Returns its answer, or after `TIMEOUT_S` seconds an outcome that is not known."""
        is_stop = command.name == STOP
        if self._waiting[is_stop] >= MAX_WAITING[is_stop]:
            return Outcome((TOO_MANY,), is_known=False)
        self._waiting[is_stop] += 1
        answered: asyncio.Future[Outcome] = self._ros.loop.create_future()

        def done(outcome: Outcome) -> None:
            self._waiting[is_stop] -= 1
            if not answered.done():
                answered.set_result(outcome)

        def work() -> None:
            outcome = _outcome(command)
            self._ros.post(lambda: done(outcome))

        threading.Thread(target=work, name=command.name, daemon=True).start()
        try:
            return await asyncio.wait_for(answered, TIMEOUT_S)
        except asyncio.TimeoutError:
            return Outcome(is_known=False)


def _outcome(command: Command) -> Outcome:
    call = CALLS[command.name]
    proxy = KnownService(f"/core/{call.service}", call.kind, headers={
        REFEREE_HEADER: command.session.who, refusals.HEADER: refusals.VALUES})
    try:
        answer = proxy(*call.request(command))
    except rospy.ServiceException as error:
        text = str(error)
        reasons = tuple(refusals.reasons(text))
        is_confirmed = not any(map(is_unconfirmed, reasons))
        return Outcome(reasons, refusals.was_answered(text), is_confirmed)
    except genpy.SerializationError as error:  # such as a number that the message cannot hold: the referee reads it
        return Outcome((str(error),))
    except Exception as error:  # the core was killed, or the master: only an answer ends the repetition of a STOP
        return Outcome((str(error) or type(error).__name__,), is_known=False)
    if call.kind is Act:
        return Outcome(result=json.loads(answer.answer) if answer.answer else None)
    return Outcome(result={name: getattr(answer, name) for name in answer.__slots__})
