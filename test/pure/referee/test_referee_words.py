"""Words that a referee types: zones, items, values, events."""

import pytest

from helpers.referee_box import EVENTS, ITEMS
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.scoring import Entered
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.referee.words import BadWord, event_wanted, pick, pick_item, pick_zone, score_wanted, value_of

ZONES = ["Testing TestingTeam", "Testing Other", "Home A", "Home AB"]
TWINS = ["Home", "home", "home 2"]


@pytest.mark.parametrize("word, names, found", [
    ("Home A", ZONES, "Home A"),  # also the beginning of another one
    ("home a", ZONES, "Home A"), ("HOME AB", ZONES, "Home AB"), ("testing t", ZONES, "Testing TestingTeam"),
    ("Testing O", ZONES, "Testing Other"), ("home", TWINS, "home"), ("Home", TWINS, "Home"),
])
def test_a_zone_is_found_by_its_name_or_beginning(word, names, found):
    assert pick_zone(word, names) == found


@pytest.mark.parametrize("what, word, names, text", [
    ("zone", "test", ZONES, "'test' is the beginning of 2 zones: 'Testing TestingTeam', 'Testing Other'"),
    ("zone", "HOME", TWINS[:2], "'HOME' is the beginning of 2 zones: 'Home', 'home'"),
    ("zone", "Testing TestngTeam", ZONES,
     "no zone 'Testing TestngTeam': did you mean 'Testing TestingTeam'? (the zones are 'Testing TestingTeam', "
     "'Testing Other', 'Home A', 'Home AB')"),
    ("zone", "", ["A", "B"], "no zone '': there is 'A', 'B'"),
    ("zone", "zzz", ["A", "B"], "no zone 'zzz': there is 'A', 'B'"),
    ("day", "tomorrow", ["2026-11-28", "2026-11-29"], "no day 'tomorrow': there is '2026-11-28', '2026-11-29'"),
])
def test_a_word_that_means_no_name_lists_what_it_may_mean(what, word, names, text):
    with pytest.raises(BadWord) as bad:
        pick(what, word, names)
    assert str(bad.value) == text


@pytest.mark.parametrize("word, number", [
    ("1", 1), ("3", 3), ("door", 1), ("MOVED", 2), ("bumps", 3), ("Moved furniture", 2),
])
def test_an_item_is_found_by_number_or_part_of_its_text(word, number):
    assert pick_item(word, ITEMS) == number


@pytest.mark.parametrize("word, items, begin, listed", [
    ("furniture", ITEMS, "'furniture' is in 2 scoring items: give the number, or more of the text", ITEMS[1:]),
    ("door", (ITEMS[0], ITEMS[0]._replace(group="Penalized")), "'door' is in 2 scoring items", ITEMS[:1]),
    *((word, ITEMS, f"no scoring item '{word}'; there are", ITEMS) for word in ("0", "4", "²", "zzz", "")),
    ("1", (), "this benchmark has no scoring items", ()),
])
def test_a_word_that_means_no_item_lists_what_it_may_mean(word, items, begin, listed):
    with pytest.raises(BadWord) as bad:
        pick_item(word, items)
    text = str(bad.value)
    assert text.startswith(begin)
    assert {item for item in ITEMS if f": {item.desc}" in text} == set(listed)


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
BUMPS = ITEMS[1]._replace(value=5)
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
    # counts, whatever is shown; yes or no
    ("3", BUMPS, Entered(3)), ("0", BUMPS, Entered(0)), ("+2", BUMPS, Entered(added="2")),
    ("-1", BUMPS, Entered(added="-1")), ("yes", ITEMS[0], Entered(1)), ("No", ITEMS[0], Entered(0)),
    ("TRUE", ITEMS[0], Entered(1)), ("false", ITEMS[0], Entered(0)), ("1", ITEMS[0], Entered(1)),
    ("+1", ITEMS[0], Entered(1)),
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
    ("yes", BUMPS, "whole number"), ("1.5", BUMPS, "whole number"), ("maybe", ITEMS[0], "give 0, 1, yes or no"),
    ("2147483648", BUMPS, "the maximum is 2147483647"),
])
def test_a_wrong_value_of_every_type_names_the_right_ones(text, item, hint):
    with pytest.raises(BadWord, match=hint):
        value_of(text, item)


@pytest.mark.parametrize("text", ["2", "-1"])
def test_values_that_the_core_would_refuse_are_refused_in_its_words(text):
    with pytest.raises(Refused, match="its value must be 0 or"):
        value_of(text, ITEMS[0])
