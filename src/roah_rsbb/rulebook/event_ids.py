"""Ids of events: what an event is known by, whatever its time, zone, place in the schedule or team becomes.

The schedule file has them in the key `id`. `new_competition` writes them, and so does a reload where they are missing.
An event without one gets the id that `known_by` makes of its benchmark, team, round, run and day, so that it is the
same event after each start, and after a move within the day.
"""

import datetime
import hashlib
import re
import secrets
from dataclasses import replace
from typing import Container, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

from roah_rsbb.rulebook.benchmarks import ScheduledEvent, ZonePlan

VALID = re.compile("[A-Za-z][A-Za-z0-9_-]{0,39}")
_LINES = re.compile(r"[^\r\n]*(?:\r\n|\r|\n)|[^\r\n]+")
# Without letters that look alike, and so that no id looks like a number in YAML.
_LETTERS, _SIGNS = "abcdefghjkmnpqrstuvwxyz", "abcdefghjkmnpqrstuvwxyz23456789"
_LENGTH = 8
# An event without an id that is moved by more is another event.
SAME_S = 36_000.0


class EventKey(NamedTuple):
    """Identifies an event of a schedule: its id, or without one the rest. Its other properties are in the benchmarks
    file."""

    benchmark: str  # code
    team: str
    round: int
    run: int
    scheduled: float  # UTC seconds
    id: str = ""

    @property
    def turn(self) -> Tuple[object, ...]:
        """What identifies an event without an id whose time may have changed."""
        return self[:4]


def key_of(event: ScheduledEvent) -> EventKey:
    """Return the key of an event."""
    return EventKey(event.benchmark.code, event.team, event.round, event.run, event.scheduled, event.id)


def new_id(taken: Container[str] = ()) -> str:
    """Return an id for a new event."""
    while True:
        found = secrets.choice(_LETTERS) + "".join(secrets.choice(_SIGNS) for _ in range(_LENGTH - 1))
        if found not in taken:
            return found


def known_by(event: ScheduledEvent, taken: Container[str]) -> str:
    """Return the id of an event that has none: always the same one, as long as it is not taken."""
    day = datetime.datetime.fromtimestamp(event.scheduled, datetime.timezone.utc).date()
    number = 0
    while True:
        number += 1
        words = (event.benchmark.code, event.team, event.round, event.run, day, number)
        digest = int.from_bytes(hashlib.sha256(repr(tuple(map(str, words))).encode()).digest()[:8], "big")
        found = _LETTERS[digest % len(_LETTERS)]
        for _ in range(_LENGTH - 1):
            digest //= len(_SIGNS)
            found += _SIGNS[digest % len(_SIGNS)]
        if found not in taken:
            return found


def adopted(
    zones: Sequence[ZonePlan], before: Sequence[ZonePlan], past: Iterable[EventKey] = ()
) -> Tuple[ZonePlan, ...]:
    """Return a schedule whose events without an id have those of the same events in the schedule `before`, or else of
    the events of runs (`past`): the same benchmark and team at the same time, or with the same round and run at most
    `SAME_S` away."""
    named = {event.id for event in _events(zones) if event.id_goes is None}
    free: Dict[Tuple[object, ...], List[Tuple[bool, EventKey]]] = {}
    for is_past, keys in ((False, map(key_of, _events(before))), (True, past)):
        for key in keys:
            if key.id and key.id not in named:
                free.setdefault(key.turn[:2], []).append((is_past, key))
    found: Dict[int, str] = {}
    # The nearest ones first, so that an event that did not move keeps its id.
    pairs = sorted((
        (is_past, abs(old.scheduled - event.scheduled), place, old) for place, event in enumerate(_events(zones))
        if event.id_goes is not None for is_past, old in free.get(key_of(event).turn[:2], ())
        if old.scheduled == event.scheduled or old.turn == key_of(event).turn), key=lambda pair: pair[:3])
    for _, distance_s, place, old in pairs:
        if distance_s <= SAME_S and place not in found and old.id not in named:
            found[place] = old.id
            named.add(old.id)
    numbered = iter(range(sum(len(zone.events) for zone in zones)))
    return tuple(replace(zone, events=tuple(
        replace(event, id=_of(event, found.get(place), named)) for event, place in zip(zone.events, numbered)))
        for zone in zones)


def _of(event: ScheduledEvent, found: Optional[str], named: Set[str]) -> str:
    """Return the id of an event: its own, the one that was found, or one that no other event has."""
    if found is not None:
        return found
    if event.id_goes is None:
        return event.id
    own = event.id if event.id not in named else known_by(event, named)
    named.add(own)
    return own


def _events(zones: Sequence[ZonePlan]) -> Iterator[ScheduledEvent]:
    return (event for zone in zones for event in zone.events)


def written(text: str, zones: Sequence[ZonePlan]) -> str:
    """Return the text of a schedule file with the ids that are missing in it. Comments and layout stay."""
    mark = "\ufeff" if text.startswith("\ufeff") else ""  # places do not count it
    lines = _LINES.findall(text[len(mark):])
    newline = "\r\n" if lines and lines[0].endswith("\r\n") else "\n"
    missing = [(event.id_goes, event.id) for event in _events(zones) if event.id_goes is not None]
    for place, own in sorted(missing, reverse=True):
        line, column = lines[place.line - 1], place.column - 1
        if line[column] == "{":
            before, after = line[:column + 1], line[column + 1:]
            gap = after[:len(after) - len(after.lstrip(" "))]
            lines[place.line - 1] = f"{before}{gap}id: {own},{gap or ' '}{after[len(gap):]}"
        else:  # keys under each other
            lines[place.line - 1] = f"{line[:column]}id: {own}{newline}{' ' * column}{line[column:]}"
    return mark + "".join(lines)
