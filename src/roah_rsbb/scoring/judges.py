"""The judges of one run: each scores on a sheet of their own, and the head referee settles where they differ.

Theory of operation. A judge's sheet begins with the judge's first mark, and is locked when the judge submits it. The
head referee can hand it back, or withdraw it, which frees the place for another judge. When all judges have submitted,
or the head referee does not wait for those who are missing, each item gets a verdict: by the rule of the benchmark, or,
where the judges differ, by a settlement. `RunBook.take_verdicts` enters the verdicts into the sheet of the run, which
remains the only one that counts.

A settlement belongs to the values that it settled. If a judge looks again and submits another value of the item, the
rule decides again. Verdicts therefore do not depend on the order in which the judges submit.
"""

from dataclasses import dataclass, field
from typing import Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused, say
from roah_rsbb.model.records import (
    By,
    ItemRecord,
    JudgeAct,
    JudgeSheet,
    JudgingRecord,
    Settlement,
    Waiver,
)
from roah_rsbb.model.scoring import Key, ScoreKind, ScoringItem, SheetForm
from roah_rsbb.scoring.agreement import ItemValue, agreed, value_of
from roah_rsbb.scoring.sheet import Mark, ScoreSheet, SheetState
from roah_rsbb.wording import sheets

# More than a jury ever needs. The journal has each act in any case.
MAX_SHEETS = 60
MAX_ACTS = 300
# What was done with a judge's sheet.
SUBMITTED, HANDED_BACK, WITHDRAWN, SETTLED = "submitted", "handed back", "withdrawn", "settled"
WAIVED = "waived missing judges"


@dataclass
class JudgesState:
    """The sheets of a run's judges, and what became of them."""

    sheets: List[JudgeSheet] = field(default_factory=list)
    settlements: List[Settlement] = field(default_factory=list)
    waiver: Optional[Waiver] = None
    acts: List[JudgeAct] = field(default_factory=list)

    @classmethod
    def of(cls, record: JudgingRecord) -> "JudgesState":
        """Return the state that a record contains."""
        return cls(list(record.sheets), list(record.settlements), record.waiver, list(record.acts))


DIFFER = say("the judges differ: the head referee settles {items}")
MISSING = say("{missing} of {count} judges have not submitted: wait for them, or decide with a reason not to wait")
LATE = say("{missing} of {count} judges have not submitted ({names}): wait for them, or decide with a reason not to "
           "wait")


class ItemVerdict(NamedTuple):
    """What became of an item that the judges scored."""

    item: ScoringItem
    proposals: Tuple[Tuple[str, str], ...]  # each judge with the value in words, by name
    value: Optional[ItemValue]  # None: the judges differ, and nobody settled it
    ratings: Tuple[Tuple[str, str], ...] = ()  # of a rating: what the run's sheet takes for each of its judges
    who: str = ""  # who decided it
    role: str = ""
    reason: str = ""  # of a settlement

    @property
    def is_settled(self) -> bool:
        """Whether the head referee decided it."""
        return bool(self.reason)


class Judges:
    """The judges of one run."""

    def __init__(self, form: SheetForm, state: JudgesState) -> None:
        self.state = state
        self.rule = form.judges
        self._form = form
        self._sheets: Dict[str, ScoreSheet] = {}  # of judges who did not submit yet, by name

    # -- judges -------------------------------------------------------------------------------------

    def mark(self, now: Now, judge: str, mark: Mark) -> ItemRecord:
        """Mark an item on a judge's own sheet, unless the mark was applied. Returns the item after it. Raises
        `Refused`."""
        mine = self._own_or_new(now, judge)
        sheet = self._sheet(mine)
        if mine.submitted_utc:
            raise Refused([say("the sheet of {judge} is submitted: ask the head referee to hand it back")(judge=judge)])
        sheet.set(now, judge, mark._replace(judge=self._rated_by(mark, mine.judge)))
        self._sheets[mine.judge] = sheet
        self._put(mine._replace(device=mark.device, history=sheet.history, marks=sheet.marks))
        return sheet.item(mark.group, mark.desc)

    def is_applied(self, judge: str, mark: Mark) -> bool:
        """Whether a mark was applied on a sheet of this judge, also on one that was withdrawn. Raises `Refused`."""
        return any(ScoreSheet((), SheetState(list(sheet.history), sheet.marks)).is_applied(mark)
                   for sheet in self._sheets_of(judge))

    def outcome(self, judge: str, mark: Mark) -> Tuple[int, ItemRecord]:
        """Return the number of the entry that a mark led to, 0 if it made none, and the item. Raises `Refused`."""
        sheet = self._sheet((self._sheets_of(judge) or [self._needed(judge)])[-1])
        return sheet.taken(mark.id) or 0, sheet.item(mark.group, mark.desc)

    def is_submitted(self, judge: str) -> bool:
        """Whether a judge's sheet is submitted: the answer may have been lost."""
        mine = self.own_sheet(judge)
        return mine is not None and bool(mine.submitted_utc)

    def submit(self, now: Now, judge: str, device: str = "") -> str:
        """Submit a judge's sheet, which locks it. Returns a text for the referees, as all changes do. Raises
        `Refused`."""
        mine = self._own_or_new(now, judge)
        if self.own_sheet(judge) is None and self._sheets_of(judge):
            raise Refused([say("the sheet of {judge} was withdrawn: mark an item to begin another one")(judge=judge)])
        items = self._sheet(mine).items()
        missing = [item.desc for item in items
                   if item.kind == ScoreKind.RATING.word and not (item.text or item.not_attempted)]
        if missing:
            raise Refused([say("no rating of {missing}: rate it, or mark it as not attempted")(
                missing=", ".join(missing))])
        self._act(now, By(mine.judge), SUBMITTED, mine.judge)
        self._put(mine._replace(submitted_utc=now.utc, items=items, again="", device=device or mine.device))
        return f"{mine.judge} has submitted as judge"

    # -- the head referee ---------------------------------------------------------------------------

    def hand_back(self, now: Now, by: By, judge: str) -> str:
        """Let a judge look again: the sheet can be changed until it is submitted again. Raises `Refused`."""
        mine = self._needed(judge)
        if not mine.submitted_utc:
            raise Refused([say("{judge} has not submitted, so the sheet cannot be handed back")(judge=mine.judge)])
        by = _with_reason(by, say("hand a sheet back"))
        self._act(now, by, HANDED_BACK, mine.judge)
        self._put(mine._replace(submitted_utc=0.0, items=(), again=by.reason))
        self.state.waiver = None  # the referee waits for this judge
        return f"Sheet of {mine.judge} handed back: {by.reason}"

    def withdraw(self, now: Now, by: By, judge: str) -> str:
        """Withdraw a judge's sheet: it no longer counts, and another judge can take the place. Raises `Refused`."""
        mine = self._needed(judge)
        by = _with_reason(by, say("withdraw a sheet"))
        self._act(now, by, WITHDRAWN, mine.judge)
        self._put(mine._replace(withdrawn_utc=now.utc))
        return f"Sheet of {mine.judge} withdrawn: {by.reason}"

    def waive(self, now: Now, by: By) -> str:
        """Do not wait for judges who are missing. Raises `Refused`."""
        if not self.missing():
            raise Refused([say("no judge is missing")])
        by = _with_reason(by, say("stop waiting for missing judges"))
        self._act(now, by, WAIVED)
        self.state.waiver = Waiver(now.utc, by.who, by.reason)
        return f"Scored without waiting for missing judges: {by.reason}"

    def settle(self, now: Now, by: By, mark: Mark) -> str:
        """Settle an item. The value holds for what the judges have submitted. Raises `Refused`."""
        self._needed_rule()
        if not self.is_complete():
            raise Refused([*self._waits(), say("settle the items after that")])
        by = _with_reason(by, say("settle an item"))
        checked = self._check_settled(mark)
        item = next(item for item in self._form.items if item.key == (mark.group, mark.desc))
        self._act(now, by, SETTLED)
        self.state.settlements.append(Settlement(
            now.utc, by.who, mark.group, mark.desc, checked.value, checked.text, checked.not_attempted, by.reason,
            self._proposals(item.key)))
        return f"Settled: {item.group}: {item.desc}: {by.reason}"

    # -- looking ------------------------------------------------------------------------------------

    def active(self) -> Tuple[JudgeSheet, ...]:
        """Return the sheets that were not withdrawn, by the judges' names."""
        return tuple(sorted((s for s in self.state.sheets if not s.withdrawn_utc), key=lambda s: s.judge))

    def missing(self) -> int:
        """Return how many sheets are not submitted."""
        return 0 if self.rule is None else max(0, self.rule.count - len(self._submitted()))

    def is_complete(self) -> bool:
        """Whether the items get their verdicts, and all may see the sheets."""
        return self.rule is not None and (self.state.waiver is not None or not self.missing())

    def verdicts(self) -> Tuple[ItemVerdict, ...]:
        """Return what became of each item; empty: sheets are missing that the head referee waits for."""
        return tuple(self._verdict(item) for item in self._form.items) if self.is_complete() else ()

    def differences(self) -> Tuple[ItemVerdict, ...]:
        """Return the items that the head referee must settle."""
        return tuple(v for v in self.verdicts() if v.value is None and v.proposals)

    def own_items(self, judge: str) -> Tuple[ItemRecord, ...]:
        """Return the items as a judge has marked them; those of an empty sheet if the judge has none yet."""
        return self._sheet(self.own_sheet(judge) or JudgeSheet(judge, 0.0)).items()

    def own_form(self, judge: str) -> SheetForm:
        """Return the items of a judge's sheet, and the values that they accept."""
        sheet = self.own_sheet(judge)
        name = judge if sheet is None else sheet.judge
        return SheetForm(tuple(item.rated_by(name) for item in self._form.items))

    def own_sheet(self, judge: str) -> Optional[JudgeSheet]:
        """Return a judge's sheet; None: the judge has none. Names that differ in capitals only are the same."""
        return next((sheet for sheet in self._sheets_of(judge) if not sheet.withdrawn_utc), None)

    def not_ready(self) -> List[str]:
        """Return why the run cannot be signed off; empty: it can, as far as the judges are concerned."""
        if self.rule is None:
            return []
        differences = [f"{v.item.group}: {v.item.desc}" for v in self.differences()]
        settle: List[str] = [DIFFER(items="; ".join(differences))] if differences else []
        return (self._waits() if not self.is_complete() else []) + settle

    def record(self) -> JudgingRecord:
        """Return the state in the form in which the run's record contains it."""
        state = self.state
        return JudgingRecord(tuple(state.sheets), tuple(state.settlements), state.waiver, tuple(state.acts))

    # -- inside -------------------------------------------------------------------------------------

    def _sheets_of(self, judge: str) -> List[JudgeSheet]:
        """Return all sheets of a judge, the newest last: at most that one was not withdrawn."""
        name = judge.casefold()
        return [sheet for sheet in self.state.sheets if sheet.judge.casefold() == name]

    def _waits(self) -> List[str]:
        assert self.rule is not None, "it has judges"
        late = [sheet.judge for sheet in self.active() if not sheet.submitted_utc]
        counted = {"missing": self.missing(), "count": self.rule.count}
        return [LATE(**counted, names=", ".join(late)) if late else MISSING(**counted)]

    def _needed_rule(self) -> None:
        if self.rule is None:
            raise Refused([say("this benchmark has no judges with sheets of their own: see the key 'judges' of the "
                               "benchmarks file")])

    def _submitted(self) -> Tuple[JudgeSheet, ...]:
        return tuple(sheet for sheet in self.active() if sheet.submitted_utc)

    def _needed(self, judge: str) -> JudgeSheet:
        self._needed_rule()
        sheet = self.own_sheet(judge)
        if sheet is None:
            names = ", ".join(each.judge for each in self.active()) or "nobody yet"
            raise Refused([say("'{judge}' has no sheet of this run: it is judged by {names}")(
                judge=judge, names=names)])
        return sheet

    def _own_or_new(self, now: Now, judge: str) -> JudgeSheet:
        """Return a judge's sheet, or an empty one if a place is free. Raises `Refused`."""
        self._needed_rule()
        assert self.rule is not None, "it has judges"
        if sheets.person(judge) in ("", sheets.NO_NAME):
            raise Refused([say("a judge needs a name: enter it, in the terminal with --by")])
        sheet = self.own_sheet(judge)
        if sheet is not None:
            return sheet
        names = [each.judge for each in self.active()]
        if len(names) >= self.rule.count:
            raise Refused([say("this run already has its {count} judges ({names}): the head referee can withdraw a "
                               "sheet")(count=self.rule.count, names=", ".join(names))])
        if len(self.state.sheets) >= MAX_SHEETS:
            raise Refused([say("{most} sheets of judges were opened for this run: settle the items instead")(
                most=MAX_SHEETS)])
        return JudgeSheet(judge, now.utc)

    def _put(self, sheet: JudgeSheet) -> None:
        """Replace a judge's sheet, or add it."""
        if sheet.submitted_utc or sheet.withdrawn_utc:
            self._sheets.pop(sheet.judge, None)
        found = (i for i, each in enumerate(self.state.sheets) if each.judge == sheet.judge and not each.withdrawn_utc)
        index = next(found, None)
        if index is None:
            self.state.sheets.append(sheet)
        else:
            self.state.sheets[index] = sheet

    def _sheet(self, mine: JudgeSheet) -> ScoreSheet:
        """Return a judge's sheet with its items."""
        items = self.own_form(mine.judge).items
        return self._sheets.get(mine.judge) or ScoreSheet(items, SheetState(list(mine.history), mine.marks))

    def _rated_by(self, mark: Mark, judge: str) -> str:
        is_rating = any(item.key == (mark.group, mark.desc) and item.kind is ScoreKind.RATING
                        for item in self._form.items)
        return judge if is_rating else ""

    def _check_settled(self, mark: Mark) -> Mark:
        """Return a settlement as a mark that the run's sheet takes. Raises `Refused`."""
        items = tuple(item.rated_by("settlement") for item in self._form.items)
        return ScoreSheet(items).check(mark._replace(judge=self._rated_by(mark, "settlement")))

    def _act(self, now: Now, by: By, act: str, judge: str = "") -> None:
        if len(self.state.acts) >= MAX_ACTS:
            raise Refused([say("the judges' sheets of this run were changed {most} times: no more changes are kept")(
                most=MAX_ACTS)])
        self.state.acts.append(JudgeAct(now.utc, by.who, act, judge, by.reason))

    def _records(self, key: Key) -> Tuple[Tuple[str, ItemRecord], ...]:
        return tuple((sheet.judge, item) for sheet in self._submitted() for item in sheet.items if item.key == key)

    def _proposals(self, key: Key) -> Tuple[Tuple[str, str], ...]:
        return tuple((judge, sheets.proposal(item)) for judge, item in self._records(key))

    def _verdict(self, item: ScoringItem) -> ItemVerdict:
        assert self.rule is not None, "it has judges"
        records, proposals = self._records(item.key), self._proposals(item.key)
        settled = next((s for s in reversed(self.state.settlements) if (s.group, s.desc) == item.key), None)
        if settled is not None and settled.proposals == proposals:
            value = ItemValue(settled.value, settled.text, settled.not_attempted)
            ratings = tuple((judge, settled.text) for judge in item.judges)
            return ItemVerdict(item, proposals, value, ratings, settled.who, "referee", settled.reason)
        value_agreed = agreed(self.rule.agreement, item, [value_of(record) for _, record in records])
        who = ", ".join(judge for judge, _ in records)
        return ItemVerdict(item, proposals, value_agreed, _ratings(item, records), who, "judge")


def _ratings(item: ScoringItem, records: Tuple[Tuple[str, ItemRecord], ...]) -> Tuple[Tuple[str, str], ...]:
    """Assign the ratings to the judges that the file names; if it names others, in the order of the names."""
    given = {judge: record.text for judge, record in records}
    if set(given) <= set(item.judges):
        return tuple((judge, given.get(judge, "")) for judge in item.judges)
    texts = [*given.values(), *[""] * len(item.judges)]
    return tuple(zip(item.judges, texts))


def _with_reason(by: By, what: str) -> By:
    """Return who decides and why. Raises `Refused` if the name or the reason is missing."""
    if sheets.person(by.who) in ("", sheets.NO_NAME):
        raise Refused([say("to {what} needs the name of the head referee: enter it, in the terminal with --by")(
            what=what)])
    if not by.reason:
        raise Refused([say("to {what} needs a reason: type one")(what=what)])
    return by
