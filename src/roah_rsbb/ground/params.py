"""A program's parameters, checked. An error names the parameter, its value and what was expected."""

import abc
import math
import os
from typing import Dict, List, Optional

# The value of a parameter without its file or folder.
NONE = "none"


class BadParams(Exception):
    """Invalid parameters; the text has a line for each."""


class Params(abc.ABC):
    """Reads parameters, wherever they come from. Collects all errors, to report them at once."""

    def __init__(self) -> None:
        self._wrong: List[str] = []

    def text(self, name: str, default: Optional[str] = None) -> str:
        """Return a text. It may be empty if the default is. Without a default, the parameter is required."""
        value = _as_text(self._get(name, default))
        fits = isinstance(value, str) and (value != "" or default == "")
        return self._check(name, value, fits, "a text", default or "")

    def secret(self, name: str) -> str:
        """Return a text that is not empty. No error shows its value."""
        value = _as_text(self._get(name, None))
        if isinstance(value, str) and value:
            return value
        self._wrong.append(f"parameter {self.full_name(name)}: expected a text")
        return ""

    def number(self, name: str, default: float, lowest: float = 0.0, highest: float = math.inf) -> float:
        """Return a finite number in a range."""
        value = self._plain(name, default)
        fits = isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
        fits = fits and lowest <= value <= highest
        return float(self._check(name, value, fits, f"a number {_range(lowest, highest)}", default))

    def whole(self, name: str, default: int, lowest: int, highest: int) -> int:
        """Return a whole number in a range."""
        value = self._plain(name, default)
        fits = isinstance(value, int) and not isinstance(value, bool) and lowest <= value <= highest
        return self._check(name, value, fits, f"a whole number {_range(lowest, highest)}", default)

    def flag(self, name: str, default: bool) -> bool:
        """Return True or False."""
        value = self._plain(name, default)
        return self._check(name, value, isinstance(value, bool), "true or false", default)

    def choice(self, name: str, default: str, choices: List[str]) -> str:
        """Return one of the words in `choices`."""
        value = self._get(name, default)
        return self._check(name, value, value in choices, "one of " + ", ".join(choices), default)

    def path(self, name: str, default: Optional[str] = None) -> str:
        """Return a path, with ~ and variables expanded. It may be empty if the default is. Without a default, the
        parameter is required."""
        value = self._get(name, default)
        if value == default == "":
            return ""
        path = self._check(name, value, isinstance(value, str) and value != "", "a path", default or ".")
        return os.path.abspath(os.path.expandvars(os.path.expanduser(path)))

    def path_or_none(self, name: str) -> str:
        """Return a path as `path` does; empty: the value is `NONE`, which is the default."""
        return "" if self.text(name, NONE) == NONE else self.path(name)

    def done(self) -> None:
        """Raise `BadParams` if there were any errors."""
        if self._wrong:
            raise BadParams("\n".join(self._wrong))

    @abc.abstractmethod
    def full_name(self, name: str) -> str:
        """Return how users call a parameter."""

    @abc.abstractmethod
    def _get(self, name: str, default: object) -> object:
        """Return the value of a parameter, its default if it is not set, or None if that cannot be said."""

    def _plain(self, name: str, default: object) -> object:
        """Return the value of a parameter that is a number or a flag. Override it if all values are texts."""
        return self._get(name, default)

    def _check(self, name: str, value: object, fits: bool, expected: str, instead):
        if fits:
            return value
        found = "nothing" if value is None else repr(value)
        self._wrong.append(f"parameter {self.full_name(name)}: found {found}, expected {expected}")
        return instead


class KnownParams(Params):
    """Parameters with these values, and defaults for all others."""

    def __init__(self, values: Dict[str, object]) -> None:
        super().__init__()
        self._values = values

    def full_name(self, name: str) -> str:
        """See `Params`."""
        return name

    def _get(self, name: str, default: object) -> object:
        return self._values.get(name, default)


def _as_text(value: object) -> object:
    """Return a number as a text: roslaunch and rosrun turn 1234 into a number."""
    return str(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else value


def _range(lowest: float, highest: float) -> str:
    return f"of at least {lowest:g}" if math.isinf(highest) else f"from {lowest:g} to {highest:g}"
