"""Stages: teams ranked by several tests. Real competitions give what they published (test/data/competitions)."""

import json
import pathlib
import random
import re
import tempfile
from decimal import Decimal
from fractions import Fraction

import pytest

from roah_rsbb.model.rules import Adjusted, Attempts, AttemptsRule
from roah_rsbb.rulebook.errors import ConfigErrors
from roah_rsbb.rulebook.standing_rules import read_rules
from roah_rsbb.scoring.stages import Result, number_of, rank

ROOT = pathlib.Path(__file__).resolve().parents[3]
COMPETITIONS = ROOT / "test" / "data" / "competitions"


def results(attempts):
    """Results as the stages take them: of each test, the points of each team's attempts. None: not attempted."""
    return {test: {team: [Result(Fraction(points)) for points in numbers if points is not None]
                   for team, numbers in teams.items()} for test, teams in attempts.items()}


def rules_of(text, codes=None, teams=None):
    """The rules in a text."""
    with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
        file.write(text)
        file.flush()
        return read_rules(file.name, codes, teams)


def ranked(text, attempts, given=(), teams=()):
    """The rankings of the stages of a file. `given`: team, adjustment, points, of the first stage."""
    rules = rules_of(text, tuple(attempts))
    adjusted = [Adjusted(team, rules.stages[0].name, name, Decimal(points)) for team, name, points in given]
    return rank(rules.stages, results(attempts), {code: own.attempts for code, own in rules.items()},
                [*rules.adjusted, *adjusted], teams)


def table(ranking):
    """The teams in their order: place, name, sum for the eye."""
    return [(line.place, line.team, None if line.total is None else round(float(line.total), 2))
            for line in ranking.lines]


# -- real competitions ------------------------------------------------------------------------------

TASKS_AND_FINAL = """
stages:
  - {{ name: Tasks, of: [TESTS], advance: {advance} }}
  - name: Final ranking
    teams: Tasks
    of: [ {{ stage: Tasks, weight: {weight} }}, {{ test: Final, weight: {weight} }} ]
    normalised: best
    others: {others}
"""
MEANS = "".join(f"\n{code}: {{ runs: mean of the best 2 }}" for code in ("HRI", "PP", "DL", "GPSR"))
RULES = {
    "german_open_2025": TASKS_AND_FINAL.format(advance=3, weight=50, others="zero"),
    "german_open_2026": TASKS_AND_FINAL.format(advance=4, weight=100, others="below") + MEANS,
    "salvador_2025_dspl": TASKS_AND_FINAL.format(advance=3, weight=0.5, others="below"),
    "salvador_2025_opl": TASKS_AND_FINAL.format(advance=2, weight=0.5, others="below"),
    "portugal_open_2026": "stages: [ { name: Tasks, of: [TESTS] } ]",
}
DIGITS = {"final_ranking_rounded": 0, "final_ranking_two_decimals": 2, "final_ranking_three_decimals": 3}


@pytest.mark.parametrize("name", RULES)
def test_a_real_competition_gives_what_it_published(name):
    found = json.loads((COMPETITIONS / f"{name}.json").read_text())
    tests = {test.replace(" ", ""): teams for test, teams in found["tests"].items()}
    final = {"Final": {team: [points] for team, points in found.get("final", {}).items()}}
    rules = RULES[name].replace("TESTS", ", ".join(f"{{ test: {code} }}" for code in tests))
    tasks, *last = ranked(rules, {**tests, **final})

    published = found["published"]
    totals = {line.team: line.total for line in tasks.lines}
    assert totals == {team: Fraction(str(total)) for team, total in published["totals"].items()}
    assert [line.team for line in tasks.lines] == sorted(totals, key=totals.get, reverse=True)
    for key in DIGITS.keys() & published.keys():
        assert {line.team: round(float(line.total), DIGITS[key]) for line in last[0].lines if line.total is not None
                } == published[key]
    for final_ranking in last:
        assert [line.team for line in final_ranking.lines] == published.get("ranking", [*published["totals"]])
        assert [line.place for line in final_ranking.lines] == list(range(1, len(totals) + 1))


# -- RoboCup@Home 2026 ------------------------------------------------------------------------------

# Six teams; D and E have penalties outside any run, and F did not attend.
ATTEMPTS = {
    "HRI": {"A": [400, 650, 500], "B": [720, 300], "C": [100, 230], "D": [300, 180], "E": [60, 0], "F": [0, 60]},
    "PickAndPlace": {"A": [300, 0, 700], "B": [195, 195], "C": [660, 135], "D": [35, 15], "E": [0, 0], "F": [15, 15]},
    "GPSR": {"A": [200, 500], "B": [790, 640], "C": [100, 0], "D": [240, 540], "E": [80, 180], "F": [0, 100]},
    "Laundry": {"A": [115, 415], "B": [0, 15], "C": [615, 450], "D": [15, 15], "E": [15, 0], "F": [0, 115]},
    "Restaurant": {"A": [560], "B": [980], "C": [300], "D": [1200], "E": [], "F": [-500]},
    "Final": {"A": [1400], "B": [2200], "C": [1500]},
}
GIVEN = [("D", "No referee provided", -250), ("E", "Appearance", -50)]
AT_HOME = """
stages:
  - name: Tasks
    of: [ { test: HRI }, { test: PickAndPlace }, { test: GPSR }, { test: Laundry }, { test: Restaurant } ]
    adjustments: { No referee provided: -250, Appearance: { from: -50, to: 0 } }
    advance: { 0: 3, 9: { decide: Finalists of nine teams, 4: 4, 3: 3 }, 10: 4, 15: 5, 21: 6 }
    asks: yes
  - name: Final ranking
    teams: Tasks
    of: [ { stage: Tasks, weight: 50 }, { test: Final, weight: 50 } ]
    normalised: best finalist
    others: below
"""


def at_home(*changes):
    """The rankings of the example, with other rules."""
    text = AT_HOME
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return ranked(text, ATTEMPTS, GIVEN)


def test_the_sums_of_the_tasks_and_who_advances():
    tasks, _ = at_home()
    assert table(tasks) == [(1, "A", 2825), (2, "B", 2700), (3, "C", 1905), (4, "D", 1840), (5, "E", 205),
                            (6, "F", -210)]
    assert (tasks.advance, tasks.undecided) == (("A", "B", "C"), ())
    assert [line.adjusted for line in tasks.lines] == [0, 0, 0, -250, -50, 0]


NORMALISED = "normalised: best finalist"


@pytest.mark.parametrize("changes, expected", [
    # 50 × 2700 / 2825 + 50; 50 + 50 × 1400 / 2200; 50 × 1905 / 2825 + 50 × 1500 / 2200
    ([], [("B", 97.79), ("A", 81.82), ("C", 67.81)]),
    ([(NORMALISED, "normalised: best")], [("B", 97.79), ("A", 81.82), ("C", 67.81)]),
    # places 2 and 1; 1 and 3; 3 and 2
    ([(NORMALISED, "normalised: rank"), ("50 }", "0.5 }")], [("B", 1.5), ("A", 2), ("C", 2.5)]),
    # 50 × 2700 / 13230 + 50; 50 × 2825 / 13230 + 50 × 1400 / 2200; 50 × 1905 / 13230 + 50 × 1500 / 2200
    ([("stage: Tasks, weight: 50", "stage: Tasks, weight: 50, normalised: maximum, maximum: 13230")],
     [("B", 60.2), ("A", 42.49), ("C", 41.29)]),
    # 50 × (2700 − 1905) / 920 + 50; 50 + 0; 0 + 50 × 100 / 800
    ([(NORMALISED, "normalised: worst to best")], [("B", 93.21), ("A", 50), ("C", 6.25)]),
    ([(NORMALISED, "normalised: no"), ("50 }", "1 }")], [("B", 4900), ("A", 4225), ("C", 3405)]),
    # The Final by its places: the first has 1, the second 2/3, the third 1/3.
    ([("test: Final, weight: 50", "test: Final, weight: 50, normalised: rank")],
     [("B", 97.79), ("C", 67.05), ("A", 66.67)]),
])
def test_the_final_ranking_in_each_reading(changes, expected):
    _, last = at_home(*changes)
    assert table(last) == [(place, team, total) for place, (team, total) in enumerate(expected, 1)] + [
        (4, "D", None), (5, "E", None), (6, "F", None)]
    assert {(line.numbers, line.adjusted, line.disqualified) for line in last.lines[3:]} == {((None, None), 0, False)}


def test_who_is_not_in_the_final_may_be_ranked_with_all():
    """50 × 1840 / 2825, 205 / 2825, −210 / 2825."""
    _, last = at_home(("others: below", "others: zero"))
    assert table(last)[2:] == [(3, "C", 67.81), (4, "D", 32.57), (5, "E", 3.63), (6, "F", -3.72)]


@pytest.mark.parametrize("others, expected", [
    ("below", [(1, "A", 2), (2, "B", -9.4), (3, "C", None)]), ("zero", [(1, "A", 2), (2, "C", 0.59), (3, "B", -9.4)])])
def test_with_0_a_team_outside_the_final_can_pass_one_inside(others, expected):
    rules = f"""
stages:
  - {{ name: Tasks, of: [{{ test: T }}], advance: 2 }}
  - {{ name: Last, teams: Tasks, of: [{{ stage: Tasks }}, {{ test: Final }}], normalised: best, others: {others} }}
"""
    _, last = ranked(rules, {"T": {"A": [100], "B": [60], "C": [59]}, "Final": {"A": [10], "B": [-100]}})
    assert table(last) == expected


def test_the_best_team_may_be_one_that_did_not_advance():
    rules = """
stages:
  - { name: Tasks, of: [{ test: T }], advance: 1, ties: [U] }
  - { name: Last, teams: Tasks, of: [{ test: T }, { stage: Tasks, weight: 0 }, { test: Other }], normalised: SCALE }
"""
    attempts = {"T": {"A": [50]}, "U": {}, "Other": {"A": [5], "B": [10]}}
    for scale, expected in (("best", 2), ("best finalist", 2)):
        _, last = ranked(rules.replace("SCALE", scale), attempts)
        assert last.lines[0].total == expected, "a result of a team that did not advance is no reference"
    more = """
stages:
  - { name: One, of: [{ test: T }] }
  - { name: Two, of: [{ test: U }], advance: 1 }
  - { name: Last, teams: Two, of: [{ stage: One }], normalised: SCALE }
"""
    attempts = {"T": {"A": [50], "B": [100]}, "U": {"A": [1], "B": [0]}}
    assert [ranked(more.replace("SCALE", scale), attempts)[-1].lines[0].total
            for scale in ("best", "best finalist")] == [Fraction(1, 2), 1]


@pytest.mark.parametrize("teams, finalists", [
    (2, 2), (3, 3), (8, 3), (9, 4), (10, 4), (14, 4), (15, 5), (20, 5), (21, 6), (30, 6)])
def test_so_many_advance(teams, finalists):
    attempts = {**{test: {} for test in ATTEMPTS}, "HRI": {f"T{number:02}": [number] for number in range(teams)}}
    tasks, last = ranked(AT_HOME, attempts)
    assert tasks.advance == tuple(f"T{number:02}" for number in reversed(range(teams)))[:finalists]
    assert len(last.lines) == teams
    tasks, _ = ranked(AT_HOME.replace("4: 4, 3: 3", "3: 3, 4: 4"), attempts)
    assert len(tasks.advance) == (3 if teams == 9 else finalists)


# -- attempts ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("rule, expected", [
    ("best", 650), ("last", 500), ("first", 400), ("sum", 1550), ("mean", Fraction(1550, 3)), ("median", 500),
    ("mean of the best 2", 575), ("sum of the best 2", 1150), ("median of the best 2", 575),
    ("mean of the best 1", 650), ("mean of the best 9", Fraction(1550, 3)),
])
def test_attempts_become_one_number(rule, expected):
    attempts = {"T": {"A": [400, 650, 500]}}
    of_test, = ranked(f"T: {{ runs: {rule} }}\nstages: [{{ name: S, of: [{{ test: T }}] }}]", attempts)
    of_column, = ranked(f"stages: [{{ name: S, of: [{{ test: T, attempts: {rule} }}] }}]", attempts)
    assert [found.lines[0].total for found in (of_test, of_column)] == [expected] * 2


def test_what_is_charged_to_the_team_and_what_an_extra_run_replaces():
    charged = [Result(Fraction(0), charged=Fraction(-500)), Result(Fraction(15)), Result(Fraction(415))]
    assert number_of(AttemptsRule(), charged) == -85, "whichever attempt counts"
    assert number_of(AttemptsRule(Attempts.LAST), charged) == -85
    extra = [Result(Fraction(700)), Result(Fraction(100), replaces=True)]
    assert [number_of(AttemptsRule(how), extra) for how in (Attempts.BEST, Attempts.FIRST, Attempts.SUM)] == [100] * 3
    assert number_of(AttemptsRule(Attempts.SUM), [*extra, Result(Fraction(5), replaces=True), *charged]) == -65
    assert number_of(AttemptsRule(), [Result(None), Result(Fraction(-5))]) == -5, "no number is the worst"
    assert number_of(AttemptsRule(Attempts.LAST), [*charged[1:], Result(None, counts=False)]) == 415


def test_a_column_may_be_of_rounds_or_events():
    stages = rules_of("""
stages: [{ name: S, of: [{ test: T, rounds: [1, 3] }, { test: T, weight: 10, events: [b] }, { test: T, rounds: [4] }] }]
""", ["T"]).stages
    found = [Result(Fraction(1), 1, "a"), Result(Fraction(2), 2, "b"), Result(Fraction(4), 3, "c")]
    ranking, = rank(stages, {"T": {"A": found}}, {"T": AttemptsRule(Attempts.SUM)})
    assert ranking.lines[0].numbers == (5, 20, 0)
    assert ranking.lines[0].results == (found[0], found[2], found[1])
    assert list(ranking.notes) == ["T (round 4): no run counts yet"]


# -- ties -------------------------------------------------------------------------------------------

TIED = {"T": {"A": [5], "B": [3], "C": [3], "D": [1]}, "U": {"A": [0], "B": [1], "C": [2], "D": [3]},
        "Deciding": {"B": [9], "C": [8]}}
B_BEFORE_C = (1, "A"), (2, "B"), (3, "C"), (4, "D")
C_BEFORE_B = (1, "A"), (2, "C"), (3, "B"), (4, "D")
TOGETHER = (1, "A"), (2, "B"), (2, "C"), (4, "D")


@pytest.mark.parametrize("of, ties, expected", [
    ("{ test: T }", "", TOGETHER), ("{ test: T }", ", ties: [U]", C_BEFORE_B),
    ("{ test: T }, { test: U, weight: 0 }", ", ties: [U]", TOGETHER),
    ("{ test: T }", ", ties: [T, Deciding, U]", B_BEFORE_C),
    ("{ test: T, normalised: rank }", ", ties: [U]", C_BEFORE_B),
    ("{ test: T, normalised: rank }, { test: U, weight: 0, normalised: rank }", ", ties: [T, U]", TOGETHER),
])
def test_ties_are_decided_or_places_shared(of, ties, expected):
    found, = ranked(f"stages: [{{ name: S, of: [{of}]{ties} }}]", TIED)
    assert tuple((line.place, line.team) for line in found.lines) == expected
    assert [line.tied for line in found.lines] == [
        sum(place == other for other, _ in expected) > 1 for place, _ in expected]
    decides = {TOGETHER: [], B_BEFORE_C: ["Deciding"], C_BEFORE_B: ["U"]}[expected]
    assert [step for step in found.steps if " tie " in step] == [
        f"{'B, C' if by == 'Deciding' else 'C, B'} tie for S, place 2: {by} decides" for by in decides]


@pytest.mark.parametrize("scale, expected", [("no", ["C", "B"]), ("rank", ["B", "C"])])
def test_an_earlier_stage_decides_a_tie(scale, expected):
    """U as points: C has more. Its places, added: B has fewer if less was better there."""
    rules = f"""
stages:
  - {{ name: Before, of: [{{ test: U }}, {{ test: Deciding, weight: 9 }}], normalised: {scale} }}
  - {{ name: S, of: [{{ test: T }}], ties: [Before] }}
"""
    _, found = ranked(rules, {**TIED, "Deciding": {"B": [Fraction("0.1")]}} if scale == "no" else TIED)
    assert [line.team for line in found.lines][1:3] == expected


@pytest.mark.parametrize("more, advance, undecided, notes", [
    ("asks: yes", ("A",), ("B", "C"), 1), ("asks: yes, chosen: [C]", ("A", "C"), (), 0),
    ("asks: yes, chosen: [D]", ("A", "D"), ("B", "C"), 1), ("asks: yes, chosen: [C, D]", ("A", "C", "D"), (), 0),
    ("asks: no", ("A", "B", "C"), (), 1), ("asks: yes, ties: [U]", ("A", "C"), (), 0),
    ("asks: yes, ties: [Deciding]", ("A", "B"), (), 0),
])
def test_a_tie_where_only_some_can_advance(more, advance, undecided, notes):
    rules = f"""
stages:
  - {{ name: S, of: [{{ test: T }}], advance: 2, {more} }}
  - {{ name: Next, teams: S, of: [{{ test: U }}] }}
"""
    first, following = ranked(rules, TIED)
    assert (first.advance, first.undecided) == (advance, undecided)
    assert len([note for note in first.notes if " tie, " in note]) == notes
    assert [line.team for line in following.lines if line.total is not None] == sorted(
        advance, key=lambda team: -TIED["U"][team][0])
    assert ("Next: who advances from S is not decided yet" in following.notes) is bool(undecided)


# -- outside any run --------------------------------------------------------------------------------

OUTSIDE = """
stages:
  - name: Tasks
    of: [{ test: T }]
    adjustments:
      Late: { points: -250, times: 1 }
      Missing: -250
      Untidy: { from: -50, to: 0 }
      Out: { disqualified: HOW }
    advance: 2
  - { name: Last, teams: Tasks, of: [{ stage: Tasks }, { test: Final }] }
"""
FOUR = {"T": {"A": [100], "B": [90], "C": [80], "D": [70]}, "Final": {"A": [1], "B": [2], "C": [3]}}


def test_adjustments_count_each_time_or_at_most_so_often():
    rules = OUTSIDE.replace("HOW", "last")
    given = [*[("A", "Late", -250)] * 2, *[("B", "Missing", -250)] * 2, ("C", "Untidy", -30)]
    first, _ = ranked(rules, FOUR, given)
    assert {line.team: line.total for line in first.lines} == {"A": -150, "B": -410, "C": 50, "D": 70}
    assert not any(line.disqualified for line in first.lines)
    assert "A: Late counts at most 1 times" in first.steps
    assert "B: T 90 − Missing 500 = −410" in first.steps
    least, _ = ranked(rules.replace("advance: 2", "min: 0"), FOUR, given)
    assert {line.team: line.total for line in least.lines} == {"A": 0, "B": 0, "C": 50, "D": 70}
    assert "B: T 90 − Missing 500, at least 0: 0" in least.steps


def test_a_team_that_only_has_a_penalty_is_ranked():
    attempts = {**FOUR, "T": {**FOUR["T"], "Wes": []}}
    first, _ = ranked(OUTSIDE.replace("HOW", "last"), attempts, [("Zed", "Missing", -250)], teams=["Yan"])
    assert table(first)[-3:] == [(5, "Wes", 0), (5, "Yan", 0), (7, "Zed", -250)]


@pytest.mark.parametrize("how, places, advance, last", [
    ("last", [(1, "B"), (2, "C"), (3, "D"), (4, "A")], ("B", "C"), [(1, "B"), (2, "C"), (3, "D"), (4, "A")]),
    ("out of the list", [(1, "B"), (2, "C"), (3, "D")], ("B", "C"), [(1, "B"), (2, "C"), (3, "D")]),
    ("its place stays free", [(2, "B"), (3, "C"), (4, "D")], ("B",), [(2, "B"), (3, "C"), (4, "D")]),
])
def test_a_team_that_is_disqualified_for_the_competition(how, places, advance, last):
    first, following = ranked(OUTSIDE.replace("HOW", how), FOUR, [("A", "Out", 0)])
    assert [(line.place, line.team) for line in first.lines] == places
    assert first.advance == advance
    assert [(line.place, line.team) for line in following.lines] == last
    assert "A: Out" in first.steps


# -- words ------------------------------------------------------------------------------------------


def test_the_steps_say_how_a_sum_came_about():
    tasks, last = at_home()
    assert {"A, HRI: best of 400, 650, 500: 650",
            "D: HRI 300 + PickAndPlace 35 + GPSR 540 + Laundry 15 + Restaurant 1200 − No referee provided 250 = 1840",
            "F: HRI 60 + PickAndPlace 15 + GPSR 100 + Laundry 115 − Restaurant 500 = −210",
            "Tasks: 3 of 6 advance: A, B, C"} <= {*tasks.steps}
    assert "Tasks: 3 of 6 advance: A, B, C" in tasks.notes
    _, of_range = at_home((NORMALISED, "normalised: worst to best"))
    assert "B, Tasks: 50 × 795 / 920 = 43.207" in of_range.steps
    assert {"B, Tasks: 50 × 2700 / 2825 = 47.788", "B: Tasks 47.788 + Final 50 = 97.788"} <= {*last.steps}


def test_the_steps_about_attempts():
    def steps(*attempts):
        ranking, = rank(rules_of("stages: [{ name: S, of: [{ test: T }], min: -85 }]", ["T"]).stages,
                        {"T": {"A": [Result(Fraction(points), **more) for points, more in attempts]}}, {})
        return ranking.steps

    assert steps(("1/2", {})) == ("A: T 0.5 = 0.5",)
    assert steps((0, {}), (0, {})) == ("A, T: best of 0, 0: 0", "A: 0 = 0")
    assert steps((0, {"charged": -500}), (415, {})) == (
        "A, T: best of 0, 415: 415", "A, T: −500 for the team, whichever attempt counts", "A: −T 85 = −85")
    assert steps((7, {}), (5, {"replaces": True})) == (
        "A, T: the attempts before the extra one do not count", "A: T 5 = 5")


def test_notes_name_what_is_missing_or_does_not_count():
    _, last = ranked(AT_HOME, {**ATTEMPTS, "Final": {"D": [5]}}, GIVEN)
    assert list(last.notes) == ["D has a result in Final but did not advance: it does not count in Final ranking",
                                "Final: no run counts yet"]
    halves, = ranked("stages: [{ name: S, of: [{ test: T }], normalised: best }]", {"T": {"A": ["1/2"], "B": ["1/8"]}})
    assert table(halves) == [(1, "A", 1), (2, "B", 0.25)]
    zeros, = ranked("stages: [{ name: S, of: [{ test: T }], normalised: best }]", {"T": {"A": [0], "B": [-1]}})
    assert table(zeros) == [(1, "A", 0), (1, "B", 0)]
    assert list(zeros.notes) == ["T counts 0: no team has more than 0"]


# -- the file ---------------------------------------------------------------------------------------


def test_the_example_of_the_documentation_is_read():
    examples = re.findall("```yaml\n(.*?)```", (ROOT / "docs" / "results.md").read_text(), re.DOTALL)
    example = next(each for each in examples if each.startswith("stages:"))
    rules = rules_of(example, ["HGTKMH", "HWV", "HCFGAC", "HOPF"], ["Alpha", "Bravo", "Charlie"])
    assert [stage.name for stage in rules.stages] == ["Tasks", "Final ranking"]
    assert list(map(str, rules.adjusted)) == ["Alpha, Tasks: No referee provided -250 (day 2, 10:00)",
                                              "Bravo, Tasks: Untidy robot -30"]


WRITTEN = """
stages:
  - name: Tasks
    of: [{ test: HRI }, { test: GPSR, weight: 2, attempts: best }]
    adjustments: { Late: -5, Untidy: { from: -50, to: 0 }, Out: { disqualified: last } }
    advance: { 0: 3, 9: 4 }
    ties: [GPSR]
    given: [{ team: Alpha, adjustment: Late }, { team: Bravo, adjustment: Untidy, points: -30 }]
  - name: Last
    teams: Tasks
    of: [{ stage: Tasks }, { test: Final, weight: 3 }]
    normalised: best
    others: below
"""
NAMES = ("HRI", "GPSR", "Final"), ("Alpha", "Bravo")


@pytest.mark.parametrize("old, new, line, expected", [
    ("test: HRI", "test: HIR", 4, "did you mean 'HRI'?"), ("{ test: HRI }", "{ }", 4, "with neither"),
    ("test: HRI", "test: HRI, stage: Tasks", 4, "'test' and 'stage'"), ("test: HRI", "test: GPSR", 4, "'GPSR' again"),
    ("weight: 2", "weight: -2", 4, "weight"), ("attempts: best", "attempts: best of 3", 4, "mean of the best 2"),
    ("attempts: best", "attempts: last of the best 2", 4, "mean of the best 2"),
    ("attempts: best", "rounds: [0]", 4, "round"), ("attempts: best", "worth: 3", 4, "unknown key 'worth'"),
    ("attempts: best", "normalised: maximum", 4, "maximum: 500"), ("Late: -5", "Late: five", 5, "'five'"),
    ("from: -50", "from: 50", 5, "'from' 50 above 'to' 0"),
    ("disqualified: last", "disqualified: first", 5, "disqualified team"),
    ("disqualified: last", "disqualified: last, points: 3", 5, "only 'disqualified'"),
    ("0: 3", "4: 3", 6, "also '0: 3'"), ("9: 4", "nine: 4", 6, "'nine'"), ("9: 4", "9: 0", 6, "how many advance"),
    ("[GPSR]", "[GPRS]", 7, "did you mean 'GPSR'?"), ("[GPSR]", "[Last]", 7, "a test, or an earlier stage"),
    ("adjustment: Late", "adjustment: Lte", 8, "did you mean 'Late'?"),
    ("team: Alpha", "team: Alpah", 8, "did you mean 'Alpha'?"), ("points: -30", "points: -60", 8, "from -50 to 0"),
    (", points: -30", "", 8, "without points"),
    ("adjustment: Late", "adjustment: Late, points: 3", 8, "none: the rules give them"),
    ("name: Last", "name: Tasks", 9, "the stage 'Tasks' again"), ("teams: Tasks", "teams: Task", 10, "'Tasks'"),
    ("    teams: Tasks\n", "", 12, "also 'teams: NAME OF A STAGE'"),
    ("stage: Tasks", "stage: Last", 11, "an earlier stage"),
    ("stage: Tasks", "stage: Tasks, attempts: best", 11, "only beside 'test'"),
    ("normalised: best", "normalised: bets", 12, "did you mean 'best'?"),
    ("others: below", "others: above", 13, "below"),
    ("ties: [GPSR]", "normalised: rank", 11, "'normalised: rank'"), ("ties: [GPSR]", "asks: perhaps", 7, "yes or no"),
    ("ties: [GPSR]", "chosen: [Zulu]", 7, "a team of the schedule"),
])
def test_an_error_names_its_line_and_the_remedy(old, new, line, expected):
    assert old in WRITTEN
    rules_of(WRITTEN, *NAMES)
    with pytest.raises(ConfigErrors) as caught:
        rules_of(WRITTEN.replace(old, new, 1), *NAMES)
    assert [error.line for error in caught.value.errors] == [line], caught.value
    assert expected in str(caught.value)


# -- a second computation ---------------------------------------------------------------------------


def plainly(chance):
    """Random stages as a text, their attempts, and what they give, computed slowly and plainly."""
    teams = "ABCDEFG"[:chance.randint(1, 7)]
    attempts = {test: {team: [chance.randint(-3, 9) for _ in range(chance.randint(0, 3))] for team in teams}
                for test in ("T", "U", "Final")}
    rule = chance.choice(["best", "last", "mean of the best 2"])
    weight, advance = chance.randint(0, 3), chance.randint(1, 7)
    scale, others = chance.choice(["no", "best", "rank"]), chance.choice(["below", "zero"])
    text = f"""
T: {{ runs: {rule} }}
stages:
  - {{ name: Tasks, of: [{{ test: T }}, {{ test: U, weight: {weight} }}], advance: {advance}, ties: [U] }}
  - name: Last
    teams: Tasks
    of: [{{ stage: Tasks }}, {{ test: Final, weight: 2 }}]
    normalised: {scale}
    others: {others}
"""

    def of_attempts(points, rule):
        if not points:
            return Fraction(0)
        best = sorted(points, reverse=True)[:2]
        return {"best": Fraction(best[0]), "last": Fraction(points[-1])}.get(rule, Fraction(sum(best), len(best)))

    number = {test: {team: of_attempts(points, rule if test == "T" else "best") for team, points in own.items()}
              for test, own in attempts.items()}
    tasks = {team: number["T"][team] + weight * number["U"][team] for team in teams}
    better = {team: (tasks[team], number["U"][team] if weight else 0) for team in teams}
    place = {team: 1 + sum(better[other] > better[team] for other in teams) for team in teams}
    inside = [team for team in teams if place[team] <= advance]
    ranked_here = inside if others == "below" else teams
    final = {team: number["Final"][team] if team in inside else Fraction(0) for team in ranked_here}
    last = {}
    for team in ranked_here:
        parts = []
        for numbers, of_all, times in ((tasks, tasks, 1), (final, final, 2)):
            own = {one: numbers[one] for one in ranked_here}
            most = max([of_all[one] for one in of_all if numbers is tasks or attempts["Final"][one]], default=0)
            parts.append(times * {"no": own[team], "best": own[team] / most if most > 0 else Fraction(0),
                                  "rank": 1 + sum(value > own[team] for value in own.values())}[scale])
        last[team] = sum(parts)
    sign = -1 if scale == "rank" else 1
    places = {team: 1 + sum(sign * last[other] > sign * last[team] for other in last) for team in last}
    places.update({team: 1 + len(last) + sum(place[other] < place[team] for other in teams if other not in last)
                   for team in teams if team not in last})
    return text, attempts, (tasks, place), ({team: last.get(team) for team in teams}, places)


@pytest.mark.parametrize("seed", range(60))
def test_a_slow_and_plain_computation_gives_the_same(seed):
    text, attempts, *expected = plainly(random.Random(seed))
    found = ranked(text, attempts)
    assert [({line.team: line.total for line in each.lines}, {line.team: line.place for line in each.lines})
            for each in found] == expected
