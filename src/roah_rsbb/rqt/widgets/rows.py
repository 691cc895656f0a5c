"""A table from which a row is chosen. Updates keep the chosen row and the scroll position."""

from typing import Hashable, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.rqt.qt import QAbstractItemView, QHeaderView, Qt, QTableWidget, QTableWidgetItem
from roah_rsbb.rqt.widgets import basic


class TableRow(NamedTuple):
    """A row of the table."""

    key: Hashable  # identifies the row; None: it cannot be chosen
    texts: Tuple[str, ...]
    bold: bool = False
    off: bool = False  # struck through, except for the last column, which says why
    tips: Tuple[str, ...] = ()  # tooltips of the columns, where they say more than the texts


class Rows(QTableWidget):
    """Rows of text in columns; one row can be chosen."""

    def __init__(self, columns: Sequence[str], stretched: Tuple[int, ...], wrapped: bool = True) -> None:
        """`stretched`: columns that share the remaining width. `wrapped`: long texts take several lines."""
        super().__init__(0, len(columns))
        basic.enlarged(self, 1.05)
        self.setHorizontalHeaderLabels(list(columns))
        self.setAlternatingRowColors(True)
        self.setShowGrid(False)
        self.setWordWrap(wrapped)
        self.setSelectionBehavior(QAbstractItemView.SelectRows)
        self.setSelectionMode(QAbstractItemView.SingleSelection)
        self.setEditTriggers(QAbstractItemView.NoEditTriggers)
        self.setTabKeyNavigation(False)
        self.verticalHeader().hide()
        self.verticalHeader().setMinimumSectionSize(round(1.4 * basic.em()))
        self.verticalHeader().setSectionResizeMode(QHeaderView.ResizeToContents)
        self.horizontalHeader().setHighlightSections(False)
        self.horizontalHeader().setDefaultAlignment(Qt.AlignLeft | Qt.AlignVCenter)
        for column in range(len(columns)):
            mode = QHeaderView.Stretch if column in stretched else QHeaderView.ResizeToContents
            self.horizontalHeader().setSectionResizeMode(column, mode)
        self._rows: List[TableRow] = []

    @property
    def chosen(self) -> Optional[Hashable]:
        """The key of the chosen row."""
        index = self.currentRow()
        return self._rows[index].key if 0 <= index < len(self._rows) else None

    def choose(self, key: Hashable) -> None:
        """Choose the row with this key, if it exists."""
        keys = [row.key for row in self._rows]
        if key is not None and key in keys:
            self.selectRow(keys.index(key))

    def show_rows(self, rows: List[TableRow]) -> None:
        """Replace the rows; the row with the chosen key stays chosen."""
        if rows == self._rows:
            return
        chosen, place = self.chosen, self.verticalScrollBar().value()
        self.blockSignals(True)
        if [row.key for row in rows] != [row.key for row in self._rows]:
            self.setCurrentItem(None)
        before, self._rows = self._rows, rows
        # The headers would measure all rows again for each item: a second for 40 rows.
        across, down = self.horizontalHeader(), self.verticalHeader()
        modes = [across.sectionResizeMode(column) for column in range(across.count())]
        for header in (across, down):
            header.setSectionResizeMode(QHeaderView.Fixed)
        self.setRowCount(len(rows))
        for index, row in enumerate(rows):
            if index >= len(before) or before[index] != row:
                self._fill(index, row)
        for column, mode in enumerate(modes):
            across.setSectionResizeMode(column, mode)
        down.setSectionResizeMode(QHeaderView.ResizeToContents)
        self.choose(chosen)
        self.blockSignals(False)
        self.verticalScrollBar().setValue(place)

    def keys(self) -> List[Optional[Hashable]]:
        """Return the keys of all rows."""
        return [row.key for row in self._rows]

    def texts(self) -> List[Tuple[str, ...]]:
        """Return the texts of all rows."""
        return [row.texts for row in self._rows]

    def _fill(self, index: int, row: TableRow) -> None:
        font = self.font()
        font.setBold(row.bold)
        for column, text in enumerate(row.texts):
            item = QTableWidgetItem(text)
            more = row.tips[column] if column < len(row.tips) else ""
            item.setToolTip(basic.tip("\n".join(filter(None, (text, more)))))
            font.setStrikeOut(row.off and column < len(row.texts) - 1)
            item.setFont(font)
            item.setTextAlignment(Qt.AlignTop | Qt.AlignLeft)
            item.setFlags(Qt.ItemIsEnabled if row.key is None else Qt.ItemIsEnabled | Qt.ItemIsSelectable)
            self.setItem(index, column, item)
