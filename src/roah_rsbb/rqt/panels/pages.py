"""The way to the page of the whole box in a browser (docs/referee.md, "The box's page")."""

from functools import partial
from urllib.parse import urlencode

from roah_rsbb.document.calls import PAIR, PAIRED
from roah_rsbb.ground.linux import open_in_browser
from roah_rsbb.rqt.model.calls import CallOutcome
from roah_rsbb.rqt.panels.panel import AnswerLine, Panel
from roah_rsbb.rqt.qt import QMenu, Qt, QTimer, QToolButton
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.language import tr, tr_later

ORGANISER = "organiser"
# The parts of the page that windows do not draw, by their names in its address.
PARTS = {"runs": tr_later("Results, history, judges"), "schedule": tr_later("Schedule"),
         "pairings": tr_later("Pair phones and tablets")}
OPEN = tr_later("Open in the browser: results, history and judges, the schedule, pairing")
NO_BROWSER = tr_later("No browser opens here. Open {page} in one, and type the code {code}")
# How often the box is asked whether it serves pages, while it does not.
AGAIN_MS = 2000


class PagesButton(QToolButton):
    """Opens a part of the page in a browser, which a code from the box's door pairs. While no pages are served, it is
    off and says why."""

    def __init__(self, panel: Panel, answer: AnswerLine) -> None:
        super().__init__()
        self._panel = panel
        self._answer = answer
        self.setText(tr("Results …"))
        self.setFocusPolicy(Qt.TabFocus)
        self.setPopupMode(QToolButton.InstantPopup)
        basic.set_style(basic.enlarged(self, 1.0, bold=True), "QToolButton::menu-indicator { image: none; }")
        menu = QMenu(self)
        for part, text in PARTS.items():
            menu.addAction(tr(text)).triggered.connect(lambda _checked=False, part=part: self._ask_code(part))
        self.setMenu(menu)
        self._again = QTimer(self, singleShot=True, timeout=self._look)
        self._allow(tr("Waiting for the core"))
        self._look()

    def end(self) -> None:
        """Ask no more."""
        self._again.stop()

    def _look(self) -> None:
        self._panel.client.calls.call(self._panel, PAIRED, lambda outcome: self._allow(outcome.error))

    def _allow(self, why_off: str) -> None:
        self.setEnabled(not why_off)
        self.setToolTip(basic.tip(why_off or tr(OPEN)))
        if why_off:
            self._again.start(AGAIN_MS)

    def _ask_code(self, part: str) -> None:
        self._answer.say(f"{tr(PARTS[part])} …")
        self._panel.client.calls.call(self._panel, PAIR, partial(self._open, part), role=ORGANISER, zone="")

    def _open(self, part: str, outcome: CallOutcome) -> None:
        """Open the page that pairs the browser, unless it is paired, and then leads to the part."""
        if outcome.error:
            self._answer.show_outcome(tr(PARTS[part]), outcome)
            self._allow(outcome.error)
            return
        page, _, link = outcome.result["url"].partition("#")
        query = {"part": part, "zone": self._panel.model.zone_name, "person": self._panel.client.referee.name}
        shown = tr(NO_BROWSER, page=page, code=outcome.result["code"])

        def opened(found: CallOutcome) -> None:
            if found.is_answered and not found.result:  # it takes long to start
                self._answer.warn(shown)
            else:
                self._answer.clear_answer()

        opens = partial(open_in_browser, f"{page}?{urlencode(query)}#{link}")
        self._panel.client.calls.run(self._panel, "browser", opens, opened)
