"""Names that are probably one name in two spellings."""

import pytest

from roah_rsbb.wording.texts import MAX_CHOICES, twins


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
