"""Puts a box together: the core, and the parts that connect it to the network and to the disk.

The core node and the tests' simulator build the same box here. They differ in what they pass: loop, clocks, network,
journal, run logs, and where the other effects go.
"""

import asyncio
import functools
import os
from typing import Callable, Iterable, Mapping, NamedTuple, Optional, Tuple

from roah_rsbb.box.driver import CoreDriver, Outputs, RunLogs
from roah_rsbb.box.fence import Fence, end_superseded, running_s
from roah_rsbb.box.journal import ChannelNotes, CoreJournal, Memory, NoMemory, StopNotes, competition, saved_state
from roah_rsbb.box.standby_answers import StandbyAnswers
from roah_rsbb.comm.channels import MakePeer, Network, Seen
from roah_rsbb.comm.peer import Peer
from roah_rsbb.core.box import Box
from roah_rsbb.core.effects import Level
from roah_rsbb.core.settings import Settings
from roah_rsbb.journal.log_dir import CoreSession, PortRecord, begin_thread
from roah_rsbb.journal.store import Journal
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import say
from roah_rsbb.model.records import Phase
from roah_rsbb.model.results import UnsavedParts
from roah_rsbb.radio.radio import CoreRadio, beacon_size
from roah_rsbb.radio.short_way import Turns
from roah_rsbb.rulebook.benchmarks import Config, ZonePlan
from roah_rsbb.standby.beside_copy import ahead_of, read_stops


class Machine(NamedTuple):
    """What a process knows of its computer and of itself."""

    boot_id: str  # identifies the computer's start, and so its monotonic clock
    pid: int
    uuid: str  # of this start of the core
    mono: Callable[[], float]  # monotonic seconds, as the loop's
    utc: Callable[[], float]  # seconds since 1970
    running_s: Callable[[], float] = running_s  # seconds, also while the computer sleeps
    random_bytes: Callable[[int], bytes] = os.urandom
    seen: Optional[Seen] = None  # see `CoreRadio`
    can_wait: bool = True  # see `Turns`
    begin: Callable[[Callable[[], None]], None] = begin_thread  # runs what may wait for the disk


class BoxPlace(NamedTuple):
    """Where a box is: its folder and its network."""

    log_dir: str
    network: Network
    standby_port: int = 0  # 0: no standby


# The answers to a STOP that is not on the disks yet. It has been sent.
NOT_YET = say("stopped, not yet recorded")
NOT_RECORDED = say("stopped, not yet recorded: {why}")
HANGS = say("the disk of log_dir takes no data. The robot gets STOP all the same. Check the disk")
NOT_WRITTEN = say("the journal cannot be written: {why}. The robot gets STOP all the same. Free or repair the disk of "
                  "log_dir")
NOT_THERE = say("the standby does not have it, because it is not connected. Write the STOP down, and check the standby")

OnText = Callable[[str], None]
# (session, competition, on_trouble): see `Journal`.
OpenJournal = Callable[[CoreSession, str, OnText], Journal]
# (uuid of the box, on_problem, on_repaired): see `RunLogWriter`.
MakeRunLogs = Callable[[str, OnText, Callable[[str, str], None]], RunLogs]


class CoreAssembly:
    """A box with all its parts. Call everything in the loop's thread.

    Call `ask`, then `resume`, then `open`; `each_second` once a second, `driver.event` for all that happens, and at
    last `close`.
    """

    def __init__(
        self, loop: asyncio.AbstractEventLoop, machine: Machine, place: BoxPlace, config: Config, version: int,
        settings: Settings, launch: str, open_journal: OpenJournal, ports: PortRecord, make_run_logs: MakeRunLogs,
        outputs: Outputs, ask_standby: Callable[[int], None], make_peer: MakePeer = Peer,
        end: Callable[[float, str], None] = end_superseded, memory: Optional[Memory] = None,
        inform_standby: Callable[[Mapping[str, str]], object] = lambda stops: None,
    ) -> None:
        """`config` is of this `version` (see `Configuration`). `launch` identifies the launch; empty: none.

        `ask_standby` asks the node that copies the journal: see `StandbyAnswers`. `end`: see `Fence`. `memory` (None:
        there is none) and `inform_standby`: see `StopNotes`. Raises `DamagedJournal` or OSError.
        """
        self._loop, self._machine, self._place = loop, machine, place
        last_port, port_warnings = ports.read()
        self._turns = Turns(loop, machine.mono, machine.utc, machine.can_wait)
        now = self.now()
        session = CoreSession(now.utc, now.mono, machine.boot_id, machine.pid, machine.uuid, launch)
        memory = NoMemory() if memory is None else memory
        self.store = open_journal(session, competition(config), self._on_journal_trouble)
        last_ports = last_port or 0, self.store.previous.last_port or 0
        self.box = box = Box(config, settings, beacon_size, max(last_ports), version)
        self.fence = Fence(
            loop, place.log_dir, self.store.path, place.network.rsbb_host, place.network.bind_host, place.standby_port,
            lambda *by: self.event(lambda now: box.supersede(*by)), lambda text: self.event(box.on_trouble, text),
            machine.running_s, end, make_peer, machine.begin, memory.send)
        self.radio = CoreRadio(
            loop, place.network, box, self._turns, lambda text: outputs.log(Level.WARNING, text), make_peer,
            self.fence.check, machine.random_bytes, machine.seen)
        self.radio.use_passwords(version, config.passwords)
        self.journal = CoreJournal(box, self.store)
        self._stops, self._channels = StopNotes(memory, inform_standby, machine.boot_id), ChannelNotes(memory)
        self.run_logs = make_run_logs(machine.uuid, self._on_log_trouble, self._on_log_repaired)
        self.driver = CoreDriver(loop, box, self.radio, self.run_logs, ports, self.journal, outputs, self.now,
                                 self.fence.check, self._stops.sent, self._stops.starts)
        self.standby = StandbyAnswers(loop, box, self.now, self.event, ask_standby, lambda: self.store.committed)
        self.radio.on_channels = self._note_channels
        for warning in port_warnings:
            self.event(box.on_notice, warning)
        self._warn_of_journal()

    def now(self) -> Now:
        """The present moment on both clocks, for whatever happens next, or looks at the box."""
        return self._turns.now()

    def event(self, method: Callable[..., object], *arguments: object) -> None:
        """Pass an event to the box, and carry out its effects: see `CoreDriver.event`."""
        self.driver.event(method, *arguments)

    # -- the course of a core -----------------------------------------------------------------------

    async def ask(self) -> None:
        """Wait until it is decided whether this computer is the box."""
        self.fence.open()
        await self.fence.ask()
        if self.fence.by:
            self.box.stay_superseded(self.fence.by)
            self.radio.close()  # or the runs, which are shown, would be sent to their robots

    def resume(
        self, earlier: Callable[[Iterable[int]], Mapping[int, Config]], planned: Tuple[ZonePlan, ...] = ()
    ) -> None:
        """Continue where the core was when it ended, if the journal has its state.

        `earlier` returns those of these versions of the configuration that are no longer in force. `planned`: see
        `Saved`.
        """
        previous, boot_id = self.store.previous, self._machine.boot_id
        ahead = functools.partial(ahead_of, self._place.log_dir, own_boot=boot_id)
        stops = {**read_stops(self._place.log_dir), **self._stops.before()}
        saved, warnings = saved_state(previous, self.now(), boot_id, ahead, stops)
        for warning in warnings:
            self.event(self.box.on_notice, warning)
        self.journal.restore(saved.records)
        versions = {state.version for state in saved.zones.values() if state.has_run}
        saved = saved._replace(earlier=earlier(versions), planned=planned)
        for version, config in saved.earlier.items():
            self.radio.use_passwords(version, config.passwords)
        self.driver.resume(saved)
        self._stops.resumed(self.journal.next_ticket - 1)
        self.store.forget_previous()

    def open(self) -> bool:
        """Do what is due, and begin to hear robots. Returns whether this computer is the box. Raises OSError whose text
        names the remedy."""
        self.driver.tick()
        if self.box.is_superseded:
            return False
        self.radio.open(self.box.listening_left(self.now()))
        self.run_logs.make(self.store.previous.ended_logs)
        return True

    def each_second(self) -> None:
        """Write the link records and waiting data."""
        self.journal.each_second(self.now(), self.radio.unreadable())
        self._warn_of_journal()
        self._stops.look(self.store.saved, lambda: {
            run.identity for run in (*self.box.zones.runs(), *self.box.zones.members()) if run.phase is Phase.RUNNING})
        self._note_channels()

    def _note_channels(self) -> None:
        self._channels.look(self.radio.open_channels())

    def check_earlier(self) -> None:
        """In another thread: warn of damage in the part of the journal that a start does not read."""
        for warning in self.store.earlier_damage():
            self._post(functools.partial(self.event, self.box.on_notice, warning))

    def _warn_of_journal(self) -> None:
        for warning in self.store.take_warnings():
            self.event(self.box.on_notice, warning)

    def why_not_recorded(self, ticket: int) -> str:
        """Return that a STOP is missing on a disk, and why, as far as that is known; empty: it is on all, or will be
        within a moment."""
        is_waiting = self.store.is_waiting(ticket)
        if is_waiting and not self.store.hangs:
            return NOT_YET
        why = HANGS if is_waiting else NOT_WRITTEN(why=self.store.problem) if self.store.problem else ""
        copies = self.box.copies
        if not why and copies.are_two and not copies.is_worth_waiting(self.now()):
            why = NOT_THERE
        return NOT_RECORDED(why=why) if why else ""

    def unsaved(self) -> Tuple[UnsavedParts, ...]:
        """Return the parts of records that are not on all disks yet: see `CoreJournal.unsaved`."""
        return self.journal.unsaved(self.now(), self.standby.saved)

    def use(self, config: Config, version: int) -> None:
        """Prepare the parts around the box for another configuration."""
        self.radio.use_passwords(version, config.passwords)
        self.store.set_competition(competition(config))

    def close(self) -> None:
        """End without informing robots."""
        self.fence.close()
        self.radio.close()
        self.run_logs.stop()
        self.store.close()

    # -- troubles, in any thread --------------------------------------------------------------------

    def _post(self, function: Callable[[], object]) -> None:
        self._loop.call_soon_threadsafe(function)

    def _on_log_trouble(self, text: str) -> None:
        self._post(lambda: self.event(self.box.on_trouble, text))

    def _on_log_repaired(self, trouble: str, text: str) -> None:
        self._post(lambda: self.event(self.box.on_repaired, trouble, text))

    def _on_journal_trouble(self, text: str) -> None:
        self._post(lambda: self.event(self.box.on_journal, text))
