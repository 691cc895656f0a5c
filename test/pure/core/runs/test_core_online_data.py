"""Repeated strings, and texts for panels."""

import pytest

from roah_rsbb.core.runs.reported import receive, with_line


def _received(*messages):
    last = {}
    return [receive(last, "visitor", texts) for texts in messages]


def test_a_string_that_is_repeated_is_new_once():
    assert _received(["a"], ["a"], ["a", "b"], ["b"], ["b"]) == [["a"], [], ["b"], [], []]


def test_the_same_text_is_new_again_after_a_message_without_it():
    assert _received(["a"], [], ["a"], ["b"], ["a"]) == [["a"], [], ["a"], ["b"], ["a"]]


def test_a_text_twice_in_one_message_is_one():
    assert _received(["a", "b", "a"]) == [["a", "b"]]


def test_strings_keep_their_order():
    assert _received(["c", "a", "b"]) == [["c", "a", "b"]]


def test_no_more_is_remembered_than_one_message_holds():
    last = {}
    for i in range(100):
        receive(last, "visitor", [str(i)])
    assert last == {"visitor": ("99",)}


def test_fields_are_apart():
    last = {}
    assert [receive(last, field, ["a"]) for field in ("visitor", "final_command", "visitor")] == [["a"], ["a"], []]


def test_a_panel_shows_the_last_lines_that_fit():
    text = ""
    for line in ("one", "two", "three"):
        text = with_line(text, line, 10)
    assert text == "two\nthree\n"


def test_a_line_longer_than_the_panel_keeps_its_end():
    assert with_line("", "0123456789", 5) == "6789\n"


@pytest.mark.parametrize("size", [1, 7, 100])
@pytest.mark.parametrize("line", ["", "x", "\n\n\n", "x" * 99, "a\nb\nc", "é" * 50])
def test_a_panels_text_is_bounded_whatever_comes(size, line):
    text = ""
    for _ in range(300):
        text = with_line(text, line, size)
        assert len(text) <= size
        assert text.endswith("\n")


def test_what_a_robot_says_forges_no_line():
    shown = with_line("", "notifications: \x1b[2Jdone\n12:00:00 STOP: Benchmark completed\u202e", 1000)
    assert shown == "notifications: \\x1b[2Jdone\\n12:00:00 STOP: Benchmark completed\\u202e\n"
