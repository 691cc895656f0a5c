"""Dialogs for text: a score with a note, why an entry is withdrawn, why a run was stopped."""

from typing import Callable, Optional

from roah_rsbb.msg import ZoneScoreGroup
from roah_rsbb.rqt.qt import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QLabel,
    QLineEdit,
    QSpinBox,
    Qt,
    QWidget,
)
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.language import tr

MAX_NOTE = 500
MAX_VALUE = 2**31 - 1
# Width that shows the typed text, in units of the desktop's font.
WIDE_EMS = 32


class NoteDialog(QDialog):
    """Asks for a line of text and calls `then(note)` if the referee confirms."""

    def __init__(
        self, parent: QWidget, title: str, text: str, note_label: str, yes: str, then: Callable[[str], None]
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self.setAttribute(Qt.WA_DeleteOnClose)
        self._then = then
        self.form = QFormLayout(self)
        what = basic.enlarged(QLabel(text, wordWrap=True), 1.2, bold=True)
        what.setTextFormat(Qt.PlainText)
        what.setMinimumWidth(round(WIDE_EMS * basic.em()))
        self.form.addRow(what)
        self.note = QLineEdit(maxLength=MAX_NOTE)
        self.buttons = QDialogButtonBox()
        self.yes = self.buttons.addButton(yes, QDialogButtonBox.AcceptRole)
        self.cancel = self.buttons.addButton(tr("Cancel"), QDialogButtonBox.RejectRole)
        self.buttons.accepted.connect(self._accept)
        self.buttons.rejected.connect(self.reject)
        self.add_fields()
        self.form.addRow(note_label, self.note)
        self.form.addRow(self.buttons)
        self.note.setFocus()

    def add_fields(self) -> None:
        """A subclass adds its fields here, above the note."""

    def answer(self) -> None:
        """Pass on what was entered."""
        self._then(self.note.text().strip())

    def _accept(self) -> None:
        self.accept()
        self.answer()


class ScoreDialog(NoteDialog):
    """Asks for the value of an item; calls `then(value, not_attempted, note)`."""

    def __init__(
        self, parent: QWidget, title: str, desc: str, kind: int, value: int, not_attempted: bool,
        then: Callable[[int, bool, str], None],
    ) -> None:
        self._is_bool = kind == ZoneScoreGroup.SCORING_BOOL
        self._value = value
        self._was_not_attempted = not_attempted
        self._then_scored = then
        self.number: Optional[QSpinBox] = None
        self.tick: Optional[QCheckBox] = None
        super().__init__(parent, title, desc, tr("Note"), tr("Save"), lambda note: None)

    def add_fields(self) -> None:
        self.not_attempted = QCheckBox(tr("Not attempted"), checked=self._was_not_attempted)
        if self._is_bool:
            self.tick = QCheckBox(tr("Yes"), checked=bool(self._value))
            field = self.tick
        else:
            self.number = QSpinBox(minimum=0, maximum=MAX_VALUE, value=self._value)
            field = self.number
        field.setEnabled(not self._was_not_attempted)
        self.not_attempted.toggled.connect(lambda on: field.setEnabled(not on))
        self.form.addRow(tr("Value"), field)
        self.form.addRow("", self.not_attempted)

    def answer(self) -> None:
        value = int(self.tick.isChecked()) if self.tick is not None else self.number.value()
        not_attempted = self.not_attempted.isChecked()
        self._then_scored(0 if not_attempted else value, not_attempted, self.note.text().strip())
