"""Reads the score sheets in RoboCup@Home's own rule book: the LaTeX sources of the repository RoboCupAtHome/RuleBook.

A sheet is a list of rows, which macros make: `\\scoreitem`, `\\scoremod` and `\\scorepen` under it, `\\penaltyitem`,
headings. Which sheets are valid, and their titles, is in documents/scoresheets.tex. What the macros add to each sheet
(not attending, start signal, outstanding performance) is in setup/macros_scoresheets.tex, with defaults of a sheet's
options. This module knows these macros by name, and runs no TeX: what it does not understand is an error with file and
line, never left out.
"""

import enum
import pathlib
import re
from typing import Dict, Iterator, List, NamedTuple, Optional, Tuple

LIST = ("documents/scoresheets.tex", "scoresheets.tex", "score_sheets.tex")
MACROS = ("setup/macros_scoresheets.tex", "setup/macros_score_sheets.tex")
TERMS = ("setup/macros.tex", "setup/abbrevix.tex")
# Leagues for which a sheet has rows of its own.
LEAGUES = ("OPL", "DSPL", "SSPL")
MAX_BYTES = 1_000_000  # of a file


class LeagueError(Exception):
    """What was not understood, with file and line, and the remedy."""


class RowKind(enum.Enum):
    """What a row is: the name of its macro."""

    ITEM = "scoreitem"
    MODIFIER = "scoremod"  # more points for the item above
    DEDUCTION = "scorepen"  # fewer points for the item above
    PENALTY = "penaltyitem"
    BONUS = "bonusitem"  # not part of the total


UNDER = (RowKind.MODIFIER, RowKind.DEDUCTION)
_KINDS = {kind.value: kind for kind in RowKind}
_KINDS.update(scorebonus=RowKind.BONUS, scorepenalty=RowKind.PENALTY)


class LeagueRow(NamedTuple):
    """A row of a sheet."""

    number: int  # from 0; rows that the macros add come last
    kind: RowKind
    text: str
    points: int  # below 0: a penalty
    times: int
    heading: str  # empty: above the first one
    line: int  # in the file of its sheet; 0: added by the macros
    under: Optional[int] = None  # the number of the item that it modifies


class LeagueSheet(NamedTuple):
    """A score sheet."""

    title: str
    file: str
    timeout_s: int
    rows: Tuple[LeagueRow, ...]  # none: the sheet is a form, such as that of the poster session
    total: Optional[int] = None  # as the sheet states it, where it does not add it up

    @property
    def attainable(self) -> int:
        """The most points without bonus, as the league adds them up."""
        return self.total if self.total is not None else sum(
            row.points * row.times for row in self.rows
            if row.points > 0 and row.kind in (RowKind.ITEM, RowKind.MODIFIER))


class LeagueBook(NamedTuple):
    """The valid sheets of a rule book, in its order."""

    sheets: Tuple[LeagueSheet, ...]
    notes: Tuple[str, ...]  # what the directory does not say


def read_league_book(directory: str, league: str = "OPL") -> LeagueBook:
    """Read the sheets of a league from the root of the rule book's repository; `LeagueError`: something is not
    understood.
    """
    if league not in LEAGUES:
        raise LeagueError(f"There is no league {league!r}: use {', '.join(LEAGUES)}")
    root = pathlib.Path(directory)
    if not (root / "scoresheets").is_dir():
        raise LeagueError(f"{directory} has no folder 'scoresheets': give the root of a checkout of "
                          "RoboCupAtHome/RuleBook")
    notes: List[str] = []
    listed, macros = _first(root, LIST), _first(root, MACROS)
    terms = _terms(root)
    if macros is None:
        notes.append(f"There is no {MACROS[0]}: the rows that its macros add to each sheet are not read")
    defaults = _defaults(_read(root, macros)) if macros else {}
    if macros and "notattendingpenalty" not in defaults:
        notes.append(f"{macros} has a form that is not known: the rows that its macros add to each sheet are not read")
    if listed is None:
        notes.append(f"There is no {LIST[0]}: each file in 'scoresheets' is read, and its name is its title")
        files = [(path.stem, f"scoresheets/{path.name}") for path in sorted((root / "scoresheets").glob("*.tex"))]
    else:
        files = list(_listed(_read(root, listed), listed))
    sheets = (_Sheet(root, title, file, league, defaults, terms).read() for title, file in files)
    return LeagueBook(tuple(sheets), tuple(notes))


def _first(root: pathlib.Path, names: Tuple[str, ...]) -> Optional[str]:
    return next((name for name in names if (root / name).is_file()), None)


def _read(root: pathlib.Path, name: str) -> str:
    path = root / name
    try:
        data = path.read_bytes()
    except OSError as error:
        raise LeagueError(f"{name} cannot be read: {error.strerror}") from None
    if len(data) > MAX_BYTES:
        raise LeagueError(f"{name} has more than {MAX_BYTES} bytes")
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    return re.sub(r"(?<!\\)%.*", "", text)  # comments; lines stay where they are


def _listed(text: str, file: str) -> Iterator[Tuple[str, str]]:
    """Yield title and file of each valid sheet."""
    title = ""
    for match in re.finditer(r"\\renewcommand\s*\{\\currentTest\}|\\input\s*\{(\.?/?scoresheets/[^}]*)\}", text):
        if match[1] is None:
            title, _ = _braced(text, match.end(), file)
            title = re.sub(r"\s*-{2,3}\s*", " – ", title.strip())
        else:
            name = match[1].lstrip("./")
            yield title or pathlib.PurePosixPath(name).stem, name if name.endswith(".tex") else f"{name}.tex"
            title = ""


def _defaults(text: str) -> Dict[str, str]:
    """Return the values of the commands without arguments that a file of macros defines."""
    return dict(re.findall(r"\\newcommand\s*\{\\(\w+)\}\s*\{([^{}]*)\}", text))


def _terms(root: pathlib.Path) -> Dict[str, str]:
    """Return the words that the rule book's macros stand for."""
    found: Dict[str, str] = {}
    for name in TERMS:
        if (root / name).is_file():
            found.update(re.findall(r"\\def\s*\\([A-Za-z]+)\s*\{\\(?:iterm|aterm|emph|textit)\{([^{}\\]*)\}\}",
                                    _read(root, name)))
    return found


def _line(text: str, position: int) -> int:
    return text.count("\n", 0, position) + 1


def _braced(text: str, position: int, file: str, ends: str = "{}") -> Tuple[str, int]:
    """Return what is within the braces that begin at or after a position, and where they end."""
    start = position
    while start < len(text) and text[start].isspace():
        start += 1
    if text[start:start + 1] != ends[0]:
        raise LeagueError(f"{file}:{_line(text, position)}: {ends[0]}...{ends[1]} is missing here")
    depth, i = 0, start
    while i < len(text):
        if text[i] == "\\":
            i += 2
            continue
        depth += (text[i] == ends[0]) - (text[i] == ends[1])
        if depth == 0:
            return text[start + 1:i], i + 1
        i += 1
    raise LeagueError(f"{file}:{_line(text, start)}: the {ends[0]} here is never closed")


# Macros of layout without an argument, and with one that is not text. They are left out.
_SILENT = {"small", "footnotesize", "large", "Large", "LARGE", "newpage", "noindent", "centering", "hline", "hfill",
           "vfill", "smallskip", "medskip", "bigskip", "quad", "qquad", "protect", "relax"}
_SPACE = {"hspace", "vspace", "hspace*", "vspace*", "label", "ref", "pageref", "vskip"}
_BEGIN = "a row begins with \\scoreitem, \\scoremod, \\scorepen or \\penaltyitem"
# Macros whose argument is text.
_WORDS = {"textit", "textbf", "textbi", "emph", "texttt", "textsc", "text", "mbox", "iterm", "aterm", "underline", "ul"}
_SIGNS = {"&": "&", "%": "%", "$": "$", "#": "#", "_": "_", "{": "{", "}": "}", ",": " ", " ": " ", ";": " ", "\\": " ",
          "times": "×", "cdot": "·", "leq": "≤", "le": "≤", "geq": "≥", "ge": "≥", "star": "*", "ldots": "…",
          "dots": "…", "textendash": "–", "Box": "", "pm": "±", "degree": "°", "infty": "∞", "sum": "Σ", "max": "max",
          "min": "min", "slash": "/", "textquotesingle": "'", "euro": "€"}


class _Sheet:
    """Reads one sheet."""

    def __init__(self, root: pathlib.Path, title: str, file: str, league: str, defaults: Dict[str, str],
                 terms: Dict[str, str]) -> None:
        self._title, self._file, self._league, self._defaults, self._terms = title, file, league, defaults, terms
        self._text = self._by_league(_read(root, file))
        self._rows: List[LeagueRow] = []
        self._heading = ""
        self._total: Optional[int] = None
        self._options = {
            "timelimit": defaults.get("timelimit", ""), "specialpenbonus": defaults.get("specialPenBonus", "true"),
            "outstanding": defaults.get("outstandingPerformanceBonus", "false"),
            "outstandingpc": defaults.get("outstandingPerformanceBonusPercentage", "0"), "outstandingbonus": "0",
            "datarecording": defaults.get("dataRecordingBonus", "false"),
            "datarecordingpc": defaults.get("dataRecordingBonusPercentage", "0"), "datarecordingbonus": "0",
            "startbutton": defaults.get("startbuttonpenalized", "false"),
            "startbuttonpenalty": defaults.get("startbuttonpenalty", "0")}
        self._known = {*self._options, "score", "attempts", "continue", "firstcolcaption", "secondcolcaption",
                       "singletrycc", "firsttrycc", "secondtrycc"}

    def read(self) -> LeagueSheet:
        """Return the sheet with the rows that the macros add."""
        begin = re.search(r"\\begin\{scorelist\}", self._text)
        if begin is None:
            if re.search(rf"\\(?:{'|'.join(_KINDS)})\b", self._text):
                raise self._error(0, "rows outside of a scorelist", "\\begin{scorelist} before them")
            return self._sheet()
        end = self._text.find("\\end{scorelist}", begin.end())
        if end < 0:
            raise self._error(begin.start(), "a scorelist without an end", "\\end{scorelist}")
        if "\\begin{scorelist}" in self._text[end:]:
            raise self._error(end, "a second scorelist", "one on a sheet")
        position = begin.end()
        if self._text[position:position + 1] == "[":
            given, position = _braced(self._text, position, self._file, "[]")
            self._set(given, begin.start())
        self._read_rows(position, end)
        self._add_rows()
        return self._sheet()

    def _sheet(self) -> LeagueSheet:
        """Return the sheet with the rows so far."""
        return LeagueSheet(self._title, self._file, self._timeout_s(), tuple(self._rows), self._total)

    # -- what is written ----------------------------------------------------------------------------

    def _error(self, position: int, what: str, remedy: str) -> LeagueError:
        return LeagueError(f"{self._file}:{_line(self._text, position)}: {what} is not understood: {remedy}")

    def _by_league(self, text: str) -> str:
        """Return the text with the rows of the league alone, and the long form of the sheet; lines stay."""
        choices = {"ifDSPL": self._league == "DSPL", "ifNotDSPL": self._league != "DSPL",
                   "ifOPL": self._league == "OPL", "ifSSPL": self._league == "SSPL"}
        while True:
            match = re.search(rf"\\({'|'.join(choices)}|ifShortScoresheet)\b", text)
            if match is None:
                return text
            first, end = _braced(text, match.end(), self._file)
            if match[1] == "ifShortScoresheet":
                second = ""  # some rows have no long form
                if text[end:].lstrip()[:1] == "{":
                    second, end = _braced(text, end, self._file)
                first = "\n" * first.count("\n") + second
            elif not choices[match[1]]:
                first = "\n" * first.count("\n")
            text = text[:match.start()] + first + text[end:]

    def _set(self, given: str, position: int) -> None:
        for option in filter(None, (each.strip() for each in given.split(","))):
            name, _, value = (part.strip() for part in option.partition("="))
            if name not in self._known:
                raise self._error(position, f"the option {name!r}", f"it may be {', '.join(sorted(self._known))}")
            self._options[name] = value

    def _read_rows(self, position: int, end: int) -> None:
        """Read the rows from a position to another: nothing but macros that are known."""
        item: Optional[int] = None
        while True:
            match = re.compile(r"\s*(?:\\([A-Za-z]+\*?|.))?", re.DOTALL).match(self._text, position, end)
            assert match is not None  # it may be empty
            macro = match[1]
            if macro is None:
                if match.end() < end:
                    raise self._error(match.end(), repr(self._text[match.end():match.end() + 30].strip()),
                                      _BEGIN)
                return
            start, position = match.start(1) - 1, match.end()
            if macro in _KINDS:
                row, position = self._row(_KINDS[macro], start, position, item)
                self._rows.append(row)
                item = row.number if row.under is None else item
            elif macro == "scoreheading":
                heading, position = _braced(self._text, position, self._file)
                self._heading, item = self._words(heading, start), None
            elif macro in ("setTotalScore", "setOutstandingBonus"):
                given, position = _braced(self._text, position, self._file)
                if macro == "setTotalScore":
                    self._total = self._number(given, start)
                else:
                    self._options["outstandingbonus"] = given
            elif macro in _SPACE:
                _, position = _braced(self._text, position, self._file)
            elif macro not in _SILENT and macro != "\\":
                raise self._error(start, f"\\{macro}", _BEGIN)

    def _row(self, kind: RowKind, start: int, position: int, item: Optional[int]) -> Tuple[LeagueRow, int]:
        times = "1"
        if self._text[position:].lstrip()[:1] == "[":
            times, position = _braced(self._text, position, self._file, "[]")
        points, position = _braced(self._text, position, self._file)
        text, position = _braced(self._text, position, self._file)
        if kind in UNDER and item is None:
            raise self._error(start, f"\\{kind.value} without an item above it", "\\scoreitem before it")
        given, count = self._number(points, start), self._number(times, start)
        if count == 0:
            raise self._error(start, "a row that counts 0 times", "a number from 1")
        if kind in (RowKind.DEDUCTION, RowKind.PENALTY):
            given = -abs(given)
        elif count < 0:
            given, count = -given, -count  # the penalties of old sheets: -1 × 20
        return LeagueRow(len(self._rows), kind, self._words(text, start), given, count,
                   self._heading, _line(self._text, start), item if kind in UNDER else None), position

    def _number(self, text: str, position: int) -> int:
        if not re.fullmatch(r"\s*[+-]?\d{1,9}\s*", text):
            raise self._error(position, f"{text.strip()!r} as a number", "a whole number")
        return int(text)

    def _words(self, text: str, position: int) -> str:
        """Return the text of a row as it is read."""
        made: List[str] = []
        i = 0
        while i < len(text):
            match = re.compile(r"\\([A-Za-z]+\*?|.)", re.DOTALL).match(text, i)
            if match is None:
                made.append("" if text[i] in "{}$^" else " " if text[i] == "~" else text[i])
                i += 1
                continue
            macro, i = match[1], match.end()
            if macro in _SPACE:
                _, i = _braced(text, i, self._file)
                made.append(" ")
            elif macro in _WORDS or macro == "enquote":
                inner, i = _braced(text, i, self._file)
                words = self._words(inner, position)
                made.append(f"“{words}”" if macro == "enquote" else words)
            elif macro == "frac":
                above, i = _braced(text, i, self._file)
                below, i = _braced(text, i, self._file)
                made.append(f"{self._words(above, position)} / {self._words(below, position)}")
            elif macro in self._terms:
                made.append(self._terms[macro])
            elif macro in _SIGNS:
                made.append(_SIGNS[macro])
            elif macro not in _SILENT:
                raise self._error(position, f"\\{macro} in the text of a row", "plain text there")
        words = "".join(made).replace("``", "“").replace("''", "”").replace("---", " – ").replace("--", "–")
        return " ".join(words.split())

    # -- what the macros add ------------------------------------------------------------------------

    def _timeout_s(self) -> int:
        said = re.search(r"maximum time for this test is (\d+) minutes", self._text)  # on old sheets
        limit = said[1] if said else self._options["timelimit"]
        return 60 * self._number(limit, 0) if limit else 0

    def _is_on(self, option: str) -> bool:
        return self._options[option] == "true"  # the macros compare with just this: "False" and "True" are off

    def _add_rows(self) -> None:
        """Add the special penalties and bonuses, as the rule book's macros do: a bonus of 0 points is not printed."""
        if not self._is_on("specialpenbonus") or "notattendingpenalty" not in self._defaults:
            return
        gained = self._sheet().attainable
        self._add(RowKind.PENALTY, -self._number(self._defaults.get("notattendingpenalty", "0"), 0), "Not attending")
        if self._is_on("startbutton"):
            self._add(RowKind.PENALTY, -self._number(self._options["startbuttonpenalty"], 0),
                      "Using alternative start signal")
        for option, text in (("datarecording", "Contributing with recorded data"),
                             ("outstanding", "Outstanding performance")):
            fixed = self._number(self._options[f"{option}bonus"], 0)
            bonus = fixed or gained * self._number(self._options[f"{option}pc"], 0) // 100
            if self._is_on(option) and bonus:
                self._add(RowKind.BONUS, bonus, text)

    def _add(self, kind: RowKind, points: int, text: str) -> None:
        self._rows.append(LeagueRow(len(self._rows), kind, text, points, 1, "Special Penalties & Bonuses", 0))
