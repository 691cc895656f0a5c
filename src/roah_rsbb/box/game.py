"""The game: the core, and the parts that connect it to the network and to the disk, which carry out its effects.

The box program and the tests' simulator build the same game here. They differ in what they pass: loop, clocks, network,
journal, run logs, and where the other effects go. The core makes all decisions; the game only dispatches effects.

Effects of an event leave when the journal's file has its record. While the disk hangs, they wait, in their
order. Only STOP does not wait: it leaves before the record is written, and what still waits for that robot is older
than it, and is dropped. Messages that only acknowledge what a robot said leave at once if nothing waits for this robot.
"""

import asyncio
import functools
import os
from collections import deque
from typing import Callable, Deque, Dict, Iterable, List, Mapping, NamedTuple, Optional, Set, Tuple

from roah_rsbb.box.fence import Fence, end_superseded, running_s
from roah_rsbb.box.journal import ChannelNotes, CoreJournal, Memory, NoMemory, StopNotes, competition, saved_state
from roah_rsbb.box.run_logs import RunLogWriter
from roah_rsbb.box.standby_answers import StandbyAnswers
from roah_rsbb.comm.channels import MakePeer, Network, Seen
from roah_rsbb.comm.peer import Peer
from roah_rsbb.core import effects
from roah_rsbb.core.box import Box
from roah_rsbb.core.copies import STANDBY
from roah_rsbb.core.effects import Effect, Level
from roah_rsbb.core.settings import Settings
from roah_rsbb.journal.log_dir import CoreSession, PortRecord, begin_thread
from roah_rsbb.journal.store import Journal
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import NEVER, BoxMessage, RobotReport
from roah_rsbb.model.reason import say
from roah_rsbb.model.records import EndReason, Phase, RunRecord
from roah_rsbb.model.results import UnsavedParts
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.radio.radio import CoreRadio, beacon_size
from roah_rsbb.radio.short_way import Turns
from roah_rsbb.rulebook.benchmarks import Config, ZonePlan
from roah_rsbb.standby.beside_copy import ahead_of, read_stops
from roah_rsbb.standby.pairing import read_standby
from roah_rsbb.wording.texts import escaped

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
MakeRunLogs = Callable[[str, OnText, Callable[[str, str], None]], RunLogWriter]


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
    make_peer: MakePeer = Peer
    memory: Memory = NoMemory()  # outside of the process: see `StopNotes`
    end: Callable[[float, str], None] = end_superseded  # see `Fence`


class BoxPlace(NamedTuple):
    """Where a box is: its folder and its network."""

    log_dir: str
    network: Network
    standby_port: int = 0  # 0: no standby


class Outputs(NamedTuple):
    """Where effects go that the box's own radio and files do not carry out. Called in the loop's thread."""

    ring_timeout: Callable[[], None]  # a run timed out
    publish_module_runs: Callable[[], None]  # for the benchmarking modules
    set_device: Callable[[effects.SetDevice], None]
    log: Callable[[Level, str], None]  # a line for the program's log
    report_bug: Callable[[str], None]  # within `except`: an internal error, which stops nothing
    ask_standby: Callable[[int], None]  # through the program that copies the journal: see `StandbyAnswers`
    inform_standby: Callable[[Mapping[str, str]], object] = lambda stops: None  # see `StopNotes`


class _Waiting(NamedTuple):
    """Effects of an event whose record is not in the journal's file yet."""

    ticket: int  # of the record; 0: there is none
    moment: Now  # of the event
    effects: List[Effect]


class Game:
    """A box with all its parts. Call everything in the loop's thread.

    Call `ask`, then `resume`, then `open`; `each_second` once a second, `event` for all that happens, and at last
    `close`.
    """

    def __init__(
        self, loop: asyncio.AbstractEventLoop, machine: Machine, place: BoxPlace, config: Config, version: int,
        settings: Settings, launch: str, open_journal: OpenJournal, ports: PortRecord, make_run_logs: MakeRunLogs,
        outputs: Outputs,
    ) -> None:
        """`config` is of this `version` (see `Configuration`). `launch` identifies the launch; empty: none. Raises
        `DamagedJournal` or OSError."""
        self._loop, self._machine, self._place = loop, machine, place
        last_port, port_warnings = ports.read()
        self._turns = Turns(loop, machine.mono, machine.utc, machine.can_wait)
        now = self.now()
        session = CoreSession(now.utc, now.mono, machine.boot_id, machine.pid, machine.uuid, launch)
        self.store = open_journal(session, competition(config), self._on_journal_trouble)
        last_ports = last_port or 0, self.store.previous.last_port or 0
        self.box = box = Box(config, settings, beacon_size, max(last_ports), version)
        self.fence = Fence(
            loop, place.log_dir, self.store.path, place.network.rsbb_host, place.network.bind_host, place.standby_port,
            lambda *by: self.event(lambda now: box.authority.supersede(*by)),
            lambda text: self.event(box.watches.trouble, text),
            machine.running_s, machine.end, machine.make_peer, machine.begin, machine.memory.send)
        self.radio = CoreRadio(
            loop, place.network, box, self._turns, lambda text: outputs.log(Level.WARNING, text), machine.make_peer,
            self.fence.check, machine.random_bytes, machine.seen)
        self.radio.use_passwords(version, config.passwords)
        self.journal = CoreJournal(box, self.store)
        self._stops = StopNotes(machine.memory, outputs.inform_standby, machine.boot_id)
        self._channels = ChannelNotes(machine.memory)
        self.run_logs = make_run_logs(machine.uuid, self._on_log_trouble, self._on_log_repaired)
        self.on_changed: Callable[[], object] = lambda: None
        """Called when something happened in the box: see `Box.happenings`."""
        self._ports, self._outputs = ports, outputs
        self._timer: Optional[asyncio.TimerHandle] = None
        self._carrying_out = self._resuming = False
        self._waiting: Deque[_Waiting] = deque()
        self._beacon_wanted = False
        self._modules_wait = False
        self._unopened: Set[int] = set()  # ports
        self._moment = self.now()  # of the latest event
        self._happenings = box.happenings  # after it
        self.radio.connect(self.event, self.report)
        self.journal.on_written(lambda: self._waiting and loop.call_soon_threadsafe(self._continue))
        self._hands = {
            effects.PortTaken: self._port_taken,
            effects.OpenChannel: self._open_channel,
            effects.AimChannel: lambda e: self.radio.aim(e.port, e.host),
            effects.CloseChannel: lambda e: self.radio.close_channel(e.port),
            effects.SendState: self._send_state,
            effects.SendBeacon: self._want_beacon,
            effects.TimeoutRung: lambda e: outputs.ring_timeout(),
            effects.SetDevice: lambda e: box.authority.is_superseded or outputs.set_device(e),
            effects.RunOpened: self._run_opened,
            effects.RunResumed: self._run_resumed,
            effects.RunClosed: lambda e: self.run_logs.closed(e),
            effects.ModuleRunsChanged: self._want_module_runs,
            effects.Superseded: lambda e: self.radio.close(),
            effects.Notice: self._notice,
            effects.AnotherBox: lambda e: None,  # a referee decides
            # The journal records them.
            **dict.fromkeys((effects.SheetOpened, effects.RecordChanged, effects.Recorded, effects.RunLogged),
                            lambda e: None),
        }
        self.standby = StandbyAnswers(
            loop, box, self.now, self.event, outputs.ask_standby, lambda: self.store.committed)
        self.radio.on_channels = self._note_channels
        for warning in port_warnings:
            self.event(box.watches.notice, warning)
        self._warn_of_journal()

    def now(self) -> Now:
        """The present moment on both clocks, for whatever happens next, or looks at the box."""
        return self._turns.now()

    def expect_copies(self, places: Iterable[str]) -> None:
        """Warn from now on if one of these copies is missing. The computer of a standby that was ever connected may be
        the box, too, and so may that of the box before, whose copy this is."""
        standby = read_standby(self._place.log_dir)
        for place in places:
            self.box.copies.expect(self.now(), place, place == STANDBY and standby is not None and bool(standby.host))

    # -- the course of a core -----------------------------------------------------------------------

    async def ask(self) -> None:
        """Wait until it is decided whether this computer is the box."""
        self.fence.open()
        await self.fence.ask()
        if self.fence.by:
            self.box.authority.stay_superseded(self.fence.by)
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
            self.event(self.box.watches.notice, warning)
        self.journal.restore(saved.records)
        versions = {state.version for state in saved.zones.values() if state.has_run}
        saved = saved._replace(earlier=earlier(versions), planned=planned)
        for version, config in saved.earlier.items():
            self.radio.use_passwords(version, config.passwords)
        self._resuming = True  # robots are sent what they were sent before, which waits for no disk
        try:
            self.event(self.box.restart.resume, saved)
        finally:
            self._resuming = False
        self._stops.resumed(self.journal.next_ticket - 1)
        self.store.forget_previous()

    def open(self) -> bool:
        """Do what is due, and begin to hear robots. Returns whether this computer is the box. Raises OSError whose text
        names the remedy."""
        self.tick()
        if self.box.authority.is_superseded:
            return False
        self.radio.open(self.box.watches.listening_left(self.now()))
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
            self._post(functools.partial(self.event, self.box.watches.notice, warning))

    def _warn_of_journal(self) -> None:
        for warning in self.store.take_warnings():
            self.event(self.box.watches.notice, warning)

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
        self._post(lambda: self.event(self.box.watches.trouble, text))

    def _on_log_repaired(self, trouble: str, text: str) -> None:
        self._post(lambda: self.event(self.box.watches.repaired, trouble, text))

    def _on_journal_trouble(self, text: str) -> None:
        self._post(lambda: self.event(self.box.watches.journal, text))

    # -- events and their effects -------------------------------------------------------------------

    def event(self, method: Callable[..., object], *args: object) -> None:
        """Pass an event to the box, then carry out the effects. Exceptions of the method are raised afterwards."""
        self.fence.check()
        self._moment = self.now()
        try:
            method(self._moment, *args)
        finally:
            self._finish()

    def report(
        self, now: Now, port: int, host: str, report: RobotReport, received_utc: Optional[float],
    ) -> Optional[BoxMessage]:
        """Like `event`, for a robot's report that was read `now`. Returns the message to send to the robot from now on,
        if there is nothing else to do: see `Arrivals.on_robot_report`."""
        self.fence.check()
        self._moment = now
        message = None
        try:
            message = self.box.arrivals.on_robot_report(self._moment, port, host, report, received_utc)
        finally:
            if message is None:
                self._finish()
        # It may have a state that still waits.
        return message if message is not None and port not in self._held() else None

    def _continue(self) -> None:
        """The disk takes data again."""
        self.fence.check()
        self._moment = self.now()  # what was read before is taken before
        self._finish()

    def _finish(self) -> None:
        self._carry_out()
        self._set_timer()
        if self.box.happenings != self._happenings:
            self._happenings = self.box.happenings
            self.on_changed()

    def tick(self) -> None:
        """Run the box's due timers."""
        self.event(self.box.timers.tick)

    def _carry_out(self) -> None:
        if self._carrying_out:
            return  # an effect caused another event, whose effects follow later
        self._carrying_out = True
        notices: List[effects.Notice] = []
        try:
            self._release()
            todo = self.box.outbox.take()
            while todo:
                self.fence.check()
                self._stop(todo)
                notices += [effect for effect in todo if isinstance(effect, effects.Notice)]
                self._hold(self._record(todo), todo)
                self._release()
                todo = self.box.outbox.take()
            if self._beacon_wanted:
                self._beacon_wanted = False
                self.radio.send_beacon()
            if self._modules_wait and not self._waiting:  # they see the box as it is now
                self._modules_wait = False
                self._outputs.publish_module_runs()
        finally:
            self._carrying_out = False
            # Log lines are slow and not urgent, so they come last.
            for notice in notices:
                self._do(notice)

    def _stop(self, todo: List[Effect]) -> None:
        """Send STOP, before anything waits for the disk."""
        ended: Dict[str, RunRecord] = {}
        for effect in todo:
            if isinstance(effect, effects.Superseded):
                self._do(effect)
            if (not isinstance(effect, effects.SendState) or effect.message.state is not BoxState.STOP
                    or not self.radio.is_open(effect.port)):
                continue
            sent = self.radio.sent(effect.port)  # None: after a restart, to a robot that was not heard yet
            for waiting in self._waiting:
                waiting.effects[:] = [e for e in waiting.effects if not isinstance(e, effects.SendState)
                                      or e.port != effect.port or e.message.state is BoxState.STOP]
            if self._is_result(effect.port):
                continue
            if sent is None or sent.state is not BoxState.STOP:
                # What the robot said is acknowledged when it is recorded.
                before = NEVER if sent is None else sent.acknowledgement
                self._do(effect._replace(message=effect.message._replace(acknowledgement=before)))
            record = self.journal.end_of(effect.port, todo)
            ended.update({} if record is None else {record.identity: record})
        for record in ended.values():
            self._stops.sent(self._moment, record, self.journal.next_ticket)

    def _is_result(self, port: int) -> bool:
        """Whether a robot has completed the run: it does not move, and repeats its result until STOP takes it."""
        run = self.box.zones.run_at(port)
        return run is not None and run.end_reason is EndReason.COMPLETED and run.robot_state is RobotState.RESULT_TX

    def _record(self, todo: List[Effect]) -> int:
        """Give the journal what happened; returns the ticket, 0: nothing is to be recorded."""
        try:
            return self.journal.record(self._moment, todo)
        except Exception:
            # A failed record must not stop the runs.
            self.journal.lost()
            self._outputs.report_bug("what happened could not be recorded")
            return 0

    def _hold(self, ticket: int, todo: List[Effect]) -> None:
        """Let effects wait until the journal has their record, and all before them."""
        if self._resuming:
            ticket = 0
        held, waiting = self._held(), _Waiting(ticket, self._moment, [])
        for effect in todo:
            is_acknowledgement = not ticket and isinstance(effect, effects.SendState) and effect.port not in held
            if is_acknowledgement or isinstance(effect, (effects.SendBeacon, effects.TimeoutRung)):
                self._do(effect)
            elif not isinstance(effect, (effects.Notice, effects.Superseded)):
                waiting.effects.append(effect)
            if isinstance(effect, effects.OpenChannel):
                self.radio.awaited.add(effect.port)
                held.add(effect.port)
        self._waiting.append(waiting)

    def _release(self) -> None:
        """Carry out the effects whose record is in the journal."""
        while self._waiting and not self.journal.is_waiting(self._waiting[0].ticket):
            self._moment = self._waiting[0].moment
            todo = self._waiting.popleft().effects
            for effect in todo:
                self._do(effect)

    def _held(self) -> Set[int]:
        """The ports of robots for which something waits."""
        return {effect.port for waiting in self._waiting for effect in waiting.effects
                if isinstance(effect, (effects.OpenChannel, effects.AimChannel, effects.SendState))}

    def _do(self, effect: Effect) -> None:
        try:
            self._hands[type(effect)](effect)
        except Exception:
            # A failing effect must not prevent the others.
            self._outputs.report_bug(f"{type(effect).__name__} was not carried out")

    def _set_timer(self) -> None:
        deadline = self.box.timers.deadline()
        if self._timer is not None:
            if self._timer.when() == deadline:
                return
            self._timer.cancel()
        self._timer = None if deadline is None else self._loop.call_at(deadline, self._on_timer)

    def _send_state(self, effect: effects.SendState) -> None:
        if effect.message.state is not BoxState.STOP and not self._resuming:
            self._stops.starts(self.journal.place(effect.port).identity)
        self.radio.send_state(effect.port, effect.message, effect.how)

    def _on_timer(self) -> None:
        self._timer = None
        self.tick()

    def _want_beacon(self, _effect: effects.SendBeacon) -> None:
        """Request a beacon after all other effects, so that it has the final state."""
        self._beacon_wanted = True

    def _want_module_runs(self, _effect: effects.ModuleRunsChanged) -> None:
        """Publish once per event, after the effects that robots wait for."""
        self._modules_wait = True

    def _port_taken(self, effect: effects.PortTaken) -> None:
        self._ports.add(effect.port, lambda error: self._loop.call_soon_threadsafe(self._port_not_kept, error))

    def _port_not_kept(self, error: OSError) -> None:
        self.event(
            self.box.watches.trouble,
            f"{self._ports.path} cannot be written: {error.strerror}. After a restart of the box private ports "
            "may be used twice: free or repair the disk of log_dir",
        )

    def _open_channel(self, effect: effects.OpenChannel) -> None:
        try:
            self.radio.open_channel(effect.port, effect.team, effect.host, effect.version)
        except OSError as error:
            self._unopened.add(effect.port)
            self.event(self.box.arrivals.on_channel_failed, effect.port, str(error))

    def _run_opened(self, effect: effects.RunOpened) -> None:
        if effect.port in self._unopened:
            return  # the box retries on another port: no log for this one
        self.run_logs.opened(effect, self._moment.utc)
        self.journal.log_file(effect.port, self.run_logs.files[effect.port])

    def _run_resumed(self, effect: effects.RunResumed) -> None:
        self.run_logs.resumed(effect.port, self.journal.log_file_before(effect.port))
        self.journal.log_file(effect.port, self.run_logs.files[effect.port])

    def _notice(self, effect: effects.Notice) -> None:
        zone = f"zone {effect.zone}: " if effect.zone else ""
        self._outputs.log(effect.level, escaped(f"{zone}{effect.text}"))
