"""Benchmark Control: the zone's event, the state of its run, and the commands (docs/referee.md, "Benchmark Control").

Key: F5 twice starts, whichever panel of the process has the focus. STOP is in the strip below all panels. The button
"Results …" leads to the page of the whole box in a browser (docs/referee.md, "The box's page").
"""

import time
from functools import partial
from typing import Any, Callable, Dict, FrozenSet, Hashable, Optional, Tuple
from urllib.parse import urlencode

from roah_rsbb.document.calls import PAIR, PAIRED
from roah_rsbb.ground.linux import open_in_browser
from roah_rsbb.model.actions import ACTIONS, Action
from roah_rsbb.model.fields import Team, entered
from roah_rsbb.model.reason import MAX_NOTE
from roah_rsbb.model.records import RAN_TO_THE_END
from roah_rsbb.model.results import RunLine
from roah_rsbb.model.zone import CONNECTED, ENDED, IDLE, ZoneSeen
from roah_rsbb.rqt import basic, keys
from roah_rsbb.rqt.calls import CallOutcome
from roah_rsbb.rqt.model import NOT_HEARD, Sheets
from roah_rsbb.rqt.panels.actions import ActionForm, MoreMenu, RuleButtons, ask, keep_true, what_text, why_off
from roah_rsbb.rqt.panels.panel import SILENT, AnswerLine, Panel
from roah_rsbb.rqt.panels.run_times import TimesWidget, phase_look
from roah_rsbb.rqt.qt import (
    QComboBox,
    QGridLayout,
    QHBoxLayout,
    QKeySequence,
    QLabel,
    QLineEdit,
    QShortcut,
    QSizePolicy,
    Qt,
    QTimer,
    QToolButton,
)
from roah_rsbb.wording import sheets, stop
from roah_rsbb.wording.language import tr, tr_later, tr_said

ORGANISER = "organiser"
# The parts of the page that windows do not draw, by their names in its address.
PARTS = {"runs": tr_later("Results, history, judges"), "schedule": tr_later("Schedule"),
         "pairings": tr_later("Pair phones and tablets")}
OPEN = tr_later("Open in the browser: results, history and judges, the schedule, pairing")
NO_BROWSER = tr_later("No browser opens here. Open {page} in one, and type the code {code}")
# How often the box is asked whether it serves pages, while it does not.
AGAIN_MS = 2000


class PagesButton(basic.MenuButton):
    """Opens a part of the page in a browser, which a code from the box's door pairs. While no pages are served, it is
    off and says why."""

    def __init__(self, panel: Panel, answer: AnswerLine) -> None:
        super().__init__(tr("Results …"))
        self._panel = panel
        self._answer = answer
        for part, text in PARTS.items():
            self.entries.addAction(tr(text)).triggered.connect(lambda _checked=False, part=part: self._ask_code(part))
        self._again = QTimer(self, singleShot=True, timeout=self._look)
        self._allow(tr(NOT_HEARD))
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


REASON = ACTIONS["stop"].fields[0].label
ASK_REASON = tr_later("Why was the run stopped? Press Enter to save")
NO_CHANGE = tr_later("The box is silent: nothing can be changed now")
REASON_TIP = tr_later(
    "After a stop, type the reason here and press Enter. You can change it until the run is signed off.")


class StopReasonLine(QLineEdit):
    """The field for the reason of the last end in the zone. It shows what is saved, until another run is connected."""

    def __init__(self, panel: Panel, answer: AnswerLine) -> None:
        super().__init__(panel)
        self._panel = panel
        self._answer = answer
        self._sheets = Sheets(panel, panel.client.calls, self._show)
        self._summary: Optional[RunLine] = None
        self._without: FrozenSet[int] = frozenset()  # revisions of the run from before the text was sent
        self.setMaxLength(MAX_NOTE)
        self.editingFinished.connect(self._send)

    def show_run(self) -> None:
        """Follow the zone."""
        model = self._panel.model
        runs = model.runs_of(model.zone_name)
        summary = runs[0] if runs and runs[0].end_reason else None
        if self._identity(summary) != self._identity(self._summary):
            self._send()  # what was typed belongs to the run before
            self.clear()
            self.setModified(False)
        self._summary = summary
        self._show()

    def _show(self) -> None:
        summary = self._summary
        why_fixed = ""
        if summary is not None:
            why_fixed = (tr("Final: signed off by {name}", name=summary.signed_by) if summary.signed_utc_s else
                         self._panel.model.why_read_only(tr(NO_CHANGE)))
        self.setEnabled(summary is not None and not why_fixed)
        self.setToolTip(basic.tip(why_fixed or tr(REASON_TIP)))
        self.setPlaceholderText("" if summary is None else tr(ASK_REASON))
        sheet = self._sheets.newest(summary)
        if sheet is None or not sheet.ends or self.isModified() or sheet.run.revision in self._without:
            return
        if self.text() != sheet.ends[-1].reason:
            self.setText(sheet.ends[-1].reason)

    @staticmethod
    def _identity(summary: Optional[RunLine]) -> str:
        return "" if summary is None else summary.identity

    def _send(self) -> None:
        """Save what was typed."""
        reason, summary, client = self.text().strip(), self._summary, self._panel.client
        if summary is None or not self.isModified():
            return
        self.setModified(False)
        known = self._sheets.newest(summary)
        self._without = frozenset([summary.revision] if known is None else [summary.revision, known.run.revision])

        def done(outcome: CallOutcome) -> None:
            self._answer.show_outcome(tr(REASON), outcome)
            if outcome.error and self._identity(self._summary) == summary.identity and self.text().strip() == reason:
                self.setModified(True)
                self._without = frozenset()

        client.calls.act(self._panel, "stop_reason", summary.zone, summary.identity, {"reason": reason}, done)


class TwiceKey:
    """A key that gives a button's command when it is pressed twice, wherever the focus is."""

    def __init__(
        self, panel: Panel, key: str, button: basic.CommandButton, answer: AnswerLine,
        what: Callable[[], Tuple[Hashable, str]], act: Callable[[], None],
    ) -> None:
        """`what()` returns the key's current command, on which both presses must agree, and its name."""
        self._key = key
        self._button = button
        self._answer = answer
        self._what = what
        self._act = act
        self._presses = panel.client.presses
        self._asked = False
        shortcut = QShortcut(QKeySequence(key), panel)
        shortcut.setContext(Qt.ApplicationShortcut)
        shortcut.setAutoRepeat(False)
        shortcut.activated.connect(self._press)
        # If a process has two of these panels, either may take the key: they share the count of presses.
        shortcut.activatedAmbiguously.connect(self._press)

    def forget(self) -> None:
        """Clear the prompt when the time for the second press is over. Call it regularly."""
        if self._asked and self._presses.armed(time.monotonic()) is None:
            self._asked = False
            self._answer.clear_answer()

    def _press(self) -> None:
        now, (what, label) = time.monotonic(), self._what()
        if not self._button.is_on():
            self._answer.warn(f"{label}: {self._button.why_off or tr('just pressed')}")
        elif self._presses.press(now, what):
            self._act()
        elif self._presses.armed(now) == what:
            self._answer.warn(tr("{command}?  Press {key} again within {time:.0f} s",
                                 command=label, key=self._key, time=keys.WITHIN_S))
            self._asked = True


# The actions that have a place of their own here.
COMMANDS = {name: ACTIONS[name] for name in ("previous", "next", "connect", "start", "disconnect")}
SMALL = ("previous", "next")
START_KEYS = tr_later("keys: F5 twice")
# Reasons for an end that START would take back, although no referee stopped the run.
_BY_ITSELF = frozenset(reason.name.lower() for reason in RAN_TO_THE_END)
NO_ZONE = tr_later("This zone is not in the schedule. Choose a zone above.")

# The usual next command of each phase is highlighted while it is possible, and nothing must be done before.
NEXT_STEP = {
    (IDLE, "connect"): basic.ON,
    (CONNECTED, "start"): basic.ON,
    (ENDED, "disconnect"): basic.ON,
}


class _ZoneBox(basic.NoWheel, QComboBox):
    pass


class BenchmarkControlPanel(Panel):
    """Zone selector, event, countdown, state and the commands of a run but STOP."""

    TITLE = tr_later("Benchmark Control")
    WHERE_FACTOR = basic.LEAD
    WORKS_BEHIND = True
    PARTS = ("zone", "results")

    def __init__(self, client) -> None:
        super().__init__(client)
        self.zones = _ZoneBox()
        self._shown_zone = ""
        self._highlight = QTimer(self, singleShot=True, timeout=lambda: basic.set_style(self.zones, ""))
        self.event_labels: Dict[str, QLabel] = {}
        self.phase = basic.Badge(basic.TITLE)
        self.times = TimesWidget()
        self.state = basic.Notices()
        self.answer = AnswerLine()
        self.reason = StopReasonLine(self, self.answer)
        self.buttons = {name: self._button(c) for name, c in COMMANDS.items()}
        self.rules = RuleButtons(self._ask)
        self.more = MoreMenu(self._connect_robot, self._ask)
        self._lay_out()
        self.pages = PagesButton(self, self.answer)
        self.heading.addWidget(self.pages)
        keys = QToolButton()
        keys.setText("?")
        keys.setToolTip(tr("All keys (key: ?)"))
        keys.setFocusPolicy(Qt.NoFocus)  # the key does the same
        keys.clicked.connect(client.keys.open_page)
        self.heading.addWidget(keys)
        self.zones.activated.connect(lambda index: self.model.choose_zone(self.zones.itemText(index)))
        self._start_key = self._key("F5", "start")

    def shutdown(self) -> None:
        self.pages.end()
        super().shutdown()

    # -- layout -------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        basic.enlarged(self.zones, basic.TITLE, bold=True)
        self.zones.setFocusPolicy(Qt.TabFocus)
        self.body.addWidget(self.zones)
        self.body.addLayout(self._event_grid())
        self.body.addWidget(self.phase)
        self.body.addWidget(self.times, 3)
        self.state.setMinimumHeight(round(3.5 * basic.em()))
        self.body.addWidget(self.state, 2)
        commands = QGridLayout()
        connect = QHBoxLayout()
        connect.addWidget(self.buttons["connect"], 1)
        connect.addWidget(self.more)
        commands.addLayout(connect, 0, 0)
        commands.addWidget(self.buttons["disconnect"], 1, 0)
        start = basic.enlarged(self.buttons["start"], basic.FIGURE, bold=True)
        start.setSizePolicy(QSizePolicy.Preferred, QSizePolicy.Expanding)
        commands.addWidget(start, 0, 1, 2, 1)
        commands.setColumnStretch(0, 1)
        commands.setColumnStretch(1, 1)
        self.body.addWidget(self.answer)
        reason = QHBoxLayout()
        reason.addWidget(QLabel(tr(REASON)))
        reason.addWidget(self.reason, 1)
        self.body.addLayout(reason)
        self.body.addWidget(self.rules)
        self.foot.addLayout(commands)

    def _event_grid(self) -> QGridLayout:
        grid = QGridLayout()
        for row, (name, factor) in enumerate((("name", basic.LEAD), ("team", basic.FIGURE), ("facts", basic.TEXT))):
            label = basic.enlarged(QLabel(wordWrap=True, textFormat=Qt.PlainText), factor, bold=name != "facts")
            label.setMinimumWidth(1)
            grid.addWidget(label, row, 0, 1, 2 if name == "facts" else 1)
            self.event_labels[name] = label
        grid.addWidget(self.buttons["previous"], 0, 1)
        grid.addWidget(self.buttons["next"], 1, 1)
        grid.setColumnStretch(0, 1)
        return grid

    def _button(self, action: Action) -> basic.CommandButton:
        explanation = tr(action.explanation) + (f" ({tr(START_KEYS)})" if action.name == "start" else "")
        return basic.CommandButton(tr(action.label), explanation, basic.TEXT if action.name in SMALL else basic.LEAD,
                                   partial(self._press, action.name))

    def _key(self, key: str, service: str) -> TwiceKey:
        def what():
            zone = self.model.zone_name
            return (service, zone), f"{tr(COMMANDS[service].label)} {zone}"

        return TwiceKey(self, key, self.buttons[service], self.answer, what, lambda: self._press(service))

    # -- showing ------------------------------------------------------------------------------------

    def show_model(self) -> None:
        self._show_zone_change()
        zone = self.model.zone
        if zone is None:
            self._show_no_zone()
        else:
            self._show_event(zone)
            self._show_state(zone)
        for name in COMMANDS:
            self._show_button(name, zone)
        self.rules.show_zone(zone, self._silent(zone))
        self.reason.show_run()

    def show_times(self) -> None:
        self._show_zones()
        zone, clock = self.model.zone, self.model.clock_of(self.model.zone_name)
        self.times.show_clock(clock, self.model.is_old)
        if zone is not None:
            phase = phase_look(zone, clock)
            text = f"{phase.text}  ·  {zone.robot_name}" if zone.robot_name else phase.text
            self.phase.show_text(text, basic.IDLE if self.model.is_old else phase.tone)
        self.more.show_zone(zone, self._silent(zone))  # its menu may just have closed
        self._start_key.forget()

    def _silent(self, zone: Optional[ZoneSeen]) -> str:
        return tr(NO_ZONE) if zone is None else self.model.why_old(tr(SILENT))

    def where(self) -> str:
        return self.client.moments.with_zone(self.model.now().utc) if self.model.document else ""

    def where_tip(self) -> str:
        return self.client.moments.tip(self.model.now().utc) if self.model.document else ""

    def _show_zones(self) -> None:
        names = self.model.zone_names
        if [self.zones.itemText(i) for i in range(self.zones.count())] != names:
            self.zones.clear()
            self.zones.addItems(names)
        if not self.zones.view().isVisible():
            self.zones.setCurrentIndex(self.zones.findText(self.model.zone_name))

    def _show_zone_change(self) -> None:
        """Highlight another zone for a moment. Until then no command works: no click may hit the wrong zone."""
        before, self._shown_zone = self._shown_zone, self.model.zone_name
        if before in ("", self._shown_zone):
            return
        for button in (*self.buttons.values(), *self.rules.buttons.values()):
            button.hold()
        basic.set_style(self.zones, f"QComboBox {{ {basic.OLD.css} }}")
        self._highlight.start(basic.HOLD_MS)

    def _show_no_zone(self) -> None:
        for label in self.event_labels.values():
            label.setText("")
        heard = self.model.document is not None
        self.phase.show_text(tr("NO SUCH ZONE") if heard else tr("NO BOX"), basic.IDLE)
        text = f"{tr(NO_ZONE)} ({self.model.zone_name})" if heard else tr(NOT_HEARD)
        self.state.show_lines([(line, False) for line in (text, self.model.why) if line])

    def _show_event(self, zone: ZoneSeen) -> None:
        event, moments = zone.event, self.client.moments
        self.event_labels["name"].setText(f"{event.code}  {event.desc}")
        self.event_labels["team"].setText(event.team)
        when = moments.scheduled(event.scheduled, self.model.now().utc)
        self.event_labels["facts"].setText(
            f"{event.name} · {sheets.turn(event.round, event.run)} · {tr('scheduled {time}', time=when)}"
        )
        self.event_labels["facts"].setToolTip(tr("Scheduled: {time}", time=moments.tip(event.scheduled)))

    def _show_state(self, zone: ZoneSeen) -> None:
        """Show the zone's warnings, those of the box, which concern every referee, then the zone's other lines."""
        self.state.show_lines([(tr_said(text), True) for text in (*zone.unsaid, *self.model.box.warnings)]
                              + [(tr_said(line), False) for line in zone.state])

    def _show_button(self, name: str, zone: Optional[ZoneSeen]) -> None:
        reasons = why_off(zone, name, self._silent(zone) if self.model.document else tr(NOT_HEARD))
        is_next = zone is not None and not stop.leaving(zone) and not zone.action(name).question
        tone = NEXT_STEP.get((zone.phase, name)) if is_next else None
        self.buttons[name].allow(not reasons, reasons, tone)

    # -- commands -----------------------------------------------------------------------------------

    def _press(self, name: str) -> None:
        """A button was clicked, or its key pressed twice."""
        zone = self.model.zone_name
        question, why = self._leaving(zone)
        if name == "disconnect" and why:
            box = ask(self, question, why, tr(COMMANDS[name].label),
                      partial(self._disconnect, zone, self.model.identity_of(zone)))
            keep_true(box, self.model, partial(self._leaving, zone))
        elif name == "start" and self.model.zone is not None and self.model.zone.end_reason in _BY_ITSELF:
            ask(self, tr("The run is over. Start it again?"), "\n".join(map(tr_said, self.model.zone.state)),
                tr(COMMANDS[name].label), partial(self._send_if_same, ACTIONS[name], self.model.zone))
        else:
            self._confirm(ACTIONS[name], self.model.zone)

    def _leaving(self, zone: str) -> Tuple[str, str]:
        """Return the question before the run in a zone is left, and why it is asked; empty: it is not."""
        found = self.model.zone_of(zone)
        if zone in self.model.running_zones():
            return tr("The run is in progress. Disconnect?"), tr(
                "This ends the run of {robot} in zone {zone}, and it cannot be resumed.",
                robot=found.robot_name, zone=zone)
        why = "" if found is None else stop.leaving(found)
        return tr("The robot has not stopped. Disconnect?") if why else tr("The run is over. Disconnect?"), why

    def _disconnect(self, zone: str, asked: str) -> None:
        """Disconnect the run that the referee was asked about, and no other one. `asked`: its identity."""
        if self.model.identity_of(zone) == asked:
            self._send(ACTIONS["disconnect"], zone, {"running": True})
        else:
            self.answer.warn(tr("Not disconnected: another run is in {zone} now", zone=zone))

    def _ask(self, action: Action) -> None:
        """An action of the row or the menu was chosen: ask what it needs, and what its table says, then do it."""
        zone = self.model.zone
        if zone is None:
            return
        fields = zone.fields(action.name)
        if entered(fields):
            same = partial(self._send_if_same, action, zone)
            basic.show_dialog(ActionForm(self, action, what_text(action, zone.zone), fields, same))
        else:
            self._confirm(action, zone)

    def _confirm(self, action: Action, zone: Optional[ZoneSeen], given: Optional[Dict[str, Any]] = None,
                 what: str = "") -> None:
        """Do an action, after its questions: its own, and that of the zone."""
        asked = "" if zone is None else zone.action(action.name).question
        if zone is None or not (asked or action.question):
            self._send(action, self.model.zone_name, given, what)
            return
        if asked:
            given = {**(given or {}), "again": True}
        text = "\n\n".join(filter(None, [
            stop.leaving(zone) if action.leaves else "", tr_said(asked) if asked else "",
            tr(action.question, team=zone.event.team) if action.question else ""]))
        ask(self, tr(action.label), text, tr(action.label), partial(self._send_if_same, action, zone, given, what))

    def _send_if_same(self, action: Action, asked: ZoneSeen, given: Optional[Dict[str, Any]] = None,
                      what: str = "") -> None:
        """Do an action if the zone is still at the event and the run that the referee was asked about. The core checks
        it again."""
        now = self.model.zone
        if now is not None and _subject(now) == _subject(asked):
            self._send(action, asked.zone, given, what)
        else:
            self.answer.warn(tr("Not done: {zone} is at another event now", zone=asked.zone))

    def _connect_robot(self, robot: str) -> None:
        what = tr("Connect {robot} in {zone}", robot=robot, zone=self.model.zone_name)
        self._confirm(ACTIONS["connect"], self.model.zone, {"robot": robot}, what)

    def _send(
        self, action: Action, zone: str, given: Optional[Dict[str, Any]] = None, what: str = "",
    ) -> None:
        """Do an action in the zone that is shown. `given`: the values of its fields."""
        what = what or what_text(action, zone)
        button = self.buttons.get(action.name) or self.rules.buttons.get(action.name)
        if button is not None:
            button.hold()
        self.answer.say(f"{what} …")

        def done(outcome: CallOutcome) -> None:
            self.answer.show_outcome(what, outcome)
            if outcome.error and button is not None:
                button.let_go()

        found = self.model.zone_of(zone)
        event = None if found is None else found.event
        team = {"team": event.team} if event is not None and any(isinstance(f, Team) for f in action.fields) else {}
        seen = event.id if event is not None and action.aims else ""
        run = self.model.identity_of(zone)
        self.client.calls.act(self, action.name, zone, run, {**team, **(given or {})}, done, seen)


def _subject(zone: ZoneSeen) -> Tuple[str, str, str, str]:
    """Return what an action in a zone is about."""
    return zone.zone, zone.event.team, zone.event.id, zone.identity
