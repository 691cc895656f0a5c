"""Reads the files of a competition: errors that name file, line and remedy; texts; and the launch file as data.

An organiser corrects a file with a text editor. Each error therefore names the file and the line, what was found and
what was expected (docs/architecture.md, "Errors name the remedy"). All errors are reported together.
"""

import contextlib
import os
import stat
from contextvars import ContextVar
from typing import Any, Dict, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Tuple
from xml.parsers import expat

from roah_rsbb.wording.texts import nearest

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
        errors = list(dict.fromkeys(errors))  # two files may use a third one
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


# Enough for a schedule of ten thousand runs. PyYAML takes two to six seconds to read this much.
MAX_BYTES = 1_000_000

# What files contained when they were read, by path. They are not read again.
_KNOWN: ContextVar[Mapping[str, str]] = ContextVar("known")

# How files begin that are no text. UTF-32 is before UTF-16, which begins it.
_UTF_8 = "UTF-8: choose this encoding in the editor's 'save as'"
_AS_CSV = "plain text: open it in its program, and save a sheet as CSV (UTF-8)"
_OTHER_FILES = {
    b"\xff\xfe\0\0": ("UTF-32 text", _UTF_8), b"\0\0\xfe\xff": ("UTF-32 text", _UTF_8),
    b"\xff\xfe": ("UTF-16 text", _UTF_8), b"\xfe\xff": ("UTF-16 text", _UTF_8),
    b"PK\3\4": ("a file of a spreadsheet or office program (.xlsx, .ods), or an archive", _AS_CSV),
    b"\xd0\xcf\x11\xe0": ("a file of a spreadsheet or office program (.xls)", _AS_CSV),
}


class CannotRead(Exception):
    """The rest of the file cannot be read, e.g. after a syntax error. Whoever catches it reports it."""

    def __init__(self, place: Place, found: str, expected: str) -> None:
        super().__init__(found)
        self.error = (place, found, expected)


def read_text(path: str, report: Report, what: str) -> Optional[str]:
    """Read the text of a file up to `MAX_BYTES`. Return None after an error."""
    text = _KNOWN.get({}).get(path)
    try:
        return _decode(path, read_bytes(path, what) if text is None else text.encode("utf-8"))
    except CannotRead as error:
        report.error(*error.error)
        return None


@contextlib.contextmanager
def known(texts: Mapping[str, str]) -> Iterator[None]:
    """Let these paths have these texts, whatever is in their files now."""
    token = _KNOWN.set(texts)
    try:
        yield
    finally:
        _KNOWN.reset(token)


def is_known(path: str, beside: str) -> bool:
    """Whether a file that may be missing is there: among the known texts, if the one beside it is, else on the disk."""
    texts = _KNOWN.get({})
    return path in texts if beside in texts else path in texts or os.path.lexists(path)


def read_bytes(path: str, what: str) -> bytes:
    """Read a file up to `MAX_BYTES`. Raises `CannotRead`."""
    whole = Place(path, 0, 0)
    if not path:
        raise CannotRead(whole, "an empty file name", what)
    try:
        # Opening a pipe or a device could block forever.
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise CannotRead(whole, "a directory or a device", f"a file: {what}")
        with open(path, "rb") as file:
            data = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise CannotRead(whole, f"no file {quote(os.path.abspath(path))}", what + _neighbour(path)) from None
    except PermissionError:
        raise CannotRead(whole, "a file that the box may not read", f"{what}; see 'chmod' and 'chown'") from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        raise CannotRead(whole, f"something that cannot be read ({error})", f"a readable file: {what}") from None
    if len(data) > MAX_BYTES:
        raise CannotRead(whole, f"more than {MAX_BYTES // 1000} kB", f"{what}, which is much smaller")
    return data


def _neighbour(path: str) -> str:
    """Return the end of the message about a missing file: a similar name in its directory, if there is one."""
    folder, name = os.path.split(os.path.abspath(path))
    try:
        near = nearest(name, os.listdir(folder))
    except OSError:
        return f"; there is no directory {quote(folder)} either"
    return f": did you mean {quote(near)} there?" if near else ""


def _decode(path: str, data: bytes) -> str:
    for begin, (found, expected) in _OTHER_FILES.items():
        if data.startswith(begin):
            raise CannotRead(Place(path, 1, 1), found, expected)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start]
        place = Place(path, before.count(b"\n") + 1, error.start - before.rfind(b"\n"))
        raise CannotRead(place, "a character that is not UTF-8", _UTF_8) from None


# An element's name, its attributes, and its line.
Element = Tuple[str, Dict[str, str], int]


class LaunchArgument(NamedTuple):
    """An argument of a launch file, as it is written there."""

    default: str
    doc: str


def elements(report: Report, path: str) -> List[Element]:
    """Return all elements of a file; those before an error, which is in the report."""
    found: List[Element] = []
    text = read_text(path, report, "the launch file")
    if text is None:
        return found
    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda name, given: found.append((name, given, parser.CurrentLineNumber))
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        report.error(Place(path, error.lineno, error.offset + 1), f"invalid XML ({expat.ErrorString(error.code)})",
                     "each <tag> closed with </tag> or />, values in quotes, no -- within a comment")
    return found


def arguments(report: Report, path: str) -> Dict[str, LaunchArgument]:
    """Return the arguments of a file that have a default, by name; see `elements`."""
    return {given["name"]: LaunchArgument(given["default"], given.get("doc", ""))
            for name, given, _ in elements(report, path) if name == "arg" and {"name", "default"} <= given.keys()}
