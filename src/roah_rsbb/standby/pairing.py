"""Pairing of box and standby: the proofs, the code, and the files that say who belongs together.

Theory of operation. A command on the box shows a code, which the organiser gives to the standby. Each end
proves to the other one that it has the code. The proofs include the fingerprint of the box's certificate as each end
sees it, so nobody in the middle can pass them on. Then the box gives the standby a key of its own, and the standby
remembers the fingerprint.

Whoever pretends to be the box learns a proof, from which a code could be guessed offline. The code has 39 bits, a guess
takes tens of milliseconds, and the code is used once, so this takes centuries of computing time.
"""

import contextlib
import hashlib
import hmac
import json
import os
import secrets
import time
from typing import Callable, Dict, NamedTuple, Optional

from roah_rsbb.ground import durable
from roah_rsbb.ground.arguments import typed
from roah_rsbb.standby.pair import Side, hashed, is_same, pair_name

# -- proofs -------------------------------------------------------------------------------------------

NONCE_BYTES = KEY_BYTES = 32
BOX, STANDBY = b"box", b"standby"


class Exchange(NamedTuple):
    """What both ends know of one attempt to pair."""

    fingerprint: bytes  # of the box's certificate
    nonce_of_standby: bytes
    nonce_of_box: bytes

    def proof(self, code: str, who: bytes) -> str:
        """Return the proof that `who` has the code."""
        salt = b"".join((self.fingerprint, self.nonce_of_standby, self.nonce_of_box))
        key = hashlib.scrypt(plain_code(code).encode("utf-8"), salt=salt, n=2**14, r=8, p=1)
        return hmac.new(key, who, hashlib.sha256).hexdigest()


def plain_code(typed: str) -> str:
    """Return a code without what does not count."""
    return "".join(sign for sign in typed.upper() if sign.isalnum())


# -- the files that say who belongs together ----------------------------------------------------------

# `standby/paired.json` in the log_dir of a box names its standby. `box.json` in the folder of a standby names its box.
# The folder of a standby that took over has both: it is the log_dir of the present box.

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


# -- the code -----------------------------------------------------------------------------------------

# `standby code` writes it, and the program that copies the journal reads it. It is in no log, topic or parameter,
# because other users of the computer can read those. A code is valid for some minutes, for one standby, and for a few
# guesses.

CODE_FILE = "code.json"
VALID_S = 600.0
# A code is not valid any more after so many wrong proofs.
MAX_GUESSES = 5
# Letters and digits that cannot be mistaken for each other.
_SIGNS = "ABCDEFGHJKMNPQRSTUVWXYZ23456789"
_CODE_LENGTH = 8


def command(log_dir: str) -> str:
    """Return the command that makes a code."""
    return f"{typed('standby')} code --log-dir {log_dir}"


def make_code(log_dir: str, now: Callable[[], float] = time.time) -> str:
    """Make a code for the box that runs with this log_dir. An earlier one is not valid any more. Raises OSError."""
    code = "".join(secrets.choice(_SIGNS) for _ in range(_CODE_LENGTH))
    code = f"{code[:4]}-{code[4:]}"
    durable.write_file(_path(log_dir), json.dumps({"code": code, "utc": now()}).encode("ascii"))
    return code


class PairingCode:
    """The code as the box's end sees it. Call all methods in one thread at a time."""

    def __init__(self, log_dir: str, now: Callable[[], float] = time.time) -> None:
        """`now`: UTC seconds."""
        self._path, self._now = _path(log_dir), now
        self._code = self._over = ""  # the code that is being guessed, and the one that was used up
        self._guesses = 0

    def take(self, exchange: Exchange, proof: str) -> str:
        """Check a standby's proof, and use the code up. Return the box's proof, or empty: it was wrong, or there is no
        code."""
        code = self.valid()
        if not code:
            return ""
        if code != self._code:
            self._code, self._guesses = code, 0
        if is_same(exchange.proof(code, STANDBY), proof):
            self._use_up()
            return exchange.proof(code, BOX)
        self._guesses += 1
        if self._guesses >= MAX_GUESSES:
            self._use_up()
        return ""

    def valid(self) -> str:
        """Return the code that is valid now; empty: none."""
        try:
            with open(self._path, encoding="ascii") as file:
                found = json.load(file)
            code, age = str(found["code"]), self._now() - float(found["utc"])
        except (OSError, ValueError, KeyError, TypeError):
            return ""
        return code if 0 <= age < VALID_S and code != self._over else ""

    def _use_up(self) -> None:
        self._over = self._code
        with contextlib.suppress(OSError):
            os.unlink(self._path)


def _path(log_dir: str) -> str:
    return os.path.join(log_dir, FOLDER, CODE_FILE)
