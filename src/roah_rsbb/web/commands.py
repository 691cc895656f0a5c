"""What paired devices may command. The gateway checks who may give them, and the core what is possible. No I/O."""

from typing import Any, Dict, NamedTuple, Tuple

from roah_rsbb.document.calls import DEVICES, SET_DEVICE
from roah_rsbb.model import fields as model_fields
from roah_rsbb.model.actions import EVERY, JUDGES, MARK, STOP, Action
from roah_rsbb.web.pairing import JUDGE, ORGANISER, DeviceSession

MAX_TEXT = 500
_MAX_WHOLE = 2**31 - 1

# What a page says of what it shows, with each action of the table: the run, and the event at which it is.
SHOWN: Dict[str, type] = {"identity": str, "event_id": str}
# What a request has besides the values of an action's fields; `language`: of the page, for the answer.
_BESIDE = {"zone", "language", "given", *SHOWN}
# Each command that is not in the table of actions, and the type of each of its fields.
FIELDS: Dict[str, Dict[str, type]] = {
    "stop": {"identity": str},
    "sheet": {"identity": str},
    "judging": {"identity": str},
}
# Those for the whole box, which only an organiser may give.
OF_BOX: Dict[str, Dict[str, type]] = {
    "reload": {"digest": str}, "exit": {"anyway": bool}, DEVICES: {}, SET_DEVICE: {"device": str, "value": int}}
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
        if (len(value) > MAX_TEXT) if kind is str else not -_MAX_WHOLE <= value <= _MAX_WHOLE:
            raise BadCommand(f"{field} is too long" if kind is str else f"{field} is too large")
        if kind is str and not model_fields.is_encodable(value):
            raise BadCommand(f"{field} is no text")
        fields[field] = value
    if action is not None:
        entered = body.get("given", {})
        if not isinstance(entered, dict):
            raise BadCommand("given is no object")
        given = {name: value for name, value in body.items() if name not in _BESIDE}
        given.update(entered, **_of_session(action, session))
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
    if command.name != STOP and command.name in EVERY:
        return grant.role in EVERY[command.name].roles
    return grant.role != JUDGE or command.name == JUDGING


def _of_session(action: Action, session: DeviceSession) -> Dict[str, str]:
    """Return the values of fields that a device cannot choose: what a judge does is done under the name that was typed
    when the device was paired."""
    own = {"device": session.device_id, "role": session.grant.role}
    if action.roles == JUDGES:
        own["judge"] = session.person
    return {field.name: own[field.name] for field in action.fields if field.name in own}
