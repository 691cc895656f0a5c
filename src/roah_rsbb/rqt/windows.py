"""Windows of our own: one with all panels, for machines without rqt, and one for a single panel, such as `rosrun
roah_rsbb panel scoring`.

They show the zone of the namespace in which they are started (`__ns:=`), as all panels of a client do.
"""

import math
from typing import Any, Dict

from roah_rsbb.rqt import basic
from roah_rsbb.rqt.client import RefereeClient
from roah_rsbb.rqt.node import WindowNode
from roah_rsbb.rqt.panels import PANELS, load
from roah_rsbb.rqt.panels.panel import Panel
from roah_rsbb.rqt.qt import QApplication, QDockWidget, QMainWindow, QSettings, Qt, QTabBar
from roah_rsbb.wording.language import tr

# Size of a panel's window at the first start, in units of the desktop's font.
WIDE_EMS, HIGH_EMS = 40, 40
# At the first start a window takes at most this share of the screen's width and height.
MOST_OF_SCREEN = 0.95


def open_at(window: Any, width: float, height: float, saved: Any) -> None:
    """Give a window its place: the saved one (None: there is none), or its first size in pixels. All of it is on the
    screen, also without a window manager: at its lower edge is STOP."""
    area = QApplication.primaryScreen().availableGeometry()
    window.resize(round(min(width, area.width() * MOST_OF_SCREEN)), round(min(height, area.height() * MOST_OF_SCREEN)))
    if saved is None or not window.restoreGeometry(saved):
        return
    place = window.geometry()
    areas = [area, *(screen.availableGeometry() for screen in QApplication.screens())]
    area = next((one for one in areas if one.contains(place.topLeft())), area)
    if not (window.isMaximized() or window.isFullScreen() or area.contains(place)):
        window.resize(place.size().boundedTo(area.size()))
        window.move(max(area.left(), min(place.left(), area.right() + 1 - window.width())),
                    max(area.top(), min(place.top(), area.bottom() + 1 - window.height())))


class PanelSettings:
    """The settings of one panel outside rqt: QSettings with the methods of rqt's settings."""

    def __init__(self, settings: QSettings, name: str) -> None:
        self._settings = settings
        self._name = name

    def set_value(self, key: str, value) -> None:
        """Save a value."""
        self._settings.setValue(f"{self._name}/{key}", value)

    def value(self, key: str, default=None):
        """Return the saved value, or `default`."""
        return self._settings.value(f"{self._name}/{key}", default)


class PanelWindow(QMainWindow):
    """A window with one panel. Its size and the panel's settings are saved."""

    def __init__(self, name: str, node: WindowNode, settings: QSettings) -> None:
        """`name` is that of the panel."""
        super().__init__()
        kind = load(name)
        self._settings = settings
        self._of_panel = PanelSettings(settings, kind.__name__)
        self._panel = kind(RefereeClient.acquire(lambda: node))
        self.setCentralWidget(self._panel)
        self._panel.client.add_strip(self)
        self.setWindowTitle(f"{tr(kind.TITLE)} – RoAH RSBB")
        open_at(self, WIDE_EMS * basic.em(), HIGH_EMS * basic.em(), settings.value("geometry"))
        self._panel.restore_settings(self._of_panel)

    def shutdown(self) -> None:
        """Save the settings, and close the panel."""
        self._settings.setValue("geometry", self.saveGeometry())
        self._panel.save_settings(self._of_panel)
        self._settings.sync()
        self._panel.shutdown()
        RefereeClient.release()


# Increase it when the set of panels changes: an older layout would hide new panels.
LAYOUT_VERSION = 7


class Window(QMainWindow):
    """All panels, as docks that can be moved, stacked and closed. The layout is saved."""

    def __init__(self, node: WindowNode, settings: QSettings, of_launch: bool = False) -> None:
        """`of_launch`: closing the window asks, then ends what was launched; otherwise it just closes."""
        super().__init__()
        self._settings = settings
        self._of_launch = of_launch
        self.setWindowTitle(tr("RoAH RSBB – referee"))
        self.setObjectName("RoahRsbbWindow")
        client = RefereeClient.acquire(lambda: node)
        self._model = client.model
        self._title = basic.MarkedTitle(self)
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

    def childEvent(self, event) -> None:
        """Let tabs that find no place scroll: their names must stay legible. Qt would shorten them to a letter."""
        if event.polished() and isinstance(event.child(), QTabBar):
            event.child().setElideMode(Qt.ElideNone)
            event.child().setUsesScrollButtons(True)
        super().childEvent(event)

    def _mark(self) -> None:
        self._title.show(self._model.is_replay)

    def closeEvent(self, event) -> None:
        if self._of_launch:
            event.ignore()
            self.docks["CoreStatusPanel"].show()
            self.docks["CoreStatusPanel"].raise_()
            self.panels["CoreStatusPanel"].ask_exit()
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
