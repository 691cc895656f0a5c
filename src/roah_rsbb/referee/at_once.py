"""`referee stop ZONE` and `referee stop all` before the rest of the program is imported, which takes a busy computer
seconds. What is imported here is little, and must stay so.

A STOP leaves through the door of a box whose file is on this computer. The rest of the program then reports how far it
came (`stopping.py`). What fails here is left to it: it sends the STOP in its own way, until the core answers.
"""

import binascii
import contextlib
import enum
import json
import os
import socket
import struct
import time
import urllib.parse
from typing import Any, BinaryIO, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, TypeVar

from roah_rsbb.client.places import DoorPlace, DoorPlaces, NotFound

T = TypeVar("T")

ROLE = "referee"  # of the person at the terminal; also the face of the connection
STOP = "stop"  # the command, and the call
# The words for all zones: a person under stress types them in their own language.
ALL, ALL_OPTION = ("all", "alle"), "--all"
# Within this time the box has answered, or the rest of the program sends the STOP.
LIMIT_S = 1.0
# The limit of every other call: a busy computer may take seconds.
ANSWER_S = 6.0

_TEXT_AND_FINAL, _MASKED = 0x81, 0x80
# No file, no box, a box that is slow, ends, or is of another version.
_TROUBLE = (NotFound, OSError, ValueError, LookupError, TypeError, struct.error)


class Exit(enum.IntEnum):
    """Exit statuses. `referee --help` lists them, and scripts rely on them."""

    OK = 0
    REFUSED = 1
    USAGE = 2
    NO_CORE = 3
    NOT_COMPLETED = 4
    INTERRUPTED = 130


class NoCore(Exception):
    """The ROS master or the core is missing or does not answer. The text names the remedy."""


class EarlyStop(NamedTuple):
    """A STOP that was sent."""

    sent_s: float  # monotonic
    first: Dict[str, Any]  # the box's first message, with its whole document
    answers: Dict[str, Dict[str, Any]]  # its messages with the answers, by zone


def caller_name(program: str) -> str:
    """Return a name for the records that no other process has."""
    name = f"{program}_{socket.gethostname()}_{os.getpid()}_{int(time.time() * 1000)}"
    return "/" + "".join(letter if letter.isalnum() and letter.isascii() else "_" for letter in name)


def meant(word: str, things: Sequence[T], name: Callable[[T], str], fits: Callable[[str, str], bool]) -> List[T]:
    """Return the things whose name is `word`, or else those whose name fits it. Case does not matter."""
    exact = [thing for thing in things if name(thing) == word]
    if exact:
        return exact
    low = word.casefold()
    same = [thing for thing in things if name(thing).casefold() == low]
    return same or [thing for thing in things if low and fits(name(thing).casefold(), low)]


def is_all(word: str, names: Sequence[str] = ()) -> bool:
    """Whether a word means all zones. A zone that is really named "all" comes first; '--all' always means all."""
    low = word.casefold()
    return low == ALL_OPTION or (low in ALL and low not in [name.casefold() for name in names])


def send_stop(words: Sequence[str], without_ros: bool) -> Optional[EarlyStop]:
    """Send the STOP of a command line, and return the answers. None: nothing is known of it, or these words are no
    plain STOP of a zone that there is. `without_ros`: see `DoorPlaces`."""
    plain = [word for word in words if word not in ("--json", "--utc") and ":=" not in word]
    if len(plain) != 2 or plain[0] != STOP or (plain[1].startswith("-") and plain[1] != ALL_OPTION):
        return None
    try:
        place = DoorPlaces(without_ros=without_ros).near()
        return None if place is None else _sent(plain[1], place)
    except _TROUBLE:
        return None


def _sent(word: str, place: DoorPlace) -> Optional[EarlyStop]:
    deadline_s = time.monotonic() + LIMIT_S
    url = urllib.parse.urlsplit(place.url)
    with socket.create_connection((url.hostname or "", url.port or 0), LIMIT_S) as door, door.makefile("rb") as stream:
        door.sendall("\r\n".join((
            f"GET {url.path}?face={ROLE} HTTP/1.1", f"Host: {url.netloc}", "Upgrade: websocket", "Connection: Upgrade",
            f"Sec-WebSocket-Key: {binascii.b2a_base64(os.urandom(16)).decode().strip()}", "Sec-WebSocket-Version: 13",
            f"Authorization: Bearer {place.token}", "", "")).encode())
        if b" 101 " not in stream.readline():
            return None
        while stream.readline().strip():
            pass
        messages = _messages(stream, deadline_s)
        first = next(messages)
        names = first["whole"]["box"]["zones"]
        zones = names if is_all(word, names) else meant(word, names, str, str.startswith)
        if zones is not names and len(zones) != 1:
            return None
        sent_s, node = time.monotonic(), caller_name(ROLE)
        for number, zone in enumerate(zones):
            door.sendall(_frame(json.dumps(
                {"id": number, "call": STOP, "zone": zone, "run": "", "node": node, "by": ""})))
        answers: Dict[str, Dict[str, Any]] = {}
        with contextlib.suppress(*_TROUBLE):
            while len(answers) < len(zones):
                message = next(messages)
                if "id" in message:
                    answers[zones[message["id"]]] = message
        return EarlyStop(sent_s, first, answers)


def _messages(stream: BinaryIO, deadline_s: float) -> Iterator[Dict[str, Any]]:
    """Return the messages of a door: frames of a WebSocket (RFC 6455, 5.2), whole and in text. Raises OSError."""
    while time.monotonic() < deadline_s:
        kind, length = struct.unpack("!BB", stream.read(2))
        if length >= 126:
            length, = struct.unpack("!H" if length == 126 else "!Q", stream.read(2 if length == 126 else 8))
        content = stream.read(length)
        if kind == _TEXT_AND_FINAL:
            yield json.loads(content)
    raise OSError("the box is slow")


def _frame(text: str) -> bytes:
    """Return the frame of a message of a client, whose mask is zeros."""
    data = text.encode()
    length = bytes([_MASKED | len(data)]) if len(data) < 126 else struct.pack("!BH", _MASKED | 126, len(data))
    return bytes([_TEXT_AND_FINAL]) + length + bytes(4) + data
