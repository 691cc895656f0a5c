"""The web server of the tablet: a page, its map, and a WebSocket for each browser that shows it.

Anybody on the network may open it. Therefore nothing from a browser is stored or takes much time.
"""

import asyncio
import socket
import time
from typing import Callable, Dict, FrozenSet, List, Optional

from tornado import web, websocket

from roah_rsbb.tablet.maps import Map
from roah_rsbb.tablet.pages import Pages, Refusal, refusal_text
from roah_rsbb.web.guarded import FileHandler, Guarded
from roah_rsbb.web.limits import Rates
from roah_rsbb.web.serving import MAX_MESSAGE_BYTES, BoundedServer, BoundedSocket, bind

# No venue has more tablets.
MAX_PAGES = 32
# A page sends a message every two seconds. A phone that goes to sleep does not close its page.
PAGE_SILENT_S = 6.0
# Nobody touches a page more often than this per second.
MAX_MESSAGES_A_SECOND = 20
_PUBLISH_PERIOD_S = 1.0


class TabletServer:
    """Serves one tablet to any number of browsers. Call all methods in the thread of the asyncio loop."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        pages: Pages,
        plan: Optional[Map],
        folder: str,
        names: FrozenSet[str],
        on_touch: Callable[[], None],
        on_presence: Callable[[bool], None],
    ) -> None:
        """`folder`: the page's files; `names`: of this computer (`limits.own_names`).

        `on_touch()` is called when a page touched the tablet. `on_presence(there)` is called each second and reports
        whether any page is open.
        """
        self._loop = loop
        self.names = names
        self.rates = Rates()
        self._pages = pages
        self._on_touch = on_touch
        self._on_presence = on_presence
        self._sockets: Dict[PageSocket, float] = {}  # to the monotonic time it was last heard
        self._present_until_mono = float("-inf")
        self._timer: Optional[asyncio.TimerHandle] = None
        self._listening: List[socket.socket] = []
        application = web.Application(
            [
                (r"/pages", PageSocket, {"server": self}),
                (r"/map\.png", MapHandler, {"server": self, "plan": plan}),
                (r"/(.*)", FileHandler, {"server": self, "path": folder, "default_filename": "index.html"}),
            ],
            websocket_max_message_size=MAX_MESSAGE_BYTES,
            default_handler_class=web.ErrorHandler, default_handler_args={"status_code": 404},
            log_function=lambda handler: None,
        )
        self._http = BoundedServer(application)

    def open(self, host: str, port: int) -> int:
        """Start serving (port 0: any free port); returns the port. Raises OSError whose text names the remedy."""
        self._listening = bind(host, port, "the tablet's page", "tablet")
        self._http.add_sockets(self._listening)
        self._publish_each_second()
        return self._listening[0].getsockname()[1]

    def close(self) -> None:
        """Stop serving. Has no effect if it is closed already."""
        if self._timer is not None:
            self._timer.cancel()
        for page in list(self._sockets):
            page.close()
        self._http.stop()
        self._listening = []

    def now(self) -> float:
        """Return the monotonic time in seconds."""
        return self._loop.time()

    def publish(self) -> None:
        """Send the current state to all pages."""
        text = self._pages.text(self._loop.time())
        for page in list(self._sockets):
            page.send(text)

    def _publish_each_second(self) -> None:
        self._timer = self._loop.call_later(_PUBLISH_PERIOD_S, self._publish_each_second)
        now = self._loop.time()
        for page, heard in list(self._sockets.items()):
            if now - heard > PAGE_SILENT_S:
                self.forget(page)
                page.close()
        self._note_presence()
        self.publish()

    def _note_presence(self) -> None:
        # A page that was just closed still counts, because its last touch is still being sent.
        now = self._loop.time()
        if self._sockets:
            self._present_until_mono = now + PAGE_SILENT_S
        self._on_presence(now <= self._present_until_mono)

    # -- for the pages' sockets ---------------------------------------------------------------------

    def add(self, page: "PageSocket") -> bool:
        """Add a browser that opened the page; returns False if there are too many."""
        if len(self._sockets) >= MAX_PAGES:
            return False
        self._sockets[page] = self._loop.time()
        self._http.keep(getattr(page.ws_connection, "stream", None))
        self._note_presence()
        page.send(self._pages.text(self._loop.time()))
        return True

    def forget(self, page: "PageSocket") -> None:
        """Forget a browser that left."""
        self._sockets.pop(page, None)

    def receive(self, page: "PageSocket", text: object) -> None:
        """Handle a message of a page."""
        if page not in self._sockets:
            return  # too many pages, or silent for too long: it is being closed
        now = self._sockets[page] = self._loop.time()
        try:
            touched = self._pages.do(now, time.time_ns(), text)
        except Refusal as refusal:
            page.send(refusal_text(refusal))
            return
        if touched:
            self._on_touch()
            self.publish()


class PageSocket(Guarded, BoundedSocket):
    """The connection of one browser. Only our own page may open it: tornado compares Origin and Host."""

    def initialize(self, server: TabletServer) -> None:
        self._server = server
        self._second = 0
        self._messages = 0

    def open(self, *_args: str, **_kwargs: str) -> None:
        self.set_nodelay(True)
        if not self._server.add(self):
            self.close(1013, "too many pages are open: close one")

    def on_message(self, message: object) -> None:
        second = int(time.monotonic())
        self._messages = self._messages + 1 if second == self._second else 1
        self._second = second
        if self._messages <= MAX_MESSAGES_A_SECOND:
            self._server.receive(self, message)

    def on_close(self) -> None:
        self._server.forget(self)

    def send(self, text: str) -> None:
        """Send a text. Forget a browser whose connection is closed."""
        try:
            self.write_message(text)
        except websocket.WebSocketClosedError:
            self._server.forget(self)


class MapHandler(Guarded):
    """The map's image."""

    def initialize(self, server: TabletServer, plan: Optional[Map]) -> None:
        self._server = server
        self._plan = plan

    def get(self) -> None:
        if self._plan is None:
            raise web.HTTPError(404)
        self.set_header("Content-Type", "image/png")
        self.set_header("Cache-Control", "no-cache")
        self.write(self._plan.png)
