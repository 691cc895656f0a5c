"""Finds the few troubles of a failure that are needed for it."""

from typing import List, NamedTuple

from .troubles import Trouble
from .world import World, simulate


class Failure(NamedTuple):
    """A seed that fails, with the troubles that this needs."""

    seed: int
    error: Exception
    plan: List[Trouble]
    world: World

    def __str__(self):
        lines = [f"seed {self.seed}: {self.error}", "Troubles that this needs:"]
        lines += [f"  {trouble}" for trouble in self.plan] or ["  none"]
        return "\n".join((*lines, "What happened last:", *self.world.trace.lines[-40:]))


class Difference(Exception):
    """The short way of datagrams makes a difference."""

    name = "the short way"


def failure_of(seed, plan=None):
    """Run a seed, some with the short way of datagrams and without it; returns how it fails; None: it does not."""
    try:
        world = simulate(seed, plan)
        other = world if not world.is_compared else simulate(seed, plan, can_wait=False)
    except Exception as error:
        return Failure(seed, error, error.world.plan, error.world)
    found = None if other is world else _difference(world, other)
    return None if found is None else Failure(seed, Difference(found), world.plan, world)


def _difference(world, other):
    """What is different in two worlds that should be equal; None: nothing."""
    ends = [each.trace.compared for each in (world, other) if each.trace.compared is not None]
    lines = list(zip(world.trace.lines, other.trace.lines))
    for here, there in lines[:min(count for count, _ in ends)] if ends else lines:
        if here != there:
            return f"the short way makes a difference: {here!r} instead of {there!r}"
    for number, (here, there) in enumerate(zip(world.documents, other.documents)):
        if here != there:
            return f"the short way makes a difference in document {number}"
    if len(ends) == 1:
        return None  # the time for which one core did not run was just enough to ask
    for what in () if ends else ("journal", "documents"):
        if getattr(world, what) != getattr(other, what):
            return f"the short way makes a difference in the {what}"
    here, there = [digest for _, digest in ends] or (world.trace.digest, other.trace.digest)
    return None if here == there else "the short way makes a difference in a datagram"


def shortened(failure):
    """Leave out troubles, as long as the same oracle fails."""
    size = max(1, len(failure.plan) // 2)
    while True:
        for begin in range(0, len(failure.plan), size):
            less = failure_of(failure.seed, failure.plan[:begin] + failure.plan[begin + size:])
            if less is not None and _name(less.error) == _name(failure.error):
                failure = less
                break
        else:
            if size == 1:
                return failure
            size //= 2


def _name(error):
    return getattr(error, "name", type(error).__name__)
