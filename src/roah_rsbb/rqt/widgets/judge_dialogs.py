"""Dialogs of the head referee: settle an item, decide about a judge's sheet, enter and answer an objection.

Each asks for a text that the core needs, and cannot be confirmed without it.
"""

from functools import partial
from typing import Callable, List

from roah_rsbb.model.scoring import Entered
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.rqt.qt import QComboBox, QHBoxLayout, QLineEdit, QPushButton, QWidget
from roah_rsbb.rqt.widgets.score_dialogs import FormDialog, NoteDialog, ScoreDialog
from roah_rsbb.wording import judging
from roah_rsbb.wording.language import tr

MAX_WHO = 100


class SettleDialog(ScoreDialog):
    """Asks for the value of an item on which judges differ: that of a judge with one press, or another one."""

    def __init__(
        self, parent: QWidget, item: SheetItem, judged: judging.Judged, then: Callable[[Entered], None]
    ) -> None:
        self._judged = judged
        self._is_chosen = False
        self.given: List[QPushButton] = []
        # A rating is settled by one number for all judges.
        one = item._replace(judges=(), ratings=())
        super().__init__(parent, tr(judging.SETTLE), one, item.text or item.value, item.not_attempted, then)
        self.setWindowTitle(f"{tr(judging.SETTLE)}: {item.group}: {item.desc}")
        self.yes.setText(tr(judging.SETTLE))
        self.form.labelForField(self.note).setText(tr("Reason"))
        self.note.textChanged.connect(lambda _text: self._allow())
        self._allow()

    def add_fields(self) -> None:
        line = QHBoxLayout()
        for given in self._judged.given:
            button = QPushButton(f"{given.judge}: {given.shown}".replace("&", "&&"))
            button.setAutoDefault(False)
            button.clicked.connect(partial(self._take, given))
            line.addWidget(button)
            self.given.append(button)
        line.addStretch(1)
        self.form.addRow(tr("Judges"), line)
        super().add_fields()
        self.not_attempted.toggled.connect(self._choose)
        if self.tick is not None:
            self.tick.toggled.connect(self._choose)
        elif self.number is not None:
            self.number.valueChanged.connect(self._choose)
        elif isinstance(self.field, QComboBox):
            self.field.activated.connect(self._choose)
        else:
            self.field.valueChanged.connect(self._choose)

    def _take(self, given: judging.GivenInWords) -> None:
        self.not_attempted.setChecked(given.not_attempted)
        if given.not_attempted:
            pass
        elif self.tick is not None:
            self.tick.setChecked(bool(given.value))
        elif self.number is not None:
            self.number.setValue(given.value)
        else:
            self.field.show_text(given.text)
        self._choose()
        self.note.setFocus()

    def _choose(self, *_value: object) -> None:
        self._is_chosen = True
        self._allow()

    def _allow(self) -> None:
        self.yes.setEnabled(self._is_chosen and bool(self.note.text().strip()))


class ReasonDialog(NoteDialog):
    """Asks for a reason, or another text that is needed."""

    def __init__(
        self, parent: QWidget, title: str, text: str, note_label: str, yes: str, then: Callable[[str], None]
    ) -> None:
        super().__init__(parent, title, text, note_label, yes, then)
        self.note.textChanged.connect(lambda _text: self.allow())
        self.allow()

    def allow(self) -> None:
        """Allow to confirm if all is entered."""
        self.yes.setEnabled(self.is_complete())

    def is_complete(self) -> bool:
        """Whether all is entered."""
        return bool(self.note.text().strip())


class ChoiceDialog(ReasonDialog):
    """Asks for one of several things, and for a text; calls `then(index, text)`."""

    def __init__(
        self, parent: QWidget, title: str, text: str, choice_label: str, choices: List[str], note_label: str, yes: str,
        then: Callable[[int, str], None],
    ) -> None:
        """`text`: what it is about."""
        self._choice_label = choice_label
        self._choices = choices
        super().__init__(parent, title, text, note_label, yes, lambda note: then(self.chosen.currentIndex(), note))

    def add_fields(self) -> None:
        self.chosen = QComboBox()
        self.chosen.addItems(self._choices)
        # The first one is no answer: whoever confirms in haste must have chosen.
        self.chosen.setCurrentIndex(0 if len(self._choices) == 1 else -1)
        self.chosen.currentIndexChanged.connect(lambda _index: self.allow())
        self.form.addRow(self._choice_label, self.chosen)
        super().add_fields()
        self.chosen.setFocus()

    def is_complete(self) -> bool:
        return super().is_complete() and self.chosen.currentIndex() >= 0


class ObjectionDialog(ReasonDialog):
    """Asks who objects, and for the objection; calls `then(who, text)`."""

    def __init__(self, parent: QWidget, text: str, then: Callable[[str, str], None]) -> None:
        """`text`: what it is about."""
        super().__init__(parent, tr(judging.OBJECT), text, tr("Objection"), tr("Save"),
                         lambda note: then(self.who.text().strip(), note))

    def add_fields(self) -> None:
        self.who = QLineEdit(maxLength=MAX_WHO)
        self.who.textChanged.connect(lambda _text: self.allow())
        self.form.addRow(tr("Who objects"), self.who)
        super().add_fields()
        self.who.setFocus()

    def is_complete(self) -> bool:
        return super().is_complete() and bool(self.who.text().strip())


class PublishDialog(FormDialog):
    """Asks for the time for objections; calls `then(seconds)`, negative: as the benchmarks file says."""

    def __init__(self, parent: QWidget, text: str, then: Callable[[float], None]) -> None:
        """`text`: what it is about."""
        self._then = then
        super().__init__(parent, tr(judging.PUBLISH), text, tr(judging.PUBLISH))

    def add_fields(self) -> None:
        self.chosen = QComboBox()
        for seconds, text in judging.objection_times():
            self.chosen.addItem(text, seconds)
        self.form.addRow(tr(judging.OBJECTION_TIME), self.chosen)
        self.chosen.setFocus()

    def answer(self) -> None:
        self._then(self.chosen.currentData())
