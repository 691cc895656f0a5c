"""Judges: how far the judges of a run are, their values side by side, and the result from provisional to final."""

from functools import partial
from typing import Any, Callable, List, Optional, Tuple

from roah_rsbb.model.actions import ENTRIES
from roah_rsbb.model.judging import JudgedRun, Judging, ObjectionLine
from roah_rsbb.model.results import RunLine
from roah_rsbb.model.scoring import Entered
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.rqt.model.fetched import Fetched
from roah_rsbb.rqt.panels.history import why_fixed
from roah_rsbb.rqt.panels.panel import RefereePanel
from roah_rsbb.rqt.panels.results import SIGN_OFF, ask_sign_off
from roah_rsbb.rqt.qt import QComboBox, QHBoxLayout, QPushButton, QSignalBlocker, Qt, QTabWidget, QVBoxLayout, QWidget
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.widgets.judge_dialogs import ChoiceDialog, ObjectionDialog, PublishDialog, ReasonDialog, SettleDialog
from roah_rsbb.rqt.widgets.rows import Rows, TableRow
from roah_rsbb.wording import judging, sheets
from roah_rsbb.wording.judging import Judged
from roah_rsbb.wording.language import tr, tr_later

NO_RUNS = tr_later("No run of this zone has judges, or is to be signed off.")
ANSWER = tr_later("Answer the objection")
NO_OBJECTIONS = tr_later("No objections")
ENTER_NAME = tr_later("Enter your name at the bottom left")
# Height of the lines about the judges.
LINES = 3


class JudgesPanel(RefereePanel):
    """The head referee's panel: a run, how far its judges are, and two tabs with items and objections."""

    TITLE = tr_later("Judges")
    TAB = tr_later("Jury")
    PARTS = ("judging", "results")

    def __init__(self, client) -> None:
        super().__init__(client)
        self._answers = Fetched(self, client.calls, "judges", JudgedRun, self.redraw)
        self._zone = ""
        self._run: Optional[Judging] = None  # that is shown
        self._judges: Optional[List[str]] = None  # of the columns
        self._judged: Tuple[Judged, ...] = ()
        self._objections: Tuple[ObjectionLine, ...] = ()
        self.which = QComboBox()
        self.which.setAccessibleName(tr("Run"))
        self.which.currentIndexChanged.connect(self.redraw)
        self.progress = basic.Notices(1.1)
        self.progress.setFixedHeight(round(LINES * 1.1 * basic.em() * 1.35))
        self.items: Rows
        self.objections = Rows(
            ("#", tr("Time"), tr("Who objects"), tr("Objection"), tr("Answer")), stretched=(3, 4))
        self.objections.itemSelectionChanged.connect(self.redraw)
        self.objections.itemDoubleClicked.connect(lambda *_: self.reply.click())
        self.settle = self._button(judging.SETTLE, self._ask_settle)
        self.hand_back = self._button(judging.HAND_BACK, partial(self._ask_judge, "hand_back"))
        self.withdraw = self._button(judging.WITHDRAW, partial(self._ask_judge, "withdraw_sheet"))
        self.waive = self._button(judging.WAIVE, self._ask_waive)
        self.object = self._button(judging.OBJECT, self._ask_objection)
        self.reply = self._button(ANSWER, self._ask_answer)
        self.publish = self._button(judging.PUBLISH, self._ask_publish)
        self.sign = basic.button(tr(SIGN_OFF), self._ask_sign_off, 1.1, bold=True)
        self._lay_out()

    def _button(self, text: str, pressed: Callable[[], None]) -> QPushButton:
        return basic.button(f"{tr(text)} …", pressed, bold=True)

    def _lay_out(self) -> None:
        self._items_page = QWidget()
        self._items_column = basic.flat(QVBoxLayout(self._items_page))
        self._items_column.addLayout(_line(self.settle, self.waive))
        self._items_column.addLayout(_line(self.hand_back, self.withdraw))
        self._show_columns([])
        objections = QWidget()
        column = basic.flat(QVBoxLayout(objections))
        column.addWidget(self.objections, 1)
        column.addLayout(_line(self.object, self.reply))
        self.tabs = QTabWidget(focusPolicy=Qt.TabFocus)
        self.tabs.addTab(self._items_page, tr("Side by side"))
        self.tabs.addTab(objections, tr("Objections"))
        self.body.addWidget(self.which)
        self.body.addWidget(self.progress)
        self.body.addWidget(self.tabs, 1)
        self.add_last_line(self.publish, self.sign)

    def _show_columns(self, judges: List[str]) -> None:
        """Make another table if it has other judges."""
        if judges == self._judges:
            return
        if self._judges is not None:
            self._items_column.removeWidget(self.items)
            self.items.deleteLater()
        self._judges = judges
        columns = (tr("Group"), tr("Item"), *judges, tr("Value"), tr("Reason"))
        self.items = Rows(columns, stretched=(1, len(columns) - 1))
        self.items.itemSelectionChanged.connect(self.redraw)
        self.items.itemDoubleClicked.connect(lambda *_: self.settle.click())
        self._items_column.insertWidget(0, self.items, 1)

    # -- showing ------------------------------------------------------------------------------------

    def where(self) -> str:
        return self.model.zone_name

    def show_times(self) -> None:
        self.progress.show_lines(self._progress(self._run))

    def show_model(self) -> None:
        zone = self.model.zone_name
        if zone != self._zone:
            self._zone = zone
            self._answer.clear_answer()
        judgings = self.model.judgings_of(zone)
        self._offer(judgings)
        one = self._run = self._chosen(judgings)
        answer = self._answers.newest(one)
        self._judged = () if answer is None else judging.judged_of(answer)
        self._objections = () if answer is None else judging.objections_of(answer)
        self._show_items(one)
        self.objections.show_rows([_objection_row(each, self.client.moments.short) for each in self._objections]
                                  or [TableRow(None, ("", "", "", tr(NO_OBJECTIONS), ""))])
        waiting = sum(each.answered_utc_s is None for each in self._objections)
        self.tabs.setTabText(1, f"{tr('Objections')} ({len(self._objections)})" + (" ⚠" if waiting else ""))
        self._show_buttons(one)

    def _offer(self, judgings: List[Judging]) -> None:
        """List the runs, and keep the chosen one."""
        names = {run.identity: sheets.run_name(run.code, run.team, run.round, run.run)
                 for run in self.model.runs_of(self._zone)}
        offered = [(names.get(one.identity, one.identity), one.identity) for one in judgings] or [(tr(NO_RUNS), "")]
        if offered == [(self.which.itemText(i), self.which.itemData(i)) for i in range(self.which.count())]:
            return
        chosen = self.which.currentData()
        with QSignalBlocker(self.which):
            self.which.clear()
            for name, identity in offered:
                self.which.addItem(name, identity)
            self.which.setCurrentIndex(max(0, self.which.findData(chosen)))

    def _chosen(self, judgings: List[Judging]) -> Optional[Judging]:
        return next((one for one in judgings if one.identity == self.which.currentData()), None)

    def _one(self) -> Optional[Judging]:
        """The chosen run."""
        return self._chosen(self.model.judgings_of(self._zone))

    def _summary(self, one: Judging) -> Optional[RunLine]:
        return self.model.run_of(one.identity)

    def _progress(self, one: Optional[Judging]) -> List[Tuple[str, bool]]:
        if one is None:
            return []
        moments, utc_s = self.client.moments, self.model.box_time()
        judges = " · ".join(map(judging.judge_line, one.judges))
        missing, differences = judging.missing_text(one), judging.differences_text(one)
        published = judging.publication_text(one, utc_s, lambda until: moments.scheduled(until, utc_s))
        lines = [(judges, False), (missing, not one.waiver), (differences, True),
                 (published, bool(one.open_objections))]
        return [line for line in lines if line[0]]

    def _show_items(self, one: Optional[Judging]) -> None:
        self._show_columns(judging.judges_of(self._judged))
        rows, group = [], None
        for item in self._judged:
            given = {each.judge: each.shown for each in item.given}
            rows.append(TableRow((item.group, item.item), (
                "" if item.group == group else item.group, item.item,
                *(given.get(judge, "") for judge in self._judges), judging.outcome_text(item),
                judging.settled_text(item),
            ), bold=item.outcome == judging.DIFFER))
            group = item.group
        if not rows and one is not None:
            rows = [TableRow(None, ("", tr(judging.WAITING if one.count else judging.NO_JUDGES), "", ""))]
        self.items.show_rows(rows)
        if self._item() is None:
            with QSignalBlocker(self.items):
                self.items.choose(next(
                    ((item.group, item.item) for item in self._judged if item.outcome == judging.DIFFER), None))

    def _item(self) -> Optional[Judged]:
        """The chosen item."""
        return next((item for item in self._judged if (item.group, item.item) == self.items.chosen), None)

    def _objection(self) -> Optional[ObjectionLine]:
        """The chosen objection; the first one that is not answered, if none is chosen."""
        open_ones = [one for one in self._objections if one.answered_utc_s is None]
        chosen = [one for one in self._objections if one.number == self.objections.chosen]
        return next(iter(chosen + open_ones), None)

    # -- what may be done ---------------------------------------------------------------------------

    def _show_buttons(self, one: Optional[Judging]) -> None:
        summary = None if one is None else self._summary(one)
        general = why_fixed(summary, self.model) or (tr(NO_RUNS) if one is None else "")
        named = general or ("" if self.client.referee.name else tr(ENTER_NAME))
        off = judging.off(one or Judging("", ""), summary is not None and bool(summary.closed_utc_s))
        basic.allow(self.settle, named or off["settle"] or ("" if self._item() else tr("Choose an item above")))
        basic.allow(self.hand_back, named or off["hand_back"])
        basic.allow(self.withdraw, named or off["withdraw_sheet"])
        basic.allow(self.waive, named or off["waive"])
        basic.allow(self.publish, general or off["publish"])
        basic.allow(self.object, general or off["object"])
        basic.allow(self.reply, general or off["answer"] or ("" if self._objection() else tr(NO_OBJECTIONS)))
        basic.allow(self.sign, general or off["sign_off"] or named)

    # -- doing it -----------------------------------------------------------------------------------

    def _ask_settle(self) -> None:
        one, item = self._one(), self._item()
        answer = self._answers.newest(one)
        if one is None or item is None or answer is None:
            return
        of_sheet = answer.items[item.number - 1]
        basic.show_dialog(SettleDialog(self, of_sheet, item, partial(self._settle, one, of_sheet)))

    def _settle(self, one: Judging, item: SheetItem, given: Entered) -> None:
        self._act(one, item.desc, "settle", group=item.group, desc=item.desc, value=given.value, text=given.text,
                  not_attempted=bool(given.not_attempted), reason=given.note)

    def _ask_judge(self, action: str) -> None:
        """Ask which judge, and why."""
        one = self._one()
        if one is None:
            return
        what = tr(ENTRIES[action].label)
        judges = [judge for judge in one.judges if judge.submitted_utc_s or action != "hand_back"]

        def decide(index: int, reason: str) -> None:
            judge = judges[index].judge
            self._act(one, f"{what}: {judge}", action, judge=judge, reason=reason)

        basic.show_dialog(ChoiceDialog(
            self, what, self.which.currentText(), tr("Judge"), list(map(judging.judge_line, judges)), tr("Reason"),
            what, decide))

    def _ask_waive(self) -> None:
        one, what = self._one(), tr(judging.WAIVE)
        if one is None:
            return

        def decide(reason: str) -> None:
            self._act(one, what, "waive", reason=reason)

        basic.show_dialog(ReasonDialog(self, what, judging.missing_text(one), tr("Reason"), what, decide))

    def _ask_publish(self) -> None:
        one = self._one()
        if one is None:
            return

        def send(seconds: float) -> None:
            self._act(one, tr(judging.PUBLISH), "publish", seconds=int(seconds))

        basic.show_dialog(PublishDialog(self, self.which.currentText(), send))

    def _ask_objection(self) -> None:
        one = self._one()
        if one is None:
            return

        def send(who: str, text: str) -> None:
            self._act(one, tr(judging.OBJECT), "object", by=who, text=text)

        basic.show_dialog(ObjectionDialog(self, self.which.currentText(), send))

    def _ask_answer(self) -> None:
        one, objection = self._one(), self._objection()
        if one is None or objection is None:
            return

        def send(index: int, text: str) -> None:
            self._act(one, tr(ANSWER), "answer", number=objection.number, upheld=index == 0, text=text)

        basic.show_dialog(ChoiceDialog(
            self, tr(ANSWER), f"{objection.by}: {objection.text}", tr("Decision"),
            [tr(judging.UPHOLD), tr(judging.REJECT)], tr("Answer"), tr("Save"), send))

    def _ask_sign_off(self) -> None:
        one = self._one()
        summary = None if one is None else self._summary(one)
        if summary is None:
            return
        name = self.client.referee.name

        ask_sign_off(self, self._answer, summary, name, lambda: self._act(
            one, tr(ENTRIES["sign_off"].label), "sign_off", name))

    def _act(self, one: Judging, what: str, action: str, referee: str = "", **given: Any) -> None:
        """Do an action for a run, and show how far it is. `what`: what the answer is about."""
        self.client.calls.act(self, action, one.zone, one.identity, given,
                              self._answer.begin(what), referee=referee)


def _line(*buttons: QPushButton) -> QHBoxLayout:
    line = QHBoxLayout()
    for button in buttons:
        line.addWidget(button)
    line.addStretch(1)
    return line


def _objection_row(one: ObjectionLine, when: Callable[[float], str]) -> TableRow:
    answer = judging.answer_text(one)
    return TableRow(one.number, (str(one.number), when(one.utc_s), one.by, one.text, answer), bold=not answer,
                    tips=("", "", one.who, "", one.answered_by))
