"""The points of a score sheet."""

import random
from decimal import Decimal
from fractions import Fraction

import pytest

from helpers.competition import UTC0, benchmark, event
from helpers.examples import few
from helpers.random_sheets import TIME_LIMIT_S, random_form, random_mark
from roah_rsbb.model.as_json import BadData, from_json, to_json
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.records import By, ItemRecord, RunRecord
from roah_rsbb.model.rules import ItemChoice, JuryResult
from roah_rsbb.model.scoring import GroupLimits, ScoreKind, ScoringItem, SheetForm, SheetRules, TimeLeft
from roah_rsbb.scoring.book import FinishedRun, RunBook
from roah_rsbb.scoring.earlier import sheet_of
from roah_rsbb.scoring.points import counted, jury_text, number_of, text_of, whole_part
from roah_rsbb.scoring.sheet import Mark, ScoreSheet
from roah_rsbb.scoring.tree import Course

OBJECTS = ScoringItem("Table", "objects", ScoreKind.UINT, Decimal(20), most=Decimal(5))
EMPTY = ScoringItem("Table", "empty", ScoreKind.BOOL, Decimal(30), needs=(OBJECTS.key,))
OPENS = ScoringItem("Table", "opens", ScoreKind.CHOICE, choices=(
    ItemChoice("alone", Decimal(50)), ItemChoice("with help", Decimal(10)), ItemChoice("not at all", Decimal(0))))
DROPS = ScoringItem("Penalties", "drops", ScoreKind.UINT, Decimal(-10))
WATER = ScoringItem("Penalties", "water", ScoreKind.DECIMAL, Decimal("-2.5"), most=Decimal(10))
SHOW = ScoringItem("Jury", "show", ScoreKind.RATING, Decimal(2), Decimal(0), Decimal(10), judges=("1", "2", "3"),
                   jury=JuryResult.WITHOUT_EXTREMES)
HEIGHT = ScoringItem("Jury", "height", ScoreKind.INT)
RULES = SheetRules(
    (GroupLimits("Table", None, Decimal(120)), GroupLimits("Penalties", Decimal(-50))), Decimal(0), None,
    TimeLeft(Decimal(1), Decimal(10), Decimal(20), (EMPTY.key,)))
FORM = SheetForm((OBJECTS, EMPTY, OPENS, DROPS, WATER, SHOW, HEIGHT), RULES, 300.0)


class Book:
    """A sheet that is marked once a minute."""

    def __init__(self, form=FORM):
        self.book = RunBook(form)
        self.now = Now(100.0, UTC0)

    def set(self, item, value=0, **fields):
        self.now = self.now.later(60.0)
        self.book.mark(self.now, "Anna", Mark(*item.key, value, **fields))
        return self

    def end(self, reason="completed", elapsed_s=300.0):
        self.book.ended(self.now, reason, "", By(), elapsed_s)
        self.reason = reason
        return self

    def item(self, item):
        items, _ = self.book.counted("")
        return next(record for record in items if record.key == item.key)

    def points(self, reason=""):
        """The total, and the points of each group."""
        points = self.book.counted(reason).points
        return points.total, dict(points.groups)

    def record(self, **fields):
        record = RunRecord("X-1-2", "Home", "X", "Alpha", 1, 1, UTC0, UTC0, end_reason="completed")._replace(**fields)
        return self.book.into(record)


@pytest.fixture
def book():
    return Book()


# -- points -----------------------------------------------------------------------------------------


def test_a_sheet_begins_without_points(book):
    assert book.points() == ("0", {"Table": "0", "Penalties": "0", "Jury": "0", "Time left": "0"})
    assert [item.points for item in book.book.counted("").items] == ["0", "0", "0", "0", "0", "0", ""]


def test_a_sheet_worked_out_by_hand(book):
    book.set(OBJECTS, 3).set(EMPTY, 1).set(OPENS, text="with help").set(DROPS, 2).set(WATER, text="0.75")
    for judge, rating in zip("123", ("7", "8.5", "2")):
        book.set(SHOW, text=rating, judge=judge)
    assert [book.item(item).points for item in FORM.items] == ["60", "30", "10", "-20", "-1.875", "14", ""]
    # Time left: 300 s - 176.5 s are 12 full tens.
    book.end(elapsed_s=176.5)
    assert book.points("completed") == ("104.125", {
        "Table": "100", "Penalties": "-21.875", "Jury": "14", "Time left": "12"})


@pytest.mark.parametrize("choice, points", [("alone", "5"), ("not at all", "0"), ("", "0")])
def test_a_choice_is_given_if_it_has_points(choice, points):
    needy = ScoringItem("Table", "needy", ScoreKind.BOOL, Decimal(5), needs=(OPENS.key,))
    book = Book(SheetForm((OPENS, needy))).set(OPENS, text=choice).set(needy, 1)
    assert book.item(needy).points == points


@pytest.mark.parametrize("needs, is_empty, reason, elapsed_s, points", [
    ((), False, "completed", 250.0, "5"), ((), False, "stopped", 250.0, "0"), ((), False, "timeout", 300.0, "0"),
    ((), False, "", 250.0, "0"), ((EMPTY.key,), True, "stopped", 250.0, "5"),
    ((EMPTY.key,), False, "completed", 250.0, "0"), ((), False, "completed", 259.999, "4"),
    ((), False, "completed", 260.00000001, "4"), ((), False, "completed", 10.0, "20"),
    ((), False, "completed", 300.2, "0"),
])
def test_the_bonus_for_the_time_left(needs, is_empty, reason, elapsed_s, points):
    rules = SheetRules(time_left=TimeLeft(Decimal(1), Decimal(10), Decimal(20), needs))
    book = Book(SheetForm((OBJECTS, EMPTY), rules, 300.0)).set(OBJECTS, 1).set(EMPTY, int(is_empty))
    if reason:
        book.end(reason, elapsed_s)
    assert book.points(reason)[1]["Time left"] == points


def test_a_restarted_run_has_no_bonus_of_its_first_end(book):
    book.set(OBJECTS, 1).set(EMPTY, 1).end(elapsed_s=100.0)
    assert book.points("completed")[1]["Time left"] == "20"
    book.book.started(book.now)
    assert book.points()[1]["Time left"] == "0"


@pytest.mark.parametrize("jury, ratings, result", [
    (JuryResult.MEAN, ["1", "2", "4"], "2.333"), (JuryResult.MEAN, ["1", "2"], "1.5"), (JuryResult.MEAN, [], ""),
    (JuryResult.MEAN, ["0", "0", "0.001"], "0"), (JuryResult.MEAN, ["0", "0.001"], "0.001"),
    (JuryResult.MEDIAN, ["9", "1", "2"], "2"), (JuryResult.MEDIAN, ["9", "1", "2", "4"], "3"),
    (JuryResult.MEDIAN, ["9"], "9"), (JuryResult.WITHOUT_EXTREMES, ["9", "1", "2", "4"], "3"),
    (JuryResult.WITHOUT_EXTREMES, ["9", "1", "2"], "2"), (JuryResult.WITHOUT_EXTREMES, ["9", "1"], "5"),
    (JuryResult.WITHOUT_EXTREMES, ["9"], "9"), (JuryResult.WITHOUT_EXTREMES, ["5", "5", "5"], "5"),
])
def test_the_result_of_a_jury(jury, ratings, result):
    assert jury_text(ScoringItem("G", "d", ScoreKind.RATING, jury=jury), ratings) == result


def test_sums_are_exact():
    items = tuple(ScoringItem("G", f"item {n}", ScoreKind.DECIMAL, Decimal("0.1")) for n in range(10))
    book = Book(SheetForm(items))
    for item in items:
        book.set(item, text="0.1")
    assert book.points() == ("0.1", {"G": "0.1"})
    assert book.set(items[0], text="0.005").item(items[0]).points == "0.001"
    large = ScoringItem("G", "large", ScoreKind.UINT, Decimal("999999.999"))
    book = Book(SheetForm((large, *items))).set(large, 2**31 - 1).set(items[0], text="0.01")
    assert book.points()[0] == text_of(Decimal(2**31 - 1) * Decimal("999999.999") + Decimal("0.001"))


@pytest.mark.parametrize("text, number, whole", [
    ("2.50", "2.5", 2), ("-2.9", "-2.9", -2), ("100", "100", 100), ("-0.0", "0", 0), ("1e3", "1000", 1000),
    ("1e12", "1000000000000", 2**31 - 1),
])
def test_numbers_as_text(text, number, whole):
    assert text_of(number_of(text)) == number
    assert whole_part(text) == whole


@pytest.mark.parametrize("text", ["", "NaN", "Infinity", "alone"])
def test_no_number(text):
    assert number_of(text) is None
    assert whole_part(text) == 0


# -- against a second implementation ----------------------------------------------------------------


def _jury(item, ratings):
    numbers = sorted(map(Fraction, ratings))
    if not numbers:
        return Fraction(0)
    if item.jury is JuryResult.MEDIAN:
        half = len(numbers) // 2
        mean = numbers[half] if len(numbers) % 2 else (numbers[half - 1] + numbers[half]) / 2
    else:
        if item.jury is JuryResult.WITHOUT_EXTREMES and len(numbers) >= 3:
            numbers = numbers[1:-1]
        mean = sum(numbers) / len(numbers)
    return _rounded(mean)


def _rounded(number):
    """Three decimals, half away from zero."""
    thousandths = int(abs(number) * 1000 + Fraction(1, 2))
    return Fraction(thousandths if number >= 0 else -thousandths, 1000)


def _amount(item, record):
    if record.not_attempted:
        return Fraction(0)
    if item.kind is ScoreKind.RATING:
        return _jury(item, [rating.text for rating in record.ratings])
    if item.kind is ScoreKind.DECIMAL:
        return Fraction(record.text)
    return Fraction(record.value)


def _is_given(items, records, key):
    item, record = items[key], records[key]
    if not all(_is_given(items, records, needed) for needed in item.needs):
        return False
    if item.kind is not ScoreKind.CHOICE:
        return _amount(item, record) != 0
    if record.not_attempted or not record.text:
        return False
    points = next(choice.points for choice in item.choices if choice.name == record.text)
    return points is None or points != 0


def _expected(form, sheet, elapsed_s, reason):
    """Work out total and groups with fractions, item by item."""
    items, records = {i.key: i for i in form.items}, {r.key: r for r in sheet}
    groups = {}
    for key, item in items.items():
        if item.points is None and all(choice.points is None for choice in item.choices):
            continue
        if item.kind is ScoreKind.CHOICE:
            points = sum(Fraction(c.points) for c in item.choices
                         if c.name == records[key].text and not records[key].not_attempted)
        else:
            points = _rounded(_amount(item, records[key]) * Fraction(item.points))
        counts = all(_is_given(items, records, needed) for needed in item.needs)
        groups[item.group] = groups.get(item.group, Fraction(0)) + (points if counts else 0)
    for limits in form.rules.groups:
        if limits.most is not None:
            groups[limits.name] = min(groups[limits.name], Fraction(limits.most))
        if limits.least is not None:
            groups[limits.name] = max(groups[limits.name], Fraction(limits.least))
    bonus = form.rules.time_left
    if bonus is not None:
        due = reason and (all(_is_given(items, records, n) for n in bonus.needs) if bonus.needs
                          else reason == "completed")
        full = max(0, (300000 - round(elapsed_s * 1000)) // (1000 * int(bonus.seconds)))
        points = Fraction(bonus.points) * full if due else Fraction(0)
        groups["Time left"] = points if bonus.most is None else min(points, Fraction(bonus.most))
    total = sum(groups.values())
    if form.rules.most is not None:
        total = min(total, Fraction(form.rules.most))
    if form.rules.least is not None:
        total = max(total, Fraction(form.rules.least))
    return total, groups


@pytest.mark.parametrize("seed", range(few(150)))
def test_random_sheets_have_the_points_of_a_second_implementation(seed):
    chance = random.Random(seed)
    form = random_form(chance)
    book = Book(form)
    for _ in range(chance.randint(0, 40)):
        book.now = book.now.later(chance.uniform(0.0, 2.0))
        book.book.mark(book.now, chance.choice(["Anna", "Ben"]), random_mark(chance, form))
    for number in [entry.number for entry in book.book.sheet.history if chance.random() < 0.2]:
        book.book.withdraw(book.now, By("Anna"), number)
    reason, elapsed_s = chance.choice([("", 0.0), ("completed", 100.0), ("stopped", 12.345), ("timeout", TIME_LIMIT_S)])
    if reason:
        book.end(reason, elapsed_s)
    record = book.record(end_reason=reason)
    total, groups = _expected(form, record.items, elapsed_s, reason)
    assert Fraction(record.points.total) == total
    assert {name: Fraction(points) for name, points in record.points.groups} == groups
    # A restart, and a finished run whose benchmark is no longer configured, show the same.
    again = from_json(RunRecord, to_json(record))
    assert again == record
    shown = FinishedRun(again, benchmark("X", scoring=())).record
    assert (shown.items, shown.points) == (record.items, record.points)


# -- values -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("item, fields, reason", [
    (OBJECTS, {"value": 6}, "its value must be from 0 to 5, not 6"), (OBJECTS, {"value": -1}, "from 0 to 5"),
    (OBJECTS, {"text": "2"}, "takes a whole number, not the text '2'"), (EMPTY, {"value": 2}, "0 or 1"),
    (OBJECTS, {"value": 1, "judge": "1"}, "is not rated by judges"), (WATER, {"text": "11"}, "to 10 with at most 3"),
    (WATER, {"text": "1.2345"}, "at most 3 decimals"), (WATER, {"text": "NaN"}, "takes a number"),
    (WATER, {"text": "1e3"}, "takes a number"),
    (OPENS, {"text": "alon"}, "'alon': choose one of alone, with help, not at all"),
    (OPENS, {"value": 1}, "the number 1: choose one of"), (SHOW, {"text": "5"}, "name one of 1, 2, 3"),
    (SHOW, {"value": 5}, "name one of 1, 2, 3"), (SHOW, {"text": "5", "judge": "4"}, "no judge '4'"),
    (SHOW, {"text": "+1", "judge": "1"}, "not '[+]1'"),
    (WATER, {"text": "-1,000"}, "can mean -1000 or -1. Type"), (WATER, {"text": "-1.250"}, "can mean -1250 or -1.25"),
    (SHOW, {"text": "10.5", "judge": "1"}, "from 0 to 10"), (SHOW, {"text": "-1", "judge": "1"}, "from 0 to 10"),
    (HEIGHT, {"value": -2**31}, "must be from -2147483647"),
])
def test_a_wrong_value_is_refused(book, item, fields, reason):
    with pytest.raises(Refused, match=reason.replace("(", r"\(")):
        book.set(item, **fields)
    assert book.book.sheet.history == ()


@pytest.mark.parametrize("typed, text, most", [
    ("1,5", "1.5", None), ("−2", "-2", None), ("–0,25", "-0.25", None), ("1.251", "1.251", None),
    ("1,000", "1", 999), ("1.250", "1.25", 10)])
def test_numbers_are_taken_as_keyboards_of_other_regions_have_them(typed, text, most):
    litres = ScoringItem("Kitchen", "Litres", ScoreKind.DECIMAL, Decimal(1), most=most and Decimal(most))
    assert ScoreSheet((litres,)).check(Mark("Kitchen", "Litres", text=typed)).text == text


@pytest.mark.parametrize("item, fields, value, text", [
    (WATER, {"text": "2.50"}, 2, "2.5"), (WATER, {"value": 3}, 3, "3"), (WATER, {"text": "-0.9"}, 0, "-0.9"),
    (HEIGHT, {"value": -7}, -7, ""), (OPENS, {"text": "with help"}, 2, "with help"), (OPENS, {}, 0, ""),
])
def test_values_of_every_type(book, item, fields, value, text):
    book.set(DROPS, 1).set(item, **fields)
    assert (book.item(item).value, book.item(item).text) == (value, text)


def test_each_judge_rates_and_an_entry_can_be_withdrawn(book):
    book.set(SHOW, text="8", judge="1").set(SHOW, text="6", judge="2").set(SHOW, text="9", judge="1")
    assert (book.item(SHOW).ratings, book.item(SHOW).text) == ((("1", "9"), ("2", "6")), "7.5")
    assert [(e.judge, e.old_text, e.text) for e in book.book.sheet.history] == [
        ("1", "", "8"), ("2", "", "6"), ("1", "8", "9")]
    book.book.withdraw(book.now, By("Anna"), 3)
    assert book.item(SHOW).text == "7"
    book.set(SHOW, text="", judge="2")
    assert (book.item(SHOW).ratings, book.item(SHOW).text) == ((("1", "8"),), "8")


def test_a_rating_ends_the_mark_not_attempted_and_the_others_count_again(book):
    book.set(SHOW, text="8", judge="1").set(SHOW, not_attempted=True)
    assert (book.item(SHOW).not_attempted, book.item(SHOW).points) == (True, "0")
    book.set(SHOW, text="6", judge="2")
    assert (book.item(SHOW).not_attempted, book.item(SHOW).text) == (False, "7")


def test_the_mark_not_attempted_of_a_rating_can_be_taken_back(book):
    book.set(SHOW, text="8", judge="1").set(SHOW, not_attempted=True).set(SHOW)
    assert (book.item(SHOW).not_attempted, book.item(SHOW).text) == (False, "8")


def test_ratings_of_two_judges_within_a_moment_are_two_entries(book):
    for judge in "12":
        book.book.mark(book.now, "Anna", Mark(*SHOW.key, text="5", judge=judge))
    assert [entry.judge for entry in book.book.sheet.history] == ["1", "2"]


# -- the record -------------------------------------------------------------------------------------


def test_a_plain_sheet_is_recorded_as_ever():
    record = RunBook(benchmark("HGTKMH").form).into(Book().record(points=None, form=None))
    assert (record.points, record.form) == (None, None)
    assert "points" not in str(to_json(record)["items"])
    assert set(to_json(record)["items"][0]) == {"group", "desc", "kind", "value"}


def test_a_correction_counts_by_the_rules_of_the_run(book):
    book.set(OBJECTS, 1).end()
    run = FinishedRun(from_json(RunRecord, to_json(book.record())), event("X").benchmark)
    run.mark(book.now.later(60.0), "Anna", Mark(*OBJECTS.key, 3))
    assert run.record.points.total == "60"
    with pytest.raises(Refused, match="from 0 to 5"):
        run.mark(book.now, "Anna", Mark(*OBJECTS.key, 6))


def test_a_run_that_an_earlier_version_began_keeps_the_order_of_its_entries():
    form = SheetForm((ScoringItem("g", "a", ScoreKind.UINT, Decimal(10)),))
    sheet = ScoreSheet(form.items, rules=sheet_of(form))
    for moment, value, clock_s in ((1.0, 3, None), (10.0, 1, 5.0), (20.0, 2, None)):
        sheet.set(Now(moment, moment), "Anna", Mark("g", "a", value), clock_s=clock_s)
        assert counted(form, sheet.items(), sheet.course(0.0, "")).points.total == str(10 * value)


def test_a_sheet_of_an_old_journal_has_no_points():
    old = {"identity": "HWV-1-2", "zone": "Home", "benchmark": "HWV", "team": "Alpha", "round": 1, "run": 1,
           "scheduled": 1.0, "opened_utc": 2.0, "end_reason": "stopped", "items": [
               {"group": "Good", "desc": "door", "kind": "bool", "value": 1},
               {"group": "Good", "desc": "of the future", "kind": "colour", "value": 0}],
           "history": [{"number": 1, "utc": 3.0, "who": "Anna", "group": "Good", "desc": "door", "old": 0, "value": 1}]}
    record = from_json(RunRecord, old)
    assert record.items[0] == ItemRecord("Good", "door", "bool", 1)
    run = FinishedRun(record, benchmark("HWV"))
    run.mark(Now(1.0, UTC0), "Anna", Mark("Good", "door", 0))
    assert [(item.desc, item.value, item.points) for item in run.record.items] == [
        ("door", 0, ""), ("of the future", 0, "")]
    assert run.record.points is None


@pytest.mark.parametrize("text", ["ten", "NaN", 10])
def test_a_damaged_rule_is_no_traceback(book, text):
    frozen = to_json(book.record())
    frozen["form"]["items"][0]["points"] = text
    with pytest.raises(BadData):
        from_json(RunRecord, frozen)


def test_points_are_counted_once_until_something_changes(book):
    book.set(OBJECTS, 1)
    first = book.book.counted("")
    assert book.book.counted("") is first
    book.set(OBJECTS, 2)
    assert book.book.counted("").points.total == "40"


def test_a_sheet_without_points_is_not_counted():
    form = SheetForm((ScoringItem("G", "d", ScoreKind.INT),))
    assert counted(form, (), Course()) == ((), None)
    assert not form.is_plain


