"""How the values that several judges gave an item become one (docs/organiser.md, "Judges and objections").

Numbers are exact decimals, and the result does not depend on the order of the judges.
"""

from collections import Counter
from decimal import ROUND_HALF_UP, Decimal
from typing import NamedTuple, Optional, Sequence

from roah_rsbb.model.records import ItemRecord
from roah_rsbb.model.rules import JuryResult
from roah_rsbb.model.scoring import NUMBERS, WHOLE, Agreement, ScoreKind, ScoringItem
from roah_rsbb.scoring.points import jury_text, whole_part


class ItemValue(NamedTuple):
    """A value of an item."""

    value: int = 0
    text: str = ""
    not_attempted: bool = False


def value_of(record: ItemRecord) -> ItemValue:
    """Return the value of an item on a sheet."""
    return ItemValue(0, "", True) if record.not_attempted else ItemValue(record.value, record.text)


def agreed(agreement: Agreement, item: ScoringItem, given: Sequence[ItemValue]) -> Optional[ItemValue]:
    """Return the value that follows from the judges' values by the rule; None: the head referee must settle it.

    A rating has its own rule for its jury, so here its judges only need to have rated. Whether the robot attempted an
    item is never averaged.
    """
    if not given:
        return None
    if len(set(given)) == 1:
        return given[0]
    is_mixed = any(value.not_attempted for value in given)
    if item.kind is ScoreKind.RATING:
        text = "" if is_mixed else jury_text(item, [value.text for value in given])
        return None if not text else ItemValue(whole_part(text), text)
    if agreement is Agreement.ALL_AGREE:
        return None
    if agreement is Agreement.MAJORITY or item.kind not in NUMBERS:  # of answers that are no numbers, too
        value, count = Counter(given).most_common(1)[0]
        return value if 2 * count > len(given) else None
    return None if is_mixed else _middle(JuryResult(agreement.value), item, given)


def _middle(jury: JuryResult, item: ScoringItem, given: Sequence[ItemValue]) -> ItemValue:
    text = jury_text(item.with_jury(jury), [value.text or str(value.value) for value in given])
    if item.kind in WHOLE:
        return ItemValue(int(Decimal(text).to_integral_value(ROUND_HALF_UP)))
    return ItemValue(whole_part(text), text)
