"""The WebSockets of readers: each is sent its documents as they change (docs/web.md, "Live data").

All but sending is in `Viewer`: this is the connection.
"""

import asyncio
import json
from typing import Any, Dict, List, Optional, Set

from tornado import web

from roah_rsbb.model.actions import STOPS
from roah_rsbb.web.commands import STOP as STOP_COMMAND
from roah_rsbb.web.commands import carried_out
from roah_rsbb.web.device_documents import NO_STOP, STOP, may_show
from roah_rsbb.web.displays import display_of
from roah_rsbb.web.numbered import Key, Made, Viewer
from roah_rsbb.web.own_pages import OfDevice, is_own_origin
from roah_rsbb.web.public_documents import DATA, DISPLAY, TEXTS
from roah_rsbb.web.serving import BoundedSocket, Guarded, frame

# STOPs of a connection without an answer. A page has at most two for each zone.
MOST_STOPS = 200


class Reader(Guarded, BoundedSocket):
    """The connection of a reader. Its kinds say who may open it, and what is sent."""

    session_id = ""  # of a paired device
    key: Optional[Key] = None  # what a paired device shows, see `Desk.show`
    _viewer: Optional[Viewer] = None

    @property
    def places(self) -> Any:
        """Where the readers of this kind have their places."""
        return self._server.viewers

    def language(self) -> str:
        """The language that is asked for, of those that are available."""
        return self._server.store.language(
            self.get_query_argument("language", self.request.headers.get("Accept-Language", "")))

    def start(self, viewer: Viewer) -> None:
        """Give the reader a place, and send the first message."""
        self._viewer = viewer
        self.begin(self._server.keep)
        self.places.add(self, self.request.remote_ip or "")
        self.on_sent()

    def on_message(self, message: object) -> None:
        """Readers have nothing to say."""
        self.close(1003, "this address only sends")

    def on_close(self) -> None:
        """Free the place."""
        self.on_lost()

    def on_lost(self) -> None:
        """Free the place."""
        self.places.remove(self)

    def on_sent(self) -> None:
        """Send the next message."""
        self.send_next(self._server.now())

    def beat(self, now: float, made: Made) -> None:
        """Send the clock, unless a message is still on its way. End a reader that takes nothing."""
        if self.busy_since is None:
            self._viewer.beat()
            self.send_next(now, made)
        elif self.is_stuck(now):
            self.end()

    def send_next(self, now: float, made: Optional[Made] = None) -> None:
        """Send the next message as soon as the one before is sent. `made`: what others were sent at this moment."""
        while self.busy_since is None and self._viewer is not None:
            text = self._viewer.next(made)
            if text is None or not self.write_frames(frame(text), now):
                return


class EventsHandler(Reader):
    """A reader of public documents. Pages of all sites may open it: it only sends what is public."""

    def check_origin(self, origin: str) -> bool:
        """Reading is open."""
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
        store = self._server.store
        keys: List[Key] = store.keys(self._asked, self.language())
        display = display_of(lambda name: self.get_query_argument(name, ""), self.get_query_arguments("zone"),
                             self.language(), self.request.remote_ip or "", self._server.utc())
        if display is not None and self._server.display_opened(self, display):
            keys.append((DISPLAY, display.id))
        self.start(Viewer(store, keys))

    def on_close(self) -> None:
        """Free the place."""
        super().on_close()
        self._server.display_closed(self)


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
        """Free the place. Until now, the device was heard."""
        self.seen()
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
        key = (STOP, grant.zone) if grant.role in STOPS else NO_STOP
        self.start(Viewer(self._server.desk, [key]))
        self._server.devices_changed()
