"""The web gateway with a box that the test plays: real pages, real requests, no core.

So a test can show a phone any state of any number of zones at once.
"""

import asyncio
import itertools
import pathlib
import threading
from typing import Any, Callable, Dict, List, Optional, Tuple

from helpers.commands import actions_shown
from helpers.forms import shown_form
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import BoxSeen, Document
from roah_rsbb.model.fields import form_of
from roah_rsbb.model.modules import form_of_one
from roah_rsbb.model.zone import Count, Event, RobotInRun, RunClock, SheetItem, ZoneSeen
from roah_rsbb.web.commands import Command, Outcome
from roah_rsbb.web.own_pages import COOKIE
from roah_rsbb.web.pairing import Grant
from roah_rsbb.web.public_documents import Store
from roah_rsbb.web.server import WebServer
from roah_rsbb.wording import language
from support.browser import Browser, Page
from support.robots import RSBB_PORT
from support.waiting import LIMIT_S, happened, wait_until

ROOT = pathlib.Path(__file__).resolve().parents[4]
PORT = RSBB_PORT + 96
URL = f"http://127.0.0.1:{PORT}"
TICK_S = 0.1
NOW = 1_450_000_000.0
EVENT = Event("e1", "HCFGAC", "Task Benchmark 3", "Catering for Granny Annie's Comfort", "Delta", 1, 2, NOW)
ITEMS = [("Achievements", "Enters Annie's room", "bool"),
         ("Achievements", "Operates the right device of all those that Annie has asked for", "uint"),
         ("Penalized Behaviors", "Bumps into the furniture", "uint")]
NAMES = ("Home A", "Home B", "Hall", "Room 4", "Room 5", "Room 6", "Room 7", "Room 8", "Room 9", "Room 10", "Room 11",
         "Room 12")
NOT_RUNNING = {"idle": "No run is connected, so there is nothing to stop",
               "connected": "The run is not started: disconnect to leave it",
               "ended": "The run is over: disconnect to leave it"}
# After a stop that the robot did not answer: why STOP is off, and the warning.
NO_ANSWER = "The run is over, but the robot did not answer STOP: stop it by hand"
IGNORES_STOP = "The robot did not answer STOP: stop it by hand. The box repeats STOP until the disconnect"
LONG = "xx"  # a made-up language whose texts are twice as long


def _longer(text: str, _count: int) -> str:
    """A text of twice the length, in words of usual lengths."""
    return text + "".join(" " if n % 9 == 0 else "ø" for n in range(len(text)))


class PlayedZone:
    """A zone of the box that the test plays."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.phase = "idle"
        self.run = 0
        self.operation = ""
        self.choices: List[str] = []
        self.form: Tuple[Any, ...] = ()  # of the operation, instead of the choices or a text
        self.warning = ""
        self.not_stopped: List[str] = []
        self.stops = True  # whether the robot reports STOP after a stop
        self.end_reason = ""
        self.values = [0] * len(ITEMS)

    @property
    def identity(self) -> str:
        """The run's name; empty: there is none."""
        return "" if self.phase == "idle" else f"{self.name} run {self.run}"

    @property
    def is_moving(self) -> bool:
        """Whether the robot did not answer STOP."""
        return self.phase == "ended" and bool(self.not_stopped)

    def command(self, name: str, fields: Dict[str, Any]) -> None:
        """What the core would do."""
        if name == "connect":
            self.run += 1
            self.phase, self.not_stopped = "connected", []
        elif name == "start":
            self.phase, self.not_stopped = "running", ["R2D2"]
        elif name == "stop" and self.phase == "running" and fields.get("identity") in (None, "", self.identity):
            self.phase, self.operation, self.end_reason = "ended", "", "stopped"
            self.not_stopped = [] if self.stops else ["R2D2"]
        elif name == "disconnect":
            self.phase, self.values, self.not_stopped = "idle", [0] * len(ITEMS), []
        elif name == "operation":
            self.operation = ""
        elif name == "mark":
            index = [desc for _, desc, _ in ITEMS].index(fields["given"]["desc"])
            given = fields["given"]
            self.values[index] = self.values[index] + int(given["added"]) if given.get("added") else given["value"]

    def shown(self) -> ZoneSeen:
        """The zone as the core shows it."""
        off: Dict[str, List[str]] = {}
        if self.phase != "running":
            off["stop"] = [NO_ANSWER if self.is_moving else NOT_RUNNING[self.phase]]
        for name, phase in (("connect", "idle"), ("start", "connected"), ("disconnect", "connected")):
            if self.phase not in (phase, "ended" if name != "connect" else phase):
                off[name] = [f"{name} is not possible in phase {self.phase}"]
        fields = self.form or form_of(form_of_one(self.choices, not self.choices))
        asked = shown_form(7, fields, self.operation) if self.operation else None
        shown = ZoneSeen(
            self.name, EVENT, self.phase, state=("All OK",),
            warnings=tuple(filter(None, [self.is_moving and IGNORES_STOP, self.warning])),
            actions=actions_shown(off, ("continue", "pause", "resume", "next_phase", "previous_phase"), asked=asked),
            clock=RunClock(600.0, Count(10.0 if self.run else 0.0, 0.0 if self.phase == "running" else None)),
            not_stopped=tuple(self.not_stopped), operation=7 if asked else 0, manual_operation=self.operation)
        if self.phase == "idle":
            return shown
        return shown._replace(
            identity=self.identity, end_reason=self.end_reason if self.phase == "ended" else "",
            robot=RobotInRun("R2D2", 6701, "STOP"),
            items=tuple(SheetItem(*item, value) for item, value in zip(ITEMS, self.values)))


class FakeGateway:
    """The gateway. Methods are called by the test's thread; close it at the end."""

    def __init__(self, zones: int = 1, title: str = "") -> None:
        self.title = title
        self._people = itertools.count()
        self.sections: Dict[str, Any] = {}  # of the document, besides the zones
        self.zones = [PlayedZone(name) for name in NAMES[:zones]]
        self.given: List[Tuple[str, str, Dict[str, Any]]] = []  # commands: name, zone, fields
        self.answers = True  # whether commands have an effect and an answer
        self.is_silent = False  # the core is
        self.why = self.successor = ""
        self.document: Optional[Document] = None
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._run, name="gateway", daemon=True)
        self._thread.start()
        self.server: WebServer = self.do(self._open)

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        self._loop.run_forever()

    def do(self, act: Callable[[], Any]) -> Any:
        """Do something in the gateway's thread; returns its result."""
        async def run() -> Any:
            return act()

        return asyncio.run_coroutine_threadsafe(run(), self._loop).result(LIMIT_S)

    def _open(self) -> WebServer:
        languages = {path.stem: language.translation(path.stem, language.read_texts(path))
                     for path in (ROOT / "resource" / "languages").glob("*.ts")}
        store = Store(self, {**languages, LONG: _longer}, self.title)
        self.server = WebServer(self._loop, store, str(ROOT / "resource" / "web"), frozenset(), command=self._command)
        self.server.open("127.0.0.1", PORT)
        self._tick()
        return self.server

    def close(self) -> None:
        """End it. Has no effect if it has ended."""
        async def end() -> None:
            self._timer.cancel()
            self.server.close()
            await asyncio.sleep(TICK_S)  # the connections end
            others = asyncio.all_tasks() - {asyncio.current_task()}
            for task in others:
                task.cancel()
            await asyncio.gather(*others, return_exceptions=True)
            self._loop.stop()

        if self._thread.is_alive():
            asyncio.run_coroutine_threadsafe(end(), self._loop)
            self._thread.join(LIMIT_S)
            self._loop.close()

    def zone(self, name: str) -> PlayedZone:
        """A zone."""
        return next(zone for zone in self.zones if zone.name == name)

    def set(self, **of_zones: Any) -> None:
        """Set this of all zones."""
        def change() -> None:
            for zone in self.zones:
                # Another run: the STOP of one that is over may arrive once more.
                zone.run += zone.phase == "ended" and of_zones.get("phase") == "running"
                for name, value in of_zones.items():
                    setattr(zone, name, value)
                if zone.phase != "idle" and not zone.run:
                    zone.run = 1
            self.feed()

        self.do(change)

    @property
    def is_old(self) -> bool:
        """Whether the core is silent."""
        return self.is_silent

    def now(self) -> Now:
        """The box's clocks. No time passes for runs."""
        return Now(0.0, NOW + self._loop.time())

    def feed(self) -> None:
        """Publish what the core would, in the gateway's thread."""
        if not self.is_silent:
            zones = {zone.name: zone.shown() for zone in self.zones}
            shown = dict.fromkeys([*zones, *self.sections.get("public_runs", {})])
            box = BoxSeen("played", "", 0, zones=tuple(shown), superseded_by=self.successor)
            self.document = Document(box, {}, zones, {}, {}, {}, **self.sections)
            self.server.follow()

    def _tick(self) -> None:
        self._timer = self._loop.call_later(TICK_S, self._tick)
        self.feed()

    async def _command(self, command: Command) -> Outcome:
        self.given.append((command.name, command.zone, command.fields))
        happened()
        if not self.answers:
            return Outcome(is_known=False)
        self.zone(command.zone).command(command.name, command.fields)
        self._loop.call_soon(self.feed)
        return Outcome(result={"number": len(self.given)})

    def wait_given(self, name: str, zone: str) -> None:
        """Wait until a device has given a command."""
        wait_until(lambda: any(given[:2] == (name, zone) for given in self.given),
                   lambda: f"{name} {zone}: {self.given}")

    def count(self, name: str) -> int:
        """How often a command was given."""
        return sum(given[0] == name for given in self.given)

    def phone(self, browser: Browser, size: Tuple[int, int], language: str = "en", zone: Optional[str] = None,
              role: str = "") -> Page:
        """A paired phone that shows the referee's page; `zone`: of its pairing, "" is an organiser's."""
        zone = (self.zones[0].name if len(self.zones) == 1 else "") if zone is None else zone
        grant = Grant(role or ("referee" if zone else "organiser"), zone)
        page = self.paired(browser, f"/referee?language={language}", size, grant)
        page.wait("document.querySelector('.run') !== null", "the zone is shown")
        return page

    def paired(self, browser: Browser, address: str, size: Tuple[int, int], grant: Grant) -> Page:
        """A page of a paired device."""
        person = f"Anna {next(self._people)}"
        token = self.do(lambda: self.server.sessions.add(self.server.utc(), grant, person, "Linux"))
        page = browser.page("about:blank", *size, is_alone=True)
        page.command("Network.setCookie", name=COOKIE, value=token, url=URL)
        page.open(URL + address)
        return page
