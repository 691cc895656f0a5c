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
    WHERE = tr_later("The whole box")
    PARTS = ()

    def __init__(self, client) -> None:
        super().__init__(client)
        form = QFormLayout()
        form.setRowWrapPolicy(QFormLayout.WrapLongRows)
        self._values: Dict[str, QLabel] = {}
        for name, label in FIELDS.items():
            value = basic.enlarged(QLabel(wordWrap=True, textFormat=Qt.PlainText), 1.2)
            self._values[name] = value
            form.addRow(tr(label), value)
        self.body.addLayout(form)
        self.body.addStretch(1)

    def show_model(self) -> None:
        if self.model.box is None:
            self._values["heard"].setText(tr("Waiting for the core"))

    def show_times(self) -> None:
        if self.model.box is None:
            return
        tablet, now, moments = self.model.box.tablet, self.model.now(), self.client.moments
        silent_s = 0.0 if tablet.silent_since is None else now.mono - tablet.silent_since
        silent = f"  {tr('⚠ silent')}" if silent_s > TABLET_SILENT_S else ""
        utc_s = {"heard": now.utc - silent_s if tablet.heard else 0.0, "call": tablet.call_utc_s,
                 "position_time": tablet.position_utc_s}
        values = {name: moments.and_age(utc, now.utc) for name, utc in utc_s.items()}
        values["heard"] += silent
        values["display"] = tr("Map") if tablet.display_map else tr("Call button")
        values["position"] = (f"x {tablet.position_x:.2f} m, y {tablet.position_y:.2f} m" if tablet.position_utc_s
                              else tr("none"))
        for name, value in values.items():
            self._values[name].setText(value)
            self._values[name].setToolTip(moments.tip(utc_s[name]) if utc_s.get(name) else "")
            self._values[name].setEnabled(not self.model.is_old)
