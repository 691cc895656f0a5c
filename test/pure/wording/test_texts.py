"""Text that is safe to show, and lists."""

from roah_rsbb.wording import texts


def test_what_cannot_be_printed_is_written_out():
    assert texts.visible("a\x1b[31m\u202eb\nc\x00 ü") == "a\\x1b[31m\\u202eb\nc\\x00 ü"
    assert texts.one_line("a\n  b\t") == "a b\\t"
    assert texts.visible("\ud800") == "\\ud800"


def test_any_json_value_is_text():
    assert [texts.plain(value) for value in ("ü", 1, [True, None], {"a": "ü"})] == [
        "ü", "1", "[true, null]", '{"a": "ü"}']


def test_several_lines_are_a_list():
    assert texts.bullets(["only one"]) == "only one"
    assert texts.bullets(["one", "two"]) == "• one\n• two"
    assert texts.bullets([]) == ""
