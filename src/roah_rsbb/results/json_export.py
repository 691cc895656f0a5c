"""Results for programs: JSON (docs/results.md). `VERSION` rises when a field changes its meaning, or goes."""

from typing import Any, Dict, List, Sequence

from roah_rsbb.results.run_result import RunResult
from roah_rsbb.results.standing import Standing
from roah_rsbb.wording import result_texts

FORMAT = "roah_rsbb results"
VERSION = 1


def exported(results: Sequence[RunResult], standings: Sequence[Standing], journal: str, utc: float) -> Dict[str, Any]:
    """All of these runs, and the standings."""
    return {
        **_head(journal, utc),
        "runs": [_run(result) for result in results],
        "standings": [_standing(standing) for standing in standings],
    }


def exported_standings(standings: Sequence[Standing], journal: str, utc: float) -> Dict[str, Any]:
    """The standings alone."""
    return {**_head(journal, utc), "standings": [_standing(standing) for standing in standings]}


def _head(journal: str, utc: float) -> Dict[str, Any]:
    return {"format": FORMAT, "version": VERSION, "journal": journal, "written_utc": utc,
            "written": result_texts.iso(utc, in_utc=True)}


def _run(result: RunResult) -> Dict[str, Any]:
    return {
        **_plain(result.record),
        "state": result_texts.state_of(result.record),
        "robot_parts": [
            {"port": r.port, "team": r.team, "robot": r.robot, "log_file": r.log_file,
             "link": [{"utc": second.utc, **_plain(second.sample)} for second in r.link]}
            for r in result.robots
        ],
        "entries": [
            {"number": e.number, "utc": e.utc, "port": e.port, "who": e.who, "kind": e.kind, "value": e.value}
            for e in result.entries
        ],
    }


def _standing(standing: Standing) -> Dict[str, Any]:
    return {
        "benchmark": standing.benchmark, "of_runs": standing.of_runs.value,
        "criteria": [{"name": c.name, "better": "more" if c.more_is_better else "less"} for c in standing.criteria],
        "teams": [
            {"rank": t.rank, "tied": t.tied, "team": t.team, "numbers": list(t.numbers), "disqualified": t.disqualified,
             "runs": [
                 {"identity": r.record.identity, "disqualified": r.disqualified, "numbers": list(r.numbers),
                  "signed_off": r.record.sign_off is not None, "counts": t.best in (None, i)}
                 for i, r in enumerate(t.runs)
             ]}
            for t in standing.lines
        ],
        "remarks": list(standing.remarks),
    }


def _plain(value: Any) -> Any:
    """A record with all its fields, also those that have their default."""
    if hasattr(value, "_fields"):
        return {name: _plain(field) for name, field in zip(value._fields, value)}
    if isinstance(value, (list, tuple)):
        items: List[Any] = [_plain(item) for item in value]
        return items
    return value
