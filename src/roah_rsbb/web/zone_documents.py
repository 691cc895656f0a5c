"""The documents for paired devices: a zone, its clock, its score sheet, and what can be done (docs/web.md, "Referees").

The functions work on anything with the fields of the messages. Texts are in the language of the reader.
"""

from typing import Any, Dict, Iterable, List

from roah_rsbb.model import shown
from roah_rsbb.model.actions import ACTIONS
from roah_rsbb.web.documents import Data
from roah_rsbb.wording import judging, sheets, stop, todo
from roah_rsbb.wording.clock import Figure, clock_of
from roah_rsbb.wording.counting import with_counting
from roah_rsbb.wording.language import tr
from roah_rsbb.wording.said import tr_said
from roah_rsbb.wording.times import Moments

_MARKS = {"idle": "○", "connected": "●", "running": "▶", "ended": "■"}
# Runs without judges that are over and not signed off. The page is no archive.
MAX_UNSIGNED = 5


def zone_page(
    zone, details, box_warnings: Iterable[str], runs: List[Any], judgings: List[Any], utc_s: float,
) -> Data:
    """Return everything about a zone but its running times.

    `zone`: ZoneState; `details`: ZoneDetails; `runs`: RunSummary of all;
    `judgings`: Judging of all.
    """
    unsigned = _unsigned(runs, judgings, zone.zone)
    task = todo.todo(zone, details)
    actions = shown.read(details.actions)
    reasons = [*actions["connect"].off, *actions["start"].off]  # the page shows them beside the commands
    lines = [line for line in zone.state.split("\n") if line and line not in reasons]
    # Those of the zone first: a robot may be moving. The one that says what to do now is not repeated.
    warnings = [tr_said(text) for text in (
        *(line[len(todo.WARNING):] for line in lines if line.startswith(todo.WARNING)), *box_warnings)]
    mark = _MARKS.get(details.phase, "–")
    moments = Moments(False)
    return {
        "zone": zone.zone,
        "identity": details.identity,
        "phase": details.phase,
        "phase_text": f"{mark} {sheets.phase(details.phase, details.end_reason)}",
        "title": f"{zone.code}  {zone.desc}",
        "team": zone.team,
        "event_id": details.event,
        "event": f"{zone.schedule.to_sec():.0f}/{zone.team}/{zone.round}/{zone.run}",
        "facts": f"{sheets.turn(zone.round, zone.run)} · {moments.scheduled(zone.schedule.to_sec(), utc_s)}",
        "robot": details.robot,
        "by_hand": details.by_hand,
        "todo": task.text,
        "is_urgent": bool(task.urgency >= todo.Urgency.LOOK),
        "leaving": stop.leaving(details),
        "warnings": [text for text in warnings if text != task.text],
        "state": [tr_said(line) for line in lines if not line.startswith(todo.WARNING)],
        "off": {name: [tr_said(reason) for reason in action.off] for name, action in actions.items()},
        "shown": {name: action.shown for name, action in actions.items()},
        "robots": list(shown.robots_to_choose(details)),
        "texts": {name: action.text for name, action in actions.items() if action.text},
        "fields": {name: [{**field.form(), "label": tr(field.label)} for field in action.fields]
                   for name, action in actions.items() if name in ACTIONS and action.fields != ACTIONS[name].fields},
        "switches": {"on": list(zone.omf_switches), "damaged": zone.omf_damaged, "to_confirm": bool(zone.omf_complete)}
        if zone.omf else None,
        "items": [item_page(item) for item in details.items],
        "points": sheets.points_of(details.points),
        "unsigned": [_run(run, moments, utc_s) for run in unsigned],
        "judging": _judging(judging.judgings_of(judgings, unsigned, zone.zone), runs, utc_s),
    }


def sheet_page(sheet) -> Data:
    """Return the score sheet of a run (RunSheet), as `zone_page` has that of the run in the zone."""
    return {"items": [item_page(item) for item in sheet.items], "points": sheets.points_of(sheet.points)}


def clock_page(message, passed_s: float) -> Data:
    """Return the times of a run, `passed_s` seconds after `message` (RunClock)."""
    clock = clock_of(message, passed_s)
    return {"main": _figure(clock.main), "goal": None if clock.goal is None else _figure(clock.goal),
            "pause": clock.pause, "aside": clock.aside}


def zones_page(zones: Iterable[Any], details: Dict[str, Any]) -> List[Data]:
    """Return all zones with their phases, and what each needs of its referee."""
    known = [(zone, details[zone.zone]) for zone in zones if zone.zone in details]
    return [{"zone": zone.zone, "team": zone.team, "phase": sheets.phase(of_zone.phase), "todo": task.text,
             "is_urgent": bool(task.urgency >= todo.Urgency.LOOK)}
            for zone, of_zone in known for task in [todo.todo(zone, of_zone)]]


def stop_page(zones: Iterable[Any], has_all: bool) -> Data:
    """Return what STOP of a device needs, without a text. `zones`: ZoneDetails of those that it may stop; `has_all`:
    these are all zones."""
    return {"all": has_all, "zones": [
        {"zone": zone.zone, "identity": zone.identity, "running": zone.phase == "running",
         "by_hand": bool(zone.by_hand), "not_stopped": len(zone.not_stopped) > 0} for zone in zones]}


def _figure(figure: Figure) -> Data:
    return {"label": figure.label, "text": figure.text, "hurry": int(figure.hurry)}


def item_page(item) -> Data:
    """Return a scoring item."""
    return {
        "group": item.group, "desc": item.desc, "type": sheets.type_word(item.type), "value": item.value,
        "text": item.text, "not_attempted": bool(item.not_attempted), "points": item.points,
        "shown": sheets.item_value(sheets.type_word(item.type), item.value, bool(item.not_attempted), item.text),
        "min": item.min, "max": item.max, "choices": list(item.choices), "judges": list(item.judges),
        "ratings": list(item.ratings),
    }


def _unsigned(runs: List[Any], judgings: List[Any], zone: str) -> List[Any]:
    """Return the newest runs that are not signed off, and older ones that judges score or that are published."""
    found = [run for run in runs if run.zone == zone and run.closed.to_sec() and not run.signed.to_sec()]
    known = {one.identity for one in judgings}
    return found[:MAX_UNSIGNED] + [run for run in found[MAX_UNSIGNED:] if run.identity in known]


def _run(run, moments: Moments, utc_s: float) -> Data:
    name = sheets.run_name(run.code, run.team, run.round, run.run)
    when = moments.scheduled(run.opened.to_sec(), utc_s)
    return {"identity": run.identity, "revision": run.revision, "title": f"{when}  {name}",
            "end": with_counting(
                sheets.run_state(run.started.to_sec(), run.closed.to_sec(), run.end_reason), run.counts),
            "score": run.score}


# -- several judges ---------------------------------------------------------------------------------
#
# How far the judges are is part of the zone's document, without values. The values come with the answer to a device
# that asks: a judge gets the own sheet, the others get all sheets side by side, once the core shows them.

def _judging(judgings: List[judging.Judging], runs: List[Any], utc_s: float) -> List[Data]:
    """Return how far the judges and the results of runs are. `runs`: RunSummary of all."""
    names = {run.identity: sheets.run_name(run.code, run.team, run.round, run.run) for run in runs}
    over = {run.identity for run in runs if run.closed.to_sec()}

    def when(moment_utc_s: float) -> str:
        return Moments(False).scheduled(moment_utc_s, utc_s)

    return [{
        "identity": one.identity, "revision": one.revision, "title": names.get(one.identity, one.identity),
        "off": judging.off(one, one.identity in over), "count": one.count, "missing": one.missing,
        "is_complete": one.complete,
        "waiver": one.waiver, "differences": one.differences,
        "judges": [{"judge": each.judge, "submitted": each.submitted_utc_s is not None,
                    "state": judging.judge_state(each)} for each in one.judges],
        "publication": judging.publication_text(one, utc_s, when),
    } for one in judgings]


def own_sheet(answer) -> Data:
    """Return a judge's own sheet. `answer`: of GetJudging."""
    items = [item_page(item) for item in answer.own]
    return {"submitted": bool(answer.submitted), "again": answer.again, "items": items}


def side_by_side(answer) -> Data:
    """Return what the head referee sees. `answer`: of GetJudging."""
    items: Dict[Any, Any] = {(item.group, item.desc): item for item in answer.items}
    return {
        "judged": [{
            "outcome": one.outcome, "item": item_page(items[one.group, one.item]),
            "given": [each._asdict() for each in one.given], "who": one.who, "reason": one.reason,
        } for one in judging.judged_of(answer)],
        "objections": [{
            "number": one.number, "by": one.by, "text": one.text, "is_answered": one.answered_utc_s is not None,
            "answer": judging.answer_text(one),
        } for one in judging.objections_of(answer)],
    }
