"""Journals as a box writes them, for tests of what reads them."""

import json

from roah_rsbb.core.restart.saved import freeze
from roah_rsbb.journal.batch import Batch, Entry, LinkRow, Member, Outcome, RunRow
from roah_rsbb.journal.file import Resume, Session
from roah_rsbb.journal.store import Journal

UTC0 = 1763722800.0  # 2025-11-21 11:00 UTC


class Writer:
    """A box that writes a journal."""

    def __init__(self, log_dir, competition="[]"):
        self.troubles = []
        session = Session(UTC0, 10.0, "boot", 1234, "uuid", "launch")
        self.journal = Journal(str(log_dir), session, competition, Resume.ALWAYS, self.troubles.append)
        self.path = self.journal.path
        self.utc = UTC0

    def run(self, record, robots=((6667, "r1"),)):
        """A run begins (and may be over): its record, and the ports and names of its robots."""
        row = RunRow(record.identity, record.zone, record.benchmark, record.team, record.round, record.run,
                     record.scheduled, record.opened_utc)
        members = tuple(Member(port, record.identity, record.team, robot) for port, robot in robots)
        self.journal.write(Batch(
            runs=(row,), members=members, log_files=tuple((m.port, f"/logs/{m.port}.bag") for m in members),
        ))
        self.outcome(record)

    def outcome(self, record):
        """A run's record changed."""
        outcome = Outcome(record.closed_utc or None, text(freeze(record)))
        self.journal.write(Batch(outcomes=((record.identity, outcome),)))

    def entry(self, kind, value, identity="", zone="tbm", port=6667, who="", after=1.0):
        """Something happens, `after` seconds from the last thing."""
        self.utc += after
        entry = Entry(self.utc, self.utc - UTC0 + 10.0, zone, identity, port, who, kind, text(value))
        self.journal.write(Batch(entries=(entry,)))

    def link(self, sample, port=6667, after=1.0):
        """A second of a link record."""
        self.utc += after
        self.journal.write(Batch(links=(LinkRow(port, self.utc, self.utc - UTC0 + 10.0, text(freeze(sample))),)))

    def close(self):
        """The box ends."""
        self.journal.close()
        assert not any(self.troubles)


def text(value):
    """JSON as the box writes it."""
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))
