"""A run's score sheet, for the terminal and as a page that can be printed."""

from functools import partial
from typing import Iterator, List, Optional, Tuple

from roah_rsbb.model.records import ItemRecord, RunRecord, StopRecord, ratings, submitted
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
from roah_rsbb.wording.timeline import TimelineItem, said_of, timeline, timeline_line
from roah_rsbb.wording.times import NOTHING, date_time, elapsed, optional_date_time, time_with_tenths

_JUDGES, _OBJECTIONS, _OUTAGES = "Sheets of the judges", "Objections", "Box away"
_TIMELINE = "Timeline"
# Begin and end of struck-through text, on terminals that support it.
_STRUCK, _PLAIN = "\033[9m", "\033[29m"


def sheet_lines(result: RunResult, in_utc: bool, strike: bool) -> Iterator[str]:
    """Return the lines of the sheet. `strike`: the terminal supports struck-through text."""
    record = result.record
    yield f"{line(_title(record))} ({line(record.identity)})"
    yield ""
    for name, value in facts(result, in_utc):
        yield f"{name + ':':14}{value}"
    yield from _items(record)
    yield from _history(record, in_utc, strike)
    yield from _titled(_TIMELINE, [line(timeline_line(item)) for item in _items_of_timeline(record, in_utc)])
    yield from _judges(record, in_utc)
    yield from _stops(record, in_utc)
    for title, lines in scores_by_group(record.module_scores):
        yield from _titled(f"Module's score: {line(title)}", [f"{line(s.name)}: {line(s.value)}" for s in lines])
    for section in sections(result):
        yield from _titled(section.title, [
            f"{time_with_tenths(h.utc, in_utc)}  {_by(h.who)}{line(h.robot) + ': ' if h.robot else ''}{line(h.text)}"
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
    found = sheets.version_text(version, _when(in_utc)), version.why, sheets.difference_text(version)
    return "; ".join(filter(None, found))


def _title(record: RunRecord) -> str:
    return sheets.run_name(record.benchmark, record.team, record.round, record.run)


def _titled(title: str, lines: List[str]) -> Iterator[str]:
    if lines:
        yield ""
        yield title
        for text in lines:
            yield f"  {text}"


def _by(who: str) -> str:
    return f"{line(sheets.person(who))}: " if who else ""


def _items(record: RunRecord) -> Iterator[str]:
    for group, items in sheets.grouped_shown(record.items).items():
        yield from _titled(line(group), [
            f"{line(sheets.in_words(item)):>13}{_points(item)}  {line(item.desc)}{_ratings(record, item)}"
            + (f"  ({sheets.CORRECTED})" if item.corrected else "")
            for item in items
        ])
    if record.points is not None:
        yield ""
        yield line(sheets.points_text(record.points))
        yield from (f"  {line(step)}" for step in sheets.steps_text(record.points))


def _points(item: ItemRecord) -> str:
    return f"{item.points:>10}" if item.points else ""


def _ratings(record: RunRecord, item: ItemRecord) -> str:
    given = sheets.ratings_text(ratings(record, item))
    return f" ({line(given)})" if given else ""


def _when(in_utc: bool) -> sheets.When:
    return partial(date_time, in_utc=in_utc)


def _entries(record: RunRecord, in_utc: bool) -> Iterator[sheets.EntryTexts]:
    """The history in words, in its order."""
    items = {item.key: item for item in record.items}
    for entry in record.history:
        item = items.get((entry.group, entry.desc))
        kind, unit = ("uint", "") if item is None else (item.kind, item.unit)
        yield sheets.entry_texts(sheets.history_entry(entry, kind, unit), _when(in_utc))


def _items_of_timeline(record: RunRecord, in_utc: bool) -> List[TimelineItem]:
    """Return what happened in a run, the earliest first."""
    return timeline(run_timeline(record), _when(in_utc))[::-1]


def _history(record: RunRecord, in_utc: bool, strike: bool) -> Iterator[str]:
    def shown(entry: sheets.EntryTexts) -> str:
        text = sheets.entry_line(entry._replace(withdrawn=""))
        if entry.withdrawn:
            text = f"{_STRUCK}{text}{_PLAIN}; {entry.withdrawn}" if strike else sheets.entry_line(entry)
        return f"{entry.number:>3}  {text}"

    entries = [sheets.EntryTexts(*map(line, entry)) for entry in _entries(record, in_utc)]
    yield from _titled("History of the score sheet", [shown(entry) for entry in entries])


def _judges(record: RunRecord, in_utc: bool) -> Iterator[str]:
    names = [line(sheet.judge) for sheet in submitted(record)]
    yield from _titled("Judges", [
        f"{line(each.item.desc)}: "
        + "; ".join(f"{name} {line(value)}" for name, value in zip(names, each.proposals))
        + f" → {line(sheets.in_words(each.item))}"
        + (f" (settled by {line(sheets.person(each.settlement.who))}: {line(each.settlement.reason)})"
           if each.settlement is not None else "")
        for each in judged_items(record)
    ])
    for title, lines in ((_JUDGES, act_lines(record)), (_OBJECTIONS, objection_lines(record))):
        yield from _titled(title, [
            f"{date_time(utc, in_utc)} {_by(who)}{line(text)}" for utc, who, text in lines])


def _stops(record: RunRecord, in_utc: bool) -> Iterator[str]:
    yield from _titled("Ends", [
        f"{date_time(stop.utc, in_utc)} {_by(stop.who)}{line(_end(stop))}"
        + (f": {line(_reason(stop))}" if stop.reason else "")
        for stop in record.stops
    ])
    yield from _titled(_OUTAGES, [f"{date_time(outage.utc, in_utc)} {line(sheets.outage_text(outage))}"
                                  for outage in record.outages])


def _end(stop: StopRecord) -> str:
    return stop.desc or sheets.end_reason(stop.end_reason)


def _reason(stop: StopRecord) -> str:
    return sheets.stop_reason(stop.reason, stop.reason_by, stop.who)


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
        annex = [
            tag("h1", "Appendix"), tag("p", title), facts_table(_page_facts(result, in_utc)),
            *_items_markup(record), *_modules_markup(record), *_timeline_markup(record, in_utc),
            *_history_markup(record, in_utc),
            *_judges_markup(record, in_utc), *_stops_markup(record, in_utc),
            *(_section(section, in_utc) for section in sections(result)),
            *(part for robot in steady.robots for part in _link(steady, robot, in_utc, clock)),
        ]
        body.append(tag("div", *annex, class_="annex"))
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
    has_points = record.points is not None
    points = dict(record.points.groups) if record.points is not None else {}
    for group, items in sheets.grouped_shown(record.items).items():
        yield tag("h3", f"{group}: {points[group]} points" if group in points else group)
        yield table(("Value", *(("Points",) if has_points else ()), "Item", ""), [
            (
                sheets.in_words(i), *((i.points,) if has_points else ()), f"{i.desc}{_ratings(record, i)}",
                mark(sheets.CORRECTED) if i.corrected else "",
            )
            for i in items
        ], ("value", *(("value",) if has_points else ()), "", ""))
    if record.points is not None:
        yield tag("p", sheets.points_text(record.points))
        steps = sheets.steps_text(record.points)
        if steps:
            yield tag("ul", *(tag("li", step) for step in steps))


def _modules_markup(record: RunRecord) -> Iterator[Markup]:
    groups = scores_by_group(record.module_scores)
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
        _change(entry) for entry in _entries(record, in_utc)
    ], ("number", "when", "who", "what", "change"))


def _timeline_markup(record: RunRecord, in_utc: bool) -> Iterator[Markup]:
    yield tag("h2", _TIMELINE)
    yield table(("When", "Clock", "Who", "What", "Points"), [
        (item.time, item.clock, ", ".join(filter(None, (item.who, item.role))),
         "; ".join(filter(None, (f"{item.text} {item.change}".rstrip(), item.note, said_of(item)))), item.points)
        for item in _items_of_timeline(record, in_utc)
    ], ("when", "number", "who"))


def _change(entry: sheets.EntryTexts) -> Tuple[Child, ...]:
    what, change, note = (
        tag("del", cell) if entry.withdrawn else cell for cell in (entry.item, entry.change, entry.note)
    )
    if entry.correction:
        what = joined((mark(entry.correction), " ", what))
    if entry.withdrawn:
        note = joined((note, " ", mark(entry.withdrawn)))
    return entry.number, entry.when, entry.who, what, change, note


def _judges_markup(record: RunRecord, in_utc: bool) -> Iterator[Markup]:
    judged = list(judged_items(record))
    if judged:
        names = [sheet.judge for sheet in submitted(record)]
        yield tag("h2", "Judges")
        yield table(("Item", *names, "Counts", "Settled"), [
            (each.item.desc, *each.proposals, sheets.in_words(each.item),
             f"{sheets.person(each.settlement.who)}: {each.settlement.reason}" if each.settlement is not None else "")
            for each in judged
        ], ("what", *("value" for _ in names), "value"))
    for title, lines in ((_JUDGES, act_lines(record)), (_OBJECTIONS, objection_lines(record))):
        if lines:
            yield tag("h2", title)
            yield table(("When", "Who", "What"), [
                (date_time(utc, in_utc), sheets.person(who), text) for utc, who, text in lines
            ], ("when", "who", "what"))


def _stops_markup(record: RunRecord, in_utc: bool) -> Iterator[Markup]:
    if record.outages:
        yield tag("h2", _OUTAGES)
        yield table(("When", "What"), [
            (date_time(outage.utc, in_utc), sheets.outage_text(outage)) for outage in record.outages], ("when", "what"))
    if not record.stops:
        return
    yield tag("h2", "Ends")
    yield table(("When", "Who", "End", "Reason given"), [
        (date_time(stop.utc, in_utc), sheets.person(stop.who), _end(stop), _reason(stop)) for stop in record.stops
    ], ("when", "who", "what"))


def _section(section: Section, in_utc: bool) -> Markup:
    several = any(h.robot for h in section.events)
    headings = ("When", "Who", *(("Robot",) if several else ()), "What")
    rows = [
        (time_with_tenths(h.utc, in_utc), sheets.person(h.who), *((h.robot,) if several else ()),
         tag("span", h.text, class_="bad") if h.bad else h.text)
        for h in section.events
    ]
    return joined((tag("h2", section.title), table(headings, rows, ("time", "who"))))


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
