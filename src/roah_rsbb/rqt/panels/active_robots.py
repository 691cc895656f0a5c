"""Active Robots: every robot that the box hears (docs/referee.md, "Active Robots")."""

from typing import List, Tuple

from roah_rsbb.rqt.panels.collapsing import CollapsingPanel
from roah_rsbb.rqt.qt import QAbstractItemView, QHeaderView, Qt, QTableWidget, QTableWidgetItem
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.whole_box import ROBOT_COLUMNS, LinkQuality, column_explanations, robot_rows


class ActiveRobotsPanel(CollapsingPanel):
    """A table with one row per robot."""

    TITLE = tr_later("Active Robots")
    TAB = tr_later("Robots")
    WHERE = tr_later("The whole box")
    PARTS = ("robots", "zones")

    def __init__(self, client) -> None:
        super().__init__(client)
        self.table = basic.enlarged(QTableWidget(0, len(ROBOT_COLUMNS)), 1.1)
        self.table.setHorizontalHeaderLabels([tr(column) for column in ROBOT_COLUMNS])
        for column, explanation in column_explanations().items():
            self.table.horizontalHeaderItem(column).setToolTip(basic.tip(explanation))
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeToContents)
        self.table.horizontalHeader().setStretchLastSection(True)
        self.table.verticalHeader().hide()
        self.table.verticalHeader().setSectionResizeMode(QHeaderView.ResizeToContents)
        self.table.setEditTriggers(QAbstractItemView.NoEditTriggers)
        self.table.setSelectionMode(QAbstractItemView.NoSelection)
        self.table.setFocusPolicy(Qt.NoFocus)
        self.body.addWidget(self.table, 1)
        self._links = LinkQuality()
        # Also while the panel is hidden: the quality depends on the past.
        self.model.ticked.connect(self._observe)

    def shutdown(self) -> None:
        self.model.ticked.disconnect(self._observe)
        super().shutdown()

    def _observe(self) -> None:
        if self.model.document is not None:
            self._links.look(self.model.document, self.model.now().mono)

    def show_model(self) -> None:
        self._observe()
        self.table.setEnabled(not self.model.is_old)

    def show_times(self) -> None:
        document = self.model.document
        robots = [] if document is None else robot_rows(document, self.model.now().mono, self._links)
        self._show_lines(robots or [self._nobody()])

    def _nobody(self) -> Tuple[str, ...]:
        text = tr("No robot is heard") if self.model.document else tr("Waiting for the core")
        return (text, *("" for _ in ROBOT_COLUMNS[1:]))

    def _show_lines(self, lines: List[Tuple[str, ...]]) -> None:
        self.table.setRowCount(len(lines))
        for row, line in enumerate(lines):
            for column, text in enumerate(line):
                item = self.table.item(row, column)
                if item is None:
                    item = QTableWidgetItem()
                    self.table.setItem(row, column, item)
                if item.text() != text:
                    item.setText(text)
