"""Repeated strings, and texts for panels."""

import pytest

from roah_rsbb.core.runs.online_data import DisplayText, RepeatedStrings


def _received(*messages):
    strings = RepeatedStrings()
    return [strings.receive(texts) for texts in messages]


def test_a_string_that_is_repeated_is_new_once():
    assert _received(["a"], ["a"], ["a", "b"], ["b"], ["b"]) == [["a"], [], ["b"], [], []]


def test_the_same_text_is_new_again_after_a_message_without_it():
    assert _received(["a"], [], ["a"], ["b"], ["a"]) == [["a"], [], ["a"], ["b"], ["a"]]


def test_a_text_twice_in_one_message_is_one():
    assert _received(["a", "b", "a"]) == [["a", "b"]]


def test_strings_keep_their_order():
    assert _received(["c", "a", "b"]) == [["c", "a", "b"]]


def test_no_more_is_remembered_than_one_message_holds():
    strings = RepeatedStrings()
    for i in range(100):
        strings.receive([str(i)])
    assert strings._last == {"99"}


def test_a_panel_shows_the_last_lines_that_fit():
    text = DisplayText(10)
    for line in ("one", "two", "three"):
        text.add(line)
    assert text.text == "two\nthree\n"


def test_a_line_longer_than_the_panel_keeps_its_end():
    text = DisplayText(5)
    text.add("0123456789")
    assert text.text == "6789\n"


@pytest.mark.parametrize("size", [1, 7, 100])
@pytest.mark.parametrize("line", ["", "x", "\n\n\n", "x" * 99, "a\nb\nc", "é" * 50])
def test_a_panels_text_is_bounded_whatever_comes(size, line):
    text = DisplayText(size)
    for _ in range(300):
        text.add(line)
        assert len(text.text) <= size
        assert text.text.endswith("\n")
