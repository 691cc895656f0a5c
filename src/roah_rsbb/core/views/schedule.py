"""The schedule as the referees see it: what is done, what runs, what comes next (docs/web.md, "The whole box").

Estimated times. No event begins before its scheduled time. An event that is late delays the later events of its zone,
and gaps in the schedule absorb the delay. An event takes as long as the schedule gives its benchmark: the shortest
time from an event of this benchmark to the zone's next one, but at most its time limit and its setup time, which is
`SETUP_S` unless the rules have one. A run that takes longer is assumed to end now. Zones do not delay each other.
"""

import bisect
import enum
import math
from typing import Dict, Iterable, List, NamedTuple, Optional, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.core.views.sheets import sums_of_record
from roah_rsbb.core.zones import Zone
from roah_rsbb.model.clock import Now
from roah_rsbb.model.records import RAN_TO_THE_END, Phase, RunRecord
from roah_rsbb.model.results import EventSeen
from roah_rsbb.rulebook.benchmarks import NO_LIMIT, Benchmark, ScheduledEvent, ZonePlan
from roah_rsbb.scoring.counting import EventResult

# The longest time in seconds in which the next robot gets ready. A longer gap is a break.
SETUP_S = 900.0
# The assumed length of a run without a limit.
NO_LIMIT_S = 3600.0
# Estimates are whole minutes: they change once a minute at most.
MINUTE_S = 60.0

_THE_END = {reason.name.lower() for reason in RAN_TO_THE_END}


class EventState(enum.Enum):
    """The state of an event of the schedule."""

    DONE = "done"  # one of its runs is over
    CONNECTED = "connected"  # in its zone now, as the next three
    RUNNING = "running"
    ENDED = "ended"  # the run is over, but still connected
    NEXT = "next"
    LATER = "later"
    SKIPPED = "skipped"  # its zone went past it without a run


_OF_PHASE = {
    Phase.CONNECTED: EventState.CONNECTED, Phase.RUNNING: EventState.RUNNING, Phase.ENDED: EventState.ENDED,
}
_TO_COME = (EventState.CONNECTED, EventState.NEXT, EventState.LATER)
_IN_PROGRESS = (EventState.RUNNING, EventState.ENDED)


class EventLine(NamedTuple):
    """An event of the schedule."""

    zone: str
    event: ScheduledEvent
    current: bool  # its zone is at this event
    state: EventState
    begins: float  # UTC seconds: when it began, or the estimated time
    last: Optional[RunRecord]  # its last run that is over; None: no such run
    result: Optional[EventResult] = None  # None: no run is over


def schedule(box: Box, now: Now) -> List[EventLine]:
    """All events of all zones, in the order of their scheduled times."""
    slots = slot_lengths(ZonePlan(zone.name, zone.events) for zone in box.zones.values())
    last, results = box.zones.last_runs(box.finished.records()), box.scores.results(now)
    lines = [line for zone in box.zones.values() for line in _zone_lines(zone, last, results, slots, now)]
    return sorted(lines, key=lambda line: line.event.scheduled)


class ScheduleView:
    """The schedule of a box, for a caller that needs it often. It is only made again when it can differ."""

    def __init__(self, box: Box) -> None:
        self._box = box
        self._made_of: Optional[Tuple[int, int, int]] = None
        self._times: List[float] = []  # scheduled ones, rising
        self._lines: List[EventLine] = []

    def look(self, now: Now) -> List[EventLine]:
        """Return what `schedule` returns."""
        revision = self._box.outbox.revision
        if self._made_of is None or self._made_of[0] != revision:
            self._times = sorted(event.scheduled for zone in self._box.zones.values() for event in zone.events)
        # Time changes estimates at a scheduled time, and at each whole minute.
        made_of = revision, math.ceil(now.utc / MINUTE_S), bisect.bisect_left(self._times, now.utc)
        if self._made_of != made_of:
            self._made_of, self._lines = made_of, schedule(self._box, now)
        return self._lines


def events_shown(lines: Iterable[EventLine]) -> Dict[str, EventSeen]:
    """Return the events as the faces show them, by their ids."""
    numbers: Dict[str, int] = {}
    found: Dict[str, EventSeen] = {}
    for line in sorted(lines, key=lambda line: line.event.scheduled):
        number = numbers[line.zone] = numbers.get(line.zone, 0) + 1
        found[line.event.id or f"{line.zone} {number}"] = _shown(line, number)
    return found


def _shown(line: EventLine, number: int) -> EventSeen:
    event, benchmark = line.event, line.event.benchmark
    found = EventSeen(
        event.id, number, line.zone, benchmark.code, benchmark.title, event.team, event.round,
        event.run, event.scheduled, line.begins, line.state.value, line.current)
    if line.result is None:
        return found
    shown, why = line.result.shown
    signed = shown.sign_off if line.result.signed else None
    return found._replace(
        identity=shown.identity, end_reason=shown.end_reason, counts=why.value,
        score="" if line.state in _OF_PHASE.values() else sums_of_record(shown),
        signed_utc_s=None if signed is None else signed.utc, signed_by="" if signed is None else signed.who)


def slot_lengths(plans: Iterable[ZonePlan]) -> Dict[str, float]:
    """Return the seconds that an event takes, by the code of its benchmark."""
    longest: Dict[str, float] = {}
    gaps: Dict[str, List[float]] = {}
    for plan in plans:
        for event in plan.events:
            longest[event.benchmark.code] = _longest(event.benchmark)
        for event, following in zip(plan.events, plan.events[1:]):
            if following.scheduled > event.scheduled:
                gaps.setdefault(event.benchmark.code, []).append(following.scheduled - event.scheduled)
    return {code: min([limit, *gaps.get(code, ())]) for code, limit in longest.items()}


def _longest(benchmark: Benchmark) -> float:
    """Return the most seconds that an event may take."""
    limit = NO_LIMIT_S if benchmark.total_timeout == NO_LIMIT else benchmark.total_timeout
    return limit + (benchmark.rules.setup_time or SETUP_S)


def _zone_lines(
    zone: Zone, last: Dict[Tuple[str, int], RunRecord], results: Dict[Tuple[str, int], EventResult],
    slots: Dict[str, float], now: Now,
) -> List[EventLine]:
    found = []
    for index, event in enumerate(zone.events):
        record = last.get((zone.name, index))
        state = _state(zone, index, record)
        result = results.get((zone.name, index))
        found.append(EventLine(zone.name, event, index == zone.index, state, event.scheduled, record, result))
    return _with_times(found, zone, slots, now)


def _state(zone: Zone, index: int, last: Optional[RunRecord]) -> EventState:
    if index == zone.index:
        if zone.run is not None:
            return _OF_PHASE[zone.run.phase]
        # After a stop the zone stays at its event, for another attempt.
        return EventState.DONE if last is not None and last.end_reason in _THE_END else EventState.NEXT
    if last is not None:
        return EventState.DONE
    return EventState.SKIPPED if index < zone.index else EventState.LATER


def _with_times(lines: List[EventLine], zone: Zone, slots: Dict[str, float], now: Now) -> List[EventLine]:
    """Return the lines of a zone with the times at which their runs began, or will probably begin."""
    free = now.utc  # from then on the zone can begin another event
    timed = []
    for line in lines:
        begins, slot = line.event.scheduled, slots[line.event.benchmark.code]
        if line.state in _TO_COME:
            begins = _minute(max(begins, free), begins)
            free = begins + slot
        elif line.state in _IN_PROGRESS:
            assert zone.run is not None, "it is in progress"
            record = zone.run.record(now)
            begins = record.started_utc or record.opened_utc
            free = max(now.utc, begins + slot)
        elif line.last is not None:
            begins = line.last.started_utc or line.last.opened_utc  # a team that did not appear has no start
        timed.append(line._replace(begins=begins))
    return timed


def _minute(utc: float, scheduled: float) -> float:
    """Round an estimate up to a minute. A time that is not after the scheduled one stays."""
    return utc if utc <= scheduled else math.ceil(utc / MINUTE_S) * MINUTE_S
