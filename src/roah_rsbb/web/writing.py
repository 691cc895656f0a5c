"""What devices send: a code that pairs them, and then commands (docs/security.md, "Paired devices").

Reading handlers are open to all sites. These are not: a request must come from one of our own pages, must be small, and
its device must be paired.
"""

import json
from typing import Any, Dict, Optional
from urllib.parse import urlsplit

from tornado import web

from roah_rsbb.web.guarded import TOO_MANY_REQUESTS, Guarded
from roah_rsbb.web.pairing import SESSION_VALID_S, Refused, Session, TooManyGuesses, plain

COOKIE = "roah_rsbb_session"


def is_own_origin(origin: str, protocol: str, host: str) -> bool:
    """Whether a page of this address sends the request. `protocol`, `host`: of the request."""
    try:
        page = urlsplit(origin)
    except ValueError:
        return False
    return page.scheme == protocol and page.netloc != "" and page.netloc.lower() == host.lower()


class FromOwnPage(Guarded):
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

    def session(self) -> Optional[Session]:
        """Return the session of the device; None: it is not paired."""
        token = self.get_cookie(COOKIE)
        return None if not token else self._server.sessions.of(self._server.utc(), token)

    def needed_session(self) -> Session:
        """Return the session of the device; refuses the request of one that is not paired."""
        session = self.session()
        if session is None:
            raise web.HTTPError(401, reason="This device is not paired")
        return session

    def language(self) -> str:
        """The language of the reader."""
        return self._server.store.language(str(self.body.get("language", ""))
                                           or self.request.headers.get("Accept-Language", ""))

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


class PairHandler(FromOwnPage):
    """Pairs a device that has a code."""

    def post(self) -> None:
        """Take the code, and answer with the session's cookie."""
        server = self._server
        person, device, now = plain(self.text("person")), self.text("device"), server.now()
        before = self.session()
        with server.store.speaking(self.language()):
            try:
                server.codes.check_guess(now, self.request.remote_ip or "")
                server.sessions.check(server.utc(), person)
                grant = server.codes.take(now, self.text("code"))
                token = server.sessions.add(server.utc(), grant, person, device)
            except TooManyGuesses as refused:
                self.refuse(TOO_MANY_REQUESTS, str(refused))
                return
            except Refused as refused:
                self.refuse(403, str(refused))
                return
        if before is not None:
            server.revoke(before.id)
        self.set_cookie(COOKIE, token, path="/", max_age=int(SESSION_VALID_S), httponly=True, samesite="Strict",
                        secure=self.request.protocol == "https")
        self.finish(described(server.sessions.of(server.utc(), token)))


class SessionHandler(FromOwnPage):
    """The session of the device that asks."""

    def get(self) -> None:
        """Return it, or 401 if the device is not paired."""
        self.finish(described(self.needed_session()))

    def delete(self) -> None:
        """End the pairing of this device."""
        session = self.needed_session()
        try:
            self._server.revoke(session.id)
        except OSError as error:
            self.refuse(500, str(error))
            return
        self.clear_cookie(COOKIE, path="/")
        self.set_status(204)


def described(session: Session) -> Dict[str, Any]:
    """Return what a device may know of its session."""
    return {"id": session.id, "role": session.grant.role, "zone": session.grant.zone, "person": session.person,
            "device": session.device}
