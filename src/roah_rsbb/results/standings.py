"""Standings as text."""

from fractions import Fraction
from typing import Dict, Iterator, List, Mapping, Optional, Sequence, Tuple

from roah_rsbb.model.document import PublicRank, PublicStanding
from roah_rsbb.model.reason import Reason
from roah_rsbb.model.records import RunRecord
from roah_rsbb.model.rules import Attempts
from roah_rsbb.results.lists import aligned
from roah_rsbb.rulebook.standing_rules import Rules
from roah_rsbb.scoring.counting import RunChoice
from roah_rsbb.scoring.standings import RankedRun, Standing, TeamLine, standings
from roah_rsbb.scoring.tree import rounded_text
from roah_rsbb.wording.sheets import NOT_SIGNED_OFF, turn
from roah_rsbb.wording.texts import one_line
from roah_rsbb.wording.times import NOTHING

DISQUALIFIED = "disqualified"
OF_RUNS = {
    Attempts.BEST: "the best run of each team counts", Attempts.FIRST: "the first run of each team counts",
    Attempts.LAST: "the last run of each team counts", Attempts.SUM: "the sum of each team's{best} runs counts",
    Attempts.MEAN: "the mean of each team's{best} runs counts",
    Attempts.MEDIAN: "the median of each team's{best} runs counts",
}


def number_text(number: Optional[Fraction]) -> str:
    """A number with at most three decimals. It is rounded half up."""
    return NOTHING if number is None else rounded_text(number)


def number_with_unit(number: Optional[Fraction], unit: str) -> str:
    """A number with its unit; a missing number has none."""
    return f"{number_text(number)} {unit}" if unit and number is not None else number_text(number)


def benchmark_name(code: str, title: str) -> str:
    """Return a benchmark's title with its code, or the one that there is: a stage has no code."""
    return f"{title} ({code})" if title and code else title or code


def counting_of(standing: Standing) -> str:
    """What counts in the standing."""
    number = standing.attempts.of_best
    return standing.counting or OF_RUNS[standing.attempts.how].format(best=f" best {number}" if number else "")


def rank_text(team: TeamLine) -> str:
    """A rank; "=" marks ties."""
    return f"{team.rank}{'=' if team.tied else ''}"


def criteria_of(standing: Standing) -> List[str]:
    """The names of the criteria in the order of comparison."""
    return [c.name if c.more_is_better else f"{c.name} (less is better)" for c in standing.criteria]


def number_cells(standing: Standing, team: TeamLine) -> List[str]:
    """A team's numbers with their units."""
    if team.disqualified:
        return [DISQUALIFIED, *("" for _ in standing.criteria[1:])]
    return [number_with_unit(number, unit) for number, unit in zip(team.numbers, standing.units)]


def run_text(run: RankedRun) -> str:
    """Name a run and its state."""
    mark = f", {DISQUALIFIED}" if run.disqualified else ""
    open_mark = "" if run.record.sign_off else f", {NOT_SIGNED_OFF}"
    return f"{turn(run.record.round, run.record.run)}{mark}{open_mark}"


def standing_lines(standing: Standing) -> Iterator[str]:
    """Return the lines for the terminal."""
    yield f"{one_line(benchmark_name(standing.benchmark, standing.title))}: {counting_of(standing)}"
    rows = [("Rank", "Team", *criteria_of(standing), "Runs")]
    rows += [
        (rank_text(team), one_line(team.team), *map(one_line, number_cells(standing, team)), str(len(team.runs)))
        for team in standing.lines
    ]
    yield from (f"  {line}" for line in aligned(rows))
    for remark in standing.remarks:
        yield f"  * {one_line(remark)}"


def public_standings(
    records: Sequence[RunRecord], rules: Dict[str, Rules], choice: RunChoice, titles: Mapping[str, str]
) -> Tuple[PublicStanding, ...]:
    """Return the standings for the public; see `standings`."""
    return tuple(
        PublicStanding(found.title or found.benchmark, tuple(criteria_of(found)), tuple(
            PublicRank(rank_text(line), line.team, tuple(number_cells(found, line))) for line in found.lines),
            tuple(remark for remark in found.remarks if isinstance(remark, Reason)))
        for found in standings(records, rules, choice, titles) if found.lines)
