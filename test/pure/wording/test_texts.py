"""Text that is safe to show, and lists."""

import pytest

from roah_rsbb.wording import texts


def test_what_cannot_be_printed_is_written_out():
    assert texts.visible("a\x1b[31m\u202eb\nc\x00 ü") == "a\\x1b[31m\\u202eb\nc\\x00 ü"
    assert texts.one_line("a\n  b\t") == "a b\\t"
    assert texts.visible("\ud800") == "\\ud800"


@pytest.mark.parametrize("text, shown", [
    ("Übung 'a' – 1", "Übung 'a' – 1"), ("", ""), ("\x1b[31mred", "\\x1b[31mred"), ("a\nb\r\0", "a\\nb\\r\\x00"),
    ("\u202eevil", "\\u202eevil"),
])
def test_an_escaped_text_cannot_command_a_terminal_or_hide_text(text, shown):
    assert texts.escaped(text) == shown


def test_any_json_value_is_text():
    assert [texts.value_text(value) for value in ("ü", 1, [True, None], {"a": "ü"})] == [
        "ü", "1", "[true, null]", '{"a": "ü"}']


def test_several_lines_are_a_list():
    assert texts.bullets(["only one"]) == "only one"
    assert texts.bullets(["one", "two"]) == "• one\n• two"
    assert texts.bullets([]) == ""
