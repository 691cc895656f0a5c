"""Core Status: the state of the box, and the exit button (docs/referee.md, "Core Status").

What *exit* ends depends on the launch file. A client's own shutdown node ends that client, unless the client was
started together with the core (`exit_ends_rsbb`). Without a client, the core's shutdown node in the root namespace ends
the whole RSBB.
"""

from typing import Dict

import rospy
from std_srvs.srv import Empty

from roah_rsbb.rqt.model.calls import CallOutcome
from roah_rsbb.rqt.panels.panel import Answer, Panel, ask
from roah_rsbb.rqt.qt import QGridLayout, QLabel, Qt
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.sent import tr_sent

SHUTDOWN = "roah_rsbb_shutdown"
ENDS_RSBB = "exit_ends_rsbb"

FIELDS = {
    "addr": tr_later("Broadcast to"),
    "port": tr_later("UDP port"),
    "robots": tr_later("Robots"),
    "runs": tr_later("Running"),
}


class CoreStatusPanel(Panel):
    """Status, address, port, number of robots and runs; exit."""

    TITLE = tr_later("Core Status")
    TAB = tr_later("Core")

    def __init__(self, client, parent=None) -> None:
        super().__init__(client, parent)
        self.notices = basic.Notices(1.3)
        self.notices.setMinimumHeight(round(3 * basic.em()))
        self.body.addWidget(self.notices, 1)
        grid = QGridLayout()
        self._values: Dict[str, QLabel] = {}
        for number, (name, label) in enumerate(FIELDS.items()):
            value = QLabel()
            value.setTextFormat(Qt.PlainText)
            value.setTextInteractionFlags(Qt.TextSelectableByMouse)
            self._values[name] = basic.enlarged(value, 1.1)
            row, column = divmod(number, 2)
            grid.addWidget(QLabel(tr(label)), row, 2 * column)
            grid.addWidget(value, row, 2 * column + 1)
            grid.setColumnStretch(2 * column + 1, 1)
        self.body.addLayout(grid)
        self._answer = Answer()
        self.body.addWidget(self._answer)
        self.exit = basic.CommandButton(
            tr("Exit …"), tr("End this client or the whole RSBB. You are asked first."), 1.0)
        self.exit.allow(True)
        self.exit.clicked.connect(self.ask_exit)
        self.body.addWidget(self.exit)

    def show_model(self) -> None:
        gui, details = self.model.gui, self.model.details
        if gui is None:
            self.notices.show_lines([(tr("Waiting for the core"), False)])
            return
        warnings = list(details.warnings) if details else []
        # The status may only repeat these warnings in one line.
        is_repeated = bool(warnings) and gui.status == "; ".join(warnings)
        status = [] if is_repeated else [(tr_sent(gui.status), gui.status != "OK")]
        self.notices.show_lines(status + [(tr_sent(w), True) for w in warnings])
        phases = [d.phase for d in details.zones] if details else []
        values = {
            "addr": gui.addr,
            "port": gui.port,
            "robots": str(len(gui.active_robots)),
            "runs": tr("{number} of {n} zones", number=phases.count("running"), n=len(gui.zones)),
        }
        for name, value in values.items():
            self._values[name].setText(value)
            self._values[name].setEnabled(not self.model.is_old)

    def where(self) -> str:
        return tr("The whole box")

    # -- exit ---------------------------------------------------------------------------------------

    def ask_exit(self) -> None:
        """Find out what *exit* would end, then ask."""
        self.exit.hold()
        service = rospy.resolve_name(SHUTDOWN)
        at_root = service == f"/{SHUTDOWN}"
        self.client.calls.run(
            self, "exit", lambda: at_root or bool(rospy.get_param(ENDS_RSBB, False)),
            lambda outcome: self._ask(outcome, service),
        )

    def _ask(self, found: CallOutcome, service: str) -> None:
        if found.error:
            self._answer.show_outcome(tr("Exit"), found)
            return
        details = self.model.details
        runs = [f"{d.zone} ({d.robot})" for d in details.zones if d.phase == "running"] if details else []
        if found.result:
            question, yes = tr("End the whole RSBB?"), tr("End the RSBB")
            text = tr("This ends the core and everything started with it, for all referees.")
        else:
            question, yes = tr("End this client?"), tr("End this client")
            text = tr("This ends only this referee's client. The core and its runs continue.")
        in_progress = [tr("Runs in progress: {runs}", runs=", ".join(runs))] if runs else []
        ask(self, question, "\n\n".join([text, *in_progress]), yes, lambda: self._exit(service))

    def _exit(self, service: str) -> None:
        self._answer.say(tr("Exit …"))
        self.client.calls.service(
            self, service, Empty, (), lambda outcome: self._answer.show_outcome(tr("Exit"), outcome)
        )
