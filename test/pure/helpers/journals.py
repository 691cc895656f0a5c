"""Journals as a box writes them, for tests of their readers."""

import pathlib

from roah_rsbb.journal.log_dir import CoreSession, Resume
from roah_rsbb.journal.records import Batch, LinkRow, Member, NewEntry, OutcomeRow, RunRow
from roah_rsbb.journal.store import Journal
from roah_rsbb.model.as_json import to_json

UTC0 = 1763722800.0  # 2025-11-21 11:00 UTC


class Writer:
    """A box that writes a journal."""

    def __init__(self, log_dir, competition=(("tbm", "HNF", "Alpha", 1, 1, 0.0),), boot="boot"):
        self.troubles = []
        session = CoreSession(UTC0, 10.0, boot, 1234, "uuid", "launch")
        self.journal = Journal(str(log_dir), session, list(competition), Resume.ALWAYS, self.troubles.append)
        self.path = self.journal.path
        self.utc = UTC0

    def run(self, record, robots=((6667, "r1"),)):
        """Add a run (which may be over): its record, and the ports and names of its robots."""
        row = RunRow(record.identity, record.zone, record.benchmark, record.team, record.round, record.run,
                     record.scheduled, record.opened_utc)
        members = [Member(port, record.identity, record.team, robot) for port, robot in robots]
        self.journal.write(Batch(
            runs=[row], members=members, log_files={m.port: f"/logs/{m.port}.bag" for m in members},
        ))
        self.outcome(record)

    def outcome(self, record):
        """A run's record changed."""
        outcome = OutcomeRow(record.closed_utc or None, to_json(record))
        self.journal.write(Batch(outcomes={record.identity: outcome}))

    def entry(self, kind, value, identity="", zone="tbm", port=6667, who="", after=1.0):
        """Something happens, `after` seconds from the last thing."""
        self.utc += after
        entry = NewEntry(self.utc, self.utc - UTC0 + 10.0, zone, identity, port, who, kind, value)
        self.journal.write(Batch(entries=[entry]))

    def link(self, sample, port=6667, after=1.0):
        """A second of a link record."""
        self.utc += after
        self.journal.write(Batch(links=[LinkRow(port, self.utc, self.utc - UTC0 + 10.0, to_json(sample))]))

    def close(self):
        """The box ends."""
        self.journal.close()
        assert not any(self.troubles)


def spoil(path, text, byte=b"?"):
    """Change the first byte of a text in a journal."""
    for segment in sorted(pathlib.Path(path).glob("*.log")):
        content = segment.read_bytes()
        if text in content:
            at = content.index(text)
            segment.write_bytes(content[:at] + byte + content[at + 1:])
            return
    raise AssertionError(f"{path} has no {text}")

