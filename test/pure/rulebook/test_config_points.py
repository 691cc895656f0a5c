"""Types of scoring items, and rules by which they give points."""

import pathlib
import re
from dataclasses import replace
from decimal import Decimal

import pytest

from helpers.config_files import line_of
from roah_rsbb.model.rules import ItemChoice, JuryResult
from roah_rsbb.model.scoring import GroupLimits, ScoreKind, ScoringItem, SheetForm, SheetRules, TimeLeft
from roah_rsbb.scoring.earlier import modern

PAGE = (pathlib.Path(__file__).resolve().parents[3] / "docs" / "organiser.md").read_text(encoding="utf-8")
TEXT = re.search(r"<!-- file: points/benchmarks.yaml -->\n```yaml\n(.*?)```", PAGE, re.DOTALL).group(1)
EVENT = "{benchmark: CleanTable, team: BrassButlers, round: 1, run: 1, scheduled_time: 2026-11-28 09:00:00}"
SCHEDULE = f"- zone: Home\n  schedule:\n    - {EVENT}\n"


def _load(files, text):
    loaded, warnings = files.load(benchmarks=text, schedule=SCHEDULE)
    assert warnings == []
    return loaded.benchmarks["CleanTable"]


def _without_id(item):
    return replace(item, id="")


def _short(*items, **keys):
    """The text with these items in one group."""
    head = TEXT[:TEXT.index("  scoring:")]
    top = "".join(f"    {key}: {value}\n" for key, value in keys.items())
    return f"{head}  scoring:\n{top}    groups:\n      - G:\n" + "".join(f"          - {{{item}}}\n" for item in items)


def test_the_example_of_the_docs(files):
    benchmark = _load(files, TEXT)
    objects, empty, opens, drops, water, show = map(_without_id, benchmark.scoring)
    assert objects == ScoringItem("Table", "Objects in the dishwasher", ScoreKind.UINT, Decimal(20), most=Decimal(5))
    assert empty == ScoringItem("Table", "Table is empty", ScoreKind.BOOL, Decimal(30), needs=(objects.key,))
    assert opens.choices == (
        ItemChoice("alone", Decimal(50)), ItemChoice("with help", Decimal(10)), ItemChoice("not at all", Decimal(0)))
    assert (drops.points, water.kind, water.points, water.most) == (
        Decimal(-10), ScoreKind.DECIMAL, Decimal("-2.5"), Decimal(10))
    assert show == ScoringItem("Jury", "Presentation", ScoreKind.RATING, Decimal(2), Decimal(0), Decimal(10),
                               judges=("1", "2", "3"), jury=JuryResult.WITHOUT_EXTREMES)
    rules = SheetRules(
        (GroupLimits("Table", None, Decimal(120)), GroupLimits("Penalties", Decimal(-50))), Decimal(0), None,
        TimeLeft(Decimal(1), Decimal(10), Decimal(20), (empty.key,)))
    # Journals have such sheets in their earlier form. Those become the same ones.
    assert benchmark.form == modern(SheetForm((objects, empty, opens, drops, water, show), rules, 300.0))


@pytest.mark.parametrize("item, expected", [
    ("type: int, desc: d, min: -5, max: 5", ScoringItem("G", "d", ScoreKind.INT, None, Decimal(-5), Decimal(5))),
    ("type: choice, desc: d, choices: [a, b]",
     ScoringItem("G", "d", ScoreKind.CHOICE, choices=(ItemChoice("a"), ItemChoice("b")))),
    ("type: rating, desc: d, judges: [Anna, Ben], max: 5, min: 1, jury: median",
     ScoringItem("G", "d", ScoreKind.RATING, None, Decimal(1), Decimal(5), judges=("Anna", "Ben"),
                 jury=JuryResult.MEDIAN)),
    ("type: bool, desc: d, points: .5", ScoringItem("G", "d", ScoreKind.BOOL, Decimal("0.5"))),
    ("type: decimal, desc: d", ScoringItem("G", "d", ScoreKind.DECIMAL)),
])
def test_an_item(files, item, expected):
    form = _load(files, _short(item)).form
    assert tuple(map(_without_id, form.items)) == (expected,)
    assert form == modern(SheetForm((expected,)))


def test_needs_may_name_several_items_and_items_of_other_groups(files):
    text = TEXT.replace("desc: Drops an object,", "desc: Drops an object, needs: [Table is empty, Presentation],")
    assert _load(files, text).scoring[3].needs == (("Table", "Table is empty"), ("Jury", "Presentation"))


def test_needs_name_an_item_of_the_same_group_first(files):
    text = TEXT.replace("desc: Water on the floor (l)", "desc: Objects in the dishwasher")
    assert _load(files, text).scoring[1].needs == (("Table", "Objects in the dishwasher"),)


MISTAKES = [
    ("points: 20, max: 5", "points: twenty", ["'twenty' as points", "from -1000000 to 1000000 with at most 3"]),
    ("points: 20", "points: 1.2345", ["as points", "at most 3 decimals"]),
    ("points: 20", 'points: "20"', ["as points", "remove the quotes"]),
    ("points: 20", "points: 1e3", ["as points"]),
    ("points: 20", "points: 1000001", ["as points"]),
    ("points: 20, max: 5", "points: 20, max: 0", ["'0' as times", "from 1 to"]),
    ("points: 20, max: 5", "points: 20, max: 2.5", ["'2.5' as times", "a whole number"]),
    ("points: 20, max: 5", "points: 20, min: 5", [
        "the key 'min' in an item of type uint", "'points', 'max' and 'needs'"]),
    ("points: 30", "points: 30, max: 3", ["the key 'max' in an item of type bool"]),
    ("points: 30", "points: 30, judges: 3", ["the key 'judges' in an item of type bool"]),
    ("points: 30", "point: 30", ["unknown key 'point' in a scoring item", "did you mean 'points'?"]),
    ("choices: {", "points: 5, choices: {", [
        "the key 'points' in an item of type choice", "the points of each choice"]),
    ("choices: { alone: 50, with help: 10, not at all: 0 }", "max: 3", [
        "the key 'max' in an item of type choice", "without choices"]),
    ("choices: { alone: 50, with help: 10, not at all: 0 }", "choices: [alone]", ["too few choices"]),
    ("choices: { alone: 50, with help: 10, not at all: 0 }", "choices: alone", ["the text 'alone' as choices"]),
    ("choices: { alone: 50, with help: 10, not at all: 0 }", "choices: [a, a]", ["the choice 'a' again"]),
    ("alone: 50", "alone: fifty", ["'fifty' as points of 'alone'"]),
    ("alone: 50", "yes: 50", ["'yes' (to YAML, a yes-or-no value) as a choice", "quotes"]),
    ("judges: 3, max: 10,", "judges: 3,", ["an item of type rating without max", "something like 'max: 5'"]),
    ("judges: 3,", "judges: 0,", ["'0' as judges", "from 1 to 20"]),
    ("judges: 3,", "judges: [Anna, Anna],", ["the judge 'Anna' again"]),
    ("judges: 3,", "judges: [],", ["0 judges", "from 1 to 20"]),
    ("jury: without extremes", "jury: modus", ["'modus' as jury", "how ratings become one: there is 'mean'"]),
    ("max: 10, points: 2, jury", "max: 10, min: 10, points: 2, jury", ["to 10 of 'Presentation', whose from is 10"]),
    ("max: 10, points: 2, jury", "max: 0, points: 2, jury", ["'0' as to of a rating"]),
    ("needs: Objects in the dishwasher", "needs: Object in the dishwasher", [
        "'Object in the dishwasher' as needs", "did you mean 'Objects in the dishwasher'?"]),
    ("needs: Objects in the dishwasher", "needs: Table is empty", [
        "conditions that depend on each other: 'Table is empty';"]),
    ("needs: Objects in the dishwasher", "needs: []", ["an empty sequence as needs"]),
    ("points: 20, max: 5", "points: 20, max: 5, needs: Table is empty", [
        "conditions that depend on each other: 'Objects in the dishwasher', 'Table is empty';"]),
    ("needs: Table is empty }\n", "needs: Table empty }\n", [
        "'Table empty' as needs", "did you mean 'Table is empty'?"]),
    ("          max: 120", "          max: many", ["'many' as max"]),
    ("          max: 120", "          max: 5\n          min: 7", [
        "max 5 of 'Table', whose min is 7"]),
    ("          max: 120", "          most: 5", ["unknown key 'most' in the scoring group 'Table'"]),
    ("    min: 0\n", "    min: [0]\n", ["a sequence ('- item', or [a, b]) as min"]),
    ("    min: 0\n", "    max: 5\n    min: 6\n", ["max 5 of 'Score sheet', whose min is 6"]),
    ("    min: 0\n", "    minimum: 0\n", ["unknown key 'minimum' in scoring"]),
    ("points: 1, seconds: 10", "points: 1, seconds: 0", ["'0' as seconds"]),
    ("points: 1, seconds: 10", "seconds: 10", ["time_left without points"]),
    ("points: 1, seconds: 10", "points: 1, every: 10", ["unknown key 'every' in time_left"]),
    ("- Penalties:\n", "- Time left:\n", ["a scoring group 'Time left'"]),
]


@pytest.mark.parametrize("old, new, parts", MISTAKES, ids=[new[:40] for _, new, _ in MISTAKES])
def test_a_mistake_is_an_error_in_its_line(files, old, new, parts):
    assert old in TEXT
    text = TEXT.replace(old, new, 1)
    found = files.errors(benchmarks=text, schedule=SCHEDULE)
    first = TEXT[:TEXT.index(old)].count("\n") + 1 + (len(new) - len(new.lstrip("\n")))
    elsewhere = ("time_left, and a", "on each other")
    places = [line for _, line, message in found if not any(part in message for part in elsewhere)]
    assert all(first <= line <= first + new.count("\n") for line in places), found
    assert all(any(part in message for _, _, message in found) for part in parts), found


def test_no_bonus_for_the_time_left_without_a_time_limit(files):
    text = TEXT.replace("timeout: 300", "timeout: no limit")
    _, _, message = files.error(benchmarks=text, schedule=SCHEDULE)
    assert "the time left as 'Time left' in a run without a time limit" in message


def test_needs_of_an_item_in_two_other_groups(files):
    text = TEXT.replace("desc: Presentation", "desc: Drops an object")
    text = text.replace("needs: Table is empty }", "needs: Drops an object }")
    _, line, message = files.error(benchmarks=text, schedule=SCHEDULE)
    assert line == line_of(text, "time_left")
    assert "several rows are called" in message and "'Penalties: Drops an object', 'Jury: Drops an object'" in message


def test_all_errors_at_once(files):
    text = TEXT.replace("points: 20", "points: x").replace("points: -10", "points: y").replace("judges: 3", "judges: z")
    assert [line for _, line, _ in files.errors(benchmarks=text, schedule=SCHEDULE)] == [
        line_of(text, part) for part in ("points: x", "points: y", "judges: z")]


def test_needs_of_an_item_that_has_an_error_is_no_second_error(files):
    text = TEXT.replace("desc: Objects in the dishwasher,", "dsc: Objects in the dishwasher,")
    (error,) = files.errors(benchmarks=text, schedule=SCHEDULE)
    assert "unknown key 'dsc'" in error[2]
