"""A run's score sheet, for the terminal and as a page that can be printed."""

from typing import Iterator, List, Tuple

from roah_rsbb.core.scoring.records import RunRecord, ScoreEntry, grouped
from roah_rsbb.results.events import Section, box_states, robot_states, sections
from roah_rsbb.results.link_report import Rows, link_lines, link_plot
from roah_rsbb.results.page import Child, Markup, facts_table, joined, page, table, tag
from roah_rsbb.results.runs import RobotPart, RunResult
from roah_rsbb.wording import result_texts
from roah_rsbb.wording.module_scores import by_group
from roah_rsbb.wording.result_texts import line, moment, optional_moment

# Begin and end of struck-through text, on terminals that support it.
_STRUCK, _PLAIN = "\033[9m", "\033[29m"


def list_lines(records: List[RunRecord], in_utc: bool) -> Iterator[str]:
    """List all runs, one per line, below a line of headings."""
    rows = [("No.", "Connected", "Zone", "Benchmark", "Team", "Round", "Run", "Time", "Sheet", "State")]
    rows += [_row(number, record, in_utc) for number, record in enumerate(records, 1)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        yield "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip()


def _row(number: int, record: RunRecord, in_utc: bool) -> Tuple[str, ...]:
    return (
        str(number), moment(record.opened_utc, in_utc), line(record.zone), line(record.benchmark), line(record.team),
        str(record.round), str(record.run),
        result_texts.duration(record.elapsed_s) if record.started_utc else result_texts.NOTHING,
        "signed off" if record.sign_off else "open", line(result_texts.state_of(record)),
    )


def sheet_lines(result: RunResult, in_utc: bool, strike: bool) -> Iterator[str]:
    """Return the lines of the sheet. `strike`: the terminal supports struck-through text."""
    record = result.record
    yield (f"{line(record.benchmark)}, team {line(record.team)}, round {record.round}, run {record.run} "
           f"({line(record.identity)})")
    yield ""
    for name, value in facts(result, in_utc):
        yield f"{name + ':':14}{value}"
    yield from _items(record)
    yield from _history(record, in_utc, strike)
    yield from _stops(record, in_utc)
    for title, lines in by_group(record.module_scores):
        yield from _titled(f"Module's score: {line(title)}", [f"{line(s.name)}: {line(s.value)}" for s in lines])
    for section in sections(result):
        yield from _titled(section.title, [
            f"{result_texts.clock(h.utc, in_utc)}  {_by(h.who)}{line(h.robot) + ': ' if h.robot else ''}{line(h.text)}"
            for h in section.events
        ])
    for robot in result.robots:
        yield from _titled(f"Link of {line(robot.robot)} of team {line(robot.team)}", link_lines(robot.link))


def facts(result: RunResult, in_utc: bool) -> List[Tuple[str, str]]:
    """Return the basic data of a run: names and values."""
    record = result.record
    return [
        ("Zone", line(record.zone)),
        ("Robots", ", ".join(f"{line(r.robot)} of team {line(r.team)} (port {r.port})" for r in result.robots)
         or result_texts.robots_text(record)),
        ("Scheduled", moment(record.scheduled, in_utc)),
        ("Connected", moment(record.opened_utc, in_utc)),
        ("Started", optional_moment(record.started_utc, in_utc)),
        ("Disconnected", optional_moment(record.closed_utc, in_utc)),
        ("Time", result_texts.duration(record.elapsed_s) if record.started_utc else result_texts.NOTHING),
        ("End", line(result_texts.state_of(record))),
        ("Sheet", result_texts.sign_off_text(record, in_utc)),
        ("Run logs", ", ".join(line(r.log_file) for r in result.robots if r.log_file) or result_texts.NOTHING),
    ]


def _titled(title: str, lines: List[str]) -> Iterator[str]:
    if lines:
        yield ""
        yield title
        for text in lines:
            yield f"  {text}"


def _by(who: str) -> str:
    return f"[{line(who)}] " if who else ""


def _items(record: RunRecord) -> Iterator[str]:
    for group, items in grouped(record.items).items():
        yield from _titled(line(group), [
            f"{result_texts.item_value(item.kind, item.value, item.not_attempted):>13}  {line(item.desc)}"
            + ("  (CORRECTED)" if item.corrected else "")
            for item in items
        ])


def change_text(record: RunRecord, entry: ScoreEntry) -> str:
    """The old and the new value of an entry."""
    kind = next((i.kind for i in record.items if (i.group, i.desc) == (entry.group, entry.desc)), "uint")
    old = result_texts.item_value(kind, entry.old, entry.old_not_attempted)
    return f"{old} -> {result_texts.item_value(kind, entry.value, entry.not_attempted)}"


def withdrawn_text(entry: ScoreEntry, in_utc: bool) -> str:
    """Who withdrew an entry, when and why."""
    by = f" by {line(entry.withdrawn_by)}" if entry.withdrawn_by else ""
    note = f": {line(entry.withdrawn_note)}" if entry.withdrawn_note else ""
    mark = ", a correction" if entry.withdrawal_corrects else ""
    return f"withdrawn{by}, {moment(entry.withdrawn_utc, in_utc)}{mark}{note}"


def _history(record: RunRecord, in_utc: bool, strike: bool) -> Iterator[str]:
    def shown(entry: ScoreEntry) -> str:
        mark = "CORRECTION: " if entry.correction else ""
        note = f" ({line(entry.note)})" if entry.note else ""
        text = f"{mark}{_by(entry.who)}{line(entry.group)}: {line(entry.desc)}: {change_text(record, entry)}{note}"
        if entry.withdrawn_utc:
            struck = f"{_STRUCK}{text}{_PLAIN}" if strike else text
            text = f"{struck}  -- {withdrawn_text(entry, in_utc)}"
        return f"{entry.number:3}  {moment(entry.utc, in_utc)}  {text}"

    yield from _titled("History of the score sheet", [shown(entry) for entry in record.history])


def _stops(record: RunRecord, in_utc: bool) -> Iterator[str]:
    yield from _titled("Ends", [
        f"{moment(s.utc, in_utc)}  {_by(s.who)}{line(s.desc) or result_texts.end_text(s.end_reason)}"
        + (f"; reason given{' by ' + line(s.reason_by) if s.reason_by else ''}: {line(s.reason)}" if s.reason else "")
        for s in record.stops
    ])


# -- as a page --------------------------------------------------------------------------------------


_SIGNERS = ("Referee: name, date, signature", "Team: name, date, signature")


def sheet_page(result: RunResult, in_utc: bool) -> str:
    """Return the page of a run."""
    record = result.record
    title = f"{record.benchmark}, team {record.team}, round {record.round}, run {record.run}"
    body: List[Child] = [
        tag("h1", title),
        tag("p", "Score sheet" if record.sign_off else "Score sheet, not signed off: may still change"),
        facts_table(_page_facts(result, in_utc)),
        *_items_markup(record), *_modules_markup(record), *_history_markup(record, in_utc),
        *_stops_markup(record, in_utc),
        tag("div", *(tag("div", signer) for signer in _SIGNERS), class_="signatures"),
    ]
    annex = [_section(section, in_utc) for section in sections(result)]
    annex += [part for robot in result.robots for part in _link(result, robot, in_utc)]
    if annex:
        body.append(tag("div", tag("h1", "What happened"), tag("p", title), *annex, class_="annex"))
    return page(f"{title} ({record.identity})", *body)


def mark(text: str) -> Markup:
    """A highlighted word."""
    return tag("span", text, class_="mark")


def _page_facts(result: RunResult, in_utc: bool) -> List[Tuple[str, Child]]:
    return [*facts(result, in_utc), ("Run", result.record.identity)]


def _items_markup(record: RunRecord) -> Iterator[Markup]:
    if not record.items:
        return
    yield tag("h2", "Scores of the referee")
    for group, items in grouped(record.items).items():
        yield tag("h3", group)
        yield table(("Value", "Item", ""), [
            (
                result_texts.item_value(i.kind, i.value, i.not_attempted), i.desc,
                mark("corrected") if i.corrected else "",
            )
            for i in items
        ], ("value", "", ""))


def _modules_markup(record: RunRecord) -> Iterator[Markup]:
    groups = by_group(record.module_scores)
    if groups:
        yield tag("h2", "Scores of the benchmarking module")
    for group, lines in groups:
        yield tag("h3", group)
        yield table(("Value", "What"), [(line.value, line.name) for line in lines], ("value", ""))


def _history_markup(record: RunRecord, in_utc: bool) -> Iterator[Markup]:
    if not record.history:
        return
    yield tag("h2", "History of the score sheet")
    yield table(("No.", "When", "Who", "What", "Change", "Note"), [
        _change(record, entry, in_utc) for entry in record.history
    ], ("number", "when", "who", "what", "change"))


def _change(record: RunRecord, entry: ScoreEntry, in_utc: bool) -> Tuple[Child, ...]:
    cells = (f"{entry.group}: {entry.desc}", change_text(record, entry).replace("->", "→"), entry.note)
    what, change, note = (tag("del", cell) if entry.withdrawn_utc else cell for cell in cells)
    if entry.correction:
        what = joined((mark("correction"), " ", what))
    if entry.withdrawn_utc:
        note = joined((note, " ", mark("withdrawn"), " ", withdrawn_text(entry, in_utc)))
    return str(entry.number), moment(entry.utc, in_utc), entry.who, what, change, note


def _stops_markup(record: RunRecord, in_utc: bool) -> Iterator[Markup]:
    if not record.stops:
        return
    yield tag("h2", "Ends")
    yield table(("When", "Who", "End", "Reason given"), [
        (moment(s.utc, in_utc), s.who, s.desc or result_texts.end_text(s.end_reason),
         f"{s.reason} ({s.reason_by})" if s.reason and s.reason_by else s.reason)
        for s in record.stops
    ], ("when", "who", "what"))


def _section(section: Section, in_utc: bool) -> Markup:
    several = any(h.robot for h in section.events)
    headings = ("When", "Who", *(("Robot",) if several else ()), "What")
    rows = [
        (result_texts.clock(h.utc, in_utc), h.who, *((h.robot,) if several else ()),
         tag("span", h.text, class_="bad") if h.bad else h.text)
        for h in section.events
    ]
    return joined((tag("h2", section.title), table(headings, rows, ("time", "who"))))


def _link(result: RunResult, robot: RobotPart, in_utc: bool) -> Iterator[Markup]:
    lines = link_lines(robot.link)
    if not lines:
        return
    record = result.record
    begin = min(record.opened_utc, robot.link[0].utc)
    end = max(record.closed_utc, robot.link[-1].utc)
    rows = Rows(box_states(result, robot.port, end), robot_states(result, robot.port, end))
    yield tag("h2", f"Link of {robot.robot} of team {robot.team}")
    yield link_plot(robot.link, begin, end, rows, in_utc)
    yield joined(tag("p", line) for line in lines)
    yield tag("p", "docs/results.md explains how each number is measured and what its limits are.",
              class_="small")
