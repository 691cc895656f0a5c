"""The documents for the parts of the page of the whole box (docs/web.md, "The whole box"): each is made only while a
device shows its part. Texts are in the language of the reader. No I/O, no clock.

All lists are bounded, and what changes with time is made once a second at most: nothing here may delay STOP.
"""

import math
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.document.calls import RING
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document
from roah_rsbb.model.messages import DevicesSeen
from roah_rsbb.model.results import EventSeen, RunLine, RunSheet
from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.protocol import wire_seconds
from roah_rsbb.web.documents import Data
from roah_rsbb.web.pairing import JUDGE, Grant
from roah_rsbb.web.zone_documents import clock_page, is_urgent, run_name, sheet_page
from roah_rsbb.wording import schedule, sheets, stop, times, todo, whole_box
from roah_rsbb.wording.language import tr, tr_said
from roah_rsbb.wording.sheets import scores_by_group, with_counting
from roah_rsbb.wording.times import Moments

OVERVIEW, SCHEDULE, ROBOTS, RUNS, LOG, BOX = "overview", "schedule", "robots", "runs", "log", "box"
# The newest of each; of the schedule, those around the current events.
MAX_EVENTS, MAX_ROBOTS, MAX_RUNS, MAX_HISTORY = 200, 200, 50, 200
# Characters of the log that are sent at once. The page keeps what came before.
MAX_LOG = 6000
_MOMENTS = Moments(False)


class PartShown(NamedTuple):
    """What a part is made from."""

    document: Document
    zone: str  # the one that the device shows
    own: str  # the only one in which the device may act; empty: all
    now: Now
    links: whole_box.LinkQuality

    @property
    def second(self) -> int:
        """Changes once a second."""
        return math.floor(self.now.mono)

    def zones(self) -> List[ZoneSeen]:
        """The zones in which the device may act, in the order of the schedule."""
        document = self.document
        return [document.zones[name] for name in document.box.zones
                if name in document.zones and self.own in ("", name)]


class _Part(NamedTuple):
    made_of: Callable[[PartShown], Any]  # it is made again when this has changed
    make: Callable[[PartShown], Data]


def may_show(part: str, grant: Grant) -> bool:
    """Whether there is such a part for this device. A judge sees no values of others, and a referee has one zone."""
    return part in PARTS and grant.role != JUDGE and (part != OVERVIEW or not grant.zone)


# -- all zones --------------------------------------------------------------------------------------


def _overview(shown: PartShown) -> Data:
    return {"zones": [_tile(zone, shown.now.mono) for zone in shown.zones()]}


def _tile(zone: ZoneSeen, mono: float) -> Data:
    task, event = todo.todo(zone), zone.event
    return {
        "zone": zone.zone, "team": event.team, "event": f"{event.code} · {sheets.turn(event.round, event.run)}",
        "phase": zone.phase, "phase_text": sheets.marked_phase(zone.phase, zone.end_reason),
        "clock": clock_page(zone, mono), "todo": task.text,
        "is_urgent": is_urgent(task), "more": task.more,
    }


# -- the schedule -----------------------------------------------------------------------------------


def _leaving(shown: PartShown) -> Dict[str, str]:
    return {zone.zone: stop.leaving(zone) for zone in shown.zones()}


def _schedule(shown: PartShown) -> Data:
    events = [event for event in shown.document.events() if shown.own in ("", event.zone)]
    first = next((place for place, event in enumerate(events) if event.current), 0)
    begin = max(0, min(first - MAX_EVENTS // 3, len(events) - MAX_EVENTS))
    some = events[begin:begin + MAX_EVENTS]
    several_days = len({schedule.day_of(event) for event in some}) > 1
    current = [event for event in events if event.current]
    left = {zone.zone: schedule.left_unsigned(current, zone.zone) for zone in shown.zones()}
    return {
        "summary": schedule.summary(events), "hidden": len(events) - len(some), "leaving": _leaving(shown),
        "left": {zone: {"id": event.id, "name": _event_name(event), "score": tr_said(event.score)}
                 for zone, event in left.items() if event is not None},
        "events": [_event(event, current, several_days) for event in some],
    }


def _event(event: EventSeen, current: List[EventSeen], several_days: bool) -> Data:
    begins = "" if event.state == "skipped" else schedule.moment_text(event.begins_utc_s, several_days)
    has_begun = event.state in ("done", "running", "ended")
    return {
        "id": event.id, "zone": event.zone, "team": event.team, "day": schedule.day_of(event),
        "name": _event_name(event),
        "event": f"{event.code}, {sheets.turn(event.round, event.run)}",
        "when": schedule.moment_text(event.scheduled_utc_s, several_days),
        # An estimate has a mark that distinguishes it from a fact.
        "begins": begins if has_begun or not begins else f"~ {begins}", "late": schedule.delay_text(event.late_s),
        "state": schedule.state_text(event), "score": tr_said(event.score), "sheet": schedule.sheet_text(event),
        "current": event.current, "off": schedule.why_not(current, event),
        "shows": [show.value for show in schedule.Show if schedule.EventFilter(show=show).shows(event)],
    }


def _event_name(event: EventSeen) -> str:
    return sheets.run_name(event.code, event.team, event.round, event.run)


# -- robots -----------------------------------------------------------------------------------------


def _robots(shown: PartShown) -> Data:
    found = whole_box.robot_rows(shown.document, shown.now.mono, shown.links)
    return {"hidden": max(0, len(found) - MAX_ROBOTS), "robots": found[:MAX_ROBOTS]}


# -- the runs of a zone -----------------------------------------------------------------------------


def _runs(shown: PartShown) -> Data:
    runs = [run for run in shown.document.runs() if run.zone == shown.zone]
    return {"hidden": max(0, len(runs) - MAX_RUNS), "runs": [_run(run, shown) for run in runs[:MAX_RUNS]]}


def _run(run: RunLine, shown: PartShown) -> Data:
    judged = shown.document.judging.get(run.identity)
    unsaved = any(one.identity == run.identity for one in shown.document.box.unsaved)
    sheet = sheets.signature(run.signed_utc_s, run.signed_by, _MOMENTS.with_zone) if run.signed_utc_s else (
        sheets.sheet_state(run.closed_utc_s, None))
    return {
        "identity": run.identity, "revision": run.revision,
        "title": f"{_MOMENTS.scheduled(run.closed_utc_s or run.opened_utc_s, shown.now.utc)}  {run_name(run)}",
        "end": with_counting(sheets.run_state(run.started_utc_s, run.closed_utc_s, run.end_reason), run.counts),
        "score": tr_said(run.score), "sheet": "; ".join([*([f"⚠ {tr(sheets.NOT_SAVED)}"] if unsaved else []),
                            *([tr(sheets.CORRECTED)] if run.corrected else []), sheet]),
        "is_closed": run.closed_utc_s is not None, "is_signed": run.signed_utc_s is not None,
        "is_judged": judged is not None and judged.count > 0,
    }


def whole_sheet_page(sheet: RunSheet) -> Data:
    """Return the score sheet of a run with its history, the newest entry first, its ends and its module's scores."""
    run = sheet.run
    return {
        **sheet_page(sheet),
        "facts": [fact for fact in (times.elapsed(sheet.elapsed_s) if run.end_reason else "",
                                    ", ".join(sheet.robots)) if fact],
        "module": [[f"{group}: {line.name}", line.value] for group, lines in scores_by_group(sheet.module_scores)
                   for line in lines],
        "history": [
            {"number": entry.number, "is_withdrawn": entry.withdrawn_utc_s is not None,
             "text": sheets.entry_line(sheets.entry_texts(entry, _MOMENTS.time_of_day))}
            for entry in reversed(sheet.history[-MAX_HISTORY:])],
        "ends": [
            {"number": end.number, "reason": sheets.stop_reason(end.reason, end.reason_by, end.who),
             "text": " · ".join(filter(None, [_MOMENTS.time_of_day(end.utc_s), sheets.person(end.who),
                                              tr_said(end.desc)]))}
            for end in sheet.ends],
    }


# -- texts of a run ---------------------------------------------------------------------------------


def _log(shown: PartShown) -> Data:
    """Return the ends of the log and of the online data, which the page adds to what it has."""
    zone = shown.document.zones[shown.zone]
    return {"of": f"{zone.zone} {zone.event.id}", **{
        name: _MOMENTS.lines(_end_of(text), shown.now.utc)
        for name, text in (("log", zone.log), ("online", zone.online_data))}}


def _end_of(text: str) -> str:
    """Return the last lines of a text."""
    return text if len(text) <= MAX_LOG else text[-MAX_LOG:].partition("\n")[2]


# -- the box ----------------------------------------------------------------------------------------


def _box(shown: PartShown) -> Data:
    document, box = shown.document, shown.document.box
    return {
        "status": tr_said(box.own_status), "is_ok": box.status == "OK",
        "warnings": [tr_said(text) for text in box.warnings],
        "facts": [[tr(label), text] for label, text in zip(whole_box.BOX_FACTS, whole_box.box_facts(document))],
        "runs": whole_box.runs_in_progress(document.zones.values()),
        "tablet": [[tr(label), text] for label, (text, _) in zip(
            whole_box.TABLET_FACTS, whole_box.tablet_facts(box.tablet, shown.now, _MOMENTS),
        )] if box.tablet.heard else None,
    }


# -- the home devices -------------------------------------------------------------------------------


def devices_page(seen: DevicesSeen, now_s: float) -> Data:
    """Return the home devices as the page shows them, at a moment in UTC seconds."""
    found, (connection, reason) = seen.devices, whole_box.controller_text(seen.connected, seen.text)
    bell, rings = whole_box.bell_text(wire_seconds(found.bell), now_s, _MOMENTS)
    return {
        "connection": connection, "reason": reason, "is_connected": seen.connected,
        "devices": [_device(name, int(getattr(found, name))) for name in whole_box.DEVICES],
        "bell": {"device": RING, "name": tr(whole_box.BELL), "value": int(rings), "commands": [(tr(whole_box.RING), 1)],
                 "states": [bell] * 2},
    }


def _device(name: str, value: int) -> Data:
    return {
        "device": name, "name": whole_box.device_name(name), "value": value, "states": whole_box.device_states(name),
        "commands": whole_box.device_commands(name),
    }


def _day(shown: PartShown) -> str:
    return times.formatted(shown.now.utc, "%Y-%m-%d", in_utc=False)


PARTS: Dict[str, _Part] = {
    OVERVIEW: _Part(lambda shown: shown.second, _overview),
    SCHEDULE: _Part(lambda shown: (shown.document.schedule, shown.document.box.zones, _leaving(shown)), _schedule),
    ROBOTS: _Part(lambda shown: shown.second, _robots),
    RUNS: _Part(lambda shown: (
        shown.document.results, shown.document.judging, shown.document.box.unsaved, _day(shown)), _runs),
    LOG: _Part(lambda shown: shown.second, _log),
    BOX: _Part(lambda shown: shown.second, _box),
}


def part_name(part: str) -> str:
    """Return the name of a part's document."""
    return f"part.{part}"


def made_of(part: str, shown: PartShown) -> Tuple[Any, ...]:
    """Return what a part is made of: it is made again when that has changed."""
    return (shown.zone in shown.document.zones, PARTS[part].made_of(shown))


def part_page(part: str, shown: PartShown) -> Optional[Data]:
    """Return a part; None: its zone is gone."""
    return PARTS[part].make(shown) if shown.zone in shown.document.zones else None
