"""Pairing of box and standby. No I/O.

Theory of operation. A command on the box shows a code (`codes.py`), which the organiser gives to the standby. Each end
proves to the other one that it has the code. The proofs include the fingerprint of the box's certificate as each end
sees it, so nobody in the middle can pass them on. Then the box gives the standby a key of its own, and the standby
remembers the fingerprint.

Whoever pretends to be the box learns a proof, from which a code could be guessed offline. The code has 39 bits, a guess
takes tens of milliseconds, and the code is used once, so this takes centuries of computing time.
"""

import hashlib
import hmac
from typing import NamedTuple

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


def is_same(first: str, second: str) -> bool:
    """Compare secrets, in a time that does not depend on them."""
    return hmac.compare_digest(first.encode("utf-8", "replace"), second.encode("utf-8", "replace"))


def hashed(key: str) -> str:
    """Return what the box keeps of a key."""
    return hashlib.sha256(key.encode("utf-8", "replace")).hexdigest()
