"""The code with which a standby is paired: a file in log_dir of the box, which only the box's user can read.

`standby code` writes it, and the program that copies the journal reads it. It is in no log, topic or parameter, because
other users of the computer can read those. A code is valid for some minutes, for one standby, and for a few guesses.
"""

import contextlib
import json
import os
import secrets
import time
from typing import Callable

from roah_rsbb.ground import durable
from roah_rsbb.ground.arguments import typed
from roah_rsbb.standby.pairing import BOX, STANDBY, Exchange, is_same
from roah_rsbb.standby.partners import FOLDER

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
