"""A table to choose a line from: what changes in it moves neither the choice nor the place that is looked at."""

from typing import Hashable, List, NamedTuple, Optional, Sequence, Tuple

from python_qt_binding.QtCore import Qt
from python_qt_binding.QtWidgets import QAbstractItemView, QHeaderView, QTreeWidget, QTreeWidgetItem, QWidget

from roah_rsbb.rqt import widgets


class Row(NamedTuple):
    """A line of the table."""

    key: Hashable  # what it is about, None: it cannot be chosen
    texts: Tuple[str, ...]
    bold: bool = False
    off: bool = False  # it counts no more: struck out


class Rows(QTreeWidget):
    """Lines of text in columns; one can be chosen."""

    def __init__(self, columns: Sequence[str], stretched: int, parent: Optional[QWidget] = None) -> None:
        """`stretched`: the column that takes the room that is left."""
        super().__init__(parent)
        widgets.enlarged(self, 1.05)
        self.setHeaderLabels(list(columns))
        self.setRootIsDecorated(False)
        self.setUniformRowHeights(False)
        self.setWordWrap(True)
        self.setAlternatingRowColors(True)
        self.setSelectionMode(QAbstractItemView.SingleSelection)
        self.setEditTriggers(QAbstractItemView.NoEditTriggers)
        self.header().setStretchLastSection(False)
        for column in range(len(columns)):
            mode = QHeaderView.Stretch if column == stretched else QHeaderView.ResizeToContents
            self.header().setSectionResizeMode(column, mode)
        self._rows: List[Row] = []

    @property
    def chosen(self) -> Optional[Hashable]:
        """The key of the chosen line."""
        index = self.indexOfTopLevelItem(self.currentItem()) if self.currentItem() is not None else -1
        return self._rows[index].key if 0 <= index < len(self._rows) else None

    def choose(self, key: Hashable) -> None:
        """Choose the line with this key, if there is one."""
        for index, row in enumerate(self._rows):
            if row.key == key and key is not None:
                self.setCurrentItem(self.topLevelItem(index))

    def show_rows(self, rows: List[Row]) -> None:
        """Show other lines; the choice stays with its key."""
        if rows == self._rows:
            return
        chosen, place = self.chosen, self.verticalScrollBar().value()
        self.blockSignals(True)
        if [row.key for row in rows] != [row.key for row in self._rows]:
            self.clear()
            self.addTopLevelItems([QTreeWidgetItem() for _ in rows])
        self._rows = rows
        for index, row in enumerate(rows):
            self._fill(self.topLevelItem(index), row)
        if chosen is not None:
            self.choose(chosen)
        self.blockSignals(False)
        self.verticalScrollBar().setValue(place)

    def texts(self) -> List[Tuple[str, ...]]:
        """What the lines say."""
        return [row.texts for row in self._rows]

    def _fill(self, item: QTreeWidgetItem, row: Row) -> None:
        font = self.font()
        font.setBold(row.bold)
        font.setStrikeOut(row.off)
        for column, text in enumerate(row.texts):
            item.setText(column, text)
            item.setToolTip(column, widgets.tip(text))
            item.setFont(column, font)
            item.setTextAlignment(column, Qt.AlignTop | Qt.AlignLeft)
        item.setFlags(Qt.ItemIsEnabled if row.key is None else Qt.ItemIsEnabled | Qt.ItemIsSelectable)
