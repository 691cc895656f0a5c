"""Results: the runs of the zone and their score sheets, with history, corrections and sign-off."""

from typing import Any, Callable, List, Optional

from roah_rsbb.model.actions import ENTRIES
from roah_rsbb.model.results import RunLine, RunSheet
from roah_rsbb.model.scoring import Entered
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.rqt.model.calls import Done
from roah_rsbb.rqt.model.fetched import run_sheets
from roah_rsbb.rqt.panels.history import History, why_fixed
from roah_rsbb.rqt.panels.panel import AnswerLine, Panel, RefereePanel, ask
from roah_rsbb.rqt.qt import QLabel, QPushButton, QSignalBlocker, QSplitter, Qt, QTabWidget, QVBoxLayout, QWidget
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.widgets.rows import Rows, TableRow
from roah_rsbb.rqt.widgets.score_dialogs import NoteDialog, ScoreDialog
from roah_rsbb.wording import sheets, times
from roah_rsbb.wording.counting import with_counting
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.module_scores import by_group
from roah_rsbb.wording.said import tr_said
from roah_rsbb.wording.times import Moments

NO_RUNS = tr_later("This zone has no run yet.")
CHOOSE = tr_later("Choose a run above")
FETCHING = tr_later("Fetching the score sheet …")
SIGN_OFF = tr_later("Sign off …")


class ResultsPanel(RefereePanel):
    """A list of the zone's runs; below it, the chosen run."""

    TITLE = tr_later("Results")
    PARTS = ("results",)

    def __init__(self, client) -> None:
        super().__init__(client)
        self._sheets = run_sheets(self, client.calls, self.redraw)
        self._zone = ""
        self.runs = Rows(
            (tr("Time"), tr("Team"), tr("Run"), tr("End"), tr("Score"), tr("Sheet")), stretched=(4,), wrapped=False)
        self.items = Rows((tr("Group"), tr("Item"), tr("Value"), ""), stretched=(1,))
        self.stops = Rows(("#", tr("Time"), tr("Who"), tr("End"), tr("Reason")), stretched=(3, 4))
        self.what = basic.enlarged(QLabel(wordWrap=True, textFormat=Qt.PlainText), 1.2, bold=True)
        # Two lines are reserved: a run that is listed must not push other panels away, under the mouse.
        self.what.setMinimumHeight(2 * self.what.fontMetrics().lineSpacing())
        self.correct = basic.button(tr("Change …"), self._ask_score, 1.1, bold=True)
        self.give_reason = basic.button(tr("Reason …"), self._ask_reason, 1.1, bold=True)
        self.sign = basic.button(tr(SIGN_OFF), self._ask_sign_off, 1.1, bold=True)
        self.history = History(client, self, self._answer)
        self._lay_out()
        for rows in (self.runs, self.items, self.stops):
            rows.itemSelectionChanged.connect(self.redraw)
        self.items.itemDoubleClicked.connect(lambda *_: self.correct.click())

    def _lay_out(self) -> None:
        self.tabs = QTabWidget(focusPolicy=Qt.TabFocus)
        self.tabs.addTab(_page(self.items, self.correct), tr("Score sheet"))
        self.tabs.addTab(self.history, tr("History"))
        self.tabs.addTab(_page(self.stops, self.give_reason), tr("Ends"))
        below = QWidget()
        column = basic.flat(QVBoxLayout(below))
        column.addWidget(self.what)
        column.addWidget(self.tabs, 1)
        self._split = QSplitter(Qt.Vertical)
        self._split.setChildrenCollapsible(False)
        self._split.addWidget(self.runs)
        self._split.addWidget(below)
        self._split.setStretchFactor(0, 2)
        self._split.setStretchFactor(1, 3)
        self.body.addWidget(self._split, 1)
        self.add_last_line(self.sign)

    # -- showing ------------------------------------------------------------------------------------

    def show_model(self) -> None:
        zone = self.model.zone_name
        runs = self.model.runs_of(zone)
        if zone != self._zone:
            self._zone = zone
            self._answer.clear_answer()
        rows = [_run_row(run, self.client.moments) for run in runs]
        self.runs.show_rows(rows or [TableRow(None, ("", tr(NO_RUNS), "", "", "", ""))])
        if self.runs.chosen is None and runs:
            with QSignalBlocker(self.runs):
                self.runs.choose(runs[0].identity)
        summary = self._summary()
        sheet = self._sheets.newest(summary)
        self._show_sheet(summary, sheet)
        self._show_buttons(summary, sheet)

    def where(self) -> str:
        return self.model.zone_name

    def _summary(self) -> Optional[RunLine]:
        """The chosen run."""
        run = self.model.run_of(str(self.runs.chosen or ""))
        return run if run is not None and run.zone == self._zone else None

    def _show_sheet(self, summary: Optional[RunLine], sheet: Optional[RunSheet]) -> None:
        moments = self.client.moments
        self.what.setText(self._what(summary, sheet))
        self.items.show_rows([] if sheet is None else _item_rows(sheet))
        self.history.show_sheet(summary, sheet, self._why_off(summary, sheet))
        self.stops.show_rows([] if sheet is None else [
            TableRow(end.number, (
                     str(end.number), moments.time_of_day(end.utc_s), sheets.person(end.who) or "–",
                     tr_said(end.desc), sheets.stop_reason(end.reason, end.reason_by, end.who),
            ), tips=("", moments.tip(end.utc_s), sheets.node_of(end.who), "", sheets.node_of(end.reason_by)))
            for end in sheet.ends
        ])
        for index, (name, rows) in enumerate(((tr("History"), self.history.rows), (tr("Ends"), self.stops)), 1):
            self.tabs.setTabText(index, f"{name} ({len(rows.texts())})")

    def _what(self, summary: Optional[RunLine], sheet: Optional[RunSheet]) -> str:
        if summary is None:
            return tr(CHOOSE) if self.model.runs_of(self._zone) else ""
        if sheet is None:
            return self._sheets.error or tr(FETCHING)
        took = [tr("{time} min", time=times.elapsed(sheet.elapsed_s))] if summary.end_reason else []
        unsaved = [f"⚠ {tr(sheets.NOT_SAVED)}"] if self.model.unsaved_of(summary.identity).sign_off else []
        lines = ([_name(summary), _state(summary), *took, ", ".join(sheet.robots)],
                 [_sheet_state(summary, self.client.moments.with_zone), *unsaved])
        return "\n".join("  ·  ".join(parts) for parts in lines)

    # -- what may be done ---------------------------------------------------------------------------

    def _show_buttons(self, summary: Optional[RunLine], sheet: Optional[RunSheet]) -> None:
        general = self._why_off(summary, sheet)
        item = self._chosen_item(sheet)
        over = summary is not None and summary.closed_utc_s
        basic.allow(self.correct, general or ("" if item is not None else tr("Choose an item above")))
        is_stopped = sheet is not None and bool(sheet.ends)
        basic.allow(self.give_reason, general or ("" if is_stopped else tr("The run has not been stopped yet")))
        basic.allow(self.sign, general or ("" if over else tr("The run is still connected. Disconnect it first."))
                    or ("" if self.client.referee.name else tr("Enter your name at the bottom left")))
        self.correct.setText(tr("Correct …") if over else tr("Change …"))

    def _why_off(self, summary: Optional[RunLine], sheet: Optional[RunSheet]) -> str:
        if summary is None or sheet is None:
            return tr(CHOOSE)
        return why_fixed(summary, self.model)

    def _chosen_item(self, sheet: Optional[RunSheet]) -> Optional[SheetItem]:
        items = () if sheet is None else sheet.items
        return next((item for item in items if (item.group, item.desc) == self.items.chosen), None)

    # -- doing it -----------------------------------------------------------------------------------

    def _ask_score(self) -> None:
        summary = self._summary()
        item = self._chosen_item(self._sheets.newest(summary))
        if summary is None or item is None:
            return
        title = _name(summary)
        basic.show_dialog(ScoreDialog(
            self, title, item, item.text or item.value, item.not_attempted,
            lambda given: self._mark(summary, item, given),
        ))

    def _mark(self, summary: RunLine, item: SheetItem, given: Entered) -> None:
        self.client.calls.mark(self, summary.zone, summary.identity, {
            "group": item.group, "desc": item.desc, **given._asdict()}, self._begin(summary, item.desc))

    def _ask_reason(self) -> None:
        summary = self._summary()
        sheet = self._sheets.newest(summary)
        if summary is None or sheet is None or not sheet.ends:
            return
        end = next((end for end in sheet.ends if end.number == self.stops.chosen), sheet.ends[-1])
        what = f"{self.client.moments.time_of_day(end.utc_s)}: {tr_said(end.desc)}"
        about = tr("Reason of end {number}", number=end.number)
        dialog = NoteDialog(
            self, tr("Reason"), what, tr("Why"), tr("Save"),
            lambda reason: self._send(summary, about, "stop_reason", reason=reason, stop=end.number),
        )
        dialog.note.setText(end.reason)
        basic.show_dialog(dialog)

    def _ask_sign_off(self) -> None:
        summary = self._summary()
        if summary is None:
            return
        name = self.client.referee.name
        ask_sign_off(self, self._answer, summary, name,
                     lambda: self._send(summary, tr(ENTRIES["sign_off"].label), "sign_off", name))

    def _send(self, summary: RunLine, what: str, action: str, referee: str = "", **given: Any) -> None:
        self.client.calls.act(self, action, summary.zone, summary.identity, given, self._begin(summary, what),
                              referee=referee)

    def _begin(self, summary: RunLine, what: str) -> Done:
        """Show that a call begins. Returns what shows its outcome."""
        return self._answer.begin(f"{_name(summary)}: {what}")


def ask_sign_off(
    panel: Panel, answer: AnswerLine, summary: RunLine, name: str, then: Callable[[], None]
) -> None:
    """Ask before a score sheet becomes final; call `then()` if the referee confirms the score of that moment."""
    def confirmed() -> None:
        run = panel.model.run_of(summary.identity) or summary
        if run.score == summary.score:
            then()
        else:
            answer.warn(tr("Not signed off: the score has changed. Check it and sign off again."))

    ask(
        panel, tr("Sign off {run}?", run=_name(summary)),
        tr("{score}\n\nSigned by {name}. The sheet cannot be corrected afterwards.",
           score=summary.score or tr("no score"), name=name),
        tr(ENTRIES["sign_off"].label), confirmed,
    )


def _page(rows: Rows, button: QPushButton) -> QWidget:
    page = QWidget()
    column = basic.flat(QVBoxLayout(page))
    column.addWidget(rows, 1)
    column.addWidget(button, 0, Qt.AlignLeft)
    return page


def _name(run: RunLine) -> str:
    return sheets.run_name(run.code, run.team, run.round, run.run)


def _state(run: RunLine) -> str:
    return with_counting(sheets.run_state(run.started_utc_s, run.closed_utc_s, run.end_reason), run.counts)


def _sheet_state(run: RunLine, when: Optional[sheets.When] = None) -> str:
    """Return the state of the score sheet; with `when`, also who signed it off and at what time."""
    signed = run.signed_utc_s
    state = sheets.sheet_state(run.closed_utc_s, signed)
    if signed:
        state = f"✔ {sheets.signature(signed, run.signed_by, when) if when else state}"
    return f"✎ {tr(sheets.CORRECTED)}, {state}" if run.corrected else state


def _run_row(run: RunLine, moments: Moments) -> TableRow:
    closed = run.closed_utc_s
    return TableRow(run.identity, (
        moments.short(closed) if closed else tr("now"), run.team,
        f"{run.code}, {sheets.turn(run.round, run.run)}", _state(run), run.score, _sheet_state(run),
    ), bold=not run.signed_utc_s, tips=(
        moments.tip(closed) if closed else "", "", "", "", "", sheets.node_of(run.signed_by),
    ))


def _item_rows(sheet: RunSheet) -> List[TableRow]:
    """Return the referee's items, then the module's scores, which cannot be changed here."""
    rows: List[TableRow] = []
    group = None
    for item in sheet.items:
        name, group = ("" if item.group == group else item.group), item.group
        value = sheets.item_value(item.type, item.value, item.not_attempted, item.text)
        rows.append(TableRow((item.group, item.desc), (
            name, f"{item.desc}{_ratings(item)}", value, _notes(item)
        ), bold=bool(sheets.is_marked(item.value, item.text) or item.not_attempted or item.corrected)))
    if sheet.points is not None:
        rows.append(TableRow(None, ("", sheets.points_of(sheet.points), "", ""), bold=True))
    for name, lines in by_group(sheet.module_scores):
        rows += [
            TableRow(None, (tr("Module: {name}", name=name) if index == 0 else "", line.name, line.value, ""))
            for index, line in enumerate(lines)
        ]
    return rows


def _ratings(item: SheetItem) -> str:
    ratings = sheets.ratings_text(zip(item.judges, item.ratings))
    return f" ({ratings})" if ratings else ""


def _notes(item: SheetItem) -> str:
    corrected = [f"✎ {tr(sheets.CORRECTED)}"] if item.corrected else []
    points = [tr("{points} points", points=item.points)] if item.points else []
    return "; ".join((*points, *corrected))
