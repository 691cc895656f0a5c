"""Active Robots: every robot that the box hears (docs/referee.md, "Active Robots")."""

from typing import List, Tuple

from roah_rsbb.model.document import RobotSeen
from roah_rsbb.rqt.model import link_quality
from roah_rsbb.rqt.panels.collapsing import CollapsingPanel
from roah_rsbb.rqt.qt import QAbstractItemView, QHeaderView, Qt, QTableWidget, QTableWidgetItem
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording import times
from roah_rsbb.wording.language import tr, tr_later

COLUMNS = (
    tr_later("Team"), tr_later("Robot"), tr_later("Link"), tr_later("Clock skew"), tr_later("Run in zone"),
    tr_later("Last heard"),
)
NO_RUN = "–"
LINK, SKEW = 2, 3  # columns with tooltips


class ActiveRobotsPanel(CollapsingPanel):
    """A table with one row per robot."""

    TITLE = tr_later("Active Robots")
    TAB = tr_later("Robots")
    WHERE = tr_later("The whole box")
    PARTS = ("robots", "zones")

    def __init__(self, client) -> None:
        super().__init__(client)
        self.table = basic.enlarged(QTableWidget(0, len(COLUMNS)), 1.1)
        self.table.setHorizontalHeaderLabels([tr(column) for column in COLUMNS])
        self.table.horizontalHeaderItem(LINK).setToolTip(basic.tip(tr(
            "Longest silence of the robot in the last {time:.0f} s. It sends every second.",
            time=link_quality.WINDOW_S)))
        self.table.horizontalHeaderItem(SKEW).setToolTip(basic.tip(tr(
            "The robot's clock minus the box's: + is ahead, - is behind")))
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeToContents)
        self.table.horizontalHeader().setStretchLastSection(True)
        self.table.verticalHeader().hide()
        self.table.verticalHeader().setSectionResizeMode(QHeaderView.ResizeToContents)
        self.table.setEditTriggers(QAbstractItemView.NoEditTriggers)
        self.table.setSelectionMode(QAbstractItemView.NoSelection)
        self.table.setFocusPolicy(Qt.NoFocus)
        self.body.addWidget(self.table, 1)
        self._links = link_quality.LinkQuality()
        # Also while the panel is hidden: the quality depends on the past.
        self.model.ticked.connect(self._observe)

    def shutdown(self) -> None:
        self.model.ticked.disconnect(self._observe)
        super().shutdown()

    def _observe(self) -> None:
        if self.model.document is not None:
            self._links.observe(self.model.now().mono, {
                name: robot.silent_since for name, robot in self.model.document.robots.items()})

    def show_model(self) -> None:
        self._observe()
        self.table.setEnabled(not self.model.is_old)

    def show_times(self) -> None:
        document = self.model.document
        robots = [] if document is None else sorted(document.robots.items(), key=lambda item: item[1][:2])
        self._show_lines([self._line(name, robot) for name, robot in robots] or [self._nobody()])

    def _nobody(self) -> Tuple[str, ...]:
        text = tr("No robot is heard") if self.model.document else tr("Waiting for the core")
        return (text, *("" for _ in COLUMNS[1:]))

    def _line(self, name: str, robot: RobotSeen) -> Tuple[str, ...]:
        silent_since = robot.silent_since
        return (
            robot.team,
            robot.robot,
            link_quality.text(self._links.longest_silence_s(name)),
            times.skew(robot.skew),
            self.model.document.zone_of(name) or NO_RUN,
            times.ago(0.0 if silent_since is None else self.model.now().mono - silent_since),
        )

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
