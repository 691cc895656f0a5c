"""The times of a run as people read them: each figure with its label, and how urgent it is.

Works on anything with the fields of RunClock; ROS is not imported. A figure never changes its meaning under one label.
"""

import enum
from typing import Any, List, NamedTuple, Optional

from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.said import tr_said
from roah_rsbb.wording.times import countdown, elapsed

SOON_S = 30.0
LAST_S = 10.0
PAUSED = tr_later("PAUSED")


class Hurry(enum.IntEnum):
    """How soon a time is up."""

    NO = 0
    SOON = 1  # in the last 30 s
    LAST = 2  # in the last 10 s


class Figure(NamedTuple):
    """A time with its label."""

    label: str
    text: str
    hurry: Hurry = Hurry.NO


class Clock(NamedTuple):
    """The times of a run, in words."""

    main: Figure  # of the run
    goal: Optional[Figure] = None  # of the robot's goal, or of the task's phase
    pause: str = ""  # says that the run is paused, and why; empty: not paused
    aside: str = ""  # less important details


def clock_of(message: Any, passed_s: float) -> Clock:
    """Return the times of `message` (RunClock), `passed_s` seconds after it."""
    limit_s = message.limit.to_sec()
    if message.phase == "ended":
        left = max(0.0, message.after_stop.to_sec() - passed_s)
        aside = tr("Time left after the stop: {time}", time=countdown(left)) if left > 0.0 else ""
        return Clock(Figure(tr("Final time of the run"), elapsed(message.elapsed.to_sec())), aside=aside)
    if message.phase != "running":
        goal_s = message.goal_limit.to_sec()
        goal = Figure(tr("Time limit of a goal"), countdown(goal_s)) if goal_s else None
        limit = Figure(tr("Time limit of the run"), countdown(limit_s) if limit_s else tr("no limit"))
        return Clock(_setup(message, passed_s), limit) if message.setup_counting else Clock(limit, goal)
    spent_s = _spent(message.elapsed.to_sec(), message.counting, passed_s)
    goal = None
    if message.goal:
        goal_spent_s = _spent(message.goal_elapsed.to_sec(), message.goal_counting, passed_s)
        goal = _left(tr("Goal: time left"), message.goal_limit.to_sec() - goal_spent_s, message.goal_counting)
    elif message.phase_number:
        goal = _phase(message, passed_s)
    pause = f"{tr(PAUSED)}: {tr_said(message.paused)}" if message.paused else ""
    if not limit_s:
        return Clock(Figure(tr("Run: time used"), countdown(int(spent_s))), goal, pause)
    used = tr("Used: {time} of {limit}", time=countdown(int(spent_s)), limit=countdown(limit_s))
    return Clock(_left(tr("Run: time left"), limit_s - spent_s, message.counting), goal, pause, used)


def lines(clock: Clock) -> List[str]:
    """Return the times in words, the most important first."""
    figures = [f"{figure.label} {figure.text}" for figure in (clock.main, clock.goal) if figure is not None]
    return [text for text in (clock.pause, *figures, clock.aside) if text]


def _setup(message: Any, passed_s: float) -> Figure:
    left_s = message.setup_limit.to_sec() - _spent(message.setup_elapsed.to_sec(), True, passed_s)
    if left_s > 0.0:
        return _left(tr("Setup: time left"), left_s, True)
    return Figure(tr("Setup: over by"), countdown(int(-left_s)), Hurry.LAST)


def _phase(message: Any, passed_s: float) -> Figure:
    """Return the time of the current phase of a task."""
    name = tr("Phase {number} of {count}, {name}", number=message.phase_number, count=message.phases,
              name=message.phase_name)
    spent_s = _spent(message.phase_elapsed.to_sec(), message.counting, passed_s)
    limit_s = message.phase_limit.to_sec()
    if not limit_s:
        return Figure(tr("{phase}: time used", phase=name), countdown(int(spent_s)))
    if spent_s < limit_s:
        return _left(tr("{phase}: time left", phase=name), limit_s - spent_s, message.counting)
    return Figure(tr("{phase}: over by", phase=name), countdown(int(spent_s - limit_s)), Hurry.LAST)


def _spent(elapsed_s: float, counting: bool, passed_s: float) -> float:
    return elapsed_s + max(0.0, passed_s) if counting else elapsed_s


def _left(label: str, left_s: float, counting: bool) -> Figure:
    hurry = Hurry.NO
    if counting and left_s <= SOON_S:
        hurry = Hurry.LAST if left_s <= LAST_S else Hurry.SOON
    return Figure(label, countdown(max(0.0, left_s)), hurry)
