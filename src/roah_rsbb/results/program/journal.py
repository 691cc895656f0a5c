"""Opens a journal for the commands of `results`, and reports problems."""

import argparse
import os
import sys
from typing import List

from roah_rsbb.journal.reader import JournalError, JournalReader, journal_in
from roah_rsbb.results.runs import RunResult, find_record, run_result
from roah_rsbb.wording.texts import visible

RULES_FILE = "standings.yaml"
BENCHMARKS_FILE, SCHEDULE_FILE = "benchmarks.yaml", "schedule.yaml"


class Usage(Exception):
    """The request cannot be fulfilled. The text names the remedy."""


def open_journal(options: argparse.Namespace, checks_all: bool = True) -> JournalReader:
    """Open the journal. `checks_all`: check all of a large one for damage, which takes seconds."""
    path = options.journal or journal_in(os.path.expanduser(options.log_dir))
    reader = JournalReader(path, checks_all, lambda text: _warn_of_damage(reader, [text]))
    try:
        _warn_of_damage(reader, reader.damage)
        _warn_of_fork(reader)
    except JournalError:
        reader.close()
        raise
    return reader


def one_run(reader: JournalReader, word: str) -> RunResult:
    """Read the run with this number, identity or beginning of the identity."""
    number, record = find_record(reader, word, warn)
    _warn_of_damage(reader, reader.damage_of(record.identity))
    return run_result(reader, number, record, warn)


def _warn_of_damage(reader: JournalReader, damage: List[str]) -> None:
    for text in damage:
        warn(f"{reader.path} is damaged: {text}. A copy of the journal may have it (docs/backup.md)")


def _warn_of_fork(reader: JournalReader) -> None:
    """Name what is only in the journal of a box from which a standby took over (docs/standby.md, "The old box")."""
    standing = reader.standing()
    if not standing.is_superseded:
        return
    numbers = {identity: number for number, identity in enumerate(reader.identities(), 1)}
    runs = ", ".join(f"run {numbers.get(run, 0)} ({count} entries)" for run, count in reader.only_here())
    warn(f"{reader.path} forks: the box at {standing.by} took over. It continues without what this one recorded after "
         f"record {standing.cut}: {runs or 'no run'}")


def warn(text: str) -> None:
    """Print a warning or an error."""
    print(f"results: {visible(text)}", file=sys.stderr)
