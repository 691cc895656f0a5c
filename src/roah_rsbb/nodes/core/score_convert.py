"""Converts between scores of referees and modules and their ROS messages.

ZoneScoreGroup, which original panels read, only knows yes-or-no items and counts. There, other numbers appear as counts
without their decimals, and 0 if they are negative; choices and ratings do not appear.
"""

from typing import Dict, Iterable, List, Sequence, Tuple

from roah_rsbb.model.modules import ScoreValue
from roah_rsbb.model.scoring import ScoreGroup, ScoreKind, ScoringItem
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.msg import ModuleScore, ZoneScoreGroup

_KINDS = {kind.word: kind for kind in ScoreKind}
# How ZoneScoreGroup shows the types that it can show.
_OLD_TYPES = {
    ScoreKind.BOOL: ZoneScoreGroup.SCORING_BOOL, ScoreKind.UINT: ZoneScoreGroup.SCORING_UINT,
    ScoreKind.INT: ZoneScoreGroup.SCORING_UINT, ScoreKind.DECIMAL: ZoneScoreGroup.SCORING_UINT,
}


def group_message(group: ScoreGroup) -> ZoneScoreGroup:
    """A group of the referee's scoring items."""
    return _old_group(group.name, [(item.kind, item.desc, value) for item, value in group.items])


def old_groups(items: Iterable[SheetItem]) -> List[ZoneScoreGroup]:
    """A score sheet, group by group."""
    groups: Dict[str, List[Tuple[ScoreKind, str, int]]] = {}
    for item in items:
        groups.setdefault(item.group, []).append((_KINDS[item.type], item.desc, item.value))
    return [_old_group(name, group) for name, group in groups.items()]


def _old_group(name: str, items: Sequence[Tuple[ScoreKind, str, int]]) -> ZoneScoreGroup:
    shown = [item for item in items if item[0] in _OLD_TYPES]
    return ZoneScoreGroup(
        group_name=name,
        types=bytes(_OLD_TYPES[kind] for kind, _, _ in shown),
        descriptions=[desc for _, desc, _ in shown],
        current_values=[max(0, value) for _, _, value in shown],
    )


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
