"""Reads typed values from a `yaml_lines` tree, and reports errors.

Each function takes a node, its name in messages, and the allowed values. It returns None after an error, which it has
added to the report. Given None or an `Unusable`, it returns None without a further error. A caller can therefore read
all its values first; each None among them is already in the report.
"""

import datetime
import math
import re
import unicodedata
from decimal import Decimal
from typing import Any, Callable, Dict, Optional, Tuple, TypeVar, Union

import yaml

from roah_rsbb.rulebook.errors import Report, listing, quote
from roah_rsbb.rulebook.yaml_lines import Mapping, Node, Scalar, Sequence, Unusable
from roah_rsbb.wording.texts import did_you_mean, nearest

T = TypeVar("T")

_DECIMAL = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
_EXACT = re.compile(r"[+-]?([0-9]{1,12}\.?[0-9]{0,3}|\.[0-9]{1,3})")
_INTEGER = re.compile(r"[+-]?[0-9]{1,18}")
_TIME = re.compile(
    r"([0-9]{4})-([0-9]{1,2})-([0-9]{1,2})"
    r"(?:(?:[Tt]|[ \t]+)([0-9]{1,2}):([0-9]{2})(?::([0-9]{2})(\.[0-9]*)?)?"
    r"(?:[ \t]*(?:[Zz]|([+-])([0-9]{1,2}):?([0-9]{2})?))?)?"
)
# `time` on the ROS interface: uint32 seconds since 1970.
_LAST_SECOND = 2**32 - 1

YES_NO = {"yes": True, "no": False}

# Control characters, those without width or that turn the direction of text, line and paragraph separators.
_NOT_IN_A_LINE = ("Cc", "Cf", "Zl", "Zp")
# Names in some languages need those that join letters, or keep them apart.
_JOINERS = "\u200c\u200d"

# What PyYAML, and so any other program that reads the file, makes of an unquoted value.
_RESOLVER = yaml.resolver.Resolver()
_KINDS = {
    "tag:yaml.org,2002:int": "number",
    "tag:yaml.org,2002:float": "number",
    "tag:yaml.org,2002:bool": "yes-or-no value",
    "tag:yaml.org,2002:timestamp": "date",
    "tag:yaml.org,2002:null": "null value",
}


def _tag(scalar: Scalar) -> str:
    return str(_RESOLVER.resolve(yaml.ScalarNode, scalar.text, (not scalar.quoted, scalar.quoted)))


def describe(node: Node) -> str:
    """Describe a node for "found ...". Only the type and length of a secret are shown."""
    if isinstance(node, Mapping):
        return "a map ('key: value')"
    if not isinstance(node, Scalar):
        return "a sequence ('- item', or [a, b])"
    if not node.text:
        return "an empty text" if node.quoted else "nothing"
    tag = _tag(node)
    kind = _KINDS.get(tag, "text")
    if node.secret:
        return f"a {kind} of {len(node.text)} characters"
    if _DECIMAL.fullmatch(node.text):
        return f"the quoted text {quote(node.text)}" if node.quoted else f"the number {quote(node.text)}"
    if kind == "text":
        return f"the text {quote(node.text)}"
    if kind == "date":
        return f"the date {quote(node.text)}"
    return f"{quote(node.text)} (to YAML, a {kind})"


def _wrong(report: Report, node: Optional[Node], what: str, expected: str) -> Optional[Any]:
    if node is None or isinstance(node, Unusable):
        return None
    return report.error(node.place, f"{describe(node)} as {what}", expected)


def text(report: Report, node: Optional[Node], what: str, max_bytes: Optional[int] = None) -> Optional[str]:
    """Read one line of text: not empty, no spaces at either end, and at most `max_bytes` bytes of UTF-8."""
    if not isinstance(node, Scalar):
        return _wrong(report, node, what, "a text; one that begins with [ or { needs quotes")
    if not node.text:
        return _wrong(report, node, what, "a text that is not empty")
    if _tag(node) in _KINDS:
        return _wrong(report, node, what, "a text: put it in quotes")
    if any(unicodedata.category(c) in _NOT_IN_A_LINE and c not in _JOINERS for c in node.text):
        return _wrong(report, node, what, "a text of one line, without tabs and control characters, also without those "
                      "that have no width or turn the direction of text")
    if node.text != node.text.strip():
        return _wrong(report, node, what, "a text that neither begins nor ends with a space")
    size = len(node.text.encode("utf-8"))
    if max_bytes is not None and size > max_bytes:
        return _wrong(report, node, what, f"a text of at most {max_bytes} bytes; it has {size}")
    return node.text


def choice(
    report: Report, node: Optional[Node], what: str, choices: Tuple[str, ...], expected: str
) -> Optional[str]:
    """Read one of `choices`. `expected` describes them, e.g. "a benchmark code"."""
    word = node.text if isinstance(node, Scalar) else ""
    if word in choices:
        return word
    return _wrong(report, node, what, expected + (did_you_mean(word, choices) if choices else ""))


def one_of(report: Report, node: Optional[Node], what: str, words: Dict[str, T], expected: str) -> Optional[T]:
    """Read one of these words, and return what it stands for."""
    found = choice(report, node, what, tuple(words), expected)
    return None if found is None else words[found]


def _number_shape(unit: str, above: Optional[float], least: Optional[float], most: Optional[float]) -> str:
    low = f"above {above:g}" if above is not None else f"at least {least:g}" if least is not None else ""
    high = f"at most {most:g}" if most is not None else ""
    bounds = " and ".join(filter(None, [low, high]))
    return " ".join(filter(None, ["a number", f"of {unit}" if unit else "", bounds]))


def number(
    report: Report,
    node: Optional[Node],
    what: str,
    unit: str = "",
    above: Optional[float] = None,
    least: Optional[float] = None,
    most: Optional[float] = None,
    infinity: str = "",
) -> Optional[float]:
    """Read a decimal number above `above` (or from `least`) up to `most`. `unit` is e.g. "seconds".

    `infinity`: a text that stands for infinity; empty: only finite numbers are valid.
    """
    if infinity and isinstance(node, Scalar) and node.text == infinity:
        return math.inf
    shape, instead = _number_shape(unit, above, least, most), f"; or '{infinity}'" if infinity else ""
    if not isinstance(node, Scalar) or not _DECIMAL.fullmatch(node.text):
        return _wrong(report, node, what, f"{shape}: digits only, '.' before decimals{instead}")
    if node.quoted:
        return _wrong(report, node, what, f"{shape}: remove the quotes")
    value = float(node.text)
    low = (above is None or value > above) and (least is None or value >= least)
    if not (low and (most is None or value <= most) and math.isfinite(value)):
        return _wrong(report, node, what, shape + instead)
    return value


def exact(
    report: Report, node: Optional[Node], what: str, least: Union[int, Decimal], most: Union[int, Decimal]
) -> Optional[Decimal]:
    """Read a number with at most three decimals from `least` to `most`, which is used in exact sums."""
    shape = f"a number from {least} to {most} with at most 3 decimals"
    value = _unquoted(report, node, what, shape, _EXACT, Decimal)
    return value if value is None or least <= value <= most else _wrong(report, node, what, shape)


def integer(report: Report, node: Optional[Node], what: str, least: int, most: int) -> Optional[int]:
    """Read a whole decimal number from `least` to `most`."""
    shape = f"a whole number from {least} to {most}"
    value = _unquoted(report, node, what, shape, _INTEGER, int)
    if value is not None and least <= value <= most:
        if isinstance(node, Scalar) and node.text.lstrip("+-") != str(abs(value)) and value > 7:
            report.warn(node.place, f"{what} {node.text} is {value} here, but another number for programs that take a "
                        f"leading 0 for octal: write {value}")
        return value
    return value if value is None else _wrong(report, node, what, shape)


def _unquoted(
    report: Report, node: Optional[Node], what: str, shape: str, pattern: "re.Pattern[str]", read: Callable[[str], T]
) -> Optional[T]:
    """Read a value that has this pattern and no quotes; `shape` describes it."""
    if not isinstance(node, Scalar) or not pattern.fullmatch(node.text):
        return _wrong(report, node, what, shape)
    if node.quoted:
        return _wrong(report, node, what, shape + ": remove the quotes")
    return read(node.text)


def utc_time(report: Report, node: Optional[Node], what: str) -> Optional[float]:
    """Read a date, with or without a time of day, as UTC seconds since 1970.

    The value may be quoted. Without a time zone it is UTC; with one ("+01:00") it is converted.
    """
    found = _TIME.fullmatch(node.text) if isinstance(node, Scalar) else None
    if found is None:
        return _wrong(report, node, what, "a date and time in UTC such as 2015-12-31 14:30:00")
    try:
        seconds = _utc_seconds(found)
    except (ValueError, OverflowError):
        return _wrong(report, node, what, "an existing day and time of day, such as 2015-12-31 14:30:00")
    if not 0 <= seconds <= _LAST_SECOND:
        return _wrong(report, node, what, "a date from 1970 to 2105")
    return seconds


def _utc_seconds(found: "re.Match[str]") -> float:
    year, month, day, hour, minute, second = (int(part or 0) for part in found.group(1, 2, 3, 4, 5, 6))
    sign, hours, minutes = found.group(8, 9, 10)
    offset = datetime.timedelta(hours=int(hours or 0), minutes=int(minutes or 0))
    if offset >= datetime.timedelta(days=1) or int(minutes or 0) >= 60:
        raise ValueError("no such time zone")
    local = datetime.datetime(year, month, day, hour, minute, second, tzinfo=datetime.timezone.utc)
    return (local + (offset if sign == "-" else -offset)).timestamp() + float("0" + (found.group(7) or ""))


def sequence(
    report: Report, node: Optional[Node], what: str, shape: str
) -> Optional[Tuple[Node, ...]]:
    """Return the items of a sequence that is not empty. `shape` describes the items, e.g. "runs, '- {run: 1}'"."""
    if not isinstance(node, Sequence):
        return _wrong(report, node, what, f"a sequence of {shape}")
    if not node.items:
        return report.error(node.place, f"an empty sequence as {what}", f"a sequence of {shape}")
    return node.items


def all_of(
    report: Report, node: Optional[Node], what: str, shape: str, read: Callable[[Node], Optional[T]]
) -> Tuple[T, ...]:
    """Return what `read` makes of the items of a sequence, without those with an error."""
    return tuple(found for found in map(read, sequence(report, node, what, shape) or ()) if found is not None)


def _word(key: Scalar) -> str:
    """Return the text of an unknown key without what follows a colon, as in ``run:1``."""
    return key.text.split(":")[0]


def _why_no_value(key: Scalar, value: Node) -> str:
    """Explain why an unknown key without a value may not be a key at all, as in ``{run:1, desc: Hits, or damages}``."""
    if not isinstance(value, Scalar) or value.text or value.quoted:
        return ""
    return " (a space after the colon)" if ":" in key.text else " (a text with a comma needs quotes)"


def fields(
    report: Report,
    node: Optional[Node],
    what: str,
    required: Dict[str, str],
    optional: Dict[str, str],
) -> Optional[Dict[str, Node]]:
    """Return the values of a map by key. Missing keys are missing in the result, too.

    `what` is e.g. "a benchmark". `required` and `optional` map each known key to an example of its value.
    """
    if not isinstance(node, Mapping):
        shape = ", ".join(f"{key}: {example}" for key, example in required.items())
        return _wrong(report, node, what, f"a map '{shape or '{}'}'")
    known = {**required, **optional}
    found = {key.text: value for key, value in node.pairs if key.text in known}
    unknown = [(key, value) for key, value in node.pairs if key.text not in known]
    for key, value in unknown:
        if not isinstance(value, Unusable):
            expected = f"a key of {what}{did_you_mean(_word(key), known)}{_why_no_value(key, value)}"
            report.error(key.place, f"the unknown key {quote(key.text)} in {what}", expected)
    # Report a misspelt key once, not also as missing. A pair that could not be read may be the missing one.
    misspelt = {nearest(_word(key), known) for key, _ in unknown}
    missing = [key for key in required if key not in found and key not in misspelt]
    if missing and node.whole and not any(isinstance(value, Unusable) for _, value in unknown):
        examples = listing(f"'{key}: {required[key]}'" for key in missing)
        report.error(node.place, f"{what} without {listing(missing)}", f"something like {examples}")
    return found
