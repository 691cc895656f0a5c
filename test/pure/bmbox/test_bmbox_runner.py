"""The runner: requests out, outcomes in, and back to where it was after a restart."""

import math

import pytest

from helpers.forms import ODD, ODD_ASKED, ODD_VALUES, form
from roah_rsbb.bmbox.framework.ground_truth import Pose2D, Pose3
from roah_rsbb.bmbox.framework.module import Disconnected, Module, RunEnded, RunTimedOut, Stopped
from roah_rsbb.bmbox.framework.rehearsal import Poses, Rehearsal
from roah_rsbb.bmbox.framework.runner import ModuleRunner
from roah_rsbb.bmbox.framework.score import Value
from roah_rsbb.bmbox.stb import STB
from roah_rsbb.model.fields import BadValue
from roah_rsbb.model.modules import OutcomeKind, Request, RequestKind, RequestOutcome, RunForModule, Step
from roah_rsbb.model.scoring import ScoreGroup, ScoreKind, ScoringItem
from roah_rsbb.rulebook.errors import ConfigError, ConfigErrors

DONE = RequestOutcome(OutcomeKind.DONE)


class Odd(Module):
    CODE = "ODD"

    async def execute(self):
        self.kept = await self.ask(ODD_ASKED, *ODD)
        self.kept["more"] = await self.referee("Who?", ("Annie", "Tom"), asks_text=True)


def test_a_form_of_any_fields():
    r = Rehearsal(Odd)
    assert (r.asked.text, r.asked.fields) == (ODD_ASKED, ODD)
    with pytest.raises(BadValue, match="Pose of the cup is missing"):
        r.answer(held=True, drops=2)
    r.answer(**ODD_VALUES)
    pose = pytest.approx([1.25, 0.4, math.pi / 2])
    assert r.module.kept == {"held": True, "drops": 2, "place": "floor", "pose": pose}
    r.restart()
    r.answer(text="Bob")
    assert (r.finished, r.module.kept["more"]) == (True, "Bob")


class Story(Module):
    """Uses some of everything, and records the answers."""

    CODE = "X"
    SCORES = {"said": Value("Said"), "drawn": Value("Drawn"), "end": Value("How it ended"), "looks": Value("Looks")}

    async def execute(self):
        try:
            self.score["said"] = await self.referee("first", ("yes", "no"))
            self.score["drawn"] = self.random.randrange(1000)
            self.kept = {"looks": 0}
            outcome = await self.goal({"draw": self.score["drawn"]}, timeout=10.0, watch=self.look, every=0.5)
            self.score["said"] = outcome.result
            self.score["looks"] = self.kept["looks"]
            pose = await self.pose("thing", may_skip=True)
            await self.goal(pose=None if pose is None else Pose2D(pose.x, pose.y, pose.theta))
        except RunEnded as ended:
            self.score["end"] = f"{type(ended).__name__} {ended}"
            raise
        self.score["end"] = "through"

    def look(self, seconds):
        self.kept["looks"] += 1
        self.kept["last"] = seconds


def story(**kwargs):
    return Rehearsal(Story, truth=Poses(thing=Pose3(1.0, 2.0, 0.5, 0.25)), **kwargs)


def test_a_whole_story():
    r = story()
    assert r.asked == Request(1, RequestKind.REFEREE, "first", form("yes", "no"))
    r.answer("no")
    assert r.score["said"] == "no"
    assert (r.asked.number, r.asked.kind, r.asked.timeout) == (2, RequestKind.GOAL, 10.0)
    assert r.asked.goal == f"{{draw: {r.score['drawn']}}}"
    r.result("seen", 3.0)
    assert r.asked.number == 5, "3 is what was gathered, 4 the pose"
    assert (r.asked.goal, r.asked.pose) == ("[1.0, 2.0, 0.25]", (1.0, 2.0, 0.25))
    r.result()
    assert (r.finished, r.failed, r.asked, r.score["end"]) == (True, "", None, "through")


@pytest.mark.parametrize("reason, ended", [
    ("stopped", "Stopped stopped"), ("timeout", "RunTimedOut timeout"),
    ("no_messages_saved", "Stopped no_messages_saved"),
])
@pytest.mark.parametrize("steps", range(4))
def test_a_run_that_ends_raises_wherever_the_module_waits(reason, ended, steps):
    r = story()
    for act in (r.answer, r.result, lambda: None)[:steps]:
        act()
    r.end(reason)
    assert (r.score["end"], r.finished, r.failed) == (ended, False, "")


def test_a_run_that_is_left():
    r = story()
    r.runner.close()
    assert r.score["end"] == "Disconnected the run was left"
    assert issubclass(Disconnected, RunEnded) and issubclass(RunTimedOut, RunEnded) and issubclass(Stopped, RunEnded)
    assert not issubclass(RunEnded, Exception)


def test_repeated_or_late_messages_do_nothing():
    r = story()
    first = r.run
    r.answer("no")
    r.result("seen")
    now = r.runner.progress()
    for run in (first, r.run, r.run, first._replace(attempt=0), first._replace(attempt=0, running=False)):
        r.runner.on_run(run)
        assert r.runner.progress() == now


def test_a_run_that_was_not_started_does_nothing_until_it_is():
    runner = ModuleRunner(Story, lambda: None, Poses())
    waiting = RunForModule("r", 0, "zone", "X", "Team", 1, 1, running=False)
    runner.on_run(waiting)
    assert runner.progress() is None
    runner.on_run(waiting._replace(attempt=1, running=True))
    assert runner.progress().request.number == 1


def test_a_new_attempt_starts_from_the_beginning():
    r = story()
    r.answer("no")
    r.result("seen")
    r.end()
    runner = r.runner
    runner.on_run(r.run._replace(attempt=2, running=True, end_reason="", steps=()))
    progress = runner.progress()
    assert (progress.attempt, progress.request.number, progress.kept) == (2, 1, "")
    assert [value.value for value in progress.scores] == ["null"] * 4


def test_a_new_attempt_without_an_end_of_the_old_one_ends_that():
    r = story()
    ended = r.module
    r.runner.on_run(r.run._replace(attempt=2, steps=()))
    assert ended.score["end"] == "Stopped restarted"
    assert r.runner.progress().attempt == 2


def test_each_attempt_draws_again_and_a_restart_draws_the_same():
    draws = set()
    for attempt in range(1, 6):
        r = Rehearsal(Story)
        r.runner = r._runner()
        r.run = r.run._replace(attempt=attempt, steps=(Step(r.run.steps[0].request, DONE),))
        r.runner.on_run(r.run)
        again = ModuleRunner(Story, lambda: None, Poses())
        again.on_run(r.run)
        assert again.module.score["drawn"] == r.score["drawn"]
        draws.add(r.score["drawn"])
    assert len(draws) > 1


# -- restarts -----------------------------------------------------------------------------------------

def acts(r):
    def goal():
        r.executes(2.0)
        r.result("seen", 3.0)

    return [lambda: r.answer("no"), goal, lambda: r.answer("Skip"), r.result]


@pytest.mark.parametrize("restarts", range(16))
def test_restarts_anywhere_lead_to_the_same_score(restarts):
    truth = Poses()
    plain, shaken = Rehearsal(Story, truth=truth), Rehearsal(Story, truth=truth)
    for number, (act, same) in enumerate(zip(acts(plain), acts(shaken))):
        if restarts >> number & 1:
            shaken.restart()
        act()
        same()
        assert shaken.asked == plain.asked
    assert plain.finished and shaken.finished
    assert shaken.score.values() == plain.score.values()


def test_a_pose_is_the_one_measured_at_that_time():
    r = story()
    r.answer()
    r.result("seen")
    r.truth.subjects["thing"] = Pose3(9.0, 9.0, 9.0, 0.9)
    r.restart()
    assert (r.failed, r.asked.pose) == ("", (1.0, 2.0, 0.25))


def test_a_module_that_crashed_while_it_measured_measures_again():
    r = story()
    r.answer()
    r.result("seen")
    steps = r.run.steps[:3]
    r.truth.subjects["thing"] = None
    r.run = r.run._replace(steps=steps)
    r.restart()
    assert r.asked.text.startswith("The pose of thing is not available. Solve the problem")


def test_what_a_watch_gathered_survives():
    r = story()
    r.answer()
    r.executes(2.0)
    assert r.module.kept["looks"] == 4
    r.restart()
    assert r.module.kept["looks"] == 4
    r.executes(1.0)
    r.result()
    assert r.score["looks"] == 6


def test_samples_of_a_goal_are_known_after_it():
    r = story()
    r.answer()
    r.executes(2.0)
    r.result()
    r.restart()
    assert r.score["looks"] == 4


def test_a_module_that_crashed_just_after_a_goal_has_what_was_gathered():
    r = story()
    r.answer()
    r.executes(2.0)
    r.result()
    r.run = r.run._replace(steps=r.run.steps[:2])
    r.restart()
    assert r.score["looks"] == 4


def test_changed_rules_cannot_continue():
    r = story()
    r.answer("no")
    other = r.run.steps[0].request._replace(text="another")
    r.run = r.run._replace(steps=(r.run.steps[0]._replace(request=other), *r.run.steps[1:]))
    r.restart()
    assert r.failed == (
        "its rules or parameters changed during the run: step 1 was referee 'another', "
        "now it is referee 'first'"
    )
    assert not r.finished


def test_changed_goals_of_the_same_name_are_named_with_their_places():
    r = story()
    r.answer("no")
    r.executes(1.0)
    step = next(step for step in r.run.steps if step.request.kind is RequestKind.GOAL)
    moved = step.request._replace(text="Waypoint", goal="[1, 2, 3]")
    r.run = r.run._replace(steps=tuple(step._replace(request=moved) if each is step else each for each in r.run.steps))
    r.restart()
    assert "goal 'Waypoint' [1, 2, 3], now it is goal" in r.failed


# -- watching -----------------------------------------------------------------------------------------

def test_a_watch_looks_only_while_the_robot_executes():
    r = story()
    r.runner.tick(r.utc)
    r.answer()
    r.runner.tick(r.utc)
    assert not r.runner.watching()
    assert r.module.kept["looks"] == 0
    r.executes(1.05, step=0.05)
    assert r.runner.watching()
    assert r.module.kept["looks"] == 3
    assert r.module.kept["last"] == pytest.approx(1.0)
    r.result()
    r.runner.tick(r.utc + 10.0)
    assert r.module.kept["looks"] == 3


def test_a_clock_that_is_set_back_does_not_stop_the_watch():
    r = story()
    r.answer()
    r.executes(5.0)
    looks = r.module.kept["looks"]
    r.utc -= 3.0
    r.executes(1.0)
    assert r.module.kept["looks"] >= looks + 2


# -- what goes wrong ------------------------------------------------------------------------------------

class Faulty(Module):
    CODE = "F"
    SCORES = {"a": Value("A")}

    async def execute(self):
        self.score["a"] = 1
        how = await self.referee("how", asks_text=True)
        if how == "raise":
            raise ValueError("no such thing")
        if how == "look":
            await self.goal(watch=lambda seconds: 1 / 0)
        if how == "note":
            await self.note(lambda: object())
        if how == "end":
            raise Stopped("by itself")
        if how == "other":
            await _Other()


class _Other:
    def __await__(self):
        yield "something else"


@pytest.mark.parametrize("how, failed", [
    ("raise", "ValueError: no such thing"), ("look", "ZeroDivisionError: division by zero"),
    ("note", "TypeError: Object of type object is not JSON serializable"), ("end", "it raised"),
    ("other", "AttributeError: "),
])
def test_a_module_that_fails_says_why_and_keeps_its_score(how, failed):
    r = Rehearsal(Faulty)
    r.answer(how)
    if how == "look":
        r.executes(0.1)
    assert r.failed.startswith(failed)
    assert (r.finished, r.score["a"]) == (False, 1)
    assert ("Traceback" in r.runner.traceback) == (how != "end")
    r.end()


def test_parameters_that_cannot_be_read():
    def load():
        raise ConfigErrors([ConfigError("F.yaml", 3, 1, "x", "y"), ConfigError("F.yaml", 4, 1, "z", "w")])

    runner = ModuleRunner(Faulty, load, Poses())
    runner.on_run(RunForModule("r", 1, "zone", "F", "Team", 1, 1, running=True))
    assert runner.progress().failed == "F.yaml:3: found x; expected y; F.yaml:4: found z; expected w"


class Stubborn(Module):
    CODE = "S"

    async def execute(self):
        while True:
            try:
                await self.referee("more")
            except RunEnded:
                await self.referee("never mind")


def test_a_module_that_does_not_want_to_end_is_ended():
    r = Rehearsal(Stubborn)
    r.end()
    assert not r.runner.watching()
    assert r.asked is not None, "what it asks for now reaches nobody"
    assert len(r.run.steps) == 1


class Cleaning(Module):
    CODE = "C"
    SCORES = {"clean": Value("Clean")}

    async def execute(self):
        try:
            await self.goal()
        finally:
            self.score["clean"] = True


def test_finally_is_run_and_scored():
    r = Rehearsal(Cleaning)
    r.end("timeout")
    assert r.score["clean"] is True
    assert r.runner.progress().scores[0].value == "true"


def test_the_referees_scores_can_be_read_as_they_are_now():
    item = ScoringItem("Penalized", "bumps", ScoreKind.UINT)
    r = story(sheet=(ScoreGroup("Penalized", ((item, 2),)),))
    assert r.module.referee_score("Penalized", "bumps") == 2
    r.run = r.run._replace(sheet=(ScoreGroup("Penalized", ((item, 5),)),))
    r.runner.on_run(r.run)
    assert r.module.referee_score("Penalized", "bumps") == 5
    with pytest.raises(KeyError, match="no scoring item 'hits'"):
        r.module.referee_score("Penalized", "hits")


def test_an_unreadable_result_is_ignored_and_the_referee_is_warned_once():
    r = story()
    outcome = type("O", (), {"timed_out": False, "result": "[1"})()
    for _ in range(2):
        assert r.module.record(outcome, {"x": float}) is None
    assert len(r.runner.progress().warnings) == 1
    outcome.timed_out = True
    assert r.module.record(outcome, {"x": float}) is None
    assert len(r.runner.progress().warnings) == 1


def test_numbers_of_requests_are_the_core_s():
    """A request of the core's that has no place here (another kind of step) is a change of the rules."""
    r = story()
    note = Request(1, RequestKind.NOTE, note="1")
    r.run = r.run._replace(steps=(Step(note, DONE),))
    r.restart()
    assert "changed during the run" in r.failed


@pytest.mark.parametrize("parameters, timeout", [
    ({}, 30.0), ({"goal_timeout": None}, 30.0), ({"goal_timeout": 15.0}, 15.0),
])
def test_a_goal_ends_by_the_benchmarks_file_unless_the_parameters_say_otherwise(parameters, timeout):
    r = Rehearsal(STB, {"goals": ["A"], **parameters}, goal_timeout=30.0)
    r.answer()
    assert r.asked.timeout == timeout
