"""A journal and its copy in another folder."""

import pathlib

from helpers.journals import Writer
from roah_rsbb.journal import log
from roah_rsbb.journal.copy_folder import Stick
from roah_rsbb.journal.copy_follower import Follower, JournalSegments
from roah_rsbb.journal.log_dir import JOURNAL

COMPETITION = [["tbm", "HCFGAC", "Alpha", 1, 1, 0.0]]


def contents(folder):
    """The segments of the journal in a folder, by name: what of them is copied."""
    folder = pathlib.Path(folder, JOURNAL)
    return {name: (folder / name).read_bytes()[:size] for name, size in JournalSegments(str(folder)).sizes().items()}


def numbers(folder):
    """The numbers of the intact records in the journal in a folder, in order."""
    found = {frame.number for segment, scan in log.scans(log.read_chain(str(pathlib.Path(folder, JOURNAL))).segments)
             for frame in scan.records}
    return sorted(found)


class Copied:
    """A journal and its copy on a stick. Tests call `follower.step`, instead of the follower's thread; `on_part`: how a
    part is written, given what writes it."""

    def __init__(self, folder):
        self.log_dir, self.stick = folder / "log", folder / "stick"
        self.stick.mkdir()
        self.mono = 100.0
        self.on_part = lambda write, part: write(part)
        self.writer = self.new_writer()
        self.follower = self.new_follower()

    def new_writer(self):
        """A box that continues the journal, or begins it."""
        return Writer(self.log_dir, COMPETITION)

    def new_follower(self, **options):
        """A follower as a restarted process has it."""
        self.open_stick = Stick(str(self.stick), str(self.log_dir)).open
        return Follower(str(self.log_dir), self.opened, **{"now": lambda: self.mono, **options})

    def opened(self):
        """The copy, which writes its parts through `on_part`."""
        copy = self.open_stick()
        write = copy.write
        copy.write = lambda part: self.on_part(write, part)
        return copy

    @property
    def trouble(self):
        """What the follower reports."""
        return self.follower.progress.trouble

    def step(self):
        """Copy; return whether the copy has all of the journal."""
        self.follower.step()
        return not self.trouble and contents(self.stick) == contents(self.log_dir)

    def save(self):
        """Wait until the disk of the box has everything."""
        journal = self.writer.journal
        assert not journal.why_not_saved(journal.committed)

    def restart_box(self):
        """End the box, and start it again."""
        self.writer.close()
        self.writer = self.new_writer()

    def close(self):
        """End both."""
        self.follower.close()
        self.writer.journal.close()
