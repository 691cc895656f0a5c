"""Scores as RoboCup@Home publishes them: what German Open 2026 published comes out, to the digit."""

import json
import pathlib
import re
from fractions import Fraction

import pytest

from roah_rsbb.results import league_tables as tables
from roah_rsbb.results.cases import answer, read_folder
from roah_rsbb.results.program.trying import try_cases
from roah_rsbb.results.runs import NotPossible

ROOT = pathlib.Path(__file__).resolve().parents[3]
OPEN = json.loads((ROOT / "test/data/competitions/german_open_2026.json").read_text("utf-8"))
RULES = """
stages:
  - {{ name: Tasks, of: [{tests}], advance: 4 }}
  - name: Final ranking
    teams: Tasks
    of: [ {{ stage: Tasks, weight: 100 }}, {{ test: Final, weight: 100 }} ]
    normalised: best
    others: below
"""
MEANS = "".join(f"{code}: {{ runs: mean of the best 2 }}\n" for code in ("HRI", "PP", "DL", "GPSR"))


@pytest.fixture(name="folder")
def fixture_folder(tmp_path):
    codes = [*OPEN["tests"], "Final"]
    (tmp_path / "benchmarks.yaml").write_text("".join(
        f"- {{name: {code}, desc: {code}, code: {code}, kind: task, timeout: 60, "
        "sheet: [{item: Points, amount: points}]}\n" for code in codes), "utf-8")
    (tmp_path / "standings.yaml").write_text(
        MEANS + RULES.format(tests=", ".join(f"{{ test: {code} }}" for code in OPEN["tests"])), "utf-8")
    rows = ["Date,Task,Team,Score", *(f"Wed,{test},{team},{points}" for test, teams in OPEN["tests"].items()
                                      for team, attempts in teams.items() for points in attempts),
            *(f"Sat,Final,{team},{points}" for team, points in OPEN["final"].items())]
    (tmp_path / "scores.csv").write_text("\n".join(rows) + "\n", "utf-8")
    return tmp_path


def test_a_file_of_scores_is_ranked_as_published(folder):
    rules = read_folder(str(folder), str(ROOT / "config"), {})
    found = answer(tables.case_of(str(folder / "scores.csv")), rules)
    assert found.standings["totals"] == OPEN["published"]["totals"]
    assert found.standings["ranking"] == [[team] for team in OPEN["published"]["ranking"]]


def test_the_program_takes_a_file_of_scores(folder, capsys):
    class Options:
        file, rulebook, config_dir, json = str(folder / "scores.csv"), str(folder), str(ROOT / "config"), False

    assert try_cases(Options) == 0
    assert "Nimbro > Tobi > SCC > Bit" in capsys.readouterr().out


@pytest.mark.parametrize("text, said", [
    ("", ":1: the first line is not"),
    ("Day,Task,Team,Score\n", ":1: the first line is not"),
    ("Stage,Task,Team,Score\n1,GPSR,A\n", ":2: '1,GPSR,A' is not"),
    ("Stage,Task,Team,Score\n\n1,GPSR,A,many\n", ":3: '1,GPSR,A,many' is not"),
    ("Stage,Task,Team,Score\n3,Final,A,1\n3,final,A,2\n", ":3: A has a second score in the Final"),
])
def test_what_is_wrong_in_a_file_of_scores_is_said(tmp_path, text, said):
    path = tmp_path / "scores.csv"
    path.write_text(text, "utf-8")
    with pytest.raises(NotPossible, match=re.escape(f"{path}{said}")):
        tables.case_of(str(path))


def test_attempts_are_listed_as_they_were_held_and_by_their_points():
    wednesday, thursday = 1773216000.0, 1773302400.0
    scores = [tables.AttemptScore(wednesday, "GPSR", "A|B", Fraction(195)),
              tables.AttemptScore(wednesday, "GPSR", "C", Fraction(-20)),
              tables.AttemptScore(wednesday + 600, "GPSR", "C", Fraction("562.5")),
              tables.AttemptScore(thursday, "PP", "C", Fraction(0))]
    assert tables.scores_text(scores) == (
        "Date,Task,Team,Score\nWed,GPSR,A|B,195\nWed,GPSR,C,-20\nWed,GPSR,C,562.5\nThu,PP,C,0\n")
    assert tables.attempts_text(scores) == """\
# PP
| index | Team | Score |
|------:|------|------:|
|     0 | C    |     0 |

# GPSR
| index | Team | Score |
|------:|------|------:|
|     0 | C    | 562.5 |
|     1 | A\\|B |   195 |
|     2 | C    |   -20 |
"""
