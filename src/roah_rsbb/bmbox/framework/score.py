"""A module's score: values with units, which a module declares before it sets them."""

import json
import math
from typing import Dict, List, NamedTuple, Tuple, Union

from roah_rsbb.model.modules import ScoreValue

Scalar = Union[None, bool, int, float, str]
# A value of the whole run has a name; a value of a group ("waypoint 2") has group and name.
Key = Union[str, Tuple[str, str]]


class Value(NamedTuple):
    """The declaration of a score value."""

    desc: str  # for the referee
    unit: str = ""  # m, rad, s, or empty


class Score:
    """The present values. Those of the whole run exist from the beginning, as null."""

    def __init__(self, whole: Dict[str, Value], each: Dict[str, Value]) -> None:
        """`whole`: values of the whole run by name; `each`: values that every group has."""
        self._whole, self._each = whole, each
        self._values: Dict[Tuple[str, str], Scalar] = {}
        # The same values as they are sent, several times a second.
        self._sent: Dict[Tuple[str, str], ScoreValue] = {}
        for name in whole:
            self[name] = None

    def __setitem__(self, key: Key, value: Scalar) -> None:
        """Set a value: `score["reached"] = 2`, `score["waypoint 2", "time"] = 12.5`.

        Raises KeyError for an undeclared name, ValueError for an unsupported value.
        """
        group, name = _split(key)
        declared = self._declared(group, name)
        if isinstance(value, float) and not math.isfinite(value):
            raise ValueError(f"score {name} cannot be {value}: use None for an unknown value")
        if not isinstance(value, (bool, int, float, str, type(None))):
            raise ValueError(f"score {name} cannot be {value!r}: use a number, True, False, a text or None")
        self._values[group, name] = value
        self._sent[group, name] = ScoreValue(group, name, json.dumps(value), declared.unit, declared.desc)

    def __getitem__(self, key: Key) -> Scalar:
        """The latest value; None before it is set. Raises KeyError for an undeclared name."""
        group, name = _split(key)
        self._declared(group, name)
        return self._values.get((group, name))

    def each(self, name: str) -> List[Scalar]:
        """The values of this name in all groups that have it, in the order in which they were first set."""
        return [value for (group, known), value in self._values.items() if group and known == name]

    def values(self) -> Tuple[ScoreValue, ...]:
        """All values in the form in which they are sent and saved."""
        return tuple(self._sent.values())

    def _declared(self, group: str, name: str) -> Value:
        known = self._each if group else self._whole
        if name not in known:
            where = "EACH" if group else "SCORES"
            raise KeyError(f"score '{name}' is not declared in {where}, which has {', '.join(known) or 'none'}")
        return known[name]


def _split(key: Key) -> Tuple[str, str]:
    return ("", key) if isinstance(key, str) else key
