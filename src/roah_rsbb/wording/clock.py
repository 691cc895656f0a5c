"""The times of a run as people read them: each figure with its label, and how urgent it is.

Works on anything with the fields of RunClock; ROS is not imported. A figure never changes its meaning under one label.
"""

import enum
from typing import List, NamedTuple, Optional

from roah_rsbb.wording.language import tr, tr_later
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
    goal: Optional[Figure] = None
    pause: str = ""  # says that the run is paused, and why; empty: not paused
    aside: str = ""  # less important details


def clock_of(message, passed_s: float) -> Clock:
    """Returns the times of `message` (RunClock), `passed_s` seconds after it."""
    limit_s = message.limit.to_sec()
    if message.phase == "ended":
        left = max(0.0, message.after_stop.to_sec() - passed_s)
        aside = tr("Time left after the stop: {time}", time=countdown(left)) if left > 0.0 else ""
        return Clock(Figure(tr("Final time of the run"), elapsed(message.elapsed.to_sec())), aside=aside)
    if message.phase != "running":
        goal_s = message.goal_limit.to_sec()
        goal = Figure(tr("Time limit of a goal"), countdown(goal_s)) if goal_s else None
        return Clock(Figure(tr("Time limit of the run"), countdown(limit_s)), goal)
    spent_s = _spent(message.elapsed.to_sec(), message.counting, passed_s)
    goal = None
    if message.goal:
        goal_spent_s = _spent(message.goal_elapsed.to_sec(), message.goal_counting, passed_s)
        goal = _left(tr("Goal: time left"), message.goal_limit.to_sec() - goal_spent_s, message.goal_counting)
    pause = f"{tr(PAUSED)}: {message.paused}" if message.paused else ""
    used = tr("Used: {time} of {limit}", time=countdown(int(spent_s)), limit=countdown(limit_s))
    return Clock(_left(tr("Run: time left"), limit_s - spent_s, message.counting), goal, pause, used)


def lines(clock: Clock) -> List[str]:
    """Returns the times in words, the most important first."""
    figures = [f"{figure.label} {figure.text}" for figure in (clock.main, clock.goal) if figure is not None]
    return [text for text in (clock.pause, *figures, clock.aside) if text]


def _spent(elapsed_s: float, counting: bool, passed_s: float) -> float:
    return elapsed_s + max(0.0, passed_s) if counting else elapsed_s


def _left(label: str, left_s: float, counting: bool) -> Figure:
    hurry = Hurry.NO
    if counting and left_s <= SOON_S:
        hurry = Hurry.LAST if left_s <= LAST_S else Hurry.SOON
    return Figure(label, countdown(max(0.0, left_s)), hurry)
