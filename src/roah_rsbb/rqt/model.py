"""The newest document of the box, its devices, and the score sheets of its runs, for all panels (docs/architecture.md,
"Panels hold no truth").
"""

import time
from typing import TYPE_CHECKING, Callable, Dict, List, NamedTuple, Optional

from roah_rsbb.client.client import Client
from roah_rsbb.client.places import DoorPlaces
from roah_rsbb.model.as_json import from_json
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import BoxSeen, Document
from roah_rsbb.model.messages import DevicesState
from roah_rsbb.model.results import RunLine, RunSheet
from roah_rsbb.model.zone import RUNNING, ZoneSeen
from roah_rsbb.rqt.calls import CallOutcome, Calls
from roah_rsbb.rqt.qt import QObject, QTimer, QWidget, Signal
from roah_rsbb.wording import times, whole_box
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.times import use_zone
from roah_rsbb.wording.whole_box import REPLAY_NO_COMMANDS

if TYPE_CHECKING:  # it needs ROS
    from roah_rsbb.rqt.node import ControllerStatus, WindowNode

NOT_HEARD = tr_later("Waiting for the box")
TICK_MS = 200
# Interval at which to look for the devices again while the box is silent, seconds.
RENEW_S = 5.0


class Model(QObject):
    """The newest document, whether it is old, and the zone that is shown."""

    updated = Signal()  # the document, its age or the zone that is shown is another one; or news of the devices
    ticked = Signal()  # a moment has passed: for what shows times and silences
    _came = Signal()  # from the client's thread

    def __init__(self, node: "WindowNode", find: Optional[Callable] = None) -> None:
        """`find`: see `Client`; None: where `DoorPlaces` finds it."""
        super().__init__()
        self._zone, self._devices = node.zone, node.devices
        self._is_coming = False
        self._came.connect(self._take)
        self.afar = Client(Document, find or DoorPlaces().find, self._on_change, face="referee")
        self.document: Optional[Document] = None
        self.number = 0  # of the document
        self._stands: Optional[Now] = None  # when the document became old; None: it is not
        self._renewed = time.monotonic()
        self._shown: tuple = ()
        self._timer = QTimer(self, timeout=self._tick)

    def start(self) -> None:
        """Start listening."""
        self.afar.start()
        self._devices.start()
        self._zone.start()
        self._timer.start(TICK_MS)

    def end(self) -> None:
        """Stop listening."""
        self._timer.stop()
        self.afar.close()
        self._devices.stop()
        self._zone.stop()

    # -- for panels ---------------------------------------------------------------------------------

    @property
    def box(self) -> Optional[BoxSeen]:
        """The box itself; None: nothing heard yet."""
        return None if self.document is None else self.document.box

    @property
    def why(self) -> str:
        """Why there is no connection to the box, with the remedy; empty: there is one."""
        return self.afar.why

    @property
    def silence_s(self) -> Optional[float]:
        """Seconds since the core was last heard; None: never heard."""
        return None if self.document is None else self.afar.silence_s

    @property
    def is_old(self) -> bool:
        """Whether the state shown may be out of date."""
        return self.document is None or self.afar.is_old or self.is_superseded

    @property
    def is_superseded(self) -> bool:
        """Whether another box took over from the one that is shown."""
        return self.box is not None and bool(self.box.superseded_by)

    @property
    def is_replay(self) -> bool:
        """Whether the state shown is that of an earlier run, which is replayed."""
        return self.box is not None and self.box.is_replay

    def why_read_only(self, silent: str) -> str:
        """Return why nothing can be changed now; empty: it can. `silent`: the reason if the core is silent."""
        return self.why_old(silent) or (tr(REPLAY_NO_COMMANDS) if self.is_replay else "")

    def why_old(self, silent: str) -> str:
        """Return why the state shown may be out of date; empty: it is not. `silent`: the reason if the core is
        silent."""
        if self.is_superseded:
            return tr(whole_box.SUPERSEDED_NO_COMMANDS)
        return silent if self.is_old else ""

    def is_confirmed(self, number: int) -> bool:
        """Whether the document contains what was done with this number (`CallOutcome.number`)."""
        return self.number >= number

    def now(self) -> Now:
        """Return our estimate of the box's clocks. While the document is old they stand: nobody knows what happens."""
        return self._stands or self.afar.now()

    def box_time(self) -> float:
        """Return our estimate of the box's clock in UTC seconds, also while it is silent; 0.0: it was never heard."""
        return self.afar.now().utc

    @property
    def zone_name(self) -> str:
        """The zone that this client shows: the chosen one, or the first one if none was chosen."""
        return self._zone.value or next(iter(self.zone_names), "")

    @property
    def zone_names(self) -> List[str]:
        """All zones, in the order of the schedule."""
        return [] if self.document is None else list(self.document.box.zones)

    def running_zones(self) -> List[str]:
        """Return the zones that are running."""
        return [name for name in self.zone_names if self.document.zones[name].phase == RUNNING]

    def identity_of(self, zone_name: str) -> str:
        """Return the identity of the run in a zone; empty: none, or not known."""
        zone = self.zone_of(zone_name)
        return "" if zone is None else zone.identity

    @property
    def zone(self) -> Optional[ZoneSeen]:
        """That zone; None: nothing heard yet, or the schedule has no such zone."""
        return self.zone_of(self.zone_name)

    def zone_of(self, zone_name: str) -> Optional[ZoneSeen]:
        """Return a zone; None: not known."""
        return None if self.document is None else self.document.zones.get(zone_name)

    def clock_of(self, zone_name: str) -> Optional[times.Clock]:
        """Return the times of the run in a zone; None: not known."""
        zone = self.zone_of(zone_name)
        return None if zone is None else times.clock_of(zone.clock, zone.phase, self.now().mono)

    def run_of(self, identity: str) -> Optional[RunLine]:
        """Return a run; None: not known."""
        return None if self.document is None else self.document.results.get(identity)

    def runs_of(self, zone_name: str) -> List[RunLine]:
        """Return the runs of a zone: the connected one, then those that are over, the latest first."""
        return [] if self.document is None else [run for run in self.document.runs() if run.zone == zone_name]

    @property
    def devices(self) -> Optional[DevicesState]:
        """The home devices; None: never heard."""
        return self._devices.state

    @property
    def devices_status(self) -> "Optional[ControllerStatus]":
        """Of the devices' controller; None: never heard."""
        return self._devices.status

    @property
    def why_no_devices(self) -> str:
        """Why nothing controls the devices, for the referee; empty: something does."""
        return self._devices.why_missing

    def choose_zone(self, zone_name: str) -> None:
        """Show another zone, in all panels of this client."""
        self._zone.choose(zone_name)
        self._look()

    # -- listening ----------------------------------------------------------------------------------

    def _on_change(self) -> None:
        """In the client's thread: there is news, which the Qt thread takes soon, all of it at once."""
        if not self._is_coming:
            self._is_coming = True
            self._came.emit()

    def _take(self) -> None:
        self._is_coming = False
        self.number, self.document = self.afar.number, self.afar.document  # in this order: it may be newer
        if self.document is not None:
            use_zone(self.document.public.time_zone)
        self._look()

    def _tick(self) -> None:
        self._devices.look()
        if self.afar.is_old and time.monotonic() - max(self.afar.heard_mono, self._renewed) > RENEW_S:
            self._renewed = time.monotonic()
            self._devices.renew()
        self._look()
        self.ticked.emit()

    def _look(self) -> None:
        """Let everything that follows look at what has changed."""
        is_old = self.is_old
        if not is_old:
            self._stands = None
        elif self._stands is None and self.document is not None:
            self._stands = self.afar.now()
        shown = (self.document, self.number, is_old, self.why, self.zone_name, self.devices, self.devices_status,
                 self.why_no_devices)
        if not same(shown, self._shown):
            self._shown = shown
            self.updated.emit()


def same(parts: tuple, before: tuple) -> bool:
    """Whether all parts are the same objects as before. Texts and numbers are compared."""
    return len(parts) == len(before) and all(
        part is old or (part.__class__ in (str, int, bool) and part == old) for part, old in zip(parts, before))


# After a failure it is requested again after this long.
AGAIN_MS = 2000
MAX_KEPT = 20


class _Known(NamedTuple):
    asked_mono: float  # when it was requested
    revision: int  # that the core published then
    sheet: RunSheet


class Sheets:
    """The newest score sheets, by the identities of runs."""

    def __init__(self, owner: QWidget, calls: Calls, news: Callable[[], None]) -> None:
        """`news()` is called when one has arrived for `owner`."""
        self._owner = owner
        self._calls = calls
        self._news = news
        self._known: Dict[str, _Known] = {}
        self._asked: Dict[str, int] = {}  # requested revisions
        self._again = QTimer(owner, singleShot=True, interval=AGAIN_MS, timeout=self._ask_again)

    def newest(self, run: Optional[RunLine]) -> Optional[RunSheet]:
        """Return the known sheet of a run at once, and request a newer one if the core published its revision after it
        was requested. None: no run, or nothing is known."""
        if run is None:
            return None
        identity, revision = run.identity, run.revision
        known = self._known.get(identity)
        if (known is None or known.revision != revision) and self._asked.get(identity) != revision:
            self._asked[identity] = revision
            now = time.monotonic()
            self._calls.call(self._owner, "sheet", lambda outcome: self._on_answer(identity, revision, now, outcome),
                             zone=run.zone, run=identity)
        return None if known is None else known.sheet

    def _ask_again(self) -> None:
        self._asked.clear()
        self._news()

    def _on_answer(self, identity: str, revision: int, asked_mono: float, outcome: CallOutcome) -> None:
        known = self._known.get(identity)
        if known is not None and asked_mono < known.asked_mono:
            return  # a later request was answered first: this answer may be older
        if outcome.error:
            self._again.start()
        else:
            self._known.pop(identity, None)
            self._known[identity] = _Known(asked_mono, revision, from_json(RunSheet, outcome.result))
            while len(self._known) > MAX_KEPT:
                self._known.pop(next(iter(self._known)))
        self._asked = {i: asked for i, asked in self._asked.items() if i in self._known or i == identity}
        self._news()
