"""The WebSockets of readers: each is sent its documents as they change (docs/web.md, "Live data").

All but sending is in `Viewer`: this is the connection.
"""

from typing import Any, List, Optional

from tornado import web

from roah_rsbb.web.displays.listed import display_of
from roah_rsbb.web.documents import DATA, DISPLAY, TEXTS
from roah_rsbb.web.guarded import Guarded
from roah_rsbb.web.numbered import Key, Made
from roah_rsbb.web.serving import BoundedSocket, frame
from roah_rsbb.web.viewer import Viewer


class Reader(Guarded, BoundedSocket):
    """The connection of a reader. Its kinds say who may open it, and what is sent."""

    session_id = ""  # of a paired device
    key: Optional[Key] = None  # what a paired device shows, see `Desk.show`

    def initialize(self, server: Any) -> None:
        self._server = server
        self._viewer: Optional[Viewer] = None

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
