"""The documents for browsers and programs, made from PublicDetails, PublicBoard and PublicExplained (docs/web.md,
"Data").

They contain what these messages contain and nothing else. The functions work on anything with the fields of the
messages. Times are UTC seconds since 1970 of the box's clock.
"""

from typing import Any, Dict, List, Optional

from roah_rsbb.wording import public
from roah_rsbb.wording.explained import explained as explained_texts
from roah_rsbb.wording.language import tr
from roah_rsbb.wording.replay import NOT_LIVE, is_replay

Data = Dict[str, Any]

STATE, SCHEDULE, RESULTS, STANDINGS, EXPLAINED = DATA = ("state", "schedule", "results", "standings", "explained")
# The texts of our pages, in the language of the reader.
WORDS, DEVICE_WORDS, PAGE_RUNS, PAGE_NEXT, PAGE_RESULTS, PAGE_STANDINGS, PAGE_EXPLAINED = TEXTS = (
    "page.words", "page.device_words", "page.runs", "page.next", "page.results", "page.standings", "page.explained",
)
FIXED_TEXTS = (WORDS, DEVICE_WORDS)  # these need no message of the core
DISPLAY = "page.display"  # what the organiser has set for a display: for this one only
# The time at which a run ends is computed from two clocks. A smaller difference is no change.
SAME_TIME_S = 0.05


# -- data -------------------------------------------------------------------------------------------


def state(details, before: Optional[Data] = None) -> Data:
    """Return the runs of all zones. Times that hardly differ from those in `before` stay the same."""
    known = {} if before is None else {run["zone"]: run for run in before["runs"]}
    return {
        "box": details.box_uuid,
        "public_results": details.results,
        "runs": [_steady(_run(run, details.clock.to_sec()), known.get(run.event.zone)) for run in details.runs],
    }


def schedule(details) -> Data:
    """Return the coming events, the soonest first."""
    return {"events": [_event(event) for event in details.following]}


def results(details, board) -> Data:
    """Return the results that the public may see, the newest first."""
    return {
        "results": [_result(result) for result in (details.finished if board is None else board.results)],
        "provisional": [] if board is None else [_result(result) for result in board.provisional],
    }


def standings(board) -> Data:
    """Return the standing of each benchmark."""
    return {"standings": [] if board is None else [
        {
            "benchmark": standing.benchmark, "criteria": list(standing.criteria),
            "ranks": [{"rank": rank.rank, "team": rank.team, "numbers": list(rank.numbers)} for rank in standing.ranks],
        }
        for standing in board.standings
    ]}


def explained(details, message) -> Data:
    """Return the runs explained."""
    return {"runs": [] if message is None else [
        {
            "zone": run.zone, "about": dict(zip(run.languages, run.about)), "kind": run.kind, "doing": run.doing,
            "phases": list(run.phases), "phase": run.phase, "waypoints": bool(run.waypoints), "goals": run.goals,
            "goals_ended": run.goals_ended,
            "goals_completed": run.goals_completed if _shows_outcomes(details) else None,
            "said": [{"robot": one.robot, "kind": one.kind, "text": one.text, "received": _time(one.received.to_sec())}
                     for one in run.said],
        }
        for run in message.runs
    ]}


def _shows_outcomes(details) -> bool:
    return details.results != "none"


def _event(event) -> Data:
    return {
        "zone": event.zone, "benchmark": event.benchmark, "team": event.team, "round": event.round, "run": event.run,
        "scheduled": _time(event.scheduled.to_sec()),
    }


def _run(run, clock_s: float) -> Data:
    """A run. While its clock runs, only the time from or to which it counts is given: so it changes rarely."""
    elapsed_s = run.elapsed.to_sec()
    return {
        **_event(run.event),
        "teams": list(run.teams),
        "phase": run.phase,
        "end_reason": run.end_reason,
        "activity": run.activity,
        "counting": run.counting,
        "unlimited": run.unlimited,
        "ends": _time(run.ends.to_sec()) if run.counting and not run.unlimited else None,
        "counts_from": _time(clock_s - elapsed_s) if run.counting and run.unlimited else None,
        "left_s": None if run.counting or run.unlimited else _time(run.left.to_sec()),
        "elapsed_s": _time(elapsed_s) if run.unlimited and not run.counting else None,
    }


def _steady(run: Data, before: Optional[Data]) -> Data:
    for name in ("ends", "counts_from") if before is not None else ():
        new, old = run[name], before[name]
        if new is not None and old is not None and abs(new - old) < SAME_TIME_S:
            run[name] = old
    return run


def _result(result) -> Data:
    return {
        **_event(result.event),
        "end_reason": result.end_reason,
        "disconnected": _time(result.disconnected.to_sec()),
        "groups": [
            {
                "name": group.group_name, "not_attempted": not_attempted,
                "items": [
                    {"name": name, "kind": "bool" if kind == 0 else "count", "value": value}
                    for name, kind, value in zip(group.descriptions, bytearray(group.types), group.current_values)
                ],
            }
            for group, not_attempted in zip(result.scoring, result.not_attempted)
        ],
        "module_scores": [
            {"name": score.name, "value": score.value, "unit": score.unit, "description": score.desc}
            for score in result.module_scores
        ],
        "points": {
            "total": result.points.total,
            "groups": [{"name": group.name, "points": group.points} for group in result.points.groups],
        } if result.points.total else None,
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


def page_runs(details, runs: List[Data]) -> Data:
    """Return the texts of all runs, and the mark of a replay. `runs`: those of `state`, for the times that the page
    counts itself."""
    return {"replay": tr(NOT_LIVE) if is_replay(details.box_uuid) else "", "runs": [
        {
            **card._replace(big=public.still(card, run, details.clock.to_sec()))._asdict(),
            **{name: times[name] for name in ("zone", "teams", "ends", "counts_from")},
        }
        for card, run, times in zip(public.cards(details), details.runs, runs)
    ]}


def page_next(details, utc_s: float) -> Data:
    """Return the texts of the coming events."""
    return {"lines": _lines(public.following(details, utc_s), details.following)}


def page_results(details, board, utc_s: float) -> Data:
    """Return the texts of the results."""
    signed = details.finished if board is None else board.results
    provisional = [] if board is None else board.provisional
    return {
        "results": _lines(public.result_lines(signed, utc_s), [result.event for result in signed]),
        "provisional": _lines(public.result_lines(provisional, utc_s), [result.event for result in provisional]),
    }


def page_standings(board) -> Data:
    """Return the texts of the standings."""
    return {"standings": [] if board is None else [
        {"title": public.standing_title(one.title), "lines": [line._asdict() for line in one.lines]}
        for one in public.standings(board)
    ]}


def page_explained(details, message, language: str) -> Data:
    """Return the texts that explain the runs."""
    return {"runs": [] if message is None else [
        {"zone": run.zone, **texts._asdict(), "steps": [step._asdict() for step in texts.steps]}
        for run in message.runs
        for texts in [explained_texts(run, language, _shows_outcomes(details))]
    ]}


def _lines(lines, events) -> List[Data]:
    """The texts of lines with the zone and the team by which a page chooses them."""
    return [{**line._asdict(), "zone": event.zone, "of_team": event.team} for line, event in zip(lines, events)]
