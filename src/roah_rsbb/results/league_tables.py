"""Scores as RoboCup@Home publishes them in the repository of an event: scores.csv, an attempt a row, and tables in
Markdown (docs/results.md, "The league's own tables").
"""

import csv
import io
from fractions import Fraction
from typing import Any, Dict, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.results.runs import NotPossible
from roah_rsbb.results.standings import rank_text
from roah_rsbb.scoring.standings import Standing
from roah_rsbb.scoring.tree import rounded, rounded_text
from roah_rsbb.wording.times import formatted

COLUMNS = ("Date", "Task", "Team", "Score")
# The first column may also be the number of the stage.
WHEN = ("Date", "Stage", "Date or Stage")


class AttemptScore(NamedTuple):
    """An attempt of a team at a test."""

    scheduled: float  # UTC, s
    task: str
    team: str
    points: Fraction


def scores_of(standings: Iterable[Standing]) -> List[AttemptScore]:
    """Return all attempts that count or were less good than another one, in the order in which they were held."""
    found = [AttemptScore(run.record.scheduled, standing.benchmark, line.team, run.numbers[0] or Fraction(0))
             for standing in standings if standing.benchmark for line in standing.lines for run in line.runs]
    return sorted(found, key=lambda score: (score.scheduled, score.task))


def scores_text(scores: Sequence[AttemptScore]) -> str:
    """Return the file scores.csv."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows((formatted(score.scheduled, "%a", False), score.task, score.team, rounded_text(score.points))
                     for score in scores)
    return file.getvalue()


def attempts_text(scores: Sequence[AttemptScore]) -> str:
    """Return a table of each test with all attempts, the best first; the tests that were held last come first."""
    tests: Dict[str, List[AttemptScore]] = {}
    for score in scores:
        tests.setdefault(score.task, []).append(score)
    made = []
    for task, own in reversed(tests.items()):
        own.sort(key=lambda score: -score.points)
        rows = [(str(number), score.team, rounded_text(score.points)) for number, score in enumerate(own)]
        made.append(f"# {task}\n{table(('index', 'Team', 'Score'), rows, (0, 2))}")
    return "\n\n".join(made) + "\n" if made else ""


def rankings_text(standings: Iterable[Standing]) -> str:
    """Return a table of each stage: what each part gave, and the sum. A stage of stages shows the shares in whole
    numbers, as the league does.
    """
    made = []
    stages = [standing for standing in standings if not standing.benchmark and standing.lines]
    for standing in stages:
        names = [criterion.name for criterion in standing.criteria]
        is_final = any(other.title in names for other in stages)
        order = [*range(1, len(names)), 0]
        columns = [_column([line.numbers[i] for line in standing.lines], is_final) for i in order]
        rows = [(line.team, *(column[row] for column in columns), "" if line.disqualified else rank_text(line))
                for row, line in enumerate(standing.lines)]
        head = ("Team", *(names[i] for i in order[:-1]), "Total Score", "Rank")
        made.append(f"# {standing.title}\n{table(head, rows, range(1, len(head)))}")
    return "\n\n".join(made) + "\n" if made else ""


def _column(numbers: Sequence[Optional[Fraction]], is_whole: bool) -> List[str]:
    """Return numbers with as many decimals as the one of them that needs most, at most three."""
    parts = [("", "", "") if number is None else rounded_text(rounded(number, 0) if is_whole else number).partition(".")
             for number in numbers]
    decimals = max((len(part[2]) for part in parts), default=0)
    return [f"{whole}.{rest.ljust(decimals, '0')}" if whole and decimals else whole for whole, _, rest in parts]


def table(head: Sequence[str], rows: Sequence[Sequence[str]], right: Iterable[int]) -> str:
    """Return a table in Markdown. `right`: the columns that are aligned to the right."""
    right = set(right)
    lines = [[cell.replace("|", "\\|") for cell in row] for row in (head, *rows)]
    widths = [max(3, *(len(line[i]) for line in lines)) for i in range(len(head))]

    def line(cells: Sequence[str]) -> str:
        return "| " + " | ".join(cell.rjust(width) if i in right else cell.ljust(width)
                                 for i, (cell, width) in enumerate(zip(cells, widths))) + " |"

    rule = "|" + "|".join("-" * (width + 1) + ":" if i in right else "-" * (width + 2)
                          for i, width in enumerate(widths)) + "|"
    return "\n".join([line(lines[0]), rule, *map(line, lines[1:])])


# -- reading ----------------------------------------------------------------------------------------


def case_of(path: str) -> Mapping[str, Any]:
    """Return a file scores.csv as a case of standings: of each team, the points of its attempts at each test, and those
    of the test that is called Final. Raises NotPossible, with the line that is wrong.
    """
    attempts: Dict[str, Dict[str, List[float]]] = {}
    final: Dict[str, float] = {}
    for number, (task, team, points) in _rows(path):
        if task.casefold() == "final":
            if team in final:
                raise NotPossible(f"{path}:{number}: {team} has a second score in the Final")
            final[team] = points
            attempts.setdefault(team, {})
        else:
            attempts.setdefault(team, {}).setdefault(task, []).append(points)
    return {"kind": "standings", "id": path, "final": final,
            "teams": {team: {"attempts": tests} for team, tests in attempts.items()}}


def _rows(path: str) -> Iterator[Tuple[int, Tuple[str, str, float]]]:
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            rows = list(csv.reader(file))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise NotPossible(f"{path} cannot be read: {error}") from None
    if not rows or len(rows[0]) != len(COLUMNS) or rows[0][0] not in WHEN or tuple(rows[0][1:]) != COLUMNS[1:]:
        raise NotPossible(f"{path}:1: the first line is not 'Date,Task,Team,Score' or 'Stage,Task,Team,Score'")
    for number, row in enumerate(rows[1:], 2):
        if not any(row):
            continue
        try:
            _, task, team, score = (cell.strip() for cell in row)
            yield number, (task, team, float(score))
        except ValueError:
            wrong = ",".join(row)
            raise NotPossible(f"{path}:{number}: {wrong!r} is not day or stage, task, team, and a number") from None
