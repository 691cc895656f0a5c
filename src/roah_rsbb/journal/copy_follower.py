"""Keeps a copy of the journal up to date, in a thread of its own.

The core never waits for the copy: another process reads the journal's files. A stick that hangs stops only the thread,
and the time since the last complete copy still rises.
"""

import logging
import math
import os
import threading
import time
from types import MappingProxyType
from typing import Callable, Dict, Iterator, List, Mapping, NamedTuple, Optional

from roah_rsbb.ground.params import NONE, Params
from roah_rsbb.journal import log
from roah_rsbb.journal import log_dir as log_dirs
from roah_rsbb.journal.copy_folder import (
    FILES,
    PART_BYTES,
    CannotReadJournal,
    CannotWriteCopy,
    ChangedFiles,
    Copy,
    Held,
    Part,
    crc_of,
    identity_in,
)

# -- reading the journal ------------------------------------------------------------------------------

# Theory of operation. A segment is only appended to, and none is written after the next one has its name. So a copy is
# an earlier state of the journal if each of its segments is the beginning of the segment with the same name, which
# contains a random number. The bytes of older segments are copied as they are, with their damage; those of the newest
# one up to the end of its last intact record: what follows is being written, or is written again when the disk has
# space.


class JournalSegments:
    """The journal in a folder, which another process may write."""

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._newest = ""  # a segment,
        self._end = 0  # and where its last intact record ends
        self.identity = ""  # of the journal; empty: unknown

    def sizes(self) -> Dict[str, int]:
        """Return how many bytes of each segment can be copied, the oldest first. Raises `CannotReadJournal`."""
        try:
            names = log.names_in(self._folder)
            sizes = {str(name): os.stat(self._path(str(name))).st_size for name in names}
            if names:
                sizes[str(names[-1])] = self._end_of_newest(names[-1], sizes[str(names[-1])])
        except OSError as error:
            raise self._cannot_read(error) from None
        if not sizes:
            raise CannotReadJournal(f"there is no journal {self._folder} yet")
        return sizes

    def has(self, held: Mapping[str, Held], sizes: Mapping[str, int]) -> bool:
        """Whether a copy with these segments is an earlier state of the journal. Raises `CannotReadJournal`."""
        try:
            return all(size <= sizes.get(name, -1) and crc_of(self._path(name), size) == crc
                       for name, (size, crc) in held.items())
        except OSError as error:
            raise self._cannot_read(error) from None

    def parts(self, segment: str, begin: int, end: int) -> Iterator[Part]:
        """Return the parts of a segment between these bytes. Raises `CannotReadJournal`."""
        if begin >= end:
            return  # most segments never change any more
        try:
            with open(self._path(segment), "rb") as file:
                file.seek(begin)
                while begin < end:
                    content = file.read(min(PART_BYTES, end - begin))
                    if not content:
                        raise CannotReadJournal(f"{self._path(segment)} is shorter than before")
                    yield Part(segment, begin, content, begin + len(content) == end)
                    begin += len(content)
        except OSError as error:
            raise self._cannot_read(error) from None

    # -- steps --------------------------------------------------------------------------------------

    def _path(self, segment: str) -> str:
        return os.path.join(self._folder, segment)

    def _cannot_read(self, error: OSError) -> CannotReadJournal:
        return CannotReadJournal(f"{self._folder}: {error.strerror}")

    def _end_of_newest(self, name: log.Name, size: int) -> int:
        if str(name) != self._newest or size < self._end:
            self._newest, self._end = str(name), log.HEAD_BYTES
            with open(self._path(str(name)), "rb") as file:
                self.identity = identity_in(file.read(log.HEAD_BYTES))
        if size > self._end:
            with open(self._path(str(name)), "rb") as file:
                file.seek(self._end)
                content = file.read(size - self._end)
            self._end += max((frame.end for frame in log.frames(content, name.salt, 0)), default=0)
        return self._end


# -- following it -------------------------------------------------------------------------------------

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


# -- what is reported ---------------------------------------------------------------------------------

_log = logging.getLogger(__name__)


class CopyNews(NamedTuple):
    """The state of a copy."""

    place: str
    journal: str  # identity of the journal that it copies
    behind_s: float  # since it was complete; inf: it never was
    missing_bytes: int
    trouble: str  # why it is not complete, with the remedy; empty: nothing prevents it
    notice: str  # what referees must know besides


class ReportedCopy:
    """A copy, and what was logged about it."""

    def __init__(self, place: str, follower: Follower, notice: Callable[[], str] = lambda: "") -> None:
        """Start to copy. `notice` returns what referees must know besides."""
        self.place = place
        self.follower = follower
        self._notice = notice
        self._trouble = self._aside = ""
        follower.start()

    def news(self) -> CopyNews:
        """Return the present state, and log what is new in it."""
        progress = self.follower.progress
        if progress.trouble != self._trouble:
            if progress.trouble:
                _log.warning("%s: %s", self.place, progress.trouble)
            self._trouble = progress.trouble
        if progress.aside and progress.aside != self._aside:
            _log.warning("%s: the earlier copy is not of this journal, or is damaged. It is kept as %s",
                         self.place, progress.aside)
            self._aside = progress.aside
        behind_s = math.inf if progress.complete_mono is None else time.monotonic() - progress.complete_mono
        return CopyNews(self.place, progress.journal, behind_s, progress.missing_bytes, progress.trouble,
                        self._notice())


# In the environment of the program that copies: the process that started it, which may be gone already.
PARENT = "ROAH_RSBB_PARENT"


class CopySettings(NamedTuple):
    """What is copied to where."""

    log_dir: str
    backup_dir: str  # empty: to no folder
    standby_port: int  # TCP; 0: to no standby
    bind_host: str  # own address for the standby
    passwords_file: str  # a standby needs it to continue,
    rsbb_host: str  # and these
    rsbb_port: int
    modules_dir: str  # empty: it needs no benchmarking modules
    of_venue: Mapping[str, str] = MappingProxyType({})  # and these arguments, which depend on no computer

    @property
    def words(self) -> List[str]:
        """As a command line has them; none: nothing is to be copied."""
        values = self._replace(backup_dir=self.backup_dir or NONE)._asdict()
        values.update(values.pop("of_venue"))
        return [f"{name}:={value}" for name, value in values.items()] if self.backup_dir or self.standby_port else []


def copy_settings(params: Params) -> CopySettings:
    """Read them. Raises `BadParams`."""
    found = CopySettings(
        params.path("log_dir", "~/.ros/roah_rsbb"), params.path_or_none("backup_dir"),
        params.whole("standby_port", 0, 0, 65535), params.text("bind_host", "0.0.0.0"),
        params.path("passwords_file", NONE), params.text("rsbb_host", "10.255.255.255"),
        params.whole("rsbb_port", 6666, 1, 65000), params.path("modules_dir", ""), _of_venue(params))
    params.done()
    return found


def _of_venue(params: Params) -> Dict[str, str]:
    found = {
        **{name: params.flag(name, False) for name in (
            "devices", "tablet", "web", "public_provisional", "public_robot_texts")},
        "smartif_host": params.text("smartif_host", ""), "smartif_port": params.whole("smartif_port", 6665, 1, 65535),
        "tablet_port": params.whole("tablet_port", 8080, 0, 65535),
        "web_port": params.whole("web_port", 8081, 0, 65535),
        "public_results": params.text("public_results", NONE), "team_pages": params.text("team_pages", "code"),
        "web_title": params.text("title", ""),
    }
    return {name: str(value).lower() if isinstance(value, bool) else str(value)
            for name, value in found.items() if value != ""}
