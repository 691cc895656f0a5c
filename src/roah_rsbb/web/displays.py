"""The connected displays, and what the organiser sets for each of them (docs/web.md, "Displays"). No I/O and no clock.

Anybody who reaches the port can open a display, or pretend to be one. So their names are bounded, and the list has a
limit for each address and one for all. Displays that the organiser has set always have a place in it.
"""

import collections
import os
import re
from typing import Any, Callable, Dict, Hashable, Iterable, List, NamedTuple, Optional, Set, Tuple

from roah_rsbb.ground.kept_file import Save, SavedBeside
from roah_rsbb.web.own_pages import OfOrganiser
from roah_rsbb.web.pairing import plain
from roah_rsbb.web.serving import Guarded
from roah_rsbb.wording import device
from roah_rsbb.wording.language import tr

ROTATING, RUN, STANDINGS, SCHEDULE, RESULTS = SHOWS = ("rotating", "run", "standings", "schedule", "results")
# What an overlay shows. Without one of these, it shows the run as soon as there is one.
OVERLAY_SHOWS = ("run", "clock", "results", "caption", "nothing")
PAGES = ("display", "overlay")
MAX_LISTED = 100
MAX_OF_ADDRESS = 20
MAX_WINDOWS = 10  # of one display
MAX_SET = 100
MAX_ZONES = 10
MAX_CAPTION = 120  # characters
# How long displays show their names.
NAMED_S = 10.0
FILE = "web_displays.json"

# A display makes its id itself, at random. Nobody but organisers is shown it.
_ID = re.compile("[0-9a-f]{32}")
_SIZE = re.compile("[1-9][0-9]{0,4}x[1-9][0-9]{0,4}")


class TooMany(Exception):
    """There are too many settings."""


class Setting(NamedTuple):
    """What the organiser has set for a display. None: as the address of its page says."""

    name: str = ""  # empty: the one that the display gives
    zone: Optional[str] = None  # empty: all zones
    show: Optional[str] = None
    language: Optional[str] = None
    caption: str = ""  # text of an overlay's lower third: a name and, after a "|", what it is
    called: str = ""  # the name that the display gave when it was set


# What the organiser sets.
FIELDS = ("name", "zone", "show", "language", "caption")
NOTHING_SET = Setting()


class Display(NamedTuple):
    """A page that is open."""

    id: str
    page: str
    name: str  # as its address says; may be empty
    size: str  # such as 1920x1080; empty: not known
    zones: Tuple[str, ...]  # as its address says; empty: all
    show: str
    language: str
    address: str
    since_utc: float


class DisplayRow(NamedTuple):
    """A line of the organiser's list."""

    id: str
    display: Optional[Display]  # the newest one; None: not connected
    windows: int
    setting: Setting

    @property
    def name(self) -> str:
        """The name of the display; empty: none was given."""
        return self.setting.name or (self.setting.called if self.display is None else self.display.name)


def display_of(asked: Callable[[str], str], zones: Iterable[str], language: str, address: str,
               utc: float) -> Optional[Display]:
    """Read what a page says about itself; None: it is no display. `asked` returns a parameter of its address."""
    page, display_id, size, show = asked("page"), asked("display"), asked("size"), asked("show")
    if page not in PAGES or not _ID.fullmatch(display_id):
        return None
    return Display(
        display_id, page, plain(asked("name")), size if _SIZE.fullmatch(size) else "",
        tuple(plain(zone) for zone in list(zones)[:MAX_ZONES]), show if show in (*SHOWS, *OVERLAY_SHOWS) else ROTATING,
        language, address, utc)


class Displays:
    """All displays."""

    def __init__(self, save: Save, saved: Dict[str, Any]) -> None:
        """`save` keeps the settings and raises OSError; `saved`: what it kept before."""
        self.kept = SavedBeside(save)
        """Changes count at once. Wait for it before you answer."""
        self._settings: Dict[str, Setting] = {key: _setting_of(record) for key, record in saved.items()}
        self._open: Dict[Hashable, Display] = {}  # oldest first
        self._named_until = float("-inf")
        self._unlisted: Set[Hashable] = set()  # windows that found no place

    def add(self, window: Hashable, display: Display) -> bool:
        """Note that a display is open; returns whether there is a place for it in the list."""
        windows = [one for one in self._open.values() if one.id == display.id]
        ids = {one.id: one.address for one in self._open.values()}
        crowded = collections.Counter(ids.values())[display.address] >= MAX_OF_ADDRESS or len(ids) >= MAX_LISTED
        is_set = display.id in self._settings
        if len(windows) >= MAX_WINDOWS or (not windows and not is_set and crowded):
            self._unlisted.add(window)
            return False
        self._open[window] = display
        return True

    def remove(self, window: Hashable) -> Optional[str]:
        """Note that a window is closed; returns the id of its display if that has no other; None: it has."""
        self._unlisted.discard(window)
        gone = self._open.pop(window, None)
        is_last = gone is not None and all(one.id != gone.id for one in self._open.values())
        return gone.id if is_last else None

    @property
    def unlisted(self) -> int:
        """How many windows are open that found no place."""
        return len(self._unlisted)

    def ids(self) -> List[str]:
        """Return the ids of all displays that are open."""
        return list(dict.fromkeys(one.id for one in self._open.values()))

    def rows(self) -> List[DisplayRow]:
        """Return the organiser's list: by name, then by time."""
        newest = {one.id: one for one in self._open.values()}
        windows = collections.Counter(one.id for one in self._open.values())
        rows = [DisplayRow(key, newest.get(key), windows[key], self._settings.get(key, NOTHING_SET))
                for key in dict.fromkeys([*newest, *self._settings])]
        return sorted(rows, key=lambda row: (
            row.display is None, not row.name, row.name.casefold(),
            0.0 if row.display is None else row.display.since_utc))

    def setting(self, display_id: str) -> Setting:
        """Return what is set for a display."""
        return self._settings.get(display_id, NOTHING_SET)

    def name(self, display_id: str) -> str:
        """Return the name of a display; without one, the beginning of its id."""
        row = next((row for row in self.rows() if row.id == display_id), None)
        return (row.name if row is not None else "") or display_id[:4]

    def set(self, display_id: str, setting: Setting) -> None:
        """Set what a display shows; `NOTHING_SET`: take it back. Raises `TooMany`, or KeyError: there is no such
        display."""
        is_set = display_id in self._settings
        if not is_set and display_id not in self.ids():
            raise KeyError(display_id)
        if setting == NOTHING_SET:
            self._settings.pop(display_id, None)
        elif not is_set and len(self._settings) >= MAX_SET:
            raise TooMany()
        else:
            given = [one.name for one in self._open.values() if one.id == display_id]
            called = given[-1] if given else self.setting(display_id).called
            self._settings[display_id] = setting._replace(called=called)
        self.kept.keep({key: _record(one) for key, one in self._settings.items()})

    def show_names(self, mono: float) -> float:
        """Let all displays show their names for a moment; returns until when."""
        self._named_until = mono + NAMED_S
        return self._named_until

    def are_named(self, mono: float) -> bool:
        """Whether displays show their names now."""
        return mono < self._named_until


def setting_of(body: Dict[str, Any], languages: Iterable[str]) -> Setting:
    """Read a setting of the organiser; raises ValueError. A field that is missing or null is not set."""
    name, zone, show, language, caption = given = tuple(body.get(field) for field in FIELDS)
    if any(value is not None and not isinstance(value, str) for value in given):
        raise ValueError("A field has the wrong type")
    if show not in (None, *SHOWS, *OVERLAY_SHOWS) or language not in (None, *languages):
        raise ValueError("A display cannot show that")
    if zone is not None and len(zone) > 200:
        raise ValueError("zone is too long")
    return Setting(plain(name or ""), zone, show, language, plain(caption or "", MAX_CAPTION))


def _record(setting: Setting) -> Dict[str, Any]:
    return {name: value for name, value in setting._asdict().items() if value not in (None, "") or name == "zone"}


def _setting_of(record: Dict[str, Any]) -> Setting:
    """Read a saved setting; raises ValueError, TypeError or AttributeError."""
    language = record.get("language")
    setting = setting_of(record, [language] if isinstance(language, str) else [])
    return setting._replace(called=plain(record.get("called", "")))


TYPES = {".png": "image/png", ".jpg": "image/jpeg", ".svg": "image/svg+xml"}
MAX_LOGOS = 200
MAX_BYTES = 1_000_000


def read_logos(folder: str, report: Callable[[str], None]) -> Dict[str, str]:
    """Return the paths of the logos by team. `report` is called for each file that cannot be used."""
    found: Dict[str, str] = {}
    try:
        names = sorted(os.listdir(folder)) if folder else []
    except OSError as error:
        report(f"cannot read the logos of the teams in web_logos ({error}): correct web_logos")
        return found
    for name in names:
        team, kind = os.path.splitext(name)
        path = os.path.join(folder, name)
        if kind.lower() not in TYPES or not os.path.isfile(path):
            continue
        if os.path.dirname(os.path.realpath(path)) != os.path.realpath(folder):
            report(f"the logo {path} is not shown: it is a link to a file outside of web_logos. Copy the file")
            continue
        if os.path.getsize(path) > MAX_BYTES:
            report(f"the logo {path} is not shown: it has more than 1 MB")
        elif len(found) < MAX_LOGOS:
            found[team] = os.path.realpath(path)
    return found


class LogoHandler(Guarded):
    """The logo of a team."""

    def get(self, team: str) -> None:
        """Return the picture. Only files that were found at the start are served."""
        path = self._server.store.logos.get(team, "")
        try:
            with open(os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0)), "rb") as file:
                content = file.read(MAX_BYTES)
        except OSError:
            self.send_error(404)
            return
        self.set_header("Content-Type", TYPES[os.path.splitext(path)[1].lower()])
        self.set_header("Cache-Control", "max-age=300")
        self.finish(content)


class DisplaysHandler(OfOrganiser):
    """The list of displays."""

    def get(self) -> None:
        """Return the list, and what can be chosen."""
        server = self._server
        self.finish({
            "displays": [_row(row) for row in server.displays.rows()],
            "unlisted": server.displays.unlisted,
            "zones": sorted(server.desk.zones()), "languages": server.store.known_languages(), "shows": SHOWS,
            "overlay_shows": OVERLAY_SHOWS,
            "clock": server.utc(),
        })

    async def post(self) -> None:
        """Change what is set for a display, or let all displays show their names.

        A request has only the fields that change: so two organisers do not undo what the other one sets. With
        `take_back` the page's own address counts again.
        """
        if self.body.get("show_names"):
            self._server.show_display_names()
            self.finish({})
            return
        displays, display_id = self._server.displays, self.text("id")
        with self._server.store.speaking(self.language()):
            try:
                setting = NOTHING_SET if self.body.get("take_back") else setting_of(
                    {**displays.setting(display_id)._asdict(), **self.body.get("setting", {})},
                    self._server.store.known_languages())
                self._server.set_display(display_id, setting)
            except (ValueError, TypeError) as bad:
                self.refuse(400, str(bad))
                return
            except (KeyError, TooMany) as refused:
                self.refuse(409, tr(device.NO_SUCH_DISPLAY if isinstance(refused, KeyError)
                                    else device.TOO_MANY_DISPLAYS))
                return
        try:
            await displays.kept.wait()
            self.finish({})
        except OSError as error:
            with self._server.store.speaking(self.language()):
                self.refuse(500, tr(device.SETTING_NOT_SAVED, error=error))


def _row(row: DisplayRow) -> Dict[str, Any]:
    display = row.display
    return {
        "id": row.id, "name": row.name, "windows": row.windows, "setting": row.setting._asdict(),
        "is_set": row.setting != NOTHING_SET,
        "display": None if display is None else {
            "page": display.page, "name": display.name, "address": display.address, "size": display.size,
            "since": display.since_utc, "zones": display.zones, "show": display.show, "language": display.language,
        },
    }
