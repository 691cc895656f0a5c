"""Lists what differs between two configurations, for the organiser who takes the new one.

No line contains a password (docs/organiser.md, "Changes during the competition").
"""

import datetime
from dataclasses import fields, is_dataclass
from typing import Any, Dict, Iterable, List, Tuple

from roah_rsbb.rulebook.benchmarks import Benchmark, Config, ScheduledEvent, ZonePlan
from roah_rsbb.rulebook.errors import quote

_Run = Tuple[str, str, int, int]  # code, team, round, run
# The fields of a benchmark whose differences are listed by other names.
_NAMES = {"own": "", "rules": "", "desc": "subject", "name": "title"}


def changes(before: Config, after: Config) -> List[str]:
    """Return a line for each difference; empty: there is none."""
    found = []
    for code in {**before.benchmarks, **after.benchmarks}:
        found += _of_benchmark(code, before.benchmarks.get(code), after.benchmarks.get(code))
    for team in {**before.passwords, **after.passwords}:
        old, new = before.passwords.get(team), after.passwords.get(team)
        if old != new:
            what = "added" if old is None else "removed" if new is None else "another password"
            found.append(f"team {quote(team)}: {what}")
    zones = {zone.name: zone for zone in before.zones}, {zone.name: zone for zone in after.zones}
    for name in {**zones[0], **zones[1]}:
        found += _of_zone(name, zones[0].get(name), zones[1].get(name))
    if not found and before != after:
        found.append("schedule: another order")
    return found


# -- benchmarks -------------------------------------------------------------------------------------


def _of_benchmark(code: str, before: Any, after: Any) -> List[str]:
    if before is None or after is None:
        return [f"benchmark {code}: {'added' if before is None else 'removed'}"]
    lines = _differences("", before, after)
    return [f"benchmark {code}: {line}" for line in lines]


def _differences(name: str, before: Any, after: Any) -> List[str]:
    """Return the differences of a value, with its name in the file."""
    if before == after:
        return []
    if is_dataclass(before) and type(before) is type(after):
        found = []
        for field in fields(before):
            label = _NAMES.get(field.name, field.name.replace("_", " "))
            if isinstance(before, Benchmark) and field.name == "own":
                found += _differences(label, before.profile, after.profile)
            else:
                found += _differences(label, getattr(before, field.name), getattr(after, field.name))
        return found
    if isinstance(before, tuple) and isinstance(after, tuple):
        return _of_items(name, before, after)
    return [f"{name} {_text(before)}, now {_text(after)}"]


def _of_items(name: str, before: Iterable[Any], after: Iterable[Any]) -> List[str]:
    """Return the differences of a sequence, such as the scoring items."""
    old, new = _by_name(before), _by_name(after)
    found = []
    for key in {**old, **new}:
        if key not in old or key not in new:
            found.append(f"{name}: {quote(key)} {'added' if key not in old else 'removed'}")
        elif old[key] != new[key]:
            found.append(f"{name}: {quote(key)} changed")
    return found or [f"{name}: another order"]


def _by_name(items: Iterable[Any]) -> Dict[str, Any]:
    return {": ".join(str(getattr(item, part)) for part in ("group", "desc", "name") if hasattr(item, part))
            or str(item): item for item in items}


def _text(value: Any) -> str:
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:g}" if abs(value) != float("inf") else "without limit"
    if isinstance(value, (frozenset, set)):
        return ", ".join(sorted(map(str, value))) or "nothing"
    return str(getattr(value, "value", value)) if not isinstance(value, str) else quote(value)


# -- the schedule -----------------------------------------------------------------------------------


def _of_zone(name: str, before: Any, after: Any) -> List[str]:
    where = f"zone {quote(name)}"
    if before is None or after is None:
        count = len((before or after).events)
        return [f"{where}: {'added' if before is None else 'removed'}, with {count} event{'s' if count > 1 else ''}"]
    old, new = _events(before), _events(after)
    found = []
    for run in {**old, **new}:
        gone = [utc for utc in old.get(run, []) if utc not in new.get(run, [])]
        come = [utc for utc in new.get(run, []) if utc not in old.get(run, [])]
        while gone and come:
            found.append(f"{where}: {_run(run)}: moved from {_time(gone.pop(0))} to {_time(come.pop(0))}")
        found += [f"{where}: {_run(run)}, {_time(utc)}: removed" for utc in gone]
        found += [f"{where}: {_run(run)}, {_time(utc)}: added" for utc in come]
    return found


def _events(zone: ZonePlan) -> Dict[_Run, List[float]]:
    """Return the times of the events of a zone, by run."""
    found: Dict[_Run, List[float]] = {}
    for event in zone.events:
        found.setdefault(_run_of(event), []).append(event.scheduled)
    return found


def _run_of(event: ScheduledEvent) -> _Run:
    return event.benchmark.code, event.team, event.round, event.run


def _run(run: _Run) -> str:
    return f"{run[0]} of {run[1]}, round {run[2]}, run {run[3]}"


def _time(utc: float) -> str:
    return datetime.datetime.fromtimestamp(utc, datetime.timezone.utc).strftime("%Y-%m-%d %H:%M:%S UTC")
