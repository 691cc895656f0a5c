"""Pairing: who may give commands by a browser, and how a device gets that right (docs/web.md, "Pairing").

An organiser's page or a terminal shows a code. The device that sends it first gets a session: a random token, which it
keeps in a cookie. Only a hash of the token is kept here, so nobody who reads the file of the sessions can use one. No
I/O and no clock.
"""

import hashlib
import secrets
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Tuple

from roah_rsbb.ground.kept_file import Save, SavedBeside
from roah_rsbb.model.actions import ROLES
from roah_rsbb.web.limits import Rates
from roah_rsbb.wording import device, sheets
from roah_rsbb.wording.language import tr

CODE_VALID_S = 120.0
# Letters and digits that cannot be mistaken for each other. A code has 39 bits, the link that begins with it 118.
SIGNS = "ABCDEFGHJKMNPQRSTUVWXYZ23456789"
CODE_LENGTH, LINK_LENGTH = 8, 24
MAX_CODES = 20

# Guesses of an address. All addresses together have no limit: with one, some computers could keep all referees from
# pairing. A gateway answers some 1000 requests a second. Of a code that is valid for two minutes, they are a share of
# 1 in 7 million.
GUESSES_AT_ONCE, GUESSES_A_SECOND = 10.0, 0.1

TOKEN_BYTES = 32
# Longer than a competition.
SESSION_VALID_S = 14 * 24 * 3600.0
MAX_SESSIONS = 200
FILE = "web_sessions.json"
MAX_NAME = 40


class NotPaired(Exception):
    """A device is not paired. The text is for its user."""


class TooManyGuesses(NotPaired):
    """There were too many guesses of codes."""


class Grant(NamedTuple):
    """What a device may do."""

    role: str
    zone: str  # empty: all zones

    def allows(self, zone: str) -> bool:
        """Whether the device may act in a zone."""
        return self.zone in ("", zone)


class DeviceSession(NamedTuple):
    """A paired device."""

    id: str
    grant: Grant
    person: str
    device: str
    paired_utc: float
    seen_utc: float = 0.0  # 0: never
    marked_utc: float = 0.0  # when its last mark came; 0: none since the start of the gateway
    is_encrypted: bool = False  # whether it is valid on encrypted pages, and on no others

    @property
    def device_id(self) -> str:
        """The device in the records: no other one has the same."""
        return f"{self.device} {self.id}"

    @property
    def who(self) -> str:
        """Who acts, for the records: person, role and device."""
        return sheets.author(self.person, self.grant.role, self.device_id)


class Guesses:
    """Limits the guesses of codes of each address."""

    def __init__(self, message: str) -> None:
        """`message`: what somebody reads who guesses too often."""
        self._message = message
        self._of_address = Rates(GUESSES_A_SECOND, GUESSES_AT_ONCE)

    def check(self, mono: float, address: str) -> None:
        """Count a guess; raises `TooManyGuesses`."""
        if not self._of_address.allows(mono, address):
            raise TooManyGuesses(tr(self._message))

    def was_right(self, address: str) -> None:
        """Do not count the last guess: many devices may be paired at once, behind one address."""
        self._of_address.give_back(address)


class NewCode(NamedTuple):
    """A code for one device, to type, and in the link of the QR code."""

    typed: str
    link: str  # the code, and more that nobody guesses


class Codes:
    """The codes that can be used now. They are kept in memory only.

    Guesses of typed codes are limited. The link is not: a whole hall may share the address of somebody who guesses.
    """

    def __init__(self) -> None:
        self._codes: Dict[Tuple[str, str], Tuple[Grant, float]] = {}  # by hashes of code and link, oldest first
        self._guesses = Guesses(device.TOO_MANY_GUESSES)

    def make(self, mono: float, grant: Grant) -> NewCode:
        """Return a new code. If there are too many, the oldest one becomes invalid."""
        self._forget_old(mono)
        while len(self._codes) >= MAX_CODES:
            del self._codes[next(iter(self._codes))]
        signs = "".join(secrets.choice(SIGNS) for _ in range(LINK_LENGTH))
        self._codes[_hash(signs[:CODE_LENGTH]), _hash(signs)] = (grant, mono + CODE_VALID_S)
        typed = f"{signs[:4]}-{signs[4:CODE_LENGTH]}"
        return NewCode(typed, f"{typed}-{signs[CODE_LENGTH:]}")

    def granted(self, mono: float, given: str, address: str) -> Grant:
        """Return what a code or a link gives, and do not use it up. Raises `NotPaired`, and `TooManyGuesses` of typed
        codes."""
        self._forget_old(mono)
        is_typed = len(signs_of(given)) <= CODE_LENGTH
        if is_typed:
            self._guesses.check(mono, address)
        found = self._find(given)
        if found is None:
            raise NotPaired(tr(device.WRONG_CODE))
        if is_typed:
            self._guesses.was_right(address)
        return self._codes[found][0]

    def use_up(self, given: str) -> Callable[[], None]:
        """The code, and its link, are for one device. Returns what lets it be used again."""
        found = self._find(given)
        if found is None:
            return lambda: None
        code = self._codes.pop(found)
        return lambda: self._codes.update({found: code})

    def _find(self, given: str) -> Optional[Tuple[str, str]]:
        hashed = _hash(signs_of(given))
        return next((hashes for hashes in self._codes if hashed in hashes), None)

    def _forget_old(self, mono: float) -> None:
        self._codes = {code: (grant, until) for code, (grant, until) in self._codes.items() if mono < until}


class Sessions:
    """The paired devices."""

    def __init__(self, save: Save, saved: Iterable[Dict[str, Any]] = ()) -> None:
        """`save` keeps the sessions and raises OSError; `saved`: what it kept before."""
        self.kept = SavedBeside(save)
        """Changes count at once. Wait for it before you answer."""
        self._sessions: Dict[str, DeviceSession] = {}  # by hash of the token, oldest first
        for record in saved:
            hashed, session = _session_of(record)
            self._sessions[hashed] = session

    def listed(self, utc: float) -> List[DeviceSession]:
        """Return all sessions, oldest first."""
        self._forget_old(utc)
        return list(self._sessions.values())

    def add(self, utc: float, grant: Grant, person: str, name: str, is_encrypted: bool = False,
            before: Optional[DeviceSession] = None) -> str:
        """Pair a device of that name; returns its token. `before`: its session until now. Raises `NotPaired`.

        The sheet of a judge is that of a name, so a name is for one device.
        """
        self._forget_old(utc)
        person = plain(person)
        if len(self._sessions) >= MAX_SESSIONS:
            raise NotPaired(tr(device.TOO_MANY_DEVICES))
        if not person:
            raise NotPaired(tr(device.NO_NAME))
        for other in self._sessions.values():
            if (other.person.casefold() == person.casefold() and other.is_encrypted == is_encrypted
                    and (before is None or other.id != before.id)):
                raise NotPaired(tr(device.NAME_IN_USE, name=person, device=other.device_id))
        token = secrets.token_urlsafe(TOKEN_BYTES)
        hashed = _hash_of(token, is_encrypted)
        self._sessions[hashed] = DeviceSession(
            secrets.token_hex(4), grant, person, plain(name) or "browser", utc, is_encrypted=is_encrypted)
        self._write()
        return token

    def of(self, utc: float, token: str, is_encrypted: bool = False) -> Optional[DeviceSession]:
        """Return the session of a token, and note that its device was seen; None: it has none.

        Others may know a token that was given without encryption, so it has no session on encrypted pages.
        """
        hashed = _hash_of(token, is_encrypted)
        session = self._sessions.get(hashed)
        if session is None or _is_old(session, utc):
            return None
        session = self._sessions[hashed] = session._replace(seen_utc=utc)
        return session

    def marked(self, utc: float, session_id: str) -> None:
        """Note that a mark of a device came."""
        self._sessions = {hashed: one._replace(marked_utc=utc) if one.id == session_id else one
                          for hashed, one in self._sessions.items()}

    def revoke(self, session_id: str) -> List[DeviceSession]:
        """End the pairing of a device; empty: of all. Returns which were ended. If that cannot be saved, they are valid
        again after a restart."""
        ended = {hashed: one for hashed, one in self._sessions.items() if session_id in ("", one.id)}
        for hashed in ended:
            del self._sessions[hashed]
        if ended:
            self._write()
        return list(ended.values())

    def _forget_old(self, utc: float) -> None:
        self._sessions = {hashed: one for hashed, one in self._sessions.items() if not _is_old(one, utc)}

    def _write(self) -> None:
        self.kept.keep([
            {"token_sha256": hashed, "id": one.id, "role": one.grant.role, "zone": one.grant.zone,
             "person": one.person, "device": one.device, "paired_utc": one.paired_utc, "seen_utc": one.seen_utc,
             "is_encrypted": one.is_encrypted}
            for hashed, one in self._sessions.items()
        ])


def plain(text: str, most: int = MAX_NAME) -> str:
    """Return a name that fits in a line: printable, and not too long."""
    return " ".join("".join(sign if sign.isprintable() else " " for sign in text).split())[:most].rstrip()


def signs_of(typed: str) -> str:
    """Return the signs of a code as somebody typed it."""
    return "".join(sign for sign in typed.upper() if sign.isalnum())


def _is_old(session: DeviceSession, utc: float) -> bool:
    return utc - session.paired_utc > SESSION_VALID_S


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "replace")).hexdigest()


def _hash_of(token: str, is_encrypted: bool) -> str:
    return _hash(f"https {token}" if is_encrypted else token)


def _session_of(record: Dict[str, Any]) -> "tuple[str, DeviceSession]":
    """Read a saved session; raises KeyError, TypeError or ValueError."""
    role, zone = str(record["role"]), str(record["zone"])
    if role not in ROLES or len(record["token_sha256"]) != 64:
        raise ValueError(record)
    return record["token_sha256"], DeviceSession(
        str(record["id"]), Grant(role, zone), str(record["person"]), str(record["device"]),
        float(record["paired_utc"]), float(record["seen_utc"]), record.get("is_encrypted") is True)


INSTALL = "sudo apt install python3-qrcode"  # pip installs it with the box
# Light modules around the code, which readers need.
_BORDER = 2


def modules_of(text: str) -> Optional[List[List[bool]]]:
    """Return the rows of a text's QR code with its border. True: a dark module. None: the library is not installed."""
    try:
        import qrcode
    except ImportError:
        return None
    code = qrcode.QRCode(border=_BORDER, error_correction=qrcode.constants.ERROR_CORRECT_M)
    code.add_data(text)
    code.make(fit=True)
    return code.get_matrix()


def lines_of(text: str) -> List[str]:
    """Return a text's QR code for a terminal: light on dark, two rows of modules in a line. Empty: no library."""
    rows = modules_of(text)
    if rows is None:
        return []
    if len(rows) % 2:
        rows = [*rows, [False] * len(rows[0])]
    blocks = {(False, False): "█", (False, True): "▀", (True, False): "▄", (True, True): " "}
    return ["".join(blocks[pair] for pair in zip(upper, lower)) for upper, lower in zip(rows[::2], rows[1::2])]
