"""What devices send: a code that pairs them, and then commands; and what they are shown (docs/security.md, "Paired
devices").

Reading handlers are open to all sites. These are not: a request must come from one of our own pages, must be small, and
its device must be paired.
"""

import asyncio
import functools
import json
from typing import Any, Dict, List, Optional, Set, Tuple
from urllib.parse import urlsplit

from tornado import web

from roah_rsbb.document.calls import DEVICES
from roah_rsbb.web.box_page.documents import devices_page, may_show, whole_sheet_page
from roah_rsbb.web.commands import JUDGING, SHEET, BadCommand, Command, command_of, may
from roah_rsbb.web.commands import STOP as STOP_COMMAND
from roah_rsbb.web.desk import NO_STOP, STOP
from roah_rsbb.web.events import Reader
from roah_rsbb.web.guarded import TOO_MANY_REQUESTS, Guarded
from roah_rsbb.web.numbered import Made
from roah_rsbb.web.pairing import JUDGE, ORGANISER, SESSION_VALID_S, DeviceSession, NotPaired, TooManyGuesses
from roah_rsbb.web.serving import frame
from roah_rsbb.web.viewer import Viewer
from roah_rsbb.web.zone_documents import own_sheet, side_by_side
from roah_rsbb.wording import device
from roah_rsbb.wording.device import role_text
from roah_rsbb.wording.language import tr, tr_said

# Browsers take a cookie with this prefix from encrypted pages only.
COOKIE, ENCRYPTED_COOKIE = "roah_rsbb_session", "__Host-roah_rsbb_session"
# STOPs of a connection without an answer. A page has at most two for each zone.
MOST_STOPS = 200


def is_own_origin(origin: str, protocol: str, host: str) -> bool:
    """Whether a page of this address sends the request. `protocol`, `host`: of the request."""
    try:
        page = urlsplit(origin)
    except ValueError:
        return False
    return page.scheme == protocol and page.netloc != "" and page.netloc.lower() == host.lower()


class OfDevice(Guarded):
    """A request that may come from a paired device."""

    def is_allowed(self) -> bool:
        """Paired devices have a limit of their own: a crowd behind the same address must not keep a referee out."""
        session = self.session()
        if session is None:
            return super().is_allowed()
        return self._server.device_rates.allows(self._server.now(), session.id)

    def session(self) -> Optional[DeviceSession]:
        """Return the session of the device; None: it is not paired."""
        token = self.get_cookie(self.cookie)
        session = None if not token else self._server.sessions.of(self._server.utc(), token, self.is_encrypted)
        if session is not None:
            self._server.know(getattr(self.request.connection, "stream", None), self.request.remote_ip or "")
        return session

    @property
    def is_encrypted(self) -> bool:
        """Whether the request came with TLS."""
        return self.request.protocol == "https"

    @property
    def cookie(self) -> str:
        """The name of the session's cookie."""
        return ENCRYPTED_COOKIE if self.is_encrypted else COOKIE

    def needed_session(self) -> DeviceSession:
        """Return the session of the device; refuses the request of one that is not paired."""
        session = self.session()
        if session is None:
            raise web.HTTPError(401, reason="This device is not paired")
        return session


class FromOwnPage(OfDevice):
    """Takes requests of our own pages only. Answers are JSON, and nobody keeps them."""

    def initialize(self, server: Any) -> None:
        self._server = server
        self.body: Dict[str, Any] = {}

    def prepare(self) -> None:
        """Refuse requests of other sites, and those that are not JSON objects.

        Browsers name the page in everything but GET. A page of another site cannot read the answer to a GET.
        """
        super().prepare()
        request = self.request
        if request.method not in ("GET", "HEAD") and not is_own_origin(
                request.headers.get("Origin", ""), request.protocol, request.host):
            raise web.HTTPError(403, reason="Only pages of this address may do this")
        if request.headers.get("Sec-Fetch-Site", "same-origin") not in ("same-origin", "none"):
            raise web.HTTPError(403, reason="Only pages of this address may do this")
        if request.method == "POST":
            self.body = self._read_body()

    def set_default_headers(self) -> None:
        super().set_default_headers()
        self.set_header("Cache-Control", "no-store")

    def language(self) -> str:
        """The language of the reader."""
        return self._server.store.language(str(self.body.get("language", "")) or self.get_query_argument(
            "language", self.request.headers.get("Accept-Language", "")))

    def refuse(self, status: int, *reasons: str) -> None:
        """Answer that the request has no effect, and why."""
        self.set_status(status)
        self.finish({"reasons": reasons})

    def text(self, name: str) -> str:
        """Return a text of the body; refuses the request if it is something else."""
        value = self.body.get(name, "")
        if not isinstance(value, str):
            raise web.HTTPError(400, reason="A field has the wrong type")
        return value

    def _read_body(self) -> Dict[str, Any]:
        kind = self.request.headers.get("Content-Type", "").partition(";")[0].strip().lower()
        if kind != "application/json":  # a form of another site cannot send it
            raise web.HTTPError(415, reason="JSON is expected")
        try:
            body = json.loads(self.request.body)
        except (ValueError, RecursionError):
            raise web.HTTPError(400, reason="This is not JSON") from None
        if not isinstance(body, dict):
            raise web.HTTPError(400, reason="A JSON object is expected")
        return body


class OfOrganiser(FromOwnPage):
    """A request that only an organiser may make."""

    def prepare(self) -> None:
        """Refuse other devices."""
        super().prepare()
        if self.needed_session().grant.role != ORGANISER:
            raise web.HTTPError(403, reason="Only an organiser may do this")


class PairHandler(FromOwnPage):
    """Pairs a device that has a code."""

    async def post(self) -> None:
        """Take the code, and answer with the session's cookie when the session is on the disk."""
        server = self._server
        code, before = self.text("code"), self.session()
        with server.store.speaking(self.language()):
            try:
                grant = server.codes.granted(server.now(), code, self.request.remote_ip or "")
                token = server.sessions.add(server.utc(), grant, self.text("person"), self.text("device"),
                                            self.is_encrypted, before)
            except TooManyGuesses as refused:
                self.refuse(TOO_MANY_REQUESTS, str(refused))
                return
            except NotPaired as refused:
                self.refuse(403, str(refused))
                return
        let_again = server.codes.use_up(code)
        session = server.sessions.of(server.utc(), token, self.is_encrypted)
        try:
            await server.sessions.kept.wait()
        except OSError as error:
            server.revoke(session.id)
            let_again()
            with server.store.speaking(self.language()):
                self.refuse(403, tr(device.NOT_SAVED, error=error))
            return
        if before is not None:
            server.revoke(before.id)
        self.set_cookie(self.cookie, token, path="/", max_age=int(SESSION_VALID_S), httponly=True, samesite="Strict",
                        secure=self.is_encrypted)
        self.finish(described(session))


class SessionHandler(FromOwnPage):
    """The session of the device that asks."""

    def get(self) -> None:
        """Return it, or 401 if the device is not paired."""
        self.finish(described(self.needed_session()))

    async def delete(self) -> None:
        """End the pairing of this device."""
        self._server.revoke(self.needed_session().id)
        try:
            await self._server.sessions.kept.wait()
        except OSError as error:
            self.refuse(500, str(error))
            return
        self.clear_cookie(self.cookie, path="/")
        self.set_status(204)


class CommandHandler(FromOwnPage):
    """Takes a command of a paired device."""

    def is_allowed(self) -> bool:
        """A STOP of a paired device is never one request too many: a frightened person presses often."""
        return (self.path_args == [STOP_COMMAND] and self.session() is not None) or super().is_allowed()

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
) -> Tuple[int, Dict[str, Any]]:
    """Carry out a command of a device. Returns the status and the answer, see `CommandHandler.post`."""
    speaking = functools.partial(server.store.speaking, language)
    try:
        command = command_of(name, body, session)
    except BadCommand as bad:
        with speaking():
            return 400, {"reasons": [tr_said(bad.args[0])]}
    if not may(command):
        with speaking():
            return 403, {"reasons": [tr(device.NOT_ALLOWED, role=role_text(*session.grant))]}
    outcome = await server.command(command)
    with speaking():
        reasons = [tr_said(reason) for reason in outcome.reasons]
        if not outcome.is_known:
            return 504, {"reasons": reasons or [tr(device.NO_ANSWER)]}
        if reasons:
            return 409 if outcome.is_confirmed else 202, {"reasons": reasons}
        return 200, _shown(command, outcome.result, server.desk.box.now().utc)


def _shown(command: Command, result: Any, now_s: float) -> Dict[str, Any]:
    """Return what the device may see of the result of a command."""
    if command.name == DEVICES:
        return devices_page(result, now_s)
    if command.name == SHEET:
        return whole_sheet_page(result)
    if command.name == JUDGING:
        return (own_sheet if command.session.grant.role == JUDGE else side_by_side)(result)
    return result or {}


class DeviceEventsHandler(OfDevice, Reader):
    """The connection of a paired device: it is sent all about one zone."""

    @property
    def places(self) -> Any:
        """Spectators take no places of referees."""
        return self._server.devices

    def check_origin(self, origin: str) -> bool:
        """Only our own pages may open it: a page of another site would have the cookie of its reader's browser."""
        return is_own_origin(origin, self.request.protocol, self.request.host)

    def prepare(self) -> None:
        """Refuse devices that are not paired, and zones that are not theirs."""
        super().prepare()
        session = self.needed_session()
        zones = self._server.desk.zones()
        self.zone = self.get_query_argument("zone", session.grant.zone or next(iter(zones), ""))
        if not session.grant.allows(self.zone):
            raise web.HTTPError(403, reason="This device may not act in this zone")
        part = self.get_query_argument("part", "")
        if part and not may_show(part, session.grant):
            raise web.HTTPError(403, reason="This device may not see this part")
        self.part = (part, session.grant.zone) if part else ()
        self.session_id = session.id

    def open(self, *_args: str, **_kwargs: str) -> None:
        """Send the snapshot."""
        self.key = (self.language(), self.zone, *self.part)
        self.start(Viewer(self._server.desk, self._server.desk.keys(*self.key)))
        self._server.devices_changed()

    def on_close(self) -> None:
        """Free the place."""
        super().on_close()
        self._server.devices_changed()


class StopEventsHandler(DeviceEventsHandler):
    """A second connection of a paired device, for what its STOP needs, and for STOP itself: no other document can
    disturb it, and STOP waits for no new connection."""

    def initialize(self, server: Any) -> None:
        super().initialize(server)
        self._answers: List[str] = []
        self._stops: Set[asyncio.Future[None]] = set()  # that are carried out

    def on_message(self, message: Any) -> None:
        """Take a STOP, and answer with its number. Others do not wait for its answer, as a coroutine would let them."""
        try:
            body = json.loads(message)
            number = body["number"]
        except (ValueError, RecursionError, TypeError, KeyError):
            number = None
        if type(number) is not int or not isinstance(body.get("language", ""), str):
            self.close(1003, "this address takes STOP only")
            return
        if len(self._stops) + len(self._answers) >= MOST_STOPS:
            self.close(1008, "too many STOPs without an answer")
            return
        stop = asyncio.ensure_future(self._stop(number, body))
        self._stops.add(stop)
        stop.add_done_callback(self._stops.discard)

    async def _stop(self, number: int, body: Dict[str, Any]) -> None:
        status, answer, session = 401, {}, self.session()
        if session is not None:
            language = self._server.store.language(body.pop("language", ""))
            status, answer = await carried_out(self._server, session, STOP_COMMAND, body, language)
        self._answers.append(json.dumps({**answer, "type": "answer", "number": number, "status": status}))
        self.on_sent()

    def send_next(self, now: float, made: Optional[Made] = None) -> None:
        """Send answers first."""
        while self._answers and self.busy_since is None:
            if not self.write_frames(frame(self._answers.pop(0)), now):
                return
        super().send_next(now, made)

    def open(self, *_args: str, **_kwargs: str) -> None:
        """Send the snapshot."""
        grant = self.needed_session().grant
        key = NO_STOP if grant.role == JUDGE else (STOP, grant.zone)
        self.start(Viewer(self._server.desk, [key]))
        self._server.devices_changed()


def described(session: DeviceSession) -> Dict[str, Any]:
    """Return what a device may know of its session."""
    return {"id": session.id, "role": session.grant.role, "zone": session.grant.zone, "person": session.person,
            "device": session.device}
