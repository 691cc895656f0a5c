"""The items of a score sheet in their groups, in one or two columns, so that all of them are visible.

Disqualifying items stay visible even if the others must scroll.
"""

from typing import Dict, List, Mapping, NamedTuple, Optional

from roah_rsbb.rqt.qt import QFrame, QGridLayout, QGroupBox, QScrollArea, QSize, QTimer, QVBoxLayout, QWidget
from roah_rsbb.rqt.widgets import basic

# Groups whose names begin with this are never hidden.
PINNED = "disqualif"
# A narrower sheet stays in one column, in units of the desktop's font.
TWO_COLUMNS_EMS = 34
# The smallest width and height.
LEAST_EMS = (20, 9)


class _Group(NamedTuple):
    box: QGroupBox
    grid: QGridLayout
    rows: List[QWidget]


class SheetArrangement(NamedTuple):
    """How the items are arranged."""

    columns: int
    is_compact: bool


# The first arrangement that shows all items is used. The last one scrolls if necessary.
ARRANGEMENTS = (SheetArrangement(1, False), SheetArrangement(1, True), SheetArrangement(2, True))


class SheetView(QWidget):
    """Shows rows in groups. A row has `set_compact(is_compact)`."""

    def __init__(self) -> None:
        super().__init__()
        self._groups: Dict[str, _Group] = {}
        self.arrangement: Optional[SheetArrangement] = None
        self._area = QScrollArea(widgetResizable=True)
        self._area.setFrameShape(QFrame.NoFrame)
        self._area.setMinimumHeight(round(2 * basic.em()))
        self._pinned = QWidget()
        column = basic.flat(QVBoxLayout(self))
        column.setSpacing(round(0.2 * basic.em()))
        column.addWidget(self._area, 1)
        column.addWidget(self._pinned)
        self._inside: Optional[QVBoxLayout] = None
        self._below = basic.flat(QVBoxLayout(self._pinned))
        self._soon = QTimer(self, singleShot=True, interval=0, timeout=self._settle)

    def clear(self) -> None:
        """Remove all rows."""
        for group in self._groups.values():
            group.box.hide()
            group.box.deleteLater()
        self._groups = {}
        inside = QWidget()
        self._inside = basic.flat(QVBoxLayout(inside))
        self._inside.addStretch(1)
        self._area.setWidget(inside)
        self.arrangement = None

    def add(self, group: str, row: QWidget) -> None:
        """Add a row to a group. Call `settle` after the last one."""
        if group not in self._groups:
            box = basic.enlarged(QGroupBox(group), 1.0, bold=True)
            grid = QGridLayout(box)
            edge = round(0.3 * basic.em())
            grid.setContentsMargins(edge, edge, edge, edge)
            grid.setHorizontalSpacing(round(0.8 * basic.em()))
            grid.setVerticalSpacing(round(0.15 * basic.em()))
            self._groups[group] = _Group(box, grid, [])
            if group.lower().startswith(PINNED):
                self._below.addWidget(box)
            else:
                self._inside.insertWidget(self._inside.count() - 1, box)
        self._groups[group].rows.append(row)

    def show_points(self, points: Mapping[str, str]) -> None:
        """Show the points of groups, by their names, in their titles."""
        for name, group in self._groups.items():
            title = f"{name}: {points[name]}" if name in points else name
            if title != group.box.title():
                group.box.setTitle(title)

    def settle(self) -> None:
        """Choose the number of columns, once the layout is up to date."""
        self._arrange(ARRANGEMENTS[0])
        self._soon.start()

    def minimumSizeHint(self) -> QSize:
        """Does not depend on the sheet: another one must not push other panels away, under the mouse."""
        return QSize(round(LEAST_EMS[0] * basic.em()), round(LEAST_EMS[1] * basic.em()))

    def sizeHint(self) -> QSize:
        return self.minimumSizeHint()

    def resizeEvent(self, event) -> None:
        super().resizeEvent(event)
        self._soon.start()

    def _settle(self) -> None:
        if not self._groups:
            return
        is_wide = self.width() >= TWO_COLUMNS_EMS * basic.em()
        for arrangement in ARRANGEMENTS:
            if arrangement.columns == 1 or is_wide:
                self._arrange(arrangement)
                if self._needed() <= self.height():
                    return

    def _needed(self) -> int:
        """The height of all groups, at the present width."""
        width = self.width()
        # Layouts keep the sizes of their widgets until Qt has handled the events of the last arrangement.
        for group in self._groups.values():
            for row in group.rows:
                for widget in row.findChildren(QWidget):
                    widget.updateGeometry()
                row.updateGeometry()
            group.box.updateGeometry()
        layouts = [self._below] + ([self._inside] if self._inside is not None else [])
        for layout in layouts:
            layout.invalidate()
        heights = [max(layout.totalHeightForWidth(width), layout.totalSizeHint().height()) if layout.hasHeightForWidth()
                   else layout.totalSizeHint().height() for layout in layouts]
        return sum(heights) + self.layout().spacing()

    def _arrange(self, arrangement: SheetArrangement) -> None:
        if arrangement == self.arrangement:
            return
        self.arrangement = arrangement
        for group in self._groups.values():
            # A layout shows what is added to it only when Qt handles its next events; until then it has no height.
            group.box.show()
            for index, row in enumerate(group.rows):
                row.set_compact(arrangement.is_compact)
                group.grid.addWidget(row, *divmod(index, arrangement.columns))
                row.show()
            for column in range(2):
                group.grid.setColumnStretch(column, 1 if column < arrangement.columns else 0)
