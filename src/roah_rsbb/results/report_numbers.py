"""What the report counts: items, phases, goals, ends, delays and links, over the runs of a competition.

The facts of a run take little memory, so that the runs themselves need not be kept.
"""

import statistics
from typing import Callable, Dict, Hashable, Iterable, List, NamedTuple, Optional, Sequence, Tuple, TypeVar

from roah_rsbb.model.records import RunRecord
from roah_rsbb.results.events import goals, sections
from roah_rsbb.results.runs import RunResult
from roah_rsbb.rulebook.registry import in_order
from roah_rsbb.scoring.counting import attempts_of
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


def facts_of(result: RunResult, link_period: int = LINK_PERIODS_S[-1]) -> RunFacts:
    """Return the facts of a run. `link_period`: in seconds."""
    record = result.record
    warnings = sum(event.bad for section in sections(result) for event in section.events)
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


# -- over the runs of a competition -----------------------------------------------------------------


Place = TypeVar("Place", bound=Hashable)


class Spread(NamedTuple):
    """Numbers in short; None: there are none."""

    count: int
    least: Optional[float]
    median: Optional[float]
    most: Optional[float]


class ItemLine(NamedTuple):
    """How often an item was achieved."""

    benchmark: str
    group: str
    name: str
    runs: int  # that had the item on their sheet and are over
    achieved: int
    not_attempted: int
    after_s: Spread  # from the start to its first mark

    @property
    def share(self) -> float:
        """The share of the runs in which it was achieved."""
        return self.achieved / self.runs if self.runs else 0.0


class TimeLine(NamedTuple):
    """How long a phase or a goal took."""

    benchmark: str
    name: str
    runs: int  # that had it
    seconds: Spread  # of those that ended it


class EndLine(NamedTuple):
    """How the runs of a benchmark ended."""

    benchmark: str
    runs: int  # that were connected
    ends: Dict[str, int]  # by the name of the reason; empty: never started, or not over
    restarts: int
    repeated: int  # further attempts at the same event


class DelayLine(NamedTuple):
    """How late the runs of a zone started."""

    zone: str
    delays_s: Spread
    late: int  # more than `LATE_S`


# A start within this time (s) is not late.
LATE_S = 300.0


def spread(numbers: Iterable[Optional[float]]) -> Spread:
    """Return the numbers in short, without those that are missing."""
    known = sorted(number for number in numbers if number is not None)
    return Spread(len(known), known[0], statistics.median(known), known[-1]) if known else Spread(0, None, None, None)


def codes(runs: Sequence[RunFacts]) -> List[str]:
    """Return the benchmarks of the runs, in their order."""
    return in_order(run.record.benchmark for run in runs)


def teams(runs: Sequence[RunFacts]) -> List[str]:
    """Return the teams of the runs, sorted."""
    return sorted({run.record.team for run in runs})


def _by(runs: Iterable[RunFacts], place: Callable[[RunFacts], Place]) -> Dict[Place, List[RunFacts]]:
    found: Dict[Place, List[RunFacts]] = {}
    for run in runs:
        found.setdefault(place(run), []).append(run)
    return found


def item_lines(runs: Sequence[RunFacts]) -> List[ItemLine]:
    """Return a line for each item, in the order of the sheets. Runs count that were started and are over."""
    lines = []
    for code in codes(runs):
        of_code = [run for run in runs if run.record.benchmark == code and run.is_over]
        for key in dict.fromkeys(key for run in of_code for key in run.items):
            items = [run.items[key] for run in of_code if key in run.items]
            lines.append(ItemLine(
                code, *key, len(items), sum(item.achieved for item in items),
                sum(item.not_attempted for item in items),
                spread(item.after_s for item in items if item.achieved)))
    return lines


def phase_lines(runs: Sequence[RunFacts]) -> List[TimeLine]:
    """Return a line for each phase, in the order of the runs. Runs count that were started and are over."""
    return _time_lines(runs, lambda run: [(phase.name, phase.elapsed_s) for phase in run.record.phases if run.is_over])


def goal_lines(runs: Sequence[RunFacts]) -> List[TimeLine]:
    """Return a line for each goal by its number within the run, where they are numbered in their order."""
    return _time_lines(runs, lambda run: [(str(goal.number), goal.seconds) for goal in run.goals])


def _time_lines(
    runs: Sequence[RunFacts], times: Callable[[RunFacts], List[Tuple[str, Optional[float]]]]
) -> List[TimeLine]:
    lines = []
    for code in codes(runs):
        seconds: Dict[str, List[Optional[float]]] = {}
        for name, each in (pair for run in runs if run.record.benchmark == code for pair in times(run)):
            seconds.setdefault(name, []).append(each)
        lines += [TimeLine(code, name, len(each), spread(each)) for name, each in seconds.items()]
    return lines


def end_lines(runs: Sequence[RunFacts]) -> List[EndLine]:
    """Return a line for each benchmark."""
    lines = []
    for code in codes(runs):
        of_code = [run for run in runs if run.record.benchmark == code]
        ends: Dict[str, int] = {}
        for run in of_code:
            ends[run.record.end_reason] = ends.get(run.record.end_reason, 0) + 1
        attempts = attempts_of(run.record for run in of_code if run.record.started_utc)
        lines.append(EndLine(
            code, len(of_code), dict(sorted(ends.items())), sum(max(0, len(run.record.stops) - 1) for run in of_code),
            sum(len(each) - 1 for each in attempts.values())))
    return lines


def delay_lines(runs: Sequence[RunFacts]) -> List[DelayLine]:
    """Return a line for each zone."""
    return [
        DelayLine(zone, spread(run.delay_s for run in of_zone),
                  sum(run.delay_s is not None and run.delay_s > LATE_S for run in of_zone))
        for zone, of_zone in sorted(_by(runs, lambda run: run.record.zone).items())
    ]


def links(runs: Sequence[RunFacts]) -> Dict[Tuple[str, float], LinkFacts]:
    """Return the links by team and period, sorted."""
    found: Dict[Tuple[str, float], LinkFacts] = {}
    for run in runs:
        for key, link in run.link.items():
            found[key] = found.get(key, LinkFacts()).plus(link)
    return dict(sorted(found.items()))


def link_of_teams(runs: Sequence[RunFacts]) -> Dict[str, LinkFacts]:
    """Return the links by team, sorted."""
    found: Dict[str, LinkFacts] = {}
    for (team, _), link in links(runs).items():
        found[team] = found.get(team, LinkFacts()).plus(link)
    return found


def unsigned(runs: Sequence[RunFacts]) -> List[RunFacts]:
    """Return the runs that are over and whose sheet nobody has signed off."""
    return [run for run in runs if run.record.end_reason and run.record.sign_off is None]
