"""Overview: all zones at a glance (docs/referee.md, "Overview")."""

import math
from typing import Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.rqt import basic
from roah_rsbb.rqt.model import NOT_HEARD
from roah_rsbb.rqt.panels.panel import CollapsingPanel
from roah_rsbb.rqt.panels.run_times import known, marked, phase_look, tone_of
from roah_rsbb.rqt.qt import (
    QApplication,
    QFrame,
    QGridLayout,
    QLabel,
    QScrollArea,
    QSizePolicy,
    Qt,
    QWidget,
    Signal,
)
from roah_rsbb.rqt.stops import NONE_RUNS
from roah_rsbb.wording import sheets
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.times import Clock, clock_lines
from roah_rsbb.wording.todo import Todo, Urgency, todo

# Size of a tile at scale 1, in units of the desktop's font.
HIGH_EMS, WIDE_EMS = 5.6, 20.0
LINES = {
    Urgency.DO: (tr_later("☛ DO NOW: "), basic.ALARM),
    Urgency.LOOK: ("⚠ ", basic.OLD),
    Urgency.POSSIBLE: ("→ ", basic.OFF),
    Urgency.NONE: ("", basic.OFF),
}
CHOSEN = "◆ "


class ZoneTile(QFrame):
    """One zone: its team, phase, countdown, and what to do now. A click or Enter chooses it for this client."""

    chosen = Signal(str)

    def __init__(self, zone: str) -> None:
        super().__init__()
        self.zone = zone
        self.setObjectName(f"zone {zone}")
        self.setFocusPolicy(Qt.TabFocus)
        self.setCursor(Qt.PointingHandCursor)
        self.setToolTip(basic.tip(tr("Show {zone} in all panels of this client", zone=zone)))
        self.setAccessibleName(zone)
        self.name, self.event = basic.ShortenedLabel(), basic.ShortenedLabel()
        self.countdown = QLabel(alignment=Qt.AlignRight, textFormat=Qt.PlainText)
        self.phase = basic.Badge()
        self.todo = basic.FilledLabel()
        for label in (self.name, self.event):
            label.setSizePolicy(QSizePolicy.Ignored, QSizePolicy.Preferred)
        self._grid = grid = QGridLayout(self)
        grid.setVerticalSpacing(round(0.1 * basic.em()))
        grid.addWidget(self.name, 0, 0, 1, 2)
        grid.addWidget(self.countdown, 0, 2)
        grid.addWidget(self.event, 1, 0)
        grid.addWidget(self.phase, 1, 1, 1, 2)
        grid.addWidget(self.todo, 2, 0, 1, 3)
        grid.setColumnStretch(0, 1)
        grid.setRowStretch(2, 1)
        self.scale(1.0)

    def scale(self, factor: float) -> None:
        """Scale the tile relative to the desktop's font."""
        edge = round(0.35 * factor * basic.em())
        self._grid.setContentsMargins(edge, edge, edge, edge)
        for label, share, bold in ((self.name, basic.LEAD, True), (self.phase, basic.TEXT, True),
                                   (self.countdown, basic.TITLE, True), (self.event, basic.TEXT, False)):
            basic.enlarged(label, share * factor, bold)
        self.todo.factor = factor
        self.todo.settle()
        self.setMinimumHeight(round(HIGH_EMS * factor * basic.em()))

    def show_zone(self, zone: ZoneSeen, todo: Todo, chosen: bool, old: bool) -> None:
        """Show the zone. `chosen`: the other panels show it; `old`: the core is silent."""
        event = zone.event
        self.name.setText(f"{CHOSEN if chosen else ''}{zone.zone}")
        self.event.setText(f"{event.team}  ·  {event.code}  ·  {sheets.turn(event.round, event.run)}")
        mark, tone = LINES[todo.urgency]
        text = f"{tr(mark)}{todo.text}" + (f"   ({todo.more})" if todo.more else "")
        self.todo.show_text(text)
        self.todo.setToolTip(basic.tip(text))  # the whole text, if it does not fit
        tone = basic.OFF if old else tone
        basic.set_style(self.todo, f"{tone.css} padding: 0.1em 0.3em;")
        for label in (self.name, self.countdown, self.event, self.todo):
            label.setEnabled(not old)
        border = "0.15em solid palette(text)" if chosen else "1px solid palette(midlight)"
        basic.set_style(self, f"ZoneTile {{ border: {border}; border-radius: 0.5em; background: palette(base); }}"
                                "ZoneTile:focus { border-style: dashed; }")

    def show_clock(self, zone: ZoneSeen, clock: Optional[Clock], old: bool) -> None:
        """Show the time and the phase; see `show_zone`."""
        figure = known(clock).main
        self.countdown.setText(f"({figure.text})" if old else marked(figure))
        self.countdown.setToolTip(basic.tip("\n".join(clock_lines(known(clock)))))
        tone = None if old else tone_of(figure)
        basic.set_style(self.countdown, tone.css if tone else "")
        phase = phase_look(zone, clock)
        self.phase.show_text(phase.text, basic.IDLE if old else phase.tone)

    def mouseReleaseEvent(self, event) -> None:
        if event.button() == Qt.LeftButton and self.rect().contains(event.pos()):
            self.chosen.emit(self.zone)

    def keyPressEvent(self, event) -> None:
        if event.key() in (Qt.Key_Return, Qt.Key_Enter, Qt.Key_Space):
            self.chosen.emit(self.zone)
        else:
            super().keyPressEvent(event)


NO_CALL = ("", -1)
# Tiles grow with the panel, so that they can be read from a distance. Where space is short, they scroll.
LEAST, MOST = 0.8, 3.5
# Between two tiles, in units of the desktop's font.
GAP_EMS = 0.3


class TileArrangement(NamedTuple):
    """How the tiles are arranged."""

    columns: int
    factor: float  # scale, relative to the desktop's font


class OverviewPanel(CollapsingPanel):
    """A tile for each zone, in the order of the schedule, so that no tile moves under the mouse."""

    TITLE = tr_later("Overview")
    PARTS = ("zones",)
    WORKS_BEHIND = True

    def __init__(self, client) -> None:
        super().__init__(client)
        self.tiles: Dict[str, ZoneTile] = {}
        self._shape: Optional[TileArrangement] = None
        self._calls: Dict[str, Tuple[str, int]] = {}  # zone: identity of the run, number of the operation
        self.head = basic.Badge(basic.LEAD)
        self.head.setAlignment(Qt.AlignLeft | Qt.AlignVCenter)  # if the text is too long, its beginning stays visible
        self.body.addWidget(self.head)
        self._inside = QWidget()
        self._grid = basic.flat(QGridLayout(self._inside))
        self._grid.setSpacing(round(GAP_EMS * basic.em()))
        self._area = QScrollArea(widgetResizable=True)
        self._area.setFrameShape(QFrame.NoFrame)
        self._area.setWidget(self._inside)
        self.body.addWidget(self._area, 1)

    # -- showing ------------------------------------------------------------------------------------

    def show_collapsed(self, is_collapsed: bool) -> None:
        """Keep the line with the zones that need the referee, in the heading."""
        super().show_collapsed(is_collapsed)
        self._where.setVisible(not is_collapsed)
        basic.enlarged(self.head, basic.TEXT if is_collapsed else basic.LEAD, bold=True)
        if is_collapsed:
            self.heading.insertWidget(1, self.head, 2)
        else:
            self.body.insertWidget(0, self.head)

    def where(self) -> str:
        clock = f"  ·  {self.client.moments.with_zone(self.model.now().utc)}" if self.model.document else ""
        return tr("All zones") + clock

    def where_tip(self) -> str:
        return self.client.moments.tip(self.model.now().utc) if self.model.document else ""

    def show_model(self) -> None:
        zones = list(filter(None, map(self.model.zone_of, self.model.zone_names)))
        if list(self.tiles) != [zone.zone for zone in zones]:
            self._build(zones)
        old, calling = self.model.is_old, []
        for zone in zones:
            what = todo(zone)
            if what.urgency is Urgency.DO:
                calling.append(zone.zone)
                self._beep(zone)
            elif self._calls.get(zone.zone, NO_CALL)[1] == 0:  # switches have no number: the next request is new
                del self._calls[zone.zone]
            self.tiles[zone.zone].show_zone(zone, what, zone.zone == self.model.zone_name, old)
        self._show_head(self.model.running_zones(), calling)

    def show_times(self) -> None:
        for name, tile in self.tiles.items():
            zone = self.model.zone_of(name)
            if zone is not None:
                tile.show_clock(zone, self.model.clock_of(name), self.model.is_old)

    def resizeEvent(self, event) -> None:
        super().resizeEvent(event)
        self._arrange()

    def _show_head(self, running: List[str], calling: List[str]) -> None:
        """Show which zones need the referee, and which are running."""
        if self.model.document is None:
            self.head.show_text(tr(NOT_HEARD), basic.IDLE)
            return
        text = tr("▶ RUNNING: {zones}", zones=", ".join(running)) if running else f"○ {tr(NONE_RUNS)}"
        tone = basic.PHASES["executing"] if running else basic.IDLE
        if calling:
            text, tone = f"{tr(LINES[Urgency.DO][0])}{', '.join(calling)}   {text}", basic.ALARM
        old = self.model.is_old
        self.head.show_text(f"({text})" if old else text, basic.IDLE if old else tone)

    def _beep(self, zone: ZoneSeen) -> None:
        """Beep once for each request to the referee, also in zones that the other panels do not show."""
        call = (zone.identity, zone.operation)
        if self._calls.get(zone.zone) != call:
            self._calls[zone.zone] = call
            QApplication.beep()

    def _build(self, zones: List[ZoneSeen]) -> None:
        """Create the tiles again: the schedule has other zones."""
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
        """Arrange the tiles in the columns that make them largest."""
        if not self.tiles:
            return
        shape = best_arrangement(len(self.tiles), self._area.width() / basic.em(), self._area.height() / basic.em())
        if shape == self._shape:
            return
        self._shape = shape
        for index, tile in enumerate(self.tiles.values()):
            tile.scale(shape.factor)
            self._grid.addWidget(tile, *divmod(index, shape.columns))
        for column in range(len(self.tiles)):
            self._grid.setColumnStretch(column, 1 if column < shape.columns else 0)


def best_arrangement(tiles: int, wide_ems: float, high_ems: float) -> TileArrangement:
    """Return the arrangement that fills an area best. Its size is in units of the desktop's font."""
    def shape(columns: int) -> TileArrangement:
        rows = -(-tiles // columns)
        factor = min(high_ems / (rows * (HIGH_EMS + GAP_EMS)), wide_ems / (columns * (WIDE_EMS + GAP_EMS)))
        return TileArrangement(columns, min(MOST, max(LEAST, math.floor(20 * factor) / 20)))

    # Among equals, prefer fewer columns: a list is easier to read.
    return max(map(shape, range(1, tiles + 1)), key=lambda shape: (shape.factor, -shape.columns))
