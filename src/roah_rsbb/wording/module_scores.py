"""A benchmarking module's score as people read it: in the panels, in the terminal.

Works on anything with the fields of ModuleScore (ROS interface, new): no ROS is needed.
"""

import json
import math
from typing import Dict, Iterable, List, NamedTuple, Tuple

# What stands for a value that there is none of yet.
NONE_YET = "–"
# Of the run as a whole.
WHOLE_RUN = "Whole run"
_WORDS = {True: "yes", False: "no", None: NONE_YET}


class Line(NamedTuple):
    """One value: what it is, and the value with its unit."""

    name: str
    value: str


def readable(score) -> Line:
    """One score, such as ("Distance error", "0.124 m")."""
    return Line(score.desc or score.name.replace("_", " "), _with_unit(_value(score.value), score.unit))


def by_group(scores: Iterable) -> List[Tuple[str, List[Line]]]:
    """All scores, group by group in the order in which they came; those of the whole run first."""
    groups: Dict[str, List[Line]] = {}
    for score in scores:
        groups.setdefault(score.group, []).append(readable(score))
    whole = [(WHOLE_RUN, groups.pop(""))] if "" in groups else []
    return whole + list(groups.items())


def _value(text: str) -> str:
    try:
        value = json.loads(text)
    except ValueError:
        return text
    if value is None or isinstance(value, bool):
        return _WORDS[value]
    if isinstance(value, float):
        # "+ 0.0" makes a small negative number no "-0".
        return f"{round(value, 3) + 0.0:.3f}".rstrip("0").rstrip(".") if math.isfinite(value) else str(value)
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def _with_unit(value: str, unit: str) -> str:
    return f"{value} {unit}" if unit and value != NONE_YET else value
