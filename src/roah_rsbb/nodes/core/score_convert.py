"""Converts between scores of referees and modules and their ROS messages.

ZoneScoreGroup, which original panels read, only knows yes-or-no items and counts. There, other numbers appear as counts
without their decimals, and 0 if they are negative; choices and ratings do not appear. ScoreItem has everything.
"""

from typing import Iterable, List, Optional, Sequence, Tuple

from roah_rsbb.core.scoring.points import text_of
from roah_rsbb.model.modules import ScoreValue
from roah_rsbb.model.records import ItemRecord, SheetPoints, grouped
from roah_rsbb.model.scoring import Number, ScoreGroup, ScoreKind, ScoringItem, SheetForm
from roah_rsbb.msg import GroupPoints, ModuleScore, ScoreItem, ZoneScoreGroup
from roah_rsbb.msg import SheetPoints as SheetPointsMsg

_KINDS = {kind.word: kind for kind in ScoreKind}
# How ZoneScoreGroup shows the types that it can show.
_OLD_TYPES = {
    ScoreKind.BOOL: ZoneScoreGroup.SCORING_BOOL, ScoreKind.UINT: ZoneScoreGroup.SCORING_UINT,
    ScoreKind.INT: ZoneScoreGroup.SCORING_UINT, ScoreKind.DECIMAL: ZoneScoreGroup.SCORING_UINT,
}


def kind_of(item: ItemRecord) -> ScoreKind:
    """An item's type; unknown types are counts."""
    return _KINDS.get(item.kind, ScoreKind.UINT)


def has_old_form(item: ItemRecord) -> bool:
    """Whether ZoneScoreGroup can show an item."""
    return kind_of(item) in _OLD_TYPES


def group_message(group: ScoreGroup) -> ZoneScoreGroup:
    """A group of the referee's scoring items."""
    return _old_group(group.name, [(item.kind, item.desc, value) for item, value in group.items])


def items_message(items: Iterable[ItemRecord]) -> List[ZoneScoreGroup]:
    """A score sheet, group by group."""
    return [
        _old_group(name, [(kind_of(item), item.desc, item.value) for item in group])
        for name, group in grouped(items).items()
    ]


def _old_group(name: str, items: Sequence[Tuple[ScoreKind, str, int]]) -> ZoneScoreGroup:
    shown = [item for item in items if item[0] in _OLD_TYPES]
    return ZoneScoreGroup(
        group_name=name,
        types=bytes(_OLD_TYPES[kind] for kind, _, _ in shown),
        descriptions=[desc for _, desc, _ in shown],
        current_values=[max(0, value) for _, _, value in shown],
    )


def sheet_items(items: Sequence[ItemRecord], form: Optional[SheetForm]) -> List[ScoreItem]:
    """All items of a score sheet, with what each takes. `form`: None if the items have no rules."""
    rules = {} if form is None else {item.key: item for item in form.items}
    return [_item(item, rules.get(item.key)) for item in items]


def _item(record: ItemRecord, rule: Optional[ScoringItem]) -> ScoreItem:
    message = ScoreItem(
        group=record.group, desc=record.desc, type=int(kind_of(record)), value=record.value,
        not_attempted=record.not_attempted, corrected=record.corrected, text=record.text, points=record.points,
    )
    if rule is None:
        return message
    message.each, message.min, message.max = map(_number, (rule.points, rule.least, rule.most))
    message.choices = [choice.name for choice in rule.choices]
    message.choice_points = [_number(choice.points) for choice in rule.choices]
    ratings = dict(record.ratings)
    message.judges = list(rule.judges)
    message.ratings = [ratings.get(judge, "") for judge in rule.judges]
    message.jury = rule.jury.value if rule.judges else ""
    message.needs = [desc for _, desc in rule.needs]
    return message


def _number(number: Number) -> str:
    return "" if number is None else text_of(number)


def points_message(points: Optional[SheetPoints]) -> SheetPointsMsg:
    """The points of a sheet; without a total if it gives none."""
    if points is None:
        return SheetPointsMsg()
    return SheetPointsMsg(points.total, [GroupPoints(*group) for group in points.groups])


def group_of(message: ZoneScoreGroup) -> ScoreGroup:
    """A group of the referee's scoring items; items of unknown type are counts."""
    kinds = {int(kind): kind for kind in ScoreKind}
    return ScoreGroup(message.group_name, tuple(
        (ScoringItem(message.group_name, desc, kinds.get(kind, ScoreKind.UINT)), value)
        for kind, desc, value in zip(message.types, message.descriptions, message.current_values)
    ))


def score_message(score: ScoreValue) -> ModuleScore:
    """A line of a module's score."""
    return ModuleScore(*score)


def score_of(message: ModuleScore) -> ScoreValue:
    """A line of a module's score."""
    return ScoreValue(message.group, message.name, message.value, message.unit, message.desc)
