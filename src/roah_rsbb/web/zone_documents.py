"""The documents for paired devices: a zone, its clock, its score sheet, and what can be done (docs/web.md, "Referees").

Texts are in the language of the reader.
"""

from typing import List, Sequence, Tuple

from roah_rsbb.model.document import Document
from roah_rsbb.model.results import JudgedRun, Judging, RunLine, RunSheet
from roah_rsbb.model.zone import RUNNING, Count, RunClock, SheetItem, ZoneSeen
from roah_rsbb.web.documents import Data
from roah_rsbb.wording import judging, sheets, stop, todo
from roah_rsbb.wording.language import tr, tr_said
from roah_rsbb.wording.sheets import with_counting
from roah_rsbb.wording.times import Figure, Moments, clock_of, formatted

# Runs without judges that are over and not signed off. Of more, the page says how many there are.
MAX_UNSIGNED = 50


def zone_page(zone: ZoneSeen, document: Document, utc_s: float) -> Data:
    """Return everything about a zone but its running times. `utc_s`: the box's clock, see `moment`."""
    event, actions, moments, task = zone.event, zone.actions, Moments(False), todo.todo(zone)
    runs = [run for run in document.runs() if run.zone == zone.zone]
    waiting = [run for run in runs if run.closed_utc_s is not None and run.signed_utc_s is None]
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
        "phase_text": sheets.marked_phase(zone.phase, zone.end_reason),
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
        "points": sheets.points_of(zone.points),
        "unsigned": [_run(run, moments, utc_s) for run in unsigned],
        "unlisted": len(waiting) - len(unsigned),
        "judging": [_judging(judgings[run.identity], run, moments, utc_s) for run in runs
                    if run.identity in judgings and (run.closed_utc_s is None or run in unsigned)],
    }


def moment(document: Document, utc_s: float) -> Tuple[object, ...]:
    """Return what a page shows otherwise when only time passes: the day, and whose time for objections is over."""
    return (formatted(utc_s, "%Y-%m-%d", in_utc=False),
            *(one.identity for one in document.judging.values() if (one.objections_until_utc_s or 0.0) > utc_s))


def sheet_page(sheet: RunSheet) -> Data:
    """Return the score sheet of a run, as `zone_page` has that of the run in the zone."""
    return {"items": [item_page(item) for item in sheet.items], "points": sheets.points_of(sheet.points)}


def clock_page(zone: ZoneSeen, mono: float) -> Data:
    """Return the times of the run in a zone at a moment of the box's clock."""
    clock = clock_of(zone.clock, zone.phase, mono)
    return {"main": _figure(clock.main), "goal": None if clock.goal is None else _figure(clock.goal),
            "pause": clock.pause, "aside": clock.aside}


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
        "group": item.group, "desc": item.desc, "type": item.type, "value": item.value,
        "text": item.text, "not_attempted": item.not_attempted, "points": item.points,
        "shown": sheets.item_value(item.type, item.value, item.not_attempted, item.text),
        "min": item.min, "max": item.max, "choices": item.choices, "judges": item.judges, "ratings": item.ratings,
    }


def _run(run: RunLine, moments: Moments, utc_s: float) -> Data:
    when = moments.scheduled(run.opened_utc_s, utc_s)
    return {"identity": run.identity, "revision": run.revision, "title": f"{when}  {run_name(run)}",
            "end": with_counting(sheets.run_state(run.started_utc_s, run.closed_utc_s, run.end_reason), run.counts),
            "score": tr_said(run.score)}


def run_name(run: RunLine) -> str:
    """Return the name of a run."""
    return sheets.run_name(run.code, run.team, run.round, run.run)


# -- several judges ---------------------------------------------------------------------------------
#
# How far the judges are is part of the zone's document, without values. The values come with the answer to a device
# that asks: a judge gets the own sheet, the others get all sheets side by side, once the core shows them.

def _judging(one: Judging, run: RunLine, moments: Moments, utc_s: float) -> Data:
    """Return how far the judges and the result of a run are."""
    return {
        "identity": one.identity, "revision": one.revision, "title": run_name(run),
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
            "answer": judging.answer_text(one),
        } for one in judging.objections_of(run)],
    }
