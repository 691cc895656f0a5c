"""The rules about time and attempts: limits, setup time, attempts, restarts, pauses and phases."""

import pytest

from helpers.config_files import TEXTS, changed, line_of
from roah_rsbb.rulebook.benchmarks import NO_LIMIT, NO_RULES, CountingAttempt, EventRules, PhaseRule, Restarts

RULES = """  setup_time: 90.5
  attempts: 3
  attempt_counts: best
  restarts: clock stops
  pause: allowed
  no_show: zero
  phases:
    - {name: Take the order, limit: 120}
    - {name: Serve, limit: no limit}
    - {name: Clear the table}
"""
TASK = """
- name: Task 4
  desc: Set the table
  code: SetTable
  kind: task
  timeout: 420
"""
TEXT = TEXTS["benchmarks"] + TASK + RULES


def table(files, text=TEXT):
    """The benchmark of the competition, and the warnings."""
    loaded, warnings = files.load(benchmarks=text)
    return loaded.benchmarks["SetTable"], warnings


def test_all_rules(files):
    benchmark, warnings = table(files)
    phases = (PhaseRule("Take the order", 120.0), PhaseRule("Serve", NO_LIMIT), PhaseRule("Clear the table", NO_LIMIT))
    assert benchmark.rules == EventRules(
        90.5, 3, CountingAttempt.BEST, Restarts.CLOCK_STOPS, True, phases, ("no_show", "withdrawn"))
    assert warnings == []


def test_shipped_benchmarks_have_no_such_rules(files):
    assert {benchmark.rules for benchmark in files.load()[0].benchmarks.values()} == {NO_RULES}


def test_the_defaults_are_what_the_box_always_did():
    expected = EventRules(0.0, 0, CountingAttempt.LAST, Restarts.CLOCK_RUNS, False, (), ())
    assert expected == NO_RULES


def test_no_limit(files):
    benchmark, warnings = table(files, TEXT.replace("timeout: 420", "timeout: no limit"))
    assert (benchmark.timeout, benchmark.total_timeout, benchmark.limit) == (NO_LIMIT, NO_LIMIT, NO_LIMIT)
    assert warnings == []


def test_goals_without_limit_in_a_run_with_one(files):
    text = changed("benchmarks", "timeout: 120\n  total_timeout: 600", "timeout: no limit\n  total_timeout: 600")
    loaded, warnings = files.load(benchmarks=text)
    assert (loaded.benchmarks["HOPF"].timeout, loaded.benchmarks["HOPF"].total_timeout) == (NO_LIMIT, 600.0)
    assert warnings == []


@pytest.mark.parametrize("timeouts, unused, used", [
    ("timeout: no limit\n  total_timeout: 300", "no limit", "300"),
    ("timeout: 300\n  total_timeout: no limit", "300", "no limit"),
])
def test_a_task_ends_by_its_total_timeout(files, timeouts, unused, used):
    text = TEXT.replace("timeout: 420", timeouts)
    _, warnings = table(files, text)
    assert warnings[0].endswith(f":{line_of(text, timeouts)}: timeout {unused} of SetTable is not used: a benchmark "
                                f"without goals ends by its total_timeout {used}")


def test_phases_that_take_longer_than_the_run(files):
    text = TEXT.replace("limit: no limit", "limit: 200").replace("{name: Clear the table}", "{name: C, limit: 101}")
    benchmark, warnings = table(files, text)
    assert sum(phase.limit for phase in benchmark.rules.phases) == 421.0
    assert warnings[0].endswith("the phases of SetTable take 421 s together: its total_timeout 420 ends the run "
                                "earlier")


# What is replaced, by what, and parts of the only message, which is in the line of the replacement.
MISTAKES = [
    ("timeout: 420", "timeout: none", ["the text 'none' as timeout", "a number of seconds", "or 'no limit'"]),
    ("timeout: 420", "timeout: 0", ["above 0 and at most 86400; or 'no limit'"]),
    ("setup_time: 90.5", "setup_time: no limit", ["'no limit' as setup_time; expected a number of seconds above 0"]),
    ("setup_time: 90.5", "setup_time: 2 min", ["digits only"]),
    ("attempts: 3", "attempts: 0", ["as attempts; expected a whole number from 1 to 100"]),
    ("attempts: 3", "attempts: two", ["the text 'two' as attempts"]),
    ("attempt_counts: best", "attempt_counts: bset", ["did you mean 'best'?"]),
    ("attempt_counts: best", "attempt_counts: [best]", ["which of several attempts at an event counts"]),
    ("restarts: clock stops", "restarts: clock stop", ["as restarts", "did you mean 'clock stops'?"]),
    ("restarts: clock stops", "restarts: no", ["there is 'clock runs', 'clock stops', 'not allowed'"]),
    ("pause: allowed", "pause: yes", ["as pause", "whether the referee may pause the clock"]),
    ("no_show: zero", "no_show: 0", ["how an event counts whose team did not appear"]),
    ("limit: 120", "limit: -1", ["as limit", "or 'no limit'"]),
    ("name: Serve, limit: no", "name: Take the order, limit: no", ["a second phase"]),
    ("{name: Clear the table}", "{limit: 5}", ["a phase without name"]),
    ("{name: Clear the table}", "Clear", ["the text 'Clear' as a phase"]),
    ("{name: Clear the table}", "{name: Clear the table, limits: 5}", ["the unknown key 'limits' in a phase"]),
    ("kind: task", "kind: functionality", ["phases in a benchmark of kind 'functionality'", "in a task only"]),
]


@pytest.mark.parametrize("old, new, parts", MISTAKES, ids=[new for _, new, _ in MISTAKES])
def test_one_mistake_is_one_error(files, old, new, parts):
    text = TEXT.replace(old, new)
    name, line, message = files.error(benchmarks=text)
    assert name == "benchmarks"
    assert new.startswith("kind") or line == line_of(text, new)
    assert [part for part in parts if part not in message] == [], message


def test_an_empty_sequence_of_phases(files):
    text = TEXTS["benchmarks"] + TASK + "  phases: []\n"
    _, _, message = files.error(benchmarks=text)
    assert "an empty sequence as phases" in message


# -- goals that end by their timeout --------------------------------------------------------------------


@pytest.mark.parametrize("word, completes", [(None, False), ("failed", False), ("completed", True)])
def test_what_a_goal_counts_as_whose_timeout_is_over(files, word, completes):
    text = TEXTS["benchmarks"] + TASK.replace("kind: task", "kind: functionality")
    text += f"  timed_out_goal: {word}\n" if word else ""
    loaded, _ = files.load(benchmarks=text)
    assert loaded.benchmarks["SetTable"].profile.runs_until_timeout is completes
    assert loaded.benchmarks["HPFF"].profile.runs_until_timeout


@pytest.mark.parametrize("kind, word, parts", [
    ("functionality", "complete", ["as timed_out_goal", "did you mean 'completed'?"]),
    ("task", "completed", ["timed_out_goal in a benchmark of kind 'task'", "in a functionality benchmark only"]),
])
def test_mistakes_in_timed_out_goal(files, kind, word, parts):
    text = TEXTS["benchmarks"] + TASK.replace("kind: task", f"kind: {kind}") + f"  timed_out_goal: {word}\n"
    _, line, message = files.error(benchmarks=text)
    assert line == line_of(text, "timed_out_goal")
    assert [part for part in parts if part not in message] == [], message
