"""Keeps a copy of the journal up to date, in a thread of its own.

The core never waits for the copy: another process reads the journal's files. A stick that hangs stops only the thread,
and the time since the last complete copy still rises.
"""

import os
import threading
import time
from types import MappingProxyType
from typing import Callable, Mapping, NamedTuple, Optional

from roah_rsbb.copies.copy import FILES, CannotReadJournal, CannotWriteCopy, ChangedFiles, Copy
from roah_rsbb.copies.segments import JournalSegments
from roah_rsbb.journal import log_dir as log_dirs

# Time between two looks at the journal.
PERIOD_S = 0.05
# Failed attempts are repeated after this time.
RETRY_S = 1.0


class CopyProgress(NamedTuple):
    """How complete the copy is."""

    trouble: str  # why it is not complete, and what to do; empty: none
    complete_mono: Optional[float]  # when it was complete for the last time (monotonic seconds); None: never
    missing_bytes: int  # bytes of the journal that the copy lacks, as far as it is known
    journal: str  # identity of the journal that was read last; empty: none yet
    aside: str  # the folder to which an earlier copy was moved; empty: none


class Follower:
    """Copies the journal in `log_dir` to another place."""

    def __init__(
        self, log_dir: str, open_copy: Callable[[], Copy], more_files: Mapping[str, str] = MappingProxyType({}),
        now: Callable[[], float] = time.monotonic, on_answer: Callable[[object], None] = lambda question: None,
    ) -> None:
        """`open_copy` raises `CannotWriteCopy`. `more_files`: paths of files to copy, by their names in the copy.

        `on_answer` is called in the thread with a question (see `ask`).
        """
        self.progress = CopyProgress("", None, 0, "", "")
        self.log_dir = log_dir
        self._now = now
        self._journal = JournalSegments(os.path.join(log_dir, log_dirs.JOURNAL))
        self._present: Mapping[str, int] = {}  # the sizes of its segments,
        self._sizes: Mapping[str, int] = {}  # and what the copy had of them, also while it is closed
        self._open_copy = open_copy
        self._copy: Optional[Copy] = None
        self._paths = {**{name: os.path.join(log_dir, name) for name in FILES}, **more_files}
        self._beside = ChangedFiles(self._paths)
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

    def wake(self) -> None:
        """From any thread: look now."""
        self._woken.set()

    def end(self, timeout: float) -> None:
        """Ask the thread to end, and wait at most `timeout` seconds for it: the stick may hang."""
        self._ended.set()
        self._woken.set()
        self._thread.join(timeout)

    def close(self) -> None:
        """Close the copy, in the thread that calls `step`."""
        if self._copy is not None:
            self._copy.close()
            self._copy = None

    def step(self) -> None:
        """Copy everything that is missing. Never raises."""
        try:
            self._follow()
        except (CannotReadJournal, CannotWriteCopy) as error:
            trouble = error.args[0] if error.args else str(error)
            self.progress = self.progress._replace(trouble=trouble, missing_bytes=self._missing_bytes())
            self.close()

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
        question, began = self._question, self._now()
        # What is written after this look is copied by the next step, or a busy journal would never be complete.
        self._present = present = self._journal.sizes()
        self.progress = self.progress._replace(journal=self._journal.identity)
        if self._copy is None:
            self._copy = self._open_copy()
            self._beside = ChangedFiles(self._paths)
            is_earlier = self._journal.has(self._copy.held, present)
        else:
            self._copy.check()
            is_earlier = all(size <= present.get(segment, -1) for segment, size in self._copy.sizes.items())
        if not is_earlier:
            self._copy.set_aside(self._journal.identity)
        self._sizes = self._copy.sizes
        # The files come first: the journal refers to them.
        beside = self._beside.changed()
        if beside:
            self._copy.write_files(beside)
        for segment, size in present.items():
            for part in self._journal.parts(segment, self._sizes.get(segment, 0), size):
                if self._ended.is_set():
                    return
                self._copy.write(part)
                self.progress = self.progress._replace(trouble="", missing_bytes=self._missing_bytes())
        self._copy.complete()
        self.progress = self.progress._replace(trouble="", complete_mono=began, missing_bytes=0, aside=self._copy.aside)
        if question is not self._answered:
            self._answered = question
            self._on_answer(question)

    def _missing_bytes(self) -> int:
        return sum(max(0, size - self._sizes.get(name, 0)) for name, size in self._present.items())
