"""Parameters of a node, checked: a wrong one is named with what it is and what it should be."""

import math
import os
from typing import List, Optional

import rospy


class BadParams(Exception):
    """Parameters that cannot be used; the text has a line for each."""


class Params:
    """Reads a node's private parameters and gathers what is wrong with them, to be told all at once."""

    def __init__(self) -> None:
        self._wrong: List[str] = []

    def text(self, name: str, default: Optional[str] = None) -> str:
        """A text that is not empty; without a default it must be given."""
        value = self._get(name, default)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            value = str(value)  # roslaunch and rosrun make numbers of 1234
        return self._check(name, value, isinstance(value, str) and value != "", "a text", default or "")

    def number(self, name: str, default: float, lowest: float = 0.0, highest: float = math.inf) -> float:
        """A finite number in a range."""
        value = self._get(name, default)
        fits = isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
        fits = fits and lowest <= value <= highest
        return float(self._check(name, value, fits, f"a number {_range(lowest, highest)}", default))

    def whole(self, name: str, default: int, lowest: int, highest: int) -> int:
        """A whole number in a range."""
        value = self._get(name, default)
        fits = isinstance(value, int) and not isinstance(value, bool) and lowest <= value <= highest
        return self._check(name, value, fits, f"a whole number {_range(lowest, highest)}", default)

    def flag(self, name: str, default: bool) -> bool:
        """True or false."""
        value = self._get(name, default)
        return self._check(name, value, isinstance(value, bool), "true or false", default)

    def choice(self, name: str, default: str, choices: List[str]) -> str:
        """One of some words."""
        value = self._get(name, default)
        return self._check(name, value, value in choices, "one of " + ", ".join(choices), default)

    def path(self, name: str, default: Optional[str] = None) -> str:
        """A path, with ~ and variables replaced; without a default it must be given."""
        value = self._get(name, default)
        path = self._check(name, value, isinstance(value, str) and value != "", "a path", default or ".")
        return os.path.abspath(os.path.expandvars(os.path.expanduser(path)))

    def done(self) -> None:
        """Raise `BadParams` if anything was wrong."""
        if self._wrong:
            raise BadParams("\n".join(self._wrong))

    def _get(self, name: str, default: object) -> object:
        try:
            return rospy.get_param("~" + name, default)
        except KeyError:
            return None

    def _check(self, name: str, value: object, fits: bool, expected: str, instead):
        if fits:
            return value
        found = "nothing" if value is None else repr(value)
        self._wrong.append(f"parameter {rospy.resolve_name('~' + name)}: found {found}, expected {expected}")
        return instead


def _range(lowest: float, highest: float) -> str:
    return f"of at least {lowest:g}" if math.isinf(highest) else f"from {lowest:g} to {highest:g}"
