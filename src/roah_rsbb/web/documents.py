"""The documents for browsers and programs, made from what the public may see of the box (docs/web.md, "Data").

They contain nothing else. Times are UTC seconds since 1970 of the box's clock.
"""

from typing import Any, Dict, Iterable, List, Optional

from roah_rsbb.model.document import Document, PublicEvent, PublicResult, PublicRun
from roah_rsbb.wording import public
from roah_rsbb.wording.language import tr
from roah_rsbb.wording.public import explained as explained_texts
from roah_rsbb.wording.whole_box import REPLAY_NOT_LIVE

Data = Dict[str, Any]

STATE, SCHEDULE, RESULTS, STANDINGS, EXPLAINED = DATA = ("state", "schedule", "results", "standings", "explained")
# The texts of our pages, in the language of the reader.
WORDS, DEVICE_WORDS, PAGE_RUNS, PAGE_NEXT, PAGE_RESULTS, PAGE_STANDINGS, PAGE_EXPLAINED = TEXTS = (
    "page.words", "page.device_words", "page.runs", "page.next", "page.results", "page.standings", "page.explained",
)
FIXED_TEXTS = (WORDS, DEVICE_WORDS)  # these need no message of the core
DISPLAY = "page.display"  # what the organiser has set for a display: for this one only


# -- data -------------------------------------------------------------------------------------------


def state(document: Document, ahead_s: float) -> Data:
    """Return the runs of all zones. `ahead_s`: of the box's UTC to its monotonic clock."""
    return {
        "box": document.box.uuid,
        "public_results": document.public.results,
        "runs": [_run(run, ahead_s) for run in document.runs_shown()],
    }


def schedule(document: Document) -> Data:
    """Return the coming events, the soonest first."""
    return {"events": [_event(event) for event in document.public.following]}


def results(document: Document) -> Data:
    """Return the results that the public may see, the newest first."""
    return {
        "results": [_result(result) for result in document.results_shown(signed=True)],
        "provisional": [_result(result) for result in document.results_shown(signed=False)],
    }


def standings(document: Document) -> Data:
    """Return the standing of each benchmark."""
    return {"standings": [
        {
            "benchmark": standing.benchmark, "criteria": list(standing.criteria),
            "ranks": [{"rank": rank.rank, "team": rank.team, "numbers": list(rank.numbers)} for rank in standing.ranks],
            "notes": list(standing.notes),
        }
        for standing in document.public.standings
    ]}


def explained(document: Document) -> Data:
    """Return the runs explained."""
    return {"runs": [
        {
            "zone": run.event.zone, "about": run.about, "kind": run.kind, "doing": run.doing,
            "phases": list(run.phases), "phase": run.phase_number, "waypoints": run.are_waypoints, "goals": run.goals,
            "goals_ended": run.goals_ended, "goals_completed": run.goals_completed,
            "said": [{"robot": one.robot, "kind": one.kind, "text": one.text, "received": _time(one.utc_s)}
                     for one in run.said],
        }
        for run in document.runs_shown()
    ]}


def _event(event: PublicEvent) -> Data:
    return {
        "zone": event.zone, "benchmark": event.benchmark, "team": event.team, "round": event.round, "run": event.run,
        "scheduled": _time(event.scheduled_utc_s),
    }


def _run(run: PublicRun, ahead_s: float) -> Data:
    """A run. While its clock runs, only the time from or to which it counts is given: so it changes rarely."""
    since, seconds = run.elapsed.since, run.elapsed.seconds
    counts, has_limit = since is not None, run.limit > 0.0
    began = ahead_s + (since or 0.0) - seconds  # without pauses
    return {
        **_event(run.event),
        "teams": list(run.teams),
        "phase": run.phase,
        "end_reason": run.end_reason,
        "activity": run.activity,
        "counting": counts,
        "unlimited": not has_limit,
        "ends": _time(began + run.limit) if counts and has_limit else None,
        "counts_from": _time(began) if counts and not has_limit else None,
        "left_s": _time(run.limit - seconds) if has_limit and not counts else None,
        "elapsed_s": _time(seconds) if not has_limit and not counts else None,
    }


def _result(result: PublicResult) -> Data:
    return {
        **_event(result.event),
        "end_reason": result.end_reason,
        "disconnected": _time(result.disconnected_utc_s),
        "groups": [
            {
                "name": group.name, "not_attempted": group.not_attempted,
                "items": [item._asdict() for item in group.items],
            }
            for group in result.groups
        ],
        "module_scores": [
            {"name": score.name, "value": score.value, "unit": score.unit, "description": score.desc}
            for score in result.module_scores
        ],
        "points": None if result.points is None else {
            "total": result.points.total,
            "groups": [{"name": group.name, "points": group.points} for group in result.points.groups],
        },
    }


def _time(seconds: float) -> float:
    return round(seconds, 3)


# -- texts of pages ---------------------------------------------------------------------------------


def page_words(language: str, title: str, utc_s: Optional[float], utc_offset_s: int) -> Data:
    """Return the fixed texts of all pages. `title`: of the competition; `utc_s`: the box's clock; None: not known."""
    return {
        "language": language, "title": title, "date": "" if utc_s is None else public.date(utc_s),
        "utc_offset_s": utc_offset_s,
        **public.page_words(),
    }


def page_runs(document: Document, ahead_s: float) -> Data:
    """Return the texts of all runs with the times that the page counts itself, and the mark of a replay. `ahead_s`: see
    `state`."""
    return {"replay": tr(REPLAY_NOT_LIVE) if document.box.is_replay else "", "runs": [
        {**card._asdict(), **{name: _run(run, ahead_s)[name] for name in ("zone", "teams", "ends", "counts_from")}}
        for card, run in zip(public.cards(document), document.runs_shown())
    ]}


def page_next(document: Document, utc_s: float) -> Data:
    """Return the texts of the coming events."""
    return {"lines": _lines(public.following(document, utc_s), document.public.following)}


def page_results(document: Document, utc_s: float) -> Data:
    """Return the texts of the results."""
    found = {"results": document.results_shown(signed=True), "provisional": document.results_shown(signed=False)}
    return {name: _lines(public.result_lines(results, utc_s), [result.event for result in results])
            for name, results in found.items()}


def page_standings(document: Document) -> Data:
    """Return the texts of the standings."""
    return {"standings": [
        {"title": public.standing_title(one.title), "lines": [line._asdict() for line in one.lines]}
        for one in public.standings(document)
    ]}


def page_explained(document: Document, language: str) -> Data:
    """Return the texts that explain the runs."""
    return {"runs": [
        {"zone": run.event.zone, **texts._asdict(), "steps": [step._asdict() for step in texts.steps]}
        for run in document.runs_shown()
        for texts in [explained_texts(run, language)]
    ]}


def _lines(lines: Iterable[public.ListLine], events: Iterable[PublicEvent]) -> List[Data]:
    """The texts of lines with the zone and the team by which a page chooses them."""
    return [{**line._asdict(), "zone": event.zone, "of_team": event.team} for line, event in zip(lines, events)]
