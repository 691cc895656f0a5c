"""The file of one run log: a bag that grows, or a complete bag that replaces another one atomically.

A bag that is being written is locked, so that other processes know that it is in use.
"""

import collections
import contextlib
import errno
import io
import itertools
import os
from typing import IO, Counter, Iterable, Iterator, List, Optional, Tuple

from roah_rsbb import durable, platform
from roah_rsbb.model.run_log import KINDS
from roah_rsbb.run_logs.bag import BagWriter
from roah_rsbb.run_logs.messages import HEADERS, BadEntry, LogEntry, Message, is_sound, message_of
from roah_rsbb.run_logs.salvage import NotABag, Salvage

# A bag that is being rewritten has this suffix until it is complete.
DRAFT = ".draft"
# A damaged bag is kept with this suffix after its readable part has replaced it.
DAMAGED = ".damaged"

# Errors that writing a bag may raise.
WRITE_ERRORS = (OSError, ValueError)


class GrowingBag:
    """A bag that grows. All methods raise `WRITE_ERRORS`; after that, only `abandon` may be called."""

    def __init__(self, path: str, is_new: bool = True) -> None:
        """`is_new`: raise FileExistsError rather than overwrite a file."""
        self.path = path
        mode = "x+b" if is_new else "w+b"
        self._file = open(path, mode, opener=platform.open_file)  # noqa: SIM115 (closed with the bag)
        self._dirty = False
        self._stamp = (0, 0)
        self._same = 0
        try:
            # Some network file systems do not support locks.
            with contextlib.suppress(OSError):
                platform.lock(self._file.fileno())
            self._bag = BagWriter(self._file)
            self._file.flush()
        except BaseException:
            self.abandon()
            raise

    def write(self, message: Message) -> None:
        """Append a message and hand it to the operating system, where it survives this process.

        Simultaneous messages get different stamps, because readers sort by them.
        """
        self._same = self._same + 1 if message.stamp == self._stamp else 0
        self._stamp = message.stamp
        seconds, nanoseconds = divmod(message.stamp[1] + self._same, 1_000_000_000)
        self._dirty = True
        self._bag.write(message.topic, (message.stamp[0] + seconds, nanoseconds), message.data, message.kind)
        self._file.flush()

    def flush(self) -> None:
        """End the chunk. `rosbag reindex` can read ended chunks of a file that was not closed."""
        if self._dirty:
            self._dirty = False
            self._bag.end_chunk()
            self._file.flush()

    def is_in_place(self) -> bool:
        """Whether the file is still at its path. A deleted file stays writable through its open descriptor."""
        try:
            return os.path.samestat(os.stat(self.path), os.fstat(self._file.fileno()))
        except FileNotFoundError:
            return False

    def move(self, path: str) -> None:
        """Move the file to another path and continue there."""
        os.replace(self.path, path)
        self.path = path
        with contextlib.suppress(OSError):
            durable.sync(os.path.dirname(path) or ".")

    def settle(self) -> None:
        """Sync everything that was written to the disk."""
        self.flush()
        platform.sync(self._file.fileno())

    def close(self) -> None:
        """Write the index and sync the file to the disk."""
        self._bag.close()
        self._file.flush()
        platform.sync(self._file.fileno())
        self._file.close()

    def abandon(self) -> None:
        """Close the file without completing it."""
        with contextlib.suppress(*WRITE_ERRORS):
            self._file.close()


def write_whole(path: str, entries: Iterable[LogEntry], stays_open: bool = False) -> Tuple[GrowingBag, str]:
    """Rewrite a run log. Messages of the old file at `path` that are not among the entries are kept.

    Returns the bag, which is closed unless it `stays_open`, and the path where a damaged old file is kept; empty if
    the old file was not damaged. Entries that do not fit into a message are omitted. Raises `WRITE_ERRORS`; then the
    old file is unchanged.
    """
    draft = path + DRAFT
    messages = list(_messages(entries))
    bag = GrowingBag(draft, is_new=False)
    try:
        with _opened(path) as file:
            is_whole = _fill(bag, messages, file)
        if stays_open:
            bag.settle()
        else:
            bag.close()
        kept = "" if is_whole else _keep_aside(path)
        bag.move(path)
    except BaseException:
        bag.abandon()
        with contextlib.suppress(OSError):
            os.remove(draft)
        raise
    return bag, kept


def try_out(path: str, room: int) -> None:
    """Check that `write_whole` would succeed with `room` additional bytes; raises OSError if not."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    size = os.stat(path).st_size if os.path.exists(path) else 0
    draft = path + DRAFT
    try:
        with open(draft, "wb") as file:
            platform.reserve(file.fileno(), size + room)
    except OSError as error:
        if error.errno not in (errno.EOPNOTSUPP, errno.EINVAL):  # the file system does not support it
            raise
    finally:
        with contextlib.suppress(OSError):
            os.remove(draft)


@contextlib.contextmanager
def _opened(path: str) -> Iterator[Optional[io.BufferedReader]]:
    try:
        file = open(path, "rb")  # noqa: SIM115 (closed below)
    except FileNotFoundError:
        yield None
        return
    with file:
        yield file


def _fill(bag: GrowingBag, messages: List[Message], old_file: Optional[IO[bytes]]) -> bool:
    """Write the messages and the rest of the old file; returns whether all of the old file could be read."""
    if old_file is None:
        old, is_bag = (), True
    else:
        try:
            old, is_bag = Salvage(old_file), True
        except NotABag:
            if not messages:
                raise
            old, is_bag = (), False
    extra, fits = _extra(messages, old) if messages else (old, True)
    for message in itertools.chain(messages, filter(_is_sound, extra)):  # readers sort them by their stamps
        bag.write(message)
    return is_bag and fits and not (isinstance(old, Salvage) and old.damage)


def _extra(messages: List[Message], old: Iterable[Message]) -> Tuple[List[Message], bool]:
    """Messages of an old bag that are not among these, and whether one bag can hold both."""
    known: Counter[Tuple[str, bytes]] = collections.Counter((message.topic, message.data) for message in messages)
    sums = {message.topic: message.kind["md5sum"] for message in messages}
    # A message with another content at such a moment is one of these, torn by a power failure: bags have no checksums.
    moments = {(message.topic, message.stamp) for message in messages}
    extra: List[Message] = []
    fits = True
    for message in old:
        key = message.topic, message.data
        md5sum = message.kind["md5sum"]
        if md5sum != sums.setdefault(message.topic, md5sum):
            fits = False  # written by another version of roah_rsbb
        elif known[key] > 0:
            known[key] -= 1
        elif (message.topic, message.stamp) not in moments:
            extra.append(message)
    return extra, fits


def _is_sound(message: Message) -> bool:
    """Whether a message of an old file can be read."""
    kind = KINDS.get(message.topic)
    if kind is None or message.kind["md5sum"] != HEADERS[kind]["md5sum"]:
        return True  # written by another version of roah_rsbb
    return is_sound(kind, message.data)


def _messages(entries: Iterable[LogEntry]) -> Iterator[Message]:
    for entry in entries:
        with contextlib.suppress(BadEntry):
            yield message_of(entry)


def _keep_aside(path: str) -> str:
    """Give a file a second name; returns that name."""
    number, aside = 1, path + DAMAGED
    while os.path.lexists(aside):
        number += 1
        aside = f"{path}{DAMAGED}{number}"
    try:
        os.link(path, aside)
    except OSError:  # the file system does not support links
        os.rename(path, aside)
    return aside

