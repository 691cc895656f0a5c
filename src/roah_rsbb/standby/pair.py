"""Box and standby as a pair: which of them is the box. No I/O and no clock.

Theory of operation. The journal has an epoch, which each takeover raises. Both ends of a pair say *words*: which end
they are, their epoch, and whether they claim to be the box. A box repeats its word every `SAY_S` seconds. Words are
true for ever: a box that took over stays the successor of the one before, so a late, doubled or repeated word does no
harm.

A box is superseded when its partner claims to be the box with a higher rank. The rank is the epoch; of two equal ones,
the standby's end has the higher rank. So of two boxes that hear each other, exactly one stops. A superseded box never
begins again by itself.

A box that starts asks its partners first, and sends nothing to robots until each has answered, or for `ASK_S` seconds.
So does a box that was not running for a while (`AWAY_S`), because it was stopped, for example. It asks for
`ASK_AGAIN_S`: a partner that does not answer may be starting as the box.
"""

import enum
import hashlib
import hmac
import json
from typing import Dict, List, Mapping, NamedTuple, Optional, Set, Tuple

# Period of a box's words. Three can be lost in the second in which two boxes may be active.
SAY_S = 0.25
# A box that starts waits this long for its partners.
ASK_S = 0.5
# A box that was not running for so long is not the box any more until it has asked. A standby takes over after 2 s at
# the earliest.
AWAY_S = 1.5
ASK_AGAIN_S = 2.0


class Side(enum.Enum):
    """The ends of a pair, as they were when they were paired."""

    BOX = "box"
    STANDBY = "standby"


class Word(NamedTuple):
    """What an end of a pair says."""

    side: Side  # of the end that says it
    epoch: int
    claims: bool  # that it is the box
    asks: bool = False  # for an answer
    cut: int = 0  # number of the last entry that it has of the journal of the box before it

    @property
    def rank(self) -> "tuple[int, bool]":
        """The higher one is the box."""
        return self.epoch, self.side is Side.STANDBY


class State(enum.Enum):
    """Of a computer that is, or was, the box."""

    ASKING = "asking"  # silent, until the partners have answered
    ACTIVE = "active"
    SUPERSEDED = "superseded"  # silent, for good


class SupersededBy(NamedTuple):
    """By which word the box was superseded."""

    pair: str
    word: Word


class Claim:
    """The claim of one computer to be the box, against the other ends of all pairs to which it belongs."""

    def __init__(self, epoch: int, cut: int, sides: Mapping[str, Side], is_superseded: bool = False) -> None:
        """`sides`: this computer's side of each pair, by the pair's name."""
        self.epoch = epoch
        self.state = State.SUPERSEDED if is_superseded else State.ASKING if sides else State.ACTIVE
        self.by: Optional[SupersededBy] = None
        self._cut = cut
        self._sides: Dict[str, Side] = dict(sides)
        self._unanswered: Set[str] = set(sides)
        self._asked: Optional[float] = None
        self._ask_s = ASK_S
        self._due: Optional[float] = None  # when the next words are; None: now

    def ask_again(self) -> None:
        """Be silent again until the partners have answered: this computer was not running for a while."""
        if self.state is not State.SUPERSEDED and self._sides:
            self.state, self._unanswered = State.ASKING, set(self._sides)
            self._asked = self._due = None
            self._ask_s = ASK_AGAIN_S

    def word(self, pair: str, asks: bool = False) -> Word:
        """What this computer says to the other end of a pair now."""
        return Word(self._sides[pair], self.epoch, self.state is not State.SUPERSEDED, asks, self._cut)

    def hear(self, pair: str, word: Word) -> Optional[Word]:
        """Take a word of the other end of a pair; returns the answer, if it asks for one."""
        if pair not in self._sides or word.side is self._sides[pair]:
            return None  # an echo of an own word
        self._unanswered.discard(pair)
        own = self.word(pair)
        if word.claims and own.claims and word.rank > own.rank:
            self.state, self.by = State.SUPERSEDED, SupersededBy(pair, word)
        elif self.state is State.ASKING and not self._unanswered:
            self.state = State.ACTIVE
        return self.word(pair) if word.asks else None

    def use(self, sides: Mapping[str, Side]) -> None:
        """Belong to these pairs from now on."""
        self._sides = dict(sides)
        self._unanswered &= set(sides)

    def tick(self, now: float) -> List["tuple[str, Word]"]:
        """Return the words that are to be said now, each with its pair. `now`: monotonic seconds."""
        if self._asked is None:
            self._asked = now
        if self.state is State.ASKING and now >= self._asked + self._ask_s:
            self.state = State.ACTIVE
        due = now if self._due is None else self._due
        if self.state is State.SUPERSEDED or now < due:
            return []
        # From when they were due, or a tick that comes a little early would make a gap of two periods.
        self._due = max(due, now - SAY_S) + SAY_S
        return [(pair, self.word(pair, asks=self.state is State.ASKING)) for pair in self._sides]


class BoxSilence:
    """How long the standby has not heard the box, in any way."""

    def __init__(self) -> None:
        self._heard: Optional[float] = None

    def hear(self, now: float) -> None:
        """The box was heard: its copy, its word or its beacon."""
        self._heard = now if self._heard is None else max(now, self._heard)

    def lasts(self, now: float, seconds: float) -> bool:
        """Whether the box has been silent for that long, after it was heard at least once."""
        return self._heard is not None and now - self._heard >= seconds


# -- words as datagrams, which only the two ends can make ---------------------------------------------

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


def is_same(first: str, second: str) -> bool:
    """Compare secrets, in a time that does not depend on them."""
    return hmac.compare_digest(first.encode("utf-8", "replace"), second.encode("utf-8", "replace"))


def hashed(key: str) -> str:
    """Return what the box keeps of a key."""
    return hashlib.sha256(key.encode("utf-8", "replace")).hexdigest()


def rejoin_key(secret: str) -> str:
    """Return the key with which the box before a takeover is the standby of its successor."""
    return _mac(secret, b"key of the next pair")


def rejoin_proof(secret: str, nonce: bytes, fingerprint: bytes) -> str:
    """Return the proof that a successor has this certificate."""
    return _mac(secret, b"certificate" + nonce + fingerprint)


def _mac(secret: str, data: bytes) -> str:
    return hmac.new(secret.encode("ascii", "replace"), data, hashlib.sha256).hexdigest()
