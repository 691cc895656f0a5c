"""The disk of one computer: what is in the files, what of it survives a power failure, and how long that takes.

The journal's files are real ones, in memory, and contain what the system's page cache has. Beside them, the disk knows
what was synced. After a power failure, each file has what was synced, and any of the sectors that were written since;
each folder has the names that were synced, and the first ones of the changes since. All of these states are legal.
"""

import errno
import os
from typing import Dict, List, Optional, Tuple

from roah_rsbb.journal import log
from roah_rsbb.journal import log_dir as log_dirs
from roah_rsbb.journal.log_dir import Resume
from roah_rsbb.journal.store import RETRY_S, Journal

from .scheduler import Ended

SECTOR = 512
SHORTEST_S, LONGEST_S = 0.0003, 0.003
# How often a thread looks whether a frozen disk takes writes.
LOOKS_S = 0.1
# What a power failure may take (docs/architecture.md, "Write first, then act"), and when the box has written what
# waited.
LOST_S, TRIES_AGAIN_S = 0.12, 2.5


class NotYet(Exception):
    """A thread still waits for the disk."""


class _Inode:
    """A file, by whatever name."""

    def __init__(self):
        self.synced = bytearray()
        self.written: List[Tuple[int, bytes]] = []  # since then

    def sync(self, count):
        """The first ones of the writes are on the disk."""
        for at, content in self.written[:count]:
            self._put(at, content)
        del self.written[:count]

    def after_power(self, random):
        """Return what a power failure leaves."""
        mode = random.random()
        for at, content in self.written:
            for begin in range(0, len(content), SECTOR):
                if mode < 0.25 or (mode < 0.75 and random.random() < 0.5):
                    self._put(at + begin, content[begin:begin + SECTOR])
        self.written.clear()
        return bytes(self.synced)

    def _put(self, at, content):
        if at > len(self.synced):
            self.synced.extend(bytes(at - len(self.synced)))
        self.synced[at:at + len(content)] = content


class _Folder:
    """The names in a folder."""

    def __init__(self):
        self.names: Dict[str, _Inode] = {}  # as programs see them
        self.synced: Dict[str, _Inode] = {}
        self.changes: List[Tuple[str, Optional[_Inode]]] = []  # since then; None: the name was removed

    def set(self, name, inode):
        if inode is None:
            self.names.pop(name, None)
        else:
            self.names[name] = inode
        self.changes.append((name, inode))

    def sync(self, count):
        for name, inode in self.changes[:count]:
            if inode is None:
                self.synced.pop(name, None)
            else:
                self.synced[name] = inode
        del self.changes[:count]


class Storage:
    """The folder log_dir of one computer."""

    def __init__(self, folder, scheduler, random, random_bytes):
        self.folder = str(folder)
        self.scheduler, self.random, self.random_bytes = scheduler, random, random_bytes
        self.slow_until = self.broken_until = self.full_until = 0.0  # true time
        self.slow_s = 1.0
        self.frozen_until = 0.0  # true time until which it takes no writes, as while a snapshot is taken
        self._troubled = self._blocked = 0.0  # since when there is trouble, and since when it takes nothing
        self._held = []  # of the newest syncs: when each is over, and when its thread notices that
        self.patient_until = 0.0  # the process's time until which a thread waits for a sync
        self._lock: Optional[int] = None  # of the journal, which the present core has
        self._journal: Optional[Journal] = None  # of the present core
        self._folders: Dict[str, _Folder] = {}
        self._open: Dict[int, _Inode] = {}
        os.makedirs(self.folder, exist_ok=True)

    def adopt(self, path):
        """The files in a folder are there, and on the disk."""
        folder = self._folders.setdefault(path, _Folder())
        for name in os.listdir(path):
            inode = folder.names[name] = folder.synced[name] = _Inode()
            with open(os.path.join(path, name), "rb") as file:
                inode.synced.extend(file.read())

    def open_journal(self, process):
        """Return what opens the journal for a core."""
        def make(session, events, on_trouble):
            lock = log_dirs.lock(self.folder)
            self._lock = lock.fd
            self._journal = Journal(
                self.folder, session, events, Resume.ALWAYS, on_trouble, lock, Files(self, process),
                process.loop.time, lambda work, group_s: Syncer(process, self, work, group_s))
            return self._journal
        return make

    @property
    def is_in_trouble(self):
        """Whether what was written lately may not be on it."""
        ends = self.slow_until, self.broken_until, self.full_until, self.frozen_until
        return self.scheduler.now < max(ends) + max(self.slow_s, TRIES_AGAIN_S)

    def fail(self, seconds, **until):
        """A trouble begins, and lasts so long. `until`: which ones."""
        now = self.scheduler.now
        self._troubled = self._troubled if self.is_in_trouble else now
        self._blocked = self._blocked if self.blocked_s() else now
        for name in until:
            setattr(self, name, now + seconds)

    def end_troubles(self):
        """All troubles end now."""
        for name in ("slow_until", "broken_until", "full_until", "frozen_until"):
            setattr(self, name, min(getattr(self, name), self.scheduler.now))

    def kept_until(self, killed_at, power):
        """Until when a process that was killed then must have kept what happened."""
        since = self._troubled if self.is_in_trouble else killed_at
        if power:
            return since - LOST_S - self._held_s()
        is_blocked = self.scheduler.now < max(self.full_until, self.frozen_until, self.broken_until) + TRIES_AGAIN_S
        return since if is_blocked else float("inf")

    def _held_s(self):
        """How much later the threads of syncs have noticed lately that these were over: a program that waits in a
        system call meanwhile holds them (`Process.wait`), which only happens here."""
        now, found = self.scheduler.now, 0.0
        for is_over, noticed in reversed(self._held):
            if noticed > now - found - LOST_S:
                found += max(0.0, min(noticed, now) - is_over)
        return found

    def _await_sync(self, wait):
        seconds = self.sync_s()
        held = [self.scheduler.now + seconds, float("inf")]
        self._held = [*self._held[-9:], held]
        try:
            wait(seconds)
        finally:
            held[1] = self.scheduler.now

    def blocked_s(self):
        """For how long it has taken nothing; 0: it does."""
        is_blocked = self.scheduler.now < max(self.full_until, self.frozen_until, self.broken_until)
        return self.scheduler.now - self._blocked if is_blocked else 0.0

    def sync_s(self):
        """How long a sync takes now."""
        if self.scheduler.now < self.slow_until:
            return self.random.uniform(0.1, self.slow_s)
        return self.random.uniform(SHORTEST_S, LONGEST_S)

    def write_s(self):
        """How long it is until the disk takes writes. The threads of the journal wait for so long."""
        return max(0.0, self.frozen_until - self.scheduler.now)

    def killed(self):
        """The process was killed: its files are closed, and the system keeps what was written."""
        writer = None if self._journal is None else self._journal._writer
        read = [] if writer is None else [fd for _, fd in writer.log._kept]
        for fd in {*self._open, *read}:
            os.close(fd)
        self._open.clear()
        self._journal = None
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def cut(self):
        """The power failed."""
        self.killed()
        for path, folder in self._folders.items():
            folder.sync(self.random.randint(0, len(folder.changes)))
            folder.changes.clear()
            folder.names = dict(folder.synced)
            for name in os.listdir(path):
                os.remove(os.path.join(path, name))
            for name, inode in folder.names.items():
                with open(os.path.join(path, name), "wb") as file:
                    file.write(inode.after_power(self.random))

    def has(self, text, is_certain=True):
        """Whether a text is in a segment of the journal. `is_certain`: a power failure now would leave it there."""
        path, text = os.path.join(self.folder, "roah_rsbb_journal"), text.encode()
        folder = self._folders.get(path, _Folder())
        for inode in reversed(list((folder.synced if is_certain else folder.names).values())):
            if text in inode.synced or (not is_certain and any(text in content for _, content in inode.written)):
                return True
        return False

    def records(self):
        """Return the numbers of all records, and what is damaged."""
        chain = log.read_chain(os.path.join(self.folder, "roah_rsbb_journal"))
        numbers, holes = [], list(chain.problems)
        for _, found in log.scans(chain.segments):
            numbers += [frame.number for frame in found.records]
            holes += found.holes
        return numbers, holes

    # -- for `Files` ----------------------------------------------------------------------------------

    def folder_of(self, path):
        """Return the folder of a path, and the name in it."""
        folder, name = os.path.split(path)
        return self._folders.setdefault(folder, _Folder()), name

    def check_space(self):
        """Raise OSError if the disk is full."""
        if self.scheduler.now < self.full_until:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def create(self, path):
        self.check_space()
        fd = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)
        folder, name = self.folder_of(path)
        self._open[fd] = _Inode()
        folder.set(name, self._open[fd])
        return fd

    def write(self, fd, content, at):
        if self.scheduler.now < self.full_until:
            content = content[:self.random.randint(0, len(content))]
        log.Files.write(fd, content, at)
        self._open[fd].written.append((at, bytes(content)))
        self.check_space()

    def sync(self, fd, wait):
        inode = self._open[fd]
        count = len(inode.written)
        self._await_sync(wait)
        if self.scheduler.now < self.broken_until:
            # The system forgets what it could not write. A part of it may be on the disk.
            kept = [write for write in inode.written[:count] if self.random.random() < 0.5]
            inode.written[:count] = kept
            inode.sync(len(kept))
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        inode.sync(count)

    def sync_folder(self, path, wait):
        folder = self._folders.get(path)
        count = 0 if folder is None else len(folder.changes)
        self._await_sync(wait)
        if self.scheduler.now < self.broken_until:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        if folder is not None:
            folder.sync(count)

    def close(self, fd):
        del self._open[fd]
        os.close(fd)


class Files(log.Files):
    """The operations on files of one process, which end with it."""

    def __init__(self, storage, process):
        self._storage, self._process = storage, process

    def _wait(self, seconds):
        process, scheduler = self._process, self._process.scheduler
        if scheduler.current is process:
            process.wait(seconds)
        else:  # the thread of a syncer: the loop continues
            scheduler.run(scheduler.now + seconds, lambda: process.is_ended or bool(scheduler.bugs))
            if process.is_ended or scheduler.bugs:
                raise Ended

    def unique(self, count):
        return self._storage.random_bytes(count)

    def make_folder(self, path):
        log.Files.make_folder(path)

    def create(self, path):
        return self._storage.create(path)

    def write(self, fd, content, at):
        self._storage.write(fd, content, at)

    def sync(self, fd):
        self._storage.sync(fd, self._wait)

    def close(self, fd):
        if not self._process.is_ended:
            self._storage.close(fd)

    def rename(self, old, new):
        if self._process.is_ended:
            raise Ended
        os.rename(old, new)
        folder, name = self._storage.folder_of(old)
        to, new_name = self._storage.folder_of(new)
        inode = folder.names.get(name)
        if inode is not None:
            to.set(new_name, inode)
            folder.set(name, None)

    def remove(self, path):
        if self._process.is_ended:
            raise Ended
        os.remove(path)
        folder, name = self._storage.folder_of(path)
        folder.set(name, None)

    def sync_folder(self, path):
        self._storage.sync_folder(path, self._wait)

    def note(self, path, text):
        self._wait(self._storage.sync_s())
        self._storage.check_space()
        if self._storage.scheduler.now < self._storage.broken_until:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        with open(path, "w", encoding="ascii") as file:
            file.write(text)


class Syncer:
    """Stands for `journal.store.Syncer`, without its thread."""

    def __init__(self, process, storage, work, group_s):
        self._process, self._storage, self._work, self._group_s = process, storage, work, group_s
        self._is_wanted = self._is_planned = self._is_hurried = self._is_working = False

    def wake(self):
        """Work soon."""
        self._is_wanted = True
        self._plan(self._group_s)

    def work(self, is_done, timeout):
        """Work at once, unless that takes long."""
        self.wake()
        if not self._is_working and not self._storage.write_s():
            self._run()
            if self._process.is_ended:  # the core, which waits here, was killed meanwhile
                raise Ended
        return is_done()

    def wait(self, is_done, timeout):
        """Work now. Raises `NotYet` in place of a wait."""
        if not is_done() and self._is_wanted and not self._is_hurried:
            self._is_hurried = True
            self._process.scheduler.after(0.0, self._run)
        if not is_done() and self._process.loop.time() < self._storage.patient_until:
            raise NotYet
        return is_done()

    def end(self):
        """Nothing: a simulated core is always killed."""

    def _plan(self, seconds):
        if not self._is_planned:
            self._is_planned = True
            self._process.scheduler.after(seconds, self._run)

    def _run(self):
        self._is_planned = self._is_hurried = False
        if not self._is_wanted or self._is_working or self._process.is_ended or self._process.scheduler.bugs:
            return
        if self._storage.write_s():
            self._plan(min(self._storage.write_s(), LOOKS_S))
            return
        self._is_wanted, self._is_working = False, True
        try:
            succeeded = self._work()
        except Ended:
            return
        self._is_working = False
        if self._is_wanted or not succeeded:
            self._is_wanted = True
            self._plan(self._group_s if succeeded else RETRY_S)
