"""The page with all keys. `?` opens it unless the focus is in a text."""

from typing import Optional

from roah_rsbb.rqt.qt import (
    QAbstractSpinBox,
    QApplication,
    QDialog,
    QDialogButtonBox,
    QEvent,
    QGridLayout,
    QLabel,
    QLineEdit,
    QObject,
    Qt,
    QWidget,
)
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.widgets.window_keys import WindowKeys
from roah_rsbb.wording.language import tr, tr_later

# docs/referee.md has the same table.
KEYS = (
    (tr_later("F5 twice"), tr_later("start the benchmark of the zone")),
    (tr_later("Esc twice"), tr_later("stop the run of the zone, wherever the focus is")),
    (tr_later("Shift+Esc twice"), tr_later("stop the runs of all zones")),
    (tr_later("1 to 9"), tr_later("score the item with this number: count one more, or yes")),
    (tr_later("Shift+1 to 9"), tr_later("take it back: count one less, or no")),
    (tr_later("Tab, Shift+Tab"), tr_later("go to the next or previous control; a frame shows where you are")),
    (tr_later("Space"), tr_later("press the button in the frame")),
    (tr_later("Ctrl+F, F3, Shift+F3"), tr_later("in a log: search, next, previous")),
    ("?", tr_later("open this page; Esc closes it")),
)
WIDE_EMS = 40


class KeysDialog(QDialog):
    """The table of all keys."""

    def __init__(self, parent: Optional[QWidget]) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WA_DeleteOnClose)
        self.setWindowTitle(tr("Keys"))
        grid = QGridLayout(self)
        grid.setHorizontalSpacing(round(1.5 * basic.em()))
        for row, (key, text) in enumerate(KEYS):
            grid.addWidget(basic.enlarged(QLabel(tr(key)), 1.2, bold=True), row, 0, Qt.AlignTop)
            what = basic.enlarged(QLabel(tr(text), wordWrap=True), 1.2)
            grid.addWidget(what, row, 1)
        grid.setColumnStretch(1, 1)
        buttons = QDialogButtonBox(QDialogButtonBox.Close)
        buttons.rejected.connect(self.reject)
        grid.addWidget(buttons, len(KEYS), 0, 1, 2)
        self.resize(round(WIDE_EMS * basic.em()), self.sizeHint().height())


class KeysKey(WindowKeys):
    """Opens the page when `?` is pressed in a window of this process."""

    def __init__(self) -> None:
        self._dialog: Optional[KeysDialog] = None
        super().__init__()

    def open(self) -> None:
        """Open the page, or bring it to the front."""
        if self._dialog is None:
            self._dialog = KeysDialog(QApplication.activeWindow())
            self._dialog.destroyed.connect(self._forget)
        basic.show_alone(self._dialog)

    def eventFilter(self, _window: QObject, event: QEvent) -> bool:
        if event.type() == QEvent.KeyPress and event.text() == "?" and not _is_typing():
            self.open()
            return True
        return False

    def _forget(self) -> None:
        self._dialog = None


def _is_typing() -> bool:
    """Whether the focus is in a field for text."""
    return isinstance(QApplication.focusWidget(), (QLineEdit, QAbstractSpinBox))
