"""The judges of a run and the objections to its result: proposals side by side, settlements, and what was decided."""

from typing import Iterator, List, NamedTuple, Optional, Tuple

from roah_rsbb.model.records import ItemRecord, JudgeSheet, RunRecord, Settlement
from roah_rsbb.wording import sheets


class ItemProposals(NamedTuple):
    """An item with what each judge submitted."""

    item: ItemRecord  # as it counts
    proposals: Tuple[str, ...]  # in the order of the judges
    settlement: Optional[Settlement]  # the one that counts; None: the judges agreed, or nobody settled it


def submitted(record: RunRecord) -> Tuple[JudgeSheet, ...]:
    """Return the sheets that count, by the judges' names; none before all who are awaited have submitted."""
    judging, rule = record.judging, None if record.form is None else record.form.judges
    found = sorted((s for s in judging.sheets if s.submitted_utc and not s.withdrawn_utc), key=lambda s: s.judge)
    is_complete = judging.waiver is not None or (rule is not None and len(found) >= rule.count)
    return tuple(found) if is_complete else ()


def ratings(record: RunRecord, item: ItemRecord) -> Tuple[Tuple[str, str], ...]:
    """Return what each judge gave for an item that judges rate. If they have sheets of their own, what counts in the
    run's sheet may be a settlement instead."""
    if record.form is None or record.form.judges is None:
        return item.ratings
    return tuple((one.judge, each.text) for one in submitted(record) for each in one.items
                 if each.key == item.key and item.kind == "rating")


def judged_items(record: RunRecord) -> Iterator[ItemProposals]:
    """Return the items of a run with what its judges submitted; none if it has no judges."""
    judges = submitted(record)
    settled = {(s.group, s.desc): s for s in record.judging.settlements}
    if not judges and not settled:
        return
    for item in record.items:
        values = {one.judge: sheets.in_words(each) for one in judges for each in one.items if each.key == item.key}
        settlement = settled.get(item.key)
        counts = settlement is not None and settlement.proposals == tuple(sorted(values.items()))
        yield ItemProposals(item, tuple(values.get(s.judge, "") for s in judges), settlement if counts else None)


def act_lines(record: RunRecord) -> List[Tuple[float, str, str]]:
    """Return what was done with the judges' sheets: UTC seconds, who, what."""
    return [
        (act.utc, act.who, act.act + (f" the sheet of {act.judge}" if act.judge and act.judge != act.who else "")
         + (f": {act.reason}" if act.reason else ""))
        for act in record.judging.acts
    ]


def objection_lines(record: RunRecord) -> List[Tuple[float, str, str]]:
    """Return the publication of a result, the objections and their answers: UTC seconds, who, what."""
    published, lines = record.publication.published, []
    if published is not None:
        seconds = round(published.until_utc - published.utc)
        given = f"{seconds} s" if seconds % 60 else f"{seconds // 60} min"
        lines.append((published.utc, published.who, f"Published as provisional, {given} for objections"))
    for one in record.publication.objections:
        lines.append((one.utc, one.who, f"Objection {one.number} of {one.by}: {one.text}"))
        if one.answered_utc:
            answer = f"Objection {one.number} {'upheld' if one.upheld else 'rejected'}: {one.answer}"
            lines.append((one.answered_utc, one.answered_by, answer))
    return sorted(lines, key=lambda line: line[0])
