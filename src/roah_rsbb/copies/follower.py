"""Keeps a copy of the journal up to date, in a thread of its own.

The core never waits for the copy: another process reads the journal's file. A stick that hangs stops only the thread,
and the time since the last complete copy still rises.
"""

import os
import threading
import time
from types import MappingProxyType
from typing import Callable, Mapping, NamedTuple, Optional

from roah_rsbb.copies.copy import FILES, CannotWriteCopy, ChangedFiles, Copy
from roah_rsbb.copies.rows import CannotReadJournal, JournalRows, OtherJournal
from roah_rsbb.journal import file as files

# Time between two looks at the journal.
PERIOD_S = 0.05
# Failed attempts are repeated after this time.
RETRY_S = 1.0


class Progress(NamedTuple):
    """How complete the copy is."""

    trouble: str  # why it is not complete, and what to do; empty: none
    complete_mono: Optional[float]  # when it was complete for the last time (monotonic seconds); None: never
    missing_entries: int  # number of entries that the copy lacks, as far as it is known
    box_uuid: str  # of the core whose journal was copied last; empty: none yet
    aside: str  # the file to which an earlier copy was moved; empty: none


class Follower:
    """Copies the journal in `log_dir` to another place."""

    def __init__(
        self, log_dir: str, open_copy: Callable[[], Copy], more_files: Mapping[str, str] = MappingProxyType({}),
        now: Callable[[], float] = time.monotonic, on_answer: Callable[[object], None] = lambda question: None,
    ) -> None:
        """`open_copy` raises `CannotWriteCopy`. `more_files`: paths of files to copy, by their names in the copy.

        `on_answer` is called in the thread with a question (see `ask`).
        """
        self.progress = Progress("", None, 0, "", "")
        self.log_dir = log_dir
        self._path = os.path.join(log_dir, files.FILE_NAME)
        self._now = now
        self._journal: Optional[JournalRows] = None
        self._open_place = open_copy
        self._copy: Optional[Copy] = None
        self._paths = {**{name: os.path.join(log_dir, name) for name in FILES}, **more_files}
        self._beside = ChangedFiles(self._paths)
        self._copied_entry = 0
        self._on_answer = on_answer
        self._question: Optional[object] = None
        self._answered: Optional[object] = None
        self._woken = threading.Event()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._work, name="copy", daemon=True)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def ask(self, question: object) -> None:
        """From any thread: copy now. The question is answered when the copy has everything that is in the journal at
        this moment. An earlier question that was not answered yet is dropped."""
        self._question = question
        self._woken.set()

    def end(self, timeout: float) -> None:
        """Ask the thread to end, and wait at most `timeout` seconds for it: the stick may hang."""
        self._ended.set()
        self._woken.set()
        self._thread.join(timeout)

    def close(self) -> None:
        """Close all files, in the thread that calls `step`."""
        self._drop_copy()
        if self._journal is not None:
            self._journal.close()
            self._journal = None

    def step(self) -> None:
        """Copy everything that is missing. Never raises."""
        try:
            self._follow()
        except CannotReadJournal as error:
            self.close()
            self.progress = self.progress._replace(trouble=str(error))
        except CannotWriteCopy as error:
            self._drop_copy()
            self.progress = self.progress._replace(
                trouble=f"the copy cannot be written: {error}", missing_entries=self._missing_entries())

    def _work(self) -> None:
        while not self._ended.is_set():
            try:
                self.step()
            except Exception as error:
                # The thread continues. What failed once is visible in the panels.
                self.close()
                self.progress = self.progress._replace(trouble=f"internal error, please report it: {error!r}")
            if self.progress.trouble:
                self._ended.wait(RETRY_S)
            else:
                self._woken.wait(PERIOD_S)
                self._woken.clear()
        self.close()

    def _follow(self) -> None:
        if self._journal is None or not self._journal.is_in_place():
            self.close()
            self._journal = self._open_journal()
        if self._copy is None:
            self._open_copy()
        copy, journal = self._copy, self._journal
        copy.check()
        # A part that is not the last is followed by the next one at once. What is written meanwhile is copied by the
        # next step, or a busy journal would never be complete.
        is_last, has_parts = False, False
        while not is_last and not self._ended.is_set():
            question, began = self._question, self._now()
            if not journal.has_changed():
                break
            rows = journal.missing(copy.known)
            is_last = rows.is_last
            beside = self._beside.changed()
            # The last part puts all of them on the disk, even if it has no rows.
            if beside or has_parts or not rows.is_empty():
                copy.write(rows, beside)
            has_parts = not is_last
            self._copied_entry = copy.known.last["entries"].number
            if not is_last:
                self.progress = self.progress._replace(missing_entries=self._missing_entries())
        if not self._ended.is_set():
            self.progress = Progress("", began, 0, copy.box_uuid, copy.aside)
            if question is not self._answered:
                self._answered = question
                self._on_answer(question)

    def _open_journal(self) -> JournalRows:
        if not os.path.exists(self._path):
            raise CannotReadJournal(f"there is no journal {self._path} yet")
        return JournalRows(self._path)

    def _open_copy(self) -> None:
        self._copy = self._open_place()
        try:
            self._journal.begin(self._copy.known)
        except OtherJournal:
            self._copy.set_aside()
            self._journal.begin(self._copy.known)
        self._beside = ChangedFiles(self._paths)

    def _missing_entries(self) -> int:
        """Return how many entries the copy lacks; the last known number if the journal cannot be read."""
        try:
            return max(0, self._journal.newest_entry() - self._copied_entry)
        except CannotReadJournal:
            return self.progress.missing_entries

    def _drop_copy(self) -> None:
        if self._copy is not None:
            self._copy.close()
            self._copy = None
