"""Test cases of our whole window, with all panels and a fake core."""

import tempfile

from PyQt5 import sip

from roah_rsbb.rqt.client import RefereeClient
from roah_rsbb.rqt.node import WindowNode
from roah_rsbb.rqt.panels.score_sheet import ScoreDialog
from roah_rsbb.rqt.qt import QDialog, QRect, QSettings
from roah_rsbb.rqt.windows import Window
from support import gui_testing
from support.fakes.core import ITEMS, FakeCore
from support.gui_testing import QApplication, QPoint, QWidget, opened, settle, show, wait_until
from support.panel_case import BUMPS, CoreCase


def is_closed(dialog: QDialog) -> bool:
    """Whether a dialog that is deleted when it closes is gone."""
    return sip.isdeleted(dialog) or not dialog.isVisible()


class WindowCase(CoreCase):
    """Our window with all panels, and a fake core."""

    ZONES = ("Home A", "Home B")
    SIZE = gui_testing.SCREEN
    ITEMS = ITEMS

    def setUp(self) -> None:
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.window = Window(WindowNode(), QSettings(f"{folder.name}/window.ini", QSettings.IniFormat))
        self.addCleanup(self.end)
        self.client = RefereeClient.acquire(WindowNode)  # that of the window
        self.addCleanup(RefereeClient.release)
        self.window.move(0, 0)
        show(self.window, *self.SIZE)
        self.control = self.panel("BenchmarkControlPanel")
        self.scoring = self.panel("ScoringPanel")
        self.prompt = self.client.keys.prompt
        self.wait_heard()

    def new_core(self) -> FakeCore:
        return FakeCore(self.ZONES, items=self.ITEMS)

    def end(self) -> None:
        self.core.answer_gate.set()
        self.wait_answered()
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
        self.wait_quiet()

    def wait_quiet(self) -> None:
        """Wait until the window shows what the core says now, with all sheets, and nothing moves any more."""
        self.wait_heard()
        self.wait_answered()
        settle(self.window)

    def dialog(self, kind: type) -> QDialog:
        found = opened(kind)
        found.move(self.window.width() - found.width(), 0)  # a referee can move it, too
        found.activateWindow()
        wait_until(lambda: QApplication.activeWindow() is found, "it has the focus")
        return found

    def ask_note(self) -> QDialog:
        self.scoring.rows[BUMPS].with_note.trigger()
        return self.dialog(ScoreDialog)

    def wait_prompt(self, text: str) -> None:
        wait_until(lambda: self.prompt.isVisible() and text in self.prompt.text(),
                   lambda: f"the prompt says '{text}', not '{self.prompt.text()}'")


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
