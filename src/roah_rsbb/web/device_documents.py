"""What paired devices are shown of the box, made from its document: a zone, its clock, its score sheet and what can be
done (docs/web.md, "Referees"), and the parts of the page of the whole box ("The whole box"). No I/O, no clock.

Texts are in the language of the reader. Documents are made only for zones, languages and parts that a connected device
shows, and again only if what they are made of has changed. All lists are bounded, and what changes with time is made
once a second at most: nothing here may delay STOP.
"""
import functools
import math
from typing import (
    Any,
    Callable,
    Dict,
    Iterable,
    List,
    NamedTuple,
    Optional,
    Sequence,
    Set,
    Tuple,
)

from roah_rsbb.document.calls import RING
from roah_rsbb.model.actions import READS, REFEREES
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document
from roah_rsbb.model.messages import DevicesSeen
from roah_rsbb.model.records import SheetPoints
from roah_rsbb.model.results import EventSeen, JudgedRun, Judging, RunLine, RunSheet, RunTimeline
from roah_rsbb.model.scoring import INCIDENTS
from roah_rsbb.model.zone import CONNECTED, ENDED, IDLE, RUNNING, Count, Event, RunClock, SheetItem, ZoneSeen
from roah_rsbb.protocol import wire_seconds
from roah_rsbb.web.limits import STUCK_S
from roah_rsbb.web.numbered import Key, Numbered, NumberedDocument
from roah_rsbb.web.pairing import DeviceSession, Grant
from roah_rsbb.web.public_documents import FIXED_TEXTS, Data, Store
from roah_rsbb.wording import judging, public, schedule, sheets, stop, times, todo, whole_box
from roah_rsbb.wording.language import number, tr, tr_said
from roah_rsbb.wording.sheets import scores_by_group, with_counting
from roah_rsbb.wording.timeline import captain_text, clock_text, corrections, page_item, timeline
from roah_rsbb.wording.times import Figure, Moments, clock_of, formatted
from roah_rsbb.wording.whole_box import LinkQuality

# Runs without judges that are over and not signed off. Of more, the page says how many there are.
MAX_UNSIGNED = 50
# Runs on the page of a team.
MAX_TEAM_RUNS = 20
# Items of a timeline. The sheet of the run has all.
MAX_TIMELINE = 100


class Absent(NamedTuple):
    """A paired device that may mark, and is not connected: marks may be waiting on it."""

    name: str  # who has it, and the role
    seen_utc: float  # UTC seconds: until then it was heard
    marked_utc: float = 0.0  # when its last mark came; 0: none


def zone_page(zone: ZoneSeen, document: Document, utc_s: float, absent: Sequence[Absent] = ()) -> Data:
    """Return everything about a zone but its running times. `utc_s`: the box's clock, see `moment`; `absent`: devices
    that may mark in this zone."""
    event, actions, moments, task = zone.event, zone.actions, Moments(False), todo.todo(zone)
    runs = [run for run in document.runs() if run.zone == zone.zone]
    waiting = [run for run in runs if run.is_unsigned]
    # Also older ones that judges score or that are published.
    unsigned = waiting[:MAX_UNSIGNED] + [run for run in waiting[MAX_UNSIGNED:] if run.identity in document.judging]
    judgings = {one.identity: one for one in judging.judgings_of(document, zone.zone)}
    reasons = [*zone.off("connect"), *zone.off("start")]  # the page shows them beside the commands
    # Those of the zone first: a robot may be moving. The one that says what to do now is not repeated.
    warnings = [tr_said(text) for text in (*zone.unsaid, *document.box.warnings)]
    return {
        "zone": zone.zone,
        "identity": zone.identity,
        "phase": zone.phase,
        "phase_text": sheets.phase(zone.phase, zone.end_reason),
        "end": zone.end_reason,
        "has_second_clock": bool(zone.clock.goal_limit or zone.clock.phases),
        "look": sheets.look(zone.phase, zone.end_reason),
        "title": f"{event.code}  {event.desc}",
        "team": event.team,
        "event_id": event.id,
        "event": f"{event.scheduled:.0f}/{event.team}/{event.round}/{event.run}",
        "facts": f"{sheets.turn(event.round, event.run)} · {moments.scheduled(event.scheduled, utc_s)}",
        "robot": zone.robot_name,
        "by_hand": zone.by_hand,
        "todo": task.text,
        "is_urgent": is_urgent(task),
        "leaving": stop.leaving(zone),
        "warnings": [text for text in warnings if text != task.text],
        "state": [said for line in zone.state if line not in reasons for said in [tr_said(line)] if said != task.text],
        "off": {name: [tr_said(reason) for reason in action.off] for name, action in actions.items()},
        "shown": {name: action.shown for name, action in actions.items()},
        "questions": {name: tr_said(action.question) for name, action in actions.items() if action.question},
        "robots": list(zone.robots_to_choose),
        "texts": {name: action.text for name, action in actions.items() if action.text},
        "fields": {name: [{**field.form(), "label": tr(field.label)} for field in action.fields]
                   for name, action in actions.items() if action.fields is not None},
        "switches": None if zone.switches is None else zone.switches._asdict(),
        "items": [item_page(item) for item in zone.items],
        "incidents": sheets.incidents_text(zone.items),
        "earlier": _earlier(zone, document.runs(), utc_s),
        **_sums(zone.points),
        "unsigned": [{**_unsigned_run(run, moments, utc_s, absent), "is_here": _is_of(run, event)} for run in unsigned],
        "proposed": [{"identity": run.identity, "title": _timed_name(run, moments, utc_s), "number": run.proposals,
                      "revision": run.revision} for run in runs if run.proposals],
        "unlisted": len(waiting) - len(unsigned),
        # First that of the run in the zone, so that no judge takes another one for it.
        "judging": [_judging(judgings[run.identity], run, moments, utc_s)
                    for run in sorted(runs, key=lambda run: run.identity != zone.identity)
                    if run.identity in judgings and (
                        run.closed_utc_s is None or run in unsigned or judgings[run.identity].open_objections)],
    }


def _earlier(zone: ZoneSeen, runs: Iterable[RunLine], utc_s: float) -> List[Data]:
    """Return the incidents in other runs of the team of the zone today: a warning may be the second one."""
    found = [run for run in runs if run.incidents and run.team == zone.event.team and run.identity != zone.identity]
    day = formatted(utc_s, "%Y-%m-%d", in_utc=False)
    return [{"run": f"{run.code}, {_MOMENTS.time_of_day(run.opened_utc_s)}",
             "text": sheets.incidents_said(run.incidents)}
            for run in found if formatted(run.opened_utc_s, "%Y-%m-%d", in_utc=False) == day]


def moment(document: Document, utc_s: float) -> Tuple[object, ...]:
    """Return what a page shows otherwise when only time passes: the day, and whose time for objections is over."""
    return (formatted(utc_s, "%Y-%m-%d", in_utc=False),
            *(one.identity for one in document.judging.values() if (one.objections_until_utc_s or 0.0) > utc_s))


def sheet_page(sheet: RunSheet) -> Data:
    """Return the score sheet of a run, as `zone_page` has that of the run in the zone."""
    return {"items": [item_page(item) for item in sheet.items], "incidents": sheets.incidents_text(sheet.items),
            **_sums(sheet.points)}


def _sums(points: Optional[SheetPoints]) -> Data:
    """Return the points of a sheet, in words and by group."""
    return {
        "points": sheets.points_text(points), "steps": sheets.steps_text(points),
        "total": "" if points is None else number(points.total),
        "groups": {} if points is None else {group.name: number(group.points) for group in points.groups},
    }


def _is_of(run: RunLine, event: Event) -> bool:
    """Whether a run is one of an event."""
    return (run.code, run.team, run.round, run.run) == (event.code, event.team, event.round, event.run)


def timeline_page(run: Optional[RunTimeline]) -> Optional[Data]:
    """Return what happened in a run, the latest first; None: there is no run."""
    if run is None:
        return None
    items = timeline(run, _MOMENTS.time_of_day)
    return {"identity": run.identity, "items": [page_item(item) for item in items[:MAX_TIMELINE]],
            "hidden": max(0, len(items) - MAX_TIMELINE)}


def clock_page(zone: ZoneSeen, mono: float) -> Data:
    """Return the times of the run in a zone at a moment of the box's clock."""
    clock = clock_of(zone.clock, zone.phase, mono)
    limit, spent_s = zone.clock.limit, zone.clock.spent(mono)
    return {"main": _figure(clock.main), "goal": None if clock.goal is None else _figure(clock.goal),
            "pause": clock.pause, "aside": clock.aside, "below": times.below_clock(zone.clock, zone.phase),
            "part": round(spent_s / limit, 3) if limit else 0}


def counts(clock: RunClock) -> bool:
    """Whether times change while only time passes."""
    return clock.after_stop_until is not None or any(
        isinstance(one, Count) and one.counting for one in clock)


def zones_page(zones: Sequence[ZoneSeen]) -> List[Data]:
    """Return all zones with their phases, and what each needs of its referee."""
    return [{"zone": zone.zone, "team": zone.event.team, "phase": sheets.phase(zone.phase), "todo": task.text,
             "is_urgent": is_urgent(task)} for zone in zones for task in [todo.todo(zone)]]


def is_urgent(task: todo.Todo) -> bool:
    """Whether a zone needs its referee."""
    return task.urgency >= todo.Urgency.LOOK


def stop_page(zones: Sequence[ZoneSeen], has_all: bool, successor: str = "") -> Data:
    """Return what STOP of a device needs, without a text. `zones`: those that it may stop; `has_all`: these are all
    zones; `successor`: address of the box that took over."""
    return {"all": has_all, "successor": successor, "zones": [
        {"zone": zone.zone, "identity": zone.identity, "running": zone.phase == RUNNING,
         "by_hand": zone.by_hand, "not_stopped": len(zone.not_stopped) > 0} for zone in zones]}


def _figure(figure: Figure) -> Data:
    return {"label": figure.label, "text": figure.text, "hurry": int(figure.hurry)}


def item_page(item: SheetItem) -> Data:
    """Return a scoring item."""
    return {
        "group": item.group, "desc": item.desc, "type": item.type,
        "name": tr(item.desc) if item.group == INCIDENTS else item.desc, "value": item.value,
        "text": item.text, "not_attempted": item.not_attempted, "points": number(item.points),
        "shown": sheets.item_text(item), "late": item.late, "void": tr_said(item.void), "unit": item.unit,
        "is_incident": item.group == INCIDENTS, "under": item.under, "each": item.each, "after": item.after,
        "incident": item.incident, "until": item.until, "worth": sheets.worth_text(item),
        "gives": sheets.gives_text(item),
        "step": sheets.PERCENT_STEP if item.unit == sheets.PERCENT else 1,
        "is_penalty": (item.percent or item.each).startswith("-"),
        "min": item.min, "max": item.max, "choices": item.choices,
        "choice_points": item.choice_points, "judges": item.judges, "ratings": item.ratings,
        "help": item.help, "decided": item.decided,
    }


def _unsigned_run(run: RunLine, moments: Moments, utc_s: float, absent: Sequence[Absent]) -> Data:
    return {"identity": run.identity, "revision": run.revision, "title": _timed_name(run, moments, utc_s),
            "end": with_counting(sheets.run_state(run.started_utc_s, run.closed_utc_s, run.end_reason), run.counts),
            "score": tr_said(run.score),
            # Before the sign-off: on these devices, marks of the run may wait. Whoever was heard after the run was left
            # and after their last mark had a link then, over which all marks came. A lost one counts as heard until
            # that is noticed.
            "unheard": [one.name for one in absent if run.opened_utc_s <= one.seen_utc
                        < max(run.closed_utc_s or math.inf, one.marked_utc) + STUCK_S]}


def run_name(run: RunLine) -> str:
    """Return the name of a run."""
    return sheets.run_name(run.code, run.team, run.round, run.run)


def _timed_name(run: RunLine, moments: Moments, utc_s: float) -> str:
    """Two attempts have the same name, but not the same time."""
    return f"{moments.scheduled(run.closed_utc_s or run.opened_utc_s, utc_s)}  {run_name(run)}"


# -- several judges ---------------------------------------------------------------------------------
#
# How far the judges are is part of the zone's document, without values. The values come with the answer to a device
# that asks: a judge gets the own sheet, the others get all sheets side by side, once the core shows them.

def _judging(one: Judging, run: RunLine, moments: Moments, utc_s: float) -> Data:
    """Return how far the judges and the result of a run are."""
    return {
        "identity": one.identity, "revision": one.revision, "title": _timed_name(run, moments, utc_s),
        "off": judging.off(one, run.closed_utc_s is not None), "count": one.count, "missing": one.missing,
        "is_complete": one.complete,
        "waiver": one.waiver, "differences": one.differences,
        "judges": [{"judge": each.judge, "submitted": each.submitted_utc_s is not None,
                    "state": judging.judge_state(each)} for each in one.judges],
        "publication": judging.publication_text(one, utc_s, lambda when: moments.scheduled(when, utc_s)),
    }


def own_sheet(run: JudgedRun) -> Data:
    """Return a judge's own sheet."""
    return {"submitted": run.submitted, "again": run.again, "items": [item_page(item) for item in run.own]}


def side_by_side(run: JudgedRun) -> Data:
    """Return what the head referee sees."""
    return {
        "judged": [{
            "outcome": one.outcome, "item": item_page(run.items[one.number - 1]),
            "given": [each._asdict() for each in one.given], "who": one.who, "reason": one.reason,
        } for one in judging.judged_of(run)],
        "objections": [{
            "number": one.number, "by": one.by, "text": one.text, "is_answered": one.answered_utc_s is not None,
            "answer": judging.answer_text(one), "second": one.second, "at": clock_text(one.second or None),
        } for one in judging.objections_of(run)],
    }


OVERVIEW, SCHEDULE, ROBOTS, RUNS, LOG, BOX = "overview", "schedule", "robots", "runs", "log", "box"
# The newest of each; of the schedule, those around the current events.
MAX_EVENTS, MAX_ROBOTS, MAX_RUNS, MAX_HISTORY, MAX_COMING = 200, 200, 50, 200, 16
# Characters of the log that are sent at once. The page keeps what came before.
MAX_LOG = 6000
_MOMENTS = Moments(False)


class PartShown(NamedTuple):
    """What a part is made from."""

    document: Document
    zone: str  # the one that the device shows
    own: str  # the only one in which the device may act; empty: all
    now: Now
    links: LinkQuality
    people: Sequence[DeviceSession] = ()  # with devices that are connected, see `Desk`

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
    return part in PARTS and grant.role in READS and (part != OVERVIEW or not grant.zone)


# -- all zones --------------------------------------------------------------------------------------


def _overview(shown: PartShown) -> Data:
    events = [event for event in shown.document.events() if event.state in schedule.TO_COME]
    several_days = len({schedule.day_of(event) for event in events[:MAX_COMING]}) > 1
    return {"zones": [_tile(zone, events, shown) for zone in shown.zones()], "open": _open(shown),
            "coming": [_event(event, [], several_days) for event in events[:MAX_COMING]],
            "standings": _standings(shown.document)}


def _tile(zone: ZoneSeen, coming: Sequence[EventSeen], shown: PartShown) -> Data:
    task, event = todo.todo(zone), zone.event
    after = next((one for one in coming if one.zone == zone.zone and not one.current), None)
    return {
        "zone": zone.zone, "team": event.team, "event": f"{event.code} · {sheets.turn(event.round, event.run)}",
        "phase": zone.phase, "phase_text": sheets.phase(zone.phase, zone.end_reason),
        "look": sheets.look(zone.phase, zone.end_reason),
        "clock": clock_page(zone, shown.now.mono),
        "todo": task.text, "is_urgent": is_urgent(task), "more": task.more,
        "people": ", ".join(f"{one.person} ({sheets.role_word(one.grant.role)})" for one in shown.people
                            if one.grant.zone == zone.zone),
        "next": after and _event(after, [], False),
    }


def _open(shown: PartShown) -> List[Data]:
    """Return what waits for somebody: how much, of what, and the part of a zone where it is done."""
    document, zones = shown.document, shown.zones()
    runs = {run.identity: run for run in document.runs() if run.zone in {zone.zone for zone in zones}}
    unsigned = [run for run in runs.values() if run.is_unsigned]
    judgings = [one for one in document.judging.values() if one.identity in runs]
    alone = [zone.zone for zone in zones
             if not any(one.grant.role in REFEREES and one.grant.zone == zone.zone for one in shown.people)]

    late = [run for run in runs.values() if run.proposals]

    def judged(number: Callable[[Judging], int], what: str) -> List[Data]:
        return of_runs(sum(map(number, judgings)), what, [runs[one.identity] for one in judgings if number(one)])

    def of_runs(count: int, what: str, found: Sequence[RunLine]) -> List[Data]:
        return [{"count": count, "what": tr(what), "more": _timed_name(found[-1], _MOMENTS, shown.now.utc),
                 "part": RUNS, "zone": found[-1].zone}] if count else []

    return [
        *of_runs(len(unsigned), whole_box.TO_SIGN, unsigned),  # the last one is the oldest
        *of_runs(sum(run.proposals for run in late), whole_box.TO_DECIDE, late),
        *judged(lambda one: one.open_objections, whole_box.TO_ANSWER),
        *judged(lambda one: one.differences, whole_box.TO_SETTLE),
        *([{"count": len(alone), "what": tr(whole_box.ALONE), "more": ", ".join(alone), "part": ROBOTS,
            "zone": alone[0]}] if alone else []),
    ]


def _standings(document: Document) -> List[Data]:
    """Return the standings as tables."""
    return [{"title": one.benchmark, "columns": list(one.criteria), "notes": [tr_said(note) for note in one.notes],
             "rows": [[rank.rank, rank.team, *map(number, rank.numbers)] for rank in one.ranks]}
            for one in document.public.standings]


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
        "current": event.current, "look": _look_of_event(event), "off": schedule.why_not(current, event),
        "shows": [show.value for show in schedule.Show if schedule.EventFilter(show=show).shows(event)],
    }


def _look_of_event(event: EventSeen) -> str:
    return sheets.look({"done": ENDED, "next": IDLE, "later": IDLE, "skipped": IDLE}.get(event.state, event.state),
                       event.end_reason)


def _event_name(event: EventSeen) -> str:
    return sheets.run_name(event.code, event.team, event.round, event.run)


# -- robots -----------------------------------------------------------------------------------------


def _robots(shown: PartShown) -> Data:
    found = whole_box.robot_rows(shown.document, shown.now.mono, shown.links)
    return {"hidden": max(0, len(found) - MAX_ROBOTS), "robots": found[:MAX_ROBOTS]}


# -- the runs of a zone -----------------------------------------------------------------------------


def _runs(shown: PartShown) -> Data:
    runs = [run for run in shown.document.runs() if run.zone == shown.zone]
    return {"hidden": max(0, len(runs) - MAX_RUNS), "runs": [_run(run, shown) for run in runs[:MAX_RUNS]],
            "events": {run.code: [
                [event.id, f"{schedule.moment_text(event.scheduled_utc_s, True)}  {_event_name(event)}"]
                for event in shown.document.events() if event.code == run.code] for run in runs},
            "standings": _standings(shown.document)}


def _look_of(run: RunLine) -> str:
    return sheets.look(ENDED if run.end_reason else RUNNING if run.started_utc_s else CONNECTED, run.end_reason)


def _run(run: RunLine, shown: PartShown) -> Data:
    judged = shown.document.judging.get(run.identity)
    unsaved = any(one.identity == run.identity for one in shown.document.box.unsaved)
    sheet = sheets.signature(run.signed_utc_s, run.signed_by, _MOMENTS.with_zone, run.versions) \
        if run.signed_utc_s or run.versions else sheets.sheet_state(run.closed_utc_s, None)
    return {
        "identity": run.identity, "revision": run.revision,
        "title": _timed_name(run, _MOMENTS, shown.now.utc), "look": _look_of(run),
        "end": with_counting(sheets.run_state(run.started_utc_s, run.closed_utc_s, run.end_reason), run.counts),
        "score": tr_said(run.score), "sheet": "; ".join([*([f"⚠ {tr(sheets.NOT_SAVED)}"] if unsaved else []),
                            *([tr(sheets.CORRECTED)] if run.corrected and not run.versions else []), sheet]),
        "is_closed": run.closed_utc_s is not None, "is_signed": run.signed_utc_s is not None,
        "is_judged": judged is not None and judged.count > 0, "code": run.code, "number": run.proposals,
        "put_right": [name for name, is_on in (
            ("object", True), ("annul", not run.is_annulled), ("move", True), ("reopen", run.signed_utc_s is not None),
            ("undo", run.can_undo)) if is_on and run.closed_utc_s is not None],
    }


def captain_page(sheet: RunSheet) -> List[Data]:
    """Return the captain's signature; empty: there is none."""
    return [{"text": captain_text(sign, _MOMENTS.time_of_day), "comment": sign.comment, "drawing": sign.drawing,
             "refused": sign.refused, "outdated": sign.outdated} for sign in sheet.captain[-1:]]


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
        "captain": captain_page(sheet),
        "corrections": [page_item(item) for item in corrections(sheet.timeline, _MOMENTS.time_of_day)],
        "timeline": [page_item(item) for item in timeline(sheet.timeline, _MOMENTS.time_of_day)],
        "ends": [
            {"number": end.number, "is_stop": end.end_reason != "completed",
             "reason": sheets.stop_reason(end.reason, end.reason_by, end.who),
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
        shown.document.results, shown.document.judging, shown.document.box.unsaved, shown.document.public.standings,
        shown.document.schedule, _day(shown)), _runs),
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


def _of_team(document: Optional[Document], team: str) -> List[RunLine]:
    """Return the runs of a team that are over."""
    return [] if document is None else [
        run for run in document.runs() if run.team == team and run.closed_utc_s is not None]


ZONE, CLOCK, ZONES, TIMELINE = "page.zone", "page.clock", "page.zones", "page.timeline"
# What STOP needs, without a text: of a zone, or with "" of all zones.
STOP = "page.stop"
NO_STOP: Key = (STOP,)  # of devices that may stop nothing


class Desk(Numbered):
    """The documents for devices. The fixed texts of pages are those of the store."""

    def __init__(
        self, store: Store, people: Callable[[], Sequence[DeviceSession]] = tuple,
        absent: Callable[[str], Sequence[Absent]] = lambda zone: (),
    ) -> None:
        """`people`: with devices that are connected, an organiser as of the zone whose page is open; `absent`
        returns the devices that may mark in a zone and are not connected now."""
        super().__init__(store.box, store.session)
        self._store, self._people, self._absent = store, people, absent
        self._shown: Set[Key] = set()  # see `show`
        self._links = LinkQuality()
        self._put(NO_STOP, stop_page([], False))

    def zones(self) -> List[str]:
        """Return all zones, in the order of the schedule."""
        return [zone.zone for zone in self._zones()]

    def team_facts(self, team: str, language: str) -> Optional[List[str]]:
        """Return what the box knows of a team's robot; None: it was not heard yet."""
        document = self.box.document
        if document is None:
            return None
        with self._store.speaking(language):
            return public.team_facts(team, document, self.box.now())

    def protests(self, team: str, language: str) -> Dict[str, List[Data]]:
        """Return the runs to whose results a team may object now, and what became of its objections."""
        runs, utc_s = _of_team(self.box.document, team), self.box.now().utc
        with self._store.speaking(language):
            return {
                "runs": [{"identity": run.identity, "zone": run.zone, "title": _timed_name(run, _MOMENTS, utc_s),
                          "until": tr(judging.OBJECTIONS_UNTIL, time=_MOMENTS.scheduled(until, utc_s))}
                         for run in runs for until in [run.protests_until_utc_s or 0.0] if until > utc_s],
                "objections": [{"title": run_name(run), "text": one.text,
                                "answer": judging.answer_text(one) or tr(judging.NO_ANSWER)}
                               for run in runs for one in run.objections if one.by == team]}

    def team_runs(self, team: str, language: str) -> List[Data]:
        """Return the runs of a team that are over, the newest first, as its captain sees them."""
        document = self.box.document
        with self._store.speaking(language):
            return [{"identity": run.identity, "revision": run.revision, "score": tr_said(run.score),
                     "title": _timed_name(run, _MOMENTS, self.box.now().utc),
                     "sheet": sheets.sheet_state(run.closed_utc_s, run.signed_utc_s)}
                    for run in _of_team(document, team)[:MAX_TEAM_RUNS]]

    def run_of_team(self, team: str, identity: str) -> Optional[str]:
        """Return the zone of a run that is over; None: the team has no such run."""
        return next((run.zone for run in _of_team(self.box.document, team) if run.identity == identity), None)

    def show(self, shown: Iterable[Key]) -> None:
        """Make documents for these from now on, and for no others: language and zone, and where a part of the page of
        the whole box is open, that part and the zone in which its device may act; empty: all zones."""
        self._shown = set(shown)
        self.look()

    def look(self) -> bool:
        """Make documents again: the box, or only its clocks, may have changed. Returns whether any has changed. What
        STOP needs is made first. A device of a zone that is gone has nothing to stop."""
        document, before, zones = self.box.document, self.changes, self._zones()
        if document is None:
            return False
        successor = document.box.superseded_by
        for name in {"", *document.zones, *(key[1] for key in self._made_of if key[0] == STOP)}:
            own = [zone for zone in zones if name in ("", zone.zone)]
            self._renew((STOP, name), (own, successor),
                        functools.partial(stop_page, own, name == "", successor))
        now = self.box.now()
        self._links.look(document, now.mono)  # also while nobody sees it: it depends on the past
        for language, name in {key[:2] for key in self._shown}:
            with self._store.speaking(language):
                self._renew((ZONES, language), zones, lambda: zones_page(zones))
                self._make(document, language, name, now)
        for language, name, part, own in (key for key in self._shown if len(key) > 2):
            key, shown = (part_name(part), language, name, own), PartShown(
                document, name, own, now, self._links, self._people())
            if self.box.is_old and key in self._made_of:
                continue  # its clocks stop
            with self._store.speaking(language):
                self._renew(key, made_of(part, shown), functools.partial(part_page, part, shown))
        return self.changes != before

    def _make(self, document: Document, language: str, name: str, now: Now) -> None:
        """Make the documents of a zone in a language, which texts have now."""
        zone = document.zones.get(name)
        if zone is None:  # it is gone
            self._renew((ZONE, language, name), None, lambda: None)
            self._renew((CLOCK, language, name), None, lambda: None)
            self._renew((TIMELINE, language, name), None, lambda: None)
            return
        is_counting = counts(zone.clock) and not self.box.is_old
        absent = tuple(self._absent(name))
        self._renew(
            (ZONE, language, name), (zone, document.box.warnings, document.results, document.judging,
                                     moment(document, now.utc), absent),
            lambda: zone_page(zone, document, now.utc, absent))
        self._renew((CLOCK, language, name), (zone.clock, zone.phase, now.mono if is_counting else None),
                    lambda: clock_page(zone, now.mono))
        happened = document.timelines.get(name)
        self._renew((TIMELINE, language, name), happened, lambda: timeline_page(happened))

    def _zones(self) -> List[ZoneSeen]:
        document = self.box.document
        return [] if document is None else [
            document.zones[name] for name in document.box.zones if name in document.zones]

    # -- for devices ----------------------------------------------------------------------------------

    def keys(self, language: str, zone: str, part: str = "", own: str = "") -> List[Key]:
        """Return the keys of all documents of a page; see `show`."""
        return [*self._store.keys(FIXED_TEXTS, language), (ZONES, language), (ZONE, language, zone),
                (CLOCK, language, zone), (TIMELINE, language, zone),
                *([(part_name(part), language, zone, own)] if part else [])]

    def document(self, key: Key) -> NumberedDocument:
        """Return a document."""
        return self._store.document(key) if key[0] in FIXED_TEXTS else super().document(key)

    def piece(self, key: Key) -> str:
        """Return a document as a part of a message."""
        return self._store.piece(key) if key[0] in FIXED_TEXTS else super().piece(key)
