"""What paired devices may command. The gateway checks who may give them, and the core what is possible. No I/O."""

import asyncio
import functools
from concurrent.futures import Future
from typing import Any, Callable, Dict, NamedTuple, Protocol, Tuple

from roah_rsbb.client.client import Answer
from roah_rsbb.document.calls import DEVICES, EDIT, EDITS, SET_DEVICE
from roah_rsbb.model import fields as model_fields
from roah_rsbb.model.actions import EVERY, JUDGE, JUDGES, MARK, ORGANISER, READS, STOP, Action
from roah_rsbb.model.as_json import from_json
from roah_rsbb.model.messages import DevicesSeen
from roah_rsbb.model.results import JudgedRun, RunSheet
from roah_rsbb.web.day_page import effect_page, forms_page
from roah_rsbb.web.device_documents import devices_page, own_sheet, side_by_side, whole_sheet_page
from roah_rsbb.web.numbered import BoxShown
from roah_rsbb.web.own_pages import FromOwnPage
from roah_rsbb.web.pairing import DeviceSession
from roah_rsbb.wording import device
from roah_rsbb.wording.device import role_text
from roah_rsbb.wording.language import tr, tr_said

MAX_TEXT = 500
_MAX_WHOLE = 2**31 - 1

# What a page says of what it shows, with each action of the table: the run, and the event at which it is.
SHOWN: Dict[str, type] = {"identity": str, "event_id": str}
# When something was entered, and when it is sent, both in ms of the device's clock, which may be wrong.
MADE, NOW = "made", "now"
# What a request has besides the values of an action's fields; `language`: of the page, for the answer.
_BESIDE = {"zone", "language", "given", MADE, NOW, *SHOWN}
# Each command that is not in the table of actions, and the type of each of its fields.
FIELDS: Dict[str, Dict[str, type]] = {
    "stop": {"identity": str},
    "sheet": {"identity": str},
    "judging": {"identity": str},
}
# Those for the whole box, which only an organiser may give.
OF_BOX: Dict[str, Dict[str, type]] = {
    "reload": {"digest": str, "for_all": bool}, "exit": {"anyway": bool}, DEVICES: {}, EDITS: {},
    EDIT: {"action": str, "seen": str, "given": dict},
    SET_DEVICE: {"device": str, "value": int}}
SHEET = "sheet"
# What is asked of the judges of a run: its answer depends on the role.
JUDGING = "judging"


class BadCommand(Exception):
    """A command is malformed. The text says how."""


class Command(NamedTuple):
    """A command of a device."""

    name: str
    zone: str
    session: DeviceSession
    fields: Dict[str, Any]


class Outcome(NamedTuple):
    """How a command ended."""

    reasons: Tuple[str, ...] = ()  # why it was refused; empty: it was carried out
    is_known: bool = True  # false: there was no answer, so it may have been carried out
    is_confirmed: bool = True  # false: it was carried out, but it is not on all disks yet; `reasons` say why
    result: Any = None  # of a sheet `RunSheet`, of judges `JudgedRun`, of devices `DevicesSeen`, else JSON


def command_of(name: str, body: Dict[str, Any], session: DeviceSession) -> Command:
    """Read a command; raises `BadCommand`. Fields that are missing are empty or 0."""
    action = None if name == STOP else EVERY.get(name)
    wanted = {**FIELDS, **OF_BOX}.get(name) if action is None else SHOWN
    zone = body.get("zone", "")
    if wanted is None or not isinstance(zone, str):
        raise BadCommand("There is no such command")
    fields = {}
    for field, kind in wanted.items():
        value = body.get(field, kind())
        if type(value) is not kind:  # true is no number
            raise BadCommand(f"{field} has the wrong type")
        if kind is not dict and (
                (len(value) > MAX_TEXT) if kind is str else not -_MAX_WHOLE <= value <= _MAX_WHOLE):
            raise BadCommand(f"{field} is too long" if kind is str else f"{field} is too large")
        if kind is str and not model_fields.is_encodable(value):
            raise BadCommand(f"{field} is no text")
        fields[field] = value
    if action is not None:
        entered = body.get("given", {})
        if not isinstance(entered, dict):
            raise BadCommand("given is no object")
        given = {name: value for name, value in body.items() if name not in _BESIDE}
        given.update(entered, **_filled_in(action, session, _ago_ms(body)))
        try:
            if not action.is_open:
                model_fields.read(action.fields, given)
        except model_fields.BadValue as bad:
            raise BadCommand(bad.reason) from None
        fields["given"] = entered if action.is_open else given
    return Command(name, zone, session, fields)


def may(command: Command) -> bool:
    """Whether the role of the device allows a command, in this zone."""
    grant = command.session.grant
    if command.name in OF_BOX:
        return grant.role == ORGANISER
    if not command.zone or not grant.allows(command.zone):
        return False
    if command.name == MARK and grant.role == JUDGE:
        # A judge gives ratings under the name that was typed when the device was paired. That nothing was attempted is
        # no rating: it would count for the whole item.
        given = command.fields["given"]
        return given.get("judge") == command.session.person and not (given.get("not_attempted") or given.get("added"))
    if command.name in EVERY:
        return grant.role in EVERY[command.name].roles
    return grant.role in READS or command.name == JUDGING


def _ago_ms(body: Dict[str, Any]) -> int:
    """Return how many milliseconds ago something was entered, which may have waited for a link; 0: just now. Raises
    `BadCommand`."""
    made, now = body.get(MADE, 0), body.get(NOW, 0)
    for name, value in ((MADE, made), (NOW, now)):
        if type(value) is not int:
            raise BadCommand(f"{name} has the wrong type")
    return min(max(0, now - made), _MAX_WHOLE)


def _filled_in(action: Action, session: DeviceSession, ago_ms: int) -> Dict[str, Any]:
    """Return the values of fields that a device cannot choose: what a judge does is done under the name that was typed
    when the device was paired."""
    own = {"device": session.device_id, "role": session.grant.role, "ago_ms": ago_ms}
    if action.roles == JUDGES:
        own["judge"] = session.person
    return {field.name: own[field.name] for field in action.fields if field.name in own}


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
        result = answer.answer if kind is None or answer.reasons else from_json(kind, answer.answer)
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


class CommandHandler(FromOwnPage):
    """Takes a command of a paired device."""

    def is_allowed(self) -> bool:
        """A STOP of a paired device is never one request too many: a frightened person presses often."""
        return (self.path_args == [STOP] and self.session() is not None) or super().is_allowed()

    async def post(self, name: str) -> None:
        """Carry it out, and answer with the outcome.

        200: it was carried out. 202: so it was, but it is not on all disks yet, and why. 409: it was refused, and why.
        504: there was no answer, so it may have been.
        """
        status, answer = await carried_out(self._server, self.needed_session(), name, self.body, self.language())
        self.set_status(status)
        self.finish(answer)


async def carried_out(
    server: Any, session: DeviceSession, name: str, body: Dict[str, Any], language: str,
    is_allowed: Callable[[Command], bool] = may,
) -> Tuple[int, Dict[str, Any]]:
    """Carry out a command of a device. Returns the status and the answer, see `CommandHandler.post`."""
    speaking = functools.partial(server.store.speaking, language)
    try:
        command = command_of(name, body, session)
    except BadCommand as bad:
        with speaking():
            return 400, {"reasons": [tr_said(bad.args[0])]}
    if not is_allowed(command):
        with speaking():
            return 403, {"reasons": [tr(device.NOT_ALLOWED, role=role_text(*session.grant))]}
    outcome = await server.command(command)
    with speaking():
        reasons = [tr_said(reason) for reason in outcome.reasons]
        if not outcome.is_known:
            return 504, {"reasons": reasons or [tr(device.NO_ANSWER)]}
        if reasons:
            return 409 if outcome.is_confirmed else 202, {"reasons": reasons}
        if command.name == MARK:
            server.sessions.marked(server.utc(), session.id)
        return 200, _shown(command, outcome.result, server.desk.box)


def _shown(command: Command, result: Any, box: BoxShown) -> Dict[str, Any]:
    """Return what the device may see of the result of a command."""
    if command.name == DEVICES:
        return devices_page(result, box.now().utc)
    if command.name == EDITS and box.document is not None:
        return forms_page(box.document, result)
    if command.name == EDIT:
        return effect_page(result)
    if command.name == SHEET:
        return whole_sheet_page(result)
    if command.name == JUDGING:
        return (own_sheet if command.session.grant.role == JUDGE else side_by_side)(result)
    return result or {}
