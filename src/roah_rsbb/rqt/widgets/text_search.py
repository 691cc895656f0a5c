"""A search line for a text: next, previous, number of matches, all matches highlighted."""

from typing import List, Optional

from roah_rsbb.rqt.qt import (
    QColor,
    QHBoxLayout,
    QKeySequence,
    QLabel,
    QLineEdit,
    QPlainTextEdit,
    QShortcut,
    Qt,
    QTextCharFormat,
    QTextCursor,
    QTextEdit,
    QWidget,
    Signal,
)
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.language import tr

# Highlighting more matches would make the text slow.
MOST = 1000
FOUND = basic.Tone("#ffe08a", "#000000")
# The current match; it is also underlined, and its number is shown in the count.
HERE = basic.Tone("#14508c", "#ffffff")


class TextSearch(QWidget):
    """Searches `view`, ignoring case. Keys: Ctrl+F, F3 (next), Shift+F3 (previous)."""

    jumped = Signal()  # the view shows a match now

    def __init__(self, view: QPlainTextEdit, owner: QWidget) -> None:
        """`owner`: the keys work while the focus is inside it."""
        super().__init__()
        self._view = view
        self._found: List[QTextCursor] = []
        self._here: Optional[int] = None
        self.line = QLineEdit(placeholderText=tr("Search (Ctrl+F)"), clearButtonEnabled=True)
        self.count = QLabel()
        self.count.setMinimumWidth(round(6 * basic.em()))
        self.previous = basic.CommandButton("▲", tr("Previous match (Shift+F3)"), 1.0)
        self.next = basic.CommandButton("▼", tr("Next match (F3, Enter)"), 1.0)
        layout = basic.flat(QHBoxLayout(self))
        layout.addWidget(self.line, 1)
        for widget in (self.count, self.previous, self.next):
            layout.addWidget(widget)
        self.line.textChanged.connect(self._on_text)
        self.line.returnPressed.connect(lambda: self.go(1))
        self.previous.clicked.connect(lambda: self.go(-1))
        self.next.clicked.connect(lambda: self.go(1))
        view.textChanged.connect(self.search)
        for key, act in (("Ctrl+F", self._focus), ("F3", lambda: self.go(1)), ("Shift+F3", lambda: self.go(-1))):
            shortcut = QShortcut(QKeySequence(key), owner)
            shortcut.setContext(Qt.WidgetWithChildrenShortcut)
            shortcut.activated.connect(act)
        self.search()

    def search(self) -> None:
        """Search again, because the text changed. The current match stays the same."""
        here = None if self._here is None else self._found[self._here].selectionStart()
        self._found = self._all()
        starts = [cursor.selectionStart() for cursor in self._found]
        self._here = starts.index(here) if here in starts else None
        self._show()

    def go(self, by: int) -> None:
        """Go to the next match (1) or the previous one (-1). After the last match comes the first."""
        if not self._found:
            return
        if self._here is None:
            self._here = self._nearest(by)
        else:
            self._here = (self._here + by) % len(self._found)
        cursor = QTextCursor(self._found[self._here])
        cursor.clearSelection()
        self._view.setTextCursor(cursor)
        self._view.centerCursor()
        self._show()
        self.jumped.emit()

    def _all(self) -> List[QTextCursor]:
        wanted, document = self.line.text(), self._view.document()
        cursor, found = QTextCursor(document), []
        while wanted and len(found) < MOST:
            cursor = document.find(wanted, cursor)
            if cursor.isNull():
                break
            found.append(QTextCursor(cursor))
        return found

    def _nearest(self, by: int) -> int:
        """Return where to start: the first visible match, or the last one above it."""
        top = self._view.firstVisibleBlock().position()
        below = [i for i, cursor in enumerate(self._found) if cursor.selectionStart() >= top]
        first = below[0] if below else 0
        return first if by > 0 else (first - 1) % len(self._found)

    def _on_text(self) -> None:
        self._here = None
        self.search()

    def _focus(self) -> None:
        self.line.setFocus()
        self.line.selectAll()

    def _show(self) -> None:
        many, text = len(self._found), ""
        if self.line.text():
            text = tr("none") if not many else tr("{number} found", number=f"{many}{'+' if many == MOST else ''}")
        self.count.setText(
            text if self._here is None else tr("{number} of {all}", number=self._here + 1, all=many))
        for button in (self.previous, self.next):
            button.allow(bool(many), [tr("No match") if self.line.text() else tr("Type the text to search for")])
        self._view.setExtraSelections(
            [_selection(cursor, number == self._here) for number, cursor in enumerate(self._found)]
        )


def _selection(cursor: QTextCursor, here: bool) -> QTextEdit.ExtraSelection:
    tone = HERE if here else FOUND
    selection = QTextEdit.ExtraSelection()
    selection.cursor = cursor
    look = QTextCharFormat()
    look.setBackground(QColor(tone.background))
    look.setForeground(QColor(tone.text))
    look.setFontUnderline(here)
    selection.format = look
    return selection
