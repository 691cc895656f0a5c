"""The commands of `results` that show runs and the journal, and what all commands need: the competition's files."""

import argparse
import contextlib
import glob
import importlib
import os
import sys
from typing import Dict, Iterable, Iterator, List, Sequence

from roah_rsbb.ground.installed import NotShipped, shipped_folder
from roah_rsbb.journal.bag import making_bags, missing_bags, write_bag, write_bags
from roah_rsbb.journal.log_dir import CONFIGURATION, JOURNAL, kept_files
from roah_rsbb.journal.reader import JournalError, JournalReader, journal_in
from roah_rsbb.model import run_log
from roah_rsbb.model.records import RunRecord
from roah_rsbb.model.rules import Attempts, AttemptsRule
from roah_rsbb.results import lists
from roah_rsbb.results.runs import NotPossible, RunResult, find, find_record, records, run_result
from roah_rsbb.rulebook import config, errors
from roah_rsbb.rulebook.benchmarks import Benchmark
from roah_rsbb.rulebook.decisions import decided_in, decisions_in
from roah_rsbb.rulebook.errors import ConfigErrors, Report
from roah_rsbb.rulebook.standing_rules import StandingRules, read_rules
from roah_rsbb.scoring.counting import Ruling, RunChoice, Why, rulings, with_events
from roah_rsbb.wording import times
from roah_rsbb.wording.texts import visible
from roah_rsbb.wording.times import date_time

RULES_FILE = "standings.yaml"
BENCHMARKS_FILE, SCHEDULE_FILE = "benchmarks.yaml", "schedule.yaml"


def run(options: argparse.Namespace) -> int:
    """Run the command that was chosen; returns its exit status."""
    try:
        options.config_dir = str(shipped_folder())
        with files_of(options):
            # Imported late: most take longer to load than to list all runs.
            module = importlib.import_module(f"roah_rsbb.results.program.{options.module}")
            return int(getattr(module, options.command)(options))
    except (JournalError, NotPossible, NotShipped) as error:
        warn(str(error))
    except ConfigErrors as error:
        warn(f"a file of the competition is invalid:\n{error}")
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # the reader has closed the pipe
        return 0
    except OSError as error:
        warn(f"{error.filename}: {error.strerror}: choose another place or free some space")
    return 1


# -- the files of the competition -------------------------------------------------------------------


@contextlib.contextmanager
def files_of(options: argparse.Namespace) -> Iterator[None]:
    """Let `file` find the files of the competition. Days and times are those of its time zone."""
    kept = kept_files(_log_dir(options))
    if kept:
        kept.setdefault("standings", "{}")  # the box ranked without rules
    options.kept = {_kept_path(options, f"{name}.yaml"): text for name, text in kept.items()}
    options.has_files = any(map(os.path.exists, (_beside(options, name) for name in (BENCHMARKS_FILE, SCHEDULE_FILE))))
    with errors.known(options.kept):
        times.use_zone(config.settings_in(_found(options, SCHEDULE_FILE)).time_zone)
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
    return os.path.join(_log_dir(options), CONFIGURATION, name)


def _log_dir(options: argparse.Namespace) -> str:
    return os.path.abspath(os.path.join(options.journal, "..") if options.journal
                           else os.path.expanduser(options.log_dir))


def rules(options: argparse.Namespace) -> StandingRules:
    """Return the rules of the standings, with all decisions of the competition. Raises ConfigErrors."""
    found = read_rules(file(options, RULES_FILE))
    of_sheets = decisions_in(decided_in(Report(), file(options, BENCHMARKS_FILE)))
    found.decisions = tuple(dict.fromkeys((*of_sheets, *found.decisions)))
    return found


def benchmarks(options: argparse.Namespace) -> Dict[str, Benchmark]:
    """Return the benchmarks by their codes. Raises ConfigErrors."""
    return config.load_benchmarks(file(options, BENCHMARKS_FILE))


# -- the journal ------------------------------------------------------------------------------------


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


# -- what counts ------------------------------------------------------------------------------------


def known_records(options: argparse.Namespace, reader: JournalReader) -> List[RunRecord]:
    """Return the records of all runs with the ids of their events. Runs of old journals get them from the schedule, if
    it can be read."""
    known = records(reader, warn)
    with contextlib.suppress(ConfigErrors):
        return with_events(known, config.load_schedule(file(options, BENCHMARKS_FILE), file(options, SCHEDULE_FILE))[1])
    return known


def choice(options: argparse.Namespace, known: Iterable[RunRecord]) -> RunChoice:
    """Return which runs may count, as the options say. Raises ConfigErrors, `NotPossible`."""
    identities = [record.identity for record in known]
    without = tuple(identities[find(identities, word)] for word in getattr(options, "without", ()))
    attempts = AttemptsRule(Attempts(options.of_runs)) if getattr(options, "of_runs", None) else None
    events = {code: benchmark.rules for code, benchmark in benchmarks(options).items()}
    return RunChoice(getattr(options, "signed_off", False), without, attempts, events)


def ruled(options: argparse.Namespace, known: Sequence[RunRecord]) -> List[Ruling]:
    """Return which runs count, and why or why not. Raises ConfigErrors, `NotPossible`."""
    return rulings(known, rules(options), choice(options, known))


def why_of(options: argparse.Namespace, known: Sequence[RunRecord]) -> Dict[str, Why]:
    """Return the same by the identities of the runs."""
    return {ruling.record.identity: ruling.why for ruling in ruled(options, known)}


def counts_of(options: argparse.Namespace, known: Sequence[RunRecord]) -> Dict[str, str]:
    """Return whether runs count (`RunResult.counts`), by their identities; nothing if a file of the competition is
    invalid."""
    try:
        return {identity: why.value for identity, why in why_of(options, known).items()}
    except ConfigErrors as error:
        warn(f"whether runs count is not known, because a file of the competition is invalid: {error.errors[0]}")
        return {}


# -- commands that show runs ------------------------------------------------------------------------


def list_runs(options: argparse.Namespace) -> int:
    """The command `list`."""
    reader = open_journal(options, checks_all=False)
    known = known_records(options, reader)
    if not known:
        print("There are no runs yet.")
        return 0
    counts = counts_of(options, known)
    print("\n".join(lists.list_lines(known, options.utc, counts)))
    return 0


def show(options: argparse.Namespace) -> int:
    """The command of this name."""
    reader = open_journal(options, checks_all=False)
    result = one_run(reader, options.run)
    from roah_rsbb.results.sheet import sheet_lines  # imported late: no other command of this file needs it

    counts = counts_of(options, known_records(options, reader))
    result = result._replace(counts=counts.get(result.record.identity, ""))
    print("\n".join(sheet_lines(result, options.utc, strike=sys.stdout.isatty())))
    return 0


def bag(options: argparse.Namespace) -> int:
    """The command of this name."""
    result = one_run(open_journal(options, checks_all=False), options.run)
    if os.path.exists(options.bag):
        raise NotPossible(f"{options.bag}: this file already exists: choose another name")
    ports = [robot.port for robot in result.robots if options.port in (None, robot.port)]
    if len(ports) != 1:
        known = ", ".join(f"{robot.port} ({robot.robot} of team {robot.team})" for robot in result.robots)
        raise NotPossible(f"choose a robot with --port: {known or 'this run has none'}")
    entries = [(e.kind, e.value, e.utc) for e in result.entries if e.port == ports[0] and e.kind in run_log.KINDS]
    write_bag(options.bag, entries)
    print(f"{options.bag}: {len(entries)} messages")
    return 0


def bags(options: argparse.Namespace) -> int:
    """The command of this name."""
    reader = open_journal(options, checks_all=False)
    if options.make:
        with making_bags(reader) as may_make:
            if not may_make:
                raise NotPossible("another program makes the bags just now: try again")
            write_bags(reader, missing_bags(reader))
    print("\n".join(lists.bag_lines(reader)))
    return 0


# -- the journal itself -----------------------------------------------------------------------------


def journals(options: argparse.Namespace) -> int:
    """The command of this name."""
    log_dir = os.path.expanduser(options.log_dir)
    found = glob.glob(os.path.join(glob.escape(log_dir), f"{JOURNAL}*"))
    paths = sorted(path for path in found if os.path.isdir(path))
    if not paths:
        raise NotPossible(f"there are no journals in {log_dir}: give the box's log_dir with --log-dir DIR")
    for path in paths:
        try:
            _print_journal(JournalReader(path), options.utc)
        except JournalError as error:
            print(error)
    return 0


def _print_journal(reader: JournalReader, in_utc: bool) -> None:
    known, sessions = records(reader, lambda _: None), reader.sessions()
    begun = f"started {date_time(sessions[0].utc, in_utc)}" if sessions else "empty"
    last = f", last connected {date_time(known[-1].opened_utc, in_utc)}" if known else ""
    print(f"{reader.path}: {begun}, {len(known)} runs{last}")
    for segment in reader.segments():
        begin = "no records" if not segment.count else f"from {date_time(segment.utc, in_utc)}"
        print(f"  {segment.name}: {segment.bytes / 1e6:.1f} MB, {segment.count} records, {begin}"
              f"{', damaged' if segment.damage else ''}")
    for text in reader.damage:
        print(f"  damaged: {text}")


def verify(options: argparse.Namespace) -> int:
    """The command of this name. The status is 1 if something is damaged or missing."""
    reader = open_journal(options)
    segments, damage = reader.segments(), reader.damage
    if not damage:
        count = sum(segment.count for segment in segments)
        print(f"{reader.path}: all {count} records in {len(segments)} segments are intact")
    return 1 if damage else 0


def dump(options: argparse.Namespace) -> int:
    """The command of this name."""
    reader = open_journal(options, checks_all=False)
    identity = find_record(reader, options.run, warn)[1].identity if options.run else ""
    for text in reader.dump(identity):
        print(visible(text))
    return 0
