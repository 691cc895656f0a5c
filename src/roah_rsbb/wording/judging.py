"""Several judges of a run, and how its result becomes final, as people read them.

Terminal and pages show the values of `model.judging` in these words. The names of the fields are those of the
terminal's JSON output (docs/referee.md, "JSON") and never change.
"""

from typing import Callable, Dict, List, NamedTuple, Tuple

from roah_rsbb.model.actions import BY_THE_FILE_S, ENTRIES
from roah_rsbb.model.document import Document
from roah_rsbb.model.results import DIFFER, JudgedItem, JudgedRun, JudgeLine, Judging, ObjectionLine
from roah_rsbb.wording import sheets
from roah_rsbb.wording.language import tr, tr_later

JUDGING, SUBMITTED = tr_later("is judging"), tr_later("has submitted")
LOOKS_AGAIN = tr_later("looks again")
MISSING = tr_later("Sheets that are missing: {missing} of {count}")
WAIVED = tr_later("Missing judges are not waited for: {reason}")
DIFFERENCES = tr_later("The judges differ. Items to settle: {number}")
DIFFERS = tr_later("differs")
SETTLED_BY = tr_later("Settled by {name}: {reason}")
PROVISIONAL = tr_later("provisional")
OBJECTIONS_UNTIL = tr_later("objections until {time}")
OBJECTIONS_OVER = tr_later("the time for objections is over")
OPEN_OBJECTIONS = tr_later("objections to answer: {number}")
NO_ANSWER = tr_later("not answered yet")
UPHELD, REJECTED = tr_later("upheld"), tr_later("rejected")
NOT_OVER = tr_later("The run is still connected")
WAITING = tr_later("The values are shown when all judges have submitted, or when you do not wait for the others.")
NO_JUDGES = tr_later("The referee scores this benchmark: see Results.")
NONE_SUBMITTED, NO_SHEETS = tr_later("No judge has submitted"), tr_later("No judge has a sheet")
NOBODY_MISSING, NOT_PUBLISHED = tr_later("No judge is waited for"), tr_later("The result is not published yet")
# What the head referee does. Buttons have these names.
SETTLE, HAND_BACK, WITHDRAW, WAIVE, PUBLISH, OBJECT = (
    ENTRIES[name].label for name in ("settle", "hand_back", "withdraw_sheet", "waive", "publish", "object"))
OBJECTION_TIME = ENTRIES["publish"].fields[0].label
_OBJECTION_MINUTES = (5, 10, 15, 30, 60)
UPHOLD, REJECT = tr_later("Uphold the objection"), tr_later("Reject the objection")


class GivenInWords(NamedTuple):
    """What a judge gave an item."""

    judge: str
    shown: str  # the value in words
    value: int
    text: str  # of a type that is not a whole number
    not_attempted: bool


class Judged(NamedTuple):
    """An item with what each judge submitted."""

    number: int  # in the sheet, from 1
    group: str
    item: str
    type: str
    outcome: str  # a word of `model.judging`
    shown: str  # the value that counts, in words
    given: Tuple[GivenInWords, ...]
    who: str  # who settled it; empty: nobody
    reason: str


def judged_of(run: JudgedRun) -> Tuple[Judged, ...]:
    """Return what the judges gave, in words; empty: more sheets are expected."""
    numbers = {item: number for number, item in enumerate(run.items, 1)}
    return tuple(_judged(one, numbers[one.item]) for one in run.judged)


def _judged(one: JudgedItem, number: int) -> Judged:
    item = one.item
    return Judged(
        number, item.group, item.desc, item.type, one.outcome,
        sheets.item_text(item),
        tuple(GivenInWords(each.judge, sheets.with_unit(
            sheets.item_value(item.type, each.value, each.not_attempted, each.text), item),
                           each.value, each.text, each.not_attempted) for each in one.given),
        sheets.person(one.who), one.reason,
    )


def objections_of(run: JudgedRun) -> Tuple[ObjectionLine, ...]:
    """Return the objections to a result, with the names of persons."""
    return tuple(one._replace(who=sheets.person(one.who), answered_by=sheets.person(one.answered_by))
                 for one in run.objections)


def judgings_of(document: Document, zone: str) -> List[Judging]:
    """Return the progress of all runs of a zone that are not signed off, first those with judges or a published
    result."""
    found = [one for one in document.judging.values() if one.zone == zone]
    known = {one.identity for one in found}
    return found + [Judging(zone, run.identity) for run in document.runs() if run.zone == zone
                    and run.is_unsigned and run.identity not in known]


def off(judging: Judging, is_over: bool) -> Dict[str, str]:
    """Return why each action of the head referee is off for a run, by its name; empty: it is on. `is_over`: the run is
    not connected any more. The core refuses what is off (a test compares both)."""
    has_submitted = any(judge.submitted_utc_s for judge in judging.judges)
    is_waited_for = judging.count and judging.missing and not judging.waiver
    over = "" if is_over else tr(NOT_OVER)
    return {
        "settle": "" if judging.complete and judging.count else tr(WAITING if judging.count else NO_JUDGES),
        "hand_back": "" if has_submitted else tr(NONE_SUBMITTED),
        "withdraw_sheet": "" if judging.judges else tr(NO_SHEETS),
        "waive": "" if is_waited_for else tr(NOBODY_MISSING),
        "publish": over, "answer": over, "sign_off": over,
        "object": over or (tr(NOT_PUBLISHED) if judging.must_publish else ""),
    }


# -- in words ---------------------------------------------------------------------------------------


def judge_state(judge: JudgeLine) -> str:
    """Return the state of a judge's work."""
    return tr(SUBMITTED if judge.submitted_utc_s else LOOKS_AGAIN if judge.again else JUDGING)


def judge_line(judge: JudgeLine) -> str:
    """Return a line with a judge and the state of the judge's work."""
    again = f" ({judge.again})" if judge.again else ""
    return f"{'✔' if judge.submitted_utc_s else '…'} {judge.judge}: {judge_state(judge)}{again}"


def missing_text(judging: Judging) -> str:
    """Return how many sheets are missing, and whether they are waited for; empty: none is."""
    if judging.waiver:
        return tr(WAIVED, reason=judging.waiver)
    return tr(MISSING, missing=judging.missing, count=judging.count) if judging.missing else ""


def differences_text(judging: Judging) -> str:
    """Return how many items the head referee must settle; empty: none."""
    return tr(DIFFERENCES, number=judging.differences) if judging.differences else ""


def publication_text(judging: Judging, utc_s: float, when: Callable[[float], str]) -> str:
    """Return the state of the publication at the time `utc_s`, and of objections; empty: there is neither."""
    waiting = [tr(OPEN_OBJECTIONS, number=judging.open_objections)] if judging.open_objections else []
    if judging.published_utc_s is None:
        return "".join(waiting)
    until = judging.objections_until_utc_s or 0.0
    limit = tr(OBJECTIONS_UNTIL, time=when(until)) if until > utc_s else tr(OBJECTIONS_OVER)
    return " · ".join([tr(PROVISIONAL), limit, *waiting])


def objection_times() -> List[Tuple[float, str]]:
    """Return the times for objections that can be chosen: PublishResult.seconds, and its text."""
    return [(BY_THE_FILE_S, tr("As the benchmarks file says")), (0.0, tr("None")),
            *((60.0 * minutes, tr("{n} minutes", n=minutes)) for minutes in _OBJECTION_MINUTES)]


def outcome_text(item: Judged) -> str:
    """Return the value of an item, or that the judges differ."""
    return f"≠ {tr(DIFFERS)}" if item.outcome == DIFFER else item.shown


def settled_text(item: Judged) -> str:
    """Return who settled an item and why; empty: nobody."""
    return tr(SETTLED_BY, name=item.who, reason=item.reason) if item.reason else ""


def answer_text(objection: ObjectionLine) -> str:
    """Return the answer to an objection; empty: there is none."""
    if objection.answered_utc_s is None:
        return ""
    return f"{tr(UPHELD if objection.upheld else REJECTED)}: {objection.answer}"
