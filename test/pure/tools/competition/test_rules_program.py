"""`rulebook`: what rules leave to people, and what is wrong with them."""

import json

import pytest

from roah_rsbb.tools.competition import rules

BENCHMARKS = """\
- name: Test 1
  desc: Fetch
  code: Fetch
  kind: task
  timeout: 300
  sheet:
    - section: Goals
      items:
        - { item: Takes the cup, points: 50, times: { decide: Cups, one: 1, many: 3 } }
        - { item: Says hello, points: 10, needs: { item: Takes the cup, least: 2 } }
  incidents:
    restart: { below: { decide: Limit of a restart, general: 40, none: nothing }, voids: earlier }
"""
STANDINGS = "stages: [ { name: All, of: [ { test: Fetch, weight: { decide: Cups, one: 1, many: 2 } } ] } ]\n"


@pytest.fixture
def run(tmp_path, capsys):
    (tmp_path / "benchmarks.yaml").write_text(BENCHMARKS, "utf-8")
    (tmp_path / "standings.yaml").write_text(STANDINGS, "utf-8")

    def program(*words, **files):
        for name, text in files.items():
            (tmp_path / f"{name}.yaml").write_text(text, "utf-8")
        with pytest.raises(SystemExit) as end:
            rules.main([*words, str(tmp_path)])
        out, err = capsys.readouterr()
        return end.value.code, out, err.replace(str(tmp_path), "FOLDER")

    return program


def test_what_rules_leave_to_people(run):
    assert run("decisions", decisions="Cups: many\n")[:2] == (0, """\
Cups: 'many'; the default is 'one'
  Fetch, Goals, Takes the cup, times (benchmarks.yaml:9)
      one: 1
    * many: 3
  All, Fetch, weight (standings.yaml:1)
      one: 1
    * many: 2
Limit of a restart: 'general'
  Fetch, incidents, restart, below (benchmarks.yaml:12)
    * general: 40
      none: nothing
""")


def test_rules_that_leave_nothing_to_people(run):
    assert run("decisions", benchmarks=BENCHMARKS.split("  sheet:")[0], standings="{}")[1] == (
        "The rules leave nothing to people.\n")


def test_a_check(run):
    status, out, _ = run("check")
    assert (status, out.splitlines()) == (1, [
        "Fetch: 'Says hello' never counts: it needs 'Takes the cup' ≥ 2, which is at most 1",
        "1 benchmark, 3 rows, 0 cases: 1 found"])
    status, out, _ = run("check", decisions="Cups: many\n")
    assert (status, out) == (0, "1 benchmark, 3 rows, 0 cases: nothing found\n")


@pytest.mark.parametrize("command", ["decisions", "check"])
def test_wrong_rules(run, command):
    status, out, err = run(command, decisions="Cup: many\n")
    assert (status, out) == (1, "")
    assert err.splitlines()[1:] == ["FOLDER/decisions.yaml:1: found the unknown choice 'Cup'; expected a choice of the "
                                    "rules: did you mean 'Cups'?"]


def test_cases_of_the_folder(run, tmp_path):
    case = {"sheet": "Fetch", "marks": [["Takes the cup", 2], ["Says hello", 1]], "decisions": {"Cups": "many"}}
    cases = [{**case, "expected": 110}, {**case, "id": "b", "expected": 60}, {**case, "sheet": "Fetsh"}, case]
    (tmp_path / "cases.json").write_text(json.dumps(cases))
    status, out, _ = run("check", decisions="Cups: many\n")
    assert (status, out.splitlines()) == (1, [
        "cases.json, case b: points 110, expected 60",
        "cases.json, case 3: no sheet 'Fetsh': did you mean 'Fetch'?",
        "cases.json, case 4: nothing is expected: give 'expected' (docs/results.md)",
        "1 benchmark, 3 rows, 4 cases: 3 found"])


@pytest.mark.parametrize("name, found", [("heartmet", "4 benchmarks,"), ("athome2026", "7 benchmarks,")])
def test_an_included_rulebook(capsys, name, found):
    with pytest.raises(SystemExit) as end:
        rules.main(["check", name])
    out = capsys.readouterr().out
    assert (end.value.code, out.startswith(found), out.endswith(": nothing found\n")) == (0, True, True), out


def test_the_words_of_a_league(run, tmp_path):
    sheets = tmp_path / "RuleBook" / "scoresheets"
    sheets.mkdir(parents=True)
    (sheets / "Fetch.tex").write_text(
        "\\begin{scorelist}\n\\scoreitem[2]{50}{Grasps}\n\\scoreitem{5}{Waves}\n\\end{scorelist}\n")
    own = BENCHMARKS.replace("item: Takes the cup, points", "item: Takes the cup, id: 0, points").replace(
        "{ item: Takes the cup, least", "{ item: 0, least")
    status, out, _ = run("import", "athome", str(tmp_path / "RuleBook"), benchmarks=own)
    assert status == 0 and out.splitlines()[2:] == [
        f"{tmp_path}/benchmarks.yaml: 1 row in the words of the league; before: {tmp_path}/benchmarks.yaml~",
        "  Fetch, row 0, 'Grasps': 50 points; printed: 50 points × 2", "  Fetch, row 1, 'Waves': missing"]
    assert (tmp_path / "benchmarks.yaml").read_text("utf-8") == own.replace("item: Takes the cup", 'item: "Grasps"')
    assert (tmp_path / "benchmarks.yaml~").read_text("utf-8") == own
    assert run("diff", str(tmp_path / "RuleBook"))[1] == (
        "Fetch: removed: 'Waves' (5 points)\nFetch: 'Grasps': 50 points × 2, now 50 points\n"
        "Fetch: added: 'Says hello' (10 points)\n")
    status, _, err = run("import", "athome", str(tmp_path))
    assert status == 1 and "no folder 'scoresheets'" in err
