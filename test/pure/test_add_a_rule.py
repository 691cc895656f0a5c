"""The walk "Add a rule" of docs/architecture.md, on a copy of the sources: a new rule touches no face."""

import pytest

from helpers.walks import changed_copy, run, steps

pytestmark = pytest.mark.long


@pytest.fixture(scope="module", name="found")
def _found(tmp_path_factory):
    """What a rule book with the new key says and is worth: half of the points so far are lost."""
    return run(changed_copy(tmp_path_factory.mktemp("tree"), "Add a rule"), """
        from fractions import Fraction
        from roah_rsbb.rulebook.changes import differences
        from roah_rsbb.rulebook.config import load_benchmarks
        from roah_rsbb.rulebook.errors import ConfigErrors, known
        from roah_rsbb.rulebook.sheet_check import findings
        from roah_rsbb.scoring.tree import Course, Happened, SheetMark, count
        def sheet(takes):
            text = ("- {name: T, desc: T, code: T, kind: task, timeout: 300, sheet: [{item: a, points: 50, times: 9}], "
                    f"incidents: {{halved: {{takes: {takes}}}, restart: {{voids: earlier}}}}}}")
            with known({"benchmarks.yaml": text}):
                return load_benchmarks("benchmarks.yaml")["T"].sheet
        def worth(marks, *incidents):
            return count(sheet(50), Course(tuple(SheetMark("a", at_s=Fraction(at)) for at in marks),
                                           tuple(Happened(name, Fraction(at)) for name, at in incidents)))
        found = {"totals": [str(worth(*each).total) for each in (
            ([10, 20, 40], ("halved", 30)), ([10, 20], ("halved", 30), ("halved", 31)), ([40], ("halved", 30)),
            ([10, 40], ("halved", 20), ("restart", 30)))]}
        found["steps"] = worth([10, 40], ("halved", 30)).steps
        found["in vain"] = findings(sheet(50))
        found["changes"] = differences("sheet", sheet(50), sheet(20))
        try:
            sheet(101)
        except ConfigErrors as wrong:
            found["error"] = str(wrong)
        print(json.dumps(found))
    """)


def test_it_is_worth_what_it_says(found):
    assert found["totals"] == ["100", "25", "50", "50"]
    assert found["steps"] == ["halved (0:30.0): takes 50 % of 50 points", "a: 2 × 50 = 100", "Total: 100 − 25 = 75"]


def test_check_errors_and_changes_know_it(found):
    assert found["in vain"] == []
    assert found["changes"] == ["incidents: 'halved': takes 50, now 20"]
    assert found["error"] == (
        "benchmarks.yaml:1: found the number '101' as takes; expected a number from 0 to 100 with at most 3 decimals")


def test_it_is_a_change_of_few_files():
    assert len({step.file for step in steps("Add a rule")}) <= 4
