"""Saved state: through JSON and back, by names and types; moments move with a new start of the computer."""

import enum
import json
from typing import Dict, NamedTuple, Optional, Tuple

import pytest

from roah_rsbb.model.clock import Now
from roah_rsbb.model.saved import Anchor, BadState, Mono, freeze, thaw


class Colour(enum.IntEnum):
    RED = 1
    GREEN = 2


class Inner(NamedTuple):
    x: float
    seen: Optional[Mono] = None


class Outer(NamedTuple):
    name: str
    colour: Colour
    inner: Inner = Inner(0.0)
    pairs: Tuple[Tuple[str, int], ...] = ()
    lists: Dict[str, Tuple[str, ...]] = {}
    at: Optional[Now] = None
    on: bool = False


FULL = Outer(
    "é", Colour.GREEN, Inner(1.5, Mono(10.0)), (("a", 1), ("b", 2)), {"k": ("v", "w")}, Now(20.0, 1e9), True)


def through_json(value):
    return json.loads(json.dumps(freeze(value)))


@pytest.mark.parametrize("state", [FULL, Outer("", Colour.RED)])
def test_there_and_back(state):
    assert thaw(Outer, through_json(state)) == state


def test_defaults_take_no_room():
    assert freeze(Outer("n", Colour.RED)) == {"name": "n", "colour": "RED"}


def test_moments_are_moved_and_nothing_else():
    moved = thaw(Outer, through_json(FULL), shift=-5.0)
    assert moved == FULL._replace(inner=Inner(1.5, Mono(5.0)), at=Now(15.0, 1e9))


def test_what_a_newer_version_added_is_passed_over():
    assert thaw(Inner, {"x": 1.0, "colour": "RED"}) == Inner(1.0)


@pytest.mark.parametrize("data", [
    {}, {"name": "n"}, {"name": "n", "colour": "BLUE"}, {"name": 3, "colour": "RED"}, [], None, "text",
    {"name": "n", "colour": "RED", "inner": {}}, {"name": "n", "colour": "RED", "pairs": [["a"]]},
    {"name": "n", "colour": "RED", "at": {"mono": 1.0}}, {"name": "n", "colour": "RED", "on": 1},
    {"name": "n", "colour": "RED", "inner": {"x": "far"}}, {"name": "n", "colour": "RED", "lists": ["a"]},
])
def test_an_invalid_saved_state(data):
    with pytest.raises(BadState):
        thaw(Outer, data)


def test_a_boot_keeps_its_monotonic_clock_whatever_utc_did():
    assert Anchor(100.0, 1e9, "boot").shift(Now(107.0, 5e8), "boot") == 0.0


def test_a_new_boot_has_a_new_clock():
    # 60 s passed by UTC: what was due at 100 + 90 is due in 30 s.
    shift = Anchor(100.0, 1e9, "one").shift(Now(12.0, 1e9 + 60), "two")
    assert 190.0 + shift == 12.0 + 30.0


def test_a_clock_that_went_back_over_a_new_boot_means_no_time_passed():
    shift = Anchor(100.0, 1e9, "one").shift(Now(12.0, 1e9 - 3600), "two")
    assert 100.0 + shift == 12.0
