"""Standings for the terminal, and as pages."""

from typing import Dict, Iterator, List, Mapping, Optional, Sequence, Tuple

from roah_rsbb.core.scoring.records import RunRecord
from roah_rsbb.results.page import Child, Markup, joined, page, table, tag
from roah_rsbb.results.standing import Numbers, RunLine, Standing, TeamLine
from roah_rsbb.results.standing_rules import OfRuns
from roah_rsbb.wording import result_texts
from roah_rsbb.wording.result_texts import line, moment

DISQUALIFIED = "disqualified"
OF_RUNS = {
    OfRuns.BEST: "the best run of each team counts", OfRuns.MEAN: "the mean of each team's runs counts",
    OfRuns.MEDIAN: "the median of each team's runs counts",
}


def number_text(number: Optional[float]) -> str:
    """A number of a criterion: whole, or with three decimals at most."""
    return result_texts.NOTHING if number is None else f"{number:.3f}".rstrip("0").rstrip(".")


def rank_text(team: TeamLine) -> str:
    """A rank; teams that share one have "="."""
    return f"{team.rank}{'=' if team.tied else ''}"


def criteria_of(standing: Standing) -> List[str]:
    """What is compared, in this order."""
    return [c.name if c.more_is_better else f"{c.name} (less is better)" for c in standing.criteria]


def _numbers(standing: Standing, numbers: Numbers, disqualified: bool) -> List[str]:
    if disqualified:
        return [DISQUALIFIED, *("" for _ in standing.criteria[1:])]
    return [number_text(number) for number in numbers]


def run_text(run: RunLine) -> str:
    """Which run it was."""
    mark = f", {DISQUALIFIED}" if run.disqualified else ""
    open_mark = "" if run.record.sign_off else ", not signed off"
    return f"round {run.record.round}, run {run.record.run}{mark}{open_mark}"


def standing_lines(standing: Standing) -> Iterator[str]:
    """For the terminal."""
    yield f"{standing.benchmark}: {OF_RUNS[standing.of_runs]}"
    rows = [("Rank", "Team", *criteria_of(standing), "Runs")]
    rows += [
        (rank_text(team), line(team.team), *_numbers(standing, team.numbers, team.disqualified), str(len(team.runs)))
        for team in standing.lines
    ]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        yield "  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip()
    for remark in standing.remarks:
        yield f"  * {line(remark)}"


def standing_markup(standing: Standing, sheets: Mapping[str, str]) -> Markup:
    """A standing in a page; `sheets`: the files of the runs' sheets by identity, where there are any."""
    names = criteria_of(standing)
    parts: List[Child] = [
        tag("h2", standing.benchmark),
        tag("p", f"In the order of {'; then '.join(names)}; {OF_RUNS[standing.of_runs]}."),
        table(("Rank", "Team", *names, "Runs"), [
            (rank_text(team), team.team, *_numbers(standing, team.numbers, team.disqualified),
             _runs(standing, team, sheets))
            for team in standing.lines
        ], ("number", "team", *("number" for _ in names), "")),
    ]
    parts += [tag("p", remark, class_="small") for remark in standing.remarks]
    return joined(parts)


def _runs(standing: Standing, team: TeamLine, sheets: Mapping[str, str]) -> Markup:
    parts: List[Child] = []
    for i, run in enumerate(team.runs):
        numbers = ", ".join(number_text(number) for number in run.numbers)
        text = f"{run_text(run)}: {numbers}"
        link = linked(text, run.record.identity, sheets)
        parts += [tag("br")] if i else []
        parts.append(tag("b", link) if i == team.best else link)
    return joined(parts)


def linked(text: str, identity: str, sheets: Mapping[str, str]) -> Child:
    """The text as a link to the run's sheet, where there is one."""
    return tag("a", text, href=sheets[identity]) if identity in sheets else text


def standings_page(standings: Sequence[Standing], written_utc: float, in_utc: bool) -> str:
    """A page of standings alone."""
    return page(
        "Standings", tag("h1", "Standings"), tag("p", f"As of {moment(written_utc, in_utc)}", class_="small"),
        *(standing_markup(standing, {}) for standing in standings),
    )


def index_page(
    numbered: Sequence[Tuple[int, RunRecord]], sheets: Dict[str, str], standings: Sequence[Standing],
    written_utc: float, in_utc: bool,
) -> str:
    """The page that leads to all sheets, with the standings."""
    rows = [
        (str(number), moment(r.opened_utc, in_utc), r.zone, linked(r.benchmark, r.identity, sheets), r.team,
         f"{r.round} / {r.run}", result_texts.state_of(r), result_texts.sign_off_text(r, in_utc))
        for number, r in numbered
    ]
    return page(
        "Results", tag("h1", "Results"), tag("p", f"As of {moment(written_utc, in_utc)}", class_="small"),
        *(standing_markup(standing, sheets) for standing in standings),
        tag("h2", "Runs"),
        table(("No.", "Connected", "Zone", "Benchmark", "Team", "Round / run", "State", "Sheet"), rows,
              ("number", "time", "", "", "team")),
    )
