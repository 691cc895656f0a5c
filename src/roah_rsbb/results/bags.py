"""The run logs (rosbags) of all runs: where each is, and which are missing."""

import os
from typing import Iterator, List, Tuple

from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.wording.texts import one_line
from roah_rsbb.wording.times import NOTHING

MISSING = "missing"


def bag_lines(reader: JournalReader) -> Iterator[str]:
    """Return a line for each robot in a run. A bag is where the journal says, or in the folder of the journal."""
    numbers = {identity: number for number, identity in enumerate(reader.identities(), 1)}
    rows: List[Tuple[str, ...]] = [("No.", "Run", "Port", "Robot", "Size", "Bag")]
    found = 0
    members = [(numbers.get(member.identity, 0), member) for member in reader.all_members()]
    for number, member in sorted(members):
        path = _found(member.log_file, os.path.dirname(reader.path))
        found += bool(path)
        size = f"{os.path.getsize(path) / 1e6:.1f} MB" if path else MISSING if member.log_file else NOTHING
        rows.append((str(number), one_line(member.identity), str(member.port),
                     one_line(f"{member.robot} of team {member.team}"), size, one_line(path or member.log_file)))
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        yield "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip()
    missing = len(members) - found
    yield f"{found} of {len(members)} bags found" + (
        "; results bag RUN FILE writes a missing one again from the journal" if missing else "")


def _found(log_file: str, folder: str) -> str:
    """Return the path of a bag that exists; empty: none."""
    beside = os.path.join(folder, os.path.basename(log_file))
    return next((path for path in (log_file, beside) if log_file and os.path.isfile(path)), "")
