"""Errors in configuration files: collected from all of them, then reported at once.

An organiser corrects a file with a text editor. Each error therefore names the file and the line, what was found and
what was expected (docs/architecture.md, "Errors name the remedy"). All errors are reported together.
"""

from typing import Any, Dict, Iterable, List, NamedTuple, Optional

# Nobody reads more. The limit keeps the report short and reading fast, even for a malicious file.
MAX_ERRORS = 1000

_LONGEST_EXCERPT = 60
_LINES_SHOWN = 10


class Place(NamedTuple):
    """A position in a file. Line and column count from 1. Line 0 is the file as a whole."""

    file: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}" if self.line else self.file


class ConfigError(NamedTuple):
    """One error, as an organiser reads it. `line` and `column` count from 1.

    Both are 0 if the error concerns the whole file: it is missing, unreadable or too large.
    """

    file: str
    line: int
    column: int
    found: str
    expected: str

    def __str__(self) -> str:
        place = Place(self.file, self.line, self.column)
        return f"{place}: found {self.found}; expected {self.expected}"


class ConfigErrors(Exception):
    """The configuration cannot be used. `errors` holds every error, in the order of files and lines.

    `str()` is the whole report, one error a line. It contains no passwords.
    """

    def __init__(self, errors: List[ConfigError]) -> None:
        lines = [str(error) for error in errors]
        if len(errors) >= MAX_ERRORS:
            lines.append(f"... and perhaps more: reading ended at {MAX_ERRORS} errors")
        super().__init__("\n".join(lines))
        self.errors = errors


class Report:
    """Collects errors and warnings while files are read and checked."""

    def __init__(self) -> None:
        self.errors: List[ConfigError] = []
        self.warnings: List[str] = []

    def error(self, place: Place, found: str, expected: str) -> Optional[Any]:
        """Add an error, and return None for the value. Raises `ConfigErrors` when there are `MAX_ERRORS` of them."""
        self.errors.append(ConfigError(place.file, place.line, place.column, found, expected))
        if len(self.errors) >= MAX_ERRORS:
            self.raise_errors()
        return None

    def once(self, seen: Dict[Any, Place], thing: Any, place: Place, found: str, expected: str) -> None:
        """Add an error if `thing` is already in `seen`, which holds the place of its first occurrence."""
        first = seen.setdefault(thing, place)
        if first is not place:
            self.error(place, found, f"{expected}: it is already in line {first.line}")

    def warn(self, place: Place, text: str) -> None:
        """Add a warning about something that is allowed but probably a mistake."""
        self.warnings.append(f"{place}: {text}")

    def raise_errors(self) -> None:
        """Raise `ConfigErrors` if there are any errors, sorted by line within each file."""
        if not self.errors:
            return
        files = list(dict.fromkeys(error.file for error in self.errors))
        ordered = sorted(self.errors, key=lambda error: (files.index(error.file), error.line, error.column))
        raise ConfigErrors(ordered)


def quote(text: str) -> str:
    """Quote text of a file for a message: in one line, shortened if it is long."""
    shown = text if len(text) <= _LONGEST_EXCERPT else text[: _LONGEST_EXCERPT - 3] + "..."
    visible = (c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in shown)
    return "'" + "".join(visible) + "'"


def line_list(lines: List[int]) -> str:
    """Return numbers as a text: ``3, 7 and 12``, or if there are many ``3, 7, ... and 90 more``."""
    shown = [str(line) for line in lines]
    if len(shown) > _LINES_SHOWN:
        shown[_LINES_SHOWN:] = [f"{len(shown) - _LINES_SHOWN} more"]
    return listing(shown)


def listing(words: Iterable[str]) -> str:
    """Return words as a text: ``a, b and c``."""
    words = list(words)
    return ", ".join(words[:-1]) + " and " + words[-1] if len(words) > 1 else "".join(words)
