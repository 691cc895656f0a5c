"""Reads results of robots safely: no input can do harm or take much time.

A result is YAML (docs/protocol.md, "Goals and results") from an unknown robot. A module declares what it expects.
Any other result is rejected, with a reason for the referee.
"""

import keyword
import math
import re
from types import SimpleNamespace
from typing import Any, Callable, Dict, List, Optional, Tuple, Union

import yaml

# Longest result in characters. A robot's datagram has space for less than 1000.
MAX_RESULT = 2000
MAX_DEPTH = 5
# Limits brackets, commas, colons and so on: PyYAML takes a long time for many of them.
MAX_SIGNS = 100
_SIGNS = "[{,:-?\n"
_SHOWN = 60


class BadResult(Exception):
    """The result cannot be read. The text says what was found and what was expected."""


# What a value must be: `str`, `float` (finite), `int`, `bool`, or a list of one of them, such as `[float]`.
Kind = Union[type, List[type]]


def read_record(text: str, shape: Dict[str, Kind]) -> SimpleNamespace:
    """Read a map with at least the keys of `shape`; raises BadResult.

    `read_record("{class: mug, x: 1}", {"class": str, "x": float})` has the attributes class_ and x: Python keywords
    get an underscore.
    """
    expected = "{" + ", ".join(shape) + "}"
    found = _plain(text)
    if not isinstance(found, dict):
        raise BadResult(f"the result is {_shown(text)}: expected {expected}")
    missing = [key for key in shape if key not in found]
    if missing:
        raise BadResult(f"the result {_shown(text)} has no {', '.join(missing)}: expected {expected}")
    read = {key: _value(key, found[key], kind) for key, kind in shape.items()}
    return SimpleNamespace(**{key + "_" * keyword.iskeyword(key): value for key, value in read.items()})


def _value(key: str, found: Any, kind: Kind) -> Any:
    if isinstance(kind, list):
        if not isinstance(found, list):
            raise BadResult(f"{key} of the result is a single value or a map: expected a list")
        return [_value(f"item {number} of {key}", item, kind[0]) for number, item in enumerate(found, 1)]
    if not isinstance(found, str):
        raise BadResult(f"{key} of the result is a list or a map: expected one value")
    value, expected = _READERS[kind](found)
    if value is None:
        raise BadResult(f"{key} of the result is {_shown(found)}: expected {expected}")
    return value


def _number(text: str) -> Optional[float]:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


_WHOLE = re.compile("[+-]?[0-9]{1,18}")
# For each kind, a function from a text to its value (None: the text is not of this kind) and to what is expected.
_READERS: Dict[type, Callable[[str], Tuple[Any, str]]] = {
    str: lambda text: (text, "a text"),
    float: lambda text: (_number(text), "a number"),
    int: lambda text: (int(text) if _WHOLE.fullmatch(text) else None, "a whole number"),
    bool: lambda text: ({"true": True, "false": False}.get(text.lower()), "true or false"),
}


def _plain(text: str) -> Any:
    """Parse YAML, leaving every scalar as text; raises BadResult."""
    if len(text) > MAX_RESULT:
        raise BadResult(f"the result has {len(text)} characters: at most {MAX_RESULT} are read")
    if sum(map(text.count, _SIGNS)) > MAX_SIGNS:
        raise BadResult(f"the result {_shown(text)} has too many parts: expected a few keys and values")
    try:
        events = list(_safe_events(text))
    except (yaml.YAMLError, ValueError, OverflowError) as error:  # the last two come from invalid escapes
        raise BadResult(f"the result {_shown(text)} is not valid YAML: {str(error).splitlines()[0]}") from None
    if not events:
        raise BadResult("the result is empty")
    return _build(events, 0)[0]


def _safe_events(text: str) -> List[yaml.Event]:
    """Parse a text into events. Rejects anchors and tags, which can create huge, recursive or arbitrary objects."""
    events = []
    depth = 0
    for event in yaml.parse(text, Loader=yaml.SafeLoader):
        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None) is not None:
            raise BadResult("the result has an anchor or alias (&, *): put texts in quotes")
        if getattr(event, "tag", None) not in (None, "!"):
            raise BadResult("the result has a tag (!): put texts in quotes")
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
        if depth > MAX_DEPTH:
            raise BadResult(f"the result is more than {MAX_DEPTH} levels deep")
        if isinstance(event, yaml.DocumentStartEvent) and events:
            raise BadResult("the result contains several documents: expected one")
        if isinstance(event, (yaml.NodeEvent, yaml.CollectionEndEvent)):
            events.append(event)
    return events


def _build(events: List[yaml.Event], at: int) -> Tuple[Any, int]:
    """Build the value that begins at an event; returns it and the index of the next event."""
    event = events[at]
    at += 1
    if isinstance(event, yaml.ScalarEvent):
        return event.value, at
    items = []
    while not isinstance(events[at], yaml.CollectionEndEvent):
        item, at = _build(events, at)
        items.append(item)
    if isinstance(event, yaml.SequenceStartEvent):
        return items, at + 1
    keys, values = items[::2], items[1::2]
    return {key: value for key, value in zip(keys, values) if isinstance(key, str)}, at + 1


def _shown(text: str) -> str:
    shown = repr(text if len(text) <= _SHOWN else text[:_SHOWN - 3] + "...")
    # An unprintable character takes up to ten characters.
    return shown if len(shown) <= 2 * _SHOWN else shown[:2 * _SHOWN] + "..."
