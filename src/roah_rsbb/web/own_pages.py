"""What our own pages ask: who may (docs/security.md, "Paired devices"), the pairing of a device, and the organiser's
list of those that are paired (docs/web.md, "Pairing").

Handlers that only read are open to all sites. These are not: a request must come from one of our own pages, must be
small, and its device must be paired.
"""

import asyncio
import json
from typing import Any, Dict, Optional
from urllib.parse import urlsplit

from tornado import web

from roah_rsbb.document.calls import PAIR, PAIRED, REVOKE, Caller, InThread
from roah_rsbb.model.actions import ORGANISER
from roah_rsbb.model.reason import Refused
from roah_rsbb.web.pairing import SESSION_VALID_S, DeviceSession, NotPaired, TooManyGuesses, modules_of
from roah_rsbb.web.serving import TOO_MANY_REQUESTS, Guarded
from roah_rsbb.wording import device
from roah_rsbb.wording.device import encryption_text, role_text
from roah_rsbb.wording.language import tr, tr_said
from roah_rsbb.wording.times import Moments

COOKIE = "roah_rsbb_session"
# Browsers take a cookie with this prefix from encrypted pages only.
ENCRYPTED = "__Host-"


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
        session = self.seen()
        if session is not None:
            self._server.know(getattr(self.request.connection, "stream", None), self.request.remote_ip or "")
        return session

    def seen(self) -> Optional[DeviceSession]:
        """Note that the device is heard now, also at the end of its connection. Returns its session."""
        token = self.get_cookie(self.cookie(COOKIE))
        return self._server.sessions.of(self._server.utc(), token, self.is_encrypted) if token else None

    @property
    def is_encrypted(self) -> bool:
        """Whether the request came with TLS."""
        return self.request.protocol == "https"

    def cookie(self, name: str) -> str:
        """Return the name that a cookie has on this connection."""
        return f"{ENCRYPTED}{name}" if self.is_encrypted else name

    def give_cookie(self, name: str, token: str) -> None:
        """Let the browser keep a token, which no script reads."""
        self.set_cookie(self.cookie(name), token, path="/", max_age=int(SESSION_VALID_S), httponly=True,
                        samesite="Strict", secure=self.is_encrypted)

    def needed_session(self) -> DeviceSession:
        """Return the session of the device; refuses the request of one that is not paired."""
        session = self.session()
        if session is None:
            raise web.HTTPError(401, reason="This device is not paired")
        return session


class FromOwnPage(OfDevice):
    """Takes requests of our own pages only. Answers are JSON, and nobody keeps them."""

    def prepare(self) -> None:
        """Refuse requests of other sites, and those that are not JSON objects.

        Browsers name the page in everything but GET. A page of another site cannot read the answer to a GET.
        """
        self.body: Dict[str, Any] = {}
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
        self.give_cookie(COOKIE, token)
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
            with self._server.store.speaking(self.language()):
                self.refuse(500, tr(device.ENDED_NOT_SAVED, error=error))
            return
        self.clear_cookie(self.cookie(COOKIE), path="/")
        self.set_status(204)


def described(session: DeviceSession) -> Dict[str, Any]:
    """Return what a device may know of its session."""
    return {"id": session.id, "role": session.grant.role, "zone": session.grant.zone, "person": session.person,
            "device": session.device}


class PairingsHandler(OfOrganiser):
    """The paired devices."""

    async def get(self) -> None:
        """Return the list."""
        own, moments = self.needed_session(), Moments(False)
        await self._answer(PAIRED, lambda found: {"devices": [
            {"id": one["id"], "person": one["person"], "device": one["device"], "is_own": one["id"] == own.id,
             "role": role_text(one["role"], one["zone"]),
             "seen": tr("connected") if one["connected"] else moments.stamp(one["seen"] or one["paired"])}
            for one in found["devices"]]})

    async def post(self) -> None:
        """Make a code for a device, or end the pairing of the one that is named."""
        ended = self.text("end")
        if ended:
            await self._answer(REVOKE, lambda found: found, device=ended)
        else:
            await self._answer(PAIR, lambda found: {**found, "square": _square(found["url"]),
                                                    "encryption": encryption_text(found["url"])},
                               role=self.text("role"), zone=self.text("zone"))

    async def _answer(self, name: str, shown: Any, **arguments: str) -> None:
        try:
            found: Any = self._server.calls[name](arguments, Caller(ORGANISER, self.request.remote_ip or ""))
            if isinstance(found, InThread):
                found = await asyncio.get_event_loop().run_in_executor(None, found.make)
        except Refused as refused:
            with self._server.store.speaking(self.language()):
                self.refuse(409, *map(tr_said, refused.reasons))
        else:
            with self._server.store.speaking(self.language()):
                self.finish(shown(found))


def _square(url: str) -> Any:
    """Return the rows of the QR code, a 1 for each dark module; None: its library is not installed."""
    rows = modules_of(url)
    return rows and ["".join("01"[is_dark] for is_dark in row) for row in rows]
