"""Where the referee types why a run was stopped: after the stop, which waits for nobody's words."""

from typing import Optional, Tuple

from python_qt_binding.QtWidgets import QLineEdit

from roah_rsbb.msg import ZoneDetails
from roah_rsbb.rqt.model.calls import Outcome
from roah_rsbb.rqt.panels.panel import Answer, Panel
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.widgets.score_dialogs import MAX_NOTE
from roah_rsbb.srv import StopReason

ASK = "Why was it stopped? (Enter keeps it)"
NOTHING = "Once a run was stopped, the reason can be typed here"


class StopReasonLine(QLineEdit):
    """A line for the reason of the last stop in the zone; also once the run is left, until another one begins."""

    def __init__(self, panel: Panel, answer: Answer) -> None:
        super().__init__(panel)
        self._panel = panel
        self._answer = answer
        self._run: Tuple[str, str] = ("", "")  # zone, and identity of the run that was stopped
        self.setMaxLength(MAX_NOTE)
        self.setToolTip(basic.tip(NOTHING))
        self.returnPressed.connect(self._send)
        self.show_run(None)

    def show_run(self, details: Optional[ZoneDetails]) -> None:
        """Follow the zone: these are its details now."""
        model = self._panel.model
        run = self._run if self._run[0] == model.zone_name else ("", "")
        if details is not None and details.identity:
            was_stopped = details.phase == "ended"
            run = (details.zone, details.identity) if was_stopped else ("", "")
        if run != self._run:
            self._run = run
            self.clear()
        self.setEnabled(bool(run[1]) and not model.is_old)
        self.setPlaceholderText(ASK if run[1] else "")

    def _send(self) -> None:
        reason, run, client = self.text().strip(), self._run, self._panel.client
        if not reason or not run[1]:
            return

        def done(outcome: Outcome) -> None:
            self._answer.show_outcome("Reason of the stop", outcome)
            if not outcome.error and run == self._run and self.text().strip() == reason:
                self.clear()

        client.calls.service(
            self._panel, "/core/stop_reason", StopReason, (*run, 0, reason, client.referee.name), done
        )
