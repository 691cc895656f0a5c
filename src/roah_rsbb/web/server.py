"""The gateway's web server: pages, data for programs, and a WebSocket for each reader of live data (docs/web.md).

Reading is open to everybody who reaches the port. Nothing that a reader sends is stored or takes much time. Only a
paired device may write (`own_pages.py`, `commands.py`).
"""

import asyncio
import functools
import hashlib
import json
import os
import pathlib
import socket
import ssl
import time
from typing import Any, Awaitable, Callable, Dict, FrozenSet, Iterable, List, Mapping, Optional, Set, Tuple, Type

from tornado import web

from roah_rsbb.document.calls import Call
from roah_rsbb.model.actions import EVERY, MARK
from roah_rsbb.web.commands import Command, CommandHandler, Outcome
from roah_rsbb.web.device_documents import Absent, Desk
from roah_rsbb.web.displays import PAGES as DISPLAYS
from roah_rsbb.web.displays import Display, Displays, DisplaysHandler, LogoHandler, Setting
from roah_rsbb.web.limits import Places, Rates
from roah_rsbb.web.numbered import Made, report_once
from roah_rsbb.web.own_pages import OfDevice, PairHandler, PairingsHandler, SessionHandler
from roah_rsbb.web.pairing import Codes, DeviceSession, Guesses, Sessions
from roah_rsbb.web.public_documents import DATA, Store
from roah_rsbb.web.readers import DeviceEventsHandler, EventsHandler, Reader, StopEventsHandler
from roah_rsbb.web.replays import ReplayHandler
from roah_rsbb.web.serving import (
    MAX_MESSAGE_BYTES,
    BoundedServer,
    EncryptedServer,
    FileHandler,
    Guarded,
    bind,
    policy,
    set_headers,
)
from roah_rsbb.web.teams import CODE, CodesHandler, ProtestHandler, TeamCodes, TeamHandler, TeamSheetHandler
from roah_rsbb.wording.device import TOO_MANY_TEAM_GUESSES
from roah_rsbb.wording.language import tr
from roah_rsbb.wording.public import FIRST_PAGE, NO_PAGE, NO_SCRIPT
from roah_rsbb.wording.sheets import role_word

# They have STOP, and one script. Others have STOP on a paired device, which may come to them in a run.
PAGES_WITH_STOP = ("referee", "box")
PAGE_WITHOUT_STOP = "overlay"  # part of a picture
# Classes of a page besides its name: of the whole box, also those of the page that it consists of.
_KINDS = {"box": " device referee"}
# The style sheets of a page, besides that of STOP where a paired device gets it.
_PARTS = ("tokens", "dark", "parts")
_PUBLIC = (*_PARTS, "public")
_STYLES: Dict[str, Tuple[str, ...]] = {
    **dict.fromkeys(("index", "pair", "displays", "codes"), _PUBLIC), "team": (*_PUBLIC, "captain"),
    **dict.fromkeys(DISPLAYS, (*_PUBLIC, "display")),
    "referee": (*_PARTS, "referee", "captain"), "box": (*_PARTS, "referee", "captain", "box"),
}
# What is for a hall or a picture is always dark.
_MEDIA = {"dark": ' media="(prefers-color-scheme: dark)"'}
# What makes a page one that a phone can install.
_INSTALLED = ('<link rel="manifest" href="/assets/manifest.json">',
              '<link rel="apple-touch-icon" href="/assets/icon-192.png">')
# Files that a page needs, besides texts such as licences.
_NEEDED = (".js", ".css", ".svg", ".woff2", ".json", ".png")
PAGES_OF_DEVICES = ("pair", *PAGES_WITH_STOP, "displays", "codes")
PAGES = (*DISPLAYS, *PAGES_OF_DEVICES)
# A device that scores makes some requests a second. A crowd behind the same address has other limits.
REQUESTS_OF_DEVICE_A_SECOND, REQUESTS_OF_DEVICE_AT_ONCE = 20.0, 100.0
MAX_DEVICES = 400  # connections: each has one for STOP alone
# Why a WebSocket is closed.
NOT_PAIRED = 4401
# How often readers get the clock. Pages report silence after three of these periods.
BEAT_S = 1.0
# How often the server checks for its readers whether the core is silent, and counts the clocks that devices show.
LOOK_S = 0.1
_PING_S = 20.0

_OPEN_TO_READ = {
    "Access-Control-Allow-Origin": "*",
    "Access-Control-Allow-Methods": "GET, HEAD, OPTIONS",
    "Access-Control-Allow-Headers": "If-None-Match",
    "Access-Control-Expose-Headers": "ETag",
}


class WebServer:
    """Serves the documents of a store, and what paired devices are shown of its box. Call all methods in the thread of
    the asyncio loop."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, store: Store, folder: str, names: FrozenSet[str],
        sessions: Optional[Sessions] = None, command: Optional[Callable[[Command], Awaitable[Outcome]]] = None,
        context: Optional[ssl.SSLContext] = None,
        displays: Optional[Displays] = None, team_codes: Optional[TeamCodes] = None, team_pages: str = CODE,
        calls: Optional[Mapping[str, Call]] = None, log_dir: str = "",
    ) -> None:
        """`folder`: the files of the pages; `names`: of this computer (`limits.own_names`).

        `sessions`: the paired devices; None: they are forgotten at the end. `command` carries commands out; None:
        there is no answer.
        `context`: the certificate; None: nothing is encrypted.
        `displays`: what organisers have set for them, `team_codes`: of the teams; None: forgotten at the end.
        `calls`: those of the gateway, for organisers.
        `team_pages`: who sees what the box knows of a team's robot: `all`, or who has the team's `code`.
        `log_dir`: has the journal, for replays; empty: there are none.
        """
        self._loop = loop
        self.store = store
        self.names = names
        self.rates = Rates()
        self.codes = Codes()
        self.sessions = sessions or Sessions(lambda records: None)
        self.desk = Desk(store, self.people, self._absent)
        self.team_codes = team_codes or TeamCodes(lambda secret: None, {})
        self.team_pages = team_pages
        self.team_guesses = Guesses(TOO_MANY_TEAM_GUESSES)
        self.displays = displays or Displays(lambda records: None, {})
        self.command = command or _no_answer
        self.calls = calls or {}
        self.log_dir, self.is_replaying = log_dir, False
        self.device_rates = Rates(REQUESTS_OF_DEVICE_A_SECOND, REQUESTS_OF_DEVICE_AT_ONCE)
        self.devices: Places[Reader] = Places(
            lambda device: device.close(1013, "too many devices"), MAX_DEVICES)
        self.viewers: Places[Reader] = Places(
            lambda viewer: viewer.close(1013, "too many readers of this address"))
        self._was_heard = False
        self._beat_due_mono = float("-inf")
        self._timer: Optional[asyncio.TimerHandle] = None
        self._listening: List[socket.socket] = []
        shared = {"server": self}
        application = web.Application(
            [(rf"/{path}", handler, {**shared, **more}) for path, handler, more in _routes(folder)],
            compress_response=True,
            websocket_max_message_size=MAX_MESSAGE_BYTES, websocket_ping_interval=_PING_S,
            default_handler_class=MissingHandler, default_handler_args={**shared, "folder": pathlib.Path(folder)},
            log_function=lambda handler: None,
        )
        if context is None:
            self._http = BoundedServer(application)
        else:
            plain = BoundedServer(web.Application([(r".*", PlainHandler, shared)], log_function=lambda handler: None))
            self._http = EncryptedServer(application, context=context, plain=plain)

    def open(self, host: str, port: int) -> int:
        """Start serving (port 0: any free port); returns the port. Raises `ServeError`, whose text names the remedy."""
        self._listening = bind(host, port, "the web pages", "web")
        self._http.add_sockets(self._listening)
        self._look()
        return self._listening[0].getsockname()[1]

    def close(self) -> None:
        """Stop serving. Has no effect if it is closed already."""
        if self._timer is not None:
            self._timer.cancel()
        for viewer in (*self.viewers, *self.devices):
            viewer.close()
        self._http.stop()
        self._listening = []

    def publish(self) -> None:
        """Send what has changed to all readers, first to those who act on it."""
        self._send_changes((*self.devices, *self.viewers))

    def follow(self) -> None:
        """Send what has changed in the box, or only with its clocks. Call it when the box has changed."""
        self._follow_for_devices()
        if self.store.look():
            self.publish()

    def _follow_for_devices(self) -> None:
        if self.desk.look():
            self._send_changes(self.devices)

    def _send_changes(self, readers: Iterable[Reader]) -> None:
        self._to_each(readers, lambda viewer, made: viewer.send_next(self.now(), made))

    def _to_each(self, readers: Iterable[Reader], send: Callable[[Reader, Made], None]) -> None:
        """Send something to readers. A fault of one costs it one message: it notices, and begins again."""
        made: Made = {}
        for viewer in tuple(readers):
            try:
                send(viewer, made)
            except Exception as error:
                report_once("A reader of the web pages misses a message", error)

    def now(self) -> float:
        """Return the monotonic time in seconds."""
        return self._loop.time()

    @staticmethod
    def utc() -> float:
        """Return UTC seconds of this computer, for what outlives the process."""
        return time.time()

    def revoke(self, session_id: str) -> List[DeviceSession]:
        """End the pairing of a device; empty: of all. Returns which were ended: see `Sessions.revoke`."""
        ended = self.sessions.revoke(session_id)
        self._close_unpaired()
        return ended

    def _close_unpaired(self) -> None:
        paired = {session.id for session in self.sessions.listed(self.utc())}
        for device in self.devices:
            if device.session_id not in paired:
                device.close(NOT_PAIRED, "this device is not paired any more")

    def devices_changed(self) -> None:
        """Make documents only for what devices show."""
        self.desk.show(device.key for device in self.devices if device.key is not None)

    def display_opened(self, window: Reader, display: Display) -> bool:
        """Note that a display was opened; returns whether the organiser can set what it shows."""
        is_listed = self.displays.add(window, display)
        if is_listed:
            self._put_display(display.id)
        return is_listed

    def display_closed(self, window: Reader) -> None:
        """Note that a page was closed, which may have been a display."""
        closed = self.displays.remove(window)
        if closed is not None:
            self.store.drop_display(closed)

    def set_display(self, display_id: str, setting: Setting) -> None:
        """Set what a display shows; raises as `Displays.set` does."""
        self.displays.set(display_id, setting)
        if display_id in self.displays.ids():
            self._put_display(display_id)
            self.publish()

    def show_display_names(self) -> None:
        """Let all displays show their names for a moment."""
        until = self.displays.show_names(self.now())
        self._put_displays()
        self._loop.call_at(until, self._put_displays)

    def _put_displays(self) -> None:
        for display_id in self.displays.ids():
            self._put_display(display_id)
        self.publish()

    def _put_display(self, display_id: str) -> None:
        setting = self.displays.setting(display_id)
        self.store.put_display(display_id, {
            "zone": setting.zone, "show": setting.show, "language": setting.language, "caption": setting.caption,
            "name": self.displays.name(display_id),
            "shows_name": self.displays.are_named(self.now()),
        })

    def people(self) -> List[DeviceSession]:
        """Return the sessions whose devices are connected. An organiser with the page of a zone has that zone."""
        connected = {device.session_id: device.key for device in self.devices if device.key is not None}
        found = [session for session in self.sessions.listed(self.utc()) if session.id in connected]
        return [one if one.grant.zone or len(connected[one.id]) > 2 else one._replace(
            grant=one.grant._replace(zone=connected[one.id][1])) for one in found]

    def connected(self) -> Set[str]:
        """Return the ids of the sessions whose devices are connected."""
        return {device.session_id for device in self.devices}

    def _absent(self, zone: str) -> List[Absent]:
        """Return the devices that may mark in a zone and are not connected."""
        connected = self.connected()
        return [Absent(f"{one.person}, {role_word(one.grant.role)}", one.seen_utc, one.marked_utc)
                for one in self.sessions.listed(self.utc())
                if one.id not in connected and one.grant.allows(zone) and one.grant.role in EVERY[MARK].roles]

    def keep(self, stream: Any) -> None:
        """Note that a connection became a reader, because readers have their own limit."""
        self._http.keep(stream)

    def know(self, stream: Any, address: str) -> None:
        """Note that a connection is that of a paired device."""
        self._http.know(stream, address)

    def _look(self) -> None:
        """Send the clock each second, and at once when the core falls silent or is heard again. Count clocks."""
        self._timer = self._loop.call_later(LOOK_S if self.devices or self.viewers else BEAT_S, self._look)
        if self.devices:
            self._follow_for_devices()
        now = self.now()
        is_heard = self.store.is_heard
        if now < self._beat_due_mono and is_heard == self._was_heard:
            return
        self._was_heard, self._beat_due_mono = is_heard, now + BEAT_S
        self.follow()  # it may be another day
        self._close_unpaired()
        self._to_each((*self.devices, *self.viewers), lambda viewer, made: viewer.beat(now, made))


async def _no_answer(_command: Command) -> Outcome:
    return Outcome(is_known=False)


class PlainHandler(Guarded):
    """Answers requests without TLS where the pages are encrypted."""

    def prepare(self) -> None:
        """Send browsers to the encrypted address. Nothing that they send counts."""
        super().prepare()
        request = self.request
        if request.method not in ("GET", "HEAD") or not request.uri.startswith("/"):
            raise web.HTTPError(403, reason="These pages are encrypted: begin the address with https")
        self.set_header("Cache-Control", "no-store")
        self.redirect(f"https://{request.host}{request.uri}")


class PageHandler(OfDevice):
    """A page. Its parameters are for its script: the server reads only the language."""

    def initialize(self, server: WebServer, folder: pathlib.Path) -> None:
        super().initialize(server)
        self._folder = folder

    def get(self, name: str) -> None:
        """Return the page, with the script that must not be lost on the way. STOP depends on no other script."""
        name = name or "index"
        has_stop = name in PAGES_WITH_STOP or (name != PAGE_WITHOUT_STOP and self.session() is not None)
        script = "referee" if name in PAGES_WITH_STOP else name
        self._finish_page(
            name, (*_STYLES[name][:3], *(("stop",) if has_stop else ()), *_STYLES[name][3:]),
            self._server.store.first_frame if name not in (*PAGES_WITH_STOP, PAGE_WITHOUT_STOP) else str,
            _KINDS.get(name, " device") if name in PAGES_OF_DEVICES else "", "\n  ".join([
                *(f'<link rel="modulepreload" href="/assets/{part}.js">'
                  for part in ("vendor/preact-htm", "live", "parts")),
                f'<script type="module" src="/assets/{script}.js"></script>',
                *(_INSTALLED if name in PAGES_OF_DEVICES else ())]),
            '<script src="/assets/stop.js"></script>' if has_stop else "")

    head = get

    def _finish_page(self, name: str, styles: Iterable[str], first: Callable[[], str], kind: str = "", script: str = "",
                     stop: str = "") -> None:
        """Send a page. `first` returns what it shows until its script has heard the box."""
        again, page = ((self._folder / file).read_text(encoding="utf-8") for file in ("again.js", "page.html"))
        set_headers(self, {"Content-Type": "text/html; charset=utf-8", "Cache-Control": "no-cache",
                           "Content-Security-Policy": policy(self.request, again)})
        store = self._server.store
        language = store.language(self.get_query_argument("language", self.request.headers.get("Accept-Language", "")))
        media = {} if name in DISPLAYS else _MEDIA
        with store.speaking(language):
            self.finish(page.format(
                again=again, name=name, kind=kind, language=language, script=script, stop=stop,
                styles="\n  ".join(
                    f'<link rel="stylesheet" href="/assets/{style}.css"{media.get(style, "")}>' for style in styles),
                layout="" if name in DISPLAYS else 'data-layout="list"', first=first(), no_script=tr(NO_SCRIPT)))


class MissingHandler(PageHandler):
    """Answers all other addresses: people with a page, programs with a line."""

    def prepare(self) -> None:
        """Refuse the request."""
        super().prepare()
        self.set_status(404)
        if "text/html" not in self.request.headers.get("Accept", ""):
            raise web.HTTPError(404)
        self._finish_page("missing", _PUBLIC, lambda: (
            f'<h1>{tr(NO_PAGE)}</h1>\n<p><a class="button next" href="/">{tr(FIRST_PAGE)}</a></p>'))


class WorkerHandler(Guarded):
    """The script that opens the pages of paired devices without a network. It names their files and their version."""

    def initialize(self, server: WebServer, folder: pathlib.Path) -> None:
        super().initialize(server)
        self._folder = folder

    def get(self) -> None:
        """Return it."""
        set_headers(self, {"Content-Type": "text/javascript; charset=utf-8", "Cache-Control": "no-cache"})
        self.finish(worker(self._folder))

    head = get


@functools.lru_cache(1)
def worker(folder: pathlib.Path) -> str:
    """Return the script of `WorkerHandler`. It is read once: the files belong to this version of the box."""
    own = [folder / name for name in ("page.html", "again.js", "worker.js")]
    files = sorted(path for path in (folder / "assets").rglob("*") if path.suffix in _NEEDED)
    digests = [hashlib.sha256(path.read_bytes()).digest() for path in (*own, *files)]
    version = hashlib.sha256(b"".join(digests)).hexdigest()
    paths = [*(f"/{page}" for page in PAGES_WITH_STOP), *(f"/{path.relative_to(folder)}" for path in files)]
    return f"const VERSION = {json.dumps(version)}, FILES = {json.dumps(paths)};\n{own[-1].read_text('utf-8')}"


class SchemaHandler(FileHandler):
    """The JSON Schema of a document or of the messages."""

    def set_extra_headers(self, path: str) -> None:
        set_headers(self, {**_OPEN_TO_READ, "Content-Type": "application/schema+json", "Cache-Control": "max-age=60"})


class DataHandler(Guarded):
    """A document of data. Pages of all sites may read it: it is public."""

    def set_default_headers(self) -> None:
        super().set_default_headers()
        set_headers(self, {**_OPEN_TO_READ, "Cache-Control": "max-age=1"})

    def options(self, _name: str) -> None:
        """Allow pages of other sites to ask."""
        self.set_status(204)

    def get(self, name: str) -> None:
        """Return the document, or 304 if it has not changed. The clock in it is no change."""
        store = self._server.store
        number, is_heard = store.document((name, "")).number, store.is_heard
        self.set_header("Etag", f'W/"{store.session}-{number}-{int(is_heard)}"')
        if self.check_etag_header():
            self.set_status(304)
            self.finish()
            return
        self.set_header("Content-Type", "application/json; charset=utf-8")
        self.finish(store.answer(name))

    head = get

    def compute_etag(self) -> Optional[str]:
        """Keep the ETag that `get` has set."""
        return None


def _routes(folder: str) -> List[Tuple[str, Type[web.RequestHandler], Dict[str, Any]]]:
    """Return the handler of each address, with what it needs. `folder`: the files of the pages."""
    page = {"folder": pathlib.Path(folder)}
    return [
        *((rf"api/v1/{path}", handler, {}) for path, handler in (
            (f"({'|'.join(DATA)})", DataHandler), ("events", EventsHandler), ("device", DeviceEventsHandler),
            ("stop", StopEventsHandler), ("commands/([a-z_]+)", CommandHandler), ("pair", PairHandler),
            ("session", SessionHandler), ("pairings", PairingsHandler), ("displays", DisplaysHandler),
            ("codes", CodesHandler), ("teams/([^/]+)", TeamHandler),
            ("teams/([^/]+)/protest", ProtestHandler), ("teams/([^/]+)/sheet", TeamSheetHandler),
        )),
        (r"api/v1/schemas/([a-z]+\.json)", SchemaHandler, {"path": os.path.join(folder, "schemas")}),
        ("worker[.]js", WorkerHandler, page),
        ("assets/(.*)", FileHandler, {"path": os.path.join(folder, "assets")}),
        ("logos/([^/]+)", LogoHandler, {}), ("replay/([^/]+)", ReplayHandler, {}),
        ("()", PageHandler, page), (f"({'|'.join(PAGES)})", PageHandler, page), ("(team)/[^/]+", PageHandler, page),
    ]
