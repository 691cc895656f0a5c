"""A journal and its copy in another folder."""

import contextlib
import pathlib
import sqlite3

from helpers.journals import Writer
from roah_rsbb.copies.folder import Stick
from roah_rsbb.copies.follower import Follower
from roah_rsbb.copies.rows import COLUMNS
from roah_rsbb.journal.file import FILE_NAME


def contents(folder):
    """All rows of the journal in a folder, with their checksums, by table."""
    uri = f"{(pathlib.Path(folder) / FILE_NAME).resolve().as_uri()}?mode=ro"
    with contextlib.closing(sqlite3.connect(uri, uri=True)) as connection:
        return {table: connection.execute(
            f"SELECT {', '.join(columns)} FROM {table} ORDER BY {columns[0]}").fetchall()
            for table, columns in COLUMNS.items()}


class Copied:
    """A journal and its copy on a stick. Tests call `follower.step`, instead of the follower's thread."""

    def __init__(self, folder):
        self.log_dir, self.stick = folder / "log", folder / "stick"
        self.stick.mkdir()
        self.mono = 100.0
        self.writer = Writer(self.log_dir)
        self.follower = self.new_follower()

    def new_follower(self):
        """A follower as a restarted process has it."""
        return Follower(str(self.log_dir), Stick(str(self.stick), str(self.log_dir)).open, now=lambda: self.mono)

    @property
    def trouble(self):
        """What the follower reports."""
        return self.follower.progress.trouble

    def step(self):
        """Copy; return whether the copy has all of the journal."""
        self.follower.step()
        return not self.trouble and contents(self.stick) == contents(self.log_dir)

    def close(self):
        """End both."""
        self.follower.close()
        self.writer.journal.close()
