"""What counts: which of a team's runs at an event, with which numbers, and why or why not.

Theory of operation. Whatever shows results asks `rulings`: standings, checklist, schedule, public results, score sheets
and exports. An event is known by its id, so its time, zone and place in the schedule may change between two attempts.
If its team or benchmark changes, the runs before are no attempts at it any more: see `is_attempt`.
Runs of journals that have no ids belong to the event that had their zone, team, round, run and scheduled time.

All numbers are exact fractions, so equal sums tie. They are rounded only where they are shown.
"""

import enum
import functools
import json
import math
import operator
from decimal import Decimal
from fractions import Fraction
from typing import Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from roah_rsbb.model.records import NOT_RUN, ItemRecord, RunRecord, ScoreValue
from roah_rsbb.model.rules import AttemptsRule
from roah_rsbb.rulebook.benchmarks import (
    ALL_TEAMS,
    NO_RULES,
    CountingAttempt,
    EventRules,
    ScheduledEvent,
    ZonePlan,
)
from roah_rsbb.rulebook.standing_rules import BY_POINTS, DEFAULT, TOTAL, Criterion, Rules, Term
from roah_rsbb.scoring.stages import first_kept
from roah_rsbb.wording.sheets import is_marked

# A number for each criterion; None (missing) is worse than any number.
Numbers = Tuple[Optional[Fraction], ...]

NO_EVENT_RULES: Mapping[str, EventRules] = {}

# The names of the ends of runs whose team did not appear or withdrew.
NOT_RUN_WORDS = frozenset(reason.name.lower() for reason in NOT_RUN)


# -- the numbers of a run ---------------------------------------------------------------------------


@functools.lru_cache(maxsize=1024)  # weights: reading one takes longer than multiplying
def exact(number: Union[int, float, str, Decimal, Fraction]) -> Fraction:
    """Return a number exactly as it is written: 0.1 is a tenth."""
    return Fraction(repr(number)) if isinstance(number, float) else Fraction(number)


def rules_for(records: Sequence[RunRecord], rules: Optional[Rules]) -> Rules:
    """Return the rules of a benchmark. Without criteria, its points count, or if it has none, the sum of the sheet."""
    if rules is not None and rules.criteria:
        return rules
    found = BY_POINTS if any(record.points is not None for record in records) else DEFAULT
    return found if rules is None else rules._replace(criteria=found.criteria)


def numbers_of(record: RunRecord, rules: Rules, missing: Optional[Dict[str, None]] = None) -> Numbers:
    """Return a run's number for each criterion. `missing` takes the names that the run lacks: items count as 0, values
    as None."""
    missing = {} if missing is None else missing
    return tuple(_number(record, criterion, missing) for criterion in rules.criteria)


def is_disqualified(record: RunRecord, rules: Rules) -> bool:
    """Return whether an entry of the sheet disqualifies the run."""
    return any(is_marked(item.value, item.text) and item.group in rules.disqualified_by for item in record.items)


def sort_key(numbers: Numbers, disqualified: bool, criteria: Sequence[Criterion]) -> Tuple[object, ...]:
    """Return a sort key: smaller is better."""
    if disqualified:
        return (1, *(0 for _ in criteria))
    return (0, *(math.inf if number is None else -number if criterion.more_is_better else number
                 for number, criterion in zip(numbers, criteria)))


def _number(record: RunRecord, criterion: Criterion, missing: Dict[str, None]) -> Optional[Fraction]:
    parts = [_term(record, term, missing) for term in criterion.terms]
    return None if None in parts else sum(filter(None, parts), Fraction(0))


def _term(record: RunRecord, term: Term, missing: Dict[str, None]) -> Optional[Fraction]:
    weight = exact(term.weight)
    if term.score:
        value = next((s for s in record.module_scores if not s.group and s.name == term.score), None)
        if value is None:
            missing[term.score] = None
            return None
        number = _module_number(value)
        return None if number is None else weight * number
    if term.points:
        points = points_of(record, term.points)
        if points is None:
            missing[term.points] = None
        return weight * exact(points or 0)
    items = [item for item in record.items if term.counts(item.group, item.desc)]
    if not items and (term.group or term.item):
        missing[term.item or term.group] = None
    whole = [item.value for item in items if not item.text and item.kind != "choice"]
    return weight * sum((amount_of(item) for item in items if item.text and item.kind != "choice"),
                        Fraction(sum(whole)))


def points_of(record: RunRecord, name: str) -> Optional[Decimal]:
    """Return the points of a group of the sheet, or `TOTAL`; None if it gives none."""
    if record.points is None:
        return None
    groups = {TOTAL: record.points.total, **dict(record.points.groups)}
    return Decimal(groups[name]) if name in groups else None


def replaces(record: RunRecord) -> bool:
    """Return whether the attempts of the team before a run do not count."""
    return record.points is not None and record.points.replaces


def amount_of(item: ItemRecord) -> Fraction:
    """Return the value of an item as a number. A choice counts as 0: it has points, but no number."""
    return Fraction(item.text) if item.text and item.kind in ("decimal", "rating") else \
        Fraction(0 if item.kind == "choice" else item.value)


def _module_number(score: ScoreValue) -> Optional[Fraction]:
    """A module's value as a number; None if it is missing or not a number."""
    try:
        value = json.loads(score.value)
        return exact(value) if isinstance(value, (bool, int, float)) and math.isfinite(value) else None
    except (ValueError, OverflowError):
        return None


# -- which runs count -------------------------------------------------------------------------------


class Why(enum.Enum):
    """Why a run counts or not. Messages and exports have the values; `wording.sheets` has the words."""

    COUNTS = "counts"
    ZERO = "counts_as_zero"  # the team did not appear or withdrew, and the rules give 0 for this
    NOT_OVER = "not_over"
    NEVER_STARTED = "never_started"
    ALL_ROBOTS = "all_robots"  # all robots run at once: nobody has a score
    ANNULLED = "annulled"  # a referee or organiser annulled it: it is no attempt
    EXCLUDED = "excluded"  # whoever makes the standing left it out
    NOT_SIGNED_OFF = "not_signed_off"  # it would count, but here only runs count that are signed off
    NOT_LAST = "not_last"  # a later attempt counts
    NOT_BEST = "not_best"  # a better attempt counts
    RAN = "ran"  # the team withdrew or was missing, but a run of it at the event counts
    NO_SCORE = "no_score"  # the team did not appear or withdrew, and the rules give no score for this


_COUNTING = (Why.COUNTS, Why.ZERO)


class Ruling(NamedTuple):
    """A run, and whether it counts."""

    record: RunRecord
    why: Why

    @property
    def counts(self) -> bool:
        """Whether the run counts."""
        return self.why in _COUNTING

    def numbers(self, rules: Rules, missing: Optional[Dict[str, None]] = None) -> Numbers:
        """Return the number for each criterion with which the run counts; see `numbers_of`."""
        if self.why is Why.ZERO:
            return tuple(Fraction(0) for _ in rules.criteria)
        return numbers_of(self.record, rules, missing)

    def disqualified(self, rules: Rules) -> bool:
        """Return whether the run counts behind all others."""
        return self.why is not Why.ZERO and is_disqualified(self.record, rules)


class RunChoice(NamedTuple):
    """Which runs may count."""

    signed_off: bool = False  # of those that count, only the ones whose sheet is signed off
    without: Tuple[str, ...] = ()  # identities of excluded runs
    attempts: Optional[AttemptsRule] = None  # which of a team's runs that count decide; overrides the rules
    events: Mapping[str, EventRules] = NO_EVENT_RULES  # which attempts at an event count, by the benchmarks' codes


ANY = RunChoice()

# Identifies a team's attempts at an event.
AttemptsKey = Tuple[str, str, object]


def is_attempt(record: RunRecord, event: ScheduledEvent) -> bool:
    """Return whether a run that has the event's id is an attempt at the event as it is now: of its team, and of its
    benchmark, and not annulled. What was run before a change of these keeps counting for the team and benchmark that it
    was."""
    return not record.is_annulled and (record.benchmark, record.team) == (event.benchmark.code, event.team)


def attempts_key(record: RunRecord, event: str = "") -> AttemptsKey:
    """Identify the attempts to which a run belongs. `event`: the id of its event if its record has none."""
    return record.benchmark, record.team, record.event or event or _without_id(record)


class EventResult(NamedTuple):
    """The result of a team at an event."""

    runs: Tuple[Ruling, ...]  # those that count; if none does, the last one that is over

    @property
    def shown(self) -> Ruling:
        """The run that stands for the result where there is space for one."""
        return self.runs[-1]

    @property
    def signed(self) -> bool:
        """Whether the result is final."""
        return all(ruling.record.sign_off is not None for ruling in self.runs)


class _Decided(NamedTuple):
    """The decision about a team's attempts at an event, and what it was made of."""

    attempts: List[RunRecord]
    rules: Rules
    event: EventRules
    rulings: List[Ruling]
    result: Optional[EventResult]

    def is_of(self, attempts: Sequence[RunRecord], rules: Rules, event: EventRules) -> bool:
        """Return whether it was made of the same."""
        return (rules is self.rules and event == self.event and len(attempts) == len(self.attempts)
                and all(map(operator.is_, attempts, self.attempts)))


class Counted(NamedTuple):
    """What counts."""

    rulings: List[Ruling]  # on all runs
    results: List[EventResult]  # of each team at each event. A run that is not over gives none


class Counting:
    """Decides what counts, for a caller that asks often: again only about the events of which a run changed."""

    def __init__(self, choice: RunChoice = ANY) -> None:
        self._choice = choice
        self._decided: Dict[AttemptsKey, _Decided] = {}

    def look(
        self, records: Sequence[RunRecord], ranking: Mapping[str, Rules], events: Mapping[str, EventRules]
    ) -> Counted:
        """See `rulings`. `events` overrides that of the choice."""
        of_code: Dict[str, List[RunRecord]] = {}
        for record in records:
            of_code.setdefault(record.benchmark, []).append(record)
        rules = {code: rules_for(own, ranking.get(code)) for code, own in of_code.items()}
        before, self._decided = self._decided, {}
        for key, attempts in attempts_of(records).items():
            of_event = rules[key[0]], events.get(key[0], NO_RULES)
            decided = before.get(key)
            if decided is None or not decided.is_of(attempts, *of_event):
                decided = _decided(attempts, *of_event, self._choice)
            self._decided[key] = decided
        found = {ruling.record.identity: ruling for decided in self._decided.values() for ruling in decided.rulings}
        results = [decided.result for decided in self._decided.values() if decided.result is not None]
        return Counted([found[record.identity] for record in records], results)


def rulings(records: Iterable[RunRecord], ranking: Mapping[str, Rules], choice: RunChoice = ANY) -> List[Ruling]:
    """Return whether each of the runs counts, in their order. They must be all runs of their events.

    `ranking`: how runs compare, by the benchmarks' codes.
    """
    return Counting(choice).look(list(records), ranking, choice.events).rulings


def _decided(attempts: List[RunRecord], rules: Rules, event: EventRules, choice: RunChoice) -> _Decided:
    why = _of_attempts(attempts, rules, event, choice)
    found = [Ruling(record, why[record.identity]) for record in attempts]
    if choice.signed_off:
        found = [ruling._replace(why=Why.NOT_SIGNED_OFF) if ruling.counts and ruling.record.sign_off is None else ruling
                 for ruling in found]
    return _Decided(attempts, rules, event, found, result_of(found))


def result_of(attempts: Sequence[Ruling]) -> Optional[EventResult]:
    """Return the result of a team's attempts at an event; None: none of its runs is over."""
    over = [ruling for ruling in attempts if ruling.record.end_reason and ruling.why is not Why.ANNULLED]
    runs = [ruling for ruling in over if ruling.counts] or over[-1:]
    return EventResult(tuple(runs)) if runs else None


def attempts_of(records: Iterable[RunRecord]) -> Dict[AttemptsKey, List[RunRecord]]:
    """Return the attempts of each team at each event, the oldest first."""
    records = sorted(records, key=lambda record: record.opened_utc)
    known: Dict[object, str] = {}
    if not all(record.event for record in records):
        known = {_without_id(record): record.event for record in records if record.event}
    found: Dict[AttemptsKey, List[RunRecord]] = {}
    for record in records:
        event = "" if record.event else known.get(_without_id(record), "")
        found.setdefault(attempts_key(record, event), []).append(record)
    return found


def _without_id(record: RunRecord) -> Tuple[object, ...]:
    """Return what identifies the event of a run in journals that have no ids."""
    return record.zone, record.benchmark, record.team, record.round, record.run, record.scheduled


def _of_attempts(
    attempts: Sequence[RunRecord], rules: Rules, event: EventRules, choice: RunChoice
) -> Dict[str, Why]:
    """Rule on the attempts of a team at an event, the oldest first."""
    reasons = [_why_not(record, choice) for record in attempts]
    found = {record.identity: why or Why.RAN for record, why in zip(attempts, reasons)}
    left = [record for record, why in zip(attempts, reasons) if why is None]
    ran = [record for record in left if record.end_reason not in NOT_RUN_WORDS]
    if not ran:
        found.update({record.identity: Why.NOT_LAST for record in left})
        if left:
            # Rule books give a team that does not appear penalty points: what is entered counts.
            entered = any(is_marked(item.value, item.text) for item in left[-1].items)
            found[left[-1].identity] = (
                Why.COUNTS if entered else Why.ZERO if left[-1].end_reason in event.absent else Why.NO_SCORE)
        return found
    first = first_kept(map(replaces, ran))
    found.update({record.identity: Why.NOT_LAST for record in ran[:first]})
    ran = ran[first:]
    if event.counting is CountingAttempt.ALL:
        found.update({record.identity: Why.COUNTS for record in ran})
        return found
    kept = ran[-1]
    if event.counting is CountingAttempt.BEST and len(ran) > 1:
        kept = min(ran, key=lambda record: _worth(record, rules))
    other = Why.NOT_BEST if event.counting is CountingAttempt.BEST else Why.NOT_LAST
    found.update({record.identity: Why.COUNTS if record is kept else other for record in ran})
    return found


def _worth(record: RunRecord, rules: Rules) -> Tuple[object, ...]:
    """Return the sort key of a run."""
    return sort_key(numbers_of(record, rules), is_disqualified(record, rules), rules.criteria)


def _why_not(record: RunRecord, choice: RunChoice) -> Optional[Why]:
    """Return why a run cannot count, whatever other attempts there are; None: it can."""
    if record.is_annulled:
        return Why.ANNULLED
    if not record.started_utc and record.end_reason not in NOT_RUN_WORDS:
        return Why.NEVER_STARTED if record.closed_utc else Why.NOT_OVER
    if record.team == ALL_TEAMS:
        return Why.ALL_ROBOTS
    if record.identity in choice.without:
        return Why.EXCLUDED
    return None if record.end_reason else Why.NOT_OVER


def by_attempts(ruled: Sequence[Ruling]) -> List[List[Ruling]]:
    """Return the rulings on the attempts of each team at each event, the oldest first."""
    by_identity = {ruling.record.identity: ruling for ruling in ruled}
    return [[by_identity[record.identity] for record in attempts]
            for attempts in attempts_of(ruling.record for ruling in ruled).values()]


def with_events(records: Iterable[RunRecord], plans: Iterable[ZonePlan]) -> List[RunRecord]:
    """Return the records, those of journals without ids with the id of the event in a schedule that they had: of the
    same team, round, run and time, or of the same zone, team, round and run. The same time also finds the event of
    which the id was lost: its line was deleted, and later written again."""
    events = [(zone.name, event) for zone in plans for event in zone.events]
    known = {event.id for _, event in events}
    exact = {_slot(zone, event): event.id for zone, event in reversed(events)}
    renamed = {_slot(zone, event)[1:]: event.id for zone, event in reversed(events)}  # the zone
    moved = {_slot(zone, event)[:-1]: event.id for zone, event in reversed(events)}
    found = []
    for record in records:
        if record.event not in known:
            slot = _without_id(record)
            own = exact.get(slot) or renamed.get(slot[1:]) or ("" if record.event else moved.get(slot[:-1]))
            record = record._replace(event=own or record.event)
        found.append(record)
    return found


def _slot(zone: str, event: ScheduledEvent) -> Tuple[object, ...]:
    """Return what `_without_id` returns for a run at an event."""
    return zone, event.benchmark.code, event.team, event.round, event.run, event.scheduled
