"""What the report counts: items, phases, goals, ends, delays and links, over the runs of a competition."""

import statistics
from typing import Callable, Dict, Hashable, Iterable, List, NamedTuple, Optional, Sequence, Tuple, TypeVar

from roah_rsbb.results.report.facts import LinkFacts, RunFacts
from roah_rsbb.rulebook.registry import PROFILES
from roah_rsbb.scoring.counting import attempts_of

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
    """Return the benchmarks of the runs: in the order of the benchmarks, unknown ones last."""
    found = {run.record.benchmark for run in runs}
    return [code for code in PROFILES if code in found] + sorted(found.difference(PROFILES))


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
    """Return a line for each phase, in the order of the runs."""
    lines = []
    for code in codes(runs):
        seconds: Dict[str, List[Optional[float]]] = {}
        for run in runs:
            if run.record.benchmark == code and run.is_over:
                for phase in run.record.phases:
                    seconds.setdefault(phase.name, []).append(phase.elapsed_s)
        lines += [TimeLine(code, name, len(each), spread(each)) for name, each in seconds.items()]
    return lines


def goal_lines(runs: Sequence[RunFacts]) -> List[TimeLine]:
    """Return a line for each goal by its number within the run."""
    lines = []
    for code in codes(runs):
        seconds: Dict[int, List[Optional[float]]] = {}
        for run in runs:
            if run.record.benchmark == code:
                for goal in run.goals:
                    seconds.setdefault(goal.number, []).append(goal.seconds)
        lines += [TimeLine(code, str(number), len(each), spread(each)) for number, each in sorted(seconds.items())]
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
