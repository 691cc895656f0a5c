"""Words of a pair as datagrams, which only the two ends can make."""

import hashlib
import hmac
import json
from typing import Mapping, Optional, Tuple

from roah_rsbb.standby.pair import Side, Word

MAX_BYTES = 1024
_MAX_NUMBER = 1 << 53


def pair_name(secret: str) -> str:
    """Return the name of the pair with this secret. It may be known to everyone."""
    return _mac(secret, b"name")[:16]


def seal(secret: str, word: Word) -> bytes:
    """Return a word as a datagram."""
    body = json.dumps([word.side.value, word.epoch, word.claims, word.asks, word.cut]).encode("ascii")
    return b" ".join((pair_name(secret).encode("ascii"), _mac(secret, b"word" + body).encode("ascii"), body))


def unseal(secrets: Mapping[str, str], datagram: bytes) -> Optional[Tuple[str, Word]]:
    """Return the name of the pair and the word; None if none of the pairs said it. `secrets`: by the pairs' names."""
    try:
        name, mac, body = datagram[:MAX_BYTES].split(b" ", 2)
        secret = secrets[name.decode("ascii")]
        if not hmac.compare_digest(_mac(secret, b"word" + body).encode("ascii"), mac):
            return None
        side, epoch, claims, asks, cut = json.loads(body.decode("ascii"))
        if not (0 < int(epoch) < _MAX_NUMBER and 0 <= int(cut) < _MAX_NUMBER):
            return None
        return name.decode("ascii"), Word(Side(side), int(epoch), bool(claims), bool(asks), int(cut))
    except (ValueError, KeyError, TypeError):
        return None


def rejoin_key(secret: str) -> str:
    """Return the key with which the box before a takeover is the standby of its successor."""
    return _mac(secret, b"key of the next pair")


def rejoin_proof(secret: str, nonce: bytes, fingerprint: bytes) -> str:
    """Return the proof that a successor has this certificate."""
    return _mac(secret, b"certificate" + nonce + fingerprint)


def _mac(secret: str, data: bytes) -> str:
    return hmac.new(secret.encode("ascii", "replace"), data, hashlib.sha256).hexdigest()
