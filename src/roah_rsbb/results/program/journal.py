"""Opens a journal for the commands of `results`, and reports problems."""

import argparse
import contextlib
import os
import sys
from typing import Iterator, List

from roah_rsbb.journal.log_dir import CONFIGURATION, kept_files
from roah_rsbb.journal.reader import JournalReader, journal_in
from roah_rsbb.results.runs import RunResult, find_record, run_result
from roah_rsbb.rulebook.text_files import known
from roah_rsbb.wording import times
from roah_rsbb.wording.texts import visible

RULES_FILE = "standings.yaml"
BENCHMARKS_FILE, SCHEDULE_FILE = "benchmarks.yaml", "schedule.yaml"


class Usage(Exception):
    """The request cannot be fulfilled. The text names the remedy."""


@contextlib.contextmanager
def files_of(options: argparse.Namespace) -> Iterator[None]:
    """Let `file` find the files of the competition. Days and times are those of its time zone."""
    kept = kept_files(_log_dir(options))
    if kept:
        kept.setdefault("standings", "{}")  # the box ranked without rules
    options.kept = {_kept_path(options, f"{name}.yaml"): text for name, text in kept.items()}
    options.has_files = any(map(os.path.exists, (_beside(options, name) for name in (BENCHMARKS_FILE, SCHEDULE_FILE))))
    with known(options.kept):
        from roah_rsbb.rulebook.config import settings_in  # imported late, after errors of the command line

        times.use_zone(settings_in(_found(options, SCHEDULE_FILE)).time_zone)
        yield


def file(options: argparse.Namespace, name: str) -> str:
    """The path of a file of the competition: the option's; the one beside the log_dir; the one that the box kept beside
    the journal; or the included one."""
    path = _found(options, name)
    if os.path.dirname(path) == options.config_dir and not (options.kept or options.has_files):
        options.has_files = True  # once
        warn(f"there is no {CONFIGURATION} in {_log_dir(options)}, and no file of the competition beside it: those of "
             f"{options.config_dir} are used, so ranks and what counts may differ from the box. Copy {CONFIGURATION} "
             f"together with the journal, or put {BENCHMARKS_FILE}, {SCHEDULE_FILE} and {RULES_FILE} beside it")
    return path


def _found(options: argparse.Namespace, name: str) -> str:
    given = getattr(options, "rules" if name == RULES_FILE else name.replace(".yaml", "_file"), None)
    beside, kept = _beside(options, name), _kept_path(options, name)
    found = beside if os.path.exists(beside) else kept if kept in options.kept else None
    return given or found or os.path.join(options.config_dir, name)


def _beside(options: argparse.Namespace, name: str) -> str:
    return os.path.join(os.path.dirname(_log_dir(options)), name)


def _kept_path(options: argparse.Namespace, name: str) -> str:
    """How errors name a file that the box kept."""
    return f"{os.path.join(_log_dir(options), CONFIGURATION)}, {name}"


def _log_dir(options: argparse.Namespace) -> str:
    return os.path.abspath(os.path.join(options.journal, "..") if options.journal
                           else os.path.expanduser(options.log_dir))


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
