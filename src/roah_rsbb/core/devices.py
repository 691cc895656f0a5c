"""The home devices: their state in the beacon, and what is wrong with them."""

from typing import List

from roah_rsbb.core import effects
from roah_rsbb.core.effects import Level, Outbox
from roah_rsbb.core.runs.run import Run
from roah_rsbb.core.timers import Timers
from roah_rsbb.core.watches import Watches
from roah_rsbb.core.zones import Zones
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import DevicesState
from roah_rsbb.model.reason import cut_note
from roah_rsbb.rulebook.registry import DEVICES


class ReportedDevices:
    """The home devices, as their controller reports them."""

    def __init__(self, timers: Timers, zones: Zones, watches: Watches, outbox: Outbox) -> None:
        self._timers = timers
        self._zones = zones
        self._watches = watches
        self._outbox = outbox
        self.state = DevicesState()
        self.warnings: List[str] = []
        """Why the controller is not reached, while that lasts."""

    def on_state(self, now: Now, state: DevicesState) -> None:
        """The devices reported their state."""
        self._timers.tick(now)
        if state != self.state:
            self.state = state
            self._outbox.emit(effects.SendBeacon())

    def on_status(self, now: Now, connected: bool, text: str) -> None:
        """The devices' controller is reached, or not. `text` gives details or the reason."""
        self._timers.tick(now)
        self.warnings = [] if connected else [f"Home devices: {cut_note(text)}"]

    def on_refused(self, now: Now, zone_name: str, device: str, value: int, reason: str) -> None:
        """A robot's command to a device (`SetDevice`) could not be carried out."""
        self._timers.tick(now)
        text = self._watches.device_refused(now, device, value, cut_note(reason))
        run = self._zones[zone_name].run
        if isinstance(run, Run) and DEVICES in run.event.benchmark.profile.uses:
            run.warn(now, text)
        else:  # the run that commanded it has been left
            self._outbox.notice(Level.WARNING, text, zone_name)
