"""The times of a run as people read them: each figure with its label, and how urgent it is.

A figure never changes its meaning under one label.
"""

import enum
from typing import List, NamedTuple, Optional

from roah_rsbb.model.zone import ENDED, RUNNING, RunClock
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


def clock_of(clock: RunClock, phase: str, mono: float) -> Clock:
    """Return the times of a run in this phase at a moment of the box's clock."""
    if phase == ENDED:
        left = clock.after_stop(mono)
        aside = tr("Time left after the stop: {time}", time=countdown(left)) if left > 0.0 else ""
        return Clock(Figure(tr("Final time of the run"), elapsed(clock.spent(mono))), aside=aside)
    if phase != RUNNING:
        goal = Figure(tr("Time limit of a goal"), countdown(clock.goal_limit)) if clock.goal_limit else None
        limit = Figure(tr("Time limit of the run"), countdown(clock.limit) if clock.limit else tr("no limit"))
        return Clock(_setup(clock, mono), limit) if clock.setup_elapsed.counting else Clock(limit, goal)
    goal = None
    if clock.goal:
        goal = _left(tr("Goal: time left"), clock.goal_limit - clock.goal_spent(mono), clock.goal_elapsed.counting)
    elif clock.phase_number:
        goal = _phase(clock, mono)
    pause = f"{tr(PAUSED)}: {tr_said(clock.paused)}" if clock.paused else ""
    spent_s = clock.spent(mono)
    if not clock.limit:
        return Clock(Figure(tr("Run: time used"), countdown(int(spent_s))), goal, pause)
    used = tr("Used: {time} of {limit}", time=countdown(int(spent_s)), limit=countdown(clock.limit))
    return Clock(_left(tr("Run: time left"), clock.limit - spent_s, clock.elapsed.counting), goal, pause, used)


def lines(clock: Clock) -> List[str]:
    """Return the times in words, the most important first."""
    figures = [f"{figure.label} {figure.text}" for figure in (clock.main, clock.goal) if figure is not None]
    return [text for text in (clock.pause, *figures, clock.aside) if text]


def _setup(clock: RunClock, mono: float) -> Figure:
    left_s = clock.setup_limit - clock.setup_elapsed.at(mono)
    if left_s > 0.0:
        return _left(tr("Setup: time left"), left_s, True)
    return Figure(tr("Setup: over by"), countdown(int(-left_s)), Hurry.LAST)


def _phase(clock: RunClock, mono: float) -> Figure:
    """Return the time of the current phase of a task."""
    name = tr("Phase {number} of {count}, {name}", number=clock.phase_number, count=clock.phases,
              name=clock.phase_name)
    spent_s, limit_s = clock.phase_elapsed.at(mono), clock.phase_limit
    if not limit_s:
        return Figure(tr("{phase}: time used", phase=name), countdown(int(spent_s)))
    if spent_s < limit_s:
        return _left(tr("{phase}: time left", phase=name), limit_s - spent_s, clock.elapsed.counting)
    return Figure(tr("{phase}: over by", phase=name), countdown(int(spent_s - limit_s)), Hurry.LAST)


def _left(label: str, left_s: float, counting: bool) -> Figure:
    hurry = Hurry.NO
    if counting and left_s <= SOON_S:
        hurry = Hurry.LAST if left_s <= LAST_S else Hurry.SOON
    return Figure(label, countdown(max(0.0, left_s)), hurry)
