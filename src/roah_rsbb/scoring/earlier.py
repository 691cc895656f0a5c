"""Score sheets of files and journals before 2026-12 in the language of rules.

They were groups of items, with limits of each group and of the whole sheet, and a bonus for the time left.
"""

import functools
from typing import Dict, List

from roah_rsbb.model.rules import Condition, Item, Measure, Sheet
from roah_rsbb.model.scoring import (
    MAX_DECIMALS,
    TIME_LEFT,
    GroupLimits,
    Key,
    ScoreKind,
    ScoringItem,
    SheetForm,
    TimeLeft,
)

_MEASURES = {
    ScoreKind.BOOL: Measure.YES, ScoreKind.UINT: Measure.COUNT, ScoreKind.INT: Measure.NUMBER,
    ScoreKind.DECIMAL: Measure.NUMBER, ScoreKind.CHOICE: Measure.CHOICE, ScoreKind.RATING: Measure.RATING,
}
# Ids that no group can have.
_SHEET, _LEFT = "\nsheet", "\ntime left"


@functools.lru_cache(maxsize=256)
def sheet_of(form: SheetForm) -> Sheet:
    """Return the rules of a sheet."""
    if form.sheet is not None:
        return form.sheet
    rules = form.rules
    items: List[Item] = []
    has_limits = rules.least is not None or rules.most is not None
    if has_limits:
        items.append(Item(_SHEET, "Score sheet", amount=Measure.SECTION, least=rules.least, most=rules.most))
    under = _SHEET if has_limits else ""
    limits = {group.name: group for group in rules.groups}
    sections: Dict[str, Item] = {}
    for row in form.items:
        if row.group not in sections:
            own = limits.get(row.group, GroupLimits(row.group))
            sections[row.group] = Item(
                f"\n{row.group}", row.group, under, Measure.SECTION, least=own.least, most=own.most)
            items.append(sections[row.group])
        items.append(_item(row, sections[row.group].id))
    if rules.time_left is not None:
        items.append(_time_left(rules.time_left, under))
    # Marks were never late: the time limit counts for the time that is left only.
    return Sheet(tuple(items), clock_s=form.time_limit or None)


def id_of(row: ScoringItem) -> str:
    """Return what the rules call a row. It has no id if it is of a file before 2026-12."""
    return row.id or _key_id(row.key)


def _key_id(key: Key) -> str:
    return "\n".join(key)


def _item(row: ScoringItem, under: str) -> Item:
    return Item(
        id_of(row), row.desc, under, _MEASURES[row.kind], row.points, decimals=MAX_DECIMALS,
        low=row.least, high=row.most, choices=row.choices, judges=row.judges, jury=row.jury,
        needs=tuple(Condition(_key_id(key)) for key in row.needs))


def _time_left(bonus: TimeLeft, under: str) -> Item:
    return Item(_LEFT, TIME_LEFT, under, Measure.CLOCK, bonus.points, most=bonus.most, seconds=bonus.seconds,
                needs=tuple(Condition(_key_id(key)) for key in bonus.needs))
