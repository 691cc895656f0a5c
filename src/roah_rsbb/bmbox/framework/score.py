"""A module's score: values with units, declared before they are set."""

import json
import math
from typing import Dict, List, NamedTuple, Tuple, Union

from roah_rsbb.core.modules.messages import ScoreValue

Scalar = Union[None, bool, int, float, str]
# A value of the whole run by its name; one of several groups ("waypoint 2") by group and name.
Key = Union[str, Tuple[str, str]]


class Value(NamedTuple):
    """What a score value is."""

    desc: str  # for the referee
    unit: str = ""  # m, rad, s, or empty


class Score:
    """The values so far. Those of the whole run are there from the beginning, as null."""

    def __init__(self, whole: Dict[str, Value], each: Dict[str, Value]) -> None:
        """`whole`: values of the whole run by name; `each`: values that every group has."""
        self._whole, self._each = whole, each
        self._values: Dict[Tuple[str, str], Scalar] = {("", name): None for name in whole}

    def __setitem__(self, key: Key, value: Scalar) -> None:
        """Set a value: `score["reached"] = 2`, `score["waypoint 2", "time"] = 12.5`.

        KeyError for a name that was not declared, ValueError for what is no number, yes or no, or text.
        """
        group, name = _split(key)
        self._declared(group, name)
        if isinstance(value, float) and not math.isfinite(value):
            raise ValueError(f"score {name} cannot be {value}: what is not known is None")
        if not isinstance(value, (bool, int, float, str, type(None))):
            raise ValueError(f"score {name} cannot be {value!r}: a number, True, False, a text or None")
        self._values[group, name] = value

    def __getitem__(self, key: Key) -> Scalar:
        """The value set last; None: none yet. KeyError for a name that was not declared."""
        group, name = _split(key)
        self._declared(group, name)
        return self._values.get((group, name))

    def each(self, name: str) -> List[Scalar]:
        """The values of that name in all groups that have one, in the order in which they were first set."""
        return [value for (group, known), value in self._values.items() if group and known == name]

    def values(self) -> Tuple[ScoreValue, ...]:
        """All values, as they are sent and saved."""
        return tuple(
            ScoreValue(group, name, json.dumps(value), *reversed(self._declared(group, name)))
            for (group, name), value in self._values.items()
        )

    def _declared(self, group: str, name: str) -> Value:
        known = self._each if group else self._whole
        if name not in known:
            where = "EACH" if group else "SCORES"
            raise KeyError(f"no score '{name}' is declared in {where}: there are {', '.join(known) or 'none'}")
        return known[name]


def _split(key: Key) -> Tuple[str, str]:
    return ("", key) if isinstance(key, str) else key
