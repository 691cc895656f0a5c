"""Standings: which runs count, the order of teams, and ties."""

import dataclasses
import pathlib
from decimal import Decimal
from fractions import Fraction

import pytest

from helpers.results_of import ACHIEVED, BUMPS, DISQUALIFYING, DOOR, OBJECTS, PENALIZED, module_record, task_record
from helpers.time_zones import local_time
from roah_rsbb.model.records import GroupPoints, ScoreValue, SheetPoints, SignOff
from roah_rsbb.model.rules import Adjusted, Adjustment, Attempts, AttemptsRule, Scale, Stage, StageColumn
from roah_rsbb.model.scoring import ScoreKind, ScoringItem, SheetForm
from roah_rsbb.results.standing_pages import standing_markup
from roah_rsbb.results.standings import number_text, public_standings, run_text, standing_lines
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, CountingAttempt, EventRules
from roah_rsbb.rulebook.errors import ConfigErrors
from roah_rsbb.rulebook.standing_rules import BY_POINTS, Criterion, Rules, StandingRules, Term, read_rules
from roah_rsbb.scoring.counting import RunChoice, Why, rulings
from roah_rsbb.scoring.standings import DAYS_OF_COMPUTER, WITHOUT_RULES, standing, standings
from roah_rsbb.wording import times

SHIPPED = pathlib.Path(__file__).resolve().parents[3] / "config" / "standings.yaml"
BEST, MEAN, MEDIAN = (AttemptsRule(how) for how in (Attempts.BEST, Attempts.MEAN, Attempts.MEDIAN))
ACHIEVEMENTS = Criterion("Achievements", True, (Term(group=ACHIEVED),))
PENALTIES = Criterion("Penalties", False, (Term(group=PENALIZED),))
TASK = Rules(BEST, (DISQUALIFYING,), (ACHIEVEMENTS, PENALTIES))
SIGNED = SignOff(1.0, "chief")
ALL = RunChoice()


@pytest.fixture(autouse=True)
def _utc():
    times.use_zone("UTC")


def ranks(records, rules=TASK, choice=ALL, code="HGTKMH"):
    """(rank, team, numbers) of each line."""
    return [(t.rank, t.team, t.numbers) for t in standing(code, records, rules, choice).lines]


def remarks(records, choice=ALL, rules=TASK):
    return "\n".join(standing("HGTKMH", records, rules, choice).remarks)


# -- order ------------------------------------------------------------------------------------------


def test_the_first_criterion_decides_and_the_next_one_where_it_ties():
    found = ranks([
        task_record("A", 1, objects=3, bumps=2), task_record("B", 2, objects=3, bumps=1),
        task_record("C", 3, door=1, objects=3, bumps=9), task_record("D", 4),
    ])
    assert found == [(1, "C", (4.0, 9.0)), (2, "B", (3.0, 1.0)), (3, "A", (3.0, 2.0)), (4, "D", (0.0, 0.0))]


def test_ties_share_a_rank_and_are_shown_as_ties():
    table = standing("HGTKMH", [
        task_record("A", 1, objects=1), task_record("C", 2, objects=2), task_record("B", 3, objects=2),
        task_record("D", 4),
    ], TASK, RunChoice())
    assert [(t.rank, t.tied, t.team) for t in table.lines] == [
        (1, True, "B"), (1, True, "C"), (3, False, "A"), (4, False, "D")
    ]
    lines = list(standing_lines(table))
    assert [text.split()[0] for text in lines[2:6]] == ["1=", "1=", "3", "4"]


def test_sums_that_differ_only_by_rounding_tie():
    weighed = Rules(BEST, (), (Criterion("Points", True, (Term(item=DOOR, weight=0.3),
                                                                Term(item=OBJECTS, weight=0.1))),))
    found = ranks([task_record("A", 1, objects=3), task_record("B", 2, door=1)], weighed)
    assert [(rank, numbers) for rank, _, numbers in found] == [(1, (Fraction(3, 10),))] * 2


def test_disqualified_teams_rank_last():
    found = ranks([
        task_record("A", 1, door=1, objects=9, hits=1), task_record("B", 2, bumps=5), task_record("C", 3, hits=2),
    ])
    assert [(rank, team) for rank, team, _ in found] == [(1, "B"), (2, "A"), (2, "C")]
    table = standing("HGTKMH", [task_record("A", 1, hits=1)], TASK, RunChoice())
    assert "disqualified" in list(standing_lines(table))[2]


def test_weights_items_and_values():
    points = Rules(BEST, (), (Criterion("Points", True, (
        Term(group=ACHIEVED, weight=10.0), Term(item=BUMPS, weight=-3.0), Term(group=ACHIEVED, item=DOOR, weight=0.5),
    )),))
    assert ranks([task_record("A", 1, door=1, objects=2, bumps=3)], points) == [(1, "A", (30.0 - 9.0 + 0.5,))]
    score = Rules(BEST, (), (Criterion("Reached", True, (Term(score="reached", weight=2.0),)),))
    assert ranks([module_record("A", 1, reached=3)], score, code="HNF") == [(1, "A", (6.0,))]
    assert ranks([module_record("A", 1, reached=True)], score, code="HNF") == [(1, "A", (2.0,))]


@pytest.mark.parametrize("more_is_better", [True, False])
@pytest.mark.parametrize("value", [None, "a text"])
def test_a_missing_value_ranks_behind_every_value(value, more_is_better):
    rules = Rules(BEST, (), (Criterion("Error", more_is_better, (Term(score="error"),)),))
    records = [module_record("A", 1, error=value), module_record("B", 2, error=9e9), module_record("C", 3, error=-1.0)]
    found = ranks(records, rules, code="HNF")
    assert [team for _, team, _ in found] == (["B", "C", "A"] if more_is_better else ["C", "B", "A"])
    assert found[-1][2] == (None,)


def test_a_value_of_part_of_the_run_does_not_count_for_the_run():
    record = module_record("A", 1)._replace(module_scores=(ScoreValue("waypoint 1", "time", "5", "s"),))
    rules = Rules(BEST, (), (Criterion("Time", False, (Term(score="time"),)),))
    table = standing("HNF", [record], rules, RunChoice())
    assert table.lines[0].numbers == (None,)
    assert f"run {record.identity} of team A has no 'time'" in table.remarks


def test_a_group_that_the_sheet_lacks_is_reported():
    assert "has no 'Achivements'" in remarks(
        [task_record("A", 1)], rules=Rules(BEST, (), (Criterion("x", True, (Term(group="Achivements"),)),))
    )


@pytest.mark.parametrize("weight, unit", [(1.0, "s"), (-1.0, "s"), (2.0, "")])
def test_a_number_has_the_unit_of_its_only_value(weight, unit):
    record = module_record("A", 1)._replace(module_scores=(
        ScoreValue("", "time", "5", "s"), ScoreValue("", "mass", "1", "kg"), ScoreValue("waypoint", "time", "5", "ms")))
    rules = Rules(BEST, (), (Criterion("Time", False, (Term(score="time", weight=weight),)),))
    assert standing("HNF", [record], rules, ALL).units == (unit,)


# -- runs -------------------------------------------------------------------------------------------

SEVERAL = [
    task_record("A", 1, objects=1), task_record("A", 2, objects=5, bumps=2), task_record("A", 3, objects=3),
    task_record("B", 4, objects=4),
]


@pytest.mark.parametrize(("attempts", "first", "numbers"), [
    (BEST, "A", (5.0, 2.0)), (MEAN, "B", (4.0, 0.0)), (MEDIAN, "B", (4.0, 0.0)),
])
def test_best_mean_and_median_of_a_teams_runs(attempts, first, numbers):
    found = ranks(SEVERAL, choice=RunChoice(attempts=attempts))
    assert found[0] == (1, first, numbers)
    assert found == ranks(SEVERAL, TASK._replace(attempts=attempts))


def test_the_mean_of_several_runs():
    [_, (_, _, numbers)] = ranks(SEVERAL, choice=RunChoice(attempts=MEAN))
    assert numbers == (3.0, pytest.approx(2 / 3))
    table = standing("HGTKMH", SEVERAL, TASK, RunChoice())
    assert [line.counting for line in table.lines] == [(1,), (0,)]
    assert [len(line.runs) for line in table.lines] == [3, 1]
    assert standing("HGTKMH", SEVERAL, TASK, RunChoice(attempts=MEAN)).lines[1].counting == (0, 1, 2)


def test_a_run_that_is_disqualified_among_others():
    records = [task_record("A", 1, objects=4, hits=1), task_record("A", 2, objects=2, bumps=4)]
    assert ranks(records) == [(1, "A", (2.0, 4.0))]
    assert ranks(records, choice=RunChoice(attempts=MEAN)) == [(1, "A", (1.0, 4.0))]
    assert not standing("HGTKMH", records, TASK, RunChoice()).lines[0].disqualified


def test_what_has_no_value_is_left_out_of_the_mean():
    rules = Rules(MEAN, (), (Criterion("Error", False, (Term(score="error"),)),))
    records = [module_record("A", 1, error=None), module_record("A", 2, error=4.0), module_record("A", 3, error=2.0)]
    assert ranks(records, rules, code="HNF") == [(1, "A", (3.0,))]


def test_only_runs_that_were_started_and_are_over_count():
    records = [
        task_record("A", 1, started_utc=0.0, end_reason=""), task_record("B", 2, end_reason="", closed_utc=0.0),
        task_record("C", 3, end_reason="timeout"), task_record("D", 4, benchmark="HWV"),
    ]
    assert [team for _, team, _ in ranks(records)] == ["C"]
    assert "HGTKMH-6668" in remarks(records)
    assert "still running" in remarks(records)
    assert "HGTKMH-6667" not in remarks(records)


def test_only_signed_off_runs_or_all():
    records = [task_record("A", 1, objects=5), task_record("A", 2, objects=1, sign_off=SIGNED), task_record("B", 3)]
    assert ranks(records)[0] == (1, "A", (5.0, 0.0))
    assert remarks(records).count("may still change") == 2
    signed = RunChoice(signed_off=True)
    assert ranks(records, choice=signed) == [(1, "A", (1.0, 0.0))]
    assert remarks(records, signed).count("does not count") == 2


def test_of_an_event_that_was_run_again_the_last_run_counts():
    first = task_record("A", 1, objects=5)
    again = task_record("A", 2, objects=1, round=first.round, run=first.run, scheduled=first.scheduled)
    assert ranks([again, first]) == [(1, "A", (1.0, 0.0))]
    assert f"run {first.identity} of team A was repeated" in remarks([first, again])
    assert ranks([first, again], choice=RunChoice(without=(again.identity,))) == [(1, "A", (5.0, 0.0))]
    never = again._replace(started_utc=0.0, end_reason="")
    assert ranks([first, never]) == [(1, "A", (5.0, 0.0))]


def test_a_run_of_all_teams_has_no_standing():
    records = [task_record("ALL", 1, benchmark="HSUF", items=())]
    [table] = standings(records, {}, RunChoice())
    assert table.lines == ()
    assert table.remarks == ("all robots run at once: there is no score for each team",)
    assert standings([records[0]._replace(started_utc=0.0)], {}, RunChoice()) == []


def test_standings_of_all_benchmarks_in_their_order():
    never = task_record("A", 3, started_utc=0.0, benchmark="HWV")
    records = [module_record("A", 1, reached=1), task_record("A", 2), never]
    assert [s.benchmark for s in standings(records, {"HGTKMH": TASK}, RunChoice())] == ["HGTKMH", "HNF"]


def test_a_run_says_whether_it_is_final():
    table = standing("HGTKMH", [task_record("A", 1, hits=1)], TASK, RunChoice())
    assert run_text(table.lines[0].runs[0]) == "round 1, run 1, disqualified, not signed off"


def test_a_page_leads_to_the_sheets_and_marks_the_best_run():
    markup = standing_markup(standing("HGTKMH", SEVERAL, TASK, RunChoice()), {SEVERAL[1].identity: "002.html"})
    assert '<b><a href="002.html">round 1, run 2, not signed off: 5, 2</a></b>' in markup
    assert markup.count("<a ") == 1


# -- the file ---------------------------------------------------------------------------------------


def test_the_shipped_rules():
    rules = read_rules(str(SHIPPED))
    assert rules["HGTKMH"] == TASK
    assert set(rules) == {"HGTKMH", "HWV", "HCFGAC", "HOPF", "HNF", "HPPF", "HPFF", "HGMF", "HOMF", "STB"}
    assert rules["HNF"].criteria[0] == Criterion("Waypoints reached", True, (Term(score="reached"),))


def rules_of(tmp_path, text):
    path = tmp_path / "standings.yaml"
    path.write_text(text)
    return read_rules(str(path))


def test_a_file_of_rules(tmp_path):
    assert rules_of(tmp_path, """
HWV:
  runs: median
  criteria:
    - name: Points
      better: less
      of: [{item: Bumps, group: G, weight: -2.5}, {score: time}]
""") == {"HWV": Rules(MEDIAN, (), (
        Criterion("Points", False, (Term("G", "Bumps", "", -2.5), Term(score="time"))),
    ))}


@pytest.mark.parametrize(("text", "line", "expected"), [
    ("HGTKMF: {criteria: [{name: x, of: [{group: y}]}]}", 1, "HGTKMH"),
    ("HWV: {runs: 2, criteria: [{name: x, of: [{group: y}]}]}", 1, "'mean', 'median'"),
    ("HWV:\n  criteria: []", 2, "criteria"),
    ("HWV:\n  criteria:\n    - {name: x, of: [{}]}", 3, "'group', 'item', 'points' or 'score'"),
    ("HWV:\n  criteria:\n    - {name: x, of: [{score: a, group: b}]}", 3, "either a value"),
    ("HWV:\n  criteria:\n    - {name: x, better: many, of: [{score: a}]}", 3, "more"),
    ("HWV:\n  criteria:\n    - {name: x, of: [{score: a, weight: much}]}", 3, "a number"),
    ("HWV:\n  criteria:\n    - {of: [{score: a}]}", 3, "name"),
    ("HWV: {disqualified_by: Hits, criteria: [{name: x, of: [{group: y}]}]}", 1, "groups of the score sheet"),
    ("- HWV", 1, "a map"),
])
def test_errors_in_the_file_are_reported_with_their_line(tmp_path, text, line, expected):
    with pytest.raises(ConfigErrors) as caught:
        rules_of(tmp_path, text)
    [error] = caught.value.errors
    assert error.line == line
    assert expected in str(error)


def test_runs_of_a_benchmark_that_this_version_does_not_know_are_ranked_last():
    records = [task_record("A", 1, objects=1, benchmark="XNEW"), task_record("B", 2, objects=2, benchmark="XNEW"),
               task_record("A", 3, benchmark="STB")]
    found = standings(records, {}, ALL)
    assert [s.benchmark for s in found] == ["STB", "XNEW"]
    assert [line.team for line in found[1].lines] == ["B", "A"]


# -- points -----------------------------------------------------------------------------------------


def pointed(team, number, total, groups=(), **fields):
    """A run whose sheet gives points."""
    record = task_record(team, number, **fields)
    return record._replace(points=SheetPoints(total, tuple(GroupPoints(*group) for group in groups)))


def test_runs_that_were_scored_by_an_earlier_sheet_are_named():
    item = ScoringItem(ACHIEVED, "objects", ScoreKind.UINT, Decimal(60))
    old, new = (SheetForm((dataclasses.replace(item, points=Decimal(points)),)) for points in (60, 50))
    records = [pointed("A", 1, "60", form=old), pointed("B", 2, "50", form=new), pointed("C", 3, "60", form=old)]
    assert "earlier sheet" not in str(standing("HGTKMH", records[::2], None, ALL).remarks)
    last = records[1]._replace(opened_utc=records[2].opened_utc + 60.0)
    table = standing("HGTKMH", [records[0], last, records[2]], None, ALL)
    assert [remark for remark in table.remarks if "earlier sheet" in remark] == [
        f"scored by an earlier sheet (items: 'objects ({ACHIEVED}: objects)': points 60, now 50): run "
        f"{records[0].identity}, {records[2].identity}"]


def test_points_rank_where_a_sheet_gives_them():
    # The sums of the values would be the other way round: B has more penalties.
    records = [pointed("A", 1, "10.5", bumps=1), pointed("B", 2, "-3", bumps=9)]
    table = standing("HGTKMH", records, None, ALL)
    assert [(t.rank, t.team, t.numbers) for t in table.lines] == [(1, "A", (10.5,)), (2, "B", (-3.0,))]
    assert (table.criteria, WITHOUT_RULES in table.remarks) == (BY_POINTS.criteria, False)


def test_a_sheet_without_points_and_rules_is_ranked_with_a_warning():
    records = [task_record("A", 1, bumps=1), task_record("B", 2, bumps=9)]
    table = standing("HGTKMH", records, None, ALL)
    assert [(t.team, t.numbers) for t in table.lines] == [("B", (9.0,)), ("A", (1.0,))], "the sum of the sheet"
    assert WITHOUT_RULES in table.remarks
    assert WITHOUT_RULES in "\n".join(standing_lines(table))
    assert WITHOUT_RULES not in standing("HGTKMH", records, TASK, ALL).remarks


def test_rules_may_name_points(tmp_path):
    rules = rules_of(tmp_path, "HGTKMH: {criteria: [{name: P, of: [{points: Good}, {points: total, weight: -1}]}]}")
    records = [pointed("A", 1, "10", [("Good", "12.5"), ("Bad", "-2.5")]), pointed("B", 2, "1", [("Good", "1")])]
    assert ranks(records, rules["HGTKMH"]) == [(1, "A", (2.5,)), (2, "B", (0.0,))]
    assert "has no 'Good'" in remarks([task_record("A", 1)], rules=rules["HGTKMH"])


# -- overall standings ------------------------------------------------------------------------------

DAY = 86400.0
TWO_DAYS = [
    pointed("A", 1, "40"), pointed("B", 2, "50"), pointed("C", 3, "10", hits=1),
    pointed("A", 4, "3", benchmark="HWV", scheduled=0.0), pointed("B", 5, "6", benchmark="HWV", scheduled=0.0),
    pointed("A", 6, "9", benchmark="HWV", scheduled=DAY),
]


def stage_table(columns, records, rules=None, choice=ALL, **fields):
    """The standing of a stage, relative to the best team."""
    ranking = StandingRules(rules or {})
    ranking.stages = (Stage("All", tuple(columns), **{"normalised": Scale.BEST, **fields}),)
    return standings(records, ranking, choice)[0]


def overall(*parts, **fields):
    """(rank, team, numbers) of each line."""
    table = stage_table(parts, TWO_DAYS, {"HGTKMH": HITS_OUT}, **fields)
    return [(line.rank, line.tied, line.team, line.numbers) for line in table.lines]


def test_the_public_reads_which_runs_do_not_count_yet():
    rules = StandingRules()
    rules.stages = (Stage("All", (StageColumn("HGTKMH"), StageColumn("HWV")), normalised=Scale.BEST),)
    records = [*TWO_DAYS[:2], pointed("A", 4, "3", benchmark="HWV"), pointed("B", 5, "6", benchmark="HWV"),
               pointed("C", 6, "9", end_reason="withdrawn")]
    records = [record if record.team == "B" else record._replace(sign_off=SIGNED) for record in records]
    overall, first, second = public_standings(records, rules, RunChoice(signed_off=True), {})
    assert [(rank.team, rank.numbers[0]) for rank in overall.ranks] == [("A", "2"), ("C", "0")]
    unsigned = "team B gets 0 for {}: its run is not signed off yet"
    assert overall.notes == ("team C gets 0 for HGTKMH: none of its runs counts", unsigned.format("HGTKMH"),
                             unsigned.format("HWV"))
    assert first.notes == ("team B, round 1, run 2: not signed off yet, so it does not count",
                           "team C, round 1, run 6: withdrawn, no score")
    assert second.notes == ("team B, round 1, run 5: not signed off yet, so it does not count",)


HITS_OUT = BY_POINTS._replace(disqualified_by=(DISQUALIFYING,))
TASK_PART = StageColumn("HGTKMH", weight=Decimal(2))


def test_an_overall_standing_relative_to_the_best_team():
    assert overall(TASK_PART, StageColumn("HWV")) == [
        (1, False, "B", (Fraction(8, 3), 2, Fraction(2, 3))), (2, False, "A", (Fraction(13, 5), Fraction(8, 5), 1)),
        (3, False, "C", (0, 0, 0)),
    ]


def test_an_overall_standing_relative_to_a_maximum():
    parts = dataclasses.replace(TASK_PART, maximum=Decimal(100)), StageColumn("HWV", maximum=Decimal(12))
    assert overall(*parts, normalised=Scale.MAXIMUM) == [
        (1, False, "A", (Fraction(31, 20), Fraction(4, 5), Fraction(3, 4))), (2, False, "B", (1.5, 1.0, 0.5)),
        (3, False, "C", (0.0, 0.0, 0.0)),
    ]


def test_an_overall_standing_of_plain_numbers_over_days():
    parts = StageColumn("HWV", day="1970-01-01"), StageColumn("HWV", weight=Decimal("0.5"), day="1970-01-02")
    assert overall(*parts, normalised=Scale.NO) == [
        (1, False, "A", (7.5, 3.0, 4.5)), (2, False, "B", (6.0, 6.0, 0.0))]


@pytest.mark.parametrize("zone, total", [
    ("Asia/Tokyo", {"A": 2}), ("America/Lima", {"A": 1, "B": 4}), ("UTC", {"A": 1})])
def test_a_day_is_one_of_the_venue(zone, total):
    """2026-11-28 in Tokyo begins and ends at 15:00 UTC, in Lima at 5:00."""
    night, morning, evening = 1795822200.0, 1795824000.0, 1795905000.0  # 27th 23:30; 28th 0:00, 22:30 UTC
    times.use_zone(zone)
    records = [pointed("A", 1, "2", scheduled=night), pointed("A", 2, "1", scheduled=evening),
               pointed("B", 3, "4", scheduled=morning + 28 * 3600.0)]
    table = stage_table([StageColumn("HGTKMH", day="2026-11-28")], records, normalised=Scale.NO)
    assert {line.team: line.numbers[0] for line in table.lines} == total
    assert DAYS_OF_COMPUTER not in table.remarks


def test_without_a_time_zone_days_are_those_of_this_computer():
    times.use_zone("")
    with local_time("JST-9"):
        records = [pointed("A", 1, "2", scheduled=1795822200.0)]
        table = stage_table([StageColumn("HGTKMH", day="2026-11-28")], records)
    assert ([line.team for line in table.lines], table.remarks) == (["A"], (DAYS_OF_COMPUTER,))


def test_ties_of_an_overall_standing():
    # 0.8 + 0.2 and 1.0 + 0.0
    parts = StageColumn("HGTKMH"), StageColumn("HWV", weight=Decimal("0.2"), day="1970-01-02")
    assert [line[:3] for line in overall(*parts)] == [(1, True, "A"), (1, True, "B"), (3, False, "C")]
    assert [line[2] for line in overall(*parts, ties=("HGTKMH",))] == ["B", "A", "C"]
    assert [line[:3] for line in overall(*parts, ties=("HWV", "HGTKMH"))] == [
        (1, False, "A"), (2, False, "B"), (3, False, "C")]


def test_equal_sums_tie_whatever_their_parts_are():
    """Rounded, 235/7 is 33.571, and 100/7 + 135/7 is 33.572."""
    days = [f"1970-01-0{day}" for day in (1, 2)]
    records = [pointed("A", 1, "235", scheduled=0.0), pointed("A", 2, "0", scheduled=DAY),
               pointed("B", 3, "100", scheduled=0.0), pointed("B", 4, "135", scheduled=DAY)]
    parts = tuple(StageColumn("HGTKMH", day=day, maximum=Decimal(7)) for day in days)
    table = stage_table(parts, records, normalised=Scale.MAXIMUM)
    assert [(line.rank, line.tied, line.team) for line in table.lines] == [(1, True, "A"), (1, True, "B")]
    lines = list(standing_lines(table))
    assert [line.split()[:3] for line in lines[2:]] == [["1=", "A", "33.571"], ["1=", "B", "33.571"]]


def test_a_mean_is_exact():
    """As floats, the mean of 0.1, 0.1 and 0.1 is not 0.1."""
    rules = Rules(MEAN, (), (Criterion("x", True, (Term(score="x"),)),))
    records = [module_record("A", 1, x=0.1), module_record("A", 2, x=0.1), module_record("A", 3, x=0.1),
               module_record("B", 4, x=0.1)]
    assert [(rank, numbers) for rank, _, numbers in ranks(records, rules, code="HNF")] == [(1, (Fraction(1, 10),))] * 2


@pytest.mark.parametrize(("number", "text"), [
    (Fraction(1, 3), "0.333"), (Fraction(1, 2000), "0.001"), (Fraction(-1, 2000), "-0.001"), (Fraction(-1, 9999), "0"),
    (Fraction(10 ** 12), "1000000000000"), (Fraction(5, 2), "2.5"), (None, "–"),
])
def test_a_number_is_rounded_for_the_eye(number, text):
    assert number_text(number) == text


def test_an_overall_standing_names_the_runs_that_count_and_every_team():
    records = [*TWO_DAYS, attempt(9, "D", "withdrawn")._replace(started_utc=0.0)]
    table = stage_table([TASK_PART, StageColumn("HWV")], records, {"HGTKMH": HITS_OUT})
    assert [(line.team, [run.record.identity[:-15] for run in line.runs]) for line in table.lines] == [
        ("B", ["HGTKMH-6668", "HWV-6671"]), ("A", ["HGTKMH-6667", "HWV-6672"]), ("C", ["HGTKMH-6669"]), ("D", [])]
    assert [line.split()[-1] for line in list(standing_lines(table))[2:6]] == ["2", "2", "1", "0"]
    assert "team D gets 0 for HGTKMH: none of its runs counts" in table.remarks


def test_a_benchmark_without_positive_numbers_counts_nothing():
    records = [pointed("A", 1, "-1"), pointed("B", 2, "0")]
    table = stage_table([StageColumn("HGTKMH"), StageColumn("HWV")], records)
    assert [line.numbers for line in table.lines] == [(0.0, 0.0, 0.0)] * 2
    assert table.remarks == ("HGTKMH counts 0: no team has more than 0", "HWV: no run counts yet")


OVERALL = """
overall:
  - name: All days
    normalised: maximum
    ties: [HWV]
    of:
      - {benchmark: HGTKMH, weight: 2, maximum: 500}
      - {benchmark: HWV, day: 2026-11-28, maximum: 20.5}
HGTKMH: {criteria: [{name: x, of: [{points: total}]}]}
"""


def test_an_overall_standing_is_read_and_comes_first(tmp_path):
    rules = rules_of(tmp_path, OVERALL)
    assert list(rules) == ["HGTKMH"]
    assert rules.stages == (Stage("All days", (
        StageColumn("HGTKMH", weight=Decimal(2), maximum=Decimal(500)),
        StageColumn("HWV", maximum=Decimal("20.5"), day="2026-11-28")), normalised=Scale.MAXIMUM, ties=("HWV",)),)
    first, *others = standings(TWO_DAYS, rules, ALL)
    lines = list(standing_lines(first))
    assert lines[0] == ("All days: weighted sum of the benchmarks, each relative to its maximum; in a tie HWV")
    assert lines[1].split() == ["Rank", "Team", "Total", "HGTKMH", "HWV", "(2026-11-28)", "Runs"]
    assert [s.benchmark for s in others] == ["HGTKMH", "HWV"]
    assert "<h2>All days</h2>" in standing_markup(first, {})


@pytest.mark.parametrize(("old", "new", "line", "expected"), [
    ("name: All days", "title: All days", 3, "unknown key 'title'"), ("maximum\n", "worst\n", 4, "how numbers become"),
    ("ties: [HWV]", "ties: [HNF]", 5, "as ties; expected a test"), ("weight: 2", "weight: two", 7, "'two' as"),
    ("weight: 2", "weight: -1", 7, "'-1' as weight"), (", maximum: 500", "", 7, "'maximum: 500'"),
    ("2026-11-28", "Sunday", 8, "'Sunday' as day"), ("HWV, day", "HGTKMH, day", 5, "as ties; expected a test"),
    ("{name: x,", "{name: x, better: less,", 7, "a first criterion where more is better"),
    ("{benchmark: HWV, day: 2026-11-28, maximum: 20.5}", "{benchmark: HGTKMH, maximum: 3}", 8, "'HGTKMH' again"),
    ("    of:", "    of: []\n  - of:", 6, "an empty sequence"),
])
def test_errors_in_an_overall_standing(tmp_path, old, new, line, expected):
    assert old in OVERALL
    with pytest.raises(ConfigErrors) as caught:
        rules_of(tmp_path, OVERALL.replace(old, new, 1))
    assert any(error.line == line and expected in str(error) for error in caught.value.errors), caught.value


DECIDED = """
stages:
  - { name: All, of: [{ test: HGTKMH }], normalised: { decide: Numbers, as they are: no, of the best: best } }
"""


def test_a_reading_that_was_chosen_is_below_the_standing(tmp_path):
    (tmp_path / "standings.yaml").write_text(DECIDED)
    default = read_rules(str(tmp_path / "standings.yaml"))
    (tmp_path / "decisions.yaml").write_text("Numbers: of the best")
    chosen = read_rules(str(tmp_path / "standings.yaml"))
    found = [standings(TWO_DAYS[:1], rules, ALL)[0] for rules in (default, chosen)]
    assert [(table.lines[0].numbers[0], table.remarks) for table in found] == [
        (40, ()), (1, ("Numbers: of the best",))]


@pytest.mark.parametrize("other", [{}, {"end_reason": "withdrawn", "started_utc": 0.0}])
def test_a_team_with_another_run_is_named_for_the_one_that_is_not_signed_off(other):
    records = [pointed("A", 1, "5")._replace(sign_off=SIGNED, **other), pointed("A", 2, "9")]
    table = stage_table([StageColumn("HGTKMH")], records, choice=RunChoice(signed_off=True))
    assert "team A has a run of HGTKMH that is not signed off yet: it does not count" in table.remarks


def test_the_teams_of_a_stage_are_those_that_were_to_run_in_its_tests():
    records = [pointed("A", 1, "5"), attempt(2, "B", "withdrawn")._replace(started_utc=0.0),
               attempt(3, "C", "withdrawn")._replace(started_utc=0.0, benchmark="HWV"),
               pointed("D", 4, "5")._replace(end_reason=""), pointed(ALL_TEAMS, 5, "5")]
    assert [line.team for line in stage_table([StageColumn("HGTKMH")], records).lines] == ["A", "B"]
    table = stage_table([StageColumn("HWV"), StageColumn("HGTKMH")], records)
    assert [line.team for line in table.lines] == ["A", "B", "C"]
    assert [remark for remark in table.remarks if "gets 0" in remark] == [
        f"team {team} gets 0 for {code}: none of its runs counts" for team, code in (("C", "HWV"), ("B", "HGTKMH"))]


def test_the_runs_of_a_stage_are_those_that_gave_it_its_numbers():
    """And a team with a penalty outside any run is in it."""
    rules = StandingRules({"HGTKMH": BY_POINTS._replace(attempts=AttemptsRule(Attempts.MEAN, 2))})
    rules.stages = (Stage("All", (StageColumn("HGTKMH"),), adjustments=(Adjustment("Late", Decimal(-5)),)),)
    rules.adjusted = (Adjusted("B", "All", "Late", Decimal(-5)),)
    records = [pointed("A", number, str(points)) for number, points in enumerate((4, 1, 7))]
    first, second = standings(records, rules, ALL)
    assert [(line.team, line.numbers, [run.numbers[0] for run in line.runs]) for line in first.lines] == [
        ("A", (5.5, 5.5, 0), [4, 7]), ("B", (-5, 0, -5), [])]
    assert [criterion.name for criterion in first.criteria] == ["Total", "HGTKMH", "Adjustments"]
    assert next(iter(standing_lines(second))) == "HGTKMH: the mean of each team's best 2 runs counts"
    assert second.lines[0].counting == (0, 2)
    assert "A: HGTKMH 5.5 = 5.5" in standing_markup(first, {})


def test_points_for_the_team_and_an_extra_run_that_replaces_those_before():
    """-500 for the team whichever attempt counts, and 415 as the best; of B the runs before the extra one are gone."""
    def run(team, number, total, **fields):
        record = pointed(team, number, total)
        return record._replace(points=record.points._replace(**fields))

    records = [run("A", 1, "0", for_team="-500"), run("A", 2, "415"), run("A", 3, "15"),
               run("B", 4, "700"), run("B", 5, "100", replaces=True), run("B", 6, "60"),
               run("C", 7, "9", replaces=True), run("C", 8, "90"), run("C", 9, "7", replaces=True)]
    rules = StandingRules()
    rules.stages = (Stage("All", (StageColumn("HGTKMH", weight=Decimal(2)),)),)
    stage, test = standings(records, rules, ALL)
    assert [(line.team, line.numbers, line.counting) for line in test.lines] == [
        ("B", (100,), (1,)), ("C", (7,), (2,)), ("A", (-85,), (1,))]
    assert [(line.team, line.numbers) for line in stage.lines] == [
        ("B", (200, 200)), ("C", (14, 14)), ("A", (-170, -170))]
    assert "B, HGTKMH: the attempts before the extra one do not count" in stage.steps
    assert "A, HGTKMH: −500 for the team, whichever attempt counts" in stage.steps


@pytest.mark.parametrize("which, counts", [
    (CountingAttempt.BEST, ["100"]), (CountingAttempt.ALL, ["100", "60"]), (CountingAttempt.LAST, ["60"])])
def test_an_extra_run_at_the_same_event_replaces_those_before(which, counts):
    records = [pointed("A", number, points)._replace(run=1, scheduled=1000.0)
               for number, points in enumerate(("700", "100", "60"))]
    records[1] = records[1]._replace(points=records[1].points._replace(replaces=True))
    found = rulings(records, {}, RunChoice(events={"HGTKMH": EventRules(counting=which)}))
    assert [ruling.record.points.total for ruling in found if ruling.counts] == counts
    assert found[0].why is Why.NOT_LAST


# -- attempts, no-shows -----------------------------------------------------------------------------


def attempt(number, team="A", end_reason="completed", **marks):
    """One of several attempts at the same event."""
    record = task_record(team, number, **marks)
    return record._replace(run=1, scheduled=1000.0, end_reason=end_reason)


def counting(**rules):
    return RunChoice(events={"HGTKMH": EventRules(**rules)})


ATTEMPTS = [attempt(1, objects=2), attempt(2, objects=5, bumps=1), attempt(3, objects=3)]


@pytest.mark.parametrize("which, numbers, runs", [
    (CountingAttempt.LAST, (3.0, 0.0), 1), (CountingAttempt.BEST, (5.0, 1.0), 1), (CountingAttempt.ALL, (5.0, 1.0), 3),
])
def test_which_attempt_counts(which, numbers, runs):
    found = standing("HGTKMH", ATTEMPTS, TASK, counting(counting=which))
    line, = found.lines
    assert (line.numbers, len(line.runs)) == (numbers, runs)
    repeated = [text for text in found.remarks if "was repeated" in text]
    assert len(repeated) == 3 - runs
    assert all(text.endswith(f"only the {which.value} run counts") for text in repeated)


def test_all_attempts_count_for_the_mean():
    rules = TASK._replace(attempts=MEAN)
    (_, _, numbers), = ranks(ATTEMPTS, rules, counting(counting=CountingAttempt.ALL))
    assert numbers == pytest.approx((10 / 3, 1 / 3))


def test_the_best_attempt_is_not_one_that_was_disqualified():
    attempts = [attempt(1, objects=2), attempt(2, objects=5, hits=1)]
    assert ranks(attempts, choice=counting(counting=CountingAttempt.BEST)) == [(1, "A", (2.0, 0.0))]


@pytest.mark.parametrize("end, word", [("no_show", "no-show"), ("withdrawn", "withdrawn")])
def test_a_team_that_was_not_there_has_no_rank_unless_the_rules_say_zero(end, word):
    records = [attempt(1, objects=2), attempt(2, "B", end)._replace(started_utc=0.0)]
    assert ranks(records) == [(1, "A", (2.0, 0.0))]
    assert f"team B, round 1, run 1: {word}, no score" in remarks(records)
    zero = counting(absent=("no_show", "withdrawn"))
    assert ranks(records, choice=zero) == [(1, "A", (2.0, 0.0)), (2, "B", (0.0, 0.0))]
    assert f"team B, round 1, run 1: {word}, counts as 0" in remarks(records, choice=zero)


@pytest.mark.parametrize("absent", [(), ("no_show",)])
def test_penalty_points_of_a_team_that_did_not_appear_count(absent):
    """As RoboCup@Home gives them to a team that does not attend. The table had 0, the sheet -500."""
    absent = pointed("A", 1, "-500", bumps=1)._replace(end_reason="no_show", started_utc=0.0)
    records = [absent, pointed("B", 2, "10")]
    choice = RunChoice(events={"HGTKMH": EventRules(absent=absent)})
    table = standing("HGTKMH", records, None, choice)
    assert [(line.rank, line.team, line.numbers) for line in table.lines] == [(1, "B", (10.0,)), (2, "A", (-500.0,))]
    total = stage_table([StageColumn("HGTKMH")], records, choice=choice, normalised=Scale.NO)
    assert [line.numbers[0] for line in total.lines] == [10, -500]


def test_a_no_show_does_not_replace_a_run_of_the_same_event():
    records = [attempt(1, objects=2), attempt(2, end_reason="no_show")._replace(started_utc=0.0)]
    assert ranks(records) == [(1, "A", (2.0, 0.0))]
    assert ranks(records[::-1], choice=counting(absent=("no_show", "withdrawn"))) == [(1, "A", (2.0, 0.0))]
