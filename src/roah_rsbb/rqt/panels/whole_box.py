"""Panels of the whole box: Core Status with reload and exit, Tablet Status, Active Robots (docs/referee.md)."""

from functools import partial
from typing import Callable, List, Optional, Sequence, Tuple

from roah_rsbb.rqt import basic
from roah_rsbb.rqt.calls import CallOutcome
from roah_rsbb.rqt.model import NOT_HEARD
from roah_rsbb.rqt.panels.actions import FormDialog, ask
from roah_rsbb.rqt.panels.panel import AnswerLine, CollapsingPanel, Panel
from roah_rsbb.rqt.qt import (
    QAbstractItemView,
    QCheckBox,
    QFormLayout,
    QGridLayout,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPlainTextEdit,
    Qt,
    QTableWidget,
    QTableWidgetItem,
    QWidget,
)
from roah_rsbb.wording import whole_box
from roah_rsbb.wording.language import tr, tr_later, tr_said
from roah_rsbb.wording.whole_box import (
    BOX_FACTS,
    ROBOT_COLUMNS,
    TABLET_FACTS,
    LinkQuality,
    box_facts,
    column_explanations,
    robot_rows,
    tablet_facts,
)

RELOAD = "reload"


class CoreStatusPanel(Panel):
    """Status, address, port, number of robots and runs; reload and exit.

    *Reload* checks the configuration files and lists what they change, before anything is applied. What *exit* ends
    depends on the launch file (`WindowNode.ends_box`).
    """

    TITLE = tr_later("Core Status")
    TAB = tr_later("Core")
    WHERE = tr_later("The whole box")
    PARTS = ("robots", "zones")

    def __init__(self, client) -> None:
        super().__init__(client)
        self.notices = basic.Notices()
        self.notices.setMinimumHeight(round(3 * basic.em()))
        self.body.addWidget(self.notices, 1)
        grid = QGridLayout()
        self.values: List[QLabel] = []
        for number, label in enumerate(BOX_FACTS):
            value = QLabel(textFormat=Qt.PlainText)
            value.setTextInteractionFlags(Qt.TextSelectableByMouse)
            self.values.append(basic.enlarged(value, basic.TEXT, bold=True))
            row, column = divmod(number, 2)
            grid.addWidget(QLabel(tr(label)), row, 2 * column)
            grid.addWidget(value, row, 2 * column + 1)
            grid.setColumnStretch(2 * column + 1, 1)
        self.body.addLayout(grid)
        self.answer = AnswerLine()
        self.body.addWidget(self.answer)
        self.exit = basic.CommandButton(
            tr("Exit …"), tr("End this client or the whole RSBB. You are asked first."), basic.TEXT, self.ask_exit)
        self.exit.allow(True)
        self.reload = basic.CommandButton(
            tr("Reload …"), tr("Take changed configuration files into use. First, all changes are listed."), basic.TEXT,
            self.ask_reload)
        self.reload.allow(True)
        buttons = QHBoxLayout()
        buttons.addWidget(self.reload)
        buttons.addWidget(self.exit)
        self.body.addLayout(buttons)

    def show_model(self) -> None:
        document = self.model.document
        if document is None:
            self.notices.show_lines([(line, False) for line in (tr(NOT_HEARD), self.model.why) if line])
            return
        box = document.box
        status = [(tr_said(box.own_status), box.status != "OK")] if box.own_status else []
        self.notices.show_lines(status + [(tr_said(warning), True) for warning in box.warnings])
        for value, text in zip(self.values, box_facts(document)):
            value.setText(text)
            value.setEnabled(not self.model.is_old)

    # -- reload -------------------------------------------------------------------------------------

    def ask_reload(self) -> None:
        """Check the files, list what they change, then ask."""
        self.reload.hold()
        self.answer.say(tr("Reading the configuration files …"))
        self.client.calls.call(self, RELOAD, self._ask_reload, digest="")

    def _ask_reload(self, found: CallOutcome) -> None:
        if found.error:
            self.answer.show_outcome(tr("Reload"), found)
            return
        self.answer.clear_answer()
        answer = found.result
        if answer["errors"]:
            self._show_lines(tr(whole_box.RELOAD_ERRORS), answer["errors"])
        elif not answer["changes"] and not answer["rescored"]:
            self.answer.say(tr(whole_box.RELOAD_SAME))
        else:
            warnings = [tr("Warning: {line}", line=line) for line in answer["warnings"]]
            rescored = [tr(whole_box.RELOAD_RESCORED), *answer["rescored"]] if answer["rescored"] else []
            self._show_lines(tr(whole_box.RELOAD_APPLY), [*answer["changes"], *warnings, *rescored],
                             partial(self._apply, answer["digest"]), bool(rescored))

    def _show_lines(
        self, heading: str, lines: Sequence[str], apply: Optional[Callable[[bool], None]] = None, has_runs: bool = False
    ) -> None:
        basic.show_dialog(ReloadDialog(self, heading, list(lines), apply, has_runs))

    def _apply(self, digest: str, for_all: bool) -> None:
        self.answer.say(tr("Reload …"))
        self.client.calls.call(self, RELOAD, self._applied, digest=digest, for_all=for_all)

    def _applied(self, outcome: CallOutcome) -> None:
        if not outcome.error and outcome.result["errors"]:
            self._show_lines(tr(whole_box.RELOAD_ERRORS), outcome.result["errors"])
            self.answer.clear_answer()
        else:
            self.answer.show_outcome(tr("Reload"), outcome)

    # -- exit ---------------------------------------------------------------------------------------

    def ask_exit(self) -> None:
        """Find out what *exit* would end, then ask."""
        self.exit.hold()
        self.client.calls.run(self, "exit", self.client.node.ends_box, self._ask)

    def _ask(self, found: CallOutcome) -> None:
        if found.error:
            self.answer.show_outcome(tr("Exit"), found)
            return
        runs = whole_box.runs_in_progress(map(self.model.zone_of, self.model.running_zones()))
        if found.result:
            question, yes, text = tr(whole_box.END_QUESTION), tr(whole_box.END_NOW), tr(whole_box.ENDS_ALL)
        else:
            question, yes = tr("End this client?"), tr("End this client")
            text = tr("This ends only this referee's client. The box and its runs continue.")
        in_progress = [tr(whole_box.END_RUNS, runs=runs)] if runs else []
        ask(self, question, "\n\n".join([text, *in_progress]), yes, self._exit)

    def _exit(self) -> None:
        self.client.node.exit(self.client.calls, self, self.answer.begin(tr("Exit")))


# Size, in units of the desktop's font.
RELOAD_WIDE_EMS, RELOAD_HIGH_EMS = 52, 26


class ReloadDialog(FormDialog):
    """Shows the lines, and calls `apply(for_all)` if the organiser confirms. Without `apply`, it can only be closed.
    `has_runs`: the changes may be applied to the runs that are over, too."""

    def __init__(
        self, parent: QWidget, heading: str, lines: List[str], apply: Optional[Callable[[bool], None]], has_runs: bool
    ) -> None:
        super().__init__(parent, tr(whole_box.RELOAD), heading, "" if apply is None else tr("Apply"))
        self.lines = QPlainTextEdit("\n".join(lines), readOnly=True)
        self.form.addRow(self.lines)
        self.for_all = QCheckBox(tr(whole_box.RELOAD_FOR_ALL))
        if has_runs:
            self.form.addRow(self.for_all)
        if apply is not None:
            self.yes.setAutoDefault(False)
            self.cancel.setDefault(True)
            self.accepted.connect(lambda: apply(self.for_all.isChecked()))
        self.resize(round(RELOAD_WIDE_EMS * basic.em()), round(RELOAD_HIGH_EMS * basic.em()))

    def confirm(self) -> None:
        self.accept()


class TabletStatusPanel(Panel):
    """Display, call and position of the tablet."""

    TITLE = tr_later("Tablet Status")
    TAB = tr_later("Tablet")
    WHERE = tr_later("The whole box")
    PARTS = ()

    def __init__(self, client) -> None:
        super().__init__(client)
        form = QFormLayout()
        form.setRowWrapPolicy(QFormLayout.WrapLongRows)
        self.values: List[QLabel] = []
        for label in TABLET_FACTS:
            self.values.append(basic.enlarged(QLabel(wordWrap=True, textFormat=Qt.PlainText), basic.LEAD))
            form.addRow(tr(label), self.values[-1])
        self.body.addLayout(form)
        self.body.addStretch(1)

    def show_model(self) -> None:
        if self.model.box is None:
            self.values[0].setText(tr(NOT_HEARD))

    def show_times(self) -> None:
        if self.model.box is None:
            return
        moments = self.client.moments
        for value, (text, utc_s) in zip(self.values, tablet_facts(self.model.box.tablet, self.model.now(), moments)):
            value.setText(text)
            value.setToolTip(moments.tip(utc_s) if utc_s else "")
            value.setEnabled(not self.model.is_old)


class ActiveRobotsPanel(CollapsingPanel):
    """A table with one row per robot."""

    TITLE = tr_later("Active Robots")
    TAB = tr_later("Robots")
    WHERE = tr_later("The whole box")
    PARTS = ("robots", "zones")

    def __init__(self, client) -> None:
        super().__init__(client)
        self.table = QTableWidget(0, len(ROBOT_COLUMNS))
        self.table.setHorizontalHeaderLabels([tr(column) for column in ROBOT_COLUMNS])
        for column, explanation in column_explanations().items():
            self.table.horizontalHeaderItem(column).setToolTip(basic.tip(explanation))
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeToContents)
        self.table.horizontalHeader().setStretchLastSection(True)
        self.table.verticalHeader().hide()
        self.table.verticalHeader().setSectionResizeMode(QHeaderView.ResizeToContents)
        self.table.setEditTriggers(QAbstractItemView.NoEditTriggers)
        self.table.setSelectionMode(QAbstractItemView.NoSelection)
        self.table.setFocusPolicy(Qt.NoFocus)
        self.body.addWidget(self.table, 1)
        self._links = LinkQuality()

    def watch(self) -> None:
        super().watch()
        self._observe()  # the quality depends on the past

    def _observe(self) -> None:
        if self.model.document is not None:
            self._links.look(self.model.document, self.model.now().mono)

    def show_model(self) -> None:
        self._observe()
        self.table.setEnabled(not self.model.is_old)

    def show_times(self) -> None:
        document = self.model.document
        robots = [] if document is None else robot_rows(document, self.model.now().mono, self._links)
        self._show_lines(robots or [self._nobody()])

    def _nobody(self) -> Tuple[str, ...]:
        text = tr(whole_box.NO_ROBOT) if self.model.document else tr(NOT_HEARD)
        return (text, *("" for _ in ROBOT_COLUMNS[1:]))

    def _show_lines(self, lines: List[Tuple[str, ...]]) -> None:
        self.table.setRowCount(len(lines))
        for row, line in enumerate(lines):
            for column, text in enumerate(line):
                item = self.table.item(row, column)
                if item is None:
                    item = QTableWidgetItem()
                    self.table.setItem(row, column, item)
                if item.text() != text:
                    item.setText(text)
