"""The texts that explain a run to spectators (docs/web.md, "Displays")."""

from typing import List, NamedTuple, Tuple

from roah_rsbb.model.document import PublicRun, RobotText
from roah_rsbb.wording.language import tr, tr_later

DONE, NOW, LATER = "done", "now", "later"
_ENGLISH = "en"
_PREPARES, _EXECUTES = tr_later("The robot prepares"), tr_later("The robot carries out its task")
_REFEREE = tr_later("The referee is at work")
_GOAL, _WAYPOINT = tr_later("The robot carries out the goal"), tr_later("The robot drives to the waypoint")
_ORDER = {"waiting": 0, "referee": 1, "between": 1, "preparing": 2, "executing": 3, "ended": 4}
_SAID = {
    "notifications": tr_later("Robot: {words}"), "activation_event": tr_later("Event: {words}"),
    "visitor": tr_later("Visitor: {words}"), "final_command": tr_later("Command: {words}"),
}


class ShownStep(NamedTuple):
    """A step of a run."""

    text: str
    state: str  # done, now or later


class ExplainedTexts(NamedTuple):
    """The texts of a run."""

    about: str  # may be empty
    steps: Tuple[ShownStep, ...]
    now: str  # one sentence
    progress: str  # may be empty
    said: Tuple[str, ...]  # the newest last


def explained(run: PublicRun, language: str) -> ExplainedTexts:
    """Return the texts of a run."""
    return ExplainedTexts(
        _about(run, language), tuple(_steps(run)), _now(run), _progress(run), tuple(map(_said, run.said)))


def _about(run: PublicRun, language: str) -> str:
    """The text in a language. If that is missing, the English one, or else the first one."""
    for name in (language, language.partition("_")[0], _ENGLISH):
        if name in run.about:
            return run.about[name]
    return next(iter(run.about.values()), "")


def _steps(run: PublicRun) -> List[ShownStep]:
    """The phases of a task or, without them, what happens in every run. Goals repeat, so their
    steps are never done while the run continues."""
    if run.phases:
        is_over = run.doing == "ended"
        present = run.phase_number
        return [ShownStep(name, DONE if is_over or number < present else NOW if number == present else LATER)
                for number, name in enumerate(run.phases, 1)]
    if run.doing == "by_hand":
        return []
    now = _ORDER[run.doing]
    if run.kind == "functionality":
        texts = [(1, _REFEREE), (2, _PREPARES), (3, _WAYPOINT if run.are_waypoints else _GOAL)]
        return [ShownStep(tr(text), DONE if now == _ORDER["ended"] else NOW if number == now else LATER)
                for number, text in texts]
    return [ShownStep(tr(text), DONE if number < now else NOW if number == now else LATER)
            for number, text in ((2, _PREPARES), (3, _EXECUTES))]


def _now(run: PublicRun) -> str:
    if run.doing == "executing" and run.kind == "functionality":
        if run.are_waypoints:
            return tr("The robot drives to waypoint {number}", number=run.goals)
        return tr("The robot carries out goal {number}", number=run.goals)
    if run.doing == "executing" and run.kind == "all robots":
        return tr("All robots carry out the task at the same time")
    return {
        "waiting": tr("The robot waits for the start"), "preparing": tr(_PREPARES), "executing": tr(_EXECUTES),
        "referee": tr(_REFEREE), "between": tr("The next goal follows"),
        "by_hand": tr("The referee starts and stops the clock"), "ended": tr("The run is over"),
    }[run.doing]


def _progress(run: PublicRun) -> str:
    if not run.goals_ended:
        return ""
    if run.goals_completed is None:
        return tr("Waypoints done: {number}", number=run.goals_ended) if run.are_waypoints else tr(
            "Goals done: {number}", number=run.goals_ended)
    if run.are_waypoints:
        return tr("Waypoints reached: {number} of {all}", number=run.goals_completed, all=run.goals_ended)
    return tr("Goals completed: {number} of {all}", number=run.goals_completed, all=run.goals_ended)


def _said(one: RobotText) -> str:
    text = tr(_SAID.get(one.kind, _SAID["notifications"]), words=one.text)
    return f"{one.robot}: {text}" if one.robot else text
