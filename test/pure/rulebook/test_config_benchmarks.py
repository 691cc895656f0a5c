"""Errors and warnings of the benchmarks file: the line, what was found, what was expected."""

import pytest

from helpers.config_files import TEXTS, changed, line_of
from roah_rsbb.model.scoring import ScoreKind

TEXT = TEXTS["benchmarks"]
SECONDS = "as timeout; expected a number of seconds above 0 and at most 86400"

# What is replaced, by what, and parts of the message. The error is in the line of the replacement.
MISTAKES = [
    ("timeout: 600", 'timeout: "ten"', ["found the text 'ten'", SECONDS]),
    ("timeout: 600", 'timeout: "600"', ["the quoted text '600'", SECONDS, "remove the quotes"]),
    ("timeout: 600", "timeout: -5", ["found the number '-5'", SECONDS]),
    ("timeout: 600", "timeout: 0", ["found the number '0'", SECONDS]),
    ("timeout: 600", "timeout: 0.0", ["found the number '0.0'", SECONDS]),
    ("timeout: 600", "timeout: nan", ["found the text 'nan'", SECONDS]),
    ("timeout: 600", "timeout: .nan", ["'.nan'", SECONDS]),
    ("timeout: 600", "timeout: .inf", ["'.inf'", SECONDS]),
    ("timeout: 600", "timeout: -.inf", ["'-.inf'", SECONDS]),
    ("timeout: 600", "timeout: 1e999", ["'1e999'", SECONDS]),
    ("timeout: 600", "timeout: 86401", ["'86401'", SECONDS]),
    ("timeout: 600", "timeout: " + "9" * 9000, ["'999", "...'", SECONDS]),
    ("timeout: 600", "timeout: true", ["'true' (to YAML, a yes-or-no value)", SECONDS]),
    ("timeout: 600", "timeout: 10:00", ["'10:00'", SECONDS, "digits only"]),
    ("timeout: 600", "timeout: 600,5", ["'600,5'", SECONDS, "digits only"]),
    ("timeout: 600", "timeout:", ["found nothing", SECONDS]),
    ("timeout: 600", "timeout: [600]", ["found a sequence", SECONDS]),
    ("total_timeout: 600", "total_timeout: x", ["found the text 'x' as total_timeout"]),
    ("timeout: 600", "timout: 600", ["the unknown key 'timout' in a benchmark", "did you mean 'timeout'?"]),
    ("timeout: 600", "Timeout: 600", ["the unknown key 'Timeout'", "did you mean 'timeout'?"]),
    ("timeout: 600", "timeout: 600\n  colour: red", ["the unknown key 'colour'", "'total_timeout', 'scoring'"]),
    ("code: HWV", "code: HVW", ["found the text 'HVW' as code", "did you mean 'HWV'?"]),
    ("code: HWV", "code: hwv", ["did you mean 'HWV'?"]),
    ("code: HWV", "code: Kitchen", ["'HGTKMH', 'HWV', 'HCFGAC', 'HOPF', 'HNF', 'HSUF'"]),
    ("code: HWV", "code: [HWV]", ["found a sequence"]),
    ("code: HWV", "code: HGTKMH", ["a second benchmark with code 'HGTKMH'",
                                   f"already in line {line_of(TEXTS['benchmarks'], 'code: HGTKMH')}"]),
    ("name: Task Benchmark 1", "name: 2015", ["the number '2015' as name", "a text: put it in quotes"]),
    ("name: Task Benchmark 1", "name: 2015-12-31", ["the date '2015-12-31'", "put it in quotes"]),
    ("name: Task Benchmark 1", "name: No", ["'No' (to YAML, a yes-or-no value)", "put it in quotes"]),
    ("name: Task Benchmark 1", "name: ~", ["'~' (to YAML, a null value)", "put it in quotes"]),
    ("name: Task Benchmark 1", "name: ' Task'", ["neither begins nor ends with a space"]),
    ("name: Task Benchmark 1", 'name: "Task\\n1"', [r"'Task\n1'", "a text of one line"]),
    ("name: Task Benchmark 1", 'name: "Task\\u202e1"', [r"'Task\u202e1'", "turn the direction of text"]),
    ("name: Task Benchmark 1", 'name: "Task\\u200b1"', [r"'Task\u200b1'", "have no width"]),
    ("desc: Getting", "desc: ''  # Getting", ["an empty text as desc"]),
    ("desc: Welcoming", "code: Welcoming", ["the key 'code' again", "already in line"]),
    ("code: HWV", "code: HWV\n  code: x", ["the key 'code' again"]),
    ("type: bool", "type: boolean", ["'boolean' as type", "a scoring type: did you mean 'bool'?"]),
    ("type: bool", "type: uints", ["'uints' as type", "did you mean 'uint'?"]),
    ("type: bool", "type: true", ["'true'", "a scoring type: there is 'bool', 'uint'"]),
    ("desc: Stops working", 'desc: ""', ["an empty text as name of a row"]),
    ("desc: Stops working", "desc:", ["found nothing as name of a row"]),
    ("desc: Stops working", "descr: Stops working", ["unknown key 'descr'", "did you mean 'desc'?"]),
    ("desc: Stops working", "desc: Stops, or sleeps", ["unknown key 'or sleeps'", "comma needs quotes"]),
    ("desc: Stops working", "desc:Stops", ["unknown key 'desc:Stops'", "did you mean 'desc'? (a space after"]),
    ("{ type: uint, desc: Stops working }", "Stops working", ["a scoring item; expected a map 'type: bool, desc:"]),
    ("- Penalized Behaviors:", "- Penalized Behaviors: []\n    - More:", ["an empty sequence as items"]),
    ("- Penalized Behaviors:", "- Penalized\n    - More:", ["'Penalized' in scoring; expected groups"]),
    ("- Penalized Behaviors:", "- 2015:", ["the number '2015' as name of a scoring group"]),
]


@pytest.mark.parametrize("old, new, parts", MISTAKES, ids=[new[:25] for _, new, _ in MISTAKES])
def test_one_mistake_is_one_error_in_its_line(files, old, new, parts):
    text = changed("benchmarks", old, new)
    name, line, message = files.error(benchmarks=text)
    assert name == "benchmarks"
    # Of a key that stands twice the second is the error.
    line -= "again" in message
    lines = text.splitlines()
    mistake = new.splitlines()[-1] if "colour" in new else new.splitlines()[0]
    assert mistake in lines[line - 1], (line, lines[line - 1])
    assert [part for part in parts if part not in message] == [], message


@pytest.mark.parametrize("old, new, where, expected", [
    ("  code: HWV\n  timeout: 600\n", "", "Task Benchmark 2",
     "found a benchmark without code and timeout; expected something like 'code: HGTKMH' and 'timeout: 600'"),
    ("- name: Task Benchmark 2", "  name: Task Benchmark 2", "Task Benchmark 2", "the key 'name' again"),
    ("- name: Task Benchmark 2", "  name: Task Benchmark 2", "Task Benchmark 2", "a new item begins with '- '"),
])
def test_missing_keys_are_named_where_their_map_begins_and_maps_run_together_where_they_meet(
    files, old, new, where, expected,
):
    text = changed("benchmarks", old, new)
    _, line, message = files.error(benchmarks=text)
    assert line == line_of(text, where)
    assert expected in message


def test_the_same_item_twice_in_a_group_but_not_in_two(files):
    text = changed("benchmarks", "desc: Stops working", "desc: Bumps into the furniture")
    _, line, message = files.error(benchmarks=text)
    assert line == line_of(text, "Bumps into the furniture") + 1
    assert "the id 'Penalized Behaviors: Bumps into the furniture' again" in message
    files.load(benchmarks=changed("benchmarks", "desc: Stops working", "desc: Hits Annie or another person"))


def test_a_key_twice_is_an_error_and_not_silently_the_last(files):
    text = changed("benchmarks", "  code: HWV\n", "  code: HWV\n  timeout: 5\n")
    _, line, message = files.error(benchmarks=text)
    first = line_of(text, "timeout: 5")
    assert line == first + 1
    assert message == f"found the key 'timeout' again; expected each key once: it is already in line {first}"


def test_all_errors_at_once_in_the_order_of_lines(files):
    text = TEXT.replace("code: HSUF", "code: HUSF").replace("timeout: 300", "timeout: soon")
    text = text.replace("type: bool, desc: Enters", "type: flag, desc: Enters")
    found = files.errors(benchmarks=text)
    assert [line for _, line, _ in found] == [line_of(text, part) for part in ("flag", "HUSF", "soon")]


def test_total_timeout_less_than_timeout_is_a_warning(files):
    text = changed("benchmarks", "total_timeout: 600", "total_timeout: 60")
    loaded, warnings = files.load(benchmarks=text)
    assert len(warnings) == 1
    assert f"benchmarks.yaml:{line_of(text, 'total_timeout: 60')}: total_timeout 60 of HOPF" in warnings[0]
    assert loaded.benchmarks["HOPF"].total_timeout == 60


def test_total_timeout_is_timeout_unless_given(files):
    text = changed("benchmarks", "timeout: 600", "timeout: 450.5")
    benchmark = files.load(benchmarks=text)[0].benchmarks["HGTKMH"]
    assert (benchmark.timeout, benchmark.total_timeout) == (450.5, 450.5)


def test_groups_may_be_keys_of_one_map(files):
    text = "- {name: a, desc: b, code: STB, timeout: 1, scoring: [{A: [{type: bool, desc: x}], B: [%s]}]}"
    text = text % "{type: uint, desc: x}"
    schedule = "- {zone: z, schedule: [{benchmark: STB, team: DumpTeam, round: 1, run: 1, scheduled_time: %s}]}"
    loaded, _ = files.load(benchmarks=text, schedule=schedule % "2020-01-01")
    items = [(item.group, item.desc, item.kind) for item in loaded.benchmarks["STB"].scoring]
    assert items == [("A", "x", ScoreKind.BOOL), ("B", "x", ScoreKind.UINT)]
