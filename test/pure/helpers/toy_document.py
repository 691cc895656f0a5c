"""A small document of the same shape as that of the box, and random sequences of its values."""

import enum
from dataclasses import dataclass
from typing import Any, Dict, Mapping, NamedTuple, Optional, Tuple

from hypothesis import strategies as st

from roah_rsbb.model.fields import Field, Number, TypedText
from roah_rsbb.model.reason import Reason, say

LOW = say("{robot} has {number} %")
PLAIN = say("The robot is silent")


class Light(enum.Enum):
    """A property of a zone."""

    RED = "red"
    GREEN = "green"


@dataclass(frozen=True)
class Robot:
    """A robot of a zone."""

    name: str
    charge: Optional[float] = None
    why: Reason = PLAIN


class Zone(NamedTuple):
    """An entry of a section."""

    name: str
    light: Light = Light.RED
    count: int = 0
    is_open: bool = False
    log: str = ""
    robots: Tuple[Robot, ...] = ()
    why: Tuple[Reason, ...] = ()
    pose: Tuple[float, float] = (0.0, 0.0)
    fields: Tuple[Field, ...] = ()
    marks: Mapping[str, int] = {}
    answer: Any = None


class Box(NamedTuple):
    """A section."""

    event: str = ""
    warnings: Tuple[Reason, ...] = ()


class Result(NamedTuple):
    """An item of a section."""

    team: str
    points: int = 0


class Toy(NamedTuple):
    """The document."""

    box: Box = Box()
    zones: Dict[str, Zone] = {}
    results: Tuple[Result, ...] = ()


_TEXTS = st.text("aä\ud800\n", max_size=4)
_REASONS = st.one_of(
    st.just(PLAIN), st.builds(lambda robot, number: LOW(robot=robot, number=number), _TEXTS, st.integers(0, 9)),
    st.just(LOW(robot=PLAIN, number=1)))
_ROBOTS = st.builds(Robot, _TEXTS, st.none() | st.floats(-9, 9), _REASONS)
_FIELDS = st.sampled_from([TypedText("reason", say("Reason")), Number("seconds", say("How long"), True, 1, 600, "s")])
ZONES = st.builds(
    Zone, _TEXTS, st.sampled_from(Light), st.integers(0, 3), st.booleans(), st.text("ab\n", max_size=100),
    st.lists(_ROBOTS, max_size=2).map(tuple), st.lists(_REASONS, max_size=2).map(tuple),
    st.tuples(st.floats(-9, 9), st.floats(-9, 9)), st.lists(_FIELDS, max_size=2).map(tuple),
    st.dictionaries(_TEXTS, st.integers(0, 3), max_size=2), st.sampled_from([None, {"a": [1, None]}, "text"]))
BOXES = st.builds(Box, _TEXTS, st.lists(_REASONS, max_size=2).map(tuple))
RESULTS = st.lists(st.builds(Result, _TEXTS, st.integers(0, 3)), max_size=4).map(tuple)


def changes():
    """A function from a document to one with a changed section or zone; other parts are the same objects."""
    return st.one_of(
        BOXES.map(lambda box: lambda toy: toy._replace(box=box)),
        RESULTS.map(lambda results: lambda toy: toy._replace(results=results)),
        st.tuples(st.sampled_from("abc"), ZONES).map(
            lambda pair: lambda toy: toy._replace(zones={**toy.zones, pair[0]: pair[1]})),
        st.tuples(st.sampled_from("abc"), st.integers(0, 3)).map(lambda pair: lambda toy: toy._replace(zones={
            key: zone._replace(count=pair[1]) if key == pair[0] else zone for key, zone in toy.zones.items()})),
        st.sampled_from("abc").map(lambda gone: lambda toy: toy._replace(
            zones={key: zone for key, zone in toy.zones.items() if key != gone})),
    )
