"""Makes the bags of runs from the journal, which has every entry of a run."""

import contextlib
import errno
import os
from typing import Dict, Iterable, Mapping, Tuple

from roah_rsbb.ground.durable import USUAL, has_space, write_file
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.model.run_log import KINDS
from roah_rsbb.run_logs.bag import Bag
from roah_rsbb.run_logs.messages import BadEntry, LogEntry, message_of


class _RunLog:
    """The bag of a robot in a run."""

    def __init__(self) -> None:
        self._bag = Bag()
        self._stamp = (0, 0)
        self._same = 0

    def add(self, entry: LogEntry) -> None:
        """Append an entry, unless it does not fit into its message.

        Simultaneous messages get different stamps, because readers sort by them.
        """
        with contextlib.suppress(BadEntry):
            message = message_of(entry)
            self._same = self._same + 1 if message.stamp == self._stamp else 0
            self._stamp = message.stamp
            seconds, nanoseconds = divmod(message.stamp[1] + self._same, 1_000_000_000)
            self._bag.write(message.topic, (message.stamp[0] + seconds, nanoseconds), message.data, message.kind)

    def write(self, path: str) -> None:
        """Write the file, whole or not at all. The last of the disk belongs to the journal. Raises OSError."""
        content = self._bag.content()
        if not has_space(os.path.dirname(path), len(content)):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), path)
        write_file(path, content, USUAL)


def write_bag(path: str, entries: Iterable[LogEntry]) -> None:
    """Write the log of a robot in a run, whole or not at all. Raises OSError."""
    bag = _RunLog()
    for entry in entries:
        bag.add(entry)
    bag.write(path)


def write_bags(reader: JournalReader, paths: Mapping[Tuple[str, int], str]) -> None:
    """Write the logs of robots to these paths, by the identities of their runs and their ports. This reads the journal
    once. Raises OSError and `JournalError`."""
    bags: Dict[Tuple[str, int], _RunLog] = {which: _RunLog() for which in paths}
    for entry in reader.entries_of({identity for identity, _ in paths}):
        bag = bags.get((entry.identity, entry.port or 0))
        if bag is not None and entry.kind in KINDS:
            bag.add((entry.kind, entry.value, entry.utc))
    for which, path in paths.items():
        bags.pop(which).write(path)
