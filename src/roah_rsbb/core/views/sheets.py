"""Runs, their score sheets and their judges as referees see them, made of the records."""

import functools
import json
import math
import zlib
from typing import Any, Dict, Iterable, List, Optional, Sequence, Tuple

from roah_rsbb.core.desks import RunJudging
from roah_rsbb.model.as_json import to_json
from roah_rsbb.model.reason import joined
from roah_rsbb.model.records import ItemRecord, JudgeSheet, Objection, RunRecord, ScoreEntry, grouped, ratings
from roah_rsbb.model.results import (
    AGREED,
    DIFFER,
    NOT_JUDGED,
    SETTLED,
    Given,
    JudgedItem,
    JudgedRun,
    JudgeLine,
    Judging,
    ObjectionLine,
    RunLine,
    RunSheet,
)
from roah_rsbb.model.rules import Number
from roah_rsbb.model.scoring import INCIDENTS, Key, ScoringItem, SheetForm
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.scoring.book import can_undo
from roah_rsbb.scoring.counting import Why
from roah_rsbb.scoring.judges import ItemVerdict
from roah_rsbb.scoring.points import text_of
from roah_rsbb.scoring.publication import Publication, PublicationState
from roah_rsbb.scoring.timeline import run_timeline, type_of
from roah_rsbb.scoring.tree import is_late
from roah_rsbb.wording.sheets import GroupOfValues, points_said, score_line, sums_text


def sheet_items(
    items: Sequence[ItemRecord], form: Optional[SheetForm], history: Iterable[ScoreEntry] = ()
) -> Tuple[SheetItem, ...]:
    """Return all items of a score sheet, with what each takes. `form`: None if the items have no rules; `history`:
    entries, of which some may not count."""
    rules = {} if form is None else {item.key: item for item in form.items}
    around = _around(form)
    late: Dict[Key, Tuple[int, ...]] = {}
    newest: Optional[ScoreEntry] = None
    for entry in history:
        newest = newest if entry.withdrawn_utc else entry
        if entry.void and is_late(entry.void):
            late[entry.group, entry.desc] = (*late.get((entry.group, entry.desc), ()), entry.number)
    if newest is not None and newest.void and not is_late(newest.void):  # of earlier ones, the history says it
        key = newest.group, newest.desc
        around = {**around, key: {**around.get(key, {}), "void": newest.void}}
    return tuple(_item(item, rules.get(item.key), late.get(item.key, ()))._replace(**around.get(item.key, {}))
                 for item in items)


@functools.lru_cache(maxsize=64)
def _around(form: Optional[SheetForm]) -> Dict[Key, Dict[str, Any]]:
    """Return what the rules say of rows besides their values: what they modify, what an incident leads to, help."""
    if form is None or form.sheet is None:
        return {}
    rows, items = {row.id: row for row in form.items}, {item.id: item for item in form.sheet.items}
    found: Dict[Key, Dict[str, Any]] = {}
    for row in form.items:
        above = items[row.id].under if row.id in items else ""
        while above and above not in rows:  # a section
            above = items[above].under
        item = items.get(row.id)
        if item is not None and (above or item.help or item.decided):
            found[row.key] = {"under": rows[above].desc if above else "", "help": item.help, "decided": item.decided}
    after = {incident.of: incident.after for incident in form.sheet.incidents if incident.of}
    titles = {incident.name: incident.title for incident in form.sheet.incidents}
    for incident in form.sheet.incidents:
        marked = items.get(incident.marks)
        found[INCIDENTS, incident.title] = {
            "incident": incident.name, "after": _number(after.get(incident.name)),
            "until": tuple(titles.get(name, name) for name in incident.ends),
            "help": incident.help or (marked.help if marked else ""),
            "decided": (*incident.decided, *(marked.decided if marked else ()))}
    return found


def _item(record: ItemRecord, rule: Optional[ScoringItem], late: Tuple[int, ...]) -> SheetItem:
    found = SheetItem(record.group, record.desc, type_of(record), record.value, record.not_attempted, record.corrected,
                      record.text, record.points, late=late)
    if rule is None:
        return found
    ratings = dict(record.ratings)
    return found._replace(
        each=_number(rule.points), min=_number(rule.least), max=_number(rule.most),
        choices=tuple(choice.name for choice in rule.choices),
        choice_points=tuple(_number(choice.points) for choice in rule.choices),
        judges=rule.judges, ratings=tuple(ratings.get(judge, "") for judge in rule.judges),
        jury=rule.jury.value if rule.judges else "", needs=tuple(desc for _, desc in rule.needs),
        unit=rule.unit, percent=_number(rule.percent),
    )


def _number(number: Number) -> str:
    return "" if number is None else text_of(number)


# -- runs -------------------------------------------------------------------------------------------


def run_line(record: RunRecord, why: Optional[Why]) -> RunLine:
    """Return a run in a line. `why`: why it counts or not; None: not known."""
    signed = record.sign_off
    return RunLine(
        record.identity, _revision(record), record.zone, record.benchmark, record.team, record.round, record.run,
        record.opened_utc, record.started_utc or None, record.closed_utc or None, record.end_reason,
        sums_of_record(record), any(item.corrected for item in record.items), None if signed is None else signed.utc,
        "" if signed is None else signed.who, "" if why is None else why.value,
        sum(not each.decided_utc for each in record.proposals), len(record.versions), can_undo(record),
        _protests_until(record), tuple(map(_objection, record.publication.objections)),
        tuple((item.desc, item.value) for item in record.items if item.group == INCIDENTS and item.value),
    )


def _protests_until(record: RunRecord) -> Optional[float]:
    """Return until when (UTC seconds) the rules let the team object to a result that it can know."""
    form, signed = record.form, record.sign_off
    if form is None or (signed is None and record.publication.published is None):
        return None
    until = Publication(form, PublicationState.of(record.publication)).until(0.0 if signed is None else signed.utc)
    return until if math.isfinite(until) else None


def run_sheet(record: RunRecord, why: Optional[Why]) -> RunSheet:
    """Return a run with its score sheet."""
    happened = run_timeline(record)
    return RunSheet(
        run_line(record, why), tuple(record.robots), record.elapsed_s, _given_items(record),
        happened.history, happened.ends, record.module_scores, record.points, happened.entries, happened.outages,
        happened.proposals, happened.captain, happened.versions, happened.changes,
        happened.objections,
    )


def _given_items(record: RunRecord) -> Tuple[SheetItem, ...]:
    """Return the items of a run. Of one with sheets of judges, each rating is what a judge gave there: the run's sheet
    has what counts of them, such as a settlement, for each of its places."""
    items = sheet_items(record.items, record.form, record.history)
    if record.form is None or record.form.judges is None:
        return items
    given = [ratings(record, item) for item in record.items]
    return tuple(
        item._replace(judges=tuple(one.judge for one in own), ratings=tuple(one.text for one in own)) if own else item
        for item, own in zip(items, given))


def sums_of_record(record: RunRecord) -> str:
    """Return what a module measured of the whole run, and the points of its score sheet, or the sums of its groups if
    it gives none."""
    measured = [joined(score_line(score), ": ") for score in record.module_scores if not score.group]
    sums = sums_text(_groups(record.items)) if record.points is None else points_said(record.points)
    return joined([*measured, *filter(None, [sums])], " · ")


def timeless(record: RunRecord) -> RunRecord:
    """Return the record without values that change with time only."""
    return record._replace(elapsed_s=0.0, phases=tuple(phase._replace(elapsed_s=0.0) for phase in record.phases))


def _revision(record: RunRecord) -> int:
    return zlib.crc32(json.dumps(to_json(timeless(record))).encode())


def _groups(items: Iterable[ItemRecord]) -> List[GroupOfValues]:
    return [
        GroupOfValues(name, [item.value for item in group if not item.text], sum(item.not_attempted for item in group))
        for name, group in grouped(items).items()
    ]


# -- judges -----------------------------------------------------------------------------------------


def judging(found: RunJudging) -> Judging:
    """Return the progress of the judges of a run, without any values."""
    record = found.record
    published, waiver = record.publication.published, record.judging.waiver
    return Judging(
        record.zone, record.identity, _judging_revision(record), found.count, found.agreement, found.missing,
        found.is_complete,
        tuple(JudgeLine(sheet.judge, sheet.submitted_utc or None, sheet.again) for sheet in found.active),
        "" if waiver is None else waiver.reason,
        sum(verdict.value is None and bool(verdict.proposals) for verdict in found.verdicts),
        None if published is None else published.utc, None if published is None else published.until_utc,
        record.open_objections,
        bool(published is None and record.form and record.form.objection_time and record.sign_off is None),
    )


def judged_run(found: RunJudging) -> JudgedRun:
    """Return what a judge or the head referee may see of a run."""
    record, own = found.record, found.own
    items = sheet_items(record.items, record.form)
    of_key = {(item.group, item.desc): item for item in items}
    return JudgedRun(
        judging(found), items,
        tuple(_judged(verdict, of_key[verdict.item.key], found.active) for verdict in found.verdicts),
        tuple(map(_objection, record.publication.objections)),
        sheet_items(found.own_items, found.own_form), own is not None and bool(own.submitted_utc),
        "" if own is None else own.again,
    )


def _judged(verdict: ItemVerdict, item: SheetItem, sheets: Tuple[JudgeSheet, ...]) -> JudgedItem:
    given = [(sheet.judge, item) for sheet in sheets for item in sheet.items if item.key == verdict.item.key]
    outcome = DIFFER if given else NOT_JUDGED
    if verdict.value is not None:
        outcome = SETTLED if verdict.is_settled else AGREED
    return JudgedItem(
        item, outcome, tuple(Given(judge, one.value, one.text, one.not_attempted) for judge, one in given),
        verdict.who if verdict.is_settled else "", verdict.reason,
    )


def _objection(one: Objection) -> ObjectionLine:
    return ObjectionLine(one.number, one.utc, one.by, one.text, one.who, one.answered_utc or None, one.answered_by,
                         one.upheld, one.answer, one.second)


def _judging_revision(record: RunRecord) -> int:
    """A checksum of all that `judged_run` depends on."""
    return zlib.crc32(json.dumps([
        to_json(record.judging), to_json(record.publication), *map(to_json, record.items)]).encode())
