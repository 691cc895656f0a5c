"""Limits of a module's messages: each is cut, repaired or refused correctly, and nothing raises."""

import json
import re

import pytest

from helpers.forms import MEASURED, ODD, form
from roah_rsbb.bmbox.host.limits import (
    MAX_FIELDS,
    MAX_JSON,
    MAX_LIST,
    MAX_NAME,
    MAX_SCORES,
    MAX_TEXT,
    RESERVED,
    checked,
    checked_state,
    clean,
)
from roah_rsbb.model.fields import Choice, Decimal, Fixed, Number, Robot, Toggle, TypedText, form_text
from roah_rsbb.model.modules import ModuleInfo, ModulesState, Progress, Request, RequestKind, ScoreValue
from roah_rsbb.model.reason import say

USUAL = Progress(
    "HNF-1", 2, Request(
        3, RequestKind.GOAL, "Waypoint 1", form_text(ODD), "[1, 2, 3]", (1.0, 2.0, 3.0), (True, False), (2, 1), 15.0,
        '{"a": 1}',
    ),
    (ScoreValue("waypoint 1", "time", "1.5", "s", "Time"),), "under way", ("old",), '{"sum": 1}', True, "",
)
REQUEST = Request(1, RequestKind.GOAL)
LONE = "a\ud800b"


def with_request(**fields):
    return checked(Progress("run", 1, REQUEST._replace(**fields)))


def with_value(text):
    return checked(Progress("run", 1, scores=(ScoreValue("", "n", text, ""),))).scores[0].value


def test_usual_values_stay_unchanged():
    assert checked(USUAL) == USUAL
    state = ModulesState("node", (ModuleInfo("HNF", ("HNF.yaml:1: wrong",), ("old",)),), (USUAL,))
    assert checked_state(state) == state
    assert checked(Progress("run", 1)) == Progress("run", 1)


@pytest.mark.parametrize(("fields", "reason"), [
    ({"number": 0}, "its request has the number 0"),
    ({"number": 2**32}, "numbers start at 1"),
    ({"note": "x" * (MAX_JSON + 1)}, f"its note has {MAX_JSON + 1} characters"),
    ({"form": form(*("a",) * (MAX_LIST + 1))}, f"'answer' has {MAX_LIST + 1} choices"),
    ({"form": form("x" * 1001)}, "longer than 1000 characters"),
    ({"form": form("\ud800")}, "its form is no UTF-8"),
    ({"form": '[{"kind": "\\ud800", "name": "a"}]'}, "KeyError: 'label'"),
    ({"form": form_text([Choice("a", say("A"))])}, "has 0 choices"),
    ({"form": form_text([Number("a", say("A"), high=2**31)])}, "'a' is from 0 to 2147483648"),
    ({"form": form_text([Number("a", say("A"), default=2**31)])}, "'a' is from 0 to"),
    ({"form": form_text([Decimal("a", say("A"), high=float("nan"))])}, "'a' is from 0.0 to nan"),
    ({"form": form_text([TypedText("a", say("A"), characters=1001)])}, "'a' has 1001 characters"),
    ({"form": form_text([Robot("a", say("A"))])}, "is a robot, which a module cannot ask for"),
    ({"form": form_text([Fixed("a", say("A"))])}, "is a fixed, which a module cannot ask for"),
    ({"form": form_text([Toggle("operation", say("A"))])}, "'operation' has a wrong name: names are of a to z"),
    ({"form": form_text([Toggle("a", say("A"))] * 2)}, "'a' has a wrong name"),
    *(({"form": form_text([Toggle(name, say("A"))])}, f"'{name}' has a wrong name") for name in sorted(RESERVED)),
    ({"form": form("yes", "")}, "has an empty choice, or one twice"),
    ({"form": form("yes", " yes")}, "has an empty choice, or one twice"),
    ({"form": form_text([Toggle("a", say("A\x1b[2J"))])}, "has a text with control characters"),
    ({"form": form_text([Number("a", say("A"), low=1, high=3, default=4)])}, "'a' is 4 if it is left out"),
    ({"form": form_text([Toggle("a b", say("A"))])}, "'a b' has a wrong name"),
    ({"form": form_text([Toggle(f"a{n}", say("A")) for n in range(MAX_FIELDS + 1)])}, "at most 20 fields"),
    *(({"form": text}, "its form cannot be read") for text in (
        "[", "7", "[7]", "{}7", "[" * 2000, '[{"kind": "number"}]', '[{"kind": "toggle", "name": "a", "label": 7}]',
        '[{"kind": "number", "name": "a", "label": "A", "low": "x"}]',
        '[{"kind": "choice", "name": "a", "label": "A", "choices": [7]}]',
        '[{"kind": "choice", "name": "a", "label": "A", "choices": "table"}]',
        '[{"kind": "toggle", "name": ["a"], "label": "A"}]',
        '[{"kind": "new", "name": "a", "label": "A", "required": 2}]',
        '[{"kind": "toggle", "name": "a", "label": "A", "size": 7}]')),
    ({"pose": (1.0, 2.0)}, r"pose is \(1.0, 2.0\)"),
    ({"pose": (1.0, 2.0, 3.0, 4.0)}, "x, y and theta must be finite numbers"),
    ({"pose": (1.0, float("nan"), 0.0)}, "x, y and theta must be finite numbers"),
    ({"timeout": float("nan")}, "timeout is nan s"),
    ({"timeout": float("inf")}, "timeout is inf s"),
    ({"timeout": -0.1}, "timeout is -0.1 s"),
    ({"initial_state": (True,) * 256}, "its goal has 256 switches"),
    ({"switches": (1, -1)}, r"switches are \(1, -1\)"),
    ({"switches": (2**32,)}, "numbers start at 1"),
])
def test_a_request_that_would_mean_something_else_ends_the_run(fields, reason):
    progress = with_request(**fields)
    assert re.search(reason, progress.failed)
    assert progress.request is None


@pytest.mark.parametrize("fields", [
    {"number": 2**32 - 1}, {"note": "x" * MAX_JSON}, {"timeout": 0.0},
    {"form": form(*(f"{n:0600}" for n in range(MAX_LIST)))}, {"form": form(asks_text=True)},
    {"form": form_text([MEASURED, *ODD])}, {"initial_state": (True,) * 255}, {"switches": (2**32 - 1,)}, {"pose": None},
])
def test_the_most_that_is_allowed(fields):
    assert with_request(**fields) == Progress("run", 1, REQUEST._replace(**fields))


def test_a_failed_module_keeps_its_own_reason_and_its_score():
    progress = checked(USUAL._replace(failed="its rules changed", request=REQUEST._replace(number=0)))
    assert (progress.failed, progress.request, progress.scores) == ("its rules changed", None, USUAL.scores)


def test_too_much_to_keep_ends_the_run():
    assert checked(Progress("run", 1, kept="x" * MAX_JSON)).kept == "x" * MAX_JSON
    progress = checked(Progress("run", 1, kept="x" * (MAX_JSON + 1)))
    failed = f"it keeps {MAX_JSON + 1} characters: at most {MAX_JSON} are allowed"
    assert (progress.kept, progress.failed) == ("", failed)


def test_texts_and_lists_are_cut():
    long, many = "x" * 5000, MAX_LIST + 1
    everything = Progress(
        long, 10**9, REQUEST._replace(text=long), (ScoreValue(long, long, '"a"', long, long),) * (MAX_SCORES + 1),
        long, (long,) * many, failed="",
    )
    state = checked_state(ModulesState(
        long, (ModuleInfo(long, (long,) * many, (long,) * many),) * many,
        (everything, *[Progress("run", 1)] * MAX_LIST),
    ))
    assert (len(state.node), len(state.modules), len(state.progress)) == (MAX_NAME, MAX_LIST, MAX_LIST)
    info, progress = state.modules[0], state.progress[0]
    assert (len(info.benchmark), len(info.problems), len(info.warnings)) == (MAX_NAME, MAX_LIST, MAX_LIST)
    assert {len(text) for text in info.problems + info.warnings + progress.warnings} == {MAX_TEXT}
    assert (len(progress.scores), len(progress.warnings), len(progress.status)) == (MAX_SCORES, MAX_LIST, MAX_TEXT)
    assert [len(field) for field in progress.scores[0]] == [MAX_NAME, MAX_NAME, 3, MAX_NAME, MAX_TEXT]
    assert (len(progress.request.text), progress.attempt) == (MAX_TEXT, 65535)
    assert clean("x" * 11, 10) == "x" * 9 + "…"
    assert checked(Progress("run", -1)).attempt == 0


def test_what_has_no_utf8_is_replaced_everywhere():
    state = checked_state(ModulesState(LONE, (ModuleInfo(LONE, (LONE,), (LONE,)),), (Progress(
        LONE, 1, REQUEST._replace(text=LONE, goal=LONE, note=LONE),
        (ScoreValue(LONE, LONE, LONE, LONE, LONE), ScoreValue("", "", '"\\ud800"', "")),
        LONE, (LONE,), LONE, False, LONE,
    ), Progress("run", 1, REQUEST._replace(text=LONE, goal=LONE, note=LONE), kept=LONE))))
    repr(state).encode("utf-8")
    for progress in state.progress:
        for score in progress.scores:
            json.loads(score.value).encode("utf-8")
    assert state.progress[1].request.goal == "a?b"


@pytest.mark.parametrize(("text", "value"), [
    ("1", "1"), ("1.5", "1.5"), ("true", "true"), ("null", "null"), ('"a"', '"a"'), (' "ä" ', '"\\u00e4"'),
    ("NaN", "null"), ("-Infinity", "null"), ("1e999", "null"), ("", '""'), ("no JSON", '"no JSON"'),
    ("[1]", '"[1]"'), ("{}", '"{}"'), ("[" * 900, json.dumps("[" * 900)),
])
def test_a_score_is_a_json_scalar(text, value):
    assert with_value(text) == value


def test_a_long_score_is_a_cut_text():
    assert json.loads(with_value('"' + "x" * 5000)) == '"' + "x" * (MAX_TEXT - 2) + "…"
    assert json.loads(with_value("9" * 5000)) == "9" * (MAX_TEXT - 1) + "…"
