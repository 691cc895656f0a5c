"""A whole box in one process, with ROS and without.

Core, radio, door and home devices share a loop. The web pages have a thread of their own (`WebParts`). Only the rules
of benchmarks have another process, because they are code of others (`modules_process.py`).
"""

import asyncio
import contextlib
import functools
import gc
import json
import logging
import os
import pathlib
import shlex
import stat
import sys
import threading
import time
import uuid
from typing import Any, BinaryIO, Callable, Coroutine, List, Optional, Sequence

from roah_rsbb.box.calls import BoxCalls, Disks, exit_call
from roah_rsbb.box.configuration import Configuration, Reloads
from roah_rsbb.box.day_edits import DayEdits
from roah_rsbb.box.door import BoxDoor
from roah_rsbb.box.game import BoxPlace, Game, Machine, Outputs
from roah_rsbb.box.parameters import BoxParameters, parameters_of
from roah_rsbb.box.program.neighbours import LOOPBACK, ControlledDevices, CopyCalls, DrivenModules, Sounds, WebParts
from roah_rsbb.box.program.supervisor import CopyingProcess
from roah_rsbb.box.run_logs import RunLogWriter
from roah_rsbb.box.standing_by import wait_for_journal, wait_for_takeover
from roah_rsbb.client.places import (
    OWN_VARIABLE,
    NotFound,
    door_file_in,
    is_answering,
    local_door_file,
    read_place,
    user_folder,
    write_place,
)
from roah_rsbb.comm.channels import MakePeer, Network
from roah_rsbb.comm.complaints import OnceASecond
from roah_rsbb.comm.peer import Peer
from roah_rsbb.comm.sender import on_grid
from roah_rsbb.comm.sockets import ANY_HOST
from roah_rsbb.core.copies import NO_PORT
from roah_rsbb.core.effects import Level, SetDevice
from roah_rsbb.document.calls import EXIT
from roah_rsbb.ground import linux
from roah_rsbb.ground.linux import boot_id, open_in_browser
from roah_rsbb.ground.loop import call_in_loop
from roah_rsbb.ground.params import BadParams, Params
from roah_rsbb.ground.signs_of_life import DOORS, Lifeline
from roah_rsbb.journal.copy_follower import copy_settings
from roah_rsbb.journal.log_dir import Lock, PortRecord, Resume
from roah_rsbb.journal.store import Journal
from roah_rsbb.model.clock import Now
from roah_rsbb.model.zone import RUNNING
from roah_rsbb.rulebook.benchmarks import Config, Durable
from roah_rsbb.web.pairing import CODE_VALID_S

# Seconds between signs of life, and between looks at what only time changes.
PERIOD_S = 0.2
SECOND_S = 1.0
# After which the loop's thread gets Python's lock from another thread. Usual are 0.005: too long for STOP.
SWITCH_S = 0.0005

_LEVELS = {Level.INFO: logging.INFO, Level.WARNING: logging.WARNING, Level.ERROR: logging.ERROR}
# How often it is checked whether the supervisor is there, and whether the file of the door is.
LOOK_S, DOOR_S = 1.0, 5.0
UNWATCHED = ("The program that watches this box has ended: after a crash, nothing starts the box again. Between two "
             "runs, end the box and start it again")
# Delay of the exit, so that its caller gets the answer.
EXIT_S = 0.2

_log = logging.getLogger(__name__)


class Bridge:
    """What a box has with ROS, besides. This one is that of a box without: nothing. Everything is called in the loop's
    thread."""

    is_there = False
    address = ""  # of this computer, for referees; empty: see `WebParts`
    modules: Sequence[str] = ()  # see `DrivenModules`

    def is_ended(self) -> bool:
        """Whether a box that waits is to end."""
        return False

    def begin(self, program: "BoxProgram") -> None:
        """The box runs."""

    def exit(self) -> Any:
        """Carry out the call `exit`."""

    def ring_timeout(self) -> None:
        """A run timed out."""

    def publish_module_runs(self) -> None:
        """The runs with modules have changed."""

    def set_device(self, wish: SetDevice) -> bool:
        """Carry out a robot's command, for which this box has no devices. Returns whether another program may."""
        return False

    def close(self) -> None:
        """The box ends, and all else has."""


class BoxProgram:
    """The box, from its settings to its end. Call everything in the loop's thread: `start`, then `close`."""

    def __init__(self, loop: asyncio.AbstractEventLoop, settings: Params, launch: str, make_peer: MakePeer = Peer,
                 is_dummy: bool = False, bridge: Optional[Bridge] = None, lifeline: Optional[Lifeline] = None) -> None:
        """`launch`: identifies the supervisor (`resume:=launch`), or the launch. `is_dummy`: a demonstration, see
        `DrivenModules`. `lifeline`: one for any log_dir. Raises `BadParams`, `ConfigErrors`, `DamagedJournal` or
        OSError: their text is the remedy."""
        linux.allow_many_files()
        self._bridge = bridge = bridge or Bridge()
        params = parameters_of(settings)
        self._modules: Optional[DrivenModules] = None
        if settings.flag("modules", False):
            self._modules = DrivenModules(loop, settings, is_dummy, bridge.modules)
        self._sounds = Sounds(settings)
        _make_folder(params.log_dir)
        copying = copy_settings(settings)
        lifeline, self._parent = lifeline or Lifeline(), os.getppid()
        lifeline.use(params.log_dir)

        def is_left() -> bool:
            """Say that this process waits; whether its supervisor is gone, so that nobody waits for it."""
            lifeline.wait()
            return (bool(launch) and os.getppid() != self._parent) or bridge.is_ended()

        wait_for_takeover(params.log_dir, is_left)
        self._port_lock = _lock_port(params.network) if make_peer is Peer and not bridge.is_there else None
        self.devices = ControlledDevices(loop, settings, params.log_dir, self._sounds.ring_bell,
                                         launch if bridge.is_there else "")
        settings.done()
        lock = wait_for_journal(params.log_dir, is_left)
        self._configuration = _configuration(params, launch)
        self.loop, self._params, self.lifeline = loop, params, lifeline
        self.uuid = str(uuid.uuid4())
        """Identity of this start."""
        self._bugs = OnceASecond()
        self._look: Callable[[], Sequence[Callable[[], object]]] = lambda: [self.door.publish]
        self._period_s: Callable[[], float] = lambda: PERIOD_S
        self._journal_due_mono = 0.0
        self.game = game = self._new_game(launch, lock, make_peer)
        self.box, self.event = game.box, game.event
        self.calls = BoxCalls(self.box, self._call, Disks(
            game.journal.ticket, game.store.why_not_saved, game.standby.ask, game.why_not_recorded))
        reload = Reloads(
            self.box, self._configuration, lambda function: call_in_loop(loop, function), self.event, game.use)
        edits = DayEdits(self.box, self._configuration, reload, lambda function: call_in_loop(loop, function),
                         self.event, game.now)
        self.door = BoxDoor(
            loop, self.box, self.uuid, params.network.rsbb_host, game.now, lambda: game.run_logs.files, game.unsaved,
            {**self.calls.named(), "reload": reload.call, **edits.named()}, game.fence.check, params.publicity)
        game.on_changed = self.door.changed
        self._copies = CopyCalls(self.uuid, game, self.door)
        self.door.add_calls(self._copies.named())
        for warning in self._configuration.notices:
            self.event(self.box.watches.notice, warning)
        self._check_log_dir()
        game.expect_copies(params.copies)
        self.web = WebParts(loop, settings, self.door, lifeline, make_peer, bridge.address)
        self._copying = CopyingProcess(lambda: copying)
        self._door_files: List[str] = []
        self.port = 0
        """Of the door."""
        self._tasks: List[asyncio.Task] = []  # a loop does not keep them
        self._is_supervised = lifeline.has_supervisor if bridge.is_there else bool(launch)
        self.on_exit: Callable[[], object] = lambda: None
        """Called when somebody ends the box through its door."""

    def _new_game(self, launch: str, lock: Optional[Lock], make_peer: MakePeer) -> Game:
        params = self._params
        return Game(
            self.loop, Machine(boot_id(), os.getpid(), self.uuid, time.monotonic, time.time, make_peer=make_peer,
                               memory=self.lifeline),
            BoxPlace(params.log_dir, params.network, params.standby_port), self.config, self._configuration.version,
            params.settings, launch,
            lambda session, events, on_trouble: Journal(
                params.log_dir, session, events, params.resume, on_trouble, lock),
            PortRecord(params.log_dir), functools.partial(RunLogWriter, params.log_dir),
            Outputs(self._ring_timeout, self._publish_module_runs, self.set_device,
                    lambda level, text: _log.log(_LEVELS[level], "%s", text), self._report_bug,
                    lambda ticket: self._copies.ask(ticket), lambda stops: self._copies.pass_stops(stops)))

    @property
    def config(self) -> Config:
        """The configuration in force."""
        return self._configuration.content.config

    def look(self, look: Callable[[], Sequence[Callable[[], object]]], period_s: Callable[[], float]) -> None:
        """Set what is done in each look, which includes `BoxDoor.publish`, and how long it is until the next one."""
        self._look, self._period_s = look, period_s

    async def start(self, door_file: str, host: str = LOOPBACK) -> None:
        """Start everything. `door_file`: where this box says how its door is found; empty: there is none. `host`: own
        address of the door."""
        await self.game.ask()
        self._begin()
        self.devices.start(self.game, self.door)
        if self._modules is not None:
            self._modules.start(self.game)
        self.web.start()
        self.keep(self._watch_supervisor(self._parent) if self._is_supervised else self._keep_copying())
        self.door.add_calls({EXIT: exit_call(
            self.door.publish, self._bridge.exit if self._bridge.is_there else self._end_soon)})
        self.port = self.door.open(host)
        self._url = f"ws://{LOOPBACK if host == ANY_HOST else host}:{self.port}/door"
        own = door_file_in(self._params.log_dir)
        self._door_files = [*filter(None, dict.fromkeys((own, door_file)))]
        self.lifeline.keep(DOORS, json.dumps(self._door_files))
        for path in self._door_files:
            problem = self._write_door(path)
            if problem:  # the box has other faces
                _log.error("Other programs cannot find this box: %s cannot be written: %s. Repair that", path, problem)
        self.keep(self._keep_door())
        self._bridge.begin(self)

    def _begin(self) -> None:
        """Continue where the box was, and begin to hear robots. Raises OSError whose text names the remedy."""
        gc.collect()
        sys.setswitchinterval(SWITCH_S)
        # From here on, robots are heard, and wait for reactions.
        self.game.resume(self._configuration.earlier, self._configuration.before)
        if self.game.open():
            network = self._params.network
            _log.info("Listening on UDP %s:%d, private channels above; log in %s",
                      network.rsbb_host, network.rsbb_port, self._params.log_dir)
        threading.Thread(target=self.game.check_earlier, name="check of the journal", daemon=True).start()
        self._tick()
        # Exclude the present objects from garbage collection: a full collection of them stops the box for about 15 ms.
        gc.freeze()

    def close(self) -> None:
        """End everything. Runs continue with the next start."""
        self.lifeline.end()  # whatever follows, it is no core that hangs
        running = [zone.zone for zone in self.door.document.zones.values() if zone.phase == RUNNING]
        if running and not self.box.authority.is_superseded:
            _log.warning("The box ends during a run in %s: its robot is not stopped, and the run continues when the "
                         "box is started again", ", ".join(running))
        files, self._door_files = self._door_files, []  # none is written any more
        for path in files:
            if _is_own(path, self.door.token):
                os.unlink(path)
        self.web.close()
        self.door.close()
        if self._modules is not None:
            self._modules.close()
        self.devices.close()
        self._sounds.close()
        for task in self._tasks:
            task.cancel()
        self.game.close()
        if self._port_lock is not None:
            self._port_lock.close()
        self._bridge.close()
        self._copying.end()

    async def open_pages(self, in_browser: bool) -> bool:
        """Show the organiser the way to the pages once they are served: in a browser, if there is one, and on the
        standard output, because others may read the log. Returns whether a browser was opened."""
        if not self.web.has_pages:
            return False
        await asyncio.wrap_future(self.web.url)
        url = await self.loop.run_in_executor(None, self.web.pair_organiser)
        text = f"To pair this computer or another one as the organiser's, open within {CODE_VALID_S:.0f} s: {url}"
        await self.loop.run_in_executor(None, _print, text)
        return in_browser and open_in_browser(url)

    def _write_door(self, path: str) -> str:
        """Say in a file where the door is, unless it is there; returns what is wrong, or nothing."""
        token = self.door.token
        try:
            if path in self._door_files and not _is_own(path, token):
                write_place(path, self._url, token)
        except OSError as error:
            return str(error.strerror)
        return ""

    async def _keep_door(self) -> None:
        """The disk may have been full at the start: other programs must find the box nevertheless."""
        def write() -> None:
            for number, path in enumerate(self._door_files):
                is_others = number > 0 and not _is_own(path, self.door.token) and is_answering(path)
                if not is_others:
                    self._write_door(path)

        while True:
            await asyncio.sleep(DOOR_S)
            await self.loop.run_in_executor(None, write)

    def keep(self, work: Coroutine[Any, Any, Any]) -> None:
        """Run something until this program ends, such as a robot of a demonstration."""
        self._tasks.append(self.loop.create_task(work))

    def _end_soon(self) -> None:
        self.loop.call_later(EXIT_S, self.on_exit)

    async def _watch_supervisor(self, pid: int) -> None:
        """Warn referees when the process is gone that starts this box again after a crash."""
        while os.getppid() == pid:
            await asyncio.sleep(LOOK_S)
        self.event(self.box.watches.trouble, UNWATCHED)

    async def _keep_copying(self) -> None:
        """Copy the journal; of a box with a supervisor, that one does."""
        while True:
            self._copying.look()
            await asyncio.sleep(LOOK_S)

    def now(self) -> Now:
        """The moment of what is published: nothing leaves after a takeover."""
        self.game.fence.check()
        return self.game.now()

    def _call(self, method: Callable[..., object], *arguments: object) -> None:
        try:
            self.event(method, *arguments)
        finally:
            self.door.called()

    def _report_bug(self, text: str) -> None:
        self._bugs.count()
        if self._bugs.take(self.loop.time()):
            _log.exception("internal error, please report it: %s", text)

    def _check_log_dir(self) -> None:
        problem, log_dir = self.game.run_logs.check(), self._params.log_dir
        if problem:
            self.event(self.box.watches.trouble, problem)
        elif os.stat(log_dir).st_mode & stat.S_IRWXO:
            _log.warning("%s: other users of this computer can read log_dir; remedy: chmod -R o= %s",
                         log_dir, shlex.quote(log_dir))

    def _tick(self) -> None:
        now_mono, period_s = on_grid(self.loop.time()), self._period_s()
        self.loop.call_at(now_mono + period_s, self._tick)
        self.event(self.box.timers.tick_if_due)
        self.lifeline.send()
        todo: List[Callable[[], object]] = [*self._look()]
        if now_mono > self._journal_due_mono - period_s / 2:
            self._journal_due_mono = now_mono + SECOND_S
            todo.append(self.game.each_second)
        self._do_in_turn(todo)

    def _do_in_turn(self, todo: List[Callable[[], object]]) -> None:
        """Do one thing, and the others in later turns of the loop, so that no datagram waits for all of them."""
        self.game.fence.check()
        try:
            todo[0]()
        finally:
            if todo[1:]:
                self.loop.call_soon(self._do_in_turn, todo[1:])

    def ring_bell(self) -> None:
        """Play the sound of the bell."""
        self._sounds.ring_bell()

    def _ring_timeout(self) -> None:
        self._sounds.ring_timeout()
        self._bridge.ring_timeout()

    def _publish_module_runs(self) -> None:
        if self._modules is not None:
            self._modules.publish_runs()
        self._bridge.publish_module_runs()

    def set_device(self, wish: SetDevice) -> None:
        """Carry out a robot's command for a home device."""
        if self.devices.home is not None or not self._bridge.set_device(wish):
            self.devices.set(wish)


def _configuration(params: BoxParameters, launch: str) -> Configuration:
    """Read the configuration. Raises `ConfigErrors` or `BadParams`."""
    found = Configuration(params.log_dir, "" if params.resume is Resume.NEVER else launch, params.files,
                          params.standings_file)
    loaded = found.content.config
    if loaded.durable is Durable.TWO and not params.standby_port:
        raise BadParams(NO_PORT.format(place=loaded.durable_at))
    for warning in found.warnings:
        _log.warning("%s", warning)
    return found


def _print(text: str) -> None:
    with contextlib.suppress(OSError):  # nobody reads the standard output any more
        print(text, flush=True)


def _lock_port(network: Network) -> Optional[BinaryIO]:
    """Keep a second box of this user from the same address and port: neither would hear the other one, and both would
    command the robots. Returns what keeps it until it is closed; None: the user's folder cannot be written. Raises
    `BadParams`."""
    own, others = (f"udp_{host}_{network.rsbb_port}.lock" for host in (
        network.bind_host, "*" if network.bind_host == ANY_HOST else ANY_HOST))
    try:
        os.makedirs(user_folder(), exist_ok=True)
        for path in sorted(pathlib.Path(user_folder()).glob(others)):
            _locked(str(path), network).close()  # of a box at an address that this one has, too
        return _locked(os.path.join(user_folder(), own), network)
    except OSError:
        return None


def _locked(path: str, network: Network) -> BinaryIO:
    """Lock a file; returns it. Raises `BadParams` if another box has it, or OSError."""
    file = open(path, "ab")  # noqa: SIM115
    try:
        linux.lock(file.fileno())
    except BlockingIOError:
        file.close()
        raise BadParams(f"another box of this user is at {network.bind_host}, UDP port {network.rsbb_port}: end it, or "
                        "give this one another rsbb_port, and its robots, too") from None
    except OSError:  # a file system without locks
        pass
    return file


def _make_folder(log_dir: str) -> None:
    """Make the folder of the journal. Raises `BadParams`."""
    try:
        os.makedirs(log_dir, exist_ok=True)
    except OSError as error:
        raise BadParams(f"log_dir {log_dir} cannot be created ({error.strerror}): choose another folder, or let this "
                        "user write there") from None


def door_file(log_dir: str) -> str:
    """Return where a box says how its door is found: in the user's folder, unless another box answers there."""
    usual = local_door_file()
    if OWN_VARIABLE in os.environ or not is_answering(usual):
        return usual
    own = door_file_in(log_dir)
    _log.warning("Another box of this user runs on this computer. Terminals find this one with %s=%s",
                 OWN_VARIABLE, own)
    return own


def _is_own(path: str, token: str) -> bool:
    try:
        return read_place(path).token == token
    except NotFound:
        return False
