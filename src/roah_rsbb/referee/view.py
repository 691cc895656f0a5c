"""The lines that the terminal referee prints. Pure text: no ROS, no terminal.

Colour is never the only sign: words say the same. Text from robots and configuration files is escaped (`escaped`), so
that it cannot send commands to the terminal.
"""

import json
import re
from functools import partial
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document
from roah_rsbb.model.fields import Field
from roah_rsbb.model.records import ScoreValue, SheetPoints
from roah_rsbb.model.results import EventSeen, JudgedRun, Judging, ObjectionLine, RunLine, RunSheet
from roah_rsbb.model.zone import CONNECTED, ENDED, RUNNING, Event, RobotInRun, SheetItem, Switches, ZoneSeen
from roah_rsbb.referee.state import Change, asked_in, lines_of, off_in, silence_s, zones_of
from roah_rsbb.referee.words import form_words
from roah_rsbb.wording import judging, schedule, sheets, times
from roah_rsbb.wording.device import role_text
from roah_rsbb.wording.judging import Judged
from roah_rsbb.wording.texts import escaped
from roah_rsbb.wording.timeline import corrections, timeline_line
from roah_rsbb.wording.times import clock_lines, clock_of
from roah_rsbb.wording.whole_box import ROBOT_COLUMNS, LinkQuality, robot_rows

# SGR codes (ECMA-48).
BOLD, RED, GREEN, YELLOW, CYAN = "1", "1;31", "1;32", "1;33", "1;36"
_PHASE_COLOURS = {RUNNING: GREEN, CONNECTED: CYAN, ENDED: YELLOW}
# The core's log lines begin with their own time, which is more exact than the time of publication.
_CLOCK = re.compile(r"(\d\d:\d\d:\d\dZ )?(.*)", re.DOTALL)
# Largest width of the column of module scores, characters.
_WIDEST = 20
# Indentation below a title.
_IN = "    "


class Style(NamedTuple):
    """How things are shown: in colour or not, in local time or UTC."""

    in_colour: bool = False
    moments: times.Moments = times.Moments()

    def __call__(self, code: str, text: str) -> str:
        """Return text in a colour of the terminal, if there are colours."""
        return f"\x1b[{code}m{text}\x1b[0m" if self.in_colour else text


# -- a box ----------------------------------------------------------------------------------------


def status(box: Document, now: Now, style: Style, only: Optional[str] = None) -> List[str]:
    """Return all zones at a glance, the active robots and the box's warnings. `only`: the zone to show."""
    status_text = f": {escaped(box.box.own_status)}" if box.box.own_status else ""
    lines = [f"{style(BOLD, 'RSBB')} at {escaped(box.box.host)}:{box.box.port}, "
             f"{style.moments.with_zone(now.utc)}{status_text}"]
    lines += warning_lines(box, style)
    lines += ["", *_robots(box, now)]
    for zone in zones_of(box):
        if only in (None, zone.zone):
            lines += ["", *zone_lines(zone, now, style)]
    return lines


def _robots(box: Document, now: Now) -> List[str]:
    """Return the active robots in the table that panels and pages have."""
    links = LinkQuality()
    links.look(box, now.mono)
    rows = [tuple(map(escaped, row)) for row in robot_rows(box, now.mono, links)]
    return ["Active robots:", *(_IN + line for line in _table([ROBOT_COLUMNS, *rows]))] if rows else [
        "Active robots: none"]


def _table(rows: Sequence[Sequence[str]]) -> List[str]:
    widths = [max(map(len, column)) for column in zip(*rows)]
    return ["  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in rows]


def warning_lines(box: Document, style: Style) -> List[str]:
    """Return the warnings of the whole box."""
    return [style(RED, f"WARNING: {escaped(text)}") for text in box.box.warnings]


_STATE_COLOURS = {"running": GREEN, "connected": CYAN, "ended": YELLOW, "next": BOLD}


def schedule_lines(events: Sequence[EventSeen], style: Style) -> List[str]:
    """Return a table of events, with the numbers that they have in their zones."""
    lines = _table([("Zone", "No.", "Scheduled", "Begins", "Late", "Event", "State", "Score", "Sheet"),
                    *(_event_row(event, style.moments.in_utc) for event in events)])
    return lines[:1] + [
        style(_STATE_COLOURS[event.state], line) if event.state in _STATE_COLOURS else line
        for event, line in zip(events, lines[1:])
    ]


def _event_row(event: EventSeen, in_utc: bool) -> Tuple[str, ...]:
    begins = "" if event.state == "skipped" else times.formatted(event.begins_utc_s, "%H:%M", in_utc)
    estimate = "~" if event.state in ("next", "later", "connected") else ""
    return (
        escaped(event.zone), f"{event.number}{'*' if event.current else ''}",
        times.formatted(event.scheduled_utc_s, "%Y-%m-%d %H:%M", in_utc), estimate + begins,
        schedule.delay_text(event.late_s),
        _which(event), schedule.state_text(event),
        escaped(event.score), schedule.sheet_text(event),
    )


def zone_lines(zone: ZoneSeen, now: Now, style: Style) -> List[str]:
    """Return a zone in a few lines."""
    event = zone.event
    lines = [
        f"{style(BOLD, escaped(zone.zone))}: {_phase(zone, style)}",
        *(_IN + line for line in _times(zone, now, style)),
        f"{_IN}{escaped(event.name)}: {escaped(event.desc)}",
        f"{_IN}{_which(event)}, scheduled "
        + style.moments.scheduled(event.scheduled, now.utc) + (" UTC" if style.moments.in_utc else ""),
    ]
    lines += [
        _IN + (style(RED, escaped(line)) if line.startswith("WARNING") else escaped(line))
        for text in zone.lines for line in lines_of(text)
    ]
    if zone.robot is not None:
        lines.append(_IN + _robot(zone.robot, now))
    if zone.operation:
        lines.append(_IN + style(YELLOW, to_do(zone.manual_operation, asked_in(zone))))
    if zone.switches is not None:
        lines.append(_IN + switches_line(zone.switches, style))
    allowed = [command for command, reasons in off_in(zone).items() if not reasons]
    return [*lines, f"{_IN}allowed now: {', '.join(allowed) or 'nothing'}"]


def zone_report(zone: ZoneSeen, now: Now, style: Style) -> List[str]:
    """Return a zone in full: also why each command is refused, its score sheet and its online data."""
    lines = zone_lines(zone, now, style)
    for command, reasons in off_in(zone).items():
        lines += [f"{_IN}no {command}: {escaped(reason)}" for reason in reasons]
    if zone.all_robots is not None:
        lines += [f"{_IN}robot {escaped(robot)}" for robot in zone.all_robots.robots]
    if zone.log_file:
        lines.append(f"{_IN}log: {escaped(zone.log_file)}")
    if zone.items or zone.module_scores:
        lines += ["", *score_sheet(zone, style)]
    if zone.online_data:
        online_data = style.moments.lines(zone.online_data, now.utc)
        lines += ["", "Online data:", *(_IN + escaped(line) for line in lines_of(online_data))]
    return lines


def to_do(text: str, fields: Sequence[Field]) -> str:
    """Return what the referee is asked to do, and the possible answers."""
    text = f"TO DO by the referee: {escaped(text)}"
    return f"{text} ({escaped(form_words(fields))})" if fields else text


def switches_line(switches: Switches, style: Style) -> str:
    """HOMF: return what was entered, and whether the referee must confirm it."""
    on = ", ".join(map(str, switches.on)) or "none"
    text = f"switches that are on: {on}; damaged: {switches.damaged}"
    return f"{text}; {style(YELLOW, 'TO DO by the referee: enter what changed, and confirm')}" if switches.to_confirm \
        else text


def score_sheet(zone: ZoneSeen, style: Style) -> List[str]:
    """Return all scoring items with their numbers and values by group, then the benchmarking module's score."""
    lines = [f"Score sheet: {_which(zone.event)}", *item_lines(zone.items, zone.points, style)]
    if not zone.items:
        lines.append(f"{_IN}no scoring items for the referee")
    return lines + _module_sheet(zone, style)


def item_lines(items: Sequence[SheetItem], points: Optional[SheetPoints], style: Style, mark: str = "") -> List[str]:
    """Return the items of a sheet with their numbers, by group, and its points. `mark`: behind corrected items."""
    lines = []
    for number, item in enumerate(items, 1):
        if number == 1 or item.group != items[number - 2].group:
            lines.append(f"{_IN}{escaped(item.group)}")
        lines.append(_sheet_line(number, item, style) + (mark if item.corrected else ""))
    total = sheets.points_text(points)
    lines += [f"{_IN}{_IN}{escaped(step)}" for step in sheets.steps_text(points)]
    return [*lines, f"{_IN}{style(BOLD, escaped(total))}"] if total else lines


def _module_sheet(zone: ZoneSeen, style: Style) -> List[str]:
    lines = ["Score of the benchmarking module"] if zone.module_scores else []
    for title, group in sheets.scores_by_group(zone.module_scores):
        lines.append(f"{_IN}{escaped(title)}")
        width = min(max(len(escaped(line.value)) for line in group), _WIDEST)
        lines += [f"{_IN}{_IN}{style(BOLD, escaped(line.value).rjust(width))}  {escaped(line.name)}" for line in group]
    return lines


def _sheet_line(number: int, item: SheetItem, style: Style) -> str:
    """Return the line of a scoring item in its sheet: number, value, points, text and ratings."""
    value = f"{escaped(sheets.item_text(item)):>5}"
    marked = sheets.is_marked(item.value, item.text) or item.not_attempted
    points = f"{item.points:>8}" if item.points else ""
    ratings = sheets.ratings_text(zip(item.judges, item.ratings))
    more = f" ({escaped(ratings)})" if ratings else ""
    if item.late:
        more += style(YELLOW, f" (entry {', '.join(map(str, item.late))}: after the time limit, does not count)")
    return f"{_IN}{number:4}  {style(BOLD, value) if marked else value}{points}  {escaped(item.desc)}{more}"


def item_line(item: SheetItem) -> str:
    """Return a scoring item and its value in one line."""
    why = f" ({escaped(item.void)})" if item.void else ""
    return f"{escaped(item.group)}: {escaped(item.desc)}: {sheets.item_text(item)}{why}"


def _which(event: Union[Event, EventSeen, RunLine]) -> str:
    return sheets.run_name(escaped(event.code), escaped(event.team), event.round, event.run)


def _phase(zone: ZoneSeen, style: Style) -> str:
    word = escaped(sheets.phase(zone.phase, zone.end_reason))
    return style(_PHASE_COLOURS.get(zone.phase, BOLD), word)


def _times(zone: ZoneSeen, now: Now, style: Style) -> List[str]:
    """Return the times of the run as the panels show them, and whether it is paused."""
    shown = clock_of(zone.clock, zone.phase, now.mono)
    pause = [style(YELLOW, escaped(shown.pause))] if shown.pause else []
    return [*pause, escaped(", ".join(clock_lines(shown._replace(pause=""))))]


def _robot(robot: RobotInRun, now: Now) -> str:
    skew = "not known" if robot.skew is None else times.skew(robot.skew)
    heard = f"heard {times.ago(silence_s(robot.silent_since, now))}" if robot.heard else (
        "never heard on its private channel")
    state = escaped(robot.robot_state) or "no state yet"
    return f"robot {escaped(robot.robot)}: {state}, skew {skew}, {heard} (UDP port {robot.port})"


# -- runs, score sheets and judges ------------------------------------------------------------------


def run_lines(runs: Sequence[RunLine], style: Style) -> List[str]:
    """Return a line for each run of a zone."""
    return [_run_line(run, style) for run in runs] or ["no run is connected or over"]


def _run_line(run: RunLine, style: Style) -> str:
    when = "now      " if run.closed_utc_s is None else style.moments.stamp(run.closed_utc_s)
    score = f"  {escaped(run.score)}" if run.score else ""
    return f"{when}  {escaped(run.identity)}  {_which(run)}: {_run_state(run, style)}{score}"


def _run_state(run: RunLine, style: Style) -> str:
    state = sheets.run_state(run.started_utc_s, run.closed_utc_s, run.end_reason)
    parts = [escaped(sheets.with_counting(state, run.counts))]
    if run.corrected and not run.versions:
        parts.append(style(YELLOW, sheets.CORRECTED))
    if run.closed_utc_s is not None:
        parts.append(sheets.signature(run.signed_utc_s, escaped(run.signed_by), style.moments.stamp, run.versions))
    return ", ".join(parts)


def sheet_lines(sheet: RunSheet, style: Style) -> List[str]:
    """Return the lines of a score sheet, its history and the run's ends."""
    lines = [_run_line(sheet.run, style)]
    if sheet.run.end_reason:
        lines.append(f"{_IN}time {times.elapsed(sheet.elapsed_s)}")
    lines += item_lines(sheet.items, sheet.points, style, f"  {style(YELLOW, f'({sheets.CORRECTED})')}")
    if sheet.history:
        lines.append("History")
    for entry in sheet.history:
        words = sheets.EntryTexts(*map(escaped, sheets.entry_texts(entry, style.moments.stamp)))
        lines.append(f"{_IN}{words.number:>4}  {sheets.entry_line(words, partial(style, YELLOW))}")
    if sheet.ends:
        lines.append("Ends")
    for end in sheet.ends:
        who = f" ({escaped(sheets.person(end.who))})" if end.who else ""
        reason = escaped(sheets.stop_reason(end.reason, end.reason_by, end.who))
        lines.append(f"{_IN}{end.number:4}  {style.moments.stamp(end.utc_s)} {escaped(end.desc)}{who}"
                     + (f": {style(BOLD, reason)}" if reason else ""))
    corrected = corrections(sheet.timeline, style.moments.stamp)
    return lines + ["Corrections"] * bool(corrected) + [_IN + escaped(timeline_line(item)) for item in corrected]


def judged_lines(run: Optional[RunLine], shown: JudgedRun, utc_s: float, style: Style) -> List[str]:
    """Return the lines of a run: the progress of its judges, their values side by side, and objections. `run`: None if
    the box no longer lists it."""
    lines = progress_lines(run, shown.judging, utc_s, style)
    group = None
    for item in judging.judged_of(shown):
        if item.group != group:
            group = item.group
            lines.append(f"{_IN}{escaped(group)}")
        lines += _judged_item(item, style)
    if shown.objections:
        lines.append("Objections")
    return lines + [line for one in judging.objections_of(shown) for line in _objection(one, style)]


def progress_lines(run: Optional[RunLine], one: Judging, utc_s: float, style: Style, before: str = "") -> List[str]:
    """Return the progress of the judges of a run, below its name; `before`: what stands before that."""
    def when(moment_utc_s: float) -> str:
        return style.moments.scheduled(moment_utc_s, utc_s) + ("Z" if style.moments.in_utc else "")

    name = escaped(one.identity)
    if run is not None:
        name = f"{_which(run)}  {name}"
    known = [judging.missing_text(one), judging.publication_text(one, utc_s, when)]
    differences = judging.differences_text(one)
    lines = [f"{_IN}{escaped(line)}" for line in [*map(judging.judge_line, one.judges), *filter(None, known)]]
    return [before + name, *lines, *([f"{_IN}{style(YELLOW, differences)}"] if differences else [])]


def _judged_item(item: Judged, style: Style) -> List[str]:
    given = ", ".join(f"{escaped(each.judge)} {escaped(each.shown)}" for each in item.given)
    shown = escaped(judging.outcome_text(item))
    value = style(YELLOW if item.outcome == judging.DIFFER else BOLD, shown)
    settled = judging.settled_text(item)
    return [f"{_IN}{item.number:4}  {escaped(item.item)}: {value}" + (f"  ({given})" if given else ""),
            *([f"{_IN}      {escaped(settled)}"] if settled else [])]


def _objection(one: ObjectionLine, style: Style) -> List[str]:
    answer = judging.answer_text(one)
    who = f" ({escaped(one.who)})" if one.who else ""
    at = f" (at {times.clock_time(one.second)} of the run)" if one.second else ""
    return [f"{_IN}{one.number:4}  {style.moments.stamp(one.utc_s)} {escaped(one.by)}: {escaped(one.text)}{at}{who}",
            f"{_IN}      {escaped(answer) if answer else style(YELLOW, 'not answered')}"]


# -- paired devices ---------------------------------------------------------------------------------


def device_lines(found: Sequence[Dict[str, Any]], style: Style) -> List[str]:
    """Return a line for each paired phone and tablet."""
    return [
        f"{one['id']}  {escaped(one['person'])}, {escaped(role_text(one['role'], one['zone']))}, "
        f"{escaped(one['device'])}: "
        + ("connected" if one["connected"] else f"seen {style.moments.stamp(one['seen'] or one['paired'])}")
        for one in found
    ] or ["no device is paired"]


# -- changes --------------------------------------------------------------------------------------


def change_line(change: Change, style: Style) -> str:
    """Return a change in one line with its time; empty if the core's log has it already."""
    text = _WRITERS[change.kind](change.facts, style)
    if not text:
        return ""
    clock, text = _CLOCK.match(text).groups()
    where = f"{escaped(change.zone)}: " if change.zone else ""
    shown = style.moments.lines(clock, change.utc_s) if clock else style.moments.stamp(change.utc_s) + " "
    return f"{shown}{where}{text}"


def _core(facts: Dict, style: Style) -> str:
    why = f" ({escaped(facts['why'])})" if facts.get("why") else ""
    return {
        "silent": style(RED, "box SILENT: the state above is old; waiting for the box" + why),
        "back": style(GREEN, "box is back"),
        "restarted": style(YELLOW, "box was RESTARTED"),
    }[facts["what"]]


def _warning(facts: Dict, style: Style) -> str:
    text = escaped(facts["text"])
    return f"over: {text}" if facts["over"] else style(RED, f"WARNING: {text}")


def _robot_change(facts: Dict, style: Style) -> str:
    name = f"robot {escaped(facts['team'])} {escaped(facts['robot'])}"
    if facts["what"] == "came":
        return f"{name} is active, skew {times.skew(facts['skew_s'])}"
    return style(YELLOW, f"{name} is GONE: no longer heard")


def _event(facts: Dict, style: Style) -> str:
    which = sheets.run_name(escaped(facts["code"]), escaped(facts["team"]), facts["round"], facts["run"])
    return f"now at {which}"


def _state(facts: Dict, style: Style) -> str:
    parts = []
    if "phase" in facts["changed"]:
        phase = facts["phase"]
        whom = f" to {escaped(facts['robot'])} on UDP port {facts['port']}" if phase == CONNECTED else ""
        parts.append(style(_PHASE_COLOURS.get(phase, BOLD), escaped(sheets.phase(phase, facts["end_reason"]))) + whom)
    if "robot_state" in facts["changed"] and facts["robot_state"]:
        parts.append(f"robot is in {escaped(facts['robot_state'])}")
    return ", ".join(parts)


def _score(facts: Dict, style: Style) -> str:
    old, new = (sheets.item_text(SheetItem("", "", facts["type"], facts[value], facts[f"{old}not_attempted"],
                                           text=facts[f"{old}text"], unit=facts["unit"]))
                for value, old in (("old", "old_"), ("value", "")))
    return f"score: {escaped(facts['group'])}: {escaped(facts['item'])}: {old} → {style(BOLD, new)}"


def _online_data(facts: Dict, style: Style) -> str:
    clock, text = _CLOCK.match(facts["text"]).groups()
    return f"{clock or ''}{style(CYAN, 'online data')}: {escaped(text)}"


def _manual_operation(facts: Dict, style: Style) -> str:
    if not facts["operation"]:
        return "manual operation over"
    return style(YELLOW, to_do(facts["text"], facts["fields"]))


def _module_score(facts: Dict, style: Style) -> str:
    """Only the first value gets a line: some change twice a second, and the sheet has the last one."""
    if facts["value"] is None or not (facts["old"] is None or isinstance(facts["old"], (bool, str))):
        return ""
    score = ScoreValue(facts["group"], facts["name"], json.dumps(facts["value"]), facts["unit"], facts["desc"])
    line = sheets.score_line(score)
    where = f"{escaped(score.group)}: " if score.group else ""
    return f"module's score: {where}{escaped(line.name)}: {style(BOLD, escaped(line.value))}"


_WRITERS: Dict[str, Callable[[Dict, Style], str]] = {
    "core": _core,
    "warning": _warning,
    "robot": _robot_change,
    "event": _event,
    "state": _state,
    "score": _score,
    "manual_operation": _manual_operation,
    "switches": lambda facts, style: switches_line(Switches(**facts), style),
    "module_score": _module_score,
    "module_status": lambda facts, style: f"module: {escaped(facts['text'])}",
    "log": lambda facts, style: escaped(facts["text"]),
    "online_data": _online_data,
    "note": lambda facts, style: escaped(facts["text"]),
}
