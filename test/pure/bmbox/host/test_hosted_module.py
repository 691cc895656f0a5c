"""A run's module in its host: nothing that it does gets out, and nothing is lost."""

import sys
from types import SimpleNamespace

import pytest

from roah_rsbb.bmbox.framework.ground_truth import GroundTruth
from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.score import Value
from roah_rsbb.bmbox.host.host import HostedModule
from roah_rsbb.bmbox.host.limits import MAX_TEXT
from roah_rsbb.model.modules import OutcomeKind, RequestOutcome, RunForModule, Step
from roah_rsbb.rulebook.errors import Report
from roah_rsbb.rulebook.yaml_lines import Place

RUN = RunForModule("TEST-1", 1, "Home", "TEST", "Alpha", 1, 1, running=True)


class Rules(Module):
    """Asks the referee, does `WRONG` with itself, asks again."""

    CODE = ""
    SCORES = {"done": Value("Done")}
    WRONG = staticmethod(lambda module: None)

    async def execute(self):
        self.score["done"] = 1
        await self.referee("First")
        self.WRONG(self)
        await self.referee("Second")


def hosted(wrong=lambda module: None, load=SimpleNamespace):
    reported = []
    kind = type("Wrong", (Rules,), {"WRONG": staticmethod(wrong)})
    return HostedModule(kind, load, GroundTruth(), reported.append), reported


def answered(module, run=RUN):
    """The run once the referee did the first thing."""
    step = Step(module.progress().request, RequestOutcome(OutcomeKind.DONE))
    return run._replace(steps=(step,))


def _exit(_module):
    sys.exit("enough")


def _raise(_module):
    raise RuntimeError("no rule")


def _keep(module):
    module.kept = {"no JSON": object()}


def _status(module):
    module.status = 7


def test_a_module_that_works():
    module, reported = hosted()
    assert module.progress() is None
    module.on_run(RUN)
    assert module.progress().request.text == "First"
    module.on_run(answered(module))
    progress = module.progress()
    assert (progress.request.text, progress.failed, progress.scores[0].value) == ("Second", "", "1")
    module.close()
    assert reported == []


@pytest.mark.parametrize(("wrong", "reason"), [
    (_raise, "RuntimeError: no rule"), (_exit, "SystemExit: enough"), (_keep, "TypeError"), (_status, "TypeError"),
])
def test_every_error_ends_this_run_with_its_score(wrong, reason):
    module, reported = hosted(wrong)
    module.on_run(RUN)
    module.on_run(answered(module))
    progress = module.progress()
    assert reason in progress.failed
    assert (progress.run, progress.attempt, progress.finished) == ("TEST-1", 1, False)
    assert [score.value for score in progress.scores] == ["1"]
    assert len(reported) == 1
    assert reported[0].startswith("TEST in zone Home: Traceback")
    assert reason in reported[0]
    module.on_run(answered(module)._replace(running=False, end_reason="module_failed"))
    module.tick(5.0)
    assert not module.watching()
    assert module.progress() == progress
    module.close()
    assert len(reported) == 1, "it is reported once"


def test_texts_are_limited_before_they_are_sent():
    def write(module):
        module.status = "\ud800" + "x" * 5000

    module, _ = hosted(write)
    module.on_run(RUN)
    module.on_run(answered(module))
    progress = module.progress()
    assert (progress.failed, progress.status) == ("", "?" + "x" * (MAX_TEXT - 2) + "…")


def test_the_text_of_an_error_is_limited_before_it_is_sent():
    def load():
        raise KeyboardInterrupt("\ud800" + "x" * 5000)

    module, _ = hosted(load=load)
    module.on_run(RUN)
    failed = module.progress().failed
    assert failed.startswith("KeyboardInterrupt: ?x") and len(failed) == MAX_TEXT


@pytest.mark.parametrize("wrong", [_raise, _exit, _keep, _status])
def test_another_start_is_another_chance(wrong):
    module, _ = hosted(wrong)
    module.on_run(RUN)
    module.on_run(answered(module))
    assert module.progress().failed
    module.on_run(RUN._replace(attempt=2))
    progress = module.progress()
    assert (progress.attempt, progress.failed, progress.request.text) == (2, "", "First")


def test_parameters_that_cannot_be_read_are_the_reason():
    def load():
        report = Report()
        report.error(Place("TEST.yaml", 7, 1), "x", "y")
        report.raise_errors()

    module, reported = hosted(load=load)
    module.on_run(RUN)
    assert module.progress().failed == "TEST.yaml:7: found x; expected y"
    assert reported == []
