"""Edits of the day: what an organiser changes in the schedule in force, as changes of events (docs/organiser.md, "The
day is edited").

An edit is a list of changes, each with an event's slot before and after. What an edit does, its words, its undoing and
the text of the schedule file (`schedule_text`) are made of these alone, so no event is lost that no change removes.
"""

import datetime
import re
from typing import Any, Callable, Container, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.reason import Reason, Refused, say
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, NO_LIMIT, Benchmark, ScheduledEvent, ZonePlan
from roah_rsbb.rulebook.event_ids import new_id
from roah_rsbb.wording.times import day_of, formatted, offset_s

# A team has less time than this from one zone to the next: it is warned.
LEAST_GAP_S = 600.0
# Between two runs of a zone, if the schedule has no such gap, besides the longest one (s).
SET_UP_S = 300.0
MINUTE_S = 60.0
FEW = 2  # events that are named one by one

NO_EVENT = say("The schedule has no such event any more: look at it again")
IS_OVER = say("{event} is over, or in progress: 'repeat' gives the team another one")
NONE_TO_COME = say("Zone '{zone}' has no event to come")
NO_ZONE = say("There is no zone '{zone}'")
LAST_OF_ZONE = say("{event} is the only event of zone '{zone}', which cannot be empty")
BAD_TIME = say("'{text}' is no time: expected such as 14:20, or 2026-11-29 14:20")
BAD_SHIFT = say("'{text}' is no delay: expected minutes such as 40 or -10, or the time of the next event such as 14:20")
NO_SUCH_TIME = say("{text} does not exist: the clocks skip it")
TOO_FAR = say("That is more than a day: move the events")
NOTHING = say("Nothing would change")
SAME = say("Choose two different events")
CHANGED = say("{event} was changed since: nothing was undone")
FEW_PLACES = say("{number} teams advance, and {places} events of {test} are planned: give the time of the first one, "
                 "and the zone")
KNOWN_TEAM = say("Team {team} is there already")

MOVED, ADDED = say("{event}: {time} instead of {before}"), say("{event}: {time} in zone '{zone}', added")
REMOVED = say("{event}: removed (it was at {time} in zone '{zone}')")
MOVED_TO_ZONE = say("{event}: {time} in zone '{zone}' instead of {before} in zone '{other}'")
AT_ONCE = say("Team {team} is in two zones at once: {event} at {time}, {other} at {then}")
SHORT = say("Team {team} has less than {minutes} minutes between {event} ({time}) and {other} ({then})")
CROWDED = say("Zone '{zone}': {other} at {then} begins before the end of {event} ({time})")
PAST, ALL_PAST = say("{event}: {time} has passed"), say("{number} events are at times that have passed")
MIDNIGHT = say("{event} at {time} ends after midnight")
_RUN = say("{code} of {team}")


class PlannedSlot(NamedTuple):
    """An event and its place in the day."""

    zone: str
    benchmark: str  # code
    team: str
    round: int
    run: int
    scheduled: float  # UTC seconds

    @property
    def name(self) -> Reason:
        """What a person calls it."""
        return _RUN(code=self.benchmark, team=self.team)


class EventChange(NamedTuple):
    """What becomes of an event."""

    id: str
    before: Optional[PlannedSlot]  # None: it is new
    after: Optional[PlannedSlot]  # None: it is removed


Slots = Dict[str, PlannedSlot]  # by id


class Day(NamedTuple):
    """The schedule that is edited."""

    zones: Sequence[ZonePlan]
    open: Container[str]  # ids of the events that may be changed: not over, and not in progress
    to_come: Container[str]  # of these, the ones that their zone has not passed
    now_utc: float

    @property
    def slots(self) -> Slots:
        """All events."""
        return slots(self.zones)

    @property
    def today(self) -> str:
        """The day of now, as 2026-11-29."""
        return day_of(self.now_utc)


def slots(zones: Iterable[ZonePlan]) -> Slots:
    """Return the events of a schedule."""
    return {event.id: _slot(zone.name, event) for zone in zones for event in zone.events}


def _slot(zone: str, event: ScheduledEvent) -> PlannedSlot:
    return PlannedSlot(zone, event.benchmark.code, event.team, event.round, event.run, event.scheduled)


def applied(found: Slots, changes: Iterable[EventChange]) -> Slots:
    """Return a schedule after changes. Raises `Refused` if an event is not as it was before them."""
    after = dict(found)
    for change in changes:
        if after.get(change.id) != change.before:
            raise Refused([CHANGED(event=(change.before or change.after).name)])  # type: ignore[union-attr]
        if change.after is None:
            del after[change.id]
        else:
            after[change.id] = change.after
    return after


def undone(changes: Iterable[EventChange]) -> List[EventChange]:
    """Return the changes that undo these."""
    return [EventChange(change.id, change.after, change.before) for change in changes]


# -- what can be done -------------------------------------------------------------------------------

Given = Mapping[str, Any]


def shift(day: Day, given: Given) -> List[EventChange]:
    """All events of a zone that are still to come, on the day of the first of them."""
    zone = _zone(day, given["zone"])
    coming = [event for event in zone.events if event.id in day.to_come]
    if not coming:
        raise Refused([NONE_TO_COME(zone=zone.name)])
    when = day.today if any(day_of(event.scheduled) == day.today for event in coming) else day_of(coming[0].scheduled)
    today = [event for event in coming if day_of(event.scheduled) == when]
    text, first = given["time"].strip(), today[0].scheduled
    minutes = re.fullmatch(r"([+-]?[0-9]{1,4})( ?min)?", text)
    try:
        by_s = int(minutes.group(1)) * MINUTE_S if minutes else moment(text, first) - first
    except Refused as refused:
        raise (Refused([BAD_SHIFT(text=text)]) if refused.reasons == [BAD_TIME(text=text)] else refused) from None
    if abs(by_s) >= 86400.0:
        raise Refused([TOO_FAR])
    return _moved(day, {event.id: (zone.name, event.scheduled + by_s) for event in today})


def move(day: Day, given: Given) -> List[EventChange]:
    """An event, to another time, zone or day."""
    slot = _open(day, given["event"])
    zone = _zone(day, given["zone"]).name if given["zone"] else slot.zone
    return _moved(day, {given["event"]: (zone, moment(given["time"], slot.scheduled, slot.scheduled))})


def swap(day: Day, given: Given) -> List[EventChange]:
    """Two events exchange their times and zones."""
    one, other = given["event"], given["other"]
    if one == other:
        raise Refused([SAME])
    first, second = _open(day, one), _open(day, other)
    return _moved(day, {one: (second.zone, second.scheduled), other: (first.zone, first.scheduled)})


def remove(day: Day, given: Given) -> List[EventChange]:
    """An event that will not take place."""
    return _kept([EventChange(given["event"], _open(day, given["event"]), None)], day)


def insert(day: Day, given: Given) -> List[EventChange]:
    """A new event."""
    zone = _zone(day, given["zone"])
    near = next((event.scheduled for event in zone.events if day_of(event.scheduled) == day.today), day.now_utc)
    at = moment(given["time"], near)
    same = [slot for slot in day.slots.values() if slot.benchmark == given["benchmark"]]
    rounds = [slot.round for slot in same if day_of(slot.scheduled) == day_of(at)] or [slot.round for slot in same]
    return _added(day, PlannedSlot(zone.name, given["benchmark"], given["team"], max(rounds, default=1), 1, at))


def repeat(day: Day, given: Given) -> List[EventChange]:
    """Another event of the same team, benchmark and round; usually after the zone's last one of that day."""
    slot = day.slots.get(given["event"])
    if slot is None:
        raise Refused([NO_EVENT])
    zone = _zone(day, given["zone"] or slot.zone)
    when = max(day.today, day_of(slot.scheduled))
    ends = [event.scheduled + interval_s(zone.events) for event in zone.events if day_of(event.scheduled) == when]
    after = max([*ends, _whole_minute(day.now_utc)] if when == day.today else ends, default=slot.scheduled)
    return _added(day, slot._replace(zone=zone.name, scheduled=moment(given["time"], after, after)))


def add_team(day: Day, given: Given) -> List[EventChange]:
    """A late team: each benchmark and round that other teams do from today on."""
    if any(slot.team == given["team"] for slot in day.slots.values()):
        raise Refused([KNOWN_TEAM(team=given["team"])])
    days = {day_of(slot.scheduled) for slot in day.slots.values()}
    late = late_team(day.zones, given["team"], [each for each in days if each >= day.today], day.now_utc)
    return [EventChange(new_id(day.slots), None, slot) for slot in late]


def advance(day: Day, given: Given, teams: Sequence[str], tests: Sequence[Benchmark]) -> List[EventChange]:
    """Teams that advanced, the best one first, take the events of the tests that only they run: the best one the last.
    Those that are left are removed. With a time, the first event begins there."""
    changes: List[EventChange] = []
    at = moment(given["time"], day.now_utc, 0.0)
    zone = given["zone"] and _zone(day, given["zone"]).name
    for test in tests:
        same = {event: slot for event, slot in day.slots.items() if slot.benchmark == test.code}
        for number in sorted({slot.round for slot in same.values()} or {1}):
            planned = sorted((slot.scheduled, event) for event, slot in same.items()
                             if slot.round == number and event in day.open)
            begun = {slot.team for event, slot in same.items() if slot.round == number and event not in day.open}
            waiting = [team for team in teams[::-1] if team not in begun]
            places = [same[event]._replace(zone=zone or same[event].zone) for _, event in planned]
            where = places[0].zone if places else zone
            begin = at or (places[0].scheduled if given["minutes"] and places else 0.0)
            if begin and where:
                by_s = given["minutes"] * MINUTE_S or planned_s(test) + SET_UP_S
                places = [PlannedSlot(where, test.code, "", number, 1, begin + place * by_s)
                          for place in range(len(waiting))]
                at = at and begin + len(waiting) * by_s
            if len(places) < len(waiting):
                raise Refused([FEW_PLACES(number=len(waiting), places=len(places), test=test.code)])
            left = {same[event].team: event for _, event in planned}
            for team, place in zip(waiting, places):
                event = left.pop(team, "") or new_id(day.slots)
                changes.append(EventChange(event, same.get(event), place._replace(team=team)))
            changes += [EventChange(event, same[event], None) for event in left.values()]
    return _kept([change for change in changes if change.before != change.after], day)


EDITS: Dict[str, Callable[[Day, Given], List[EventChange]]] = {
    each.__name__: each for each in (shift, move, swap, remove, insert, repeat, add_team)}


def _zone(day: Day, name: str) -> ZonePlan:
    found = next((zone for zone in day.zones if zone.name == name), None)
    if found is None:
        raise Refused([NO_ZONE(zone=name)])
    return found


def _open(day: Day, event: str) -> PlannedSlot:
    """Return an event that may be changed. Raises `Refused`."""
    slot = day.slots.get(event)
    if slot is None:
        raise Refused([NO_EVENT])
    if event not in day.open:
        raise Refused([IS_OVER(event=slot.name)])
    return slot


def _moved(day: Day, to: Mapping[str, Tuple[str, float]]) -> List[EventChange]:
    before = day.slots
    found = [EventChange(event, before[event], before[event]._replace(zone=zone, scheduled=scheduled))
             for event, (zone, scheduled) in to.items()]
    return _kept([change for change in found if change.before != change.after], day)


def _added(day: Day, slot: PlannedSlot) -> List[EventChange]:
    """Add an event with a number that no other one of the team in this round has."""
    taken = {other.run for other in day.slots.values() if other[1:4] == slot[1:4]}
    return [EventChange(new_id(day.slots), None, slot._replace(run=max(taken, default=0) + 1))]


def _kept(changes: List[EventChange], day: Day) -> List[EventChange]:
    """Return changes that leave an event in every zone. Raises `Refused`."""
    if not changes:
        raise Refused([NOTHING])
    left = {slot.zone for slot in applied(day.slots, changes).values()}
    for change in changes:
        if change.before is not None and change.before.zone not in left:
            raise Refused([LAST_OF_ZONE(event=change.before.name, zone=change.before.zone)])
    return changes


# -- times ------------------------------------------------------------------------------------------

_TIME = re.compile(r"(?:([0-9]{4}-[0-9]{2}-[0-9]{2}))?(?:(?:^| )([0-9]{1,2}):([0-9]{2}))?")


def moment(text: str, near_utc: float, default: Optional[float] = None) -> float:
    """Return the UTC seconds of a typed time at the venue, on the day of `near_utc` unless it has a day; of a day
    alone, the time of day of `near_utc`. `default`: of an empty text. Raises `Refused`."""
    text = " ".join(text.split())
    if not text and default is not None:
        return default
    found = _TIME.fullmatch(text)
    if not text or found is None:
        raise Refused([BAD_TIME(text=text)])
    day = found.group(1) or day_of(near_utc)
    clock = f"{int(found.group(2)):02}:{found.group(3)}" if found.group(2) else formatted(near_utc, "%H:%M", False)
    try:
        local = datetime.datetime.strptime(f"{day} {clock}", "%Y-%m-%d %H:%M").replace(tzinfo=datetime.timezone.utc)
    except ValueError:
        raise Refused([BAD_TIME(text=text)]) from None
    utc = local.timestamp()
    utc -= offset_s(utc - offset_s(utc))
    if formatted(utc, "%H:%M", False) != clock:
        raise Refused([NO_SUCH_TIME(text=text)])
    return utc


def _whole_minute(utc: float) -> float:
    return -(-utc // MINUTE_S) * MINUTE_S


def planned_s(benchmark: Benchmark) -> float:
    """Seconds that a run takes in a plan: set-up and limit. Without a limit, only the set-up counts."""
    return benchmark.rules.setup_time + (benchmark.total_timeout if benchmark.total_timeout < NO_LIMIT else 0.0)


def interval_s(events: Sequence[ScheduledEvent]) -> float:
    """The shortest interval between two runs of a zone (s), or a longer one that its longest benchmark needs."""
    longest = max(planned_s(event.benchmark) for event in events)
    gaps = [after.scheduled - before.scheduled for before, after in zip(events, events[1:])]
    gap = min((gap for gap in gaps if gap > 0), default=0.0)
    return gap if gap >= longest else longest + SET_UP_S


def late_team(
    zones: Sequence[ZonePlan], team: str, days: Optional[Container[str]] = None, from_utc: float = 0.0
) -> List[PlannedSlot]:
    """Return the runs of a late team: each benchmark and round that other teams do, once.

    A run comes at the end of the day, in the zone and on the day where other teams do this round of the benchmark last,
    and not before `from_utc`. `days`: consider only these.
    """
    lasts: Dict[Tuple[str, int], Tuple[str, str]] = {}
    interval = {zone.name: interval_s(zone.events) for zone in zones}
    ends: Dict[Tuple[str, str], float] = {}
    free: Dict[str, float] = {}  # for the late team
    planned = [_slot(zone.name, event) for zone in zones for event in zone.events]
    for slot in sorted(planned, key=lambda slot: slot.scheduled):
        day, end = day_of(slot.scheduled), slot.scheduled + interval[slot.zone]
        ends[slot.zone, day] = end
        if slot.team == ALL_TEAMS:
            free[day] = max(end, free.get(day, end))
        elif days is None or day in days:
            lasts[slot.benchmark, slot.round] = slot.zone, day
    found: List[PlannedSlot] = []
    for (code, number), place in sorted(lasts.items(), key=lambda item: ends[item[1]]):
        zone, day = place
        begins = max(ends[place], free.get(day, ends[place]), _whole_minute(from_utc))
        ends[place] = free[day] = begins + interval[zone]
        found.append(PlannedSlot(zone, code, team, number, 1, begins))
    return found


# -- effects in words -------------------------------------------------------------------------------


def words(changes: Iterable[EventChange], today: str) -> List[Reason]:
    """Say what changes do, in the order of the new times."""
    ordered = sorted(changes, key=lambda change: (change.after or change.before).scheduled)  # type: ignore[union-attr]
    return [_words(change, today) for change in ordered]


def _words(change: EventChange, today: str) -> Reason:
    before, after = change.before, change.after
    if after is None:
        assert before is not None, "a change has one of them"
        return REMOVED(event=before.name, time=shown(before.scheduled, today), zone=before.zone)
    time = shown(after.scheduled, today)
    if before is None:
        return ADDED(event=after.name, time=time, zone=after.zone)
    same = day_of(before.scheduled)
    was = shown(before.scheduled, same if same == day_of(after.scheduled) else today)
    if before.zone != after.zone:
        return MOVED_TO_ZONE(event=after.name, time=time, zone=after.zone, before=was, other=before.zone)
    return MOVED(event=after.name, time=time, before=was)


def shown(utc: float, today: str) -> str:
    """Return a time of day, with its day if that is not today."""
    return formatted(utc, "%H:%M" if day_of(utc) == today else "%Y-%m-%d %H:%M", in_utc=False)


class Clash(NamedTuple):
    """Two events that are too near, the earlier one first."""

    zone: str  # where both are; empty: a team's, in two zones
    team: str
    first: Tuple[str, ScheduledEvent]  # with the zone
    second: Tuple[str, ScheduledEvent]

    @property
    def gap_s(self) -> float:
        """Seconds between them; below 0: they overlap."""
        return self.second[1].scheduled - self.first[1].scheduled - planned_s(self.first[1].benchmark)


def clashes(zones: Iterable[ZonePlan], least_s: float = 0.0) -> List[Clash]:
    """Return the events that begin before an earlier one of the same zone has ended, or less than `least_s` after the
    end of one of the same team in another zone."""
    found: List[Clash] = []
    in_zone: Dict[str, ScheduledEvent] = {}
    of_team: Dict[str, Tuple[str, ScheduledEvent]] = {}
    for zone, event in sorted(((plan.name, event) for plan in zones for event in plan.events),
                              key=lambda entry: entry[1].scheduled):
        here = zone, event
        if zone in in_zone:
            found += [clash for clash in (Clash(zone, "", (zone, in_zone[zone]), here),) if clash.gap_s < 0]
        in_zone[zone] = event
        for team, busy in of_team.items():
            if (team == event.team or ALL_TEAMS in (team, event.team)) and busy[0] != zone:
                clash = Clash("", event.team if team == ALL_TEAMS else team, busy, here)
                found += [clash] if clash.gap_s < least_s else []
        of_team[event.team] = here
    return found


def warnings(day: Day, after: Sequence[ZonePlan], changes: Iterable[EventChange]) -> List[Reason]:
    """Say what is worse in a schedule after changes than it was."""
    known = {_clash_words(clash, day.today) for clash in clashes(day.zones, LEAST_GAP_S)}
    found = [text for text in (_clash_words(clash, day.today) for clash in clashes(after, LEAST_GAP_S))
             if text not in known]
    past: List[Reason] = []
    lengths = {event.id: planned_s(event.benchmark) for zone in after for event in zone.events}
    for change in changes:
        if change.after is None:
            continue
        begins, time = change.after.scheduled, shown(change.after.scheduled, day.today)
        if begins < day.now_utc and (change.before is None or change.before.scheduled > begins):
            past.append(PAST(event=change.after.name, time=time))
        if day_of(begins) != day_of(begins + max(0.0, lengths.get(change.id, 0.0) - 1.0)):
            found.append(MIDNIGHT(event=change.after.name, time=time))
    found += past if len(past) <= FEW else [ALL_PAST(number=len(past))]
    return list(dict.fromkeys(found))


def _clash_words(clash: Clash, today: str) -> Reason:
    first, second = _slot(*clash.first), _slot(*clash.second)
    when = {"time": shown(first.scheduled, today), "then": shown(second.scheduled, today)}
    if clash.zone:
        return CROWDED(zone=clash.zone, event=first.name, other=second.name, **when)
    codes = {"event": first.benchmark, "other": second.benchmark}
    if clash.gap_s < 0:
        return AT_ONCE(team=clash.team, **codes, **when)
    return SHORT(team=clash.team, minutes=round(LEAST_GAP_S / MINUTE_S), **codes, **when)
