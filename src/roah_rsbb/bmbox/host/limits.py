"""Limits for data of benchmarking modules, so that all of it can be sent, stored and shown.

Texts for the referee are shortened. Data that cannot be shortened ends the run of this module with the reason
(`Progress.failed`). Other modules are not affected.
"""

import json
import math
import re
from typing import Tuple

from roah_rsbb.model.fields import ASKED, Choice, Decimal, Field, Number, TypedText, form_of
from roah_rsbb.model.modules import ModuleInfo, ModulesState, Progress, Request, ScoreValue

# Characters and entries: more than any benchmark needs, and few enough not to slow down the box.
MAX_NAME = 200
MAX_TEXT = 1000
MAX_LIST = 100
MAX_SCORES = 1000
MAX_JSON = 65536
MAX_FIELDS = 20
# Spin boxes of panels hold no more.
MAX_SIZE = 2**31 - 1
_NAME = re.compile("[a-z][a-z0-9_]{0,39}")  # of a field
# Names that something else has in the same record: the number of the request, in the journal, in JavaScript.
RESERVED = frozenset({"operation", "command", "refused", "constructor"})
# `uint32`, `uint16` and `uint8` on the ROS interface.
MAX_NUMBER = 2**32 - 1
MAX_ATTEMPT = 2**16 - 1
MAX_SWITCHES = 2**8 - 1


def checked_state(state: ModulesState) -> ModulesState:
    """Limit the state of a node with modules."""
    return ModulesState(
        clean(state.node, MAX_NAME),
        tuple(checked_info(info) for info in state.modules[:MAX_LIST]),
        tuple(checked(progress) for progress in state.progress[:MAX_LIST]),
    )


def checked(progress: Progress) -> Progress:
    """Limit the state of one module. If it is invalid, `failed` of the returned state gives the reason."""
    problem = progress.failed or _problem_of(progress)
    request = None if problem or progress.request is None else _cleaned(progress.request)
    return Progress(
        clean(progress.run, MAX_NAME), min(max(progress.attempt, 0), MAX_ATTEMPT), request,
        tuple(_checked_score(score) for score in progress.scores[:MAX_SCORES]),
        clean(progress.status),
        _texts(progress.warnings),
        "" if problem else clean(progress.kept, MAX_JSON),
        progress.finished, clean(problem),
    )


def clean(text: str, at_most: int = MAX_TEXT) -> str:
    """Make a text valid UTF-8 (without lone surrogates) and limit its length."""
    whole = text[:at_most + 1].encode("utf-8", "replace").decode("utf-8")  # encoding megabytes takes long
    return whole if len(whole) <= at_most else whole[:at_most - 1] + "…"


def _texts(texts: Tuple[str, ...]) -> Tuple[str, ...]:
    return tuple(clean(text) for text in texts[:MAX_LIST])


def checked_info(info: ModuleInfo) -> ModuleInfo:
    """Limit what a node reports about one of its modules."""
    return ModuleInfo(clean(info.benchmark, MAX_NAME), _texts(info.problems), _texts(info.warnings),
                      clean(info.zone, MAX_NAME))


def _checked_score(score: ScoreValue) -> ScoreValue:
    return ScoreValue(
        clean(score.group, MAX_NAME), clean(score.name, MAX_NAME), _json_scalar(score.value),
        clean(score.unit, MAX_NAME), clean(score.desc),
    )


def _json_scalar(text: str) -> str:
    """Return a JSON scalar. Other values become a text, and numbers that are not finite become null."""
    try:
        value = json.loads(text, parse_constant=lambda _: None) if len(text) <= MAX_TEXT else text
    except (ValueError, RecursionError):
        value = text
    if isinstance(value, float) and not math.isfinite(value):
        value = None  # 1e999
    if isinstance(value, (list, dict)):
        value = text
    return json.dumps(clean(value) if isinstance(value, str) else value)


def _problem_of(progress: Progress) -> str:
    """Why the state of a module is invalid; empty if it is valid."""
    if len(progress.kept) > MAX_JSON:
        return f"it keeps {len(progress.kept)} characters: at most {MAX_JSON} are allowed"
    request = progress.request
    if request is None:
        return ""
    if not 1 <= request.number <= MAX_NUMBER:
        return f"its request has the number {request.number}: numbers start at 1"
    of_form = _form_problem(request.form)
    for fits, problem in (
        (not of_form, of_form),
        (len(request.note) <= MAX_JSON, f"its note has {len(request.note)} characters: at most {MAX_JSON} are allowed"),
        (request.pose is None or (len(request.pose) == 3 and all(map(math.isfinite, request.pose))),
         f"its goal's pose is {request.pose}: x, y and theta must be finite numbers"),
        (math.isfinite(request.timeout) and request.timeout >= 0.0,
         f"its goal's timeout is {request.timeout} s: it must be at least 0"),
        (len(request.initial_state) <= MAX_SWITCHES,
         f"its goal has {len(request.initial_state)} switches: at most {MAX_SWITCHES} are allowed"),
        (all(0 <= switch <= MAX_NUMBER for switch in request.switches),
         f"its goal's switches are {request.switches}: numbers start at 1"),
    ):
        if not fits:
            return f"{problem} (request {request.number})"
    return ""


def _form_problem(text: str) -> str:
    """Return why a form cannot be shown; empty: it can."""
    try:
        fields = form_of(text) if clean(text, MAX_JSON) == text else None
    except (TypeError, ValueError, KeyError, AttributeError, RecursionError) as error:
        return f"its form cannot be read: {type(error).__name__}: {error}"
    if fields is None or len(fields) > MAX_FIELDS:
        return f"its form is no UTF-8 or too long: at most {MAX_FIELDS} fields and {MAX_JSON} characters are allowed"
    names = [field.name for field in fields]
    for field in fields:
        problem = _field_problem(field, names.count(field.name))
        if problem:
            return f"its form's field '{clean(field.name, MAX_NAME)}' {problem}"
    return ""


def _field_problem(field: Field, times: int) -> str:
    if not _NAME.fullmatch(field.name) or field.name in RESERVED or times > 1:
        return ("has a wrong name: names are of a to z, 0 to 9 and _, each once, and none of "
                + ", ".join(sorted(RESERVED)))
    if type(field) not in ASKED:
        return f"is a {field.kind}, which a module cannot ask for"
    if isinstance(field, (Number, Decimal)) and not (
            -MAX_SIZE <= field.low <= field.high <= MAX_SIZE and abs(field.nothing or 0) <= MAX_SIZE):
        return f"is from {field.low} to {field.high}: at most from {-MAX_SIZE} to {MAX_SIZE} is possible"
    if isinstance(field, TypedText) and not 1 <= field.characters <= MAX_TEXT:
        return f"has {field.characters} characters: 1 to {MAX_TEXT} are allowed"
    if isinstance(field, Choice) and not 1 <= len(field.choices) <= MAX_LIST:
        return f"has {len(field.choices)} choices: 1 to {MAX_LIST} are allowed"
    if isinstance(field, Choice) and len({*map(str.strip, field.choices), ""}) <= len(field.choices):
        return "has an empty choice, or one twice"
    if isinstance(field, Number) and field.default and not field.low <= field.default <= field.high:
        return f"is {field.default} if it is left out, which is not from {field.low} to {field.high}"
    texts = [field.label, *getattr(field, "choices", ()), getattr(field, "unit", "")]
    if not all(clean(text) == text for text in texts):
        return f"has a text longer than {MAX_TEXT} characters"
    return "" if all(map(str.isprintable, texts)) else "has a text with control characters"


def _cleaned(request: Request) -> Request:
    return request._replace(
        text=clean(request.text),
        goal=clean(request.goal, MAX_JSON),
        note=clean(request.note, MAX_JSON),
    )
