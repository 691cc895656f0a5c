"""Actions as panels offer them: questions before something that cannot be undone, forms for fields, and, made from the
table of actions, those for which Benchmark Control has no place of its own: a row beside the clock, and a menu
(docs/referee.md, "Setup time, phases, pauses" and "Without a robot").
"""

from functools import partial
from typing import Any, Callable, Dict, Optional, Sequence, Tuple

from roah_rsbb.model.actions import ACTIONS, Action, Row
from roah_rsbb.model.fields import BadValue, Choice, EventId, Field, Number, Robot, Toggle, entered, fixed, read
from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.rqt import basic
from roah_rsbb.rqt.model import NOT_HEARD, Model
from roah_rsbb.rqt.qt import (
    QAction,
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QMessageBox,
    Qt,
    QTimer,
    QVBoxLayout,
    QWidget,
)
from roah_rsbb.wording.language import tr, tr_reason, tr_said

# Actions that are laid out by hand: in Benchmark Control, the strip with STOP, Manual Operation, OMF Switches, and the
# schedule of the box's page.
PLACED = ("previous", "next", "connect", "start", "disconnect", "stop", "choose_event", "operation", "switch",
          "damaged", "confirm_switches")
# A paused clock is easily forgotten.
HIGHLIGHTED = ("resume",)
# Width that shows the typed text, in units of the desktop's font.
WIDE_EMS = 32


def ask(parent: QWidget, question: str, details: str, yes: str, then) -> QMessageBox:
    """Ask before something that cannot be undone; call `then()` if the referee confirms."""
    box = QMessageBox(QMessageBox.Warning, "", "", parent=parent)
    _word(box, question, details)
    accept = box.addButton(yes, QMessageBox.AcceptRole)
    cancel = box.addButton(tr("Cancel"), QMessageBox.RejectRole)
    box.setDefaultButton(cancel)
    box.setEscapeButton(cancel)
    box.setAttribute(Qt.WA_DeleteOnClose)
    box.buttonClicked.connect(lambda button: then() if button is accept else None)
    basic.show_dialog(box)
    return box


def _word(box: QMessageBox, question: str, details: str) -> None:
    """Give a question its texts, as they are: the name of a robot may look like HTML."""
    box.setWindowTitle(question)
    box.setText(question)
    box.setInformativeText(details)
    for label in box.findChildren(QLabel):
        label.setTextFormat(Qt.PlainText)


def keep_true(box: QMessageBox, model: Model, current: Callable[[], Tuple[str, str]]) -> None:
    """Keep a question true while it is open. `current` returns it and its details. One that has changed cannot be
    confirmed for a moment, because the referee has not read it."""
    accept = next(button for button in box.buttons() if box.buttonRole(button) == QMessageBox.AcceptRole)
    held = QTimer(box, singleShot=True, timeout=lambda: accept.setEnabled(True))

    def look() -> None:
        question, details = current()
        if (question, details) == (box.text(), box.informativeText()):
            return
        _word(box, question, details)
        accept.setEnabled(False)
        held.start(basic.HOLD_MS)

    model.updated.connect(look)
    box.destroyed.connect(lambda: model.updated.disconnect(look))


class FormDialog(QDialog):
    """Asks with a form. A subclass adds rows to `form`, and passes on what was entered if the referee confirms."""

    def __init__(self, parent: QWidget, title: str, text: str, yes: str = "") -> None:
        """`text`: what it is about; `yes`: the button that confirms; empty: it can only be closed."""
        super().__init__(parent, windowTitle=title)
        self.setAttribute(Qt.WA_DeleteOnClose)
        what = basic.enlarged(QLabel(text, wordWrap=True, textFormat=Qt.PlainText), basic.LEAD, bold=True)
        what.setMinimumWidth(round(WIDE_EMS * basic.em()))
        self.form = QFormLayout()
        buttons = QDialogButtonBox()
        self.yes = buttons.addButton(yes, QDialogButtonBox.AcceptRole) if yes else None
        self.cancel = buttons.addButton(tr("Cancel") if yes else tr("Close"), QDialogButtonBox.RejectRole)
        buttons.accepted.connect(self.confirm)
        buttons.rejected.connect(self.reject)
        box = QVBoxLayout(self)
        box.addWidget(what)
        box.addLayout(self.form, 1)
        box.addWidget(buttons)

    def confirm(self) -> None:
        """Close, and pass on what was entered."""


class FieldEditors(QWidget):
    """An editor for each field that somebody must enter."""

    def __init__(self, fields: Sequence[Field]) -> None:
        super().__init__()
        self._fields = fields
        form = basic.flat(QFormLayout(self))
        self.editors: Dict[str, QWidget] = {}
        for field in entered(fields):
            self.editors[field.name] = _editor(field)
            label = QLabel(tr(field.label), textFormat=Qt.PlainText)
            label.setBuddy(self.editors[field.name])
            form.addRow(label, self.editors[field.name])
        self.problem = QLabel(wordWrap=True, textFormat=Qt.PlainText)
        self.problem.hide()
        form.addRow(self.problem)

    def given(self) -> Optional[Dict[str, Any]]:
        """Return the values of all fields but the team; None: one is wrong, and it is said which."""
        values = {name: value for name, editor in self.editors.items() for value in [_entry(editor)] if value != ""}
        try:
            return {**read(entered(self._fields), values), **fixed(self._fields)}
        except BadValue as bad:
            self.problem.setText(f"⚠ {tr_reason(bad.reason)}")
            self.problem.show()
            return None


class ActionForm(FormDialog):
    """Asks for the fields of an action, and calls `then` with their values."""

    def __init__(
        self, parent: QWidget, action: Action, what: str, fields: Sequence[Field],
        then: Callable[[Dict[str, Any]], None],
    ) -> None:
        """`what`: what is done where, for the heading."""
        super().__init__(parent, what, what, tr(action.label))
        self._then = then
        self.form.addRow(QLabel(tr(action.explanation), wordWrap=True))
        self.inside = FieldEditors(fields)
        self.form.addRow(self.inside)
        next(iter(self.inside.editors.values())).setFocus()

    def confirm(self) -> None:
        given = self.inside.given()
        if given is not None:
            self.accept()
            self._then(given)


def _editor(field: Field) -> QWidget:
    if isinstance(field, Toggle):
        return QCheckBox()
    if isinstance(field, Choice):
        box = QComboBox()
        box.addItems([*([] if field.required else [""]), *field.choices])
        return box
    if isinstance(field, Number):
        number = basic.WholeField()
        number.setRange(field.low, field.high)
        number.setSuffix(f" {field.unit}" if field.unit else "")
        number.setValue(field.default)
        return number
    hints = {"pose": "x y ° (1.25 0.40 90)", "decimal": getattr(field, "unit", "")}
    return QLineEdit(maxLength=field.most, placeholderText=hints.get(field.kind, ""))


def _entry(editor: QWidget) -> Any:
    if isinstance(editor, QCheckBox):
        return editor.isChecked()
    if isinstance(editor, QComboBox):
        return editor.currentText()
    return editor.value() if isinstance(editor, basic.WholeField) else editor.text().strip()


def others(row: Row) -> Sequence[Action]:
    """Return the actions that no panel lays out by hand, for a row."""
    return [action for action in ACTIONS.values() if action.name not in PLACED and action.row is row]


def what_text(action: Action, zone: str) -> str:
    """Return what an answer is about."""
    return tr(action.what, zone=zone) if action.what else tr("{command} in {zone}", command=tr(action.label), zone=zone)


def why_off(zone: Optional[ZoneSeen], name: str, silent: str) -> Sequence[str]:
    """Return why an action is off now; empty: it is on. `silent`: why nothing is possible; empty: the core is heard."""
    if zone is None or silent:
        return [silent or tr(NOT_HEARD)]
    return [tr_said(reason) for reason in zone.off(name)]


def is_offered(action: Action) -> bool:
    """Whether a form can offer all fields of an action. Robots and events are chosen elsewhere."""
    return not any(isinstance(field, (EventId, Robot)) for field in action.fields)


class RuleButtons(QWidget):
    """Phases and pause, and what a module asks for, in a row that is only visible where there are such actions."""

    def __init__(self, press: Callable[[Action], None]) -> None:
        super().__init__()
        self.buttons: Dict[str, basic.CommandButton] = {}
        row = basic.flat(QHBoxLayout(self))
        for action in (*others(Row.CLOCK), *others(Row.MODULE)):
            dots = " …" if entered(action.fields) else ""
            button = basic.CommandButton(
                tr(action.label) + dots, tr(action.explanation), basic.TEXT, partial(press, action))
            row.addWidget(button, 1)
            self.buttons[action.name] = button
        self.hide()

    def show_zone(self, zone: Optional[ZoneSeen], silent: str) -> None:
        """Show what is possible now. `silent`: why nothing is; empty: the core is heard."""
        is_visible = False
        for name, button in self.buttons.items():
            reasons = why_off(zone, name, silent)
            button.allow(not reasons, reasons, basic.ON if name in HIGHLIGHTED else None)
            button.setVisible(zone is not None and zone.action(name).shown)
            is_visible = is_visible or not button.isHidden()
        self.setVisible(is_visible)


class MoreMenu(basic.MenuButton):
    """The team's robots to choose from, and the actions without a place of their own."""

    def __init__(self, connect_robot: Callable[[str], None], press: Callable[[Action], None]) -> None:
        super().__init__("⋯", basic.LEAD)
        self.setToolTip(tr("Choose a robot, score without a robot, no-show"))
        self._connect_robot = connect_robot
        self.entries.setToolTipsVisible(True)
        self._robots: Sequence[str] = ()
        self.robots: Sequence[QAction] = ()  # one for each of the team's robots
        self.actions_of: Dict[str, QAction] = {}
        for action in filter(is_offered, others(Row.MORE)):
            dots = " …" if action.question or entered(action.fields) else ""
            entry = self.entries.addAction(tr(action.label) + dots)
            entry.triggered.connect(lambda _checked=False, action=action: press(action))
            self.actions_of[action.name] = entry
        self._line = self.entries.insertSeparator(next(iter(self.actions_of.values())))
        self._line.setVisible(False)

    def show_zone(self, zone: Optional[ZoneSeen], silent: str) -> None:
        """Show what is possible now. An open menu does not change its entries, only what is possible."""
        robots = () if zone is None or silent else zone.robots_to_choose
        if robots != self._robots and not self.entries.isVisible():
            self._show_robots(robots)
        for entry in self.robots:
            entry.setEnabled(bool(robots))
        for name, entry in self.actions_of.items():
            reasons = why_off(zone, name, silent)
            entry.setEnabled(not reasons)
            entry.setToolTip(basic.tip("\n".join(reasons) or tr(ACTIONS[name].explanation)))
            entry.setVisible(zone is None or zone.action(name).shown)

    def _show_robots(self, robots: Sequence[str]) -> None:
        for action in self.robots:
            self.entries.removeAction(action)
        self._robots, self.robots = robots, []
        for robot in robots:
            action = QAction(tr("Connect {robot}", robot=robot), self.entries)
            action.triggered.connect(lambda _checked=False, robot=robot: self._connect_robot(robot))
            self.entries.insertAction(self._line, action)
            self.robots.append(action)
        self._line.setVisible(bool(robots))
