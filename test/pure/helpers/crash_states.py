"""What a power failure can leave of the files that a program writes.

`Recording` runs a program that preloads `recorded_writes.c`, and has its operations on the files of a folder in their
order. `crash_states` makes from them what can be on the disk if the power fails at some moment. Theory of operation:

- What was written before an fsync began is on the disk when that fsync has returned. Of everything else, each sector
  may be there or not, in any of the versions that it had since, whatever the order in which it was written.
- The size of a file is independent of that: any size that it had since, and sizes in between while it grows. Sectors
  that a file gains contain zeros, or anything: what the disk had there before, such as an old part of the same file.
- Names (files and folders created, renamed, removed) reach the disk in their order, at the latest with an fsync of
  their folder. Nothing is found in a folder whose own name is not on the disk.
- After a failed fsync, what was to be written counts as written for Linux, and never reaches the disk unless it is
  written again; a later fsync succeeds without it.
- A process that is killed takes nothing with it: its successor reads what it wrote, also if it is not on the disk.

A disk may write 512 bytes or 4 kB at once: each state uses one of both.
"""

import contextlib
import os
import pathlib
import random
import signal
import struct
import subprocess
import tempfile
from typing import Dict, Iterator, List, NamedTuple, Optional, Set, Tuple

BLOCK = 512
# Blocks that are written together.
SECTORS = (1, 8)
# A lock has no content.
NOT_KEPT = (".lock",)
_HEAD = struct.Struct("=cQqII")
_SOURCE = os.path.join(os.path.dirname(__file__), "recorded_writes.c")


class Operation(NamedTuple):
    """What a program did to a file, a folder or, with `mark`, to the record itself."""

    kind: str
    inode: int
    at: int
    thread: int
    data: bytes

    @property
    def names(self) -> List[str]:
        """The names of what was created, renamed, removed or synced; the text of a mark."""
        return [os.fsdecode(name) for name in self.data.split(b"\0")]


CREATE, MAKE_FOLDER, WRITE, RESIZE, RENAME, REMOVE, MARK = "c", "d", "w", "t", "r", "u", "a"
SYNC, SYNCED, NOT_SYNCED = "F", "f", "x"


class CannotRecord(Exception):
    """This computer has no compiler, or cannot preload a library."""


class Recorder:
    """Compiles the library once; runs programs with it."""

    def __init__(self, folder) -> None:
        self._library, self._folder = str(folder / "recorded_writes.so"), folder
        try:
            subprocess.run(["cc", "-O1", "-shared", "-fPIC", "-pthread", "-o", self._library, _SOURCE, "-ldl"],
                           check=True)
        except (OSError, subprocess.CalledProcessError) as error:
            raise CannotRecord(str(error)) from None

    def run(self, folder, commands: List[List[str]], fail: str = "", fail_at: int = 0) -> List[Operation]:
        """Run programs one after the other, all of which write in `folder`. Each of them ends by itself, or kills
        itself between two operations. The `fail_at`-th fsync of each of a file whose name ends with `fail` fails."""
        log = str(self._folder / "operations")
        if os.path.exists(log):
            os.remove(log)
        environment = {**os.environ, "LD_PRELOAD": self._library, "RECORDED_FOLDER": str(folder), "RECORDED_LOG": log,
                       "RECORDED_FAIL": str(fail_at), "RECORDED_FAIL_NAME": fail}
        for command in commands:
            done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            assert done.returncode in (0, -signal.SIGKILL), done.stdout.decode()
        with open(log, "rb") as file:
            return list(_operations(file.read()))


def _operations(content: bytes) -> Iterator[Operation]:
    at = 0
    while at < len(content):
        kind, inode, place, thread, length = _HEAD.unpack_from(content, at)
        at += _HEAD.size + length
        yield Operation(kind.decode(), inode, place, thread, content[at - length:at])


class Version(NamedTuple):
    """What a block contained after an operation that is not on the disk for certain."""

    number: int  # of the operation
    content: bytes
    is_doubtful: bool  # an fsync of it failed


class File:
    """A file: what the system has of it, what the disk has for certain, and what it may have."""

    def __init__(self) -> None:
        self.cache = bytearray()
        self._durable = bytearray()
        self._versions: Dict[int, List[Version]] = {}  # by block
        self._sizes: List[Tuple[int, int]] = []  # by operation
        self._gained: set = set()  # blocks that may have any content, because they are new to the file
        self._old: List[bytes] = [bytes(BLOCK)]  # former blocks

    def write(self, number: int, at: int, data: bytes) -> None:
        """The program wrote."""
        end, size = at + len(data), len(self.cache)
        if end > size:
            self.resize(number, end)
        self.cache[at:end] = data
        for block in range(at // BLOCK, -(-end // BLOCK)):
            self._note(number, block)

    def resize(self, number: int, size: int) -> None:
        """The program made it longer or shorter."""
        before = len(self.cache)
        del self.cache[size:]
        self.cache.extend(bytes(size - len(self.cache)))
        self._sizes.append((number, size))
        self._gained.update(range(-(-min(before, size) // BLOCK), -(-max(before, size) // BLOCK)))
        if size % BLOCK and size < before:
            self._note(number, size // BLOCK)

    def _note(self, number: int, block: int) -> None:
        content = bytes(self.cache[block * BLOCK:(block + 1) * BLOCK]).ljust(BLOCK, b"\0")
        self._versions.setdefault(block, []).append(Version(number, content, False))

    def synced(self, number: int) -> None:
        """An fsync that began after the operation `number` has succeeded."""
        size = max((n, size) for n, size in self._sizes + [(-1, len(self._durable))] if n <= number)[1]
        del self._durable[size:]
        self._durable.extend(bytes(size - len(self._durable)))
        self._sizes = [one for one in self._sizes if one[0] > number]
        for block, versions in list(self._versions.items()):
            newest = max((v for v in versions if v.number <= number), default=None)
            if newest is None or newest.is_doubtful:
                continue
            if len(self._old) < 4000:
                self._old.append(bytes(self._durable[block * BLOCK:(block + 1) * BLOCK]).ljust(BLOCK, b"\0"))
            content = newest.content[:max(0, size - block * BLOCK)]
            self._durable[block * BLOCK:block * BLOCK + len(content)] = content
            left = [v for v in versions if v.number > newest.number]
            self._gained.discard(block)
            if left:
                self._versions[block] = left
            else:
                del self._versions[block]

    def not_synced(self, number: int) -> None:
        """An fsync that began after the operation `number` has failed."""
        for block, versions in self._versions.items():
            self._versions[block] = [v._replace(is_doubtful=v.is_doubtful or v.number <= number) for v in versions]

    @property
    def is_certain(self) -> bool:
        """Whether the disk has all of it."""
        return not self._versions and not self._sizes

    def on_disk(self, chance: random.Random, how: str, sector: int) -> bytes:
        """Return one of the contents that the disk may have."""
        if how == NEWEST:
            return bytes(self.cache)
        if how == CERTAIN and not self._gained:
            return bytes(self._durable)
        size = self._size(chance, how)
        content = self._durable[:size]
        content.extend(bytes(size - len(content)))
        stale = chance.choice((None, None, bytes(BLOCK), chance.choice(self._old), b"\xa5" * BLOCK))
        sectors: Dict[int, float] = {}
        share = {CERTAIN: 0.0, FEW: 0.05, HALF: 0.5, MOST: 0.95, ANY: 0.5}.get(how, 0.0)
        touched = sorted({*self._versions, *self._gained})
        one = chance.choice(touched) // sector if touched and how in (ONE, ALL_BUT_ONE) else -1
        for block in touched:
            if block * BLOCK >= size:
                continue
            if how in (ONE, ALL_BUT_ONE):
                is_there = (block // sector == one) is (how == ONE)
            else:
                is_there = sectors.setdefault(block // sector, chance.random()) < share
            versions = self._versions.get(block, ())
            found: Optional[bytes] = None
            if is_there and versions:
                found = (chance.choice(versions) if how == ANY else versions[-1]).content
            elif block in self._gained:
                found = chance.choice(self._old) if stale is None else stale
            if found is not None:
                content[block * BLOCK:(block + 1) * BLOCK] = found
        return bytes(content[:size])

    def _size(self, chance: random.Random, how: str) -> int:
        sizes = [len(self._durable), *(size for _, size in self._sizes)]
        if how == CERTAIN:
            return sizes[0]
        low, high = min(sizes), max(sizes)
        return chance.choice((sizes[0], sizes[-1], sizes[-1], chance.choice(sizes),
                              min(high, low + BLOCK * chance.randint(0, -(-(high - low) // BLOCK)))))


NEWEST, CERTAIN, FEW, HALF, MOST, ANY, ONE, ALL_BUT_ONE = (
    "newest", "certain", "few", "half", "most", "any", "one", "all but one")
HOW = (NEWEST, CERTAIN, FEW, HALF, MOST, ANY, ONE, ALL_BUT_ONE)


class Disk:
    """All files and names while a program runs."""

    def __init__(self) -> None:
        self.files: Dict[int, File] = {}
        self.names: Dict[str, int] = {}  # as the system has them
        self._folders: Set[str] = set()  # the names of those that were made
        self._durable_names: Dict[str, int] = {}
        self._waiting_names: List[Tuple[int, Operation]] = []
        self._begun: Dict[Tuple[int, int], Tuple[int, str]] = {}

    def do(self, number: int, operation: Operation) -> None:
        """The program did something."""
        kind, inode, at, thread, data = operation
        if kind in (CREATE, MAKE_FOLDER, RENAME, REMOVE):
            if kind == MAKE_FOLDER:
                self._folders.add(operation.names[0])
            elif kind == RENAME and operation.names[0] in self._folders:
                self._folders.add(operation.names[1])
            elif kind == CREATE and inode not in self.names.values():
                self.files[inode] = File()  # the number of a removed file is used again
            _apply(self.names, operation)
            self._waiting_names.append((number, operation))
        elif kind == SYNC:
            self._begun[thread, inode] = number, operation.names[0]
        elif kind in (SYNCED, NOT_SYNCED):
            self._end_sync(inode, *self._begun.pop((thread, inode)), kind == SYNCED)
        elif kind == WRITE:
            self.files[inode].write(number, at, data)
        elif kind == RESIZE:
            self.files[inode].resize(number, at)

    def _end_sync(self, inode: int, number: int, path: str, is_synced: bool) -> None:
        file = self.files.get(inode)
        if file is not None:
            (file.synced if is_synced else file.not_synced)(number)
        elif is_synced:  # a folder
            synced = [one for one in self._waiting_names
                      if one[0] <= number and os.path.dirname(one[1].names[-1]) == path]
            for one in synced:
                _apply(self._durable_names, one[1])
                self._waiting_names.remove(one)

    def after_power_failure(self, chance: random.Random) -> Dict[str, bytes]:
        """Return one of the states that the disk may have: the contents of files by name."""
        names = dict(self._durable_names)
        count = len(self._waiting_names)
        for _, operation in self._waiting_names[:chance.choice((0, count, count, chance.randint(0, count)))]:
            _apply(names, operation)
        sector, joint = chance.choice(SECTORS), chance.choice((None, None, None, *HOW))
        return {
            name: self.files[inode].on_disk(chance, joint or chance.choice(HOW), sector)
            for name, inode in sorted(names.items()) if self._is_file(name) and self._is_found(names, name)
        }

    def _is_file(self, name: str) -> bool:
        return name not in self._folders and not name.endswith(NOT_KEPT)

    def _is_found(self, names: Dict[str, int], name: str) -> bool:
        """Whether a name is in a folder that is on the disk."""
        folder = os.path.dirname(name)
        return folder not in self._folders or (folder in names and self._is_found(names, folder))

    def after_kill(self) -> Dict[str, bytes]:
        """Return what a killed process leaves."""
        return {name: bytes(self.files[inode].cache) for name, inode in self.names.items() if self._is_file(name)}


def _apply(names: Dict[str, int], operation: Operation) -> None:
    if operation.kind in (CREATE, MAKE_FOLDER):
        names[operation.names[0]] = operation.inode
    elif operation.kind == REMOVE:
        names.pop(operation.names[0], None)
    elif operation.names[0] in names:
        old, new = operation.names
        names[new] = names.pop(old)
        for name in [name for name in names if name.startswith(f"{old}/")]:
            names[new + name[len(old):]] = names.pop(name)


class CrashState(NamedTuple):
    """What a power failure left."""

    files: Dict[str, bytes]
    marks: Tuple[str, ...]  # what the program had announced and acknowledged until then
    after: int  # the number of operations before it


def crash_states(operations: List[Operation], count: int, seed: object) -> Iterator[CrashState]:
    """Return `count` different states, of moments between all operations; fewer if no moment has more."""
    chance = random.Random(f"{seed}")
    seen, left, moments = set(), count, set(range(len(operations)))
    while left and moments:
        disk, marks, to_come = Disk(), [], len(moments)
        for number, operation in enumerate(operations):
            disk.do(number, operation)
            if operation.kind == MARK:
                marks += operation.names
            if number not in moments:
                continue
            # The same share of the rest at each moment; a fraction is a chance.
            wanted = int(left / to_come + chance.random())
            to_come -= 1
            is_new = not wanted
            for _ in range(3 * wanted):  # many are equal
                if not wanted:
                    break
                files = disk.after_power_failure(chance)
                key = hash((tuple(files.items()), len(marks)))
                if key not in seen:
                    seen.add(key)
                    wanted, left, is_new = wanted - 1, left - 1, True
                    yield CrashState(files, tuple(marks), number + 1)
            if not is_new:  # the next round takes more of the moments that have more
                moments.remove(number)


@contextlib.contextmanager
def in_memory() -> Iterator[pathlib.Path]:
    """A folder for thousands of small files, in memory where the system has such a place; it is removed at the end."""
    memory = "/dev/shm"
    with tempfile.TemporaryDirectory(dir=memory if os.access(memory, os.W_OK) else None) as path:
        yield pathlib.Path(path)


def put(files: Dict[str, bytes], recorded, folder) -> None:
    """Write the files of a state, which are of the folder `recorded`, into another folder."""
    for name, content in files.items():
        path = os.path.join(str(folder), os.path.relpath(name, str(recorded)))
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "wb") as file:
            file.write(content)
