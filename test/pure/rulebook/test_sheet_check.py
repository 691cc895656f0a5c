"""What a score sheet says in vain."""

import pytest

from roah_rsbb.rulebook.config import load_benchmarks
from roah_rsbb.rulebook.errors import known
from roah_rsbb.rulebook.sheet_check import findings

HEAD = "- {name: Test, desc: Test, code: Test, kind: task, timeout: 60, sheet: ["


def _found(*rows, incidents="", limit=60):
    end = "]" + (f", incidents: {{{incidents}}}" if incidents else "") + "}"
    with known({"benchmarks.yaml": HEAD.replace("60", str(limit)) + ", ".join(f"{{{row}}}" for row in rows) + end}):
        return findings(load_benchmarks("benchmarks.yaml")["Test"].sheet)


GOOD = ("section: Test, min: 0, total: 391, items: [{item: a, points: 80, times: 3, min: 0, items: [{item: b, "
        "points: -20, times: 3}]}, {item: c, choices: [d, e]}, {item: f, points: 100, needs: {item: c, is: d}}, "
        "{item: g, percent: 15}]")


def test_a_sheet_without_a_fault():
    # 240 + 100, and 15 % of it: 51.
    assert _found(GOOD, incidents="inactive: {}, removed: {of: inactive, after: 30, voids: later}") == []


@pytest.mark.parametrize("rows, found", [
    # Totals.
    ([GOOD.replace("391", "340")], "'Test' has the total 340, and its rows give at most 391 points"),
    (["item: a, points: 5, times: unlimited, total: 5"], "'a' has the total 5, and its rows give any number of points"),
    (["item: a, points: 5, times: 3, each: yes, max: 7, items: [{item: b, points: 4}], total: 22"],
     "'a' has the total 22, and its rows give at most 19 points"),
    (["item: a, amount: clock, points: 2, seconds: 7, total: 1"],
     "'a' has the total 1, and its rows give at most 16 points"),
    (["item: a, amount: number, from: -2, to: 3, points: -10, total: 0"],
     "'a' has the total 0, and its rows give at most 20 points"),
    (["item: a, choices: {b: 5, c: -2}, total: 1"], "'a' has the total 1, and its rows give at most 5 points"),
    (["section: s, total: 0, items: [{item: a, points: 100}, {item: b, percent: 10, times: 2, compounding: yes}]"],
     "'s' has the total 0, and its rows give at most 121 points"),
    (["section: s, total: 0, items: [{item: a, points: 100}, {item: b, percent: 10, times: unlimited, "
      "compounding: yes}]"], "'s' has the total 0, and its rows give any number of points"),
    (["item: a, points: 5, each: yes, max: 3, total: 1"], "'a' has the total 1, and its rows give at most 3 points"),
    # Rows that never change the points.
    (["section: s, min: 0, items: [{item: a, points: -5}]"], "'s' is always 0 points: its limits leave nothing else"),
    (["item: a, percent: 5", "item: b, points: 1"], "'a' is a percentage of nothing: no row before it gives points"),
    (["section: s", "item: a, points: 1"], "'s' is a section without items"),
    (["item: a", "item: b, points: 1"],
     "'a' gives no points, and no other row depends on it: write 'points: 0' if it is only recorded"),
    (["item: a, choices: [c, d e]", "item: b, points: 1"],
     "'a' gives no points, and no other row depends on it: write 'choices: {c: 0, d e: 0}' if it is only recorded"),
    # A percentage of what a penalty without limit leaves.
    (["section: s, total: 1, items: [{item: a, points: 300, times: 2}, {item: b, points: -5, times: unlimited}, "
      "{item: c, percent: -10, times: 3}]"], "'s' has the total 1, and its rows give at most 600 points"),
    (["section: s, total: 1, items: [{item: a, points: 300, times: 2}, {item: b, points: -5, times: unlimited}, "
      "{item: c, percent: 10}]"], "'s' has the total 1, and its rows give at most 660 points"),
    (["section: s, total: 1, items: [{item: a, points: 300}, {item: c, percent: -10, times: unlimited, "
      "compounding: yes}]"], "'s' has the total 1, and its rows give at most 300 points"),
    # What the team gets is not of the sheet.
    (["section: s, total: 9, items: [{item: a, points: 5}, {item: b, points: 4, for_team: yes}]"],
     "'s' has the total 9, and its rows give at most 5 points"),
    # Conditions that nothing meets.
    (["item: a, points: 1, times: 3", "item: b, points: 1, needs: {item: a, least: 4}"],
     "'b' never counts: it needs 'a' ≥ 4, which is at most 3"),
    (["item: a, choices: [c, d]", "item: b, points: 1, needs: [{item: a, is: c}, {item: a, is: d}]"],
     "'b' never counts: it needs 'a' to be c and d"),
    (["item: a, points: 1", "item: b, points: 1, needs: a", "item: c, points: 1, needs: b, unless: a"],
     "'c' never counts: it needs 'a', with which 'c' does not count"),
    (["item: a, points: 1, withholds: b", "item: b, points: 1", "item: c, points: 1, needs: [a, b]"],
     "'c' never counts: it needs 'a', which withholds 'b'"),
    (["item: x, points: 1", "section: s, unless: x, items: [{item: a, points: 1, needs: x}]"],
     "'a' never counts: it needs 'x', with which 's' does not count"),
    (["item: a, points: 1", "item: b, points: 1, times: 2, needs: {item: a, since: 3}"],
     "'b' needs 'a' from count 3 on, and counts at most 2 times"),
])
def test_a_fault(rows, found):
    assert _found(*rows) == [found]


@pytest.mark.parametrize("rows", [
    ["item: a", "item: b"],
    ["item: a, points: 1, times: 3", "item: b, points: 1, needs: {item: a, least: 3}"],
    ["item: a, points: 1", "item: b, points: 1, needs: a, unless: {item: a, least: 2}"],
    ["item: a, points: 1", "item: b, points: 1, needs: a, unless: {item: a, each: yes}"],
    ["item: a, points: 1, needs: {item: b, since: 2}, times: 2", "item: b, points: 1",
     "item: c, points: 1, needs: a, unless: b"],
    ["item: a, points: 1, needs: {item: b, since: 2}, times: 2", "item: b, points: 1"],
])
def test_no_fault(rows):
    assert _found(*rows) == []


@pytest.mark.parametrize("condition", [
    "when: {fact: How, is: by hand}", "unless: {fact: How, is: by hand}", "when: a"])
def test_a_row_on_which_an_incident_depends(condition):
    assert _found("item: How, choices: [by hand, by tool]", "item: a", "item: b, points: 1",
                  incidents=f"collision: {{{condition}, voids: all}}, other: {{when: [How, a], voids: all}}") == []


def test_a_choice_that_is_only_recorded():
    assert _found("item: a, choices: {c: 0, d e: 0}", "item: b, points: 1") == []


def test_the_time_left_of_a_run_in_which_late_marks_count():
    head = HEAD.replace("sheet:", "late_marks: count, sheet:")
    with known({"benchmarks.yaml": head + "{item: a, amount: clock, points: 2, seconds: 7, total: 1}]}"}):
        found = findings(load_benchmarks("benchmarks.yaml")["Test"].sheet)
    assert found == ["'a' has the total 1, and its rows give at most 16 points"]


@pytest.mark.parametrize("incidents, found", [
    ("absent: {at_end: no_show}, restart: {times: 1}", "nothing follows from 'restart'"),
    ("restart: {below: 1, voids: earlier}, other: {}", "nothing follows from 'other'"),
    ("restart: {below: 0, net: yes, voids: earlier}, other: {}", "nothing follows from 'other'"),
    ("restart: {below: 0, voids: earlier}", "'restart' is never allowed: no points are less than 0"),
    ("restart: {when: x, unless: x, voids: all}", "'restart' has never an effect: it needs 'x', and must not have it"),
])
def test_a_fault_of_an_incident(incidents, found):
    assert _found("item: a, points: 1", incidents=incidents) == [found]
