"""Drives the core: passes events with their time to the box, and carries out their effects.

Everything here runs in the loop's thread. The core makes all decisions; the driver only dispatches effects.

Effects of an event leave when the journal's file has its record. While the disk hangs, they wait, in their
order. Only STOP does not wait: it leaves before the record is written, and what still waits for that robot is older
than it, and is dropped. Messages that only acknowledge what a robot said leave at once if nothing waits for this robot.
"""

import asyncio
from collections import deque
from typing import Callable, Deque, Dict, Iterable, List, NamedTuple, Optional, Protocol, Set

from roah_rsbb.box.journal import CoreJournal
from roah_rsbb.core import effects
from roah_rsbb.core.box import Box
from roah_rsbb.core.continuing import Saved
from roah_rsbb.core.effects import Effect, Level
from roah_rsbb.journal.log_dir import PortRecord
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import NEVER, BoxMessage, RobotReport
from roah_rsbb.model.records import EndReason, RunRecord
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.radio.radio import CoreRadio
from roah_rsbb.wording.texts import escaped


class RunLogs(Protocol):
    """Has the run logs made. `run_logs.writer.RunLogWriter` does it in another process."""

    files: Dict[int, str]  # by the run's port: where its log will be

    def check(self) -> str:
        """Why logs cannot be written, with the remedy; empty if they can."""

    def opened(self, effect: effects.RunOpened, utc: float) -> None:
        """A run has begun."""

    def resumed(self, port: int, path: str) -> None:
        """A run continues after a restart; `path` was that of its log, empty if unknown."""

    def closed(self, effect: effects.RunClosed) -> None:
        """A run is over: make its log from the journal."""

    def make(self, paths: Iterable[str]) -> None:
        """Make those of the logs of earlier runs that are missing."""

    def stop(self) -> None:
        """Wait for the last logs for a while."""


class Outputs(NamedTuple):
    """Where effects go that the box's own radio and files do not carry out. Called in the loop's thread."""

    ring_timeout: Callable[[], None]  # a run timed out
    publish_module_runs: Callable[[], None]  # for the benchmarking modules
    set_device: Callable[[effects.SetDevice], None]
    log: Callable[[Level, str], None]  # a line for the program's log
    report_bug: Callable[[str], None]  # within `except`: an internal error, which stops nothing
    changed: Callable[[], None] = lambda: None  # something happened in the box: see `Box.happenings`


class _Waiting(NamedTuple):
    """Effects of an event whose record is not in the journal's file yet."""

    ticket: int  # of the record; 0: there is none
    moment: Now  # of the event
    effects: List[Effect]


class CoreDriver:
    """One box, and the objects that carry out its effects."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        box: Box,
        radio: CoreRadio,
        run_logs: RunLogs,
        ports: PortRecord,
        journal: CoreJournal,
        outputs: Outputs,
        now: Callable[[], Now],
        check: Callable[[], None] = lambda: None,
        on_stop: Callable[[Now, RunRecord, int], object] = lambda now, record, ticket: None,
        on_start: Callable[[str], object] = lambda identity: None,
    ) -> None:
        """`now` returns the present moment; its monotonic clock is the loop's. `check` is called before anything
        happens, is recorded or leaves: see `Fence.check`. `on_stop`: STOP has left, and its record has not: see
        `StopNotes.sent`. `on_start`: a robot of this run is sent something else: see `StopNotes.starts`."""
        self._loop = loop
        self.box = box
        self._radio = radio
        self._run_logs = run_logs
        self._ports = ports
        self._journal = journal
        self._outputs = outputs
        self._now = now
        self._check, self._on_stop, self._on_start = check, on_stop, on_start
        self._timer: Optional[asyncio.TimerHandle] = None
        self._carrying_out = self._resuming = False
        self._waiting: Deque[_Waiting] = deque()
        self._beacon_wanted = False
        self._modules_wait = False
        self._unopened: Set[int] = set()  # ports
        self._moment = now()  # of the latest event
        self._happenings = box.happenings  # after it
        radio.connect(self.event, self.report)
        journal.on_written(lambda: self._waiting and loop.call_soon_threadsafe(self._continue))
        self._hands = {
            effects.PortTaken: self._port_taken,
            effects.OpenChannel: self._open_channel,
            effects.AimChannel: lambda e: self._radio.aim(e.port, e.host),
            effects.CloseChannel: lambda e: self._radio.close_channel(e.port),
            effects.SendState: self._send_state,
            effects.SendBeacon: self._want_beacon,
            effects.TimeoutRung: lambda e: outputs.ring_timeout(),
            effects.SetDevice: lambda e: box.is_superseded or outputs.set_device(e),
            effects.RunOpened: self._run_opened,
            effects.SheetOpened: lambda e: None,  # the journal records it
            effects.RunResumed: self._run_resumed,
            effects.RecordChanged: lambda e: None,  # the journal records it
            effects.Recorded: lambda e: None,  # the journal records it
            effects.RunLogged: lambda e: None,  # the journal records it
            effects.RunClosed: lambda e: self._run_logs.closed(e),
            effects.ModuleRunsChanged: self._want_module_runs,
            effects.Superseded: lambda e: self._radio.close(),
            effects.Notice: self._notice,
            effects.AnotherBox: lambda e: None,  # a referee decides
        }

    def event(self, method: Callable[..., object], *args: object) -> None:
        """Pass an event to the box, then carry out the effects. Exceptions of the method are raised afterwards."""
        self._check()
        self._moment = self._now()
        try:
            method(self._moment, *args)
        finally:
            self._finish()

    def report(
        self, now: Now, port: int, host: str, report: RobotReport, received_utc: Optional[float],
    ) -> Optional[BoxMessage]:
        """Like `event`, for a robot's report that was read `now`. Returns the message to send to the robot from now on,
        if there is nothing else to do: see `Box.on_robot_report`."""
        self._check()
        self._moment = now
        message = None
        try:
            message = self.box.on_robot_report(self._moment, port, host, report, received_utc)
        finally:
            if message is None:
                self._finish()
        # It may have a state that still waits.
        return message if message is not None and port not in self._held() else None

    def resume(self, saved: Saved) -> None:
        """Continue from a saved state. Robots are sent what they were sent before, which waits for no disk."""
        self._resuming = True
        try:
            self.event(self.box.resume, saved)
        finally:
            self._resuming = False

    def _continue(self) -> None:
        """The disk takes data again."""
        self._check()
        self._moment = self._now()  # what was read before is taken before
        self._finish()

    def _finish(self) -> None:
        self._carry_out()
        self._set_timer()
        if self.box.happenings != self._happenings:
            self._happenings = self.box.happenings
            self._outputs.changed()

    def tick(self) -> None:
        """Run the box's due timers."""
        self.event(self.box.tick)

    def _carry_out(self) -> None:
        if self._carrying_out:
            return  # an effect caused another event, whose effects follow later
        self._carrying_out = True
        notices: List[effects.Notice] = []
        try:
            self._release()
            todo = self.box.take_effects()
            while todo:
                self._check()
                self._stop(todo)
                notices += [effect for effect in todo if isinstance(effect, effects.Notice)]
                self._hold(self._record(todo), todo)
                self._release()
                todo = self.box.take_effects()
            if self._beacon_wanted:
                self._beacon_wanted = False
                self._radio.send_beacon()
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
                    or not self._radio.is_open(effect.port)):
                continue
            sent = self._radio.sent(effect.port)  # None: after a restart, to a robot that was not heard yet
            for waiting in self._waiting:
                waiting.effects[:] = [e for e in waiting.effects if not isinstance(e, effects.SendState)
                                      or e.port != effect.port or e.message.state is BoxState.STOP]
            if self._is_result(effect.port):
                continue
            if sent is None or sent.state is not BoxState.STOP:
                # What the robot said is acknowledged when it is recorded.
                before = NEVER if sent is None else sent.acknowledgement
                self._do(effect._replace(message=effect.message._replace(acknowledgement=before)))
            record = self._journal.end_of(effect.port, todo)
            ended.update({} if record is None else {record.identity: record})
        for record in ended.values():
            self._on_stop(self._moment, record, self._journal.next_ticket)

    def _is_result(self, port: int) -> bool:
        """Whether a robot has completed the run: it does not move, and repeats its result until STOP takes it."""
        run = self.box.zones.run_at(port)
        return run is not None and run.end_reason is EndReason.COMPLETED and run.robot_state is RobotState.RESULT_TX

    def _record(self, todo: List[Effect]) -> int:
        """Give the journal what happened; returns the ticket, 0: nothing is to be recorded."""
        try:
            return self._journal.record(self._moment, todo)
        except Exception:
            # A failed record must not stop the runs.
            self._journal.lost()
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
                self._radio.awaited.add(effect.port)
                held.add(effect.port)
        self._waiting.append(waiting)

    def _release(self) -> None:
        """Carry out the effects whose record is in the journal."""
        while self._waiting and not self._journal.is_waiting(self._waiting[0].ticket):
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
        deadline = self.box.deadline()
        if self._timer is not None:
            if self._timer.when() == deadline:
                return
            self._timer.cancel()
        self._timer = None if deadline is None else self._loop.call_at(deadline, self._on_timer)

    def _send_state(self, effect: effects.SendState) -> None:
        if effect.message.state is not BoxState.STOP and not self._resuming:
            self._on_start(self._journal.place(effect.port).identity)
        self._radio.send_state(effect.port, effect.message, effect.how)

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
            self.box.on_trouble,
            f"{self._ports.path} cannot be written: {error.strerror}. After a restart of the box private ports "
            "may be used twice: free or repair the disk of log_dir",
        )

    def _open_channel(self, effect: effects.OpenChannel) -> None:
        try:
            self._radio.open_channel(effect.port, effect.team, effect.host, effect.version)
        except OSError as error:
            self._unopened.add(effect.port)
            self.event(self.box.on_channel_failed, effect.port, str(error))

    def _run_opened(self, effect: effects.RunOpened) -> None:
        if effect.port in self._unopened:
            return  # the box retries on another port: no log for this one
        self._run_logs.opened(effect, self._moment.utc)
        self._journal.log_file(effect.port, self._run_logs.files[effect.port])

    def _run_resumed(self, effect: effects.RunResumed) -> None:
        self._run_logs.resumed(effect.port, self._journal.log_file_before(effect.port))
        self._journal.log_file(effect.port, self._run_logs.files[effect.port])

    def _notice(self, effect: effects.Notice) -> None:
        zone = f"zone {effect.zone}: " if effect.zone else ""
        self._outputs.log(effect.level, escaped(f"{zone}{effect.text}"))
