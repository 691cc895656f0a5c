"""The latest messages of core and devices, for all panels (docs/architecture.md, "Panels hold no truth")."""

import time
from typing import Dict, List, Optional

from roah_rsbb.box_clock import BoxClock
from roah_rsbb.msg import (
    CoreDetails,
    CoreToGui,
    DevicesState,
    DevicesStatus,
    Judgings,
    Results,
    RunClock,
    RunClocks,
    RunSummary,
    Schedule,
    Superseded,
    Unsaved,
    UnsavedParts,
    ZoneDetails,
    ZoneState,
)
from roah_rsbb.rqt.qt import QObject, QTimer, Signal
from roah_rsbb.wording import superseded
from roah_rsbb.wording.clock import Clock, clock_of
from roah_rsbb.wording.judging import Judging, judgings_of
from roah_rsbb.wording.language import tr
from roah_rsbb.wording.replay import NO_COMMANDS, is_replay
from roah_rsbb.wording.said import learn_details

GUI_TOPIC = "/core/to_gui"
DETAILS_TOPIC = "/core/details"
RESULTS_TOPIC = "/core/results"
UNSAVED_TOPIC = "/core/unsaved"
CLOCKS_TOPIC = "/core/clocks"
SCHEDULE_TOPIC = "/core/schedule"
JUDGING_TOPIC = "/core/judging"
SUPERSEDED_TOPIC = "/core/superseded"
DEVICES_TOPIC = "/devices/state"
DEVICES_STATUS_TOPIC = "/devices/status"
TOPICS = {
    GUI_TOPIC: CoreToGui,
    DETAILS_TOPIC: CoreDetails,
    RESULTS_TOPIC: Results,
    UNSAVED_TOPIC: Unsaved,
    CLOCKS_TOPIC: RunClocks,
    SCHEDULE_TOPIC: Schedule,
    JUDGING_TOPIC: Judgings,
    SUPERSEDED_TOPIC: Superseded,
    DEVICES_TOPIC: DevicesState,
    DEVICES_STATUS_TOPIC: DevicesStatus,
}

# The attribute of `Model` with the newest message of a topic.
_FIELDS = {
    GUI_TOPIC: "gui", DETAILS_TOPIC: "details", RESULTS_TOPIC: "results", UNSAVED_TOPIC: "_unsaved",
    CLOCKS_TOPIC: "_clocks", SCHEDULE_TOPIC: "schedule", JUDGING_TOPIC: "_judgings",
    SUPERSEDED_TOPIC: "_superseded", DEVICES_TOPIC: "devices", DEVICES_STATUS_TOPIC: "devices_status",
}

TICK_MS = 100
# The core publishes ten times a second. After this long without a message, the shown state is marked as old. With the
# tick, this is within a second.
SILENT_S = 0.7
# Details come at least once a second.
DETAILS_SILENT_S = 2.5
# Interval at which to subscribe again to a silent core, seconds.
RENEW_S = 5.0
# Interval at which panels are redrawn while no messages arrive, because they show for how long.
SILENT_REDRAW_S = 0.5


class Model(QObject):
    """The newest messages, their age, and the zone that is shown.

    `feed` is a `Feed` of roah_rsbb.ros.feed, and `zone_parameter` a `ZoneParameter`, or objects that behave like them.
    """

    updated = Signal()

    def __init__(self, feed, zone_parameter) -> None:
        super().__init__()
        self._feed = feed
        self._zone_parameter = zone_parameter
        self._heard_at: Dict[str, float] = {}  # monotonic seconds of the newest message, by topic
        self._started = self._renewed = self._emitted = time.monotonic()
        self._shown: tuple = ()
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._tick)
        self.gui: Optional[CoreToGui] = None
        self.details: Optional[CoreDetails] = None
        self.results: Optional[Results] = None
        self.schedule: Optional[Schedule] = None
        self._judgings: Optional[Judgings] = None
        self._superseded: Optional[Superseded] = None
        self._unsaved: Optional[Unsaved] = None
        self._clocks: Optional[RunClocks] = None
        self.devices: Optional[DevicesState] = None
        self.devices_status: Optional[DevicesStatus] = None
        self.box_clock = BoxClock()

    def start(self) -> None:
        """Start listening."""
        self._feed.start()
        self._zone_parameter.start()
        self._timer.start(TICK_MS)

    def stop(self) -> None:
        """Stop listening."""
        self._timer.stop()
        self._feed.stop()
        self._zone_parameter.stop()

    # -- for panels ---------------------------------------------------------------------------------

    @property
    def silence_s(self) -> Optional[float]:
        """Seconds since the core was last heard; None: never heard."""
        return None if self._heard is None else time.monotonic() - self._heard

    @property
    def _heard(self) -> Optional[float]:
        return self._heard_at.get(GUI_TOPIC)

    @property
    def is_old(self) -> bool:
        """Whether the state shown may be out of date."""
        silence = self.silence_s
        return silence is None or silence > SILENT_S or self.is_superseded

    @property
    def is_superseded(self) -> bool:
        """Whether another box took over from the one that is shown."""
        return (self.details is not None and self._superseded is not None
                and self._superseded.box_uuid == self.details.box_uuid)

    @property
    def is_replay(self) -> bool:
        """Whether the state shown is that of an earlier run, which is replayed."""
        return self.details is not None and is_replay(self.details.box_uuid)

    def why_read_only(self, silent: str) -> str:
        """Return why nothing can be changed now; empty: it can. `silent`: the reason if the core is silent."""
        return self.why_old(silent) or (tr(NO_COMMANDS) if self.is_replay else "")

    def why_old(self, silent: str) -> str:
        """Return why the state shown may be out of date; empty: it is not. `silent`: the reason if the core is
        silent."""
        if self.is_superseded:
            return tr(superseded.NO_COMMANDS)
        return silent if self.is_old else ""

    @property
    def clock_s(self) -> float:
        """The box's clock in the newest message, UTC seconds; 0.0 before the first one."""
        return 0.0 if self.gui is None else self.gui.clock.to_sec()

    @property
    def details_clock_s(self) -> float:
        """The box's clock in the newest details, UTC seconds; 0.0 before the first ones."""
        return 0.0 if self.details is None else self.details.clock.to_sec()

    def box_time(self) -> float:
        """Return our estimate of the box's clock now, in UTC seconds."""
        return self.box_clock.now(time.monotonic())

    @property
    def zone_name(self) -> str:
        """The zone that this client shows: the chosen one, or the first one if none was chosen."""
        chosen = self._zone_parameter.value
        if not chosen and self.gui is not None and self.gui.zones:
            return self.gui.zones[0].zone
        return chosen

    @property
    def zone_names(self) -> List[str]:
        """All zones, in the order of the schedule."""
        return [] if self.gui is None else [zone.zone for zone in self.gui.zones]

    def running_zones(self) -> List[str]:
        """Return the zones that are running. If a phase is unknown, a zone that can be stopped may be running. In a
        replay, no zone can be stopped."""
        found = []
        for zone in self.gui.zones if self.gui else ():
            details = self.details_of(zone.zone)
            if (zone.stop_enabled or self.is_replay) and (details is None or details.phase == "running"):
                found.append(zone.zone)
        return found

    def identity_of(self, zone_name: str) -> str:
        """Return the identity of the run in a zone; empty: none, or not known."""
        details = self.details_of(zone_name)
        return "" if details is None else details.identity

    @property
    def zone(self) -> Optional[ZoneState]:
        """The state of that zone; None: nothing heard yet, or the schedule has no such zone."""
        zones = () if self.gui is None else self.gui.zones
        return next((z for z in zones if z.zone == self.zone_name), None)

    @property
    def zone_details(self) -> Optional[ZoneDetails]:
        """The details of that zone; None: not known."""
        return self.details_of(self.zone_name)

    def details_of(self, zone_name: str) -> Optional[ZoneDetails]:
        """Return the details of a zone; None: not known, or much older than its state.

        While the core is silent both are equally old, and the last details are still useful.
        """
        if self.details is None or self._is_behind(DETAILS_TOPIC):
            return None
        return next((z for z in self.details.zones if z.zone == zone_name), None)

    def _is_behind(self, topic: str) -> bool:
        """Whether the newest message of a topic is much older than that of CoreToGui."""
        return (self._heard or 0.0) - self._heard_at[topic] > DETAILS_SILENT_S

    def clock_of(self, zone_name: str) -> Optional[Clock]:
        """Return the times of the run in a zone, as of the newest CoreToGui; None: not known, or much older."""
        details = self.details_of(zone_name)
        if details is None or self._clocks is None or self._is_behind(CLOCKS_TOPIC):
            return None
        message = next((clock for clock in self._clocks.zones if clock.zone == zone_name), RunClock(zone=""))
        if message.identity != details.identity:
            return None  # of the previous run: the two topics are from different moments
        return clock_of(message, self.clock_s - self._clocks.clock.to_sec())

    def unsaved_of(self, identity: str) -> UnsavedParts:
        """Return the parts of a run's record that the core could not write to the disk yet."""
        runs = () if self._unsaved is None else self._unsaved.runs
        return next((run for run in runs if run.identity == identity), UnsavedParts())

    def runs_of(self, zone_name: str) -> List[RunSummary]:
        """Return the runs of a zone: the connected one, then those that are over, the latest first."""
        runs = () if self.results is None else self.results.runs
        return [run for run in runs if run.zone == zone_name]

    def judgings_of(self, zone_name: str) -> List[Judging]:
        """Return the progress of all runs of a zone that are not signed off, first those with judges or a published
        result."""
        judgings = () if self._judgings is None else self._judgings.runs
        return judgings_of(judgings, self.runs_of(zone_name), zone_name)

    @property
    def has_devices(self) -> bool:
        """Whether the devices node is running. Its topics are published on change only, so silence means nothing."""
        return self.devices is not None and self._feed.has_publisher(DEVICES_TOPIC)

    def choose_zone(self, zone_name: str) -> None:
        """Show another zone, in all panels of this client."""
        self._zone_parameter.choose(zone_name)
        self._emit(time.monotonic())

    # -- listening ----------------------------------------------------------------------------------

    def _tick(self) -> None:
        now = time.monotonic()
        news = [topic for topic in TOPICS if self._take(topic)]
        old = self.is_old
        if old and now - max(self._heard or self._started, self._renewed) > RENEW_S:
            self._renewed = now
            self._feed.renew()
        shown = (old, self.zone_name, self.has_devices)
        if news or shown != self._shown or (old and now - self._emitted >= SILENT_REDRAW_S):
            self._shown = shown
            self._emit(now)

    def _take(self, topic: str) -> bool:
        """Take the newest message of a topic. Returns whether there was a new one."""
        received = self._feed.take(topic)
        if received is None:
            return False
        # The same clock again is the latched message, sent to a new subscription. A core that hangs sends it, too,
        # so it does not show that the core is running.
        before = getattr(self, _FIELDS[topic])
        if topic in (GUI_TOPIC, DETAILS_TOPIC) and before is not None and before.clock == received.message.clock:
            return False
        setattr(self, _FIELDS[topic], received.message)
        if topic == DETAILS_TOPIC:
            learn_details(received.message)
        self._heard_at[topic] = received.mono
        if topic == GUI_TOPIC:
            self.box_clock.sample(received.mono, self.clock_s)
        return True

    def _emit(self, now: float) -> None:
        self._emitted = now
        self.updated.emit()
