"""Reads a schedule from a CSV sheet of any spreadsheet program.

The first row names the columns, in any order: zone, benchmark, team, date, time, and optionally round and run. Each
further row is a run. The separator may be a comma, a semicolon or a tab, or the one that a line sep= before names.
"""

import csv
import datetime
import io
import re
from dataclasses import replace
from typing import Callable, Collection, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.rulebook.benchmarks import ALL_TEAMS
from roah_rsbb.rulebook.errors import Place, Report, listing, quote, read_text
from roah_rsbb.rulebook.registry import PROFILES
from roah_rsbb.rulebook.yaml_fields import integer, text
from roah_rsbb.rulebook.yaml_lines import Scalar
from roah_rsbb.tools.competition.answers import benchmark_code, team_name
from roah_rsbb.tools.competition.plan import Plan, PlannedRun, PlannedZone, VenueClock, for_all, read_day, read_time
from roah_rsbb.wording.texts import did_you_mean, nearest

REQUIRED = ("zone", "benchmark", "team", "date", "time")
OPTIONAL = ("round", "run")
_COLUMNS = (*REQUIRED, *OPTIONAL)
_WHAT = "the sheet (option --sheet)"
_SHAPE = f"a row that names the columns: {', '.join(REQUIRED)}; optionally {' and '.join(OPTIONAL)}"
_SEPARATORS = ",;\t"
# A first line for Excel, which does not show it.
_NAMED_SEPARATOR = re.compile(r'"?sep=([^"\r\n])"?', re.IGNORECASE)
_MAX_ROUND = 255  # as in a schedule file


class Known(NamedTuple):
    """Teams or benchmarks that a sheet may name, and where they are listed."""

    names: Sequence[str]
    where: str


class _Row(NamedTuple):
    """A valid row; round and run are None if the sheet omits them."""

    place: Place
    zone: str
    code: str
    team: str
    day: datetime.date
    begins: datetime.datetime
    round: Optional[int]
    run: Optional[int]


def read_sheet(
    path: str, report: Report, clock: VenueClock, teams: Optional[Known] = None, codes: Optional[Known] = None,
    for_all: Callable[[str], bool] = for_all, other_days: Collection[datetime.date] = (),
) -> Optional[Plan]:
    """Read the plan in a sheet; None after errors. The report gets an error for each invalid cell.

    Without `teams`, all names of teams are accepted. Without `codes`, all shipped benchmarks are accepted. `for_all`
    says whether all robots do a benchmark at once. `other_days`: further days of the competition, which count for the
    rounds.
    """
    before = len(report.errors)
    content = read_text(path, report, _WHAT)
    if content is None:
        return None
    rows = _Sheet(path, content, report, clock, teams, codes, for_all).rows()
    if not rows and len(report.errors) == before:
        report.error(Place(path, 0, 0), "no runs", f"{_SHAPE}; below it a row for each run")
    plan = _plan(report, rows, other_days)
    return plan if len(report.errors) == before else None


def column_name(number: int) -> str:
    """The name of a column in spreadsheet programs: A, B, …, Z, AA, …; `number` counts from 1."""
    name = ""
    while number:
        number, letter = divmod(number - 1, 26)
        name = chr(ord("A") + letter) + name
    return name


class _Sheet:
    def __init__(
        self, path: str, content: str, report: Report, clock: VenueClock, teams: Optional[Known],
        codes: Optional[Known], for_all: Callable[[str], bool],
    ) -> None:
        self._path, self._content, self._report, self._clock = path, content, report, clock
        self._teams, self._codes, self._for_all = teams, codes, for_all
        self._columns: Dict[str, int] = {}  # name to its index
        self._header: List[str] = []

    def rows(self) -> List[_Row]:
        """Return all valid rows; none if the header is invalid."""
        lines = self._lines()
        number, self._header = next(lines, (1, []))
        if not self._read_header(number):
            return []
        return [row for row in (self._row(number, cells) for number, cells in lines) if row is not None]

    def _lines(self) -> Iterator[Tuple[int, List[str]]]:
        """Yield lines that are not empty, with their numbers and cells."""
        if "\0" in self._content:
            line = self._content[:self._content.index("\0")].count("\n") + 1
            self._report.error(Place(self._path, line, 0), "a control character", "text; save the sheet as CSV")
            return
        first = next((line for line in self._content.splitlines() if line.strip()), "")
        named = _NAMED_SEPARATOR.fullmatch(first.strip())
        separator = named.group(1) if named else max(_SEPARATORS, key=first.count)
        reader = csv.reader(io.StringIO(self._content, newline=""), delimiter=separator, strict=True)
        begin = 1
        try:
            for cells in reader:
                is_filled = any(cell.strip() for cell in cells)
                if is_filled and named:
                    named = None  # that line
                elif is_filled:
                    yield begin, [cell.strip() for cell in cells]
                begin = reader.line_num + 1
        except csv.Error:
            self._report.error(Place(self._path, begin, 1), "an unclosed quote, or text after a closing one",
                               'cells without quotes, or with one at each end; write a quote within a cell twice: ""')

    def _read_header(self, number: int) -> bool:
        known = len(self._report.errors)
        for index, name in enumerate(self._header):
            word = name.casefold()
            place = Place(self._path, number, index + 1)
            if not word:
                continue
            if word not in _COLUMNS:
                self._report.error(place, f"{quote(name)} in column {column_name(index + 1)}",
                                   f"the name of a column{did_you_mean(word, _COLUMNS)}")
            elif word in self._columns:
                self._report.error(place, f"column {word} twice", "each column once")
            self._columns.setdefault(word, index)
        missing = [name for name in REQUIRED if name not in self._columns]
        if missing and known == len(self._report.errors):
            self._report.error(Place(self._path, number, 0), f"no column {listing(missing)}", _SHAPE)
        return known == len(self._report.errors)

    def _row(self, number: int, cells: List[str]) -> Optional[_Row]:
        """Read a run; None after an error."""
        report = self._report
        known = len(report.errors)
        for index, content in enumerate(cells):
            if content and not (index < len(self._header) and self._header[index]):
                report.error(Place(self._path, number, index + 1),
                             f"{quote(content)} in column {column_name(index + 1)}, which has no name",
                             "a name for it in the first row, or an empty cell")
        cell = {name: Scalar(Place(self._path, number, index + 1), cells[index] if index < len(cells) else "",
                             False, False) for name, index in self._columns.items()}
        zone = text(report, Scalar(cell["zone"].place, cell["zone"].text, True, False), self._what("zone"))
        code = self._code(cell["benchmark"])
        team = self._team(code, cell["team"])
        day = read_day(report, cell["date"].place, cell["date"].text, self._what("date"))
        time = read_time(report, cell["time"].place, cell["time"].text, self._what("time"))
        round_, run = (self._number(cell.get(name), name) for name in OPTIONAL)
        if day is not None and time is not None:
            self._clock.check(report, cell["time"].place, day, time)
        if len(report.errors) > known:
            return None
        return _Row(cell["zone"].place, zone, code, team, day, self._clock.utc(day, time), round_, run)

    def _what(self, name: str) -> str:
        return f"{name} (column {column_name(self._columns[name] + 1)})"

    def _number(self, cell: Optional[Scalar], name: str) -> Optional[int]:
        return None if cell is None else integer(
            self._report, replace(cell, text=cell.text.lstrip("0") or cell.text), self._what(name), 1, _MAX_ROUND)

    def _team(self, code: Optional[str], cell: Scalar) -> Optional[str]:
        what = self._what("team")
        if code is not None and self._for_all(code):
            if cell.text in ("", ALL_TEAMS):
                return ALL_TEAMS
            return self._report.error(cell.place, f"{quote(cell.text)} as {what} in {code}",
                                      f"{ALL_TEAMS} or an empty cell: all robots do it at once")
        return self._known(team_name(self._report, cell.place, cell.text, what), cell, what, self._teams)

    def _code(self, cell: Scalar) -> Optional[str]:
        what = self._what("benchmark")
        codes = dict.fromkeys([*PROFILES, *(self._codes.names if self._codes else ())])
        code = benchmark_code(self._report, cell.place, cell.text, tuple(codes), what)
        return self._known(code, cell, what, self._codes)

    def _known(self, name: Optional[str], cell: Scalar, what: str, known: Optional[Known]) -> Optional[str]:
        if name is None or known is None or name in known.names:
            return name
        near = nearest(name, known.names)
        guess = f": did you mean {quote(near)}?" if near else f" ({listing(known.names)})"
        return self._report.error(cell.place, f"{quote(name)} as {what}", f"one of {known.where}{guess}")


def _plan(report: Report, rows: List[_Row], other_days: Collection[datetime.date]) -> Plan:
    """Make the plan from the rows. A missing round is the number of its day. Missing runs are numbered by time."""
    days = sorted({*other_days, *(row.day for row in rows)})
    zones: Dict[str, List[PlannedRun]] = {row.zone: [] for row in rows}
    seen: Dict[Tuple[str, str, int, int], Place] = {}
    counts: Dict[Tuple[str, str, int], int] = {}
    for row in sorted(rows, key=lambda row: row.begins):
        number = days.index(row.day) + 1 if row.round is None else row.round
        count = counts[row.code, row.team, number] = counts.get((row.code, row.team, number), 0) + 1
        run = count if row.run is None else row.run
        report.once(seen, (row.code, row.team, number, run), row.place,
                    f"{row.code}, team {quote(row.team)}, round {number}, run {run}", "each run once")
        for name, value in (("round", number), ("run", run)):
            if value > _MAX_ROUND:
                report.error(row.place, f"{name} {value}", f"at most {_MAX_ROUND}: add columns for rounds and runs")
        zones[row.zone].append(PlannedRun(row.code, row.team, number, run, row.begins))
    teams = dict.fromkeys(row.team for row in rows if row.team != ALL_TEAMS)
    automatic = tuple(name for name in OPTIONAL if rows and getattr(rows[0], name) is None)
    return Plan(tuple(teams), tuple(PlannedZone(name, tuple(runs)) for name, runs in zones.items()), automatic)
