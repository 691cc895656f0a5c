"""Our own window with all panels, for machines without rqt."""

import math
from typing import Dict

from roah_rsbb.rqt.app.application import PanelSettings, open_at
from roah_rsbb.rqt.app.panel_list import PANELS, load
from roah_rsbb.rqt.model.client import RefereeClient
from roah_rsbb.rqt.panels.core_status import CoreStatusPanel
from roah_rsbb.rqt.panels.panel import Panel
from roah_rsbb.rqt.qt import QDockWidget, QMainWindow, QSettings, Qt
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.widgets.marked_title import MarkedTitle
from roah_rsbb.rqt.with_ros.host import HostWithRos
from roah_rsbb.wording.language import tr

# Increase it when the set of panels changes: an older layout would hide new panels.
LAYOUT_VERSION = 7


class Window(QMainWindow):
    """All panels, as docks that can be moved, stacked and closed. The layout is saved."""

    def __init__(self, host: HostWithRos, settings: QSettings, of_launch: bool = False) -> None:
        """`of_launch`: closing the window asks, then ends what was launched; otherwise it just closes."""
        super().__init__()
        self._settings = settings
        self._of_launch = of_launch
        self.setWindowTitle(tr("RoAH RSBB – referee"))
        self.setObjectName("RoahRsbbWindow")
        client = RefereeClient.acquire(lambda: host)
        self._model = client.model
        self._title = MarkedTitle(self)
        self._model.updated.connect(self._mark)
        self.panels: Dict[str, Panel] = {}
        self.docks: Dict[str, QDockWidget] = {}
        for panel in [load(name)(client) for name in PANELS]:
            dock = QDockWidget(tr(panel.TAB or panel.TITLE), self, objectName=panel.objectName())
            dock.toggleViewAction().setText(tr(panel.TITLE))
            dock.setWidget(panel)
            self.panels[panel.objectName()] = panel
            self.docks[panel.objectName()] = dock
        self.strip = client.add_strip(self)
        self._lay_out()
        menu = self.menuBar().addMenu(tr("&Panels"))
        for dock in self.docks.values():
            menu.addAction(dock.toggleViewAction())
        self._restore()

    def shutdown(self) -> None:
        """Save the layout and the panels' settings, and close the panels."""
        self._settings.setValue("geometry", self.saveGeometry())
        self._settings.setValue("layout", self.saveState(LAYOUT_VERSION))
        self._model.updated.disconnect(self._mark)
        for name, panel in self.panels.items():
            panel.save_settings(PanelSettings(self._settings, name))
            panel.shutdown()
        self._settings.sync()
        RefereeClient.release()

    def _mark(self) -> None:
        self._title.show(self._model.is_replay)

    def closeEvent(self, event) -> None:
        if self._of_launch:
            event.ignore()
            status = self.panels[CoreStatusPanel.__name__]
            self.docks[CoreStatusPanel.__name__].show()
            self.docks[CoreStatusPanel.__name__].raise_()
            status.ask_exit()
        else:
            event.accept()

    def _lay_out(self) -> None:
        """Place the commands at the left, scoring and information at the right."""
        d = self.docks
        self.setDockNestingEnabled(True)
        self.addDockWidget(Qt.LeftDockWidgetArea, d["BenchmarkControlPanel"])
        self.addDockWidget(Qt.RightDockWidgetArea, d["ScoringPanel"])
        self.splitDockWidget(d["ScoringPanel"], d["OverviewPanel"], Qt.Vertical)
        self.splitDockWidget(d["OverviewPanel"], d["LogDisplayPanel"], Qt.Horizontal)
        for name in ("ManualOperation", "OmfSwitches", "Devices", "TabletStatus", "CoreStatus"):
            self.tabifyDockWidget(d["ScoringPanel"], d[f"{name}Panel"])
        for name in ("OnlineDataPanel", "ActiveRobotsPanel"):
            self.tabifyDockWidget(d["LogDisplayPanel"], d[name])
        d["ScoringPanel"].raise_()
        d["LogDisplayPanel"].raise_()
        unit = round(basic.em())
        open_at(self, math.inf, math.inf, self._settings.value("geometry"))
        self.resizeDocks([d["BenchmarkControlPanel"], d["ScoringPanel"]], [34 * unit, 46 * unit], Qt.Horizontal)
        self.resizeDocks([d["OverviewPanel"], d["LogDisplayPanel"]], [25 * unit, 21 * unit], Qt.Horizontal)
        self.resizeDocks([d["ScoringPanel"], d["OverviewPanel"]], [18 * unit, 24 * unit], Qt.Vertical)

    def _restore(self) -> None:
        layout = self._settings.value("layout")
        if layout is not None:
            self.restoreState(layout, LAYOUT_VERSION)
        for name, panel in self.panels.items():
            panel.restore_settings(PanelSettings(self._settings, name))
