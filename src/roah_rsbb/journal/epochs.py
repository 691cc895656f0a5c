"""Epochs: which of two computers with copies of one journal is the box (docs/standby.md, "How it works").

Each takeover begins a segment with a higher epoch, and an entry says so. A box that hears of a higher epoch than its
own writes an entry, too, and is superseded from then on.
"""

import contextlib
import os
from typing import Dict, NamedTuple

from roah_rsbb.journal import records
from roah_rsbb.journal.contents import BoxEpoch, open_journal, standing_after, superseded_value, takeover_value
from roah_rsbb.journal.log import HEAD_BYTES, NewerFormat, NotASegment, frames, names_in, read_head
from roah_rsbb.journal.records import Batch, Kind, NewEntry
from roah_rsbb.journal.store import Writer

# Entries that no core wrote. A core's restart finds the end of the previous core by its session.
NO_SESSION, NO_MONO = 0, 0.0


class _Seen(NamedTuple):
    """What was read of a journal."""

    salt: int  # of its newest segment
    at: int  # bytes from the beginning of that segment
    standing: BoxEpoch


_seen: Dict[str, _Seen] = {}  # by path: it is read once a second, and mostly unchanged


def standing_in(path: str) -> BoxEpoch:
    """Read what a journal says; the first epoch if it cannot be read."""
    with contextlib.suppress(OSError, NotASegment, NewerFormat, ValueError, IndexError):
        name = names_in(path)[-1]
        seen = _seen.get(path)
        if seen is None or seen.salt != name.salt or seen.at > os.path.getsize(os.path.join(path, str(name))):
            seen = _Seen(name.salt, HEAD_BYTES, open_journal(path).contents.standing)
        with open(os.path.join(path, str(name)), "rb") as file:
            read_head(file.read(HEAD_BYTES))
            file.seek(seen.at)
            content = file.read()
        standing, at = seen.standing, 0
        for frame in frames(content, name.salt, 0):
            at = frame.end
            if not frame.is_summary and records.EPOCHS in records.top_of(frame.payload).letters:
                for entry in records.line_of(frame.payload, records.EPOCHS):
                    standing = standing_after(standing, entry[-1])
        _seen[path] = _Seen(name.salt, seen.at + at, standing)
        return standing
    return BoxEpoch()


def raise_epoch(path: str, utc: float, who: str, above: int = 0) -> BoxEpoch:
    """Raise the epoch of a journal that no core uses, and to more than `above`. It is on the disk when this returns.
    Raises OSError or `NewerFormat`."""
    writer = _writer(path)
    with contextlib.closing(writer.log):
        epoch = max(writer.contents.standing.next_epoch, above + 1)
        _add(writer, utc, who, takeover_value(epoch, writer.log.last))
        writer.log.begin(epoch)
        writer.log.finish()
    return writer.contents.standing


def hand_over(path: str, utc: float, by: str) -> BoxEpoch:
    """Note in a journal that no core uses that the standby, at the address `by`, has a copy of all of it and raises the
    epoch. It is on the disk when this returns. Raises OSError or `NewerFormat`."""
    writer = _writer(path)
    with contextlib.closing(writer.log):
        _add(writer, utc, by, superseded_value(writer.contents.standing.next_epoch, writer.log.last, by))
        writer.log.begin()
        writer.log.finish()
    return writer.contents.standing


def _writer(path: str) -> Writer:
    return Writer(path, open_journal(path))


def _add(writer: Writer, utc: float, who: str, value: Dict[str, object]) -> None:
    writer.add(Batch(entries=[NewEntry(utc, NO_MONO, "", "", None, who, Kind.EPOCH, value)]), NO_SESSION)
