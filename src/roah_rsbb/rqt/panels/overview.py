"""Overview: all zones at a glance, and a stop for all of them.

Keys: Shift+Esc twice stops all zones, in whatever panel of the process the focus is.
"""

import math
from functools import partial
from typing import Dict, List, NamedTuple, Optional, Tuple

from python_qt_binding.QtCore import Qt
from python_qt_binding.QtWidgets import QApplication, QFrame, QGridLayout, QScrollArea, QWidget

from roah_rsbb.msg import ZoneDetails, ZoneState
from roah_rsbb.rqt.model.calls import Outcome
from roah_rsbb.rqt.model.stops import stop_run
from roah_rsbb.rqt.panels.overview_tile import COMPACT_EMS, HIGH_EMS, WIDE_EMS, ZoneTile
from roah_rsbb.rqt.panels.panel import Answer, Panel
from roah_rsbb.rqt.panels.todo import Urgency, todo
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.widgets.hold_button import HoldButton
from roah_rsbb.rqt.widgets.shortcuts import TwiceKey
from roah_rsbb.wording import times

STOP_KEY = "Shift+Esc"
STOP_ALL = "■ STOP ALL ZONES"
STOP_TIP = f"Stop the runs of all zones: hold the button (keys: {STOP_KEY} twice)"
HOLD_IT = "Stop all zones: hold the button until it says so"
NONE_RUNS = "No zone is running"
NO_CALL = (0, -1)
NOT_HEARD = "The core was not heard yet"
# Tiles grow with the panel, so that they can be read from afar, up to this factor. Where there is no room they are
# compact, and shrink to no less than this one.
LEAST, MOST = 0.85, 3.5
# Between two tiles, in units of the desktop's font.
GAP_EMS = 0.3


class Shape(NamedTuple):
    """How the tiles lie."""

    columns: int
    factor: float  # so many times as large as the desktop's font calls for
    compact: bool = False


class OverviewPanel(Panel):
    """A tile a zone, in the order of the schedule: none changes its place while a referee aims at it."""

    TITLE = "Overview"

    def __init__(self, client, parent=None) -> None:
        super().__init__(client, parent)
        self.tiles: Dict[str, ZoneTile] = {}
        self._shape: Optional[Shape] = None
        self._calls: Dict[str, Tuple[int, int]] = {}  # zone: port of the run, number of the operation
        self.head = basic.Badge(1.3)
        self.head.setAlignment(Qt.AlignLeft)  # where it is too long, what comes first is seen
        self.body.addWidget(self.head)
        self._inside = QWidget()
        self._grid = QGridLayout(self._inside)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setSpacing(round(GAP_EMS * basic.em()))
        self._area = QScrollArea(widgetResizable=True)
        self._area.setFrameShape(QFrame.NoFrame)
        self._area.setWidget(self._inside)
        self.body.addWidget(self._area, 1)
        self._answer = Answer(reserved=False)
        self.body.addWidget(self._answer)
        self.stop = HoldButton(STOP_ALL, STOP_TIP, 1.4)
        self.stop.kept.connect(self._stop_all)
        self.stop.too_short.connect(lambda: self._answer.warn(HOLD_IT))
        self.body.addWidget(self.stop)
        self._key = TwiceKey(
            self, STOP_KEY, self.stop, self._answer, lambda: (STOP_ALL, STOP_ALL), self._stop_all
        )

    # -- showing ------------------------------------------------------------------------------------

    def where(self) -> str:
        return f"All zones  ·  {times.time_of_day(self.model.clock_s)} UTC" if self.model.gui else "All zones"

    def show_model(self) -> None:
        zones = list(self.model.gui.zones) if self.model.gui else []
        if list(self.tiles) != [zone.zone for zone in zones]:
            self._build(zones)
        old, calling = self.model.is_old, []
        for zone in zones:
            details = self.model.details_of(zone.zone)
            what = todo(zone, details)
            if what.urgency is Urgency.DO:
                calling.append(zone.zone)
                self._beep(zone, details)
            elif self._calls.get(zone.zone, NO_CALL)[1] == 0:  # switches have no number: the next ones call anew
                del self._calls[zone.zone]
            self.tiles[zone.zone].show_zone(zone, details, what, zone.zone == self.model.zone_name, old)
        running = self._running()
        self._show_head(running, calling)
        self.stop.allow(bool(running), [NONE_RUNS if self.model.gui else NOT_HEARD], basic.ALARM)
        self._key.forget()

    def resizeEvent(self, event) -> None:
        super().resizeEvent(event)
        self._arrange()

    def _running(self) -> List[str]:
        """The zones that run. Where the phase is not known, those that may be stopped: they may run."""
        found = []
        for zone in self.model.gui.zones if self.model.gui else ():
            details = self.model.details_of(zone.zone)
            if zone.stop_enabled and (details is None or details.phase == "running"):
                found.append(zone.zone)
        return found

    def _show_head(self, running: List[str], calling: List[str]) -> None:
        """The one look: who needs the referee's hand, and who is running."""
        if self.model.gui is None:
            self.head.show_text("Waiting for the core", basic.IDLE)
            return
        text = f"▶ RUNNING: {', '.join(running)}" if running else f"○ {NONE_RUNS}"
        tone = basic.RUNNING if running else basic.IDLE
        if calling:
            text, tone = f"☛ DO NOW: {', '.join(calling)}   {text}", basic.ALARM
        old = self.model.is_old
        self.head.show_text(f"({text})" if old else text, basic.IDLE if old else tone)

    def _beep(self, zone: ZoneState, details: Optional[ZoneDetails]) -> None:
        """Once for each call for the referee's hand, also in a zone that the other panels do not show."""
        if details is None or (zone.manual_operation and not details.operation):
            return  # the rest of it is still on its way
        call = (details.port, details.operation)
        if self._calls.get(zone.zone) != call:
            self._calls[zone.zone] = call
            QApplication.beep()

    def _build(self, zones: List[ZoneState]) -> None:
        """The schedule has other zones."""
        for tile in self.tiles.values():
            self._grid.removeWidget(tile)
            tile.hide()
            tile.deleteLater()
        self.tiles = {}
        for zone in zones:
            tile = self.tiles[zone.zone] = ZoneTile(zone.zone)
            tile.chosen.connect(self.model.choose_zone)
        self._shape = None
        self._arrange()

    def _arrange(self) -> None:
        """As many columns as let the tiles be largest."""
        if not self.tiles:
            return
        shape = best_shape(len(self.tiles), self._area.width() / basic.em(), self._area.height() / basic.em())
        if shape == self._shape:
            return
        self._shape = shape
        for index, tile in enumerate(self.tiles.values()):
            tile.scale(shape.factor, shape.compact)
            self._grid.addWidget(tile, *divmod(index, shape.columns))
        for column in range(len(self.tiles)):
            self._grid.setColumnStretch(column, 1 if column < shape.columns else 0)

    # -- stopping -----------------------------------------------------------------------------------

    def _stop_all(self) -> None:
        zones = self._running()
        self.stop.hold()
        self._answer.say(f"Stop {', '.join(zones)} …")
        outcomes: Dict[str, Outcome] = {}
        for zone in zones:
            answered = partial(self._stopped, zones, outcomes, zone)
            stop_run(self, zone, self.model.details_of(zone), answered)

    def _stopped(self, zones: List[str], outcomes: Dict[str, Outcome], zone: str, outcome: Outcome) -> None:
        outcomes[zone] = outcome
        failed = [f"{name}: {found.error}" for name, found in outcomes.items() if found.error]
        if failed:
            self.stop.let_go()
            self._answer.show_outcome("Stop", Outcome("; ".join(failed)))
        elif len(outcomes) == len(zones):
            self._answer.show_outcome(f"Stop {', '.join(zones)}", outcome)


def best_shape(tiles: int, wide_ems: float, high_ems: float) -> Shape:
    """With which shape so many tiles fill an area best, whose size is in units of the desktop's font."""
    full = _largest(tiles, wide_ems, high_ems, HIGH_EMS)
    if full.factor >= 1.0:
        return full._replace(factor=min(MOST, full.factor))
    shape = _largest(tiles, wide_ems, high_ems, COMPACT_EMS)
    return Shape(shape.columns, min(1.0, max(LEAST, shape.factor)), compact=True)


def _largest(tiles: int, wide_ems: float, high_ems: float, tile_ems: float) -> Shape:
    def shape(columns: int) -> Shape:
        rows = -(-tiles // columns)
        room = min(high_ems / (rows * (tile_ems + GAP_EMS)), wide_ems / (columns * (WIDE_EMS + GAP_EMS)))
        return Shape(columns, math.floor(20 * room) / 20)

    # Of equal ones the one with the fewest columns: a list is read more easily.
    return max(map(shape, range(1, tiles + 1)), key=lambda shape: (shape.factor, -shape.columns))
