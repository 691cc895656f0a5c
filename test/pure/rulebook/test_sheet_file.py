"""The keys `sheet` and `incidents` of a benchmark."""

from decimal import Decimal

import pytest

from helpers.config_files import line_of
from roah_rsbb.core.views.sheets import sheet_items
from roah_rsbb.model.rules import Condition, Incident, Item, ItemChoice, JuryResult, Measure, Voids
from roah_rsbb.model.scoring import INCIDENTS, SheetForm
from roah_rsbb.model.scoring import rows as rows_of
from roah_rsbb.rulebook.config import load_benchmarks
from roah_rsbb.rulebook.errors import ConfigErrors, known
from roah_rsbb.scoring.sheet import ScoreSheet
from roah_rsbb.scoring.tree import Course, SheetMark, count

HEAD = """\
- name: Test 1
  desc: Carry out spoken commands
  code: Commands
  kind: task
  timeout: 420
"""
TEXT = HEAD + """\
  sheet:
    - section: Test
      min: 0
      items:
        - section: Main goal
          items:
            - item: Understands the command
              id: 0
              points: 80
              times: 3
              min: 0
              items:
                - { item: With a custom operator, points: -20, times: 3 }
                - { item: Asks again, points: -30, times: 6 }
            - { item: Solves the first command, points: 250, amount: percent, tags: [planning, speech] }
            - item: All at once
              points: 200
              needs: [Understands the command, {item: How they came, is: all at once}]
            - { item: How they came, choices: [all at once, one by one] }
        - { item: Bumps into something, percent: -5, times: 4, compounding: yes }
    - section: Special
      items: [ { item: Not attending, points: -500 }, { item: Cheating, points: -500, withholds: Main goal } ]
  incidents:
    restart: { times: 1, below: 40, voids: earlier, until: restarted }
    restarted: {}
    inactive: { }
    removed: { of: inactive, after: 30, until: active again, longer_by: longer time, longer: 180, requests: 1,
               voids: later }
    active again: {}
    longer time: {}
    absent: { marks: Not attending, unless: { fact: announced min before, least: 60 } }
    extra run: { when: audience interference, voids: earlier runs }
"""


def _read(text, **others):
    with known({"benchmarks.yaml": text, **{f"{name}.yaml": each for name, each in others.items()}}):
        return load_benchmarks("benchmarks.yaml")["Commands"].sheet


def _of(*rows, incidents="", head=HEAD):
    """The text of a benchmark with these rows."""
    lines = "".join(f"    - {row}\n" for row in rows)
    return f"{head}  sheet:\n{lines}" + (f"  incidents:\n    {incidents}\n" if incidents else "")


def test_a_tree_of_items():
    sheet = _read(TEXT)
    D = Decimal
    assert sheet.limit_s == 420
    assert [(item.id, item.under) for item in sheet.items] == [
        ("Test", ""), ("Main goal", "Test"), ("0", "Main goal"), ("With a custom operator", "0"), ("Asks again", "0"),
        ("Solves the first command", "Main goal"), ("All at once", "Main goal"), ("How they came", "Main goal"),
        ("Bumps into something", "Test"), ("Special", ""), ("Not attending", "Special"), ("Cheating", "Special")]
    by_id = {item.id: item for item in sheet.items}
    assert by_id["Test"] == Item("Test", "Test", amount=Measure.SECTION, least=D(0))
    assert by_id["0"] == Item("0", "Understands the command", "Main goal", points=D(80), times=3, least=D(0))
    assert by_id["Asks again"] == Item("Asks again", "Asks again", "0", points=D(-30), times=6)
    assert by_id["Solves the first command"] == Item(
        "Solves the first command", "Solves the first command", "Main goal", Measure.PERCENT, D(250), times=1,
        tags=("planning", "speech"))
    assert by_id["All at once"].needs == (Condition("0"), Condition("How they came", text="all at once"))
    assert by_id["All at once"].amount is Measure.YES
    assert by_id["How they came"].choices == (ItemChoice("all at once"), ItemChoice("one by one"))
    bumps = by_id["Bumps into something"]
    assert (bumps.points, bumps.percent, bumps.compounding, bumps.times) == (None, D(-5), True, 4)
    assert by_id["Cheating"].withholds == ("Main goal",)


def test_referees_mark_its_items_and_incidents():
    with known({"benchmarks.yaml": TEXT}):
        form = load_benchmarks("benchmarks.yaml")["Commands"].form
    assert form.sheet == _read(TEXT)
    assert [(row.group, row.id) for row in form.items[:2]] == [
        ("Main goal", "0"), ("Main goal", "With a custom operator")]
    assert [row.desc for row in form.items if row.group == INCIDENTS][:2] == ["Restart", "Restarted"]


def test_incidents():
    assert _read(TEXT).incidents == (
        Incident("restart", times=1, below=Decimal(40), voids=Voids.EARLIER, ends=("restarted",)),
        Incident("restarted"),
        Incident("inactive"),
        Incident("removed", of="inactive", after=Decimal(30), ends=("active again",), longer_by="longer time",
                 longer=Decimal(180), requests=1, voids=Voids.LATER),
        Incident("active again"),
        Incident("longer time"),
        Incident("absent", marks="Not attending", unless=(Condition("announced min before", Decimal(60)),)),
        Incident("extra run", when=(Condition("audience interference"),), voids=Voids.EARLIER_RUNS),
    )


@pytest.mark.parametrize("row, expected", [
    ("item: a", Item("a", "a", amount=Measure.YES, times=1)),
    ("item: a, times: 1", Item("a", "a", amount=Measure.YES, times=1)),
    ("item: a, times: 2", Item("a", "a", times=2)),
    ("item: a, times: unlimited, each: yes", Item("a", "a", each=True)),
    ("item: a, amount: count", Item("a", "a", times=1)),
    ("item: a, amount: number, from: -1, to: 2.5, points: .5",
     Item("a", "a", amount=Measure.NUMBER, points=Decimal("0.5"), low=Decimal(-1), high=Decimal("2.5"))),
    ("item: a, amount: percent, times: unlimited, percent: -40",
     Item("a", "a", amount=Measure.PERCENT, percent=Decimal(-40))),
    ("item: a, amount: points, to: 149", Item("a", "a", amount=Measure.POINTS, points=Decimal(1), high=Decimal(149))),
    ("item: a, choices: {fully: 20, partly: 10}", Item("a", "a", amount=Measure.CHOICE, choices=(
        ItemChoice("fully", Decimal(20)), ItemChoice("partly", Decimal(10))))),
    ("item: a, amount: clock, points: 1, seconds: 10, max: 60",
     Item("a", "a", amount=Measure.CLOCK, points=Decimal(1), seconds=Decimal(10), most=Decimal(60))),
    ("item: a, judges: 2, to: 10, jury: median, points: 2",
     Item("a", "a", amount=Measure.RATING, points=Decimal(2), low=Decimal(0), high=Decimal(10), judges=("1", "2"),
          jury=JuryResult.MEDIAN)),
    ("item: a, amount: percent, each: yes, share_of_all: yes",
     Item("a", "a", amount=Measure.PERCENT, times=1, each=True, share_of_all=True)),
    ("item: a, for_team: yes", Item("a", "a", amount=Measure.YES, times=1, for_team=True)),
    ("section: a, max: 9", Item("a", "a", amount=Measure.SECTION, most=Decimal(9))),
    ("item: a, id: 7, points: 1", Item("7", "a", amount=Measure.YES, points=Decimal(1), times=1)),
])
def test_a_row(row, expected):
    assert _read(_of(f"{{{row}}}")).items == (expected,)


@pytest.mark.parametrize("needs, expected", [
    ("a", (Condition("a"),)),
    ("[a, 3]", (Condition("a"), Condition("3"))),
    ("{item: a, least: 2}", (Condition("a", Decimal(2)),)),
    ("[{item: a, since: 2, after: yes}, {item: b, each: yes}]",
     (Condition("a", since=2, after=True), Condition("3", each=True))),
])
def test_conditions(needs, expected):
    sheet = _read(_of("{item: a, times: 3}", "{item: b, id: 3}", f"{{item: c, needs: {needs}}}"))
    assert sheet.items[2].needs == expected


def test_rows_of_one_name_have_ids():
    assert [each.id for each in _read(_of("{item: Custom}", "{item: Custom, id: 12}")).items] == ["Custom", "12"]


MISTAKES = [
    # The row, what was found, what was expected.
    ("{item: a, point: 5}", "the unknown key 'point' in an item", "did you mean 'points'"),
    ("{items: []}", "a row without a name", "rows '- {item:"),
    ("{item: x}", "a second row called 'x'", "an 'id' that only this row has: it is already in line 7"),
    ("{item: a, id: x}", "the id 'x' again", "each id once"),
    ("{item: a, amount: counts}", "the text 'counts' as amount", "did you mean 'count'"),
    ("{item: a, times: 2, amount: yes or no}", "times in an item with the amount 'yes or no'", "'count'"),
    ("{item: a, times: often}", "the text 'often' as times", "a whole number, or 'unlimited'"),
    ("{item: a, points: 1, percent: 2}", "percent and points", "one of them"),
    ("{item: a, points: 1, compounding: yes}", "compounding in an item without percent", "'percent'"),
    ("{item: a, amount: percent, share_of_all: yes}", "share_of_all in an item without each", "'each'"),
    ("{item: a, needs: {item: x, after: yes}}", "after in needs without since", "since: 2"),
    ("{item: a, choices: [b, c], points: 2}",
     "the key 'points' in an item with the amount 'choice'", "the points of each"),
    ("{item: a, seconds: 2}", "the key 'seconds' in an item with the amount 'yes or no'", "'points'"),
    ("{item: a, amount: choice}", "an item with the amount 'choice' without choices", "choices: {fully"),
    ("{item: a, judges: 2}", "an item with the amount 'rating' without to", "to: 10"),
    ("{item: a, min: 2, max: 1}", "max 1 of 'a', whose min is 2", "a max above the min"),
    ("{item: a, amount: number, from: 2, to: 1}", "to 1 of 'a', whose from is 2", "a to above the from"),
    ("a row", "the text 'a row' as an item", "a map"),
    ("{item: [a]}", "a sequence ('- item', or [a, b]) as name of a row", "a text"),
    ("{item: a, section: b}", "the unknown key 'section' in an item", "a key of an item"),
    ("{item: a, choices: [b]}", "too few choices", "two or more"),
    ("{item: a, judges: [], to: 10}", "0 judges", "from 1 to 20"),
    ("{item: a, judges: 0, to: 10}", "the number '0' as judges", "a whole number from 1 to 20"),
    ("{item: a, judges: 2, to: 0}", "the number '0' as to of a rating", "a number above 0, or a from"),
    ("{item: a, judges: 2, from: -1, to: -2}", "to -2 of 'a', whose from is -1", "a to above the from"),
    ("{section: s, items: [{item: x, id: y}, {item: b, needs: z}]}", "'z' as needs", "the id or the name"),
    ("{section: s, items: [{item: c, id: y}, {item: c, id: w}, {item: b, needs: c}]}",
     "'c' as needs, which several rows are called", "the id of one of them: 'y', 'w'"),
    ("{section: s, items: [{item: a, amout: count}, {item: b, needs: a}]}", "the unknown key 'amout' in an item",
     "did you mean 'amount'"),
    ("{section: s, items: [{itm: a, points: 2}, {item: b, needs: a}]}", "a row without a name", "rows"),
    ("{item: a, needs: {itm: x}}", "the unknown key 'itm' in needs", "did you mean 'item'"),
    ("{item: a, each: yes, times: 2, items: [{item: b, amount: points}]}", "'b' under 'a'", "counts with points"),
    ("{item: a, each: yes, times: 2, items: [{item: b, items: [{item: c}]}]}", "'b' under 'a'", "counts with points"),
    ("{item: a, needs: y}", "'y' as needs", "there is 'x'"),
    ("{item: a, times: -1}", "the number '-1' as times", "a whole number, or 'unlimited'"),
    ("{item: a, needs: {item: x, is: z}}", "'is' of 'x', which has no choices", "an item with choices"),
    ("{item: a, choices: [k, l], items: [{item: b, needs: {item: a, is: m}}]}",
     "the text 'm' as is", "one of its choices"),
    ("{item: a, unless: {item: x, since: 2}}", "since in unless", "since in needs only"),
    ("{item: a, needs: a}", "conditions that depend on each other: 'a'", "without 'needs'"),
    ("{section: a, items: [{item: b, needs: a}]}",
     "conditions that depend on each other: 'a', 'b'", "one of these rows"),
    ("{item: a, needs: c, items: [{item: c}]}", "conditions that depend on each other: 'c'", "one of these rows"),
    ("{item: a, withholds: b, items: [{item: b, withholds: a}]}", "conditions that depend on each other: 'a', 'b'", ""),
    ("{item: a, each: yes, times: 2, items: [{item: b, choices: {c: 1, d: 2}}]}",
     "'b' under 'a'", "counts with points"),
]


@pytest.mark.parametrize("row, found, expected", MISTAKES, ids=[each[1] for each in MISTAKES])
def test_a_mistake_in_a_row(row, found, expected):
    with pytest.raises(ConfigErrors) as caught:
        _read(_of("{item: x}", row))
    error, = caught.value.errors
    assert (error.line, error.found[:len(found)]) == (8, found) and expected in error.expected, error


WRONG_INCIDENTS = [
    ("restart: {time: 1}", "the unknown key 'time' in the incident 'restart'", "did you mean 'times'"),
    ("restart: {voids: earliest}", "the text 'earliest' as voids", "did you mean 'earlier'"),
    ("cheating: {marks: Cheatin}", "'Cheatin' as marks", "did you mean 'Cheating'"),
    ("removed: {of: inactiv, after: 3}", "'inactiv' as of", "another incident"),
    ("{restart: {until: restarte}, restarted: {}}", "'restarte' as until", "did you mean 'restarted'"),
    ("{removed: {until: [late, removd]}, late: {}}", "'removd' as until", "did you mean 'removed'"),
    ("restart: {until: again}", "'again' as until", "also one such as 'again: {}': there is 'restart'"),
    ("{idle: {}, removed: {of: idle, after: 3, longer_by: longr}, longer: {}}", "'longr' as longer_by",
     "did you mean 'longer'"),
    ("absent: {unless: Cheatin}", "'Cheatin' as unless", "did you mean 'Cheating'"),
    ("absent: {when: [else, {fact: Cheatin, least: 2}]}", "'Cheatin' as when", "did you mean 'Cheating'"),
    ("absent: {when: {fact: How, is: late}}", "the text 'late' as is", "did you mean 'too late'"),
    ("absent: {when: {fact: Cheating, is: late}}", "'is' of 'Cheating', which has no choices", "an item with choices"),
    ("removed: {after: 3}", "after without of", "of: inactive"),
    ("restart: {net: yes}", "net without below", "below: 40"),
    ("restart: ", "nothing as the incident 'restart'", "a map '{}'"),
    ("[restart]", "a sequence ('- item', or [a, b]) as incidents", "restart: {times"),
]


@pytest.mark.parametrize("text, found, expected", WRONG_INCIDENTS, ids=[each[1] for each in WRONG_INCIDENTS])
def test_a_mistake_in_incidents(text, found, expected):
    with pytest.raises(ConfigErrors) as caught:
        _read(_of("{item: Cheating}", "{item: How, choices: [in time, too late]}", incidents=text))
    error, = caught.value.errors
    assert (error.line, error.found[:len(found)]) == (10, found) and expected in error.expected, error


def test_a_fact_is_a_row_by_its_name_or_its_id_or_comes_with_the_incident():
    incidents = "absent: {when: [Announced, '7', {fact: Announced, least: 3}, {fact: by whom, is: captain}]}"
    assert _read(_of("{item: Announced, id: 7}", incidents=incidents)).incidents[0].when == (
        Condition("7"), Condition("7"), Condition("7", Decimal(3)), Condition("by whom", text="captain"))


def _chain(rows):
    """Rows each of which needs the next two."""
    return _of(*(f"{{item: r{i}, points: 1, needs: [r{i + 1}, r{i + 2}]}}" for i in range(rows - 2)),
               *(f"{{item: r{i}, points: 1}}" for i in (rows - 2, rows - 1)))


def test_rows_that_depend_on_many_others_are_counted_at_once():
    sheet = _read(_chain(100))
    assert count(sheet, Course(tuple(SheetMark(item.id) for item in sheet.items))).total == 100
    assert count(sheet, Course(tuple(SheetMark(item.id) for item in sheet.items[:-1]))).total == 1


def test_rows_that_depend_on_too_many_others():
    with pytest.raises(ConfigErrors) as caught:
        _read(_chain(1000))
    error, = caught.value.errors
    assert error.found == "'r0', which depends on more than 100 rows, one after the other"
    assert "name fewer rows" in error.expected


def test_the_time_left_needs_a_limit():
    with pytest.raises(ConfigErrors, match="the time left as 'a' in a run without a time limit"):
        _read(_of("{item: a, amount: clock, points: 1}", head=HEAD.replace("420", "no limit")))


@pytest.mark.parametrize("late, limit_s, clock_s", [("count", None, 420), ("do not count", 420, None)])
def test_marks_after_the_time_limit(late, limit_s, clock_s):
    sheet = _read(_of("{item: a, amount: clock, points: 1}", head=HEAD + f"  late_marks: {late}\n"))
    assert (sheet.limit_s, sheet.clock_s) == (limit_s, clock_s)


def test_late_marks_need_a_sheet():
    with pytest.raises(ConfigErrors, match="late_marks in a benchmark without 'sheet'"):
        _read(HEAD + "  late_marks: count\n")


def test_one_form_of_a_sheet_in_a_benchmark():
    text = _of("{item: a}") + "  scoring:\n    - G:\n        - {type: bool, desc: a}\n"
    with pytest.raises(ConfigErrors) as caught:
        _read(text)
    assert [(error.line, error.found) for error in caught.value.errors] == [
        (line_of(text, "- {item: a}"), "sheet and scoring in one benchmark")]


# -- decisions --------------------------------------------------------------------------------------

CHOICE = "{item: a, points: {decide: Worth, five: 5, six: 6, none: nothing}}"


@pytest.mark.parametrize("chosen, points", [(None, 5), ("five", 5), ("six", 6), ("none", None)])
def test_a_value_that_is_decided(chosen, points):
    others = {} if chosen is None else {"decisions": f"Worth: {chosen}\n"}
    assert _read(_of(CHOICE), **others).items[0].points == points


def test_a_reading_may_leave_a_row_out():
    text = _of("{item: a}", "{decide: With b, no: nothing, yes: {item: b}}")
    assert [item.id for item in _read(text).items] == ["a"]
    assert [item.id for item in _read(text, decisions="With b: yes\n").items] == ["a", "b"]


def test_a_row_has_help_and_what_was_decided_about_it():
    """What was decided about a row under it is its own; a condition of a row belongs to the row."""
    text = _of(CHOICE.replace("item: a", "item: a, help: 'Once, and no more'").replace(
        "}}", "}, needs: {item: c, least: {decide: How many, one: 1, two: 2}}, "
        "items: [{item: b, times: {decide: Times, 2: 2, 3: 3}}]}"), "{decide: With c, no: nothing, yes: {item: c}}",
        incidents="{restart: {help: Ask the team, times: {decide: Restarts, one: 1, two: 2}}, fall: {}}")
    sheet = _read(text, decisions="With c: yes\nHow many: two\n")
    assert [(item.id, item.help, item.decided) for item in sheet.items] == [
        ("a", "Once, and no more", ("Worth: five", "How many: two")), ("b", "", ("Times: 2",)),
        ("c", "", ("With c: yes",))]
    assert [(one.name, one.help, one.decided) for one in sheet.incidents] == [
        ("restart", "Ask the team", ("Restarts: one",)), ("fall", "", ())]
    shown = {item.desc: (item.help, item.decided) for item in sheet_items(
        ScoreSheet(rows_of(sheet)).items(), SheetForm(rows_of(sheet), sheet=sheet))}
    assert shown == {"a": ("Once, and no more", ("Worth: five", "How many: two")), "b": ("", ("Times: 2",)),
                     "c": ("", ("With c: yes",)), "Restart": ("Ask the team", ("Restarts: one",)), "Fall": ("", ())}


def test_choices_of_other_files_are_known(tmp_path):
    standings = "stages: [{name: {decide: Name, a: A, b: B}}]\n"
    assert _read(_of(CHOICE), decisions="Name: b\n", standings=standings).items[0].points == 5


@pytest.mark.parametrize("rows, decisions, found, expected", [
    ([CHOICE], "Worthy: six", "the unknown choice 'Worthy'", "did you mean 'Worth'"),
    ([CHOICE], "Worth: sixx", "the text 'sixx' as reading of 'Worth'", "did you mean 'six'"),
    ([CHOICE, CHOICE.replace("item: a", "item: b").replace("five", "four")], "",
     "the choice 'Worth' with the readings 'four', 'six', 'none'", "those of line 7 in their order: 'five'"),
    (["{item: a, points: {decide: Worth, five: 5}}"], "", "the choice 'Worth' with 1 readings", "two or more"),
    (["{item: a}"], "Worth: six", "the unknown choice 'Worth'", "there is none"),
    ([CHOICE], "[Worth, six]", "a sequence ('- item', or [a, b]) as the file's content", "lines 'name of a choice: "),
    ([CHOICE], "{Worth: six", "a '[' or '{' that is opened here and never closed", "at its end"),
    ([CHOICE], "Worth: [six]", "a sequence ('- item', or [a, b]) as reading of 'Worth'", "one of its readings"),
    ([CHOICE], "Worth: *six", "a '*', which in YAML begins an alias", "the value itself"),
    ([CHOICE, CHOICE.replace("item: a", "item: b")], "Worth: 7", "the number '7' as reading of 'Worth'", "'five'"),
    (["{item: a, points: {decide: [Worth], five: 5, six: 6}}"], "", "a sequence ('- item', or [a, b]) as name of a "
     "choice", "a text"),
    (["{item: a, points: {decide: Worth, five: 5, five: 6}}"], "", "the key 'five' again", "each key once"),
])
def test_a_mistake_in_decisions(rows, decisions, found, expected):
    with pytest.raises(ConfigErrors) as caught:
        _read(_of(*rows), **({"decisions": decisions + "\n"} if decisions else {}))
    error, = caught.value.errors
    assert error.found == found and expected in error.expected, error
