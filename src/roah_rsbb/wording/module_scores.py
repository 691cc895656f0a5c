"""A benchmarking module's scores as people read them: in panels, terminal, pages and exports.

Works on anything with the fields of ModuleScore; ROS is not imported.
"""

import json
import math
from typing import Any, Dict, Iterable, List, NamedTuple, Tuple

from roah_rsbb.wording.language import number, tr, tr_later
from roah_rsbb.wording.times import NOTHING

# The title of the scores that belong to the run as a whole.
WHOLE_RUN = tr_later("Whole run")
_WORDS = {True: tr_later("yes"), False: tr_later("no"), None: NOTHING}


class ScoreLine(NamedTuple):
    """One score: what it is, and its value with the unit."""

    name: str
    value: str


def readable(score: Any) -> ScoreLine:
    """Return one score, such as ("Distance error", "0.124 m")."""
    return ScoreLine(score.desc or score.name.replace("_", " "), _with_unit(_value(score.value), score.unit))


def by_group(scores: Iterable[Any]) -> List[Tuple[str, List[ScoreLine]]]:
    """Return all scores by group, in their order; those of the whole run come first."""
    groups: Dict[str, List[ScoreLine]] = {}
    for score in scores:
        groups.setdefault(score.group, []).append(readable(score))
    whole = [(tr(WHOLE_RUN), groups.pop(""))] if "" in groups else []
    return whole + list(groups.items())


def _value(text: str) -> str:
    try:
        value = json.loads(text)
    except ValueError:
        return text
    if value is None or isinstance(value, bool):
        return tr(_WORDS[value])
    if isinstance(value, float):
        # Adding 0.0 turns a rounded "-0.0" into "0.0".
        return f"{round(value, 3) + 0.0:.3f}".rstrip("0").rstrip(".") if math.isfinite(value) else str(value)
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def _with_unit(value: str, unit: str) -> str:
    return number(f"{value} {unit}" if unit and value != NOTHING else value)
