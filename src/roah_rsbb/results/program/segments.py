"""The commands of `results` that look into the journal itself: its segments, its records, its damage."""

import argparse
import glob
import os

from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.journal.reader import JournalError, JournalReader
from roah_rsbb.results.program.journal import Usage, open_journal, warn
from roah_rsbb.results.runs import find_record, records
from roah_rsbb.wording.texts import visible
from roah_rsbb.wording.times import date_time


def journals(options: argparse.Namespace) -> int:
    """The command of this name."""
    log_dir = os.path.expanduser(options.log_dir)
    found = glob.glob(os.path.join(glob.escape(log_dir), f"{JOURNAL}*"))
    paths = sorted(path for path in found if os.path.isdir(path))
    if not paths:
        raise Usage(f"there are no journals in {log_dir}: give the box's log_dir with --log-dir DIR")
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
