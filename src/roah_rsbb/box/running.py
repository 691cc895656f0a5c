"""A box that runs: its configuration, the core with its parts, and the door, from the parameters to the end.

`BoxProgram` (`program/program.py`) has it, and all that is around it: `Peripherals`.
"""

import asyncio
import functools
import gc
import logging
import os
import shlex
import stat
import sys
import threading
import time
import uuid
from typing import Callable, List, NamedTuple, Optional, Sequence

from roah_rsbb.box.assembly import BoxPlace, CoreAssembly, Machine
from roah_rsbb.box.calls import BoxCalls, Disks
from roah_rsbb.box.configuration import Configuration, Content, Reloads
from roah_rsbb.box.copy_calls import CopyCalls
from roah_rsbb.box.door import BoxDoor
from roah_rsbb.box.driver import Outputs
from roah_rsbb.box.parameters import BoxParameters
from roah_rsbb.comm.channels import MakePeer
from roah_rsbb.comm.complaints import OnceASecond
from roah_rsbb.comm.peer import Peer
from roah_rsbb.comm.sender import on_grid
from roah_rsbb.core.copies import NO_PORT
from roah_rsbb.core.effects import Level, SetDevice
from roah_rsbb.ground.linux import boot_id
from roah_rsbb.ground.loop import call_in_loop
from roah_rsbb.ground.params import BadParams
from roah_rsbb.ground.signs_of_life import Lifeline
from roah_rsbb.journal.log_dir import Lock, PortRecord, Resume
from roah_rsbb.journal.store import Journal
from roah_rsbb.model.clock import Now
from roah_rsbb.rulebook.benchmarks import Config, Durable
from roah_rsbb.run_logs.writer import RunLogWriter

# Seconds between signs of life, and between looks at what only time changes.
PERIOD_S = 0.2
SECOND_S = 1.0
# After which the loop's thread gets Python's lock from another thread. Usual are 0.005: too long for STOP.
SWITCH_S = 0.0005

_LEVELS = {Level.INFO: logging.INFO, Level.WARNING: logging.WARNING, Level.ERROR: logging.ERROR}
_log = logging.getLogger(__name__)


class Peripherals(NamedTuple):
    """What a box controls outside of itself. Everything is called in the loop's thread."""

    ring_timeout: Callable[[], None]  # a run timed out
    publish_module_runs: Callable[[], None]  # for the benchmarking modules
    set_device: Callable[[SetDevice], None]
    make_peer: MakePeer = Peer


class RunningBox:
    """A box. Call everything in the loop's thread: `ask`, then `start`, then `close`."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, params: BoxParameters, launch: str, lock: Optional[Lock],
        peripherals: Peripherals, lifeline: Lifeline,
    ) -> None:
        """`launch` identifies the launch; empty: none. `lock`: of the journal (see `wait_for_journal`). `lifeline`:
        to the supervisor. Raises `BadParams`, `ConfigErrors`, `DamagedJournal` or OSError."""
        self._loop, self._params = loop, params
        self._configuration = _configuration(params, launch)
        self.uuid = str(uuid.uuid4())
        """Identity of this start."""
        self._bugs = OnceASecond()
        self._look: Callable[[], Sequence[Callable[[], object]]] = lambda: [self.door.publish]
        self._period_s: Callable[[], float] = lambda: PERIOD_S
        self._door: Optional[BoxDoor] = None
        self._journal_due_mono = 0.0
        outputs = Outputs(
            peripherals.ring_timeout, peripherals.publish_module_runs, peripherals.set_device,
            lambda level, text: _log.log(_LEVELS[level], "%s", text), self._report_bug, self._on_changed)
        self.lifeline = lifeline
        self.core = CoreAssembly(
            loop, Machine(boot_id(), os.getpid(), self.uuid, time.monotonic, time.time),
            BoxPlace(params.log_dir, params.network, params.standby_port), self._configuration.content.config,
            self._configuration.version, params.settings, launch,
            lambda session, events, on_trouble: Journal(
                params.log_dir, session, events, params.resume, on_trouble, lock),
            PortRecord(params.log_dir), functools.partial(RunLogWriter, params.log_dir), outputs,
            lambda ticket: self._copies.ask(ticket), peripherals.make_peer,
            memory=lifeline, inform_standby=lambda stops: self._copies.pass_stops(stops))
        self.box, self.event = self.core.box, self.core.event
        core = self.core
        self.calls = BoxCalls(self.box, self._call, Disks(core.journal.ticket, core.store.why_not_saved,
                                                          core.standby.ask, core.why_not_recorded))
        reload = Reloads(
            self.box, self._configuration, lambda function: call_in_loop(loop, function), self.event, self._use)
        self.door = self._door = BoxDoor(
            loop, self.box, self.uuid, params.network.rsbb_host, core.now, lambda: core.run_logs.files, core.unsaved,
            {**self.calls.named(), "reload": reload.call}, core.fence.check, params.publicity)
        self._copies = CopyCalls(self.uuid, core, self.door)
        self.door.add_calls(self._copies.named())
        for warning in self._configuration.notices:
            self.event(self.box.on_notice, warning)
        self._check_log_dir()
        for place in params.copies:
            self.box.copies.expect(core.now(), place)

    @property
    def config(self) -> Config:
        """The configuration in force."""
        return self._configuration.content.config

    def look(self, look: Callable[[], Sequence[Callable[[], object]]], period_s: Callable[[], float]) -> None:
        """Set what is done in each look, which includes `BoxDoor.publish`, and how long it is until the next one."""
        self._look, self._period_s = look, period_s

    async def ask(self) -> None:
        """Wait until it is decided whether this computer is the box."""
        await self.core.ask()

    def start(self) -> None:
        """Continue where the box was, and begin to hear robots. Raises OSError whose text names the remedy."""
        gc.collect()
        sys.setswitchinterval(SWITCH_S)
        # From here on, robots are heard, and wait for reactions.
        self.core.resume(self._configuration.earlier, self._configuration.before)
        if self.core.open():
            network = self._params.network
            _log.info("Listening on UDP %s:%d, private channels above; log in %s",
                      network.rsbb_host, network.rsbb_port, self._params.log_dir)
        threading.Thread(target=self.core.check_earlier, name="check of the journal", daemon=True).start()
        self._tick()
        # Exclude the present objects from garbage collection: a full collection of them stops the box for about 15 ms.
        gc.freeze()

    def close(self) -> None:
        """End without informing robots. The door is closed before, with whatever says where it is."""
        self.lifeline.end()
        self.core.close()

    def now(self) -> Now:
        """The moment of what is published: nothing leaves after a takeover."""
        self.core.fence.check()
        return self.core.now()

    def _call(self, method: Callable[..., object], *arguments: object) -> None:
        try:
            self.event(method, *arguments)
        finally:
            self.door.called()

    def _on_changed(self) -> None:
        if self._door is not None:
            self._door.changed()

    def _report_bug(self, text: str) -> None:
        self._bugs.count()
        if self._bugs.take(self._loop.time()):
            _log.exception("internal error, please report it: %s", text)

    def _use(self, content: Content, version: int) -> None:
        """Prepare everything outside the box for another configuration."""
        self.core.use(content.config, version)

    def _check_log_dir(self) -> None:
        problem, log_dir = self.core.run_logs.check(), self._params.log_dir
        if problem:
            self.event(self.box.on_trouble, problem)
        elif os.stat(log_dir).st_mode & stat.S_IRWXO:
            _log.warning("%s: other users of this computer can read log_dir; remedy: chmod -R o= %s",
                         log_dir, shlex.quote(log_dir))

    def _tick(self) -> None:
        now_mono, period_s = on_grid(self._loop.time()), self._period_s()
        self._loop.call_at(now_mono + period_s, self._tick)
        self.event(self.box.tick_if_due)
        self.lifeline.send()
        todo: List[Callable[[], object]] = [*self._look()]
        if now_mono > self._journal_due_mono - period_s / 2:
            self._journal_due_mono = now_mono + SECOND_S
            todo.append(self.core.each_second)
        self._do_in_turn(todo)

    def _do_in_turn(self, todo: List[Callable[[], object]]) -> None:
        """Do one thing, and the others in later turns of the loop, so that no datagram waits for all of them."""
        self.core.fence.check()
        try:
            todo[0]()
        finally:
            if todo[1:]:
                self._loop.call_soon(self._do_in_turn, todo[1:])


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
