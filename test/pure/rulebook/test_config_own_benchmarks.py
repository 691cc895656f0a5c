"""Benchmarks that a competition defines, and its changes of the shipped ones."""

import pytest

from helpers.config_files import TEXTS, changed, line_of
from roah_rsbb.rulebook.registry import OTHER_NUMBER, PROFILES, BenchmarkKind, GoalForm, ResultForm

TASK = """
- name: Task 4
  desc: Set the table
  code: SetTable
  kind: task
  timeout: 420
  uses: [notifications, tablet]
  offline_data: optional
  beacon: optional
  scoring:
    - Achievements:
        - { type: uint, desc: Puts an object at its place }
"""
TEXT = TEXTS["benchmarks"] + TASK
EVENT = "{benchmark: %s, team: %s, round: 1, run: 1, scheduled_time: 2026-11-28 09:00:00}"


def schedule(code="SetTable", team="BrassButlers"):
    return f"- zone: Home\n  schedule:\n    - {EVENT % (code, team)}\n"


def own(**changes):
    """The text with keys of the new benchmark changed; None: without the key."""
    text = TEXT
    for key, value in changes.items():
        line = next(line for line in TASK.splitlines(True) if line.strip().lstrip("- ").startswith(f"{key}:"))
        head = line[:line.index(key)]
        text = text.replace(line, "" if value is None else f"{head}{key}: {value}\n")
    return text


def test_a_new_task(files):
    loaded, warnings = files.load(benchmarks=TEXT, schedule=schedule())
    benchmark = loaded.zones[0].events[0].benchmark
    assert (benchmark.code, benchmark.name, benchmark.timeout, benchmark.limit) == ("SetTable", "Task 4", 420.0, 420.0)
    profile = benchmark.profile
    assert benchmark.kind is profile.kind is BenchmarkKind.TASK
    assert profile.uses == {"notifications", "tablet"}
    assert not profile.offline_data and not profile.beacon
    assert (profile.number, profile.goal, profile.result) == (OTHER_NUMBER, GoalForm.TEXT, ResultForm.TEXT)
    assert warnings == []


def test_what_a_new_benchmark_leaves_out(files):
    benchmarks = own(uses=None, offline_data=None, beacon=None, kind="functionality")
    loaded, _ = files.load(benchmarks=benchmarks, schedule=schedule())
    profile = loaded.benchmarks["SetTable"].profile
    assert (profile.kind, profile.uses, profile.offline_data, profile.beacon) == (
        BenchmarkKind.FUNCTIONALITY, frozenset(), True, True)


def test_all_robots_take_part_in_a_new_benchmark(files):
    text = own(kind="all robots")
    loaded, _ = files.load(benchmarks=text, schedule=schedule(team="ALL"))
    assert loaded.zones[0].events[0].benchmark.kind is BenchmarkKind.ALL_ROBOTS
    _, _, message = files.error(benchmarks=text, schedule=schedule())
    assert "team 'BrassButlers' in SetTable; expected team ALL" in message


def test_a_shipped_benchmark_keeps_what_is_not_changed(files):
    text = changed("benchmarks", "code: HWV", "code: HWV\n  uses: [devices]\n  offline_data: optional")
    profile = files.load(benchmarks=text)[0].benchmarks["HWV"].profile
    assert (profile.uses, profile.offline_data) == ({"devices"}, False)
    assert (profile.kind, profile.number) == (BenchmarkKind.TASK, PROFILES["HWV"].number)
    text = changed("benchmarks", "code: HCFGAC", "code: HCFGAC\n  uses: []")
    assert files.load(benchmarks=text)[0].benchmarks["HCFGAC"].profile.uses == frozenset()


def test_a_shipped_benchmark_of_another_kind(files):
    text = changed("benchmarks", "code: HSUF", "code: HSUF\n  kind: task")
    loaded, _ = files.load(benchmarks=text, schedule=schedule("HSUF"))
    assert loaded.benchmarks["HSUF"].kind is BenchmarkKind.TASK
    _, _, message = files.error(benchmarks=text, schedule=schedule("HSUF", "ALL"))
    assert "team ALL in HSUF; expected the name of one team" in message


def test_the_timeout_of_a_task_is_its_total_timeout(files):
    text = TEXT.replace("  timeout: 420", "  timeout: 300\n  total_timeout: 420")
    loaded, warnings = files.load(benchmarks=text, schedule=schedule())
    benchmark = loaded.benchmarks["SetTable"]
    assert (benchmark.total_timeout, benchmark.limit) == (420.0, 420.0)
    line = line_of(text, "timeout: 300\n  total_timeout: 420")
    assert warnings == [f"{files.file('benchmarks')}:{line}: timeout 300 of SetTable is not used: a benchmark without "
                        "goals ends by its total_timeout 420"]


# Key, its value, and parts of the only message, which is in the key's line.
MISTAKES = [
    ("kind", "tsk", ["the text 'tsk' as kind", "a kind of benchmark: did you mean 'task'?"]),
    ("kind", "[task]", ["a sequence", "there is 'task', 'functionality', 'all robots'"]),
    ("kind", "", ["found nothing as kind"]),
    ("code", "9Lives", ["the text '9Lives' as code", "a letter, then at most 31 letters, digits or '_'"]),
    ("code", "Set-Table", ["'Set-Table' as code", "a letter, then"]),
    ("code", "x" * 33, ["a letter, then"]),
    ("code", "'Set/../Table'", ["a letter, then"]),
    ("code", "Tischdecken_für_zwei", ["a letter, then"]),
    ("code", "hwv", ["the text 'hwv' as code", "'HWV', or a code that is not so similar to it"]),
    ("code", "2026", ["the number '2026' as code"]),
    ("code", "HNF", ["a second benchmark with code 'HNF'"]),
    ("uses", "tablet", ["the text 'tablet' as uses", "a sequence of some of notifications, activation_event"]),
    ("uses", "[tablets]", ["'tablets' as an entry of uses", "what a robot may use: did you mean 'tablet'?"]),
    ("uses", "[tablet, notifications, tablet]", ["'tablet' again in uses", "each once"]),
    ("uses", "[[tablet]]", ["a sequence", "as an entry of uses"]),
    ("uses", "{tablet: true}", ["a map", "as uses"]),
    ("uses", "yes", ["'yes' (to YAML, a yes-or-no value) as uses"]),
    ("offline_data", "no", ["'no' (to YAML, a yes-or-no value) as offline_data", "there is 'required', 'optional'"]),
    ("beacon", "required, optional", ["as beacon", "whether a run needs a robot that is heard"]),
    ("offline_data", "require", ["did you mean 'required'?"]),
]


@pytest.mark.parametrize("key, value, parts", MISTAKES, ids=[f"{key}: {value[:20]}" for key, value, _ in MISTAKES])
def test_one_mistake_is_one_error_in_its_line(files, key, value, parts):
    text = own(**{key: value})
    name, line, message = files.error(benchmarks=text, schedule=schedule("HGTKMH"))
    assert (name, text.splitlines()[line - 1].strip()) == ("benchmarks", f"{key}: {value}".strip())
    assert [part for part in parts if part not in message] == [], message


def test_a_new_code_without_kind(files):
    text = own(kind=None)
    _, line, message = files.error(benchmarks=text, schedule=schedule("HGTKMH"))
    assert line == line_of(text, "SetTable")
    assert "the text 'SetTable' as code; expected a benchmark code, or the key 'kind' for a new one" in message


def test_an_error_in_a_new_benchmark_is_not_repeated_for_the_schedule(files):
    for text in (own(kind=None), own(kind="tsk"), own(timeout="soon")):
        assert [name for name, _, _ in files.errors(benchmarks=text, schedule=schedule())] == ["benchmarks"]


def test_the_schedule_knows_the_new_codes(files):
    _, line, message = files.error(benchmarks=TEXT, schedule=schedule("SetTabel"))
    assert line == 3
    assert "'SetTabel' as benchmark; expected a benchmark code: did you mean 'SetTable'?" in message


def test_all_errors_at_once(files):
    text = own(kind="tsk", uses="[tablets, 5]", offline_data="maybe", timeout="soon")
    lines = [line for _, line, _ in files.errors(benchmarks=text, schedule=schedule("HGTKMH"))]
    begin = line_of(text, "kind: tsk")
    assert lines == [begin, begin + 1, begin + 2, begin + 2, begin + 3]


@pytest.mark.parametrize("words, expected", [
    ("about: It drives.", (("en", "It drives."),)),
    ("about: { en: It drives., de: Er fährt. }", (("en", "It drives."), ("de", "Er fährt."))),
])
def test_what_spectators_read_of_a_benchmark(files, words, expected):
    """One text is English."""
    found = files.load(benchmarks=TEXT + f"  {words}\n")[0]
    assert found.benchmarks["SetTable"].about == expected


@pytest.mark.parametrize("words, part", [
    ("about: { English: It drives. }", "a language such as en or de"),
    ("about: { en: 5 }", "the number '5' as about in 'en'"),
    ("about: [It drives.]", "a sequence"),
    (f"about: {'x' * 301}", "at most 300 bytes"),
])
def test_what_spectators_cannot_read(files, words, part):
    error = files.error(benchmarks=TEXT + f"  {words}\n")
    assert part in error[2]
