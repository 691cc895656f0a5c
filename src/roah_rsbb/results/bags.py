"""The run logs (rosbags) of all runs: where each is, and which are missing."""

import contextlib
import os
from typing import Dict, Iterator, List, Tuple

from roah_rsbb.ground import linux
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.wording.texts import one_line
from roah_rsbb.wording.times import NOTHING

MISSING = "missing"
NOT_OVER = "not over"
# A file beside the journal.
LOCK = "roah_rsbb_bags.lock"


def bag_lines(reader: JournalReader) -> Iterator[str]:
    """Return a line for each robot in a run. A bag is where the journal says, or in the folder of the journal."""
    numbers = {identity: number for number, identity in enumerate(reader.identities(), 1)}
    rows: List[Tuple[str, ...]] = [("No.", "Run", "Port", "Robot", "Size", "Bag")]
    found = 0
    members = [(numbers.get(member.identity, 0), member) for member in reader.all_members()]
    for number, member in sorted(members):
        path = _found(member.log_file, os.path.dirname(reader.path))
        found += bool(path)
        size = (f"{os.path.getsize(path) / 1e6:.1f} MB" if path else NOTHING if not member.log_file else
                MISSING if reader.is_over(member.identity) else NOT_OVER)
        rows.append((str(number), one_line(member.identity), str(member.port),
                     one_line(f"{member.robot} of team {member.team}"), size, one_line(path or member.log_file)))
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        yield "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip()
    missing = len(members) - found
    yield f"{found} of {len(members)} bags found" + (
        "; results bags --make makes those of runs that are over, results bag RUN FILE any of them" if missing else "")


def missing_bags(reader: JournalReader) -> Dict[Tuple[str, int], str]:
    """Return where the bags of runs that are over are missing: beside the journal. By identity and port."""
    folder, found = os.path.dirname(reader.path), {}
    for member in reader.all_members():
        path = os.path.join(folder, os.path.basename(member.log_file))
        if member.log_file and reader.is_over(member.identity) and not os.path.exists(path):
            found[member.identity, member.port] = path
    return found


@contextlib.contextmanager
def making_bags(reader: JournalReader) -> Iterator[bool]:
    """Let no other process make bags beside this journal; returns whether this one may. Raises OSError."""
    fd = os.open(os.path.join(os.path.dirname(reader.path), LOCK), os.O_RDWR | os.O_CREAT, 0o644)
    may_make = True
    try:
        with contextlib.suppress(OSError):  # some network file systems have no locks
            try:
                linux.lock(fd)
            except BlockingIOError:
                may_make = False
        yield may_make
    finally:
        os.close(fd)


def _found(log_file: str, folder: str) -> str:
    """Return the path of a bag that exists; empty: none."""
    beside = os.path.join(folder, os.path.basename(log_file))
    return next((path for path in (log_file, beside) if log_file and os.path.isfile(path)), "")
