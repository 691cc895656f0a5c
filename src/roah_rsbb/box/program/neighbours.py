"""The neighbours that a box has in its process, with ROS and without: modules, home devices, sounds, pages."""

import asyncio
import concurrent.futures
import json
import logging
import math
import threading
import time
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Union

from roah_rsbb.bmbox.host.host import chosen_benchmarks
from roah_rsbb.box.door import BoxDoor
from roah_rsbb.box.game import Game
from roah_rsbb.box.program.modules_process import ModulesProcess, modules_command
from roah_rsbb.client.client import TIMEOUT_S, UNANSWERED, Answer, Done, answer_of
from roah_rsbb.comm.channels import MakePeer
from roah_rsbb.comm.peer import Peer
from roah_rsbb.comm.sockets import source_host
from roah_rsbb.core.copies import CopyReport
from roah_rsbb.core.effects import SetDevice
from roah_rsbb.devices.devices import HomeDevices, open_settings
from roah_rsbb.devices.smartif import BadSetting, Home, devices_state
from roah_rsbb.devices.sounds import BELL, TIMEOUT, Sound, command_of
from roah_rsbb.document.calls import COPIED, COPY, COPY_REPORT, PAIR, STOPPED, Call, Caller, InThread
from roah_rsbb.ground.installed import shipped_folder
from roah_rsbb.ground.linux import end_loop
from roah_rsbb.ground.loop import call_in_loop
from roah_rsbb.ground.params import Params
from roah_rsbb.ground.signs_of_life import WEB_PORT, Lifeline
from roah_rsbb.model.actions import ORGANISER, STOP
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document
from roah_rsbb.model.modules import ModulesState
from roah_rsbb.model.reason import Refused, decode
from roah_rsbb.rulebook.registry import BenchmarkKind
from roah_rsbb.tablet.server import TabletPage
from roah_rsbb.web.gateway import Gateway, GatewayHost
from roah_rsbb.wording.whole_box import NO_DEVICES

LEAVE_S = 1.0
NAME = "roah_rsbb"  # of this program, for the box's records
LOOPBACK = "127.0.0.1"
# Any address outside of this computer: nothing is sent to it.
PUBLIC_ADDRESS = "192.0.2.1"
BOX = Caller("box")
MAX_REPORT = 4000  # characters of a report of the program that copies
_MALFORMED = "a malformed message of the program that copies the journal: install the same version there as on the box"

_log = logging.getLogger(__name__)


class DrivenModules:
    """The modules of functionality benchmarks, in a process of their own. It begins when one of them is scheduled."""

    def __init__(self, loop: asyncio.AbstractEventLoop, params: Params, is_dummy: bool = False,
                 program: Sequence[str] = ()) -> None:
        """`is_dummy`: a simulated motion-capture system sees what the rules ask for. `program`: see `modules_command`.
        Raises `BadParams`."""
        folder = params.path("modules_dir")
        self._game: Optional[Game] = None
        self._process = ModulesProcess(
            loop, modules_command(folder, chosen_benchmarks(params, folder), is_dummy, program), self._take_state)
        self._is_started = False

    def start(self, game: Game) -> None:
        """Drive the runs of a box."""
        self._game = game
        self.publish_runs()

    def publish_runs(self) -> None:
        """Hand the runs over that have a module."""
        if self._game is None:
            return
        box = self._game.box
        runs, planned = box.modules.runs(), [event for zone in box.zones.values() for event in zone.planned]
        # After a change of the schedule, there may be a run that is not planned any more.
        if not self._is_started and (
                runs or any(event.benchmark.kind is BenchmarkKind.FUNCTIONALITY for event in planned)):
            self._is_started = True
            self._process.start()
        self._process.take(runs)

    def _take_state(self, state: ModulesState) -> None:
        if self._game is not None:
            self._game.event(self._game.box.modules.on_modules, state)

    def close(self) -> None:
        """End them, if they were started."""
        if self._is_started:
            self._process.close()


class Sounds:
    """The sounds of the bell and of timeouts."""

    def __init__(self, params: Params) -> None:
        """Raises `BadParams`."""
        self._bell = _sound(params, "bell_ring_command", BELL)
        self._timeout = _sound(params, "timeout_ring_command", TIMEOUT)

    def ring_bell(self) -> None:
        """Somebody is at the door."""
        self._bell.ring()

    def ring_timeout(self) -> None:
        """A run timed out."""
        self._timeout.ring()

    def close(self) -> None:
        """End players."""
        self._bell.close()
        self._timeout.close()


def _sound(params: Params, name: str, file: str) -> Sound:
    return Sound(name.partition("_")[0], command_of(params, name, file), lambda text: _log.warning("%s", text))


class ControlledDevices:
    """The home devices, if this box controls them."""

    def __init__(self, loop: asyncio.AbstractEventLoop, params: Params, log_dir: str,
                 on_bell: Callable[[], object], launch: str = "") -> None:
        """`launch`: with another one, all devices are off at first; empty: never. Raises `BadParams`."""
        self._game: Optional[Game] = None
        self.home: Optional[HomeDevices] = None
        """None: this box controls none."""
        self._rings = [on_bell]
        self._follow_state: List[Callable[[Home], object]] = []
        self._follow_status: List[Callable[[bool, str], object]] = []
        host, port = params.text("smartif_host", "192.168.1.56"), params.whole("smartif_port", 6665, 1, 65535)
        if params.flag("devices", False):
            saved, save = open_settings(log_dir, launch)
            self.home = HomeDevices(loop, host, port, on_state=self._on_state, on_bell=self._on_bell,
                                    on_status=self._on_status, saved=saved, save=save)

    def start(self, game: Game, door: BoxDoor) -> None:
        """Connect to the controller."""
        self._game = game
        if self.home is not None:
            door.add_calls(self.home.calls())
            self.home.start()

    def follow(self, on_state: Callable[[Home], object], on_bell: Callable[[], object],
               on_status: Callable[[bool, str], object]) -> None:
        """Call these, too, for what is true now and for all that happens: see `HomeDevices`."""
        assert self.home is not None, "this box has devices"
        self._follow_state.append(on_state)
        self._rings.append(on_bell)
        self._follow_status.append(on_status)
        self.home.report()

    def set(self, wish: SetDevice) -> None:
        """Carry out a robot's command."""
        _log.info("zone %s: the robot sets %s to %d", wish.zone, wish.device, wish.value)
        try:
            if self.home is None:
                raise BadSetting(NO_DEVICES)
            self.home.set(wish.device, wish.value)
        except BadSetting as error:
            assert self._game is not None, "robots are heard after the start"
            self._game.event(self._game.box.devices.on_refused, wish.zone, wish.device, wish.value, str(error))

    def _on_state(self, home: Home) -> None:
        assert self._game is not None, "it was started"
        self._game.event(self._game.box.devices.on_state, devices_state(home))
        for follow in self._follow_state:
            follow(home)

    def _on_bell(self) -> None:
        for ring in self._rings:
            ring()

    def _on_status(self, connected: bool, text: str) -> None:
        assert self._game is not None, "it was started"
        self._game.event(self._game.box.devices.on_status, connected, text)
        for follow in self._follow_status:
            follow(connected, text)

    def close(self) -> None:
        """Disconnect."""
        if self.home is not None:
            self.home.close()


class InProcessClient:
    """What `Client` is over the door, without a connection: the document is that of the box, and nothing is written or
    read. Any thread may use it."""

    why = ""
    """Why there is no connection: there always is one."""

    def __init__(self, door: BoxDoor, box_loop: asyncio.AbstractEventLoop, loop: asyncio.AbstractEventLoop,
                 on_change: Callable[[], object], face: str) -> None:
        """`box_loop`: the loop of the box. `on_change` is called in `loop` when the document has changed, or whether it
        is old. `face`: see `Client`."""
        self._door, self._box_loop, self._loop = door, box_loop, loop
        self._on_change, self._caller = on_change, Caller(face, "this process")

    def start(self) -> None:
        """Begin to follow the document."""
        self._door.on_news = lambda: self._loop.call_soon_threadsafe(self._on_change)

    def close(self) -> None:
        """Follow it no more."""
        self._door.on_news = lambda: None

    @property
    def document(self) -> Optional[Document]:
        """The document, which is never changed but replaced."""
        return self._door.document

    @property
    def is_old(self) -> bool:
        """Whether the document may no longer be true."""
        return self._door.is_old

    @staticmethod
    def now() -> Now:
        """Return the box's clocks, which are those of this process."""
        return Now(time.monotonic(), time.time())

    def call(self, name: str, done: Optional[Done] = None, **arguments: Any) -> "concurrent.futures.Future[Answer]":
        """Make a call. `done` is called in the box's loop with the answer, for which it waits `TIMEOUT_S`."""
        future: concurrent.futures.Future[Answer] = concurrent.futures.Future()
        future.set_running_or_notify_cancel()
        if done is not None:
            future.add_done_callback(lambda ended: done(ended.result()))
        self._box_loop.call_soon_threadsafe(self._ask, name, arguments, future)
        return future

    def stop(self, zone: str, run: str, done: Optional[Done] = None,
             **arguments: Any) -> "concurrent.futures.Future[Answer]":
        """Stop a run, before all calls that wait for their turn; see `Client.stop`."""
        return self.call(STOP, done, zone=zone, run=run, **arguments)

    def _ask(self, name: str, arguments: Any, future: "concurrent.futures.Future[Answer]") -> None:
        def end(answer: Answer) -> None:
            late.cancel()
            if not future.done():
                future.set_result(answer)

        late = self._box_loop.call_later(TIMEOUT_S, end, UNANSWERED)
        self._door.ask(name, arguments, self._caller).add_done_callback(
            lambda asked: end(UNANSWERED if asked.cancelled() else answer_of(asked.result())))


class WebParts:
    """The web pages and the tablet's page, in a thread of their own: whatever their readers send, and however slow the
    disk is that keeps who is paired, the box's loop does not wait."""

    def __init__(self, box_loop: asyncio.AbstractEventLoop, params: Params, door: BoxDoor, lifeline: Lifeline,
                 make_peer: MakePeer = Peer, address: str = "") -> None:
        """`address`: of this computer, for referees; empty: the one that it has in its network. Raises `BadParams`."""
        self._door, self._box_loop, self._loop = door, box_loop, asyncio.new_event_loop()
        self._calls: Mapping[str, Call] = {}
        self.url: concurrent.futures.Future[str] = concurrent.futures.Future()
        """Of the web pages on this computer, once they are served."""
        self.tablet_url: concurrent.futures.Future[str] = concurrent.futures.Future()
        """Of the tablet's page."""
        resource = shipped_folder().parent / "resource"
        address = address or source_host(PUBLIC_ADDRESS) or LOOPBACK
        names = [*params.text("web_names", "").lower().split(), address]
        self._parts: List[Union[Gateway, TabletPage]] = []
        self.has_pages = params.flag("web", False)
        if self.has_pages:
            if not params.text("web_cert", ""):
                lifeline.keep(WEB_PORT, str(params.whole("web_port", 8081, 0, 65535)))
            self._parts.append(Gateway(self._loop, params, GatewayHost(
                resource, NAME, address, self._make_client, self.url.set_result, names)))
        if params.flag("tablet", False):
            self._parts.append(TabletPage(
                self._loop, params, str(resource), names, self.tablet_url.set_result, make_peer))
        params.done()
        self._thread = threading.Thread(target=self._run, name="web pages", daemon=True)

    def _make_client(self, on_change: Callable[[], object], calls: Mapping[str, Call]) -> InProcessClient:
        self._calls = calls
        # Others make them in the box's loop, which does not wait for this thread.
        self._door.add_calls({name: self._in_thread(call) for name, call in calls.items()})
        return InProcessClient(self._door, self._box_loop, self._loop, on_change, "referee")

    def _in_thread(self, call: Call) -> Call:
        def make(arguments: Mapping[str, Any], caller: Caller) -> Any:
            found = call_in_loop(self._loop, lambda: call(arguments, caller))
            return found.make() if isinstance(found, InThread) else found

        return lambda arguments, caller: InThread(lambda: make(arguments, caller))

    def start(self) -> None:
        """Serve as soon as that is possible."""
        self._thread.start()

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)  # tornado serves on the thread's loop
        for part in self._parts:
            self._loop.call_soon(part.start)
        self._loop.run_forever()
        for part in self._parts:
            part.stop()
        end_loop(self._loop)

    def pair_organiser(self) -> str:
        """Return an address that pairs one device as the organiser's. The pages must be served."""
        made = call_in_loop(self._loop, lambda: self._calls[PAIR]({"role": ORGANISER}, Caller(ORGANISER)))
        return str(made["url"])

    def close(self) -> None:
        """Stop serving. A disk that hangs does not delay the end of the box."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join(LEAVE_S)


class CopyCalls:
    """What the box and the program that copies its journal say to each other through the door (docs/door.md). It is a
    process of its own (`standby/program/copying.py`): the box never waits for a copy."""

    def __init__(self, uuid: str, game: Game, door: BoxDoor) -> None:
        """`uuid`: of this start of the box, because its tickets are only its own."""
        self._uuid, self._game, self._door = uuid, game, door

    def named(self) -> Dict[str, Call]:
        """The calls of the program that copies."""
        return {COPY_REPORT: self._report, COPIED: self._copied}

    def ask(self, ticket: int) -> None:
        """Ask whether the standby has everything up to a ticket of the journal. The answer is the call `COPIED`; a
        question is lost if nobody copies."""
        self._door.ask(COPY, {"box": self._uuid, "journal": self._game.store.identity, "ticket": ticket}, BOX)

    def pass_stops(self, stops: Mapping[str, str]) -> None:
        """Pass STOPs that were sent to the standby, before their records are written. Nothing waits for it."""
        self._door.announce(STOPPED, {"stops": dict(stops)}, BOX)

    def _report(self, found: Mapping[str, Any], _caller: Caller) -> None:
        behind_s = found.get("behind_s")
        if len(json.dumps(found)) > MAX_REPORT:
            raise Refused([_MALFORMED])
        place, journal, missing = (_checked(found, name, kind) for name, kind in (
            ("place", str), ("journal", str), ("missing_bytes", int)))
        report = CopyReport(
            place, journal == self._game.store.identity,
            math.inf if behind_s is None else max(0.0, _checked(found, "behind_s", (int, float))), missing,
            *(decode(found[name]) if found.get(name) else "" for name in ("trouble", "notice")))
        self._game.event(self._game.box.copies.report, report)
        self._game.standby.look()

    def _copied(self, found: Mapping[str, Any], _caller: Caller) -> None:
        if _checked(found, "box", str) == self._uuid:
            self._game.standby.on_answer(_checked(found, "ticket", int))


def _checked(found: Mapping[str, Any], name: str, kind: Any) -> Any:
    value = found.get(name)
    if not isinstance(value, kind) or isinstance(value, bool):
        raise Refused([_MALFORMED])
    return value
