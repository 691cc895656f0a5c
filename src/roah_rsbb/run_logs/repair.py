"""Run logs that a process left open when it was killed: which they are, and how they become whole bags."""

import contextlib
import fcntl
import os
from typing import Iterator, List

from roah_rsbb.run_logs.bag_file import DRAFT, WRITE_ERRORS, write_whole
from roah_rsbb.run_logs.names import is_log_name
from roah_rsbb.run_logs.salvage import is_closed


def unclosed(log_dir: str) -> Iterator[str]:
    """Paths of the run logs in a directory that nobody closed, and that nobody writes. Drafts of nobody are removed:
    what they are made of is there."""
    for name in _names(log_dir):
        path = os.path.join(log_dir, name)
        with contextlib.suppress(OSError):
            if name.endswith(DRAFT):
                if is_log_name(name[:-len(DRAFT)]) and _is_left(path):
                    os.remove(path)
            elif is_log_name(name) and _is_left(path) and not _has_index(path):
                yield path


def _names(log_dir: str) -> List[str]:
    try:
        return sorted(os.listdir(log_dir))
    except OSError:
        return []


def _has_index(path: str) -> bool:
    with open(path, "rb") as file:
        return is_closed(file)


def _is_left(path: str) -> bool:
    """Whether it is a file that no process has locked."""
    if not os.path.isfile(path):
        return False
    with open(path, "rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        except OSError:
            pass  # a file system without locks
    return True


def mend(path: str) -> str:
    """Index a run log again that nobody closed; returns what the referee should know, with the remedy; empty: nothing.

    The work is done on a copy. What cannot be read is kept.
    """
    try:
        _, kept = write_whole(path, ())
    except WRITE_ERRORS as error:
        return (f"The run log {path} was not closed, and could not be indexed again: {error}. It is as it was: "
                "once that is mended, try 'rosbag reindex'")
    if kept:
        return (f"The run log {path} is damaged. What could be read of it is there; all of it is kept as {kept}, "
                "where 'rosbag reindex' may find more")
    return ""
