"""Score sheets of journals before 2026-12 in the language of rules.

They were groups of items, with limits of each group and of the whole sheet, and a bonus for the time left. They become
the same sheets as those of the files by which they were held (`rulebook/scoring_section.py`).
"""

import functools
from dataclasses import replace
from decimal import Decimal
from typing import Dict, List

from roah_rsbb.model.rules import Condition, Item, Measure, Sheet
from roah_rsbb.model.scoring import (
    MAX_DECIMALS,
    NO_SHEET_RULES,
    TIME_LEFT,
    WHOLE_SHEET,
    GroupLimits,
    ScoreKind,
    ScoringItem,
    SheetForm,
    TimeLeft,
    earlier_id,
    rows,
)

_MEASURES = {
    ScoreKind.BOOL: Measure.YES, ScoreKind.UINT: Measure.COUNT, ScoreKind.INT: Measure.WHOLE,
    ScoreKind.DECIMAL: Measure.NUMBER, ScoreKind.CHOICE: Measure.CHOICE, ScoreKind.RATING: Measure.RATING,
}


@functools.lru_cache(maxsize=256)
def sheet_of(form: SheetForm) -> Sheet:
    """Return the rules of a sheet."""
    if form.sheet is not None:
        return form.sheet
    rules = form.rules
    items: List[Item] = []
    under = f"{WHOLE_SHEET}." if rules.least is not None or rules.most is not None else ""
    if under:
        items.append(Item(under, WHOLE_SHEET, amount=Measure.SECTION, least=rules.least, most=rules.most))
    limits = {group.name: group for group in rules.groups}
    groups: Dict[str, List[ScoringItem]] = {}
    for row in form.items:
        groups.setdefault(row.group, []).append(row)
    for name, own in groups.items():
        limit = limits.get(name, GroupLimits(name))
        items.append(Item(f"{name}:", name, under, Measure.SECTION, least=limit.least, most=limit.most))
        items += [_item(row, f"{name}:") for row in own]
    if rules.time_left is not None:
        items.append(_time_left(rules.time_left, under))
    # Marks were never late: the time limit counts for the time that is left only.
    return Sheet(tuple(items), clock_s=form.time_limit or None)


@functools.lru_cache(maxsize=256)
def modern(form: SheetForm) -> SheetForm:
    """Return a sheet with rules as those of this version are."""
    if form.sheet is not None or form.is_plain:
        return form
    sheet = sheet_of(form)
    return replace(form, items=rows(sheet), rules=NO_SHEET_RULES, time_limit=0.0, sheet=sheet)


def id_of(row: ScoringItem) -> str:
    """Return what the rules call a row. It has no id if it is of a file before 2026-12."""
    return row.id or earlier_id(row.key)


def _item(row: ScoringItem, under: str) -> Item:
    is_count = row.kind is ScoreKind.UINT and row.most is not None
    return Item(
        id_of(row), row.desc, under, _MEASURES[row.kind], row.points,
        decimals=None if row.points is None else MAX_DECIMALS,
        times=1 if row.kind is ScoreKind.BOOL else int(row.most or 0) if is_count else None,
        low=row.least, high=None if is_count else row.most, choices=row.choices, judges=row.judges, jury=row.jury,
        needs=tuple(Condition(earlier_id(key)) for key in row.needs))


def _time_left(bonus: TimeLeft, under: str) -> Item:
    return Item(TIME_LEFT, TIME_LEFT, under, Measure.CLOCK, Decimal(bonus.points), most=bonus.most,
                seconds=bonus.seconds, needs=tuple(Condition(earlier_id(key)) for key in bonus.needs))
