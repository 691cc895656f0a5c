"""Parameters of modules: reading them from their files, and reporting their errors."""

import pathlib

import pytest

from roah_rsbb.bmbox.framework.ground_truth import Pose2D, Pose3
from roah_rsbb.bmbox.framework.parameters import (
    Amount,
    GoalTimeout,
    ListOf,
    PlanePose,
    Record,
    Seconds,
    Text,
    Transform,
    Whole,
    YesNo,
    read_parameters,
)
from roah_rsbb.bmbox.framework.rule_files import modules
from roah_rsbb.rulebook.errors import ConfigErrors

SHIPPED = pathlib.Path(__file__).resolve().parents[3] / "config" / "modules"
FIELDS = {
    "name": Text("mug"), "count": Whole("3", 1, 10), "share": Amount("", "0.5", least=0.0, most=1.0, default=0.5),
    "start": PlanePose(), "offset": Transform(), "wait": Seconds(default=8.0), "loud": YesNo("true", default=False),
    "items": ListOf(Record({"id": Whole("1", 0, 99), "desc": Text("a mug")}), at_most=2),
}
GOOD = """\
name: table
count: 3
start: [1, -2.5, 3.14]
offset: [0, 0, 0.1, -1.57]
items:
  - {id: 1, desc: a mug}
  - {id: 2, desc: a cup}
"""


def read(tmp_path, text, fields=None):
    path = tmp_path / "X.yaml"
    path.write_text(text, encoding="utf-8")
    return read_parameters(str(path), "X", FIELDS if fields is None else fields)


def test_all_kinds_of_values(tmp_path):
    p = read(tmp_path, GOOD)
    assert (p.name, p.count, p.share, p.wait, p.loud) == ("table", 3, 0.5, 8.0, False)
    assert p.start == Pose2D(1.0, -2.5, 3.14)
    assert p.offset == Pose3(0.0, 0.0, 0.1, -1.57)
    assert [(item.id, item.desc) for item in p.items] == [(1, "a mug"), (2, "a cup")]
    p = read(tmp_path, GOOD + "share: 0\nwait: 2\nloud: true\n")
    assert (p.share, p.wait, p.loud) == (0.0, 2.0, True)


@pytest.mark.parametrize("change, line, found, expected", [
    (("count: 3", "count: 30"), 2, "the number '30' as count", "a whole number from 1 to 10"),
    (("count: 3", "cuont: 3"), 2, "unknown key 'cuont'", "did you mean 'count'"),
    (("name: table\n", ""), 1, "without name", "'name: mug'"),
    (("[1, -2.5, 3.14]", "[1, -2.5]"), 3, "2 numbers as start", "x, y, theta"),
    (("[1, -2.5, 3.14]", "[1, b, 3.14]"), 3, "the text 'b' as y of start", "a number of metres"),
    (("[1, -2.5, 3.14]", "[1, 2, 314]"), 3, "the number '314' as theta of start", "a number of radians"),
    (("[1, -2.5, 3.14]", "1"), 3, "the number '1' as start", "3 numbers"),
    (("id: 2", "id: -2"), 7, "'-2'", "a whole number from 0 to 99"),
    (("desc: a cup}", "desc: a cup}\n  - {id: 3, desc: x}"), 8, "3 of them as items", "at most 2"),
    (("items:\n", "items: []\nnot:\n"), 5, "an empty sequence as items", "at least one"),
])
def test_an_error_names_line_what_was_found_and_what_was_expected(tmp_path, change, line, found, expected):
    assert change[0] in GOOD
    with pytest.raises(ConfigErrors) as raised:
        read(tmp_path, GOOD.replace(*change))
    error = raised.value.errors[0]
    assert (error.line, found in error.found, expected in error.expected) == (line, True, True), error


def test_all_errors_come_at_once(tmp_path):
    with pytest.raises(ConfigErrors) as raised:
        read(tmp_path, GOOD.replace("count: 3", "count: x").replace("a mug", "[]").replace("3.14", "a"))
    assert [error.line for error in raised.value.errors] == [2, 3, 6]


def test_a_missing_file_names_itself(tmp_path):
    with pytest.raises(ConfigErrors, match=r"nowhere.yaml: found no file .*the parameters of X"):
        read_parameters(str(tmp_path / "nowhere.yaml"), "X", FIELDS)


@pytest.mark.parametrize("code", sorted(modules()))
def test_the_shipped_files_are_good(code):
    assert read_parameters(str(SHIPPED / f"{code}.yaml"), code, modules()[code].PARAMETERS)


def test_a_goal_timeout_may_be_left_out(tmp_path):
    fields = {"name": Text("mug"), "goal_timeout": GoalTimeout()}
    assert read(tmp_path, "name: x", fields).goal_timeout is None
    assert read(tmp_path, "{name: x, goal_timeout: 12.5}", fields).goal_timeout == 12.5
    with pytest.raises(ConfigErrors, match="found the text 'soon' as goal_timeout"):
        read(tmp_path, "{name: x, goal_timeout: soon}", fields)


def test_a_file_without_required_parameters_may_be_missing(tmp_path):
    fields = {"goal_timeout": GoalTimeout(), "wait": Seconds(default=8.0)}
    found = read_parameters(str(tmp_path / "X.yaml"), "X", fields)
    assert (found.goal_timeout, found.wait) == (None, 8.0)
