"""Standings as pages."""

from types import MappingProxyType
from typing import Dict, List, Mapping, Sequence, Tuple

from roah_rsbb.model.records import RunRecord
from roah_rsbb.results.page import NO_COMPETITION, Child, Competition, Markup, joined, page, table, tag
from roah_rsbb.results.runs import run_state_text, signature_of
from roah_rsbb.results.standings import (
    benchmark_name,
    counting_of,
    criteria_of,
    number_cells,
    number_with_unit,
    rank_text,
    run_text,
)
from roah_rsbb.scoring.counting import Why
from roah_rsbb.scoring.standings import Standing, TeamLine
from roah_rsbb.wording.times import date_time


def standing_markup(standing: Standing, sheets: Mapping[str, str]) -> Markup:
    """Build the section of a page; `sheets` has the files of the runs' sheets by identity."""
    names = criteria_of(standing)
    parts: List[Child] = [
        tag("h2", benchmark_name(standing.benchmark, standing.title)),
        tag("p", f"Ranked by {'; then '.join(names[:1] if standing.counting else names)}; {counting_of(standing)}."),
        table(("Rank", "Team", *names, "Runs"), [
            (rank_text(team), team.team, *number_cells(standing, team), _runs(standing, team, sheets))
            for team in standing.lines
        ], ("number", "team", *("number" for _ in names), "")),
    ]
    parts += [tag("p", remark, class_="small") for remark in standing.remarks]
    if standing.steps:
        parts.append(tag("details", tag("summary", "How the numbers came about"),
                         *(tag("p", step) for step in standing.steps), class_="small"))
    return joined(parts)


def _runs(standing: Standing, team: TeamLine, sheets: Mapping[str, str]) -> Markup:
    parts: List[Child] = []
    for i, run in enumerate(team.runs):
        numbers = ", ".join(map(number_with_unit, run.numbers, standing.units))
        name = run_text(run) if standing.benchmark else f"{run.record.benchmark}, {run_text(run)}"
        text = f"{name}: {numbers}"
        link = linked(text, run.record.identity, sheets)
        parts += [tag("br")] if i else []
        decides = i in team.counting and (len(team.counting) == 1 or len(team.counting) < len(team.runs))
        parts.append(tag("b", link) if decides else link)
    return joined(parts)


def linked(text: str, identity: str, sheets: Mapping[str, str]) -> Child:
    """Link a text to the run's sheet if there is one."""
    return tag("a", text, href=sheets[identity]) if identity in sheets else text


def standings_page(
    standings: Sequence[Standing], as_of_utc: float, in_utc: bool, competition: Competition = NO_COMPETITION
) -> str:
    """Build a page of standings only."""
    return page(
        "Standings", competition.markup(), tag("h1", "Standings"),
        tag("p", f"As of {date_time(as_of_utc, in_utc)}", class_="small"),
        *(standing_markup(standing, {}) for standing in standings),
    )


def index_page(
    numbered: Sequence[Tuple[int, RunRecord]], sheets: Dict[str, str], standings: Sequence[Standing],
    as_of_utc: float, in_utc: bool, competition: Competition = NO_COMPETITION,
    why: Mapping[str, Why] = MappingProxyType({}),
) -> str:
    """Build the page with the standings and links to all sheets. `why`: whether runs count, by their identities."""
    rows = [
        (str(number), date_time(r.opened_utc, in_utc), r.zone, linked(r.benchmark, r.identity, sheets), r.team,
         f"{r.round} / {r.run}", run_state_text(r, why[r.identity].value if r.identity in why else ""),
         signature_of(r, in_utc))
        for number, r in numbered
    ]
    return page(
        "Results", competition.markup(), tag("h1", "Results"),
        tag("p", f"As of {date_time(as_of_utc, in_utc)}", class_="small"),
        *(standing_markup(standing, sheets) for standing in standings),
        tag("h2", "Runs"),
        table(("No.", "Connected", "Zone", "Benchmark", "Team", "Round / run", "State", "Sheet"), rows,
              ("number", "when", "", "", "team", "", "", "who")),
    )
