"""What must survive power failures: programs that write and acknowledge, and what is found afterwards.

Each subject has `live`, which runs in a recorded process, and `found`, which opens what is left with the real code
(`newest`: the newest acknowledged entry). The enumeration of `crash_states.py` knows nothing else of a subject.
"""

import contextlib
import ctypes
import functools
import json
import os
import random
import shutil
import sys
from typing import Callable, Dict, List, NamedTuple, Set, Tuple

ISSUED, ACKNOWLEDGED, CONTINUED = "issued", "acknowledged", "continued"


class Found(NamedTuple):
    """What is left after a power failure."""

    numbers: List[int]  # of the entries, in order
    problem: str  # why it cannot be used; empty: it can
    state: int = -1  # the entry after which a core resumes; -1: it does not
    is_recovered: bool = False  # it was not intact, and the program recovered it by itself


class Recorded:
    """In the recorded process: what is recorded beside its operations."""

    def __init__(self) -> None:
        self._library = ctypes.CDLL(None)

    def issued(self, number: int) -> None:
        """From here on, entry `number` may be found."""
        self._library.recorded_mark(f"{ISSUED} {number}".encode())

    def acknowledged(self, number: int) -> None:
        """From here on, all entries up to `number` must be found."""
        self._library.recorded_mark(f"{ACKNOWLEDGED} {number}".encode())

    def continued(self, number: int) -> None:
        """A new process has found everything up to entry `number`. Later entries were only in the memory of the one
        before; they are lost, and none of them was acknowledged."""
        self._library.recorded_mark(f"{CONTINUED} {number}".encode())

    def kill(self) -> None:
        """End this process between two operations."""
        self._library.recorded_kill()


def limits(marks: Tuple[str, ...]) -> Tuple[Set[int], int]:
    """Return all acknowledged entries, and the newest issued one (0: none)."""
    acknowledged: Set[int] = set()
    lost: Set[int] = set()
    issued = 0
    for mark in marks:
        word, number = mark.split()[0], int(mark.split()[1])
        if word == ISSUED:
            issued = number
        elif word == CONTINUED:
            lost.update(range(number + 1, issued + 1))
            assert not lost & acknowledged, f"a process that was killed took {lost & acknowledged} with it"
        else:
            acknowledged.update(set(range(1, number + 1)) - lost)
    return acknowledged, issued


@functools.lru_cache(maxsize=None)
def text_of(number: int) -> str:
    """The content of an entry: from its number alone, of very different lengths."""
    chance = random.Random(number)
    return f"entry {number} " + "".join(chance.choices("abcdefgh", k=chance.choice((10, 100, 400, 5000))))


def number_of(text: str) -> int:
    """The number of an entry's content; 0: nobody wrote this."""
    words = text.split()
    number = int(words[1]) if len(words) == 3 and words[1].isdigit() else 0
    return number if number and text == text_of(number) else 0


class Journal:
    """The box's journal: `journal/store.py`."""

    LIVES = (20, 25, 12)  # entries of each process; all but the last one are killed

    @staticmethod
    def live(folder: str, life: int, recorded: Recorded) -> None:
        """Write the entries of a process."""
        from roah_rsbb.journal import log, store

        log.FULL_BYTES, store.RETRY_S = 8000, 0.0
        journal = Journal.opened(folder)[0]
        chance = random.Random(life)
        recorded.continued(number_of(journal.previous.states.get("zone:Home", "")))
        first = 1 + sum(Journal.LIVES[:life])
        for number in range(first, first + Journal.LIVES[life]):
            recorded.issued(number)
            ticket = journal.write(Journal.batch(number))
            if chance.random() < 0.4 and not journal.why_not_saved(ticket):
                recorded.acknowledged(number)
        if life + 1 < len(Journal.LIVES):
            recorded.kill()
        journal.close()
        recorded.acknowledged(number)

    @staticmethod
    def opened(folder: str, boot: str = "boot"):
        """Open the journal as a core does, and return it and what it reports."""
        from roah_rsbb.journal.log_dir import CoreSession, Resume
        from roah_rsbb.journal.store import Journal

        troubles: List[str] = []
        session = CoreSession(1e9, 1.0, boot, 1, "uuid", "")
        return Journal(folder, session, [["Home", "HNF", "Alpha", 1, 1, 0.0]], Resume.ALWAYS, troubles.append), troubles

    @staticmethod
    def batch(number: int):
        """The changes of one event: an entry, and the state from which a core resumes."""
        from roah_rsbb.journal.records import Batch, Member, NewEntry

        text = text_of(number)
        entry = NewEntry(1e9 + number, 1.0 + number, "Home", "run", 6667, "", "notice", text)
        members = [Member(6667 + number, "run", "Alpha", "r1")] if number % 10 == 1 else []
        return Batch(entries=[entry], members=members, states={"zone:Home": text})

    @staticmethod
    def found(folder: str, newest: int) -> Found:
        """Start a core with it."""
        from roah_rsbb.journal.log_dir import DamagedJournal
        from roah_rsbb.journal.reader import JournalReader

        try:
            journal, troubles = Journal.opened(folder, "next boot")
        except DamagedJournal as error:
            return Found([], f"refused: {error}")
        journal.close()
        problems = [text for text in (*troubles, *journal.warnings) if text and "as after a power failure" not in text]
        if problems:
            return Found([], "; ".join(problems))
        reader = JournalReader(journal.path)
        numbers = [number_of(entry.value) for entry in reader.entries("run")]
        return Found(numbers, str(reader.damage or ""), number_of(journal.previous.states.get("zone:Home", "")))


class SealsPageCache(Journal):
    """The same, but a process takes for proven what it reads of the one that was killed. The enumeration must find this
    and the next two faults out."""

    @staticmethod
    def live(folder: str, life: int, recorded: Recorded) -> None:
        """Write the entries of a process."""
        from roah_rsbb.journal import contents

        scan = contents.scan

        def scan_all(*arguments):
            found = scan(*arguments)
            return found._replace(proven=found.last, proven_end=max((f.end for f in found.records), default=64))

        contents.scan = scan_all
        Journal.live(folder, life, recorded)


class NamesTooEarly(Journal):
    """The same, but a segment gets its name before it is on the disk."""

    @staticmethod
    def live(folder: str, life: int, recorded: Recorded) -> None:
        """Write the entries of a process."""
        from roah_rsbb.journal import log

        switch, sync = log.Log._switch, log.Files.sync

        def early(self, segment, fd, *of_switch):
            switch(self, segment, fd, *of_switch)
            sync(fd)

        log.Log._switch = early
        log.Files.sync = staticmethod(
            lambda fd: None if os.readlink(f"/proc/self/fd/{fd}").endswith(".new") else sync(fd))
        Journal.live(folder, life, recorded)


class TrustsFailedSync(Journal):
    """The same, but it syncs the same file again after a failed fsync."""

    @staticmethod
    def live(folder: str, life: int, recorded: Recorded) -> None:
        """Write the entries of a process."""
        from roah_rsbb.journal import log

        sync = log.Log.sync

        def again(self):
            try:
                sync(self)
            except OSError:
                self._must_begin = False
                raise

        log.Log.sync = again
        Journal.live(folder, life, recorded)


class Copy:
    """A copy of the journal in another folder: `copies/`."""

    LIVES = (20, 20, 20)
    SOURCE = ".source"  # nobody records this folder

    @staticmethod
    def live(folder: str, life: int, recorded: Recorded) -> None:
        """Copy a journal, part by part."""
        from roah_rsbb.journal import copy_folder as folders
        from roah_rsbb.journal import copy_follower, log, store
        from roah_rsbb.journal.copy_follower import Follower

        log.FULL_BYTES, copy_follower.PART_BYTES, folders.CERTAIN_BYTES = 8000, 3000, 5000
        store.WRITE_S = 60.0  # nobody copies what a busy computer has not written yet
        source = f"{folder}{Copy.SOURCE}"
        journal, _ = Journal.opened(source)
        follower = Follower(source, folders.Stick(folder, source).open)
        chance = random.Random(life)
        first = 1 + sum(Copy.LIVES[:life])
        for number in range(first, first + Copy.LIVES[life]):
            with open(os.path.join(source, "used_private_ports"), "a", encoding="ascii") as ports:
                ports.write(f"{6667 + number}\n")
            recorded.issued(number)
            ticket = journal.write(Journal.batch(number))
            if chance.random() < 0.7:
                journal.why_not_saved(ticket)
            if chance.random() < 0.3:  # otherwise several parts are copied at once
                follower.step()
                if not follower.progress.trouble:
                    recorded.acknowledged(number)
        if life + 1 < len(Copy.LIVES):
            recorded.kill()
        follower.close()
        journal.close()

    @staticmethod
    def found(folder: str, newest: int) -> Found:
        """Start a core with it. Or continue the copy, which is then like the journal."""
        from roah_rsbb.journal.copy_folder import CopyFolder, drop_drafts
        from roah_rsbb.journal.copy_follower import Follower

        continued = f"{folder}.continued"
        shutil.copytree(folder, continued)
        try:
            follower = Follower(os.path.join(os.path.dirname(folder), f"files{Copy.SOURCE}"),
                                lambda: CopyFolder(continued))
            follower.step()
            follower.close()
        finally:
            shutil.rmtree(continued)
        if follower.progress.trouble or follower.progress.aside:
            return Found([], f"it cannot be continued: {follower.progress}")
        drop_drafts(folder)
        found = Journal.found(folder, newest)
        with contextlib.suppress(FileNotFoundError), \
                open(os.path.join(folder, "used_private_ports"), encoding="ascii") as file:
            ports = [int(line) for line in file]
            if found.numbers and max(ports) < 6667 + max(found.numbers):
                return found._replace(problem=f"the newest port is {max(ports)}")
        return found


class CopyOfUnsyncedDrafts(Copy):
    """The same, but a segment gets its name before it is on the disk."""

    @staticmethod
    def live(folder: str, life: int, recorded: Recorded) -> None:
        """Copy a journal, part by part."""
        fsync = os.fsync
        os.fsync = lambda fd: None if os.readlink(f"/proc/self/fd/{fd}").endswith(".log.new") else fsync(fd)
        Copy.live(folder, life, recorded)


class CopyThatTrustsFailedSync(Copy):
    """The same, but a segment is continued after a failed fsync."""

    @staticmethod
    def live(folder: str, life: int, recorded: Recorded) -> None:
        """Copy a journal, part by part."""
        from roah_rsbb.journal import copy_folder as folders

        folders._syncing = lambda *segments: contextlib.suppress(OSError)
        Copy.live(folder, life, recorded)


class CopyThatTakesTheDiskOfTheBoxForItsOwn(Copy):
    """The same, but it does not say what is on its own disk."""

    @staticmethod
    def live(folder: str, life: int, recorded: Recorded) -> None:
        """Copy a journal, part by part."""
        from roah_rsbb.journal import log

        log.note_certain = lambda *_: None
        Copy.live(folder, life, recorded)


class KeptFile:
    """A file of the web gateway: `ground/kept_file.py`."""

    LIVES = (15, 15, 10)

    @staticmethod
    def opened(folder: str, reports: List[str]):
        """Return what saves the file, and its content."""
        from roah_rsbb.ground.kept_file import open_kept

        return open_kept(folder, "settings.json", lambda save, content: (save, content), [], reports.append, "")

    @staticmethod
    def live(folder: str, life: int, recorded: Recorded) -> None:
        """Save the file again and again."""
        save, content = KeptFile.opened(folder, [])
        for _ in range(KeptFile.LIVES[life]):
            content.append(text_of(len(content) + 1))
            recorded.issued(len(content))
            with contextlib.suppress(OSError):  # the next one has it, too
                save(content)
                recorded.acknowledged(len(content))
        if life + 1 < len(KeptFile.LIVES):
            recorded.kill()

    @staticmethod
    def found(folder: str, newest: int) -> Found:
        """Open it."""
        reports: List[str] = []
        _, content = KeptFile.opened(folder, reports)
        return Found([number_of(text) for text in content], "; ".join(reports))


SUBJECTS: Dict[str, type] = {each.__name__: each for each in (
    Journal, SealsPageCache, NamesTooEarly, TrustsFailedSync, Copy, CopyOfUnsyncedDrafts, CopyThatTrustsFailedSync,
    CopyThatTakesTheDiskOfTheBoxForItsOwn, KeptFile)}


def lives_of(name: str, folder) -> List[List[str]]:
    """The commands of the processes of a subject, one after the other."""
    import roah_rsbb

    paths = json.dumps([sys.path, list(roah_rsbb.__path__)])
    return [[sys.executable, os.path.abspath(__file__), name, str(folder), str(life), paths]
            for life in range(len(SUBJECTS[name].LIVES))]


def problem_of(found: Found, marks: Tuple[str, ...]) -> str:
    """Return what is wrong with what was found after a power failure; empty: nothing."""
    acknowledged, issued = limits(marks)
    if found.problem:
        return found.problem
    missing, newest = acknowledged - set(found.numbers), max(acknowledged, default=0)
    if missing:
        return f"of {len(acknowledged)} acknowledged entries, {sorted(missing)[:5]} are missing"
    if found.state != -1 and not newest <= found.state <= max(found.numbers, default=0):
        return f"the state is that of entry {found.state}; {newest} is acknowledged"
    if found.numbers != sorted(set(found.numbers)) or not set(found.numbers) <= set(range(1, issued + 1)):
        return f"nobody wrote {found.numbers} ({issued} were issued)"
    return ""


@contextlib.contextmanager
def quiet_folder(parent):
    """A folder that is removed at the end."""
    folder = os.path.join(str(parent), "state")
    os.mkdir(folder)
    try:
        yield folder
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    sys.path[:], package = json.loads(sys.argv[4])
    import roah_rsbb as package_module

    package_module.__path__ = package
    live: Callable[..., None] = SUBJECTS[sys.argv[1]].live
    live(sys.argv[2], int(sys.argv[3]), Recorded())
