"""The facts of a run that the report counts. They take little memory, so that the runs themselves need not be kept."""

from typing import Dict, Iterable, List, NamedTuple, Optional, Tuple

from roah_rsbb.model.records import RunRecord
from roah_rsbb.results.goals import goals
from roah_rsbb.results.runs import RunResult
from roah_rsbb.wording.sheets import is_marked

Key = Tuple[str, str]  # group and name of an item


class ItemFacts(NamedTuple):
    """An item of the sheet of a run."""

    achieved: bool
    not_attempted: bool
    after_s: Optional[float]  # from the start to its first mark; None: not marked during the run


class GoalFacts(NamedTuple):
    """A goal of a run."""

    number: int
    seconds: Optional[float]  # None: the robot did not end it


class LinkFacts(NamedTuple):
    """The link of a team within a period."""

    received: int = 0
    lost: int = 0
    longest_gap_s: float = 0.0
    latest_s: float = 0.0  # the latest message was this late
    seconds: float = 0.0

    def plus(self, other: "LinkFacts") -> "LinkFacts":
        """Return the link of both times together."""
        return LinkFacts(
            self.received + other.received, self.lost + other.lost, max(self.longest_gap_s, other.longest_gap_s),
            max(self.latest_s, other.latest_s), self.seconds + other.seconds)

    @property
    def lost_share(self) -> Optional[float]:
        """The share of the messages that were lost on the way to the box; None: none was due."""
        due = self.received + self.lost
        return self.lost / due if due else None


class RunFacts(NamedTuple):
    """A run in the report."""

    number: int
    record: RunRecord  # without the parts that take most memory
    items: Dict[Key, ItemFacts]
    goals: Tuple[GoalFacts, ...]
    link: Dict[Tuple[str, float], LinkFacts]  # by team and period (UTC seconds of its beginning)
    warnings: int
    counts: str = ""  # see `RunResult`

    @property
    def is_over(self) -> bool:
        """Whether it was started and has ended."""
        return bool(self.record.started_utc and self.record.end_reason)

    @property
    def delay_s(self) -> Optional[float]:
        """Seconds from the scheduled time to the start; None: never started, or not scheduled."""
        record = self.record
        return record.started_utc - record.scheduled if record.started_utc and record.scheduled else None


# Lengths of a period of the links. The shortest one is used that divides a competition into at most so many.
LINK_PERIODS_S = (60, 300, 600, 1800, 3600)
MOST_PERIODS = 12


def link_period_s(records: Iterable[RunRecord], as_of_utc: float) -> int:
    """Return the length of a period of the links, in seconds. `as_of_utc`: the last moment in the journal."""
    times = [utc for record in records for utc in (record.opened_utc, record.closed_utc or as_of_utc)]
    length = max(times) - min(times) if times else 0.0
    return next((period for period in LINK_PERIODS_S if length <= MOST_PERIODS * period), LINK_PERIODS_S[-1])


def facts_of(result: RunResult, warnings: int, link_period: int = LINK_PERIODS_S[-1]) -> RunFacts:
    """Return the facts of a run. `warnings`: how many of its events are bad. `link_period`: in seconds."""
    record = result.record
    return RunFacts(
        result.number, record._replace(history=(), form=None), _items(record),
        tuple(GoalFacts(goal.number, goal.seconds) for goal in goals(result)),
        _link(result, link_period), warnings, result.counts,
    )


def _items(record: RunRecord) -> Dict[Key, ItemFacts]:
    first: Dict[Key, float] = {}
    for entry in record.history:
        after = entry.utc - record.started_utc
        if not entry.withdrawn_utc and not entry.correction and is_marked(entry.value, entry.text) and after >= 0:
            first.setdefault((entry.group, entry.desc), after)
    return {
        item.key: ItemFacts(is_marked(item.value, item.text), item.not_attempted, first.get(item.key))
        for item in record.items
    }


def _link(result: RunResult, period: int) -> Dict[Tuple[str, float], LinkFacts]:
    found: Dict[Tuple[str, float], LinkFacts] = {}
    for robot in result.robots:
        by_period: Dict[int, List] = {}
        for second in robot.link:
            by_period.setdefault(int(second.utc // period), []).append(second.sample)
        for number, samples in by_period.items():
            key = robot.team, float(number * period)
            found[key] = found.get(key, LinkFacts()).plus(LinkFacts(
                sum(s.received for s in samples), sum(s.lost for s in samples), max(s.gap_s for s in samples),
                max(s.late_s for s in samples), sum(s.seconds for s in samples)))
    return found
