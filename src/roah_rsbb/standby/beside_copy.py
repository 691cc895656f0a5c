"""What a standby needs for a takeover beside the copy of the journal: clocks, STOPs, benchmarking modules."""

import collections
import contextlib
import io
import json
import os
import pathlib
import shutil
import zipfile
from typing import Deque, Dict, Iterator, Mapping, NamedTuple, Optional, Tuple

from roah_rsbb.ground import durable
from roah_rsbb.ground.durable import write_file
from roah_rsbb.ground.linux import boot_id
from roah_rsbb.model.clock import Now

# -- how far the clocks are ahead ---------------------------------------------------------------------

# On another computer, the clocks of runs continue by its monotonic clock, if it was not started again since it heard
# the box: a step of its UTC must not end a run. Otherwise they continue by UTC. Without the Internet, the clocks of two
# computers can differ by seconds, which would be added to each run.

CLOCK_FILE = "clock.json"
# Messages of some seconds. The one that took the shortest time to arrive shows the difference best.
SAMPLES = 20
# Smaller changes are not written.
CHANGE_S = 0.05


class Ahead(NamedTuple):
    """By how many seconds the clocks of this computer are ahead of those of another one."""

    utc_s: float = 0.0
    mono_s: Optional[float] = None  # None: one of the two computers was started again since, or it was not measured


NOT_MEASURED = Ahead()


class ClockDifference:
    """The difference from the clocks of the box, in a file of the standby."""

    def __init__(self, folder: str, boot: str) -> None:
        """`boot`: identifies the start of the box's computer."""
        self._folder, self._boot = folder, boot
        self._utc: Deque[float] = collections.deque(maxlen=SAMPLES)
        self._mono: Deque[float] = collections.deque(maxlen=SAMPLES)
        self._written: Optional[Tuple[float, float]] = None

    def hear(self, sent: Now, came: Now) -> None:
        """Take the time at which the box sent a message, by its clocks, and the time at which it arrived. Never
        raises."""
        self._utc.append(came.utc - sent.utc)
        self._mono.append(came.mono - sent.mono)
        ahead = min(self._utc), min(self._mono)
        if self._written is None or any(abs(a - b) >= CHANGE_S for a, b in zip(ahead, self._written)):
            found = {"boot": self._boot, "ahead_s": ahead[0], "own_boot": boot_id(), "mono_ahead_s": ahead[1]}
            with contextlib.suppress(OSError):
                durable.write_file(os.path.join(self._folder, CLOCK_FILE), json.dumps(found).encode("ascii"))
                self._written = ahead


def ahead_of(folder: str, boot: str, own_boot: str) -> Ahead:
    """Return how far the clocks of this computer are ahead of those of another one, as far as it was measured.

    `boot` and `own_boot` identify the starts of the other computer and of this one.
    """
    try:
        with open(os.path.join(folder, CLOCK_FILE), encoding="ascii") as file:
            found = json.load(file)
        if not boot or found["boot"] != boot:
            return NOT_MEASURED
        mono_s = found.get("mono_ahead_s") if own_boot and found.get("own_boot") == own_boot else None
        return Ahead(float(found["ahead_s"]), None if mono_s is None else float(mono_s))
    except (OSError, ValueError, KeyError, TypeError):
        return NOT_MEASURED


# -- STOPs that the box has sent ----------------------------------------------------------------------

# They are kept in a file beside the copy. The box that takes over reads it before it sends anything. It ignores those
# that its journal has, and those that are empty: their runs were started again.

STOPS_FILE = "stops.json"
# The newest ones, and the characters of each: JSON has up to 6 for each character of who stopped, and why.
MOST, LONGEST = 100, 5000


def stops_in(found: object) -> Dict[str, str]:
    """Return the texts of STOPs by the identity of the run. One that is none does not keep out the others. Raises
    ValueError: these are no STOPs."""
    if not isinstance(found, dict):
        raise ValueError("no STOPs")
    return newest({identity: text for identity, text in found.items() if all(
        isinstance(each, str) and len(each) <= LONGEST for each in (identity, text))})


def newest(*stops: Mapping[str, str]) -> Dict[str, str]:
    """Return the newest of these STOPs, the oldest ones first; later arguments are newer."""
    found: Dict[str, str] = {}
    for each in stops:
        for identity, text in each.items():
            found.pop(identity, None)
            found[identity] = text
    return dict(list(found.items())[-MOST:])


def read_stops(folder: str) -> Dict[str, str]:
    """Return the texts of STOPs (`box/stops.py`) by the identity of the run; empty: none, or not readable."""
    try:
        with open(os.path.join(folder, STOPS_FILE), encoding="ascii") as file:
            return stops_in(json.load(file))
    except (OSError, ValueError, RecursionError):
        return {}


def add_stops(folder: str, stops: Mapping[str, str]) -> None:
    """Keep STOPs. They are on the disk when this returns. Raises OSError."""
    before = read_stops(folder)
    found = newest(before, stops)
    if found != before:
        durable.write_file(os.path.join(folder, STOPS_FILE), json.dumps(found).encode("ascii"))


# -- the folder of the benchmarking modules -----------------------------------------------------------

# They are read once a second, and the file is written again when they have changed. It is one of the files that are
# copied beside the journal.

# In all. A competition's rules and parameters have some ten kB; a folder with more is another one by mistake.
MAX_BYTES = 10_000_000
# The same content makes the same file.
_MOMENT = (1980, 1, 1, 0, 0, 0)
_NOT_COPIED = (".", "__pycache__")


class TooLarge(Exception):
    """The folder has more than `MAX_BYTES`. The text says what to do."""


class PackedModules:
    """The file of a folder. Call everything in one thread."""

    def __init__(self, folder: str, path: str) -> None:
        """`path`: of the file."""
        self._folder, self._path = pathlib.Path(folder), path
        self._packed: Tuple[object, ...] = ()  # what was packed last

    def look(self) -> None:
        """Write the file if something has changed. Raises OSError or `TooLarge`."""
        found = tuple(self._files())
        if found == self._packed and os.path.exists(self._path):
            return
        if sum(size for _, size, _ in found) > MAX_BYTES:
            raise TooLarge(f"{self._folder} has more than {MAX_BYTES // 1_000_000} MB, so the benchmarking modules are "
                           "not copied to the standby: leave only their rules and parameters there")
        written = io.BytesIO()
        with zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as file:
            for name, _, _ in found:
                file.writestr(zipfile.ZipInfo(name, _MOMENT), (self._folder / name).read_bytes())
        write_file(self._path, written.getvalue())
        self._packed = found

    def _files(self) -> Iterator[Tuple[str, int, int]]:
        """Yield the files in the folder and in those of zones: name, size, moment of the last change."""
        for path in sorted(self._folder.rglob("*")):
            name = path.relative_to(self._folder)
            if path.is_file() and not any(part.startswith(_NOT_COPIED) for part in name.parts):
                state = path.stat()
                yield name.as_posix(), state.st_size, state.st_mtime_ns


def unpack(path: str, folder: str) -> bool:
    """Make the folder again, in the place of an earlier one; returns whether there is such a file. Raises OSError, also
    for a file that is damaged."""
    if not os.path.exists(path):
        return False
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    try:
        with zipfile.ZipFile(path) as file:
            if sum(info.file_size for info in file.infolist()) > MAX_BYTES:
                raise OSError(f"{path} is too large")
            file.extractall(folder)  # names that lead out of the folder are kept in it
    except (zipfile.BadZipFile, EOFError, RuntimeError, NotImplementedError) as error:
        raise OSError(f"{path} is damaged ({error})") from None
    return True
