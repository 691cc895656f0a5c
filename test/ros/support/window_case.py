"""Test cases of our whole window, with all panels and a fake core."""

import tempfile
import unittest
from unittest import mock

import rospy
from PyQt5 import sip

from roah_rsbb.rqt.app.window import Window
from roah_rsbb.rqt.model import presses
from roah_rsbb.rqt.model.client import Client
from roah_rsbb.rqt.qt import QDialog, QRect, QSettings
from roah_rsbb.rqt.widgets.score_dialogs import ScoreDialog
from support import gui_testing
from support.fakes.core import ITEMS, FakeCore
from support.gui_testing import QApplication, QPoint, QTest, QWidget, wait_until
from support.panel_case import BUMPS


def is_closed(dialog: QDialog) -> bool:
    """Whether a dialog that is deleted when it closes is gone."""
    return sip.isdeleted(dialog) or not dialog.isVisible()


class WindowCase(unittest.TestCase):
    """Our window with all panels, and a fake core."""

    ZONES = ("Home A", "Home B")
    SIZE = gui_testing.SCREEN
    ITEMS = ITEMS

    def setUp(self) -> None:
        within = mock.patch.object(presses, "WITHIN_S", 600.0)  # a busy machine may be slow between two presses
        within.start()
        self.addCleanup(within.stop)
        rospy.set_param("current_zone", self.ZONES[0])
        self.core = FakeCore(self.ZONES, items=self.ITEMS)
        self.addCleanup(self.core.close)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.window = Window(QSettings(f"{folder.name}/window.ini", QSettings.IniFormat))
        self.addCleanup(self.end)
        self.client = Client._shared
        self.window.resize(*self.SIZE)
        self.window.move(0, 0)
        self.window.show()
        self.window.activateWindow()
        wait_until(lambda: QApplication.activeWindow() is self.window, "the window has the focus")
        self.zone = self.core.zones["Home A"]
        self.control = self.panel("BenchmarkControlPanel")
        self.scoring = self.panel("ScoringPanel")
        self.prompt = self.client.stop_keys.prompt
        wait_until(lambda: self.client.model.zone is not None and not self.client.model.is_old, "the core is heard")

    def end(self) -> None:
        self.window.shutdown()
        self.window.close()
        for dialog in self.window.findChildren(QDialog):
            dialog.deleteLater()

    def panel(self, name: str) -> QWidget:
        return self.window.panels[name]

    def run_zone(self, zone: str = "Home A") -> None:
        self.core.zones[zone].command("connect")
        self.core.zones[zone].command("start")
        wait_until(lambda: zone in self.client.model.running_zones(), "the run is in progress")
        wait_until(lambda: self.scoring.rows, "the score sheet is shown")
        wait_until(lambda: self.panel("OverviewPanel").is_collapsed, "the overview leaves its space to the sheet")
        wait_still(self.scoring)

    def dialog(self, kind: type) -> QDialog:
        found = []

        def is_open() -> bool:
            found[:] = [d for d in QApplication.topLevelWidgets() if isinstance(d, kind) and d.isVisible()]
            return bool(found)

        wait_until(is_open, f"{kind.__name__} is open")
        found[0].move(self.window.width() - found[0].width(), 0)  # a referee can move it, too
        found[0].activateWindow()
        wait_until(lambda: QApplication.activeWindow() is found[0], "it has the focus")
        return found[0]

    def ask_note(self) -> QDialog:
        self.scoring.rows[BUMPS].with_note.trigger()
        return self.dialog(ScoreDialog)

    def wait_call(self, *call: object) -> None:
        wait_until(lambda: call in self.core.calls, f"{call} is called; there were {self.core.calls}")

    def wait_prompt(self, text: str) -> None:
        wait_until(lambda: self.prompt.isVisible() and text in self.prompt.text(),
                   f"the prompt says '{text}', not '{self.prompt.text()}'")


def wait_still(panel: QWidget) -> None:
    """Wait until the layout no longer changes."""
    seen = [[], places(panel)]

    def is_still() -> bool:
        seen[:] = [seen[1], places(panel)]
        return seen[0] == seen[1]

    QTest.qWait(100)
    wait_until(is_still, "nothing moves")


def places(panel: QWidget) -> list:
    """Where all visible parts of a panel are."""
    return [(w.objectName(), w.mapToGlobal(QPoint()), w.size()) for w in panel.findChildren(QWidget) if w.isVisible()]


def in_sight(widget: QWidget) -> bool:
    """Whether a widget is visible as a whole: no ancestor cuts it off, and nothing is in front of it."""
    if not widget.isVisible() or widget.visibleRegion().boundingRect() != widget.rect():
        return False
    ancestor = widget.parentWidget()
    while ancestor is not None:
        if not ancestor.rect().contains(QRect(widget.mapTo(ancestor, QPoint()), widget.size())):
            return False
        ancestor = None if ancestor.isWindow() else ancestor.parentWidget()
    return True
