"""Reads YAML files as a tree that knows its line numbers, so that errors can name them.

It is stricter than YAML, because people write these files in a hurry. A key may occur only once in a map (PyYAML
silently takes the last one). Anchors, aliases and tags are errors, so a file cannot contain Python objects or a
"billion laughs". Whatever the file contains, the worst result is an error in the report. `yaml_fields` reads typed
values from the tree. No message shows the text of a tree that was read with `secret`: it contains passwords.
"""

import bisect
import re
from dataclasses import dataclass, field
from typing import Dict, List, NamedTuple, NoReturn, Optional, Tuple

import yaml

from roah_rsbb.rulebook.errors import CannotRead, ConfigErrors, Place, Report, line_list, quote, read_text

# Configuration files are at most seven levels deep.
MAX_DEPTH = 20

_LINE_END = re.compile("\r\n|\r|\n")
# libyaml takes these signs in places where PyYAML does not.
_READ_DIFFERENTLY = "\t?"


@dataclass(frozen=True)
class Node:
    """A part of a file. `place` is its beginning."""

    place: Place


@dataclass(frozen=True)
class Unusable(Node):
    """A part with an error that is already in the report. Do not report it again."""


@dataclass(frozen=True)
class Scalar(Node):
    """A single value, as text. Quotes and escapes are resolved."""

    text: str = field(repr=False)
    quoted: bool
    secret: bool


@dataclass(frozen=True)
class Sequence(Node):
    """The items of a sequence."""

    items: Tuple[Node, ...]


@dataclass(frozen=True)
class Mapping(Node):
    """The keys and values of a map in the file's order. Each key occurs once.

    `whole` is False if a pair could not be read or a key was repeated. A key that seems to be missing may be in that
    pair. `decided`: what was left to people and is chosen in it (`decisions`), without rows under it.
    """

    pairs: Tuple[Tuple[Scalar, Node], ...]
    whole: bool
    decided: Tuple[str, ...] = ()


class ErrorInWords(NamedTuple):
    """An error in words, and whether its place is the beginning of the construct or where the parser stopped."""

    at_begin: bool
    found: str
    expected: str


_QUOTES = ErrorInWords(
    True,
    "a text that begins with a character that has a meaning in YAML",
    "quotes around a text that begins with one of @ ` % * & ! | > [ ] { } , # or a quote",
)
# By the character where the parser stopped.
_STOPPED_AT = {
    "\t": ("a tab", "spaces: YAML does not allow tabs for indentation or between words"),
    "@": _QUOTES[1:],
    "`": _QUOTES[1:],
    "%": _QUOTES[1:],
    "-": ("a '- ' that cannot stand here",
          "each '- item' on a line of its own, under the others, below a line that ends with ':'"),
    "?": ("a '? ' in the middle of a line", "quotes around a text that contains '? '"),
}
_DIRECTIVE = ("a line that begins with '%'", "no YAML directives, or quotes around the text")
_SECOND_COLON = (
    "a second ': ' on the line", "one 'key: value' a line, and quotes around a text that contains ': '")
_COLON = (
    "a ': ' that cannot stand here: its line is indented deeper than the one above, or the one above is not "
    "'key: value'", "the keys of one map under each other, each with a colon and a space after it")
_AFTER_QUOTE = (
    "text after a closing quote",
    "a quote within a text doubled ('Granny''s'), or the other kind of quotes around it (\"Granny's\")")
_BACKSLASH = (
    "a backslash in double quotes before a character that makes no sense after it",
    "single quotes around a text with backslashes, or each backslash doubled")
_OPEN_QUOTE = ("a quote that is opened here and never closed", "a quote at the text's end, too")
_NO_VALUE = (
    "a comma, a bracket or another sign where a value should begin", f"a value, or {_QUOTES.expected}")
_NO_KEY = ("a line without 'key: value'", "a colon and a space after the key (a list item begins with '- ')")
_FLOW = {
    "[": ("a '[' without its ']', or a comma missing in between",
          "'[a, b, c]', and a pair of quotes around a text that contains [ ] { } , or ': '"),
    "{": ("a '{' without its '}', or a comma missing in between",
          "'{key: value, key: value}', and a pair of quotes around a text that contains [ ] { } , or ': '"),
}
_CLOSED = {
    "]": ("a ']' without its '['", "as many '[' as ']'"),
    "}": ("a '}' without its '{'", "as many '{' as '}'"),
}
_OTHER = (
    "a line that does not continue what stands above",
    "the keys of one map under each other, the '-' of one sequence under each other, and a closing quote for each "
    "opening one")


def explain(error: yaml.MarkedYAMLError, text: str, before: str) -> ErrorInWords:
    """Explain PyYAML's `error` to an organiser. `before` is the line up to where the parser stopped.

    The explanation depends only on the two places that PyYAML reports: the beginning of the construct, and where the
    parser stopped. It never contains text of the file, which may be a password.
    """
    stopped = text[error.problem_mark.index:][:1]
    begin = "" if error.context_mark is None else text[error.context_mark.index:][:1]
    is_scanner = isinstance(error, yaml.scanner.ScannerError)
    if begin == "%" or (stopped == "%" and not before):
        return ErrorInWords(begin == "%", *_DIRECTIVE)
    if begin in _FLOW:
        return ErrorInWords(True, *_FLOW[begin])
    if is_scanner and begin == '"' and "\\" in before[-2:]:
        return ErrorInWords(False, *_BACKSLASH)
    if is_scanner and begin in ("'", '"'):
        return ErrorInWords(True, *_OPEN_QUOTE)
    if begin and begin in "*&!|>":
        return _QUOTES
    if is_scanner and begin:
        return ErrorInWords(True, *_NO_KEY)
    if stopped == ":":
        return ErrorInWords(False, *(_SECOND_COLON if ": " in before else _COLON))
    if is_scanner and stopped in _STOPPED_AT:
        return ErrorInWords(False, *_STOPPED_AT[stopped])
    if before.rstrip().endswith(("'", '"')):
        return ErrorInWords(False, *_AFTER_QUOTE)
    if stopped in _CLOSED:
        return ErrorInWords(False, *_CLOSED[stopped])
    if stopped and stopped in ",[{":
        return ErrorInWords(False, *_NO_VALUE)
    return ErrorInWords(False, *_OTHER)


def read_yaml(path: str, report: Report, what: str, shape: str, secret: bool = False) -> Optional[Node]:
    """Read a file as a tree. Return None after an error that prevents this (missing, unreadable, not YAML, empty).

    `what` names the file in messages, e.g. "the schedule file (parameter schedule_file)". `shape` describes its
    content. Other errors are reported, and the parts that contain them become `Unusable`.
    """
    text = read_text(path, report, what)
    if text is None:
        return None
    quick = _tree_by_libyaml(path, text, shape, secret)
    if quick is not None:
        return quick
    try:
        return _Builder(path, text, report, secret).build(shape)
    except CannotRead as error:
        report.error(*error.error)
        return None


def _tree_by_libyaml(path: str, text: str, shape: str, secret: bool) -> Optional[Node]:
    """The tree of a file without errors, in a tenth of the time; None: there are errors, or PyYAML lacks libyaml.

    The other parser finds the errors again, so the messages are the same on each machine.
    """
    if not yaml.__with_libyaml__ or any(sign in text for sign in _READ_DIFFERENTLY):
        return None
    report = Report()
    try:
        tree = _QuickBuilder(path, text, report, secret).build(shape)
    except (CannotRead, ConfigErrors):
        return None
    return None if report.errors else tree


class _Builder:
    """Builds the tree from PyYAML's events. Events come one at a time, so the depth can be limited."""

    def __init__(self, path: str, text: str, report: Report, secret: bool) -> None:
        self._path = path
        self._text = text
        self._report = report
        self._secret = secret
        # PyYAML also counts U+2028 and similar characters as line ends. Editors do not.
        self._line_starts = [0] + [m.end() for m in _LINE_END.finditer(text) if m.end() < len(text)]
        self._last: Optional[yaml.Event] = None
        self._open_brackets: List[Place] = []
        self._loader = self._parser()

    def _parser(self) -> yaml.SafeLoader:
        try:
            return yaml.SafeLoader(self._text)
        except yaml.reader.ReaderError as error:
            place = self._place(error.position)
            raise CannotRead(place, "a control character", "text: delete it and type it again") from None

    def build(self, shape: str) -> Node:
        """Build the tree of the file's only document."""
        self._next()
        event = self._next()
        if isinstance(event, yaml.StreamEndEvent):
            found = "nothing but comments" if self._text.strip() else "an empty file"
            raise CannotRead(self._place(0), found, shape)
        node = self._node(self._next(), 0)
        self._next()
        event = self._next()
        if not isinstance(event, yaml.StreamEndEvent):
            raise CannotRead(self._at(event), "a second document after a '---' or '...' line", "no such line")
        return node

    def _next(self) -> yaml.Event:
        try:
            self._last = self._loader.get_event()
            return self._last
        except yaml.MarkedYAMLError as error:
            self._stop_at(error)
        except (yaml.YAMLError, ValueError, OverflowError):
            # PyYAML raises ValueError for invalid escapes and version numbers.
            place = self._place(self._loader.index)
            raise CannotRead(place, "an escape or a number that no program can read", "plain text") from None

    def _stop_at(self, error: yaml.MarkedYAMLError) -> NoReturn:
        if isinstance(self._last, yaml.ScalarEvent) and self._last.style in ("'", '"'):
            begin, end = self._at(self._last), self._place(self._last.end_mark.index)
            if end.line > begin.line:
                found = f"a quote that is opened here and closed only in line {end.line}"
                raise CannotRead(begin, found, "a quote at the text's end, too") from None
        if error.problem_mark.index >= len(self._text.rstrip()) and self._open_brackets:
            found = "a '[' or '{' that is opened here and never closed"
            raise CannotRead(self._open_brackets[-1], found, "a ']' or '}' at its end") from None
        stop = self._place(error.problem_mark.index)
        start = self._line_starts[stop.line - 1]
        why = explain(error, self._text, self._text[start : start + stop.column - 1])
        mark = (error.context_mark if why.at_begin else None) or error.problem_mark
        place = self._place(mark.index)
        also = self._other_tabs(place.line) if self._text.startswith("\t", mark.index) else ""
        raise CannotRead(place, why.found + also, why.expected) from None

    def _other_tabs(self, line: int) -> str:
        """List the other lines that are indented with a tab: it is rarely only one."""
        lines = enumerate(_LINE_END.split(self._text), start=1)
        others = [number for number, text in lines if number != line and re.match(" *\t", text)]
        if not others:
            return ""
        return f" (and at the beginning of line {line_list(others)})"

    def _place(self, index: int) -> Place:
        line = bisect.bisect_right(self._line_starts, index) - 1
        return Place(self._path, line + 1, index - self._line_starts[line] + 1)

    def _at(self, event: yaml.Event) -> Place:
        return self._place(event.start_mark.index)

    def _node(self, event: yaml.Event, depth: int) -> Node:
        place = self._at(event)
        if depth > MAX_DEPTH:
            raise CannotRead(place, f"{MAX_DEPTH} levels of nesting", "far fewer: look for repeated [ or {")
        if isinstance(event, yaml.AliasEvent):
            return self._unusable(place, "*", "an alias")
        if isinstance(event, yaml.ScalarEvent):
            node = self._scalar(event, place)
        else:
            node = self._collection(event, place, depth)
        if event.anchor is not None:
            return self._unusable(place, "&", "an anchor")
        if event.tag is not None:
            return self._unusable(place, "!", "a tag")
        return node

    def _unusable(self, place: Place, mark: str, name: str) -> Unusable:
        self._report.error(
            place,
            f"a '{mark}', which in YAML begins {name}",
            f"the value itself, or quotes around a text that begins with '{mark}'",
        )
        return Unusable(place)

    def _scalar(self, event: yaml.ScalarEvent, place: Place) -> Node:
        if any("\ud800" <= c <= "\udfff" for c in event.value):
            self._report.error(place, "an escape (\\u...) that is not a character", "the character itself")
            return Unusable(place)
        return Scalar(place, event.value, not event.implicit[0], self._secret)

    def _collection(self, event: yaml.CollectionStartEvent, place: Place, depth: int) -> Node:
        read = self._sequence if isinstance(event, yaml.SequenceStartEvent) else self._mapping
        if not event.flow_style:
            return read(place, depth)
        self._open_brackets.append(place)
        node = read(place, depth)
        self._open_brackets.pop()
        return node

    def _sequence(self, place: Place, depth: int) -> Sequence:
        items: List[Node] = []
        event = self._next()
        while not isinstance(event, yaml.SequenceEndEvent):
            items.append(self._node(event, depth + 1))
            event = self._next()
        return Sequence(place, tuple(items))

    def _mapping(self, place: Place, depth: int) -> Mapping:
        pairs: Dict[str, Tuple[Scalar, Node]] = {}
        again: List[Scalar] = []
        whole = True
        event = self._next()
        while not isinstance(event, yaml.MappingEndEvent):
            key = self._node(event, depth + 1)
            value = self._node(self._next(), depth + 1)
            if not isinstance(key, Scalar):
                whole = False
                if not isinstance(key, Unusable):
                    self._report.error(key.place, "a map or a sequence as key", "a text, e.g. 'name: value'")
            elif key.text in pairs:
                again.append(key)
                # It is unclear which value belongs to which key.
                pairs[key.text] = (pairs[key.text][0], Unusable(value.place))
            else:
                pairs[key.text] = (key, value)
            event = self._next()
        self._report_again(pairs, again)
        return Mapping(place, tuple(pairs.values()), whole and not again)

    def _report_again(self, pairs: Dict[str, Tuple[Scalar, Node]], again: List[Scalar]) -> None:
        """Report the keys that are repeated in a map."""
        begin = next(iter(pairs), None)
        for key in again:
            name = "the same key" if self._secret else f"the key {quote(key.text)}"
            expected = f"each key once: it is already in line {pairs[key.text][0].place.line}"
            if key.text == begin and not self._secret:
                # Two items became one. Do not report their other keys, too.
                self._report.error(key.place, f"{name} again", f"{expected} (a new item begins with '- ')")
                break
            self._report.error(key.place, f"{name} again", expected)


class _QuickBuilder(_Builder):
    """Makes the same tree from libyaml's events, but knows neither the place nor the cause of a syntax error."""

    def _parser(self) -> "yaml.CSafeLoader":
        return yaml.CSafeLoader(self._text)

    def _next(self) -> yaml.Event:
        try:
            return self._loader.get_event()
        except (yaml.YAMLError, ValueError):
            raise CannotRead(Place(self._path, 0, 0), "a syntax error", "YAML") from None

    def _scalar(self, event: yaml.ScalarEvent, place: Place) -> Node:
        if event.implicit[0] and not event.value:  # in brackets, libyaml reports another place
            raise CannotRead(place, "nothing", "a value")
        return super()._scalar(event, place)
