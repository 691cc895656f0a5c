"""Drives a box without ROS and without a journal: for programs that play the box on a laptop.

It passes events with their time to the box, and carries out those effects that concern the network. The core node has
a driver of its own, which also records everything (`roah_rsbb.box.game`).
"""

import asyncio
import time
from typing import Callable, Dict, Optional

from roah_rsbb.comm.channels import MakePeer, Network
from roah_rsbb.core import effects
from roah_rsbb.core.box import Box
from roah_rsbb.core.effects import Effect
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import BoxMessage, RobotReport
from roah_rsbb.radio.radio import CoreRadio
from roah_rsbb.radio.short_way import Turns


class NetworkDriver:
    """A box and its channels. All methods belong to the loop's thread."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        box: Box,
        network: Network,
        passwords: Dict[str, str],
        warn: Callable[[str], None],
        utc: Callable[[], float] = time.time,
        make_peer: Optional[MakePeer] = None,
        can_wait: bool = False,
    ) -> None:
        """`passwords` by team. `warn` logs a text about a private channel. `utc` is the clock; the loop's clock is the
        monotonic one. `make_peer`: see `CoreRadio`. `can_wait`: see `Turns`."""
        self.box = box
        self._loop = loop
        self._turns = Turns(loop, loop.time, utc, can_wait)
        self.radio = CoreRadio(loop, network, box, self._turns, warn, make_peer)
        self.radio.connect(self.event, self.report)
        self.radio.use_passwords(0, passwords)
        self._timer: Optional[asyncio.TimerHandle] = None
        self._carrying_out = False

    def open(self, listen_duration: float = 0.0) -> None:
        """Start. Raises OSError whose text names the remedy."""
        self.radio.open(listen_duration)
        self.event(self.box.timers.tick)

    def close(self) -> None:
        """Stop without informing the robot."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        self.radio.close()

    def now(self) -> Now:
        """The present moment on both clocks."""
        return self._turns.now()

    def event(self, method: Callable[..., object], *args: object) -> None:
        """Pass an event to the box, then carry out the effects. Exceptions of the method are raised afterwards."""
        try:
            method(self.now(), *args)
        finally:
            self._finish()

    def report(
        self, now: Now, port: int, host: str, report: RobotReport, received_utc: Optional[float],
    ) -> Optional[BoxMessage]:
        """See `Game.report`."""
        message = None
        try:
            message = self.box.arrivals.on_robot_report(now, port, host, report, received_utc)
        finally:
            if message is None:
                self._finish()
        return message

    def _finish(self) -> None:
        self._carry_out()
        self._set_timer()

    def on_effect(self, effect: Effect) -> None:
        """Called with each effect, after it was carried out. Override what you need."""

    def _carry_out(self) -> None:
        if self._carrying_out:
            return  # an effect caused another event, whose effects follow later
        self._carrying_out = True
        try:
            todo = self.box.outbox.take()
            while todo:
                for effect in todo:
                    self._do(effect)
                    self.on_effect(effect)
                todo = self.box.outbox.take()
        finally:
            self._carrying_out = False

    def _do(self, effect: Effect) -> None:
        radio = self.radio
        if isinstance(effect, effects.OpenChannel):
            try:
                radio.open_channel(effect.port, effect.team, effect.host, effect.version)
            except OSError as error:
                self.event(self.box.arrivals.on_channel_failed, effect.port, str(error))
        elif isinstance(effect, effects.AimChannel):
            radio.aim(effect.port, effect.host)
        elif isinstance(effect, effects.CloseChannel):
            radio.close_channel(effect.port)
        elif isinstance(effect, effects.SendState):
            radio.send_state(effect.port, effect.message, effect.how)
        elif isinstance(effect, effects.SendBeacon):
            radio.send_beacon()

    def _set_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
        deadline = self.box.timers.deadline()
        self._timer = None if deadline is None else self._loop.call_at(deadline, self._on_timer)

    def _on_timer(self) -> None:
        self._timer = None
        self.event(self.box.timers.tick)
