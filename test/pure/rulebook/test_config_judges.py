"""Several judges and objections in the benchmarks file."""

import pytest

from roah_rsbb.model.scoring import Agreement, JudgesRule
from roah_rsbb.rulebook.changes import changes
from roah_rsbb.rulebook.config import ConfigErrors

HEAD = "- name: Table\n  desc: Cleaning\n  code: CleanTable\n  kind: task\n  timeout: 300\n"
ITEMS = "  scoring:\n    - G:\n        - {type: bool, desc: Empty}\n"
RATED = "  scoring:\n    - G:\n        - {type: rating, desc: Show, max: 10}\n"
SCHEDULE = ("- zone: Home\n  schedule:\n    - {benchmark: CleanTable, team: BrassButlers, round: 1, run: 1, "
            "scheduled_time: 2026-11-28 09:00:00}\n")


def _load(files, text):
    return files.load(benchmarks=text, schedule=SCHEDULE)[0]


@pytest.mark.parametrize("text, rule", [
    ("judges: 2", JudgesRule(2)),
    ("judges: {count: 3, rule: majority}", JudgesRule(3, Agreement.MAJORITY)),
    ("judges: {count: 3, rule: without extremes}", JudgesRule(3, Agreement.WITHOUT_EXTREMES)),
    ("pause: allowed", None),
])
def test_a_benchmark_may_have_several_judges(files, text, rule):
    benchmark = _load(files, f"{HEAD}  {text}\n{ITEMS}").benchmarks["CleanTable"]
    assert benchmark.judges == benchmark.form.judges == rule
    assert benchmark.form.is_plain == (rule is None)


def test_each_judge_of_the_benchmark_rates(files):
    benchmark = _load(files, f"{HEAD}  judges: 3\n{RATED}").benchmarks["CleanTable"]
    assert benchmark.scoring[0].judges == ("1", "2", "3")


def test_the_time_for_objections(files):
    benchmark = _load(files, f"{HEAD}  objection_time: 900\n{ITEMS}").benchmarks["CleanTable"]
    assert (benchmark.form.objection_time, benchmark.form.is_plain) == (900.0, False)


@pytest.mark.parametrize("text, found, expected", [
    ("  judges: 1\n" + ITEMS, "the number '1' as judges of a benchmark", "a whole number from 2 to 20"),
    ("  judges: {rule: majority}\n" + ITEMS, "judges of a benchmark without count", "something like 'count: 2'"),
    ("  judges: {count: 2, rule: mode}\n" + ITEMS, "'mode' as rule of judges of a benchmark",
     "how their sheets become one"),
    ("  judges: 2\n", "judges in a benchmark without 'sheet'", "a sheet that they fill in"),
    ("  judges: 2\n  scoring:\n    - G:\n        - {type: rating, desc: Show, max: 10, judges: 3}\n",
     "3 judges of a rating in a benchmark with 2 judges", "no key 'judges' in the item"),
    ("  objection_time: -1\n" + ITEMS, "the number '-1' as objection_time", "seconds"),
])
def test_an_error_names_the_remedy(files, text, found, expected):
    with pytest.raises(ConfigErrors) as caught:
        _load(files, HEAD + text)
    (error,) = caught.value.errors
    assert found in str(error)
    assert expected in str(error)
    assert error.line == HEAD.count("\n") + (4 if "judges: 3" in text else 1)


def test_the_organiser_reads_which_rule_changes(files):
    def of(text):
        return _load(files, f"{HEAD}{text}{ITEMS}")

    assert changes(of(""), of("  judges: 2\n")) == ["benchmark CleanTable: judges none, now 2, all agree"]
    assert changes(of("  judges: 2\n"), of("  judges: {count: 3, rule: majority}\n")) == [
        "benchmark CleanTable: count 2, now 3", "benchmark CleanTable: agreement all agree, now majority"]
