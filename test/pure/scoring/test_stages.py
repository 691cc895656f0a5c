"""Stages: teams ranked by several tests. Real competitions give what they published (test/data/competitions)."""

import json
import pathlib
from fractions import Fraction

import pytest

from roah_rsbb.rulebook.standing_rules import read_rules
from roah_rsbb.scoring.stages import Result, rank

COMPETITIONS = pathlib.Path(__file__).resolve().parents[2] / "data" / "competitions"

TASKS_AND_FINAL = """
stages:
  - {{ name: Tasks, of: [{tests}], advance: {advance} }}
  - name: Final ranking
    teams: Tasks
    of: [ {{ stage: Tasks, weight: {weight} }}, {{ test: Final, weight: {weight} }} ]
    normalised: best
    others: {others}
"""
MEANS = "".join(f"\n{code}: {{ runs: mean of the best 2 }}" for code in ("HRI", "PP", "DL", "GPSR"))
RULES = {
    "german_open_2025": TASKS_AND_FINAL.format(tests="{tests}", advance=3, weight=50, others="zero"),
    "german_open_2026": TASKS_AND_FINAL.format(tests="{tests}", advance=4, weight=100, others="below") + MEANS,
    "salvador_2025_dspl": TASKS_AND_FINAL.format(tests="{tests}", advance=3, weight=0.5, others="below"),
    "salvador_2025_opl": TASKS_AND_FINAL.format(tests="{tests}", advance=2, weight=0.5, others="below"),
    "portugal_open_2026": "stages: [ { name: Tasks, of: [{tests}] } ]",
}


def results(attempts):
    """Results as the stages take them: of each test, the points of each team's attempts. None: not attempted."""
    return {test: {team: [Result(Fraction(points)) for points in numbers if points is not None]
                   for team, numbers in teams.items()} for test, teams in attempts.items()}


def table(ranking):
    """The teams in their order, with their sums."""
    return [(line.place, line.team, None if line.total is None else float(line.total)) for line in ranking.lines]


@pytest.mark.parametrize("name", RULES)
def test_a_real_competition_gives_what_it_published(name, tmp_path):
    found = json.loads((COMPETITIONS / f"{name}.json").read_text())
    tests = {test.replace(" ", ""): teams for test, teams in found["tests"].items()}
    path = tmp_path / "standings.yaml"
    path.write_text(RULES[name].replace("{tests}", ", ".join(f"{{ test: {code} }}" for code in tests)))
    rules = read_rules(str(path), codes=(*tests, "Final"))
    final = {"Final": {team: [points] for team, points in found.get("final", {}).items()}}
    tasks, *last = rank(rules.stages, results({**tests, **final}), {code: own.attempts for code, own in rules.items()})

    published = found["published"]
    totals = {line.team: line.total for line in tasks.lines}
    assert totals == {team: Fraction(str(total)) for team, total in published["totals"].items()}
    assert [line.team for line in tasks.lines] == sorted(totals, key=totals.get, reverse=True)
    digits = {"final_ranking_rounded": 0, "final_ranking_two_decimals": 2, "final_ranking_three_decimals": 3}
    for key in digits.keys() & published.keys():
        assert {line.team: round(float(line.total), digits[key]) for line in last[0].lines if line.total is not None
                } == published[key]
    for final_ranking in last:
        assert [line.team for line in final_ranking.lines] == published.get("ranking", [*published["totals"]])
        assert [line.place for line in final_ranking.lines] == list(range(1, len(totals) + 1))
