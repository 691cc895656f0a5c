"""The last marks of a score sheet, as buttons that withdraw them.

A button keeps its place, and a new mark replaces the oldest one. A click therefore never withdraws another mark than
the one that the referee saw.
"""

from typing import Callable, List, NamedTuple, Optional, Sequence

from roah_rsbb.model.results import HistoryEntry
from roah_rsbb.rqt.qt import QFontMetricsF, QHBoxLayout, QPushButton, QSizePolicy, Qt, QTimer, QWidget
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording import sheets, times
from roah_rsbb.wording.language import tr, tr_later

PLACES = 5
UNDO = tr_later("Undo: {mark}")


def placed(before: Sequence[Optional[HistoryEntry]], entries: Sequence[HistoryEntry]) -> List[Optional[HistoryEntry]]:
    """Return which entry is in which place. `entries`: the newest first; those that were shown keep their places."""
    by_number = {entry.number: entry for entry in entries}
    places = [by_number.pop(entry.number, None) if entry is not None else None for entry in before]
    for entry in sorted(by_number.values(), key=lambda entry: entry.number):
        places[places.index(None)] = entry
    return places


class _Place(NamedTuple):
    button: QPushButton
    held: QTimer


class UndoRow(QWidget):
    """A button for each of the last marks. It calls `withdraw(entry)`."""

    def __init__(self, withdraw: Callable[[HistoryEntry], None]) -> None:
        super().__init__()
        self._withdraw = withdraw
        self._entries: List[Optional[HistoryEntry]] = [None] * PLACES
        self._off = ""
        line = basic.flat(QHBoxLayout(self))
        line.setSpacing(round(0.2 * basic.em()))
        self._places = [self._place(number) for number in range(PLACES)]
        for place in self._places:
            line.addWidget(place.button)
        self.setFixedHeight(round(2.7 * basic.em()))

    @property
    def buttons(self) -> List[QPushButton]:
        """The buttons of all marks that can be undone."""
        return [place.button for place, entry in zip(self._places, self._entries) if entry is not None]

    def _place(self, number: int) -> _Place:
        button = basic.enlarged(QPushButton(), 0.9)
        button.setFocusPolicy(Qt.TabFocus)
        button.setSizePolicy(QSizePolicy.Ignored, QSizePolicy.Expanding)
        button.setEnabled(False)
        button.clicked.connect(lambda: self._press(number))
        held = QTimer(self, singleShot=True, timeout=self._apply)
        return _Place(button, held)

    def show_entries(self, entries: Sequence[HistoryEntry], now_utc_s: float, off: str) -> None:
        """Show these entries, the newest first. `off`: why nothing can be undone; empty: it can."""
        before, self._entries = self._entries, placed(self._entries, entries[:PLACES])
        self._off = off
        newest = entries[0].number if entries else 0
        for place, old, entry in zip(self._places, before, self._entries):
            if entry is not None and (old is None or old.number != entry.number):
                place.held.start(basic.HOLD_MS)  # a click may be meant for the mark that was here
            self._show(place.button, entry, now_utc_s, newest)
        self._apply()

    def _show(self, button: QPushButton, entry: Optional[HistoryEntry], now_utc_s: float, newest: int) -> None:
        if entry is None:
            button.setText("")
            button.setToolTip("")
            return
        ago = times.ago(now_utc_s - entry.utc_s)
        font = button.font()
        font.setBold(entry.number == newest)
        button.setFont(font)
        metrics, room = QFontMetricsF(font), button.width() - basic.em()
        lines = (entry.item, f"{tr(UNDO, mark=sheets.change_text(entry))} ({ago})")
        button.setText("\n".join(metrics.elidedText(line, Qt.ElideRight, room) for line in lines).replace("&", "&&"))
        more = tr("{group}, by {name}, entry {number} of the history",
                  group=entry.group, name=sheets.person(entry.who), number=entry.number)
        button.setToolTip(basic.tip(f"{tr(UNDO, mark=sheets.mark_text(entry))} ({ago})\n{more}"))

    def _apply(self) -> None:
        for place, entry in zip(self._places, self._entries):
            place.button.setEnabled(entry is not None and not self._off and not place.held.isActive())

    def _press(self, number: int) -> None:
        entry = self._entries[number]
        if entry is not None:
            self._places[number].held.start(basic.HOLD_MS)
            self._apply()
            self._withdraw(entry)
