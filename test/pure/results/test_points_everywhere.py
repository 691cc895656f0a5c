"""All that shows the points of a run shows the same ones: sheet, pages, exports, standings, the referee's lists."""

import json
import random
import re
from fractions import Fraction

import pytest

from helpers.competition import UTC0
from helpers.random_sheets import TIME_LIMIT_S, random_form, random_mark
from roah_rsbb.model.as_json import from_json, to_json
from roah_rsbb.model.clock import Now
from roah_rsbb.model.records import By, ItemRecord, RunRecord, SignOff
from roah_rsbb.results.export import exported, result_rows, safe
from roah_rsbb.results.paper import blank_front, front_of
from roah_rsbb.results.runs import RunResult
from roah_rsbb.results.sheet import sheet_lines, sheet_page
from roah_rsbb.results.standings import number_text
from roah_rsbb.rulebook.benchmarks import Benchmark
from roah_rsbb.scoring.book import RunBook
from roah_rsbb.scoring.counting import RunChoice, exact
from roah_rsbb.scoring.earlier import modern
from roah_rsbb.scoring.standings import standings
from roah_rsbb.wording.sheets import points_text

TEAMS = ("Alpha", "Beta", "Gamma")


def _record(chance, form, number, team):
    """A run with random marks, as the journal keeps it."""
    now, book = Now(100.0, UTC0 + 1000.0 * number), RunBook(form)
    for _ in range(chance.randint(3, 30)):
        now = now.later(chance.uniform(0.5, 5.0))
        book.mark(now, "Anna", random_mark(chance, form))
    reason = chance.choice(["completed", "stopped"])
    book.ended(now, reason, "", By(), round(chance.uniform(0.0, TIME_LIMIT_S), 3))
    record = book.into(RunRecord(
        f"X-{number}-{now.utc:.3f}", "Home", "X", team, 1, number, UTC0, UTC0 + 1000.0 * number,
        closed_utc=now.utc, end_reason=reason, robots=("r1",), sign_off=SignOff(now.utc, "Chief")))
    record = record._replace(started_utc=UTC0 + 1000.0 * number)
    return from_json(RunRecord, json.loads(json.dumps(to_json(record))))


@pytest.mark.parametrize("seed", range(40))
def test_points_are_the_same_everywhere(seed):
    chance = random.Random(seed)
    form = random_form(chance)
    records = [_record(chance, form, number, team) for number, team in enumerate(TEAMS)]
    (standing,) = standings(records, {}, RunChoice(signed_off=True))
    best = {line.team: line.numbers for line in standing.lines}
    assert sorted(line.team for line in standing.lines) == sorted(TEAMS)
    for number, record in enumerate(records, 1):
        result = RunResult(number, record, (), ())
        total, groups = record.points.total, dict(record.points.groups)
        _check_lines(list(sheet_lines(result, True, False)), record)
        assert points_text(record.points) in re.sub("<[^>]*>", "", sheet_page(result, True))
        _check_rows(list(result_rows([record], True)), total, groups)
        value = json.loads(json.dumps(exported([result], [standing], "journal", 0.0)))["runs"][0]
        assert value["points"] == {
            "total": total, "groups": [{"name": name, "points": points} for name, points in groups.items()],
            "steps": [*record.points.steps], "for_team": "", "replaces": False, "inner": []}
        _check_front(front_of(record, None, "", True), record)
        assert number_text(best[record.team][0]) == total
    ranked = [Fraction(next(r for r in records if r.team == line.team).points.total) for line in standing.lines]
    assert ranked == sorted(ranked, reverse=True)


def test_points_for_the_team_and_of_incidents_are_on_each_sheet():
    chance = random.Random(1)
    record = _record(chance, random_form(chance), 1, TEAMS[0])
    incident = ItemRecord("Incidents", "Collision", "uint", 0, points="-162.5")
    record = record._replace(points=record.points._replace(for_team="-7"), items=(*record.items, incident))
    result = RunResult(1, record, (), ())
    assert any(line.endswith(" points, and -7 for the team") or " points, and -7 for the team: " in line
               for line in sheet_lines(result, True, False))
    assert "by an incident" in sheet_page(result, True)
    assert [row["points"] for row in result_rows([record], True) if row["kind"] == "for_team"] == [-7]
    front = front_of(record, None, "", True)
    assert ("For the team", "-7") in front.totals
    assert "by an incident" in {line.value for group in front.groups for line in group.lines}


def _check_lines(lines, record):
    assert points_text(record.points) in lines
    for item in record.items:
        if item.points:
            pattern = rf" +{re.escape(item.points)}  {re.escape(item.desc)}( \(|$)"
            assert any(re.search(pattern, line) for line in lines), item


def _check_rows(rows, total, groups):
    (shown,) = (safe(row["points"]) for row in rows if row["kind"] == "total")
    assert Fraction(str(shown)) == Fraction(total)
    found = {row["group"]: Fraction(str(row["points"])) for row in rows if row["kind"] == "group"}
    assert found == {name: Fraction(points) for name, points in groups.items()}


def _check_front(front, record):
    assert front.totals == (("Points", record.points.total),)
    points = {line.what: line.points for group in front.groups for line in group.lines}
    for item in record.items:
        assert points[item.desc] == item.points
    for name, number in record.points.groups:
        lines = next(group.lines for group in front.groups if group.title == name)
        assert lines[-1].points == number


@pytest.mark.parametrize("seed", range(10))
def test_a_sheet_to_be_filled_in_by_hand_names_the_points(seed):
    form = modern(random_form(random.Random(seed)))
    benchmark = Benchmark("X", "X", "X", 300.0, 300.0, form.items, sheet=form.sheet)
    front = blank_front(benchmark)
    lines = [line for group in front.groups for line in group.lines]
    titles = [group.title for group in front.groups]
    for item, line in zip(sorted(form.items, key=lambda item: titles.index(item.group)), lines):
        assert line.what.startswith(item.desc)
        for choice in item.choices:
            assert f"☐ {choice.name}" in line.what
        if item.points is not None and line.value != "points":
            assert f"({number_text(exact(item.points))})" in line.what
        assert all(judge in line.value for judge in item.judges)
