"""The web server of the tablet: a page, its map, and a WebSocket for each browser that shows it.

Anybody on the network may open it. Therefore nothing from a browser is stored or takes much time.
"""

import asyncio
import json
import logging
import os
import socket
import time
from typing import Any, Callable, Dict, FrozenSet, Iterable, List, Optional

from tornado import web, websocket

from roah_rsbb.comm import sockets
from roah_rsbb.comm.channels import MakePeer, Network
from roah_rsbb.ground.params import Params
from roah_rsbb.tablet import maps
from roah_rsbb.tablet.maps import Map
from roah_rsbb.tablet.radio import ShownTablet, TabletRadio
from roah_rsbb.web.limits import Rates, own_names
from roah_rsbb.web.serving import (
    LOOPBACK,
    MAX_MESSAGE_BYTES,
    BoundedServer,
    BoundedSocket,
    FileHandler,
    Guarded,
    bind,
    hosts_of,
    retry_until_open,
)

# -- messages of pages --------------------------------------------------------------------------------

# A page sends `{"do": "here"}` every two seconds, `{"do": "call"}`, or `{"do": "place", "u": 0.25, "v": 0.5}` (a point
# of the map's image, see `maps`). It receives the complete state every second and after every change.

HERE, CALL, PLACE = "here", "call", "place"

# The box acknowledges a touch within milliseconds; after this time pages show that it did not.
UNANSWERED_S = 3.0
# Taps on the call button that follow each other within this time are one call.
SAME_CALL_S = 2.0


class Refusal(Exception):
    """The request of a page is refused. The text is for its user."""


class Pages:
    """The pages of one tablet."""

    def __init__(self, state: ShownTablet, plan: Optional[Map]) -> None:
        """`plan`: the map; None if there is none."""
        self._state = state
        self._map = plan
        self._touched_mono = float("-inf")
        self._tapped_mono = float("-inf")

    def do(self, now_mono: float, time_ns: int, text: object) -> bool:
        """Carry out the request of a page; returns whether something was touched. Raises `Refusal`."""
        asked = _parse(text)
        what = asked.get("do")
        if what == HERE:
            return False
        if what not in (CALL, PLACE):
            raise Refusal("Reload this page: its version differs")
        if not self._state.hears_box(now_mono):
            raise Refusal("The box is silent: nothing was sent")
        if what == CALL:
            is_same = now_mono - self._tapped_mono < SAME_CALL_S
            self._tapped_mono = now_mono
            if is_same:
                return False
            self._state.call(time_ns)
        else:
            self._place(time_ns, asked)
        self._touched_mono = now_mono
        return True

    def _place(self, time_ns: int, asked: Dict[str, Any]) -> None:
        u, v = asked.get("u"), asked.get("v")
        if self._map is None:
            raise Refusal("The map is missing")
        if not (_is_fraction(u) and _is_fraction(v)):
            raise Refusal("This position is not on the map")
        if self._map.is_wall(u, v):
            raise Refusal("This position is on a wall: touch a free place")
        self._state.place(time_ns, *self._map.to_metres(u, v))

    def text(self, now_mono: float) -> str:
        """The state that every page shows."""
        state = self._state
        return json.dumps({
            "box": state.hears_box(now_mono),
            "view": "map" if state.display_map else "call",
            "call": {"time": _milliseconds(state.call_time), "acknowledged": state.call_is_acknowledged},
            "place": {
                "time": _milliseconds(state.position_time), "acknowledged": state.position_is_acknowledged,
                **self._shown(),
            },
            "unanswered": now_mono - self._touched_mono > UNANSWERED_S,
            "map": self._plan(),
        })

    def _shown(self) -> Dict[str, float]:
        u, v = (0.0, 0.0) if self._map is None else self._map.to_image(self._state.x, self._state.y)
        return {"x": self._state.x, "y": self._state.y, "u": u, "v": v}

    def _plan(self) -> Optional[Dict[str, object]]:
        plan = self._map
        if plan is None:
            return None
        return {
            "image": f"map.png?{plan.version}", "width": plan.width, "height": plan.height, "negate": plan.negate
        }


def refusal_text(refusal: Refusal) -> str:
    """The answer to a refused request."""
    return json.dumps({"refused": str(refusal)})


def _parse(text: object) -> Dict[str, Any]:
    try:
        asked = json.loads(text) if isinstance(text, str) else None
    except (ValueError, RecursionError):
        asked = None
    return asked if isinstance(asked, dict) else {}


def _is_fraction(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and 0.0 <= value <= 1.0


def _milliseconds(time) -> int:
    """A time for a browser's Date; 0 means never."""
    return time[0] * 1000 + time[1] // 1_000_000


# -- the server ---------------------------------------------------------------------------------------

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


# -- what the program makes ---------------------------------------------------------------------------

# It works with missing parts: without a network or a free port it retries, and without a map it offers only the call
# button.

_log = logging.getLogger(__name__)


class TabletPage:
    """Serves the tablet's page. Call everything in the loop's thread."""

    def __init__(self, loop: asyncio.AbstractEventLoop, params: Params, resource: str, names: Iterable[str],
                 publish_url: Callable[[str], None], make_peer: Optional[MakePeer] = None) -> None:
        """`resource`: the folder with the page and the default map; `names`: further names of this computer.
        `publish_url` is called with the page's address, once it is served. `make_peer` replaces `Peer`, for another
        network. Raises `BadParams`."""
        self._loop, self._publish_url = loop, publish_url
        self._rsbb_host = params.text("rsbb_host", "10.255.255.255")
        rsbb_port = params.whole("rsbb_port", 6666, 1, 65000)
        bind_host = params.text("bind_host", sockets.ANY_HOST)
        map_file = params.path("map_file", os.path.join(resource, "maps", "dummy.yaml"))
        self._port = params.whole("tablet_port", 8080, 0, 65535)
        everywhere = LOOPBACK if self._rsbb_host.startswith("127.") else sockets.ANY_HOST
        self._host = params.text("tablet_host", everywhere)
        params.done()
        plan = _load_map(map_file)
        state = ShownTablet()
        self._radio = TabletRadio(
            loop, state, self._on_box, lambda text: _log.warning("%s", text),
            Network(self._rsbb_host, rsbb_port, bind_host), make_peer,
        )
        self._server = TabletServer(
            loop, Pages(state, plan), plan, os.path.join(resource, "tablet"), own_names(names),
            self._radio.changed, self._on_presence,
        )

    def start(self) -> None:
        """Serve as soon as that is possible."""
        retry_until_open(self._loop, self._radio.open)
        retry_until_open(self._loop, self._open_server)

    def stop(self) -> None:
        """Stop serving, and stop sending to the box."""
        self._server.close()
        self._radio.close()

    def _open_server(self) -> None:
        port = self._server.open(self._host, self._port)
        addresses = [f"http://{host}:{port}/" for host in hosts_of(self._host, self._rsbb_host)]
        self._publish_url(addresses[0])
        _log.info("The tablet's page: open %s", " or, on this computer, ".join(addresses))

    def _on_box(self, changed: bool) -> None:
        if changed:
            self._server.publish()

    def _on_presence(self, there: bool) -> None:
        self._radio.present = there


def _load_map(map_file: str) -> Optional[maps.Map]:
    try:
        return maps.load(map_file)
    except maps.MapError as error:
        _log.error("The tablet has no map: %s", error)
        return None
