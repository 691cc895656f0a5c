"""Core Status: the state of the box, and the reload and exit buttons (docs/referee.md, "Core Status").

*Reload* checks the configuration files and lists what they change, before anything is applied.

What *exit* ends depends on the launch file (`HostWithRos.ends_box`).
"""

from typing import Callable, List, Optional, Sequence

from roah_rsbb.rqt.model.calls import CallOutcome
from roah_rsbb.rqt.panels.panel import AnswerLine, Panel, ask
from roah_rsbb.rqt.qt import QGridLayout, QHBoxLayout, QLabel, Qt
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.widgets.reload_dialog import ReloadDialog
from roah_rsbb.wording import whole_box
from roah_rsbb.wording.language import tr, tr_later, tr_said
from roah_rsbb.wording.whole_box import BOX_FACTS, box_facts

RELOAD = "reload"


class CoreStatusPanel(Panel):
    """Status, address, port, number of robots and runs; exit."""

    TITLE = tr_later("Core Status")
    TAB = tr_later("Core")
    WHERE = tr_later("The whole box")
    PARTS = ("robots", "zones")

    def __init__(self, client) -> None:
        super().__init__(client)
        self.notices = basic.Notices(1.3)
        self.notices.setMinimumHeight(round(3 * basic.em()))
        self.body.addWidget(self.notices, 1)
        grid = QGridLayout()
        self.values: List[QLabel] = []
        for number, label in enumerate(BOX_FACTS):
            value = QLabel(textFormat=Qt.PlainText)
            value.setTextInteractionFlags(Qt.TextSelectableByMouse)
            self.values.append(basic.enlarged(value, 1.1))
            row, column = divmod(number, 2)
            grid.addWidget(QLabel(tr(label)), row, 2 * column)
            grid.addWidget(value, row, 2 * column + 1)
            grid.setColumnStretch(2 * column + 1, 1)
        self.body.addLayout(grid)
        self._answer = AnswerLine()
        self.body.addWidget(self._answer)
        self.exit = basic.CommandButton(
            tr("Exit …"), tr("End this client or the whole RSBB. You are asked first."), 1.0)
        self.exit.allow(True)
        self.exit.clicked.connect(self.ask_exit)
        self.reload = basic.CommandButton(
            tr("Reload …"), tr("Take changed configuration files into use. First, all changes are listed."), 1.0)
        self.reload.allow(True)
        self.reload.clicked.connect(self.ask_reload)
        buttons = QHBoxLayout()
        buttons.addWidget(self.reload)
        buttons.addWidget(self.exit)
        self.body.addLayout(buttons)

    def show_model(self) -> None:
        document = self.model.document
        if document is None:
            self.notices.show_lines([(line, False) for line in (tr("Waiting for the core"), self.model.why) if line])
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
        self._answer.say(tr("Reading the configuration files …"))
        self.client.calls.call(self, RELOAD, self._ask_reload, digest="")

    def _ask_reload(self, found: CallOutcome) -> None:
        if found.error:
            self._answer.show_outcome(tr("Reload"), found)
            return
        self._answer.clear_answer()
        answer = found.result
        if answer["errors"]:
            self._show_lines(tr("Nothing was changed. Correct this first:"), answer["errors"])
        elif not answer["changes"]:
            self._answer.say(tr("The files contain what is in force"))
        else:
            warnings = [tr("Warning: {line}", line=line) for line in answer["warnings"]]
            heading = tr("Apply these changes? Connected runs keep what they began with.")
            self._show_lines(heading, [*answer["changes"], *warnings], lambda: self._apply(answer["digest"]))

    def _show_lines(self, heading: str, lines: Sequence[str], apply: Optional[Callable[[], None]] = None) -> None:
        basic.show_dialog(ReloadDialog(self, heading, list(lines), apply))

    def _apply(self, digest: str) -> None:
        self._answer.say(tr("Reload …"))
        self.client.calls.call(self, RELOAD, self._applied, digest=digest)

    def _applied(self, outcome: CallOutcome) -> None:
        if not outcome.error and outcome.result["errors"]:
            self._show_lines(tr("Nothing was changed. Correct this first:"), outcome.result["errors"])
            self._answer.clear_answer()
        else:
            self._answer.show_outcome(tr("Reload"), outcome)

    # -- exit ---------------------------------------------------------------------------------------

    def ask_exit(self) -> None:
        """Find out what *exit* would end, then ask."""
        self.exit.hold()
        self.client.calls.run(self, "exit", self.client.host.ends_box, self._ask)

    def _ask(self, found: CallOutcome) -> None:
        if found.error:
            self._answer.show_outcome(tr("Exit"), found)
            return
        runs = whole_box.runs_in_progress(map(self.model.zone_of, self.model.running_zones()))
        if found.result:
            question, yes, text = tr(whole_box.END_QUESTION), tr(whole_box.END_NOW), tr(whole_box.ENDS_ALL)
        else:
            question, yes = tr("End this client?"), tr("End this client")
            text = tr("This ends only this referee's client. The core and its runs continue.")
        in_progress = [tr(whole_box.END_RUNS, runs=runs)] if runs else []
        ask(self, question, "\n\n".join([text, *in_progress]), yes, self._exit)

    def _exit(self) -> None:
        self.client.host.exit(self.client.calls, self, self._answer.begin(tr("Exit")))
