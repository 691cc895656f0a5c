"""A difference makes the new JSON value from the old one, in few bytes. Texts of which only the end is
published are followed."""

import json

from hypothesis import given
from hypothesis import strategies as st

from helpers.examples import examples
from roah_rsbb.document.difference import LONG_TEXT, SAME, added, changed, difference

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-3, 3) | st.text("ab\n", max_size=150),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from("abc"), inner, max_size=3),
    max_leaves=12,
)


@examples()
@given(VALUES, VALUES)
def test_a_difference_makes_the_new_value_from_the_old_one(old, new):
    change = difference(old, new)
    if change is SAME:
        assert old == new
    else:
        assert changed(old, json.loads(json.dumps(change))) == new


def test_a_log_of_limited_length_is_recorded_by_its_new_lines():
    lines = [f"12:00:{i:02d}Z a line of a log\n" for i in range(20)]
    old, new = "".join(lines[:10]), "".join(lines[2:12])
    assert len(old) > LONG_TEXT
    change = difference(old, new)
    assert change == [len("".join(lines[:2])), "".join(lines[10:12])]
    assert changed(old, change) == new


def test_a_list_that_grows_is_recorded_by_its_new_items():
    assert difference({"a": [1, 2, 5], "b": 0}, {"a": [1, 3, 5, 4]}) == {"a": [[[1, [3]]], [4]], "b": None}


def test_a_list_of_limited_length_is_recorded_by_what_leaves_and_comes():
    history = [{"number": i} for i in range(10)]
    assert difference(history[:8], [*history[:3], *history[4:]]) == [3, 1, history[8:]]
    assert changed(history[:8], [3, 1, history[8:]]) == [*history[:3], *history[4:]]


def lines(first, last):
    return "".join(f"12:00:{number:02d} line number {number}\n" for number in range(first, last))


def test_what_was_appended():
    assert added("", "a\n") == "a\n"
    assert added("a\n", "a\nb\n") == "b\n"
    assert added("a\n", "a\n") == ""


def test_what_was_appended_while_the_beginning_went():
    assert added(lines(0, 20), lines(3, 22)) == lines(20, 22)


def test_nothing_new_while_the_beginning_went():
    assert added(lines(0, 20), lines(3, 20)) == ""


def test_another_text():
    assert added(lines(0, 20), lines(40, 60)) is None
    assert added(lines(0, 20), "") is None


def test_an_overlap_of_a_few_characters_is_a_coincidence():
    assert added("abc\nstart\n", "start\nmore\n") is None
    assert added("abc\nstart\n", "start\n") is None


def test_a_repeated_line_is_not_taken_for_the_overlap():
    same = "12:00:00 the very same line, long enough to be searched for in the text before\n" * 3
    old = same + lines(0, 20)
    assert added(old, old[len(same) // 3:] + "new\n") == "new\n"
