"""The files that say to which pairs a computer belongs, and where the other ends are.

`standby/paired.json` in the log_dir of a box names its standby. `box.json` in the folder of a standby names its box.
The folder of a standby that took over has both: it is the log_dir of the present box.
"""

import contextlib
import json
import os
from typing import Dict, NamedTuple, Optional

from roah_rsbb.ground import durable
from roah_rsbb.standby.pair import Side
from roah_rsbb.standby.pairing import hashed
from roah_rsbb.standby.words import pair_name

FOLDER, PAIRED, BOX_FILE = "standby", "paired.json", "box.json"


class PairedBox(NamedTuple):
    """The box of a standby."""

    host: str
    port: int
    fingerprint: str  # of its certificate
    key: str


class PairedStandby(NamedTuple):
    """The standby of a box."""

    name: str
    key_sha256: str
    host: str = ""  # where it was connected from last; empty: never
    port: int = 0  # the box's standby_port, which the standby also uses when it is the box
    is_awaited: bool = False  # it is the box before this one, and was not connected since the takeover
    paired_utc: float = 0.0
    replaced: str = ""  # name and address of the standby that it replaced; empty: none

    @property
    def described(self) -> str:
        """Name and address."""
        return f"{self.name} at {self.host}" if self.host else self.name


class Partner(NamedTuple):
    """The other end of a pair."""

    own_side: Side
    secret: str
    host: str  # empty: unknown
    port: int


def read_box(folder: str) -> Optional[PairedBox]:
    """Return the box with which a standby is paired; None: none."""
    try:
        with open(os.path.join(folder, BOX_FILE), encoding="utf-8") as file:
            found = json.load(file)
        return PairedBox(str(found["host"]), int(found["port"]), str(found["fingerprint"]), str(found["key"]))
    except (OSError, ValueError, KeyError, TypeError):
        return None


def write_box(folder: str, box: PairedBox) -> None:
    """Save the box with which a standby is paired. Raises OSError."""
    os.makedirs(folder, mode=0o700, exist_ok=True)
    durable.write_file(os.path.join(folder, BOX_FILE), json.dumps(box._asdict()).encode("ascii"))


def read_standby(log_dir: str) -> Optional[PairedStandby]:
    """Return the standby with which a box is paired; None: none."""
    try:
        with open(os.path.join(log_dir, FOLDER, PAIRED), encoding="utf-8") as file:
            found = json.load(file)
        return PairedStandby(str(found["name"]), str(found["key_sha256"]), str(found.get("host", "")),
                             int(found.get("port", 0)), bool(found.get("is_awaited", False)),
                             float(found.get("paired_utc", 0.0)), str(found.get("replaced", "")))
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def write_standby(log_dir: str, standby: PairedStandby) -> None:
    """Save the standby with which a box is paired. Raises OSError."""
    folder = os.path.join(log_dir, FOLDER)
    os.makedirs(folder, mode=0o700, exist_ok=True)
    durable.write_file(os.path.join(folder, PAIRED), json.dumps(standby._asdict()).encode("ascii"))


def forget_standby(log_dir: str) -> None:
    """Have no standby from now on. Raises OSError."""
    with contextlib.suppress(FileNotFoundError):
        os.remove(os.path.join(log_dir, FOLDER, PAIRED))


def set_aside_damaged_box(folder: str) -> bool:
    """Rename a file of the box that cannot be read: with it, a core would wait for a takeover for ever. Returns whether
    there was one. Raises OSError."""
    path = os.path.join(folder, BOX_FILE)
    if read_box(folder) is not None or not os.path.exists(path):
        return False
    os.replace(path, f"{path}.damaged")
    return True


def is_standby(log_dir: str) -> bool:
    """Whether this folder belongs to a standby that has not taken over."""
    return os.path.exists(os.path.join(log_dir, BOX_FILE)) and not os.path.exists(os.path.join(log_dir, FOLDER, PAIRED))


def partners_of(log_dir: str) -> Dict[str, Partner]:
    """Return the other ends of the pairs of a computer, by the names of the pairs."""
    found = []
    standby, box = read_standby(log_dir), read_box(log_dir)
    if standby is not None and standby.key_sha256:
        found.append(Partner(Side.BOX, standby.key_sha256, standby.host, standby.port))
    if box is not None:
        found.append(Partner(Side.STANDBY, hashed(box.key), box.host, box.port))
    return {pair_name(partner.secret): partner for partner in found}
