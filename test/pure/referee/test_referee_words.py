"""Words that a referee types: zones, items, values, events."""

import pytest

from helpers.referee_box import EVENTS, ITEMS
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.scoring import Entered
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.referee.words import BadWord, event_wanted, pick, pick_item, pick_zone, score_wanted, value_of

ZONES = ["Testing TestingTeam", "Testing Other", "Home A", "Home AB"]


@pytest.mark.parametrize("word, name", [
    ("Home A", "Home A"),  # also the beginning of another one
    ("home a", "Home A"),
    ("HOME AB", "Home AB"),
    ("testing t", "Testing TestingTeam"),
    ("Testing O", "Testing Other"),
])
def test_a_zone_is_found_by_its_name_or_beginning(word, name):
    assert pick_zone(word, ZONES) == name


def test_zones_that_differ_in_case_only_are_distinguished():
    assert pick_zone("home", ["Home", "home", "home 2"]) == "home"
    with pytest.raises(BadWord):
        pick_zone("HOME", ["Home", "home"])
    assert pick("team", "beta", ["Alpha", "Beta"]) == "Beta"
    with pytest.raises(BadWord, match="no day 'tomorrow': there is '2026-11-28', '2026-11-29'"):
        pick("day", "tomorrow", ["2026-11-28", "2026-11-29"])


def test_an_ambiguous_zone_lists_those_that_fit_only():
    with pytest.raises(BadWord) as bad:
        pick_zone("test", ZONES)
    assert str(bad.value) == "'test' is the beginning of 2 zones: 'Testing TestingTeam', 'Testing Other'"


def test_a_mistyped_zone_is_suggested_and_all_are_listed():
    with pytest.raises(BadWord) as bad:
        pick_zone("Testing TestngTeam", ZONES)
    text = str(bad.value)
    assert "did you mean 'Testing TestingTeam'?" in text
    assert all(f"'{name}'" in text for name in ZONES)


@pytest.mark.parametrize("word", ["", "zzz"])
def test_an_unknown_zone_lists_all_once(word):
    with pytest.raises(BadWord) as bad:
        pick_zone(word, ZONES)
    assert all(str(bad.value).count(f"'{name}'") == 1 for name in ZONES)


@pytest.mark.parametrize("word, number", [
    ("1", 1), ("3", 3), ("door", 1), ("MOVED", 2), ("bumps", 3), ("Moved furniture", 2),
])
def test_an_item_is_found_by_number_or_part_of_its_text(word, number):
    assert pick_item(word, ITEMS) == number


def test_an_ambiguous_item_lists_those_that_fit_only():
    with pytest.raises(BadWord) as bad:
        pick_item("furniture", ITEMS)
    assert "Moved furniture" in str(bad.value)
    assert "Bumps into the furniture" in str(bad.value)
    assert "door" not in str(bad.value)


@pytest.mark.parametrize("word", ["0", "4", "²", "zzz", ""])
def test_an_unknown_item_lists_all(word):
    with pytest.raises(BadWord) as bad:
        pick_item(word, ITEMS)
    assert all(item.desc in str(bad.value) for item in ITEMS)


def test_the_same_text_in_two_groups_is_ambiguous():
    twice = (ITEMS[0], ITEMS[0]._replace(group="Penalized"))
    with pytest.raises(BadWord, match="in 2 scoring items"):
        pick_item(ITEMS[0].desc, twice)


def test_a_benchmark_without_items_says_so():
    with pytest.raises(BadWord, match="no scoring items"):
        pick_item("1", ())


@pytest.mark.parametrize("text, entered", [
    ("3", Entered(3)), ("0", Entered(0)), ("+2", Entered(added="2")), ("-1", Entered(added="-1")),
])
def test_counts_are_set_or_added_to_whatever_is_shown(text, entered):
    assert value_of(text, ITEMS[1]._replace(value=5)) == entered


@pytest.mark.parametrize("text, value", [("yes", 1), ("No", 0), ("TRUE", 1), ("false", 0), ("1", 1), ("+1", 1)])
def test_yes_or_no_items_take_words(text, value):
    assert value_of(text, ITEMS[0]) == Entered(value)


@pytest.mark.parametrize("item, text, hint", [
    (1, "yes", "whole number"), (1, "1.5", "whole number"), (0, "maybe", "yes"),
])
def test_an_invalid_value_names_the_valid_ones(item, text, hint):
    with pytest.raises(BadWord, match=hint):
        value_of(text, ITEMS[item])


@pytest.mark.parametrize("item, text", [(0, "2"), (0, "-1")])
def test_values_that_the_core_would_refuse_are_refused_in_its_words(item, text):
    with pytest.raises(Refused, match="its value must be 0 or"):
        value_of(text, ITEMS[item])


def test_a_count_too_large_for_the_message_is_refused():
    with pytest.raises(BadWord, match="2147483647"):
        value_of("2147483648", ITEMS[1])


@pytest.mark.parametrize("text, fitting", [
    ("HGTKMH", [1, 3]), ("hgtkmh/1", [1, 3]), ("HGTKMH/1/3", [3]), ("HGTKMH/2", []), ("HWV", [2]),
])
def test_an_event_is_named_by_code_round_and_run(text, fitting):
    wanted = event_wanted(text)
    assert [event.run for event in EVENTS if wanted.fits(event)] == fitting
    assert str(wanted).lower() == text.lower()


@pytest.mark.parametrize("text", ["", "/1", "HWV/x", "HWV/1/2/3", "HWV/"])
def test_other_forms_of_an_event_are_errors(text):
    with pytest.raises(ValueError):
        event_wanted(text)


def test_a_score_is_split_at_its_last_equals_sign():
    assert score_wanted("a = b item = 3") == ("a = b item", "3")
    assert score_wanted("6==-17") == ("6", "=-17")


@pytest.mark.parametrize("text", ["", "door", "door=", "=1", " = 1"])
def test_half_a_score_is_an_error(text):
    with pytest.raises(ValueError):
        score_wanted(text)


HELP = SheetItem("G", "help", "choice", 0, choices=("with help", "alone", "without"))
POSTER = SheetItem("G", "poster", "rating", 0, judges=("Anna", "Ben"), ratings=("", ""))
STEPS = SheetItem("G", "steps", "int", 1)
WATER = SheetItem("G", "water", "decimal", 2, text="2.5")


@pytest.mark.parametrize("text, item, entered", [
    ("alone", HELP, Entered(text="alone")), ("AL", HELP, Entered(text="alone")),
    ("with help", HELP, Entered(text="with help")), ("Anna:7.5", POSTER, Entered(text="7.5", judge="Anna")),
    ("b: 8", POSTER, Entered(text="8", judge="Ben")), ("1.25", WATER, Entered(text="1.25")),
    ("+0.50", WATER, Entered(added="0.5")), ("+-3", WATER, Entered(added="-3")), ("=-3", WATER, Entered(text="-3")),
    ("=-17", STEPS, Entered(-17)), ("+-3", STEPS, Entered(added="-3")), ("=+5", STEPS, Entered(5)),
    ("-3", STEPS._replace(min="0"), Entered(added="-3")), ("1,25", WATER, Entered(text="1.25")),
    ("+0,5", WATER, Entered(added="0.5")), ("=−1,5", WATER, Entered(text="-1.5")), ("=–17", STEPS, Entered(-17)),
    ("Anna: 7,5", POSTER, Entered(text="7.5", judge="Anna")), ("−1", ITEMS[1], Entered(added="-1")),
])
def test_values_of_every_type(text, item, entered):
    assert value_of(text, item) == entered


@pytest.mark.parametrize("text, item, hint", [
    ("with", HELP, "'with' is not a choice of 'help': choose one of 'with help', 'alone', 'without'"),
    ("", HELP, "is not a choice"), ("7", POSTER, "such as 'Anna:5'; the judges are 'Anna', 'Ben'"),
    ("Chris:7", POSTER, "give the judge and a number"), ("much", WATER, "give a number such as 2.5"),
    ("1.5", STEPS, "a whole number"), ("1,5", STEPS, "a whole number"),
    ("1.000,5", WATER, "'1.000,5' is not a value .* give a number"),
    ("-17", STEPS, "give '=-17' to set the item to it, '[+]-17' to count down by 17"),
    ("much", WATER, "or '=-1'$"), ("much", STEPS, "or '=-1'$"), ("much", STEPS._replace(min="0"), "or -1$"),
    ("1,001", WATER, r"can mean 1001 or 1.001. Type 1001, or 1.001 \(with a comma: 01,001\)"),
    ("1.000", WATER, r"can mean 1000 or 1. Type 1000, or 1 \(with a comma: 1,0\)"),
    ("+1,250", WATER, "can mean [+]1250 or"), ("=-1,250", WATER, "can mean -1250 or"),
    ("−1,5", WATER, "give '=-1.5' to set the item to it, '[+]-1.5' to count down by 1.5"),
])
def test_a_wrong_value_of_every_type_names_the_right_ones(text, item, hint):
    with pytest.raises(BadWord, match=hint):
        value_of(text, item)
