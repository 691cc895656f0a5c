"""Which runs count, for the commands of `results`, as the files of the competition say."""

import argparse
import contextlib
from typing import Dict, Iterable, List, Sequence, TypeVar, Union

from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.model.records import RunRecord
from roah_rsbb.results.program.journal import BENCHMARKS_FILE, RULES_FILE, SCHEDULE_FILE, file, warn
from roah_rsbb.results.runs import RunHead, find, find_record, records
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import NO_RULES, Benchmark, CountingAttempt
from roah_rsbb.rulebook.errors import ConfigErrors
from roah_rsbb.rulebook.standing_rules import OfRuns, StandingRules, read_rules
from roah_rsbb.scoring.counting import NOT_RUN_WORDS, Ruling, RunChoice, Why, attempts_of, rulings, with_events

T = TypeVar("T", RunRecord, RunHead)


# -- the files of the competition -------------------------------------------------------------------


def rules(options: argparse.Namespace) -> StandingRules:
    """Return the rules of the standings. Raises ConfigErrors."""
    return read_rules(file(options, RULES_FILE))


def benchmarks(options: argparse.Namespace) -> Dict[str, Benchmark]:
    """Return the benchmarks by their codes. Raises ConfigErrors."""
    return config.load_benchmarks(file(options, BENCHMARKS_FILE))


# -- what counts ------------------------------------------------------------------------------------


def known_records(options: argparse.Namespace, reader: JournalReader) -> List[RunRecord]:
    """Return the records of all runs with the ids of their events."""
    return _with_events(options, records(reader, warn))


def _with_events(options: argparse.Namespace, known: Sequence[T]) -> List[T]:
    """Runs of old journals get the ids of their events from the schedule, if it can be read."""
    with contextlib.suppress(ConfigErrors):
        return with_events(known, config.load_schedule(file(options, BENCHMARKS_FILE), file(options, SCHEDULE_FILE))[1])
    return list(known)


def choice(options: argparse.Namespace, known: Iterable[Union[RunRecord, RunHead]]) -> RunChoice:
    """Return which runs may count, as the options say. Raises ConfigErrors, `NoSuchRun`."""
    identities = [record.identity for record in known]
    without = tuple(identities[find(identities, word)] for word in getattr(options, "without", ()))
    of_runs = OfRuns(options.of_runs) if getattr(options, "of_runs", None) else None
    events = {code: benchmark.rules for code, benchmark in benchmarks(options).items()}
    return RunChoice(getattr(options, "signed_off", False), without, of_runs, events)


def ruled(options: argparse.Namespace, known: Sequence[RunRecord]) -> List[Ruling]:
    """Return which runs count, and why or why not. Raises ConfigErrors, `NoSuchRun`."""
    return rulings(known, rules(options), choice(options, known))


def why_of(options: argparse.Namespace, known: Sequence[RunRecord]) -> Dict[str, Why]:
    """Return the same by the identities of the runs."""
    return {ruling.record.identity: ruling.why for ruling in ruled(options, known)}


def words_of_heads(options: argparse.Namespace, reader: JournalReader, heads: Sequence[RunHead]) -> Dict[str, str]:
    """Return whether runs count (`RunResult.counts`), by their identities; nothing if a file of the competition is
    invalid. Only attempts whose sheets decide it are read whole."""
    try:
        of_events = choice(options, heads).events
        known: Sequence[Union[RunRecord, RunHead]] = _with_events(options, heads)
        compared = {
            head.identity for (code, _, _), attempts in attempts_of(known).items() for head in attempts
            if head.end_reason in NOT_RUN_WORDS
            or (len(attempts) > 1 and of_events.get(code, NO_RULES).counting is CountingAttempt.BEST)
        }
        known = [find_record(reader, head.identity, warn)[1]._replace(event=head.event)
                 if head.identity in compared else head for head in known]
        return {identity: why.value for identity, why in why_of(options, known).items()}
    except ConfigErrors as error:
        warn(f"whether runs count is not known, because a file of the competition is invalid: {error.errors[0]}")
        return {}
