"""Dialogs with a form: a score with a note, and the base of others."""

from typing import Callable, Hashable, Optional, Union

from roah_rsbb.model.scoring import Entered
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.rqt.qt import (
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QLabel,
    QLineEdit,
    Qt,
    QWidget,
)
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.widgets.score_fields import ChoiceField, NumberField
from roah_rsbb.wording.language import tr

MAX_NOTE = 500
MAX_VALUE = 2**31 - 1
# Width that shows the typed text, in units of the desktop's font.
WIDE_EMS = 32


class FormDialog(QDialog):
    """Asks with a form. A subclass adds its fields, and passes on what was entered if the referee confirms."""

    def __init__(self, parent: QWidget, title: str, text: str, yes: str) -> None:
        """`text`: what it is about; `yes`: the button that confirms."""
        super().__init__(parent, windowTitle=title)
        self.setAttribute(Qt.WA_DeleteOnClose)
        self.form = QFormLayout(self)
        what = basic.enlarged(QLabel(text, wordWrap=True, textFormat=Qt.PlainText), 1.2, bold=True)
        what.setMinimumWidth(round(WIDE_EMS * basic.em()))
        self.form.addRow(what)
        buttons = QDialogButtonBox()
        self.yes = buttons.addButton(yes, QDialogButtonBox.AcceptRole)
        self.cancel = buttons.addButton(tr("Cancel"), QDialogButtonBox.RejectRole)
        buttons.accepted.connect(self.confirm)
        buttons.rejected.connect(self.reject)
        self.add_fields()
        self.form.addRow(buttons)

    def add_fields(self) -> None:
        """Add the fields, and give one of them the focus."""

    def confirm(self) -> None:
        """Close, and pass on what was entered."""


class ScoreDialog(FormDialog):
    """Asks for the value of an item; calls `then(given)`."""

    def __init__(
        self, parent: QWidget, title: str, item: SheetItem, value: Hashable, not_attempted: bool,
        then: Callable[[Entered], None],
    ) -> None:
        """`value`: a number or a text; ignored if the item was not attempted."""
        self._item = item
        self._value = value
        self._was_not_attempted = not_attempted
        self.number: Optional[basic.WholeField] = None
        self.tick: Optional[QCheckBox] = None
        self.field: Union[NumberField, ChoiceField, None] = None
        self.judge: Optional[QComboBox] = None
        self._then = then
        super().__init__(parent, title, item.desc, tr("Save"))

    def add_fields(self) -> None:
        self.not_attempted = QCheckBox(tr("Not attempted"), checked=self._was_not_attempted)
        field = self._field()
        field.setEnabled(not self._was_not_attempted)
        self.not_attempted.toggled.connect(lambda on: field.setEnabled(not on))
        self.form.addRow(tr("Value"), field)
        self.form.addRow("", self.not_attempted)
        self.note = QLineEdit(maxLength=MAX_NOTE)
        self.form.addRow(tr("Note"), self.note)
        self.note.setFocus()

    def _field(self) -> QWidget:
        """Make the field of the item's type."""
        item = self._item
        value = 0 if self._was_not_attempted else self._value
        if item.type == "bool":
            self.tick = QCheckBox(tr("Yes"), checked=bool(value))
            return self.tick
        if item.type in ("uint", "int"):
            least = 0 if item.type == "uint" else int(item.min or -MAX_VALUE)
            self.number = basic.WholeField(minimum=least, maximum=int(item.max or MAX_VALUE), value=value)
            return self.number
        if item.type == "choice":
            self.field = ChoiceField(item, lambda text: None)
            self.field.show_text(str(value))
            return self.field
        self.field = NumberField(item, lambda text: None, may_be_empty=item.type == "rating")
        if not item.judges:
            self.field.show_text(str(value))
            return self.field
        self.judge = QComboBox()
        self.judge.addItems(item.judges)
        self.judge.currentIndexChanged.connect(lambda index: self.field.show_text(item.ratings[index]))
        self.field.show_text(item.ratings[0])
        self.form.addRow(tr("Judge"), self.judge)
        return self.field

    def confirm(self) -> None:
        self.accept()
        note = self.note.text().strip()
        if self.not_attempted.isChecked():
            self._then(Entered(not_attempted=True, note=note))
        elif self.field is not None:
            judge = "" if self.judge is None else self.judge.currentText()
            self._then(Entered(0, self.field.text_value(), judge, False, note))
        else:
            value = int(self.tick.isChecked()) if self.tick is not None else self.number.value()
            self._then(Entered(value, note=note))
