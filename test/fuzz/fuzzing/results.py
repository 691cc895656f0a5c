"""Results of robots, alone and in benchmarking modules."""

import json
from types import SimpleNamespace
from typing import Callable, Dict, Iterator, List

from fuzzing.target import Step, Target
from roah_rsbb.bmbox.framework.ground_truth import NO_TRANSFORM, Pose3
from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.rehearsal import Poses, Rehearsal
from roah_rsbb.bmbox.framework.results import BadResult, read_record
from roah_rsbb.bmbox.hopf import HOPF
from roah_rsbb.bmbox.host.limits import checked_state
from roah_rsbb.bmbox.hppf import HPPF
from roah_rsbb.bmbox.stb import STB
from roah_rsbb.core.modules import scores_json
from roah_rsbb.model.modules import ModulesState, RequestKind

SHAPE = {"class": str, "instance": str, "x": float, "y": float, "theta": float}
HERE = Pose3(0.5, 0.25, 0.8, 0.0)
_ITEM = SimpleNamespace(**{
    "id": 1, "class": "mug", "instance": "red_mug", "description": "red mug", "transform": NO_TRANSFORM,
})


def _hopf() -> Rehearsal:
    parameters = {
        "items": [_ITEM], "goals": 1, "table_size": SimpleNamespace(x=1.2, y=0.8), "goal_timeout": 120.0,
    }
    return Rehearsal(HOPF, parameters, Poses(table=Pose3(0.0, 0.0, 0.8, 0.0), positioner=HERE))


def _hppf() -> Rehearsal:
    return Rehearsal(HPPF, {"people": ["Annie"], "goal_timeout": 120.0}, Poses(person=HERE))


def _stb() -> Rehearsal:
    return Rehearsal(STB, {"goals": ["A"], "goal_timeout": 15.0})


_REHEARSALS: Dict[type, Callable[[], Rehearsal]] = {HOPF: _hopf, HPPF: _hppf, STB: _stb}


def steps(data: bytes) -> Iterator[Step]:
    """A text is a result of its shape, or BadResult; no module fails of it."""
    text = data.decode("utf-8", "ignore")
    yield lambda: _read(text)
    for make in _REHEARSALS.values():
        rehearsal = make()
        while rehearsal.asked is not None and rehearsal.asked.kind is RequestKind.REFEREE:
            rehearsal.answer()
        assert rehearsal.asked is not None
        yield lambda rehearsal=rehearsal: rehearsal.result(text, 1.0)
        _check(rehearsal.module, rehearsal)


def _read(text: str) -> None:
    try:
        found = read_record(text, SHAPE)
    except BadResult as bad:
        assert len(str(bad)) < 300
    else:
        assert isinstance(found.class_, str)
        assert abs(found.x) < float("inf")


def _check(module: Module, rehearsal: Rehearsal) -> None:
    progress = rehearsal.runner.progress()
    assert not progress.failed, progress.failed
    fit = checked_state(ModulesState("node", (), (progress,))).progress[0]
    assert not fit.failed, fit.failed
    json.dumps(json.loads(scores_json(fit.scores)), allow_nan=False)


def seeds() -> List[bytes]:
    """Results as robots send them, and those that are meant to do harm."""
    bomb = "a: &a [x,x,x,x,x,x,x,x,x]\n" + "\n".join(
        f"{chr(98 + i)}: &{chr(98 + i)} [{','.join(['*' + chr(97 + i)] * 9)}]" for i in range(20)
    )
    merged = "base: &b {class: a, x: 1}\n<<: [*b, *b, *b]\n"
    texts = [
        "{class: mug, instance: red_mug, x: 0.5, y: 0.25, theta: 0.0}",
        "class: mug\ninstance: red_mug\nx: 0.5\ny: .25\ntheta: 1e-7\n",
        "{person_name: Annie, x: 1, y: 2, theta: 3}", "found it", "", "--- {x: 1}\n...\n",
        bomb, bomb[:1900], "&a [*a]", "&a {x: *a}", merged,
        "!!python/object/apply:os.system ['touch /tmp/harm']", "!!python/name:os.system {}",
        "%TAG ! tag:x,2000:\n--- !y 1",
        "[" * 1000, "[" * 60_000, "{" * 60_000, "a" * 60_000, "- " * 1000, "? " * 1000, "a: " * 600,
        "[" + "a," * 990 + "]", "{" + ",".join(f"k{i}: {i}" for i in range(200)) + "}",
        "\n".join(f"k{i}: {i}" for i in range(250)), "x: 1\n" * 390, "'" + "''" * 900 + "'",
        '"' + "\\x41" * 480 + '"', '"' + "\\U0001F916" * 190 + '"', "|\n" + " a\n" * 600, "# \n" * 600, "\n" * 1990,
        "{x: 1e308, y: -1e308, theta: 1e308, class: mug, instance: red_mug}", "x: 0x10\ny: 1_0\ntheta: 1:30",
        "{x: ' 1 ', y: '٣', theta: 1_0, class: a, instance: b}", "{class: \"\\ud800\", instance: b, x: 1}",
        "%YAML 9.9\n--- 1", "\ufeff{x: 1}", "[[[[[" + "[]," * 600, "{a: {a: {a: {" + "a: [], " * 250,
        "? [" * 5 + "a, " * 600,
    ]
    return [text.encode("utf-8", "ignore") for text in texts]


_TOKENS = tuple(token.encode() for token in (
    "[", "]", "{", "}", ",", ": ", "- ", "? ", "&a ", "*a", "!!int ", "!<x> ", "'", '"', "|\n", ">-\n", "\n", "  ", "#",
    "---\n", "...\n", "<<: ", "x: 1", "theta", "class", "instance", "person_name", ".nan", "1e999", "%YAML 1.1\n",
    "\u2028", "\ufeff", "\\ud800", "\t",
))

RESULTS = Target("results", steps, seeds, _TOKENS)
