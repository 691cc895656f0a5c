"""Panels with a growing text that can be searched: Log Display and Online Data (docs/referee.md)."""

import re
from typing import List, Optional

from roah_rsbb.document.difference import added
from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.rqt import basic
from roah_rsbb.rqt.panels.panel import CollapsingPanel
from roah_rsbb.rqt.qt import (
    QCheckBox,
    QColor,
    QFontDatabase,
    QHBoxLayout,
    QKeySequence,
    QLabel,
    QLineEdit,
    QPlainTextEdit,
    QShortcut,
    QSyntaxHighlighter,
    Qt,
    QTextCharFormat,
    QTextCursor,
    QTextDocument,
    QTextEdit,
    QWidget,
    Signal,
)
from roah_rsbb.wording.language import tr, tr_later

# Highlighting more matches would make the text slow.
MOST = 1000
FOUND = basic.OLD
# The current match; it is also underlined, and its number is shown in the count.
HERE = basic.PHASES["executing"]


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
        self.previous = basic.CommandButton("▲", tr("Previous match (Shift+F3)"), basic.TEXT, lambda: self.go(-1))
        self.next = basic.CommandButton("▼", tr("Next match (F3, Enter)"), basic.TEXT, lambda: self.go(1))
        layout = basic.flat(QHBoxLayout(self))
        layout.addWidget(self.line, 1)
        for widget in (self.count, self.previous, self.next):
            layout.addWidget(widget)
        self.line.textChanged.connect(self._on_text)
        self.line.returnPressed.connect(lambda: self.go(1))
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


# The core publishes only the end of the text; the panel keeps what it received since it was opened.
MAX_LINES = 5000


class TextPanel(CollapsingPanel):
    """Shows a text of the zone and follows its end, unless the referee scrolls."""

    NOTHING = ""
    WORKS_BEHIND = True

    def __init__(self, client) -> None:
        super().__init__(client)
        self._source: tuple = ()
        self._published = ""
        self.view = QPlainTextEdit(readOnly=True)
        self.view.setPlaceholderText(tr(self.NOTHING))
        self.view.setMaximumBlockCount(MAX_LINES)
        font = QFontDatabase.systemFont(QFontDatabase.FixedFont)
        self.view.setFont(font)
        self.follow = QCheckBox(tr("Follow the end"))
        self.follow.setChecked(True)
        self.follow.toggled.connect(self._to_end)
        self.search = TextSearch(self.view, self)
        # New lines must not scroll a match away.
        self.search.jumped.connect(lambda: self.follow.setChecked(False))
        self.body.addWidget(self.view, 1)
        self.body.addWidget(self.search)
        self.body.addWidget(self.follow)

    def text_of(self, zone: ZoneSeen) -> str:
        """Return the text that this panel shows."""
        raise NotImplementedError

    def where(self) -> str:
        last = self._published.rstrip("\n").rpartition("\n")[2]
        return f"{tr(self.TITLE)}: {last}" if self.is_collapsed and last else super().where()

    def parts(self) -> tuple:
        zone = self.model.zone
        return () if zone is None else (zone.event.id, self.text_of(zone))

    def show_model(self) -> None:
        zone = self.model.zone
        source = () if zone is None else (zone.zone, zone.event.id)
        published = "" if zone is None else self.client.moments.lines(self.text_of(zone), self.model.now().utc)
        more = added(self._published, published) if source == self._source else None
        self._source, self._published = source, published
        if more is None:
            self.view.setPlainText(published)
            self._to_end()
        elif more:
            self._append(more)

    def save_settings(self, settings) -> None:
        settings.set_value("follow", self.follow.isChecked())

    def restore_settings(self, settings) -> None:
        # Settings files contain text.
        self.follow.setChecked(str(settings.value("follow", True)).lower() == "true")

    def _append(self, text: str) -> None:
        """Append text without changing the scroll position or the selection."""
        bar = self.view.verticalScrollBar()
        at = bar.value()
        cursor = QTextCursor(self.view.document())
        cursor.movePosition(QTextCursor.End)
        cursor.insertText(text)
        bar.setValue(bar.maximum() if self.follow.isChecked() else at)

    def _to_end(self) -> None:
        if self.follow.isChecked():
            bar = self.view.verticalScrollBar()
            bar.setValue(bar.maximum())


class OnlineDataPanel(TextPanel):
    """Notifications, activation events, visitors and commands of the zone's robot."""

    TITLE = tr_later("Online Data")
    TAB = tr_later("Online")
    NOTHING = tr_later("No online data from the robot yet")

    def text_of(self, zone: ZoneSeen) -> str:
        return zone.online_data


# The core writes the level of warnings and errors after the time.
LINE = re.compile(r"^\S+ (WARNING|ERROR): ")
TONES = {"WARNING": basic.OLD, "ERROR": basic.ALARM}


class LevelColours(QSyntaxHighlighter):
    """Highlights warnings and errors in a document, also in lines that are added later."""

    def __init__(self, document: QTextDocument) -> None:
        super().__init__(document)
        self._looks = {level: _look(tone) for level, tone in TONES.items()}

    def highlightBlock(self, text: str) -> None:
        match = LINE.match(text)
        if match:
            self.setFormat(0, len(text), self._looks[match.group(1)])


def _look(tone: basic.Tone) -> QTextCharFormat:
    look = QTextCharFormat()
    look.setBackground(QColor(tone.background))
    look.setForeground(QColor(tone.text))
    look.setFontWeight(75)
    return look


class LogDisplayPanel(TextPanel):
    """The run's log, with warnings and errors highlighted."""

    TITLE = tr_later("Log Display")
    TAB = tr_later("Log")
    NOTHING = tr_later("Nothing has been logged yet")

    def __init__(self, client) -> None:
        super().__init__(client)
        self._colours = LevelColours(self.view.document())

    def text_of(self, zone: ZoneSeen) -> str:
        return zone.log
