"""A small STOP above all windows, with a button for each zone that runs. Each zone has a place of its own, at which no
other one ever appears: whoever is frightened presses twice.

It appears while a run is in progress and none of our windows hears Esc: they are minimised, or another program is in
front. The titles of our windows and, where the desktop has one, a notification say so, too. Below each button it shows
how far the STOP of that zone came, and in its heading what the referee must know first.

It never goes by itself, and when it goes, it first stays for a moment: a hand that was on its way to it must not hit
what is behind it, such as START.
"""

from functools import partial
from typing import Dict, List, Optional, Set, Tuple

from roah_rsbb.rqt import basic, process
from roah_rsbb.rqt.basic import MarkedTitle
from roah_rsbb.rqt.model import Model
from roah_rsbb.rqt.qt import (
    QApplication,
    QGridLayout,
    QGuiApplication,
    QPoint,
    QRect,
    QStyle,
    QSystemTrayIcon,
    Qt,
    QTimer,
    QToolButton,
    QWidget,
)
from roah_rsbb.rqt.stop_strip import ABOVE_ALL, STOP, WIDE_EMS, StopButton, StopStrip, clear_place, strips_in_sight
from roah_rsbb.rqt.stops import SentStop, Stops, short_of, stoppable, text_of
from roah_rsbb.wording import stop as ways
from roah_rsbb.wording.language import tr, tr_later

DEAF = tr_later("Esc is off: click here first")
NOTICE = tr_later("Esc is off, because another window is in front. Press this STOP, or click the window of the RSBB")
COLUMNS = 3
HEADING = tr_later("RSBB: runs in progress")
NO_RUNS = tr_later("RSBB: no run is in progress")
GOES = tr_later("This STOP closes …")
CLOSE_TIP = tr_later("Close until another run begins, or the window of the RSBB is in front again")
STAYS_TIP = tr_later("It stays: a STOP has not arrived, or a robot did not answer it")
HEADING_HIGH_EMS, WAY_HIGH_EMS = 3.2, 1.3
# How long it stays after it was closed, or touched after that.
GOES_MS = 1500


class StopWindow(QWidget):
    """The small window. It never takes the focus from the program in front. Drag it by its heading."""

    def __init__(self, model: Model, stops: Stops) -> None:
        super().__init__(None, ABOVE_ALL)
        self.setAttribute(Qt.WA_ShowWithoutActivating)
        self.setWindowTitle(tr(STOP))
        self._model = model
        self._stops = stops
        self._was_in_front = False
        # When the referee closed it: the zones that ran. Closed until another run begins, or one of our windows is in
        # front again.
        self._closed_with: Optional[List[str]] = None
        self._held_at = None
        self._goes = QTimer(self, singleShot=True)  # runs while it is shown, but is not needed any more
        self._goes.timeout.connect(self._hide)
        self._tray: Optional[QSystemTrayIcon] = None
        self._titles: Dict[StopStrip, MarkedTitle] = {}
        self._zones: List[str] = []  # each has a place
        self.buttons: Dict[str, StopButton] = {}
        self.ways: Dict[str, basic.FilledLabel] = {}  # below the buttons
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(3, 3, 3, 3)
        self._grid.setVerticalSpacing(2)
        self.heading = basic.FilledLabel()
        self.heading.setFixedHeight(round(HEADING_HIGH_EMS * basic.em()))
        self.heading.setMinimumWidth(round(WIDE_EMS * basic.em()))
        self.close_button = QToolButton(text="✕")
        self.close_button.clicked.connect(self._close)
        self._grid.addWidget(self.heading, 0, 0, 1, COLUMNS - 1)
        self._grid.addWidget(self.close_button, 0, COLUMNS - 1, Qt.AlignRight)
        model.updated.connect(self.refresh)
        model.ticked.connect(self.refresh)
        stops.changed.connect(self.refresh)
        QGuiApplication.instance().applicationStateChanged.connect(self.refresh)

    def end(self) -> None:
        """Close it for good."""
        self._model.updated.disconnect(self.refresh)
        self._model.ticked.disconnect(self.refresh)
        self._stops.changed.disconnect(self.refresh)
        QGuiApplication.instance().applicationStateChanged.disconnect(self.refresh)
        self._hide()
        self.close()

    def refresh(self, *_: object) -> None:
        """Show it if it is needed."""
        is_in_front = QGuiApplication.applicationState() == Qt.ApplicationActive
        if is_in_front:
            self._was_in_front, self._closed_with = True, None
        running = stoppable(self._model)
        if self._closed_with is not None:
            self._closed_with = None if set(running) - set(self._closed_with) else running
        is_behind = self._was_in_front and not is_in_front
        sent = self._stops.sent()
        is_lost = any(one.way in ways.LOST for one in sent)
        if is_lost:
            self._closed_with = None
        is_needed = bool(running) or self.isVisible() or any(one.way not in ways.DONE for one in sent)
        self._mark_titles(is_behind and bool(running))
        if is_behind and self._closed_with is None and is_needed:
            self._goes.stop()
        elif not self.isVisible():
            return
        else:
            self._go()
        self._build(running, {one.zone for one in sent})
        if not self.isVisible():
            self._appear()
        with process.reported(tr("The line beside STOP")):
            self.close_button.setEnabled(not is_lost)
            self.close_button.setToolTip(basic.tip(tr(STAYS_TIP if is_lost else CLOSE_TIP)))
            self._show_ways(running, sent)

    def _go(self) -> None:
        """Begin to go. Our own window may have come in front of it."""
        self.raise_()
        if not self._goes.isActive():
            self._goes.start(GOES_MS)

    def _stay(self) -> None:
        """It was touched while it goes: another touch may follow."""
        if self._goes.isActive():
            self._goes.start(GOES_MS)

    def _show_ways(self, running: List[str], sent: List[SentStop]) -> None:
        of_zone = {one.zone: one for one in sent}
        for zone, label in self.ways.items():
            one = of_zone.get(zone)
            _show(label, "" if one is None else short_of(one), basic.OFF if one is None else tone_of(one))
        if self._goes.isActive():
            _show(self.heading, tr(GOES), basic.IDLE)
        elif sent:
            _show(self.heading, text_of(sent[0])[0], tone_of(sent[0]))
        else:
            _show(self.heading, tr(HEADING if running else NO_RUNS), basic.OFF)

    def _mark_titles(self, is_deaf: bool) -> None:
        self._titles = {strip: self._titles.get(strip) or MarkedTitle(strip.window(), DEAF)
                        for strip in StopStrip.shown}
        for title in self._titles.values():
            title.show(is_deaf)

    def _appear(self) -> None:
        self.adjustSize()
        area = QApplication.primaryScreen().availableGeometry()
        self._put(area.bottomLeft())
        self.show()
        self.raise_()
        if QSystemTrayIcon.isSystemTrayAvailable():
            self._tray = QSystemTrayIcon(self.style().standardIcon(QStyle.SP_MessageBoxCritical), self)
            self._tray.show()
            self._tray.showMessage(tr(STOP), tr(NOTICE))

    def _hide(self) -> None:
        self._goes.stop()
        self.hide()
        if self._tray is not None:
            self._tray.hide()
            self._tray = None

    def _close(self) -> None:
        self._closed_with = stoppable(self._model)
        self._stay()
        self.refresh()

    def _build(self, running: List[str], stopped: Set[str]) -> None:
        """Show a button for each zone that runs, or whose STOP is shown."""
        zones = self._model.zone_names
        if zones != self._zones:
            self._keep_places(zones)
        shown = [zone for zone in zones if zone in running or zone in stopped]
        for zone in [zone for zone in self.buttons if zone not in shown]:
            self._remove(zone)
        for zone in shown:
            if zone not in self.buttons:
                button = self.buttons[zone] = StopButton()
                button.pressed.connect(partial(self._press, zone))
                way = self.ways[zone] = basic.FilledLabel()
                way.setFixedHeight(round(WAY_HIGH_EMS * basic.em()))
                way.setAlignment(Qt.AlignCenter)
                row, column = self._cell(zones.index(zone))
                self._grid.addWidget(button, row, column)
                self._grid.addWidget(way, row + 1, column)
                way.show()
            self.buttons[zone].show_target(zone in running, zone=zone)

    def _keep_places(self, zones: List[str]) -> None:
        """Keep the places of these zones free."""
        self._zones = zones
        for zone in list(self.buttons):
            self._remove(zone)
        size = StopButton().size()
        for place in range(len(zones)):
            row, column = self._cell(place)
            self._grid.setRowMinimumHeight(row, size.height())
            self._grid.setRowMinimumHeight(row + 1, round(WAY_HIGH_EMS * basic.em()))
            self._grid.setColumnMinimumWidth(column, size.width())
        self.adjustSize()
        self._put(self.pos())

    @staticmethod
    def _cell(place: int) -> Tuple[int, int]:
        return 1 + 2 * (place // COLUMNS), place % COLUMNS

    def _remove(self, zone: str) -> None:
        for part in (self.buttons.pop(zone), self.ways.pop(zone)):
            self._grid.removeWidget(part)
            part.hide()
            part.deleteLater()

    def _press(self, zone: str) -> None:
        self._stops.stop([zone])
        self._stay()

    def _put(self, wanted: QPoint) -> None:
        """Move it to a place on the screen that is not over STOP of our windows: it may name another zone there."""
        screen = QApplication.screenAt(self.geometry().center()) or QApplication.primaryScreen()
        area = screen.availableGeometry()
        place = QRect(max(area.left(), min(wanted.x(), area.right() + 1 - self.width())),
                      max(area.top(), min(wanted.y(), area.bottom() + 1 - self.height())), self.width(), self.height())
        self.move(clear_place(place, strips_in_sight(), area).topLeft())

    def mousePressEvent(self, event) -> None:
        self._held_at = event.globalPos() - self.pos()
        self._stay()

    def mouseMoveEvent(self, event) -> None:
        if self._held_at is not None:
            self.move(event.globalPos() - self._held_at)


def tone_of(one: SentStop) -> basic.Tone:
    """Return the colour in which a STOP is shown."""
    if one.refused or one.way in ways.LOST:
        return basic.ALARM
    return basic.DONE if one.way in ways.DONE else basic.OFF


def _show(label: basic.FilledLabel, text: str, tone: basic.Tone) -> None:
    basic.set_style(label, tone.css)
    label.show_text(text)
