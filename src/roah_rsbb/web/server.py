"""The gateway's web server: pages, data for programs, and a WebSocket for each reader of live data (docs/web.md).

Reading is open to everybody who reaches the port. Nothing that a reader sends is stored or takes much time.
"""

import asyncio
import os
import re
import socket
from typing import Any, FrozenSet, List, Optional

from tornado import httputil, web, websocket

from roah_rsbb.web.documents import DATA, TEXTS
from roah_rsbb.web.limits import Places, Rates, is_own_host
from roah_rsbb.web.serving import MAX_MESSAGE_BYTES, BoundedServer, bind, set_headers
from roah_rsbb.web.store import Key, Store
from roah_rsbb.web.viewer import Viewer

PAGES = ("display", "overlay")
# How often readers get the clock. Pages report silence after three of these periods.
BEAT_S = 1.0
# How often the server checks whether the core is silent.
LOOK_S = 0.25
# A reader that has not taken a message for so long is gone, or does not read.
STUCK_S = 20.0
# The system would otherwise hold megabytes for a reader that does not read.
SEND_BUFFER_BYTES = 64 * 1024
_PING_S = 20.0
_TOO_MANY_REQUESTS, _MISDIRECTED = 429, 421

_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Server": "roah_rsbb",
}
# Pages load and run nothing from other sites, have no scripts within the page, and no other site may show them in a
# frame. The WebSocket is named because older browsers do not count it as 'self'.
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; font-src 'self'; "
    "connect-src 'self' ws://{host} wss://{host}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_OPEN_TO_READ = {
    "Access-Control-Allow-Origin": "*",
    "Access-Control-Allow-Methods": "GET, HEAD, OPTIONS",
    "Access-Control-Allow-Headers": "If-None-Match",
    "Access-Control-Expose-Headers": "ETag",
}


class WebServer:
    """Serves the documents of a store. Call all methods in the thread of the asyncio loop."""

    def __init__(self, loop: asyncio.AbstractEventLoop, store: Store, folder: str, names: FrozenSet[str]) -> None:
        """`folder`: the files of the pages; `names`: of this computer (`limits.own_names`)."""
        self._loop = loop
        self.store = store
        self.names = names
        self.rates = Rates()
        self.viewers: Places[EventsHandler] = Places(
            lambda viewer: viewer.close(1013, "too many readers of this address"))
        self._was_heard = False
        self._beat_due_mono = float("-inf")
        self._timer: Optional[asyncio.TimerHandle] = None
        self._listening: List[socket.socket] = []
        shared = {"server": self}
        application = web.Application(
            [
                (rf"/api/v1/({'|'.join(DATA)})", DataHandler, shared),
                (r"/api/v1/events", EventsHandler, shared),
                (r"/api/v1/schemas/([a-z]+\.json)", SchemaHandler,
                 {**shared, "path": os.path.join(folder, "schemas")}),
                (r"/assets/(.*)", FileHandler, {**shared, "path": os.path.join(folder, "assets")}),
                (r"/()", PageHandler, {**shared, "folder": folder}),
                (rf"/({'|'.join(PAGES)})", PageHandler, {**shared, "folder": folder}),
                (r"/(team)/[^/]+", PageHandler, {**shared, "folder": folder}),
            ],
            compress_response=True,
            websocket_max_message_size=MAX_MESSAGE_BYTES, websocket_ping_interval=_PING_S,
            default_handler_class=MissingHandler, default_handler_args=shared,
            log_function=lambda handler: None,
        )
        self._http = BoundedServer(application)

    def open(self, host: str, port: int) -> int:
        """Start serving (port 0: any free port); returns the port. Raises `ServeError`, whose text names the remedy."""
        self._listening = bind(host, port, "the web pages", "web")
        self._http.add_sockets(self._listening)
        self._look()
        return self._listening[0].getsockname()[1]

    def close(self) -> None:
        """Stop serving; has no effect if closed."""
        if self._timer is not None:
            self._timer.cancel()
        for viewer in self.viewers:
            viewer.close()
        self._http.stop()
        self._listening = []

    def publish(self) -> None:
        """Send what has changed to all readers."""
        for viewer in self.viewers:
            viewer.send_next()

    def now(self) -> float:
        """Return the monotonic time in seconds."""
        return self._loop.time()

    def keep(self, stream: Any) -> None:
        """A connection became a reader: readers have their own limit."""
        self._http.keep(stream)

    def _look(self) -> None:
        """Send the clock each second, and at once when the core falls silent or is heard again."""
        self._timer = self._loop.call_later(LOOK_S, self._look)
        now = self.now()
        is_heard = self.store.is_heard(now)
        if now < self._beat_due_mono and is_heard == self._was_heard:
            return
        self._was_heard, self._beat_due_mono = is_heard, now + BEAT_S
        for viewer in self.viewers:
            viewer.beat(now)


class Guarded(web.RequestHandler):
    """A handler that only answers requests for this computer, and not too many of them."""

    _server: WebServer

    def prepare(self) -> None:
        """Refuse what no browser in the hall would ask."""
        if not self._server.rates.allows(self._server.now(), self.request.remote_ip or ""):
            raise web.HTTPError(_TOO_MANY_REQUESTS, reason="Too Many Requests")
        if not is_own_host(self.request.host, self._server.names):
            raise web.HTTPError(_MISDIRECTED, reason="Misdirected Request")

    def set_default_headers(self) -> None:
        set_headers(self, {**_HEADERS, "Content-Security-Policy": _POLICY.format(host=_plain_host(self.request))})

    def write_error(self, status_code: int, **_kwargs: Any) -> None:
        """Answer with a line that names the remedy; never with what happened inside."""
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        if status_code == _TOO_MANY_REQUESTS:
            self.set_header("Retry-After", "5")
        self.finish({
            _MISDIRECTED: "Open this page by the address of the box's computer, or add its name to web_names.\n",
            _TOO_MANY_REQUESTS: "This address asks too often: try again in some seconds.\n",
            404: "There is no such page. The address / lists all pages.\n",
        }.get(status_code, f"{status_code} {self._reason}\n"))


class MissingHandler(Guarded):
    """Answers all other addresses."""

    def initialize(self, server: WebServer) -> None:
        self._server = server

    def prepare(self) -> None:
        """Refuse the request."""
        super().prepare()
        raise web.HTTPError(404)


class PageHandler(Guarded):
    """A page. Its parameters are for its script: the server does not read them."""

    def initialize(self, server: WebServer, folder: str) -> None:
        self._server = server
        self._folder = folder

    def get(self, name: str) -> None:
        """Return the page."""
        with open(os.path.join(self._folder, f"{name or 'index'}.html"), "rb") as page:
            self.set_header("Content-Type", "text/html; charset=utf-8")
            self.set_header("Cache-Control", "no-cache")
            self.finish(page.read())

    head = get


class FileHandler(Guarded, web.StaticFileHandler):
    """The files of the pages."""

    def initialize(self, server: WebServer, path: str) -> None:
        self._server = server
        web.StaticFileHandler.initialize(self, path)

    def set_extra_headers(self, path: str) -> None:
        self.set_header("Cache-Control", "no-cache")


class SchemaHandler(FileHandler):
    """The JSON Schema of a document or of the messages."""

    def set_extra_headers(self, path: str) -> None:
        set_headers(self, {**_OPEN_TO_READ, "Content-Type": "application/schema+json", "Cache-Control": "max-age=60"})


class DataHandler(Guarded):
    """A document of data. Pages of all sites may read it: it is public."""

    def initialize(self, server: WebServer) -> None:
        self._server = server

    def set_default_headers(self) -> None:
        super().set_default_headers()
        set_headers(self, {**_OPEN_TO_READ, "Cache-Control": "max-age=1"})

    def options(self, _name: str) -> None:
        """Allow pages of other sites to ask."""
        self.set_status(204)

    def get(self, name: str) -> None:
        """Return the document, or 304 if it has not changed. The clock in it is no change."""
        store, now = self._server.store, self._server.now()
        number, is_heard = store.document((name, "")).number, store.is_heard(now)
        self.set_header("Etag", f'W/"{store.session}-{number}-{int(is_heard)}"')
        if self.check_etag_header():
            self.set_status(304)
            self.finish()
            return
        self.set_header("Content-Type", "application/json; charset=utf-8")
        self.finish(store.answer(name, now))

    head = get

    def compute_etag(self) -> Optional[str]:
        """Keep the one that is set."""
        return None


class EventsHandler(Guarded, websocket.WebSocketHandler):
    """The connection of a reader of live data. Pages of all sites may open it: it only sends what is public."""

    def initialize(self, server: WebServer) -> None:
        self._server = server
        self._viewer: Optional[Viewer] = None
        self._busy_since: Optional[float] = None

    def check_origin(self, origin: str) -> bool:
        """Reading is open. A handler that takes commands must compare the origin with its own address."""
        return True

    def prepare(self) -> None:
        """Refuse unknown documents before the connection is opened."""
        super().prepare()
        asked = [name for name in self.get_query_argument("documents", ",".join(DATA)).split(",") if name]
        unknown = [name for name in asked if name not in DATA + TEXTS]
        if unknown or not asked:
            raise web.HTTPError(400, reason=f"Unknown documents: choose from {', '.join(DATA + TEXTS)}")
        self._asked = list(dict.fromkeys(asked))

    def open(self, *_args: str, **_kwargs: str) -> None:
        """Send the snapshot."""
        server = self._server
        language = server.store.language(
            self.get_query_argument("language", self.request.headers.get("Accept-Language", "")))
        keys: List[Key] = server.store.keys(self._asked, language)
        self._viewer = Viewer(server.store, keys)
        stream = getattr(self.ws_connection, "stream", None)
        if stream is not None and stream.socket is not None:
            stream.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER_BYTES)
        self.set_nodelay(True)
        server.keep(stream)
        server.viewers.add(self, self.request.remote_ip or "")
        self.send_next()

    def on_message(self, message: object) -> None:
        """Readers have nothing to say."""
        self.close(1003, "this address only sends")

    def on_close(self) -> None:
        """Free the place."""
        self._server.viewers.remove(self)

    def beat(self, now: float) -> None:
        """Send the clock, unless a message is still on its way. End a reader that takes nothing."""
        if self._busy_since is None:
            self._viewer.beat()
            self.send_next()
        elif now - self._busy_since > STUCK_S:
            self._server.viewers.remove(self)
            stream = getattr(self.ws_connection, "stream", None)
            if stream is not None:
                stream.close()  # `close` would wait behind what is not taken

    def send_next(self) -> None:
        """Send the next message as soon as the one before is sent."""
        if self._busy_since is not None or self._viewer is None:
            return
        now = self._server.now()
        text = self._viewer.next(now)
        if text is None:
            return
        try:
            sent = self.write_message(text)
        except websocket.WebSocketClosedError:
            self._server.viewers.remove(self)
            return
        self._busy_since = now
        sent.add_done_callback(self._on_sent)

    def _on_sent(self, sent: "asyncio.Future[None]") -> None:
        self._busy_since = None
        if sent.cancelled() or sent.exception() is not None:  # the connection is closed
            self._server.viewers.remove(self)
        else:
            self.send_next()


def _plain_host(request: httputil.HTTPServerRequest) -> str:
    """The host of a request for a header; anything but a host and a port is left out."""
    return request.host if re.fullmatch(r"[\w.:\[\]-]+", request.host, re.ASCII) else "invalid"
