"""The sums of a score sheet as people read them: in lists of runs, on the public display."""

from typing import Iterable, NamedTuple, Sequence


class Group(NamedTuple):
    """A group of scoring items; `not_attempted`: how many of them the robot did not try."""

    name: str
    values: Sequence[int]
    not_attempted: int


def sums_text(groups: Iterable[Group]) -> str:
    """Such as "Achievements 5 (1 not attempted) · Penalized 2"; a yes counts 1, groups without items do not count."""
    return " · ".join(_sum(group) for group in groups if group.values)


def _sum(group: Group) -> str:
    mark = f" ({group.not_attempted} not attempted)" if group.not_attempted else ""
    return f"{group.name} {sum(group.values)}{mark}"
