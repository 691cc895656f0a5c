"""Makes a rulebook of the sheets in RoboCup@Home's own rule book, gives a rulebook the league's wording, and says what
differs between two rule books (docs/rules.md, "The league's own rule book").

Sheets say points, and how often a row counts. They do not say what is unlimited, given in percent, only a note, or
where sums end at 0. Those answers are in the file league.yaml beside the rulebook; what is missing is asked by name.
"""

import difflib
import json
from typing import Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import yaml

from roah_rsbb.model.rules import Item, Measure, Sheet
from roah_rsbb.rulebook.errors import Report, quote
from roah_rsbb.rulebook.league_sheets import LeagueBook, LeagueError, LeagueRow, LeagueSheet, RowKind
from roah_rsbb.rulebook.yaml_lines import Mapping as MapNode
from roah_rsbb.rulebook.yaml_lines import Node, Scalar, read_yaml

ANSWERS = "league.yaml"
NOTE, POINTS, PRINTED = "note", "points", "as printed"
FLOORS = {"floor of an objective": "min of an item with deductions",
          "floor of a test": "min of all rows that are not special"}
# Texts that say that the printed numbers are not all.
_MORE = ("percentage", "unlimited", "per item")
# A text that is as alike as this is the same row in other words.
_ALIKE = 0.6
_INCIDENTS = """\
# What happens in a run besides marks (docs/rules.md). {not_attending} becomes the number of that row on each sheet.
#incidents:
#  restart: {times: 1, voids: earlier, until: restarted}
#  restarted: {}
#  disqualified: {voids: all}
#  absent: {marks: "{not_attending}"}
"""


class Answers(NamedTuple):
    """What a file beside a rulebook says of the league's sheets."""

    floors: Mapping[str, str]  # by the names in FLOORS
    rows: Mapping[Tuple[str, int], str]  # by code and number: a word, or keys as YAML
    incidents: str = ""  # as YAML


# -- answers ----------------------------------------------------------------------------------------


def code_of(sheet: LeagueSheet) -> str:
    """Return the code of a test: the name of its sheet's file."""
    return sheet.file.rpartition("/")[2].rpartition(".")[0]


def asked(sheet: LeagueSheet) -> List[LeagueRow]:
    """Return the rows of which the sheet does not say all."""
    has_more = {row.under for row in sheet.rows}
    return [row for row in sheet.rows if (not row.points and row.number not in has_more)
            or any(word in f"{row.heading} {row.text}".lower() for word in _MORE)]


def questions(book: LeagueBook, answers: Answers) -> List[str]:
    """Return what the answers lack, a line for each."""
    found = [f"{name}: 0 or nothing ({what})" for name, what in FLOORS.items() if name not in answers.floors]
    for sheet in book.sheets:
        found += [f"{code_of(sheet)} {row.number}, {quote(row.text)} ({row.points} points × {row.times}, under "
                  f"{quote(row.heading)}): '{NOTE}', '{POINTS}', '{PRINTED}', or keys such as {{times: unlimited}}"
                  for row in asked(sheet) if (code_of(sheet), row.number) not in answers.rows]
    return found


def questions_text(book: LeagueBook) -> str:
    """Return a file to be answered."""
    lines = ["# What the league's sheets do not say. Answer here, and give the command again.", "",
             *(f"# {name}: 0  # or nothing: {what}" for name, what in FLOORS.items()), "", "rows:"]
    for sheet in book.sheets:
        rows = asked(sheet)
        if rows:
            lines.append(f"  {code_of(sheet)}:")
        for row in rows:
            lines.append(f"    # {row.heading}: {row.text}")
            lines.append(f"    # {row.number}: {NOTE}  # {row.points} points × {row.times}; or {POINTS}, {PRINTED}, "
                         "{times: unlimited}, {amount: percent}")
    return "\n".join([*lines, "", _INCIDENTS])


def read_answers(report: Report, path: str) -> Answers:
    """Read the answers; errors are added to the report."""
    root = read_yaml(path, report, "the answers", "a map 'rows: ...'")
    floors: Dict[str, str] = {}
    rows: Dict[Tuple[str, int], str] = {}
    incidents = ""
    for key, value in root.pairs if isinstance(root, MapNode) else ():
        if key.text in FLOORS and isinstance(value, Scalar) and value.text in ("0", "nothing"):
            floors[key.text] = value.text
        elif key.text == "rows":
            rows = dict(_answered_rows(report, value))
        elif key.text == "incidents":
            incidents = _yaml_of(value)
        else:
            report.error(key.place, f"{quote(key.text)} with this value",
                         f"{', '.join(f'{name}: 0 or nothing' for name in FLOORS)}, rows, incidents")
    return Answers(floors, rows, incidents)


def _answered_rows(report: Report, node: Node) -> Iterator[Tuple[Tuple[str, int], str]]:
    for code, numbers in node.pairs if isinstance(node, MapNode) else ():
        for number, answer in numbers.pairs if isinstance(numbers, MapNode) else ():
            if not number.text.isdigit() or (isinstance(answer, Scalar) and answer.text not in (NOTE, POINTS, PRINTED)):
                report.error(number.place, f"the answer to {quote(number.text)} of {quote(code.text)}",
                             f"'number of the row: {NOTE}', {POINTS}, {PRINTED}, or keys in braces")
            else:
                yield (code.text, int(number.text)), (
                    answer.text if isinstance(answer, Scalar) else _yaml_of(answer))


def _yaml_of(node: Node) -> str:
    """Return a part of a file as YAML on one line."""
    if isinstance(node, MapNode):
        return f"{{{', '.join(f'{_quoted(key.text)}: {_yaml_of(value)}' for key, value in node.pairs)}}}"
    if isinstance(node, Scalar):
        return _quoted(node.text) if node.quoted else node.text
    return f"[{', '.join(map(_yaml_of, getattr(node, 'items', ())))}]"


# -- a rulebook -------------------------------------------------------------------------------------


def rulebook_text(book: LeagueBook, answers: Answers) -> str:
    """Return the benchmarks file of the sheets with rows. Raises LeagueError if an answer is missing."""
    missing = questions(book, answers)
    if missing:
        raise LeagueError("\n".join([f"{len(missing)} answers are missing:", *missing]))
    lines = ["# Made of the score sheets in the league's rule book by 'rulebook import'. The id of a row is its number",
             "# on its sheet, from 0; rows that macros add come last. What the sheets do not say is in league.yaml."]
    for sheet in book.sheets:
        if sheet.rows:
            lines += ["", *_benchmark(sheet, answers)]
    return "\n".join(lines) + "\n"


def _benchmark(sheet: LeagueSheet, answers: Answers) -> Iterator[str]:
    yield f"- name: {_quoted(sheet.title)}"
    yield f"  desc: {_quoted(sheet.title)}"
    yield f"  code: {code_of(sheet)}"
    yield "  kind: task"
    yield f"  timeout: {sheet.timeout_s or 300}"
    yield "  offline_data: optional"
    yield "  beacon: optional"
    yield "  sheet:"
    own, special = ([row for row in sheet.rows if bool(row.line) == is_own] for is_own in (True, False))
    yield "    - section: Test"
    if answers.floors["floor of a test"] == "0":
        yield "      min: 0"
    yield "      items:"
    yield from _headings(sheet, own, answers, 8)
    yield from (line for row in special if row.kind is RowKind.BONUS for line in _row(sheet, row, answers, 8))
    penalties = [row for row in special if row.kind is not RowKind.BONUS]
    yield from _headings(sheet, penalties, answers, 4)
    if answers.incidents:
        absent = next((str(row.number) for row in penalties if row.text == "Not attending"), "")
        yield f"  incidents: {answers.incidents.replace('{not_attending}', absent)}"


def _headings(sheet: LeagueSheet, rows: Sequence[LeagueRow], answers: Answers, indent: int) -> Iterator[str]:
    """Yield rows in the sections of their headings."""
    heading = None
    for row in rows:
        if row.under is not None:
            continue
        if row.heading != heading:
            heading = row.heading
            if heading:
                yield f"{' ' * indent}- section: {_quoted(heading)}"
                yield f"{' ' * indent}  id: {_quoted(f'heading at {row.number}')}"
                yield f"{' ' * indent}  items:"
        yield from _row(sheet, row, answers, indent + 4 if heading else indent)


def _row(sheet: LeagueSheet, row: LeagueRow, answers: Answers, indent: int) -> Iterator[str]:
    under = [other for other in sheet.rows if other.under == row.number]
    keys: Dict[str, str] = {"item": _quoted(row.text), "id": str(row.number), "points": str(row.points)}
    if row.times > 1:
        keys["times"] = str(row.times)
    if any(other.points < 0 for other in under) and answers.floors["floor of an objective"] == "0":
        keys["min"] = "0"
    answer = answers.rows.get((code_of(sheet), row.number), PRINTED)
    if row.kind is RowKind.BONUS and answer == PRINTED:
        # As much of it as is deserved.
        keys.update({"points": "1", "amount": "points", "from": "0", "to": str(row.points)})
    elif answer == NOTE:
        keys["times"] = "unlimited"
    elif answer == POINTS:
        keys.update({"points": "1", "amount": "points"})
        keys.pop("times", None)
    elif answer != PRINTED:
        keys.update({str(key): str(value) for key, value in yaml.load(answer, Loader=yaml.BaseLoader).items()})
    yield f"{' ' * indent}- {{{', '.join(f'{key}: {value}' for key, value in keys.items())}}}" if not under else \
        f"{' ' * indent}- item: {keys.pop('item')}"
    if under:
        yield from (f"{' ' * indent}  {key}: {value}" for key, value in keys.items())
        yield f"{' ' * indent}  items:"
        for other in under:
            yield from _row(sheet, other, answers, indent + 4)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


# -- the league's wording ---------------------------------------------------------------------------


def reworded(content: str, book: LeagueBook) -> Tuple[str, int]:
    """Return a benchmarks file in which the rows of the league's tests have the league's words, and how many there are.

    A test is the league's if its `desc` is the title of a sheet; a row, if its id is a number of that sheet.
    """
    sheets = {sheet.title.casefold(): sheet for sheet in book.sheets}
    places: List[Tuple[int, int, str]] = []
    root = yaml.compose(content, Loader=yaml.SafeLoader)
    for test in root.value if isinstance(root, yaml.SequenceNode) else ():
        keys = {key.value: value for key, value in test.value} if isinstance(test, yaml.MappingNode) else {}
        sheet = sheets.get(str(keys["desc"].value).casefold()) if "desc" in keys else None
        if sheet is not None and "sheet" in keys:
            texts = {str(row.number): row.text for row in sheet.rows}
            places += [(node.start_mark.index, node.end_mark.index, texts[row_id])
                       for node, row_id in _named_rows(keys["sheet"]) if row_id in texts]
    for start, end, text in sorted(places, reverse=True):
        content = content[:start] + _quoted(text) + content[end:]
    return content, len(places)


def _named_rows(node: yaml.Node) -> Iterator[Tuple[yaml.Node, str]]:
    """Yield the names of all rows within a part of a file, with their ids."""
    if isinstance(node, yaml.MappingNode):
        keys = {key.value: value for key, value in node.value}
        if isinstance(keys.get("item"), yaml.ScalarNode) and isinstance(keys.get("id"), yaml.ScalarNode):
            yield keys["item"], str(keys["id"].value)
        for _, value in node.value:
            yield from _named_rows(value)
    elif isinstance(node, yaml.SequenceNode):
        for each in node.value:
            yield from _named_rows(each)


def other_points(sheets: Mapping[str, Sheet], book: LeagueBook) -> List[str]:
    """Return in words which rows of a rulebook give other points, or count otherwise, than the league's."""
    found: List[str] = []
    for sheet in book.sheets:
        own = {line.id: line for line in _lines(sheets[sheet.title].items)} if sheet.title in sheets else {}
        for row in sheet.rows if own else ():
            line = own.get(str(row.number))
            printed = ComparedRow(str(row.number), row.text, str(row.points), str(row.times), "")
            if line is None:
                found.append(f"{sheet.title}, row {row.number}, {quote(row.text)}: missing")
            elif row.kind is not RowKind.BONUS and (line.points, line.times) != (printed.points, printed.times):
                found.append(f"{sheet.title}, row {row.number}, {quote(row.text)}: {_worth(line)}; printed: "
                             + _worth(printed))
    return found


# -- differences ------------------------------------------------------------------------------------


class ComparedRow(NamedTuple):
    """A row as it is compared."""

    id: str
    text: str
    points: str
    times: str
    place: str  # its heading


Lines = Mapping[str, Sequence[ComparedRow]]  # by the title of the test


def lines_of_league(book: LeagueBook) -> Lines:
    """Return the rows of the league's sheets."""
    return {sheet.title: [ComparedRow(str(row.number), row.text, str(row.points), str(row.times), row.heading)
                          for row in sheet.rows] for sheet in book.sheets}


def lines_of_sheets(sheets: Mapping[str, Sheet]) -> Lines:
    """Return the rows of a rulebook's sheets, by the titles of the tests."""
    return {title: list(_lines(sheet.items)) for title, sheet in sheets.items()}


def _lines(items: Sequence[Item]) -> Iterator[ComparedRow]:
    names = {item.id: item for item in items}
    for item in items:
        if item.amount is not Measure.SECTION:
            above: Optional[Item] = names.get(item.under)
            worth = f"{item.points or 0}" if item.percent is None else f"{item.percent} %"
            yield ComparedRow(item.id, item.name, worth, "unlimited" if item.times is None else str(item.times),
                       above.name if above else "")


def differences(before: Lines, after: Lines) -> List[str]:
    """Return in words what differs between two rule books; empty: nothing."""
    found: List[str] = []
    for title in dict.fromkeys((*before, *after)):
        if title not in after:
            found.append(f"{title}: removed, with {len(before[title])} rows")
        elif title not in before:
            found.append(f"{title}: added, with {len(after[title])} rows")
        else:
            found += [f"{title}: {text}" for text in _of_test(before[title], after[title])]
    return found


def _of_test(before: Sequence[ComparedRow], after: Sequence[ComparedRow]) -> Iterator[str]:
    pairs = _pairs(before, after)
    for old in before:
        if old not in pairs:
            yield f"removed: {quote(old.text)} ({_worth(old)})"
    known = {new: old for old, new in pairs.items()}
    for new in after:
        if new not in known:
            yield f"added: {quote(new.text)} ({_worth(new)})"
            continue
        old = known[new]
        if old.text != new.text:
            yield f"reworded: {quote(old.text)} is now {quote(new.text)}"
        if (old.points, old.times) != (new.points, new.times):
            yield f"{quote(new.text)}: {_worth(old)}, now {_worth(new)}"


def _worth(line: ComparedRow) -> str:
    return f"{line.points} points" + (f" × {line.times}" if line.times != "1" else "")


def _pairs(before: Sequence[ComparedRow], after: Sequence[ComparedRow]) -> Dict[ComparedRow, ComparedRow]:
    """Return which row is which: of the same text under the same heading, of the same text, of a text that is alike."""
    pairs: Dict[ComparedRow, ComparedRow] = {}
    left = list(after)
    for has_place in (True, False):
        for old in before:
            found = next((new for new in left if old not in pairs and old.text == new.text
                          and (old.place == new.place or not has_place)), None)
            if found is not None:
                pairs[old] = found
                left.remove(found)
    ratios = sorted(((difflib.SequenceMatcher(None, old.text.lower(), new.text.lower()).ratio(), i, j)
                     for i, old in enumerate(before) if old not in pairs for j, new in enumerate(left)), reverse=True)
    taken = set()
    for ratio, i, j in ratios:
        if ratio >= _ALIKE and before[i] not in pairs and j not in taken:
            pairs[before[i]] = left[j]
            taken.add(j)
    return pairs
