"""Drives the core: passes events with their time to the box, and carries out their effects.

Everything here runs in the loop's thread. The core makes all decisions; the driver only dispatches effects.
"""

import asyncio
import time
from typing import Callable, List, Optional, Set

import rospy

from roah_rsbb.core import effects
from roah_rsbb.core.box import Box
from roah_rsbb.core.clock import Now, one_moment
from roah_rsbb.core.effects import Effect, Level
from roah_rsbb.journal.ports import PortRecord
from roah_rsbb.nodes.core.journal import CoreJournal
from roah_rsbb.radio.radio import CoreRadio
from roah_rsbb.run_logs.writer import RunLogWriter
from roah_rsbb.wording.texts import escaped

_LOG = {Level.INFO: rospy.loginfo, Level.WARNING: rospy.logwarn, Level.ERROR: rospy.logerr}


class CoreDriver:
    """One box, and the objects that carry out its effects."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        box: Box,
        radio: CoreRadio,
        run_logs: RunLogWriter,
        ports: PortRecord,
        journal: CoreJournal,
        ring_timeout: Callable[[], None],
        publish_module_runs: Callable[[], None],
        results_changed: Callable[[], None],
        set_device: Callable[[effects.SetDevice], None],
        give_up: Callable[[str], None],
    ) -> None:
        self._loop = loop
        self.box = box
        self._radio = radio
        self._run_logs = run_logs
        self._ports = ports
        self._journal = journal
        self._ring_timeout = ring_timeout
        self._publish_module_runs = publish_module_runs
        self._give_up = give_up
        self._timer: Optional[asyncio.TimerHandle] = None
        self._carrying_out = False
        self._beacon_wanted = False
        self._modules_wait = False
        self._unopened: Set[int] = set()  # ports
        self._moment = self.now()  # of the latest event
        self._hands = {
            effects.PortTaken: self._port_taken,
            effects.OpenChannel: self._open_channel,
            effects.AimChannel: lambda e: self._radio.aim(e.port, e.host),
            effects.CloseChannel: lambda e: self._radio.close_channel(e.port),
            effects.SendState: lambda e: self._radio.send_state(e.port, e.message, e.how),
            effects.SendBeacon: self._want_beacon,
            effects.TimeoutRung: lambda e: self._ring_timeout(),
            effects.SetDevice: set_device,
            effects.RunOpened: self._run_opened,
            effects.SheetOpened: lambda e: None,  # the journal records it
            effects.RunResumed: self._run_resumed,
            effects.RecordChanged: lambda e: results_changed(),
            effects.Recorded: lambda e: None,  # the journal records it
            effects.RunLogged: lambda e: self._run_logs.logged(e, self._moment.utc),
            effects.RunClosed: lambda e: self._run_logs.closed(e),
            effects.ModuleRunsChanged: self._want_module_runs,
            effects.Superseded: lambda e: self._radio.close(),
            effects.Notice: self._notice,
            effects.GiveUp: lambda e: self._give_up(e.reason),
        }

    @staticmethod
    def now() -> Now:
        """The present moment on both clocks; the loop's clock is the monotonic one."""
        return one_moment(time.monotonic, time.time)

    def event(self, method: Callable[..., object], *args: object) -> None:
        """Pass an event to the box, then carry out the effects. Exceptions of the method are raised afterwards."""
        self._moment = self.now()
        try:
            method(self._moment, *args)
        finally:
            self._carry_out()
            self._set_timer()

    def tick(self) -> None:
        """Run the box's due timers."""
        self.event(self.box.tick)

    def _carry_out(self) -> None:
        if self._carrying_out:
            return  # an effect caused another event, whose effects follow later
        self._carrying_out = True
        notices: List[effects.Notice] = []
        try:
            todo = self._take_effects()
            while todo:
                for effect in todo:
                    if isinstance(effect, effects.Notice):
                        notices.append(effect)
                    else:
                        self._do(effect)
                todo = self._take_effects()
            if self._beacon_wanted:
                self._beacon_wanted = False
                self._radio.send_beacon()
            if self._modules_wait:
                self._modules_wait = False
                self._publish_module_runs()
        finally:
            self._carrying_out = False
            # Log lines are slow and not urgent, so they come last.
            for notice in notices:
                self._do(notice)

    def _take_effects(self) -> List[Effect]:
        """Return the box's effects. When this returns, the journal has them."""
        todo = self.box.take_effects()
        if todo:
            try:
                self._journal.record(self._moment, todo)
            except Exception:
                # A failed record must not stop the runs.
                self._journal.lost()
                rospy.logerr_throttle(1.0, "internal error, please report it: what happened could not be recorded",
                                      exc_info=True)
        return todo

    def _do(self, effect: Effect) -> None:
        try:
            self._hands[type(effect)](effect)
        except Exception:
            # A failing effect must not prevent the others.
            rospy.logerr_throttle(1.0, f"internal error, please report it: {type(effect).__name__} was not carried out",
                                  exc_info=True)

    def _set_timer(self) -> None:
        deadline = self.box.deadline()
        if self._timer is not None:
            if self._timer.when() == deadline:
                return
            self._timer.cancel()
        self._timer = None if deadline is None else self._loop.call_at(deadline, self._on_timer)

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
        try:
            self._ports.add(effect.port, lambda error: self._loop.call_soon_threadsafe(self._port_not_kept, error))
        except OSError as error:
            self._port_not_kept(error)

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

    @staticmethod
    def _notice(effect: effects.Notice) -> None:
        zone = f"zone {effect.zone}: " if effect.zone else ""
        _LOG[effect.level]("%s", escaped(f"{zone}{effect.text}"))
