"""Active Robots: every robot that the box hears (docs/referee.md, "Active Robots")."""

from typing import List, Tuple

from roah_rsbb.msg import RobotInfo
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
        self.model.updated.connect(self._observe)

    def shutdown(self) -> None:
        self.model.updated.disconnect(self._observe)
        super().shutdown()

    def _observe(self) -> None:
        if self.model.gui is not None:
            heard = {(r.team, r.robot): r.beacon.to_sec() for r in self.model.gui.active_robots}
            self._links.observe(self.model.clock_s, heard)

    def show_model(self) -> None:
        gui = self.model.gui
        robots = gui.active_robots if gui else []
        self.table.setEnabled(not self.model.is_old)
        self._show_lines([self._line(robot) for robot in robots] or [self._nobody()])

    def where(self) -> str:
        return tr("The whole box")

    def _nobody(self) -> Tuple[str, ...]:
        text = tr("No robot is heard") if self.model.gui else tr("Waiting for the core")
        return (text, *("" for _ in COLUMNS[1:]))

    def _zone_of(self, robot: RobotInfo) -> str:
        """Return the zone of the run that the robot takes part in."""
        gui, details = self.model.gui, self.model.details
        if gui is None or details is None:
            return NO_RUN
        teams = {z.zone: z.team for z in gui.zones}
        name = f"{robot.robot} of team {robot.team}: "
        for zone in details.zones:
            # If all robots run at once, each has a line.
            is_alone_in_it = (teams.get(zone.zone), zone.robot) == (robot.team, robot.robot)
            if is_alone_in_it or any(line.startswith(name) for line in zone.robots):
                return zone.zone
        return NO_RUN

    def _line(self, robot: RobotInfo) -> Tuple[str, ...]:
        return (
            robot.team,
            robot.robot,
            link_quality.text(self._links.longest_silence_s((robot.team, robot.robot))),
            times.skew(robot.skew.to_sec()),
            self._zone_of(robot),
            times.ago(self.model.clock_s - robot.beacon.to_sec()),
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
