"""Parameters of modules: reading them from their files, and reporting their errors."""

import pytest

from helpers.config_files import SHIPPED
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
    assert read_parameters(str(SHIPPED / "modules" / f"{code}.yaml"), code, modules()[code].PARAMETERS)


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


# -- the shipped parameters of the benchmarks with ground truth, and what is refused in them ----------

MODULES = SHIPPED / "modules"


def read_file(path, code):
    return read_parameters(str(path), code, modules()[code].PARAMETERS)


def test_the_shipped_parameters():
    hopf, hppf, hpff, hgmf = (read_file(MODULES / f"{code}.yaml", code) for code in ("HOPF", "HPPF", "HPFF", "HGMF"))
    assert {each.goal_timeout for each in (hopf, hppf, hpff, hgmf)} == {None}  # that of benchmarks.yaml
    assert len({item.id for item in hopf.items}) == len(hopf.items) >= hopf.goals == 10
    assert "Annie" in hppf.people
    assert (hpff.minimum_distance, hpff.maximum_distance, hpff.desired_distance) == (0.15, 3.5, 2.0)
    assert len({thing.id for thing in hgmf.objects}) == len(hgmf.objects)


@pytest.mark.parametrize("code, old, new, found", [
    ("HOPF", "goals: 10", "goals: 0", "found the number '0' as goals; expected a whole number from 1 to 100"),
    ("HOPF", "goals: 10", "goals: 101", "expected a whole number from 1 to 100"),
    ("HOPF", "{ id: 1,", "{ id: 70000,", "expected a whole number from 0 to 65535"),
    ("HOPF", "{ id: 1,", "{ id: -1,", "expected a whole number from 0 to 65535"),
    ("HOPF", "x: 1.2", "x: 0", "expected a number of metres above 0 and at most 10"),
    ("HOPF", "y: 0.8", "y: 0.0", "expected a number of metres above 0 and at most 10"),
    ("HOPF", "class: cups, ", "", "without class"),
    ("HPPF", "- Annie", "- 7", "expected a text"),
    ("HPFF", "minimum_distance: 0.15", "minimum_distance: -1", "expected a number of metres at least 0 and at most"),
    ("HPFF", "maximum_distance: 3.5", "maximum_distance: 0", "expected a number of metres above 0 and at most 100"),
    ("HPFF", "desired_distance: 2.0", "desired_distance: 0", "expected a number of metres above 0 and at most 100"),
    ("HPFF", "# goal_timeout: 300", "goal_timeout: -3", "expected a number of seconds above 0"),
    # On a smaller table there may be no target 5 cm from the object.
    ("HGMF", "x: 1.2", "x: 0.49", "expected a number of metres at least 0.5 and at most 10"),
    ("HGMF", "y: 0.8", "y: 0.49", "expected a number of metres at least 0.5 and at most 10"),
    # What GoalHGMF has room for (docs/ros_interface.md, "Team's side").
    ("HGMF", "{ id: 1,", "{ id: 65536,", "expected a whole number from 0 to 65535"),
])
def test_refused_values(tmp_path, code, old, new, found):
    text = (MODULES / f"{code}.yaml").read_text(encoding="utf-8")
    assert old in text
    (tmp_path / "it.yaml").write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ConfigErrors, match=f"yaml:{text[:text.index(old)].count(chr(10)) + 1}: ") as wrong:
        read_file(tmp_path / "it.yaml", code)
    assert found in str(wrong.value)
