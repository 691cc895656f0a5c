"""Lists what differs between two configurations, for the organiser who takes the new one.

No line contains a password (docs/organiser.md, "Changes during the competition").
"""

import collections
from dataclasses import fields, is_dataclass
from typing import Any, Dict, Iterable, List, Mapping, NamedTuple, Optional

from roah_rsbb.model.rules import AttemptsRule, Item
from roah_rsbb.model.scoring import ScoreKind, SheetForm
from roah_rsbb.rulebook.benchmarks import Benchmark, Config, ScheduledEvent, ZonePlan
from roah_rsbb.rulebook.errors import quote
from roah_rsbb.rulebook.event_ids import EventKey, key_of
from roah_rsbb.rulebook.standing_rules import StandingRules
from roah_rsbb.wording.times import date_time

# The fields of a benchmark whose differences are listed by other names.
_NAMES = {"own": "", "rules": "", "desc": "subject", "name": "title", "least": "min", "most": "max"}
# Times in seconds, in files without this unit.
_SECONDS = {"limit_s": "time limit", "clock_s": "time of the run, of which some may be left"}
# Those of a benchmark by which its sheets are scored.
_ROWS = ((Benchmark, "scoring"), (SheetForm, "items"))
_OF_SHEET = ("scoring", "sheet")


def changes(before: Config, after: Config, ran: Iterable[EventKey] = ()) -> List[str]:
    """Return a line for each difference; empty: there is none. Those of events say what becomes of their runs.

    `ran`: the events of all runs, as they were then.
    """
    found, ran = [], list(ran)
    for code in {**before.benchmarks, **after.benchmarks}:
        found += _of_benchmark(code, before.benchmarks.get(code), after.benchmarks.get(code),
                               sum(key.benchmark == code for key in ran))
    for team in {**before.passwords, **after.passwords}:
        old, new = before.passwords.get(team), after.passwords.get(team)
        if old != new:
            what = "added" if old is None else "removed" if new is None else "another password"
            found.append(f"team {quote(team)}: {what}")
    found += _of_schedule(before, after, _Ran(ran))
    if before.durable != after.durable:
        found.append(f"durable: {before.durable.value}, now {after.durable.value}")
    if before.time_zone != after.time_zone:
        has_days = any(column.day for stage in after.ranking.stages for column in stage.of)
        found.append(f"time zone: {before.time_zone or 'none'}, now {after.time_zone or 'none'}"
                     + (". The days of the stages are those of the new one" if has_days else ""))
    for name, reading in _readings(after).items():
        if _readings(before).get(name, reading) != reading:
            found.append(f"decision {quote(name)}: {_readings(before)[name]}, now {reading}")
    found += _of_ranking(before.ranking, after.ranking)
    if not found and before != after:
        found.append("schedule: another order")
    return found


def _readings(files: Config) -> Dict[str, str]:
    """Return which reading of each choice holds."""
    return {decision.name: decision.chosen for decision in files.decisions}


def _of_ranking(before: StandingRules, after: StandingRules) -> List[str]:
    """Return the differences of the rules of the standings."""
    found = [f"standings of {code}: other rules" for code in {**before, **after} if before.get(code) != after.get(code)]
    found += differences("stages", before.stages, after.stages)
    for old, new, what in ((before, after, "no longer given"), (after, before, "given")):
        left = collections.Counter(map(str, old.adjusted)) - collections.Counter(map(str, new.adjusted))
        found += [f"team {text}: {what}" for text in left.elements()]
    return found


# -- benchmarks -------------------------------------------------------------------------------------


def _of_benchmark(code: str, before: Any, after: Any, ran: int) -> List[str]:
    """Return the differences of a benchmark, and what becomes of its runs, whose number is `ran`."""
    if before is None or after is None:
        return [f"benchmark {code}: {'added' if before is None else 'removed'}"]
    lines = differences("", before, after)
    if ran and any(getattr(before, name) != getattr(after, name) for name in _OF_SHEET):
        lines.append("1 run keeps the old score sheet" if ran == 1 else f"{ran} runs keep the old score sheet")
    return [f"benchmark {code}: {line}" for line in lines]


def differences(name: str, before: Any, after: Any) -> List[str]:
    """Return the differences of a value, with its name in the file."""
    if before == after:
        return []
    known = after if before is None else before
    if is_dataclass(known) and type(known).__str__ is object.__str__ and None in (before, after):
        return [f"{name}: {'added' if before is None else 'removed'}"]
    if is_dataclass(before) and type(before) is type(after) and not isinstance(before, AttemptsRule):
        found = []
        for field in fields(before):
            label = _NAMES.get(field.name, field.name.replace("_", " "))
            if (type(before), field.name) in _ROWS and getattr(before, "sheet", None) != getattr(after, "sheet", None):
                continue  # its rows are those of the sheet
            if not field.compare:
                continue  # what follows from other fields
            values = getattr(before, field.name), getattr(after, field.name)
            if field.name in _SECONDS and values[0] != values[1]:
                words = ("none" if value is None else f"{value:g} s" for value in map(_float, values))
                found.append(f"{_SECONDS[field.name]} {', now '.join(words)}")
            elif isinstance(before, Benchmark) and field.name == "own":
                found += differences(label, before.profile, after.profile)
            else:
                found += differences(label, *values)
        return found
    if isinstance(before, tuple) and isinstance(after, tuple):
        return _of_items(name, before, after)
    words = (("any number" if name == "attempts" and not value else _text(value)) for value in (before, after))
    return [f"{name} {', now '.join(words)}"]


def _of_items(name: str, before: Iterable[Any], after: Iterable[Any]) -> List[str]:
    """Return the differences of a sequence, such as the scoring items."""
    old, new = _by_name(before), _by_name(after)
    found = []
    for key in {**old, **new}:
        item = old.get(key, new.get(key))
        if key not in old or key not in new:
            found.append(f"{name}: {quote(_name(item))} {'added' if key not in old else 'removed'}")
        elif old[key] != new[key]:
            found.append(f"{name}: {quote(_name(item))}: {', '.join(differences('', old[key], new[key]))}")
    return found or [f"{name}: another order"]


def _float(value: Any) -> Optional[float]:
    return None if value is None else float(value)


def _by_name(items: Iterable[Any]) -> Dict[str, Any]:
    return {item.id if isinstance(item, Item) else _name(item): item for item in items}


def _name(item: Any) -> str:
    """Return what an item of a sequence is called. Rows of a sheet may have one name, and then have ids."""
    name = ": ".join(str(getattr(item, part)) for part in ("group", "desc", "name") if hasattr(item, part))
    has_id = isinstance(item, Item) and item.id != name
    return f"{name} ({item.id})" if has_id else name or str(item)


def _text(value: Any) -> str:
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, ScoreKind):
        return value.word
    if isinstance(value, float):
        return f"{value:g}" if abs(value) != float("inf") else "without limit"
    if isinstance(value, (frozenset, set)):
        return ", ".join(sorted(map(str, value))) or "nothing"
    return str(getattr(value, "value", value)) if not isinstance(value, str) else quote(value)


# -- the schedule -----------------------------------------------------------------------------------


class _Planned(NamedTuple):
    """An event and the name of its zone."""

    zone: str
    event: ScheduledEvent

    @property
    def text(self) -> str:
        """The zone and the run."""
        return f"zone {quote(self.zone)}: {_run(self.event)}"


def _planned(config: Config) -> Dict[object, _Planned]:
    """Return the events by what they are known by."""
    return {event.id or (zone.name, key_of(event)): _Planned(zone.name, event)
            for zone in config.zones for event in zone.events}


class _Ran:
    """The runs that there were at events."""

    def __init__(self, ran: Iterable[EventKey]) -> None:
        self._counts = collections.Counter((key.id, key.benchmark, key.team) for key in ran)

    def count(self, *events: ScheduledEvent) -> int:
        """Return how many runs were attempts at these events."""
        return sum(self._counts[event.id, event.benchmark.code, event.team] for event in events if event.id)

    def text(self, event: ScheduledEvent, one: str, several: str) -> str:
        """Say what becomes of the runs of an event; empty: there was none."""
        count = self.count(event)
        return "" if not count else f". Its run {one}" if count == 1 else f". Its {count} runs {several}"


def _of_schedule(before: Config, after: Config, ran: _Ran) -> List[str]:
    old, new = _planned(before), _planned(after)
    zones, zones_now = ({zone.name: zone for zone in config.zones} for config in (before, after))
    found = []
    for key, was in old.items():
        now = new.get(key)
        if now is not None:
            found += _of_event(was, now, was.zone in zones_now, ran)
        elif was.zone in zones_now:
            found.append(f"{was.text}, {_time(was.event)}: removed"
                         f"{ran.text(was.event, 'stays in the results', 'stay in the results')}")
    for key, now in new.items():
        if key not in old and now.zone in zones:
            found.append(f"{now.text}, {_time(now.event)}: added"
                         f"{ran.text(now.event, 'before belongs to it', 'before belong to it')}")
    found += [_of_removed(zone, old, new, ran) for zone in before.zones if zone.name not in zones_now]
    return found + [f"zone {quote(zone.name)}: added, with {_events(zone)}"
                    for zone in after.zones if zone.name not in zones]


def _of_removed(
    zone: ZonePlan, old: Mapping[object, _Planned], new: Mapping[object, _Planned], ran: _Ran
) -> str:
    """Say what becomes of the events of a zone that is removed, and of their runs."""
    own = [key for key, event in old.items() if event.zone == zone.name]
    moved = collections.Counter(new[key].zone for key in own if key in new)
    parts = [f"{count} move{'s' if count == 1 else ''} to zone {quote(name)}" for name, count in moved.items()]
    count = ran.count(*(old[key].event for key in own if key not in new))
    lost = "" if not count else f". {count} run{' stays' if count == 1 else 's stay'} in the results"
    return (f"zone {quote(zone.name)}: removed, with {_events(zone)}{': ' if parts else ''}{', '.join(parts)}{lost}")


def _of_event(was: _Planned, now: _Planned, zone_stays: bool, ran: _Ran) -> List[str]:
    """Say how an event changed. That its whole zone was removed, or has another name, is said of the zone."""
    is_moved = was.event.scheduled != now.event.scheduled
    zone = f"zone {quote(now.zone)}, " if now.zone != was.zone else ""
    to = f"{zone}{_time(now.event)}"
    if key_of(was.event).turn != key_of(now.event).turn:
        moved = f", moved to {to}" if is_moved or zone else ""
        return [f"{was.text}, {_time(was.event)}: now {_run(now.event)}{moved}{_kept(was, now, ran)}"]
    if is_moved or (zone and zone_stays):
        return [f"{was.text}: moved from {_time(was.event)} to {to}{_kept(was, now, ran)}"]
    return []


def _kept(was: _Planned, now: _Planned, ran: _Ran) -> str:
    return "" if _is_other(was, now) else ran.text(was.event, "stays with it", "stay with it")


def _is_other(was: _Planned, now: _Planned) -> bool:
    """Return whether the runs before are no attempts at the event any more."""
    return (was.event.benchmark.code, was.event.team) != (now.event.benchmark.code, now.event.team)


def warnings(before: Config, after: Config, ran: Iterable[EventKey]) -> List[str]:
    """Return a warning for each event that has the id of one of another team or benchmark, of which there were runs.

    `ran`: the events of all runs, as they were then.
    """
    new, counts = _planned(after), _Ran(ran)
    found = []
    for key, was in _planned(before).items():
        now = new.get(key)
        count = counts.count(was.event)
        if now is not None and count and _is_other(was, now):
            one = count == 1
            found.append(
                f"{was.text} is {_run(now.event)} now. Its {'run' if one else f'{count} runs'} before "
                f"{'stays a result' if one else 'stay results'} of {was.event.benchmark.code} of {was.event.team}, "
                f"and {'is no attempt' if one else 'are no attempts'} at this event. If it is another event, delete "
                f"its id ({now.event.id}) in the schedule file")
    return found


def _events(zone: ZonePlan) -> str:
    return f"{len(zone.events)} event{'s' if len(zone.events) > 1 else ''}"


def _run(event: ScheduledEvent) -> str:
    return f"{event.benchmark.code} of {event.team}, round {event.round}, run {event.run}"


def _time(event: ScheduledEvent) -> str:
    return date_time(event.scheduled)
