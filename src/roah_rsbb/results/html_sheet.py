"""A run's score sheet as a page that can be printed."""

from typing import Iterator, List, Tuple

from roah_rsbb.core.scoring.records import RunRecord, ScoreEntry, grouped
from roah_rsbb.results.link_plot import Rows, link_plot
from roah_rsbb.results.link_summary import link_lines
from roah_rsbb.results.page import Child, Markup, facts_table, joined, page, table, tag
from roah_rsbb.results.run_result import RobotPart, RunResult
from roah_rsbb.results.story import Section, box_states, robot_states, sections
from roah_rsbb.results.text_sheet import change_text, facts, withdrawn_text
from roah_rsbb.wording import result_texts
from roah_rsbb.wording.module_scores import by_group
from roah_rsbb.wording.result_texts import moment

_SIGNERS = ("Referee: name, date, signature", "Team: name, date, signature")


def sheet_page(result: RunResult, in_utc: bool) -> str:
    """The page of a run."""
    record = result.record
    title = f"{record.benchmark}, team {record.team}, round {record.round}, run {record.run}"
    body: List[Child] = [
        tag("h1", title),
        tag("p", "Score sheet" if record.sign_off else "Score sheet, not signed off: it may still change"),
        facts_table(_facts(result, in_utc)),
        *_items(record), *_modules(record), *_history(record, in_utc), *_stops(record, in_utc),
        tag("div", *(tag("div", signer) for signer in _SIGNERS), class_="signatures"),
    ]
    annex = [_section(section, in_utc) for section in sections(result)]
    annex += [part for robot in result.robots for part in _link(result, robot, in_utc)]
    if annex:
        body.append(tag("div", tag("h1", "What happened"), tag("p", title), *annex, class_="annex"))
    return page(f"{title} ({record.identity})", *body)


def mark(text: str) -> Markup:
    """A word that stands out."""
    return tag("span", text, class_="mark")


def _facts(result: RunResult, in_utc: bool) -> List[Tuple[str, Child]]:
    return [*facts(result, in_utc), ("Run", result.record.identity)]


def _items(record: RunRecord) -> Iterator[Markup]:
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


def _modules(record: RunRecord) -> Iterator[Markup]:
    groups = by_group(record.module_scores)
    if groups:
        yield tag("h2", "Scores of the benchmarking module")
    for group, lines in groups:
        yield tag("h3", group)
        yield table(("Value", "What"), [(line.value, line.name) for line in lines], ("value", ""))


def _history(record: RunRecord, in_utc: bool) -> Iterator[Markup]:
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


def _stops(record: RunRecord, in_utc: bool) -> Iterator[Markup]:
    if not record.stops:
        return
    yield tag("h2", "Ends")
    yield table(("When", "Who", "End", "Reason given"), [
        (moment(s.utc, in_utc), s.who, s.desc or result_texts.end_text(s.end_reason),
         f"{s.reason} ({s.reason_by})" if s.reason and s.reason_by else s.reason)
        for s in record.stops
    ], ("when", "who", "what"))


def _section(section: Section, in_utc: bool) -> Markup:
    several = any(h.robot for h in section.happenings)
    headings = ("When", "Who", *(("Robot",) if several else ()), "What")
    rows = [
        (result_texts.clock(h.utc, in_utc), h.who, *((h.robot,) if several else ()),
         tag("span", h.text, class_="bad") if h.bad else h.text)
        for h in section.happenings
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
    yield tag("p", "What each number rests on, and what it cannot know, is in the documentation (docs/results.md).",
              class_="small")
