"""Tablet Status: the last messages of the tablet (docs/referee.md, "Tablet Status")."""

from typing import List

from roah_rsbb.rqt.panels.panel import Panel
from roah_rsbb.rqt.qt import QFormLayout, QLabel, Qt
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.whole_box import TABLET_FACTS, tablet_facts


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
        self.values: List[QLabel] = []
        for label in TABLET_FACTS:
            self.values.append(basic.enlarged(QLabel(wordWrap=True, textFormat=Qt.PlainText), 1.2))
            form.addRow(tr(label), self.values[-1])
        self.body.addLayout(form)
        self.body.addStretch(1)

    def show_model(self) -> None:
        if self.model.box is None:
            self.values[0].setText(tr("Waiting for the core"))

    def show_times(self) -> None:
        if self.model.box is None:
            return
        moments = self.client.moments
        for value, (text, utc_s) in zip(self.values, tablet_facts(self.model.box.tablet, self.model.now(), moments)):
            value.setText(text)
            value.setToolTip(moments.tip(utc_s) if utc_s else "")
            value.setEnabled(not self.model.is_old)
