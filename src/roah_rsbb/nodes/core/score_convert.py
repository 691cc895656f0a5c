"""Converts between scores of referees and modules and their ROS messages."""

from typing import Iterable, List

from roah_rsbb.core.modules.messages import ScoreValue
from roah_rsbb.core.scoring.records import ItemRecord, grouped
from roah_rsbb.core.scoring.sheet import ScoreGroup
from roah_rsbb.msg import ModuleScore, ZoneScoreGroup
from roah_rsbb.rulebook.benchmarks import ScoreKind, ScoringItem

_TYPES = {kind.name.lower(): int(kind) for kind in ScoreKind}


def group_message(group: ScoreGroup) -> ZoneScoreGroup:
    """A group of the referee's scoring items."""
    return ZoneScoreGroup(
        group_name=group.name,
        types=bytes(int(item.kind) for item, _ in group.items),
        descriptions=[item.desc for item, _ in group.items],
        current_values=[value for _, value in group.items],
    )


def type_of(item: ItemRecord) -> int:
    """An item's type in ZoneScoreGroup; unknown types are counts."""
    return _TYPES.get(item.kind, int(ScoreKind.UINT))


def items_message(items: Iterable[ItemRecord]) -> List[ZoneScoreGroup]:
    """A score sheet, group by group."""
    return [
        ZoneScoreGroup(
            group_name=name,
            types=bytes(type_of(item) for item in group),
            descriptions=[item.desc for item in group],
            current_values=[item.value for item in group],
        )
        for name, group in grouped(items).items()
    ]


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
