"""Opens a journal for the commands of `results`, and reports problems."""

import argparse
import os
import sys
from typing import List, Optional

from roah_rsbb.journal.in_force import read_in_force
from roah_rsbb.journal.reader import JournalReader, journal_in
from roah_rsbb.results.runs import RunResult, find_record, run_result
from roah_rsbb.wording import times
from roah_rsbb.wording.texts import visible

RULES_FILE = "standings.yaml"
BENCHMARKS_FILE, SCHEDULE_FILE = "benchmarks.yaml", "schedule.yaml"


class Usage(Exception):
    """The request cannot be fulfilled. The text names the remedy."""


def file(options: argparse.Namespace, name: str) -> str:
    """The path of a file of the competition: the option's, or the one beside the log_dir, else the included one."""
    given = getattr(options, name.replace(".yaml", "_file"), None)
    return given or beside(options, name) or os.path.join(options.config_dir, name)


def beside(options: argparse.Namespace, name: str) -> Optional[str]:
    """The path of a file of the competition beside the log_dir; None if it does not exist."""
    found = os.path.join(os.path.dirname(os.path.abspath(_log_dir(options))), name)
    return found if os.path.exists(found) else None


def use_zone(options: argparse.Namespace) -> None:
    """Count days, and show times, in the time zone of the competition."""
    from roah_rsbb.rulebook.config import settings_in  # imported late, after errors of the command line
    from roah_rsbb.rulebook.text_files import known

    path, texts = file(options, SCHEDULE_FILE), {}
    kept = None if beside(options, SCHEDULE_FILE) else read_in_force(_log_dir(options))
    if kept is not None:  # the journal was copied without the competition's folder
        texts = {path: kept.versions[kept.present].texts[1] or ""}
    with known(texts):
        times.use_zone(settings_in(path).time_zone)


def _log_dir(options: argparse.Namespace) -> str:
    return os.path.dirname(options.journal) if options.journal else os.path.expanduser(options.log_dir)


def open_journal(options: argparse.Namespace, checks_all: bool = True) -> JournalReader:
    """Open the journal. `checks_all`: check all of a large one for damage, which takes seconds."""
    path = options.journal or journal_in(os.path.expanduser(options.log_dir))
    reader = JournalReader(path, checks_all, lambda text: _warn_of_damage(reader, [text]))
    _warn_of_damage(reader, reader.damage)
    _warn_of_fork(reader)
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
