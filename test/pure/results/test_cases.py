"""Cases: what rules give for marks and incidents that are written down, and RoboCup@Home 2026 in all its readings."""

import functools
import json

import pytest

from helpers.config_files import SHIPPED
from roah_rsbb.results.cases import answer, differences, read_cases, read_folder
from roah_rsbb.results.program.main import main
from roah_rsbb.rulebook.decisions import resolved
from roah_rsbb.rulebook.errors import Report
from roah_rsbb.rulebook.yaml_lines import read_yaml

ATHOME = str(SHIPPED / "rulebooks" / "athome2026")
CASES = read_cases(f"{ATHOME}/cases.json")
GPSR = "General Purpose Service Robot"


@functools.lru_cache(maxsize=None)
def rules(*decisions):
    return read_folder(ATHOME, str(SHIPPED), dict(decisions))


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["id"])
def test_the_rules_give_what_was_computed_by_hand(case):
    found = answer(case, rules(*case.get("decisions", {}).items()))
    assert differences(case, found) == []
    assert found.steps


def test_each_reading_of_each_choice_has_a_case():
    decided = [each.decision for path in (f"{ATHOME}/benchmarks.yaml", f"{ATHOME}/standings.yaml")
               for each in resolved(Report(), read_yaml(path, Report(), "", ""), path)[1]]
    with_cases = {(name, reading) for case in CASES for name, reading in case.get("decisions", {}).items()}
    assert {(each.name, reading) for each in decided for reading in each.readings[1:]} == with_cases


@pytest.mark.parametrize("code, rows", [
    ("HRI", 25), ("PickAndPlace", 32), ("GPSR", 13), ("Laundry", 21), ("Restaurant", 21), ("Final", 15),
])
def test_rows_have_their_numbers_on_the_sheet(code, rows):
    ids = [item.id for item in rules().benchmarks[code].sheet.items]
    # The start signal has no row where the arena has no door.
    assert sorted(int(each) for each in ids if each.isdigit()) == list(range(rows))


def tried(capsys, tmp_path, content, *options):
    path = tmp_path / "case.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    with pytest.raises(SystemExit) as end:
        main(["try", str(path), *options])
    out, err = capsys.readouterr()
    return end.value.code, out, err


CASE = {"sheet": GPSR, "marks": [["Understands", 1, {"i": 0}], ["Asks again", 3, {"i": 2}], ["Operator", 1, {"i": 1}]]}
STEPS = ["Has it said in other words: 3 × −30 = −90",
         "Understands a command, by speech or not: 80 − 20 − 90, at least 0: 0", "Total: 0"]


def test_a_case_on_the_command_line(capsys, tmp_path):
    assert tried(capsys, tmp_path, CASE) == (0, "\n  ".join([f"{GPSR}: 0", *STEPS]) + "\n", "")
    status, out, _ = tried(capsys, tmp_path, {**CASE, "expected": 80})
    assert status == 1 and "WRONG: points 0, expected 80" in out


def test_cases_for_programs(capsys, tmp_path):
    status, out, _ = tried(capsys, tmp_path, CASE, "--json")
    assert status == 0
    assert json.loads(out) == {"points": 0, "steps": STEPS}
    out = tried(capsys, tmp_path, [{**CASE, "id": "a"}, {**CASE, "id": "b", "marks": [["Solves", 1, {
        "i": 4, "percent": 50.5}]]}], "--json")[1]
    assert [(each["id"], each["points"]) for each in json.loads(out)] == [("a", 0), ("b", 126.25)]
    standings = next(case for case in CASES if case.get("kind") == "standings")
    assert list(json.loads(tried(capsys, tmp_path, standings, "--json")[1])) == [
        "totals", "finalists", "ranking", "steps"]


@pytest.mark.parametrize("content, options, error", [
    ({"sheet": "General Purpose"}, [], "case 'General Purpose' (it names no rulebook, so it is of athome2026; others "
     "with --rulebook): no sheet 'General Purpose': did you mean 'General Purpose Service Robot'?"),
    ({"sheet": "General Purpose", "id": "a7"}, ["--rulebook", "athome2026"], "case 'a7': no sheet 'General Pur"),
    ({"sheet": "Lobby", "rulebook": "heartmet"}, [], "case 'Lobby': no sheet 'Lobby': there is"),
    ({"sheet": GPSR, "marks": [["Solved", 1]]}, [], f"case '{GPSR}' (it names"),
    ({"sheet": GPSR, "marks": [["x", 1, {"i": 77}]]}, [], "no row 77 on the sheet"),
    ({"sheet": GPSR, "marks": ["Understands a command"]}, [], "'Understands a command' is not a mark"),
    ({"sheet": GPSR, "marks": [["x", "many", {"i": 0}]]}, [], "'many' is not a number"),
    ({"sheet": GPSR, "marks": [["x", 1, {"i": 0, "t": "soon"}]]}, [], "'soon' is not a number"),
    ({**CASE, "decisions": {"Floor of an objectiv": "each time"}}, [], "unknown choice 'Floor of an objectiv'"),
    ({**CASE, "decisions": {"Floor of an objective": "sometimes"}}, [], "'decisions' of the case: found"),
    ({**CASE, "decisions": {"Floor of an objective": "sometimes"}}, [], "as reading of 'Floor of an objective'"),
    ({"sheet": GPSR, "marks": [["x", "1/0", {"i": 0}]]}, [], "'1/0' is not a number"),
    ({"sheet": GPSR, "marks": [["x", "1e99999", {"i": 0}]]}, [], "'1e99999' is no number of a case: write one with"),
    ({"sheet": GPSR, "marks": [["x", 1, "0"]]}, [], "'0' as options of a mark of a case: write a map"),
    ({"sheet": GPSR, "marks": [["x", 1, {"i": 4, "percent": 150}]]}, [], "150 as 'percent' of a mark: write a number"),
    ({"sheet": GPSR, "marks": [["x", 1, {"i": 4, "percent": -1}]]}, [], "-1 as 'percent' of a mark: write a number"),
    ({"sheet": GPSR, "marks": {"Understands": 1}}, [], "as marks of a case: write a list"),
    ({"sheet": GPSR, "events": ["restarted"]}, [], "'restarted' as event of a case: write a map"),
    ({"sheet": GPSR, "events": [{"type": "absent", "announced_min_before": [60]}]}, [],
     "[60] as 'announced_min_before' of an event: write a number, a text"),
    ({**CASE, "decisions": ["each time"]}, [], "['each time'] as decisions of a case: write a map"),
    ({"kind": "standings", "teams": {"A": [100]}}, [], "[100] as the team A of a case: write a map"),
    ({"kind": "standings", "teams": {"A": {"attempts": {"GPSR": 100}}}}, [], "100 as attempts of A at GPSR of a case"),
    ({"kind": "standings", "teams": {"A": {"team_adjustments": ["untidy"]}}}, [], "write [reason, points]"),
    (CASE, ["--rulebook", "athome2027"], "no rulebook 'athome2027'"),
    ({**CASE, "kind": "standings"}, ["--rulebook", "erl2019"], "no stages"),
    ("{", [], "is not JSON"),
    ({"sheet": "Timed", "marks": [["Time bonus", 60]]}, ["--rulebook", "OWN"],
     "a mark of 'Time bonus', the time that was left: nobody marks it. Give 'elapsed', and 'completed' if"),
])
def test_what_does_not_fit_together(capsys, tmp_path, content, options, error):
    (tmp_path / "benchmarks.yaml").write_text(
        "- { name: Timed, desc: Timed, code: Timed, kind: task, timeout: 60, sheet: [ { item: Time bonus, "
        "amount: clock, points: 1 } ] }")
    options = [str(tmp_path) if option == "OWN" else option for option in options]
    status, out, err = tried(capsys, tmp_path, content, *options)
    assert (status, out) == (1, "")
    assert error in err
    assert "decisions.yaml" not in err and err.count("there is '") < 2


def test_a_file_that_is_missing(capsys):
    with pytest.raises(SystemExit) as end:
        main(["try", "nofile.json"])
    err = capsys.readouterr().err
    assert end.value.code == 1 and "nofile.json cannot be read (No such file or directory): give a file of cases" in err


@pytest.mark.parametrize("attempts, decisions, total", [
    ({"Restaurant": [None, 300]}, {}, 300),
    ({"GPSR": [300, None]}, {"Attempts that count": "last"}, 300),
    ({"GPSR": [None, -500]}, {}, -500),
    ({"GPSR": [None]}, {}, 0),
])
def test_what_was_not_attempted_is_no_attempt(attempts, decisions, total):
    case = {"kind": "standings", "teams": {"A": {"attempts": attempts}}, "final": {"A": None}}
    assert answer(case, rules(*decisions.items())).as_json()["totals"] == {"A": total}


@pytest.mark.parametrize("reason, total", [("Another decision of the committee", -500), ("Nobody came", -250)])
def test_an_adjustment_is_known_by_its_name_or_else_by_its_points(reason, total):
    given = [["No referee or assistant provided", -250], [reason, -250]]
    case = {"kind": "standings", "teams": {"A": {"team_adjustments": given}}}
    found = answer(case, rules(("Nobody provided as referee", "once")))
    assert found.as_json()["totals"] == {"A": total}


@pytest.mark.parametrize("minutes, points", [(60, 0), ("60", 0), (59.9, -500), (None, -500), (True, -500), ("x", -500)])
def test_when_an_absence_was_announced(minutes, points):
    case = {"sheet": GPSR, "events": [{"t": None, "type": "absent", "announced_min_before": minutes}], "marks": None}
    assert answer(case, rules()).points == points


@pytest.mark.parametrize("reading, finalists", [("last", 4), ("its place stays free", 4), ("out of the list", 3)])
def test_a_disqualified_team_is_one_of_those_that_took_part_while_it_is_in_the_list(reading, finalists):
    teams = {f"T{number}": {"attempts": {"GPSR": [100 * number]}} for number in range(9)}
    teams["T0"]["team_adjustments"] = [["Disqualified for the competition", 0]]
    case = {"kind": "standings", "teams": teams}
    found = answer(case, rules(("Team that was disqualified for the competition", reading))).as_json()
    assert len(found["finalists"]) == finalists
