"""The history of a run's score sheet: who changed what and when. An entry can be withdrawn."""

from typing import Collection, List, Optional

from roah_rsbb.model.results import HistoryEntry, RunLine, RunSheet
from roah_rsbb.rqt.model.client import RefereeClient
from roah_rsbb.rqt.model.fetched import run_sheets
from roah_rsbb.rqt.model.model import Model
from roah_rsbb.rqt.panels.panel import AnswerLine
from roah_rsbb.rqt.qt import QDialog, QHBoxLayout, QPoint, Qt, QVBoxLayout, QWidget
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.widgets.rows import Rows, TableRow
from roah_rsbb.rqt.widgets.score_dialogs import NoteDialog
from roah_rsbb.wording import sheets
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.times import Moments

WIDE_EMS, HIGH_EMS = 56, 24
SILENT = tr_later("The core is silent: nothing can be changed now")


def why_fixed(summary: Optional[RunLine], model: Model) -> str:
    """Return why a run's sheet cannot be changed now; empty: it can."""
    if summary is not None and summary.signed_utc_s:
        return tr("Final: signed off by {name}", name=summary.signed_by)
    return model.why_read_only(tr(SILENT))


class History(QWidget):
    """The entries of one sheet, newest first."""

    def __init__(self, client: RefereeClient, owner: object, answer: AnswerLine) -> None:
        """`owner`: owns the calls; `answer`: shows their outcome."""
        super().__init__()
        self._client = client
        self._owner = owner
        self._answer = answer
        self._summary: Optional[RunLine] = None
        self._sheet: Optional[RunSheet] = None
        self._why_off = ""
        self.rows = Rows(("#", tr("Time"), tr("Who"), tr("Item"), tr("Change"), tr("Notes")), stretched=(3, 5))
        self.withdraw = basic.button(tr("Withdraw entry …"), self._ask, 1.1, bold=True)
        self.rows.itemSelectionChanged.connect(self._show_button)
        column = basic.flat(QVBoxLayout(self))
        column.addWidget(self.rows, 1)
        column.addWidget(self.withdraw, 0, Qt.AlignLeft)

    def show_sheet(self, summary: Optional[RunLine], sheet: Optional[RunSheet], why_off: str) -> None:
        """Show the history of a run. `why_off`: why nothing can be withdrawn; empty: it can."""
        self._summary, self._sheet, self._why_off = summary, sheet, why_off
        unsaved = () if summary is None else self._client.model.unsaved_of(summary.identity).entries
        self.rows.show_rows([] if sheet is None else _history_rows(sheet, unsaved, self._client.moments))
        self._show_button()

    def _chosen(self) -> Optional[HistoryEntry]:
        history = () if self._sheet is None else self._sheet.history
        return next((entry for entry in history if entry.number == self.rows.chosen), None)

    def _show_button(self) -> None:
        entry, why_off = self._chosen(), self._why_off
        if not why_off and entry is None:
            why_off = tr("Choose an entry above")
        elif not why_off and entry.withdrawn_utc_s:
            why_off = tr("Already withdrawn")
        basic.allow(self.withdraw, why_off)

    def _ask(self) -> None:
        summary, entry = self._summary, self._chosen()
        if summary is None or entry is None:
            return
        what = tr("Withdraw entry {number}", number=entry.number)
        text = f"{entry.item}\n{sheets.person(entry.who)}, {self._client.moments.time_of_day(entry.utc_s)}"

        def send(note: str) -> None:
            self._client.calls.act(self._owner, "withdraw", summary.zone, summary.identity,
                                   {"entry": entry.number, "note": note}, self._answer.begin(what))

        basic.show_dialog(NoteDialog(self, f"{what}?", text, tr("Why"), tr("Withdraw"), send))


def _history_rows(sheet: RunSheet, unsaved: Collection[int], moments: Moments) -> List[TableRow]:
    rows = []
    for entry in reversed(sheet.history):
        words = sheets.entry_texts(entry, moments.time_of_day)
        notes = "; ".join(mark + text for mark, text in (
            ("⚠ ", tr(sheets.NOT_SAVED) if entry.number in unsaved else ""), ("✎ ", words.correction), ("", words.note),
            ("✘ ", words.withdrawn)) if text)
        rows.append(TableRow(
            entry.number, (words.number, words.when, words.who, words.item, words.change, notes),
            bold=entry.correction, off=bool(entry.withdrawn_utc_s),
            tips=("", moments.tip(entry.utc_s), sheets.node_of(entry.who), "", "", sheets.node_of(entry.withdrawn_by)),
        ))
    return rows


class HistoryDialog(QDialog):
    """The history of one run, in a window of its own."""

    def __init__(self, parent: QWidget, client: RefereeClient, zone: str, identity: str) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WA_DeleteOnClose)
        self.setWindowTitle(tr("History of the score sheet – {zone}", zone=zone))
        self.resize(round(WIDE_EMS * basic.em()), round(HIGH_EMS * basic.em()))
        self._client = client
        self._identity = identity
        self._sheets = run_sheets(self, client.calls, self._on_update)
        answer = AnswerLine()
        self.history = History(client, self, answer)
        column = QVBoxLayout(self)
        column.addWidget(self.history, 1)
        last = QHBoxLayout()
        last.addWidget(answer, 1)
        self.close_button = basic.button(tr("Close"), self.close)
        self.close_button.setAutoDefault(False)
        last.addWidget(self.close_button)
        column.addLayout(last)
        client.model.updated.connect(self._on_update)
        self.finished.connect(lambda _: self._end())
        self._on_update()

    def place_over(self, panel: QWidget) -> None:
        """Cover nothing but this panel: the time and the commands stay in sight."""
        self.resize(self.size().boundedTo(panel.size()))
        self.move(panel.mapToGlobal(QPoint()))

    def _end(self) -> None:
        self._client.model.updated.disconnect(self._on_update)
        self._client.calls.forget(self)

    def _on_update(self) -> None:
        summary = self._client.model.run_of(self._identity)
        sheet = self._sheets.newest(summary)
        self.history.show_sheet(summary, sheet, why_fixed(summary, self._client.model))
