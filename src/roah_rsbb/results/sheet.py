"""A run's score sheet: the same tables for the terminal and for a page that can be printed."""

from functools import partial
from typing import Iterator, List, NamedTuple, Optional, Sequence, Tuple, Union

from roah_rsbb.model.records import ItemRecord, RunRecord, ratings, submitted
from roah_rsbb.model.results import VersionLine
from roah_rsbb.results.events import Section, box_states, robot_states, sections
from roah_rsbb.results.link_report import LinkRows, link_lines, link_plot
from roah_rsbb.results.page import NO_COMPETITION, Child, Competition, Markup, facts_table, joined, page, table, tag
from roah_rsbb.results.paper import front_markup, front_of, robots_of
from roah_rsbb.results.runs import (
    RobotPart,
    RunResult,
    act_lines,
    clock_text,
    judged_items,
    objection_lines,
    run_state_text,
    signature_of,
    taken_text,
    without_step,
)
from roah_rsbb.rulebook.standing_rules import Rules
from roah_rsbb.scoring.timeline import run_timeline, version_lines
from roah_rsbb.wording import sheets
from roah_rsbb.wording.sheets import counting_text, scores_by_group
from roah_rsbb.wording.texts import one_line as line
from roah_rsbb.wording.timeline import said_of, timeline
from roah_rsbb.wording.times import NOTHING, date_time, elapsed, optional_date_time, time_with_tenths

# Begin and end of struck-through text, on terminals that support it.
_STRUCK, _PLAIN = "\033[9m", "\033[29m"


class Struck(str):
    """What was withdrawn."""


class Highlighted(str):
    """A word that nobody must overlook."""


class Bad(str):
    """A warning."""


Cell = Union[str, Tuple[str, str]]  # two: with a space between them


class SheetPart(NamedTuple):
    """A part of the sheet."""

    title: str
    heads: Tuple[str, ...] = ()
    rows: Sequence[Sequence[Cell]] = ()
    classes: Tuple[str, ...] = ()  # of the columns; see `table`
    lines: Sequence[str] = ()  # below the rows
    always: bool = False  # also without rows


def parts(result: RunResult, in_utc: bool) -> Iterator[SheetPart]:
    """Return the parts of the sheet, besides its facts and links: those that have rows, and their columns that are not
    empty."""
    for part in _parts(result, in_utc):
        kept = [place for place, column in enumerate(zip(*part.rows)) if any(map("".join, column))]
        classes = [*part.classes, *("" for _ in part.heads)]
        if part.rows or part.always:
            yield part._replace(
                heads=tuple(part.heads[i] for i in kept), rows=[[row[i] for i in kept] for row in part.rows],
                classes=tuple(classes[i] for i in kept))


def _parts(result: RunResult, in_utc: bool) -> Iterator[SheetPart]:
    record, at = result.record, partial(date_time, in_utc=in_utc)
    yield from _scores(record)
    yield SheetPart("Timeline", ("When", "Clock", "Who", "What", "Points"), [
        (item.time, item.clock, ", ".join(filter(None, (item.who, item.role))),
         "; ".join(filter(None, (f"{item.text} {item.change}".rstrip(), item.note, said_of(item)))), item.points)
        for item in timeline(run_timeline(record), at)[::-1]], ("when", "number", "who"))
    yield SheetPart("History of the score sheet", ("No.", "When", "Who", "What", "Change", "Note"),
               [_change(entry) for entry in _entries(record, at)], ("number", "when", "who", "what", "change"))
    names = [sheet.judge for sheet in submitted(record)]
    yield SheetPart("Judges", ("Item", *names, "Counts", "Settled"), [
        (each.item.desc, *each.proposals, sheets.in_words(each.item),
         f"{sheets.person(each.settlement.who)}: {each.settlement.reason}" if each.settlement is not None else "")
        for each in judged_items(record)], ("what", *("value" for _ in names), "value"))
    for title, lines in (("Sheets of the judges", act_lines(record)), ("Objections", objection_lines(record))):
        yield SheetPart(title, ("When", "Who", "What"),
                   [(at(utc), sheets.person(who), text) for utc, who, text in lines], ("when", "who", "what"))
    yield SheetPart("Box away", ("When", "What"), [
        (at(outage.utc), sheets.outage_text(outage)) for outage in record.outages], ("when", "what"))
    yield SheetPart("Ends", ("When", "Who", "End", "Reason given"), [
        (at(stop.utc), sheets.person(stop.who), stop.desc or sheets.end_reason(stop.end_reason),
         sheets.stop_reason(stop.reason, stop.reason_by, stop.who)) for stop in record.stops], ("when", "who", "what"))
    yield from (_section(section, in_utc) for section in sections(result))


def _scores(record: RunRecord) -> Iterator[SheetPart]:
    points = dict(record.points.groups) if record.points is not None else {}
    for group, items in sheets.grouped_shown(record.items).items():
        title = f"{group}: {points[group]} points" if group in points else group
        yield SheetPart(title, ("Value", "Points", "Item", ""), [
            (sheets.in_words(item), item.points, f"{item.desc}{_ratings(record, item)}",
             Highlighted(sheets.CORRECTED) if item.corrected else "") for item in items], ("value", "value"))
    if record.points is not None:
        yield SheetPart(sheets.points_text(record.points), lines=sheets.steps_text(record.points), always=True)
    for name, lines in scores_by_group(record.module_scores):
        yield SheetPart(f"Module's score: {name}", ("Value", "What"), [(each.value, each.name) for each in lines],
                   ("value",))


def _ratings(record: RunRecord, item: ItemRecord) -> str:
    given = sheets.ratings_text(ratings(record, item))
    return f" ({given})" if given else ""


def _entries(record: RunRecord, at: sheets.When) -> Iterator[sheets.EntryTexts]:
    """The history in words, in its order."""
    items = {item.key: item for item in record.items}
    for entry in record.history:
        item = items.get((entry.group, entry.desc))
        kind, unit = ("uint", "") if item is None else (item.kind, item.unit)
        yield sheets.entry_texts(sheets.history_entry(entry, kind, unit), at)


def _change(entry: sheets.EntryTexts) -> Tuple[Cell, ...]:
    what, change, note = (
        Struck(text) if entry.withdrawn else text for text in (entry.item, entry.change, entry.note))
    return (entry.number, entry.when, entry.who, (Highlighted(entry.correction), what) if entry.correction else what,
            change, (note, Highlighted(entry.withdrawn)) if entry.withdrawn else note)


def _section(section: Section, in_utc: bool) -> SheetPart:
    several = any(h.robot for h in section.events)
    return SheetPart(section.title, ("When", "Who", *(("Robot",) if several else ()), "What"), [
        (time_with_tenths(h.utc, in_utc), sheets.person(h.who), *((h.robot,) if several else ()),
         Bad(h.text) if h.bad else h.text) for h in section.events], ("time", "who"))


def facts(result: RunResult, in_utc: bool) -> List[Tuple[str, str]]:
    """Return the basic data of a run: names and values."""
    record = result.record
    return [
        ("Zone", line(record.zone)),
        ("Robots", ", ".join(f"{line(r.robot)} of team {line(r.team)} (port {r.port})" for r in result.robots)
         or line(robots_of(record))),
        ("Scheduled", date_time(record.scheduled, in_utc)),
        ("Connected", date_time(record.opened_utc, in_utc)),
        ("Started", optional_date_time(record.started_utc, in_utc)),
        ("Disconnected", optional_date_time(record.closed_utc, in_utc)),
        ("Time", taken_text(record)),
        *([("Phases", ", ".join(f"{line(phase.name)} {elapsed(phase.elapsed_s)}" for phase in record.phases))]
          if record.phases else []),
        ("End", line(run_state_text(record))),
        *([("Counting", counting_text(result.counts))] if result.counts else []),
        ("Sheet", line(signature_of(record, in_utc))),
        *((f"Version {version.number}", line(_version(version, in_utc))) for version in version_lines(record)),
        ("Run logs", ", ".join(line(r.log_file) for r in result.robots if r.log_file) or NOTHING),
    ]


def _version(version: VersionLine, in_utc: bool) -> str:
    """Return an earlier version of a signed sheet, in words."""
    found = (sheets.version_text(version, partial(date_time, in_utc=in_utc)), version.why,
             sheets.difference_text(version))
    return "; ".join(filter(None, found))


def _title(record: RunRecord) -> str:
    return sheets.run_name(record.benchmark, record.team, record.round, record.run)


# -- in the terminal --------------------------------------------------------------------------------


def sheet_lines(result: RunResult, in_utc: bool, strike: bool) -> Iterator[str]:
    """Return the lines of the sheet. `strike`: the terminal supports struck-through text."""
    record = result.record
    yield f"{line(_title(record))} ({line(record.identity)})"
    yield ""
    for name, value in facts(result, in_utc):
        yield f"{name + ':':14}{value}"
    for part in parts(result, in_utc):
        yield from _titled(part.title, [*_rows(part, strike), *map(line, part.lines)])
    for robot in result.robots:
        lines = link_lines(robot.link)
        yield from _titled(f"Link of {robot.robot} of team {robot.team}", lines) if lines else ()


def _titled(title: str, lines: Sequence[str]) -> Iterator[str]:
    yield from ("", line(title), *(f"  {text}" for text in lines))


def _rows(part: SheetPart, strike: bool) -> Iterator[str]:
    """Return the rows of a table as lines with aligned columns."""
    rows = (part.heads, *part.rows) if part.rows else ()
    cells = [[(cell,) if isinstance(cell, str) else cell for cell in row] for row in rows]
    widths = [max(len(" ".join(map(line, cell))) for cell in column) for column in zip(*cells)]
    for row in cells:
        texts = []
        for cell, width, class_ in zip(row, widths, part.classes):
            text = " ".join(f"{_STRUCK}{line(each)}{_PLAIN}" if strike and isinstance(each, Struck) else line(each)
                            for each in cell)
            space = " " * (width - len(" ".join(map(line, cell))))
            texts.append(space + text if class_ in ("value", "number") else text + space)
        yield "  ".join(texts).rstrip()


# -- as a page --------------------------------------------------------------------------------------


def sheet_page(
    result: RunResult, in_utc: bool, rules: Optional[Rules] = None, benchmark: str = "", appendix: bool = True,
    competition: Competition = NO_COMPETITION,
) -> str:
    """Return the page of a run. `rules`: how its benchmark is ranked; `benchmark`: what it is called."""
    record = result.record
    title = _title(record)
    front = front_of(record, rules, benchmark, in_utc, result.counts)._replace(competition=competition)
    body: List[Child] = [front_markup(front)]
    clock = clock_text(result)
    steady = without_step(result)[0] if clock else result
    if appendix:
        body.append(tag(
            "div", tag("h1", "Appendix"), tag("p", title),
            facts_table([*facts(result, in_utc), ("Run", record.identity)]),
            *(_markup(part) for part in parts(result, in_utc)),
            *(part for robot in steady.robots for part in _link(steady, robot, in_utc, clock)), class_="annex"))
    return page(f"{title} ({record.identity})", *body)


def _markup(part: SheetPart) -> Markup:
    rows = table(part.heads, [list(map(_cell, row)) for row in part.rows], part.classes) if part.rows else ""
    lines = tag("ul", *(tag("li", text) for text in part.lines)) if part.lines else ""
    return joined((tag("h2", part.title), rows, lines))


def _cell(cell: Cell) -> Child:
    if isinstance(cell, tuple):
        return joined((_cell(cell[0]), " ", *map(_cell, cell[1:])))
    if isinstance(cell, Struck):
        return tag("del", str(cell))
    return tag("span", str(cell), class_="bad" if isinstance(cell, Bad) else "mark") if isinstance(
        cell, (Bad, Highlighted)) else cell


def _link(result: RunResult, robot: RobotPart, in_utc: bool, clock: str) -> Iterator[Markup]:
    lines = link_lines(robot.link)
    if not lines:
        return
    record = result.record
    begin = min(record.opened_utc, robot.link[0].utc)
    end = max(record.closed_utc, robot.link[-1].utc)
    rows = LinkRows(box_states(result, robot.port, end), robot_states(result, robot.port, end))
    yield tag("h2", f"Link of {robot.robot} of team {robot.team}")
    yield link_plot(robot.link, begin, end, rows, in_utc)
    if clock:
        yield tag("p", f"{clock}. The picture is as if it had not been.")
    yield joined(tag("p", line) for line in lines)
    yield tag("p", "docs/results.md explains how each number is measured and what its limits are.",
              class_="small")
