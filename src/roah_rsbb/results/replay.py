"""The replay of a run as one HTML file, which needs neither a network nor a server (docs/results.md, "Replay").

It has everything that happened, and what was in force at each moment.

A track is a value over time: pairs of milliseconds since *connect* and the value from then on. The page
(resource/replay) takes the last pair of each track up to the moment that it shows, so that every jump is equally fast.
States and times are the journal's, and scores and points come from the core's own score sheet.

The page's own script is the only one that its content security policy lets the browser run. The strings of robots are
in a block of JSON, where `<` is escaped, and the script sets them as text only.
"""

import html
import re
import urllib.parse
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.journal.records import Kind
from roah_rsbb.model import run_log
from roah_rsbb.model.as_json import BadData, from_json
from roah_rsbb.model.records import ItemRecord, RunRecord, ScoreValue
from roah_rsbb.results.events import TITLES, SectionLine, Stretch, box_states, in_order, robot_states
from roah_rsbb.results.page import checksum, json_text, resource_texts
from roah_rsbb.results.runs import (
    RobotPart,
    RunMoment,
    RunResult,
    clock_text,
    file_name,
    run_moments,
    run_state_of,
    without_step,
)
from roah_rsbb.scoring.book import BookState, RunBook, form_of
from roah_rsbb.scoring.points import CountedSheet
from roah_rsbb.scoring.timeline import run_timeline
from roah_rsbb.wording import sheets
from roah_rsbb.wording.sheets import scores_by_group
from roah_rsbb.wording.texts import visible
from roah_rsbb.wording.timeline import said_of, timeline
from roah_rsbb.wording.times import date_time, offset_s

# The kinds of entries of which the page shows the newest one, with their labels.
LATEST = {
    run_log.GOAL: "Last goal", run_log.RESULT: "Last result", run_log.MANUAL_OPERATION: "Last manual operation",
    run_log.SWITCHES: "Switches", run_log.NOTIFICATION: "Last notification",
    run_log.ACTIVATION_EVENT: "Last activation event", run_log.VISITOR: "Last visitor",
    run_log.COMMAND: "Last final command", Kind.NOTICE: "Last warning",
}
DISCONNECTED = "disconnected"
# A clock that was only read again differs by less than this (s).
_SAME_S = 0.002

Track = List[List[Any]]


def replay_data(result: RunResult, moments: Sequence[RunMoment], in_utc: bool) -> Dict[str, Any]:
    """Return what the page needs, as JSON. `moments`: the states of the run; empty: they were not recorded."""
    clock = clock_text(result)
    if clock:
        result, moments = without_step(result, moments)
    record = result.record
    begin, end = record.opened_utc, _end_utc(result, moments)
    events = list(in_order(result))
    titles = [title for title in TITLES if any(title == each for each, _ in events)]
    known = [moment for moment in moments if run_state_of(moment)]
    return {
        "title": visible(sheets.run_name(record.benchmark, record.team, record.round, record.run)),
        "facts": [
            ["Zone", visible(record.zone)], *([["Robots", visible(", ".join(record.robots))]] if record.robots else []),
            ["Connected", date_time(record.opened_utc, in_utc)], ["Run", visible(record.identity)],
            *([["Clock", f"{clock}. All times on this page are as if it had not been"]] if clock else []),
        ],
        "begin": round(begin * 1000),
        "length": max(1, _ms(end, begin)),
        "offset": 0 if in_utc else offset_s(begin),
        "kinds": titles,
        "events": [[_ms(event.utc, begin), titles.index(title), visible(sheets.person(event.who)),
                    visible(event.robot), visible(event.text), int(event.bad)] for title, event in events],
        "timeline": _timeline(record, in_utc),
        "latest": _latest([event for _, event in events]),
        "phase": _phases(record, known),
        "desc": _track(begin, ((m.utc, visible(str(run_state_of(m).get("desc", "")))) for m in known)),
        "clock": _clocks(begin, moments),
        **_sheet(record, known),
        "module": _track(begin, ((m.utc, _module_scores(m)) for m in known)),
        "robots": [_robot(result, robot, end) for robot in result.robots],
    }


# -- tracks -----------------------------------------------------------------------------------------


def _ms(utc: float, begin: float) -> int:
    return round((utc - begin) * 1000)


def _track(begin: float, values: Iterable[Tuple[float, Any]]) -> Track:
    """Return a track of values, each from its UTC on, without repetitions."""
    found: Track = []
    for utc, value in values:
        if found and found[-1][1] == value:
            continue
        found.append([_ms(utc, begin), value])
    return found


def _end_utc(result: RunResult, moments: Sequence[RunMoment]) -> float:
    """Return *disconnect*, or the newest time that is known of a run that is still connected."""
    if result.record.closed_utc:
        return result.record.closed_utc
    ends = [result.record.opened_utc, *(entry.utc for entry in result.entries), *(m.utc for m in moments)]
    return max([*ends, *(robot.link[-1].utc for robot in result.robots if robot.link)])


def _end_of(moment: RunMoment) -> str:
    """Return the name of the reason why the run has ended; empty: it has not."""
    return str(run_state_of(moment).get("end_reason") or "").lower()


def _phases(record: RunRecord, known: Sequence[RunMoment]) -> Track:
    """Return the phases, each with the end of the run in words."""
    phases = [(m.utc, [str(run_state_of(m).get("phase", "")).lower(), sheets.end_reason(_end_of(m))]) for m in known]
    closed = [(record.closed_utc, [DISCONNECTED, sheets.end_reason(record.end_reason)])] if record.closed_utc else []
    return _track(record.opened_utc, phases + closed)


def _latest(events: Sequence[SectionLine]) -> List[List[Any]]:
    """Return for each kind and robot: the label, the robot, and the indices of the events."""
    found: Dict[Tuple[str, str], List[int]] = {}
    for index, event in enumerate(events):
        if event.kind in LATEST:
            found.setdefault((event.kind, event.robot), []).append(index)
    order = list(LATEST)
    return [[LATEST[kind], visible(robot), indices]
            for (kind, robot), indices in sorted(found.items(), key=lambda item: (order.index(item[0][0]), item[0][1]))]


def _timeline(record: RunRecord, in_utc: bool) -> List[Dict[str, Any]]:
    """Return what happened in the run, the oldest first; a mark has the place of its item on the sheet."""
    places = {item.key: place for place, item in enumerate(form_of(record).items)}
    return [{
        "at": _ms(item.utc_s, record.opened_utc), "kind": item.kind, "clock": item.clock, "item": places.get(
            (item.group, item.desc)),
        **{name: visible(text) for name, text in (
            ("text", item.text), ("change", item.change), ("points", item.points), ("note", item.note),
            ("who", ", ".join(filter(None, (item.who, item.role)))), ("said", said_of(item)))},
    } for item in timeline(run_timeline(record), lambda utc: date_time(utc, in_utc))[::-1]]


# -- times ------------------------------------------------------------------------------------------


def _clocks(begin: float, moments: Sequence[RunMoment]) -> Track:
    """Return the times of the run, without those that follow from the ones before."""
    found: Track = []
    for moment in moments:
        at, clock = _ms(moment.utc, begin), moment.clock
        if not found or not _follows(found[-1], at, clock):
            found.append([at, clock])
    return found


# The times that pass, each with the field that says whether it does.
_PASSING = (("elapsed", "counting"), ("phase_elapsed", "counting"), ("goal_elapsed", "goal_counting"),
            ("setup_elapsed", "setup_counting"))
_TIMES = frozenset(("after_stop", *(name for name, _ in _PASSING)))


def _follows(last: List[Any], at: int, clock: Dict[str, Any]) -> bool:
    before, passed_s = last[1], (at - last[0]) / 1000
    if any(before.get(name) != clock.get(name) for name in {*before, *clock} - _TIMES):
        return False
    return all(
        abs(clock.get(name, 0.0) - before.get(name, 0.0) - (passed_s if before.get(counting) else 0.0)) < _SAME_S
        for name, counting in _PASSING
    )


# -- scores -----------------------------------------------------------------------------------------


def _sheet(record: RunRecord, known: Sequence[RunMoment]) -> Dict[str, Any]:
    """Return the items of the sheet, and the changes of each: text of the value, and points."""
    form = form_of(record)
    items: List[List[str]] = [[visible(item.group), visible(item.desc)] for item in form.items]
    values: List[Track] = [[] for _ in items]
    points: Track = []
    places = {item.key: place for place, item in enumerate(form.items)}
    for utc, counted in _counted(record, known):
        at = _ms(utc, record.opened_utc)
        for item in counted.items:
            track, shown = values[places[item.key]], _shown(item)
            if not track or track[-1][1] != shown:
                track.append([at, shown])
        total = "" if counted.points is None else counted.points.total
        if total and (not points or points[-1][1] != total):
            points.append([at, total])
    return {"items": items, "values": values, "points": points}


def _counted(record: RunRecord, known: Sequence[RunMoment]) -> Iterable[Tuple[float, CountedSheet]]:
    """Return the score sheet after each of its changes."""
    form, last = form_of(record), None
    for moment in known:
        state, end = run_state_of(moment).get("book"), _end_of(moment)
        if last is not None and last == (state, end):
            continue
        last = state, end
        try:
            yield moment.utc, RunBook(form, from_json(BookState, state)).counted(end)
        except BadData:
            continue  # a newer version wrote it: the sheet of the end is on the score sheet's page


def _shown(item: ItemRecord) -> List[str]:
    return [visible(sheets.in_words(item)), item.points]


def _module_scores(moment: RunMoment) -> List[List[str]]:
    """Return the scores of the benchmarking module: group, name and value."""
    scores = (moment.zone.get("for_module") or {}).get("scores", [])
    try:
        known = [from_json(ScoreValue, score) for score in scores]
    except BadData:
        return []
    return [[visible(group), visible(line.name), visible(line.value)]
            for group, lines in scores_by_group(known) for line in lines]


# -- robots -----------------------------------------------------------------------------------------


def _robot(result: RunResult, robot: RobotPart, end: float) -> Dict[str, Any]:
    begin = result.record.opened_utc
    return {
        "name": visible(f"{robot.robot} of team {robot.team}"),
        "event_name": visible(result.robot_at(robot.port)),
        "box": _states(begin, box_states(result, robot.port, end)),
        "robot": _states(begin, robot_states(result, robot.port, end)),
        "link": [
            [_ms(second.utc, begin), round(second.sample.gap_s, 1), second.sample.lost, second.sample.unanswered,
             _rounded(second.sample.round_trip_s), _rounded(second.sample.skew_s)] for second in robot.link
        ],
    }


def _rounded(seconds: Optional[float]) -> Optional[float]:
    return None if seconds is None else round(seconds, 3)


def _states(begin: float, stretches: Sequence[Stretch]) -> Track:
    return [[_ms(stretch.begin_utc, begin), visible(stretch.name)] for stretch in stretches]


# -- the page ---------------------------------------------------------------------------------------


_PART = re.compile("@([A-Z]+)@")


class PageParts(NamedTuple):
    """The files of which each page is made."""

    page: str
    style: str
    script: str


def page_parts(folder: str) -> PageParts:
    """Read the files in the package's folder resource/replay. Raises OSError."""
    return PageParts(*resource_texts(folder, "replay.html", "replay.css", "replay.js"))


def replay_name(number: int, record: RunRecord) -> str:
    """Return the file name of a run's replay. `number`: in the list of all runs."""
    return f"{file_name(number, record)}_replay.html"


def replay_of(
    reader: JournalReader, result: RunResult, parts: PageParts, in_utc: bool, warn: Callable[[str], None],
    video: str = "",
) -> str:
    """Return the page of a run. `video`: address of the video that it shows, if any."""
    moments = run_moments(reader, result.record.identity, warn)
    return replay_page(replay_data(result, moments, in_utc), parts, video)


def replay_page(data: Dict[str, Any], parts: PageParts, video: str = "") -> str:
    """Return the page with the data that `replay.replay_data` returns."""
    if video:
        data = {**data, "video": video if _is_address(video) else urllib.parse.quote(video)}
    values = {
        "POLICY": html.escape(_policy(parts, video)), "TITLE": html.escape(f"Replay: {visible(str(data['title']))}"),
        "STYLE": parts.style, "SCRIPT": parts.script, "DATA": json_text(data),
    }
    return _PART.sub(lambda match: values.get(match.group(1), match.group()), parts.page)


def _policy(parts: PageParts, video: str) -> str:
    return "; ".join((
        "default-src 'none'", f"script-src {checksum(parts.script)}", f"style-src {checksum(parts.style)}",
        f"media-src blob:{_source(video)}", "base-uri 'none'", "form-action 'none'",
    ))


def _is_address(video: str) -> bool:
    """Whether this is a web address, and not the path of a file, in which # and % have no meaning."""
    return video.startswith(("http://", "https://", "file:"))


def _source(video: str) -> str:
    """Return where the video may come from: its own site, or the place of the page."""
    if not video:
        return ""
    address = urllib.parse.urlsplit(video)
    if address.scheme not in ("http", "https") or not re.fullmatch(r"[A-Za-z0-9.:\[\]-]+", address.netloc):
        return " 'self' file:"
    return f" {address.scheme}://{address.netloc}"
