"""A zone in the panel Overview: its phase, team, countdown, and what must be done there now."""

from typing import Optional

from python_qt_binding.QtCore import QSize, Qt, Signal
from python_qt_binding.QtWidgets import QFrame, QGridLayout, QLabel, QSizePolicy, QWidget

from roah_rsbb.msg import ZoneDetails, ZoneState
from roah_rsbb.rqt.panels import phases
from roah_rsbb.rqt.panels.todo import Todo, Urgency
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording import times

# At a factor of 1 a tile needs this room, in units of the desktop's font; a compact one is lower.
HIGH_EMS = 5.6
COMPACT_EMS = 3.7
WIDE_EMS = 20.0
# A text that is too long for its place is written smaller, by these factors, before it is cut off.
SHRINK = (1.0, 0.85, 0.7)
LINES = {
    Urgency.DO: ("☛ DO NOW: ", basic.ALARM),
    Urgency.LOOK: ("⚠ ", basic.OLD),
    Urgency.POSSIBLE: ("→ ", basic.READY),
    Urgency.NONE: ("", basic.OFF),
}
CHOSEN = "◆ "


class _TodoLabel(QLabel):
    """Takes the room that there is: a long text makes no tile larger than the others. Its beginning is always seen."""

    def __init__(self) -> None:
        super().__init__(wordWrap=True)
        self.factor = 1.0
        self.setTextFormat(Qt.PlainText)
        self.setSizePolicy(QSizePolicy.Ignored, QSizePolicy.Expanding)

    def hasHeightForWidth(self) -> bool:
        return False

    def sizeHint(self) -> QSize:
        return QSize(1, round(1.3 * self.factor * basic.em()))

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def settle(self) -> None:
        """Write the text as large as its place allows."""
        fits = False
        for shrink in SHRINK:
            basic.enlarged(self, shrink * self.factor, bold=True)
            fits = self.heightForWidth(self.width()) <= self.height()
            if fits:
                break
        self.setAlignment(Qt.AlignLeft | (Qt.AlignVCenter if fits else Qt.AlignTop))

    def resizeEvent(self, event) -> None:
        super().resizeEvent(event)
        self.settle()


class ZoneTile(QFrame):
    """One zone. A click, or Enter, chooses it for all panels of this client."""

    chosen = Signal(str)

    def __init__(self, zone: str, parent: Optional[QWidget] = None) -> None:
        super().__init__(parent)
        self.zone = zone
        self.setObjectName(f"zone {zone}")
        self.setFocusPolicy(Qt.TabFocus)
        self.setCursor(Qt.PointingHandCursor)
        self.setToolTip(basic.tip(f"Show {zone} in all panels of this client"))
        self.setAccessibleName(zone)
        self.name, self.countdown, self.event = QLabel(), QLabel(alignment=Qt.AlignRight), QLabel()
        self.phase = basic.Badge()
        self.todo = _TodoLabel()
        for label in (self.name, self.countdown, self.event):
            label.setTextFormat(Qt.PlainText)
        for label in (self.name, self.event):
            label.setSizePolicy(QSizePolicy.Ignored, QSizePolicy.Preferred)
        self._grid = grid = QGridLayout(self)
        grid.setVerticalSpacing(round(0.1 * basic.em()))
        grid.addWidget(self.countdown, 0, 2)
        grid.addWidget(self.event, 1, 1, 1, 2)
        grid.addWidget(self.todo, 2, 0, 1, 3)
        grid.setColumnStretch(1, 1)
        grid.setRowStretch(2, 1)
        self.scale(1.0, False)

    def scale(self, factor: float, compact: bool) -> None:
        """Make all of it so many times as large as the desktop's font calls for; `compact`: in two lines."""
        self._compact = compact
        self.event.setVisible(not compact)
        if compact:
            self._grid.addWidget(self.phase, 0, 0)
            self._grid.addWidget(self.name, 0, 1)
        else:
            self._grid.addWidget(self.name, 0, 0, 1, 2)
            self._grid.addWidget(self.phase, 1, 0)
        edge = round((0.15 if compact else 0.35) * basic.em())
        self._grid.setContentsMargins(edge, edge, edge, edge)
        for label, share, bold in ((self.name, 1.2 if compact else 1.4, True), (self.phase, 0.95, True),
                                   (self.countdown, 1.35 if compact else 1.7, True), (self.event, 1.0, False)):
            basic.enlarged(label, share * factor, bold)
        self.todo.factor = 1.15 * factor
        self.todo.settle()
        self.setMinimumHeight(round((COMPACT_EMS if compact else HIGH_EMS) * factor * basic.em()))

    def show_zone(self, zone: ZoneState, details: Optional[ZoneDetails], todo: Todo, chosen: bool, old: bool) -> None:
        """Show the zone; `chosen`: it is the one of the other panels; `old`: the core is silent."""
        name = f"{zone.zone}  ·  {zone.team}" if self._compact else zone.zone
        self.name.setText(f"{CHOSEN if chosen else ''}{name}")
        left = times.countdown(zone.timer.to_sec())
        self.countdown.setText(f"({left})" if old else left)
        phase = phases.shown(details)
        self.phase.show_text(phase.text, basic.IDLE if old else phase.tone)
        self.event.setText(f"{zone.team}  ·  {zone.code}  ·  round {zone.round}, run {zone.run}")
        mark, tone = LINES[todo.urgency]
        more = todo.warnings - (todo.urgency is Urgency.LOOK)
        self.todo.setText(f"{mark}{todo.text}{f'   (⚠ {more} more)' if more > 0 else ''}")
        self.todo.setToolTip(basic.tip(self.todo.text()))  # all of it, also where it is too long for its place
        tone = basic.OFF if old else tone
        basic.set_style(self.todo, f"background: {tone.background}; color: {tone.text}; padding: 0.1em 0.3em;")
        self.todo.settle()
        for label in (self.name, self.countdown, self.event, self.todo):
            label.setEnabled(not old)
        border = "0.25em solid palette(highlight)" if chosen else "0.1em solid palette(mid)"
        basic.set_style(self, f"ZoneTile {{ border: {border}; border-radius: 0.3em; }}"
                                "ZoneTile:focus { border-style: dashed; }")

    def mouseReleaseEvent(self, event) -> None:
        if event.button() == Qt.LeftButton and self.rect().contains(event.pos()):
            self.chosen.emit(self.zone)

    def keyPressEvent(self, event) -> None:
        if event.key() in (Qt.Key_Return, Qt.Key_Enter, Qt.Key_Space):
            self.chosen.emit(self.zone)
        else:
            super().keyPressEvent(event)
