"""Results of unknown robots."""

import json
import time

import pytest

from roah_rsbb.bmbox.framework.results import BadResult, read_record
from roah_rsbb.bmbox.framework.score import Score, Value
from roah_rsbb.model.modules import ScoreValue

HOPF = {"class": str, "instance": str, "x": float, "y": float, "theta": float}


@pytest.mark.parametrize("text", [
    "{class: a, instance: b, x: 1, y: -2.5, theta: 1e-7}",
    "class: a\ninstance: 'b'\nx: 1.0\ny: -2.5\ntheta: 1e-07\n",
    '---\n{"class": "a", "instance": "b", "x": 1, "y": -2.5, "theta": 0.0000001, "more": [1, {b: c}]}\n...\n',
])
def test_a_map_in_any_style(text):
    read = read_record(text, HOPF)
    assert (read.class_, read.instance, read.x, read.y, read.theta) == ("a", "b", 1.0, -2.5, 1e-7)


@pytest.mark.parametrize("text, name", [("{n: on}", "on"), ("{n: 12}", "12"), ("{n: 1e3}", "1e3"), ("{n: ~}", "~"),
                                        ("{n: 2015-01-01}", "2015-01-01"), ("{n: ''}", ""), ("{n: Käse}", "Käse")])
def test_a_text_is_read_literally(text, name):
    assert read_record(text, {"n": str}).n == name


@pytest.mark.parametrize("text, reason", [
    ("", "empty"), ("  \n", "empty"), ("# nothing", "empty"), ("a", "expected {n}"), ("[1, 2]", "expected {n}"),
    ("{m: 1}", "has no n"), ("{n: [1]}", "expected one value"), ("{n: {a: 1}}", "expected one value"),
    ("{n: x}", "expected a number"), ("{n: .nan}", "expected a number"), ("{n: nan}", "expected a number"),
    ("{n: 1e999}", "expected a number"), ("{n: }", "expected a number"), ("{n: true}", "expected a number"),
    ("{n: 1", "not valid YAML"), ("\x00", "not valid YAML"), ("a: b: c", "not valid YAML"),
    ("{n: 1}\n---\n{n: 2}", "several documents"),
    ("&a {n: *a}", "anchor"), ("{n: &a 1, m: *a}", "anchor"), ("{n: !!int 1}", "tag"),
    ("!!python/object/apply:os.system [ls]", "tag"), ("x" * 2001, "2001 characters"),
    ("[" * 50 + "]" * 50, "levels deep"), ("[" * 1000 + "]" * 1000, "too many parts"),
    ("{n: [" + "1," * 100 + "]}", "too many parts"), ("{" + "\U000e0001" * 90 + "}", "expected {n}"),
    ("{" + "\0" * 90 + "}", "not valid YAML"),
    ('{n: "\\UFFFFFFFF"}', "not valid YAML"), ("{? {a: 1} : 2, ? [1] : 3}", "has no n"),
])
def test_an_invalid_result_gives_the_reason(text, reason):
    with pytest.raises(BadResult) as raised:
        read_record(text, {"n": float})
    assert reason in str(raised.value)
    assert len(str(raised.value)) < 300


def test_the_first_bomb_of_any_kind_costs_nothing():
    bomb = "a: &a [x,x,x,x,x,x,x,x,x]\n" + "\n".join(
        f"{chr(98 + i)}: &{chr(98 + i)} [{','.join(['*' + chr(97 + i)] * 9)}]" for i in range(20)
    )
    began = time.process_time()
    with pytest.raises(BadResult):
        read_record(bomb, {"n": float})
    assert time.process_time() - began < 1.0


def test_values_of_every_kind():
    text = '{"count": 3, "found": true, "lost": False, "colours": ["red", "blue"], "poses": [1, -2.5e1], "is": 1}'
    read = read_record(text, {"count": int, "found": bool, "lost": bool, "colours": [str], "poses": [float], "is": int})
    assert (read.count, read.found, read.lost, read.colours) == (3, True, False, ["red", "blue"])
    assert (read.poses, read.is_) == ([1.0, -25.0], 1)
    assert read_record("{n: []}", {"n": [int]}).n == []


@pytest.mark.parametrize("text, kind, reason", [
    ("{n: 1.5}", int, "n of the result is '1.5': expected a whole number"), ("{n: 0x1F}", int, "expected a whole"),
    ("{n: " + "9" * 19 + "}", int, "expected a whole number"), ("{n: 1}", bool, "n of the result is '1': expected"),
    ("{n: yes}", bool, "expected true or false"), ("{n: 1}", [int], "n of the result is a single value"),
    ("{n: {a: 1}}", [int], "expected a list"), ("{n: [1, x]}", [int], "item 2 of n of the result is 'x': expected a"),
    ("{n: [[1]]}", [int], "item 1 of n of the result is a list"), ("{n: [.inf]}", [float], "expected a number"),
])
def test_a_value_of_another_kind_says_why(text, kind, reason):
    with pytest.raises(BadResult) as raised:
        read_record(text, {"n": kind})
    assert reason in str(raised.value)


# -- a module's score: declared, typed, sent ----------------------------------------------------------

def score():
    return Score({"reached": Value("Reached"), "error": Value("Error", "m")}, {"time": Value("Time", "s")})


def test_values_of_the_whole_run_are_null_until_they_are_set():
    assert score().values() == (
        ScoreValue("", "reached", "null", "", "Reached"), ScoreValue("", "error", "null", "m", "Error")
    )


def test_values_keep_their_type_unit_and_order():
    s = score()
    s["waypoint 2", "time"] = 1.5
    s["reached"] = 3
    s["waypoint 1", "time"] = None
    s["waypoint 2", "time"] = 2.5
    assert [(v.group, v.name, json.loads(v.value), v.unit) for v in s.values()] == [
        ("", "reached", 3, ""), ("", "error", None, "m"), ("waypoint 2", "time", 2.5, "s"),
        ("waypoint 1", "time", None, "s"),
    ]
    assert s["reached"] == 3
    assert s["waypoint 2", "time"] == 2.5
    assert s["waypoint 9", "time"] is None
    assert s.each("time") == [2.5, None]


@pytest.mark.parametrize("key", ["time", "reachd", ("waypoint 1", "reached")])
def test_an_undeclared_name_is_an_error_that_lists_the_declared_ones(key):
    s = score()
    with pytest.raises(KeyError, match="which has (reached, error|time)"):
        s[key] = 1
    with pytest.raises(KeyError):
        s[key]


@pytest.mark.parametrize("value", [float("nan"), float("inf"), [1], {"a": 1}, object()])
def test_an_invalid_value_is_an_error(value):
    with pytest.raises(ValueError, match="score reached cannot be"):
        score()["reached"] = value
