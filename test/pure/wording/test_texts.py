"""Text that is safe to show, lists, and names that are probably one name in two spellings."""

import pytest

from roah_rsbb.wording import texts
from roah_rsbb.wording.texts import MAX_CHOICES, twins


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


# -- suggestions ----------------------------------------------------------------------------------


@pytest.mark.parametrize("one, other", [
    ("Pumas", "Pumans"), ("ToBi", "Tobi"), ("b-it-bots", "b-it bots"), ("b-it-bots", "b-it-bot"), ("Alpha", "Alpah"),
    ("Wright Eagle", "WrightEagles"), ("FBOT@Home", "FBot"), ("M\u00fcller", "Mu\u0308ller"), ("Kitchen", "Kitchn"),
    ("Alpha", "\u0410lpha"), ("Alpha", "Al\u200bpha"), ("O2AC", "02AC"), ("Team I", "Team 1"), ("Straße", "STRASSE"),
])
def test_one_name(one, other):
    assert twins(["Other", one, other]) == [(other, one)]


@pytest.mark.parametrize("names", [
    ["Team 1", "Team 2", "Team 11"], ["Arena A", "Arena B", "ArenaC", "ArenaD"], ["Tigers1", "Tigers2", "TigersB"],
    ["Robo II", "Robo III"], ["Mina", "Mona"], ["Team Home", "Home Alone"], ["日本", "中国"], ["!!!", "???", ""],
    ["BrassButlers", "CopperKettle", "HomeAlone", "TeaAtFive", "TestingTeam"],
])
def test_names_of_several(names):
    assert twins(names) == []


def test_many_long_names_are_few_comparisons():
    assert len(twins([f"{number} {'x' * 10_000}" for number in range(10 * MAX_CHOICES)])) == 0
