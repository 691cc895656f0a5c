"""The window in German: no text in English, and none that does not fit. in_sight.test starts it in that language."""

import functools
import html
import re
import unittest
from typing import Dict, Iterator, List, Tuple

from support.fakes.core import Asked
from support.gui_testing import QTest, QWidget, click, show, wait_until
from support.panel_case import BUMPS, DOOR
from support.window_case import WindowCase, is_closed

from helpers import catalogues
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.rqt.basic import FittedText, Notices
from roah_rsbb.rqt.panels.score_sheet import NumberField, UndoRow
from roah_rsbb.rqt.qt import (
    QAbstractButton,
    QDialog,
    QDockWidget,
    QLabel,
    QLineEdit,
    QLocale,
    QMenu,
    QPlainTextEdit,
    QPushButton,
    QScrollArea,
    Qt,
    QTableWidget,
    QTabWidget,
    QToolButton,
)
from roah_rsbb.scoring.sheet import Mark

LANGUAGE = "de"
# A shorter word is no sign of English.
LONG = re.compile(r"[^\W\d_]{3,}")


@functools.lru_cache(maxsize=None)
def english() -> Dict[str, "re.Pattern[str]"]:
    """The texts in English that differ from those in this language; values may be in their places."""
    entries = catalogues.read(catalogues.FOLDER / f"{LANGUAGE}.ts")[catalogues.CONTEXT]
    same = {form for entry in entries for form in entry.forms}
    texts = (entry.text for entry in entries if entry.text not in same)
    return {
        text: re.compile(".+".join(map(re.escape, re.split("{[^{}]*}", text))))
        for text in texts if LONG.search(re.sub("{[^{}]*}", "", text))
    }


@functools.lru_cache(maxsize=None)
def sources(part: str) -> Tuple[str, ...]:
    """The texts in English that this part of a text is. Most parts are looked at many times."""
    return tuple(source for source, pattern in english().items() if pattern.fullmatch(part))


def texts_of(widget: QWidget) -> Iterator[str]:
    """All texts that a widget shows, or shows on request."""
    yield from (widget.toolTip(), widget.accessibleName())
    if isinstance(widget, (QLabel, QAbstractButton, FittedText)):
        yield widget.text()
    if isinstance(widget, (QLineEdit, QPlainTextEdit)):
        yield widget.placeholderText()
    if isinstance(widget, Notices):
        yield widget.toPlainText()
    if isinstance(widget, (QDialog, QDockWidget)) or widget.isWindow():
        yield widget.windowTitle()
    if isinstance(widget, QMenu):
        yield from (action.text() for action in widget.actions())
    if isinstance(widget, QTabWidget):
        yield from (widget.tabText(index) for index in range(widget.count()))
    if isinstance(widget, QTableWidget):
        headers = [widget.horizontalHeaderItem(column) for column in range(widget.columnCount())]
        items = [widget.item(row, column) for row in range(widget.rowCount()) for column in range(widget.columnCount())]
        yield from (text for item in headers + items if item is not None for text in (item.text(), item.toolTip()))


def parts(text: str) -> List[str]:
    """The whole text without markup, its lines, and the parts of them."""
    plain = html.unescape(re.sub("<[^>]*>", "\n", text)).strip()
    lines = [line.strip() for line in plain.splitlines() if line.strip()]
    return [plain, *lines, *(part.strip() for line in lines for part in re.split("  ·  | · ", line))]


def is_cut(widget: QWidget) -> bool:
    """Whether a widget needs more space for its text than it has."""
    if isinstance(widget.parentWidget(), UndoRow):
        return widget.text().endswith("…")  # its first line may be: the item's text is the organiser's
    if isinstance(widget, QPushButton):
        return max(map(widget.fontMetrics().horizontalAdvance, widget.text().split("\n"))) > widget.width()
    if isinstance(widget, QAbstractButton) and not isinstance(widget, QToolButton):
        return widget.sizeHint().width() > widget.width()
    if isinstance(widget, QLabel) and widget.wordWrap():
        return widget.heightForWidth(widget.width()) > widget.height()
    if isinstance(widget, QScrollArea):
        return widget.horizontalScrollBar().isVisible()
    return False


class TestNumbers(unittest.TestCase):
    """Decimals on a computer in German, whose people type a comma."""

    def test_a_point_and_a_comma_are_the_same(self) -> None:
        before = QLocale()
        QLocale.setDefault(QLocale("de_DE"))
        self.addCleanup(QLocale.setDefault, before)
        entered: List[str] = []
        field = NumberField(SheetItem("", "", "rating", min="0", max="10"), entered.append, may_be_empty=True)
        self.addCleanup(field.close)
        show(field, 200, 50)
        for typed, number in (("8.5", "8.5"), ("7,25", "7.25"), ("9", "9")):
            field.selectAll()
            QTest.keyClicks(field, typed)
            QTest.keyClick(field, Qt.Key_Return)
            self.assertEqual((entered[-1:], field.text()), ([number], number))
        field.show_text("6.5")
        field.interpretText()
        self.assertEqual((field.text_value(), len(entered)), ("6.5", 3))


class TestGerman(WindowCase):
    """Every panel, before, during and after a run."""

    maxDiff = None

    def assert_german(self, root: QWidget) -> None:
        found = [
            (type(widget).__name__, part, source)
            for widget in [root, *root.findChildren(QWidget)] for text in texts_of(widget) for part in parts(text)
            for source in sources(part)
        ]
        self.assertEqual(found, [])

    def assert_fits(self, root: QWidget) -> None:
        def cut() -> List[str]:
            return [f"{type(widget).__name__} {getattr(widget, 'text', str)()!r}"
                    for widget in root.findChildren(QWidget) if widget.isVisible() and is_cut(widget)]

        wait_until(lambda: not cut(), lambda: f"{root.objectName()}: they fit: {cut()}")

    def look_at_all(self) -> None:
        """Look at every panel, in front of the others."""
        for name in self.window.docks:
            self.bring(name)
            self.assert_fits(self.panel(name))
        self.wait_quiet()
        self.assert_german(self.window)

    def bring(self, name: str) -> None:
        """Bring a panel to the front."""
        panel = self.panel(name)
        self.window.docks[name].raise_()
        wait_until(lambda: not panel.visibleRegion().isEmpty(), f"{name} is in front")
        wait_until(lambda: "live" in panel.news.text(), f"{name} shows the core")

    def test_before_during_and_after_a_run(self) -> None:
        self.look_at_all()
        self.client.keys.open_page()
        self.look_at_dialog(must_fit=True)
        self.run_zone()
        self.look_during_the_run()
        self.zone.asked, self.zone.switches_asked = None, False
        self.zone.command("stop", "disconnect")
        self.look_at_all()

    def look_at_dialog(self, must_fit: bool) -> List[str]:
        """Look at the open dialog and close it. Returns the texts of its buttons."""
        dialog = self.dialog(QDialog)
        self.assert_german(dialog)
        if must_fit:
            self.assert_fits(dialog)
        texts = [button.text() for button in dialog.findChildren(QPushButton)]
        dialog.close()
        wait_until(lambda: is_closed(dialog), "the dialog is closed")
        return texts

    def look_during_the_run(self) -> None:
        for number in range(3):
            self.zone.mark(Mark(*BUMPS, number + 1, note=str(number)), "Anna")
        self.zone.mark(Mark(*DOOR, 1), "Anna")
        self.zone.asked = Asked(1, "Place the robot", ())
        self.zone.switches_asked = True
        wait_until(lambda: len(self.scoring.undo.buttons) == 4, "the marks are shown")
        # It comes to the front by itself.
        wait_until(lambda: self.panel("ManualOperationPanel").isVisible(), "the request is shown")
        self.look_at_all()
        self.ask_note()
        self.look_at_dialog(must_fit=True)
        click(self.control.buttons["disconnect"])
        self.assertIn("Abbrechen", self.look_at_dialog(must_fit=False))

    def test_the_box_receives_what_it_receives_in_english(self) -> None:
        self.run_zone()
        self.scoring.rows[BUMPS].score()
        self.wait_call("score", "Home A", *BUMPS, "+1")
        wait_until(lambda: self.zone.scores.get(BUMPS) == 1, "the core has the score")
