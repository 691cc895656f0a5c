"""Tablet Status: the last messages of the tablet (docs/referee.md, "Tablet Status")."""

from typing import Dict

from roah_rsbb.rqt.panels.panel import Panel
from roah_rsbb.rqt.qt import QFormLayout, QLabel, Qt
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.language import tr, tr_later

# The tablet sends a beacon every second; after this long without one it is marked as silent.
TABLET_SILENT_S = 5.0

FIELDS = {
    "heard": tr_later("Last heard"),
    "display": tr_later("Display"),
    "call": tr_later("Last call"),
    "position": tr_later("Position"),
    "position_time": tr_later("Position received"),
}


class TabletStatusPanel(Panel):
    """Display, call and position of the tablet."""

    TITLE = tr_later("Tablet Status")
    TAB = tr_later("Tablet")

    def __init__(self, client) -> None:
        super().__init__(client)
        form = QFormLayout()
        form.setRowWrapPolicy(QFormLayout.WrapLongRows)
        self._values: Dict[str, QLabel] = {}
        for name, label in FIELDS.items():
            value = basic.enlarged(QLabel(wordWrap=True), 1.2)
            value.setTextFormat(Qt.PlainText)
            self._values[name] = value
            form.addRow(tr(label), value)
        self.body.addLayout(form)
        self.body.addStretch(1)

    def where(self) -> str:
        return tr("The whole box")

    def show_model(self) -> None:
        gui = self.model.gui
        if gui is None:
            self._values["heard"].setText(tr("Waiting for the core"))
            return
        now, beacon = self.model.clock_s, gui.tablet_last_beacon.to_sec()
        silent = f"  {tr('⚠ silent')}" if beacon and now - beacon > TABLET_SILENT_S else ""
        called = gui.tablet_call_time.to_sec()
        placed = gui.tablet_position_time.to_sec()
        moments = self.client.moments
        values = {
            "heard": f"{moments.and_age(beacon, now)}{silent}",
            "display": tr("Map") if gui.tablet_display_map else tr("Call button"),
            "call": moments.and_age(called, now),
            "position": f"x {gui.tablet_position_x:.2f} m, y {gui.tablet_position_y:.2f} m" if placed else tr("none"),
            "position_time": moments.and_age(placed, now),
        }
        utc_s = {"heard": beacon, "call": called, "position_time": placed}
        for name, value in values.items():
            self._values[name].setText(value)
            self._values[name].setToolTip(moments.tip(utc_s[name]) if utc_s.get(name) else "")
            self._values[name].setEnabled(not self.model.is_old)
