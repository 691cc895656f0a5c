"""Documents with numbers, and the messages with which readers get them (docs/web.md, "Live data"). No I/O, no clock.

Each document has a number, which grows by one with each change. A reader who gets a document compares its number with
the one before and so notices changes that it missed. A document is always complete.
"""

import json
import logging
import uuid
from typing import Any, Callable, Dict, NamedTuple, Optional, Sequence, Set, Tuple

from roah_rsbb.box_clock import BoxClock

# A document's name first, then what distinguishes documents of this name, such as the language of the texts.
Key = Tuple[str, ...]
# Messages that were made at one moment. Readers of the same documents share them.
Made = Dict[Tuple[Any, ...], str]


_log = logging.getLogger("rosout")  # of the node
_reported: Set[str] = set()
MAX_REPORTED = 100


def report_once(what: str, error: Exception) -> None:
    """Log a fault that must not end what feeds the other readers. Each distinct one is logged once."""
    text = f"{what} ({type(error).__name__}: {error})"
    if text not in _reported and len(_reported) < MAX_REPORTED:
        _reported.add(text)
        _log.error("%s. STOP and all other readers continue. Please report it", text, exc_info=error)


class Document(NamedTuple):
    """A document."""

    number: int
    text: str  # JSON


EMPTY = Document(0, "null")


class Numbered:
    """Documents by key, made from what the core publishes."""

    # When the core is no longer heard. A repeated message may be the latched one of a core that hangs.
    SILENT_S: float

    def __init__(self, session: str = "") -> None:
        self.session = session or uuid.uuid4().hex  # of this process: numbers begin again with each
        self.changes = 0  # of all documents
        self._documents: Dict[Key, Document] = {}
        self._pieces: Dict[Key, str] = {}  # parts of messages
        self._heard_mono = float("-inf")
        self._clock = BoxClock()

    def is_heard(self, mono: float) -> bool:
        """Whether the core publishes."""
        return mono - self._heard_mono <= self.SILENT_S

    def clock(self, mono: float) -> Optional[float]:
        """Return the box's clock in UTC seconds, or None before its first message."""
        return round(self._clock.now(mono), 3) or None

    def document(self, key: Key) -> Document:
        """Return a document; before the core is heard it is empty."""
        return self._documents.get(key, EMPTY)

    def message(self, kind: str, keys: Sequence[Key], mono: float, made: Made) -> str:
        """Return a message with these documents."""
        return self._once(made, kind, keys, mono, lambda: ",".join(map(self.piece, keys)), "documents")

    def beat(self, keys: Sequence[Key], mono: float, made: Made) -> str:
        """Return the message that repeats the clock, and the numbers of these documents."""
        return self._once(made, "clock", keys, mono, lambda: ",".join(
            f'"{key[0]}":{self.document(key).number}' for key in keys), "numbers")

    def _once(self, made: Made, kind: str, keys: Sequence[Key], mono: float, content: Callable[[], str],
              name: str) -> str:
        """Return a message, and make it if it is not among those that were made."""
        what = (self, kind, *keys)
        text = made.get(what)
        if text is None:
            text = made[what] = (f'{{"type":"{kind}","session":"{self.session}",{self._now(mono)},'
                                 f'"{name}":{{{content()}}}}}')
        return text

    def piece(self, key: Key) -> str:
        """Return a document as a part of a message."""
        piece = self._pieces.get(key)
        if piece is None:
            document = self.document(key)
            piece = self._pieces[key] = f'"{key[0]}":{{"number":{document.number},"data":{document.text}}}'
        return piece

    def _now(self, mono: float) -> str:
        return f'"clock":{json.dumps(self.clock(mono))},"heard":{json.dumps(self.is_heard(mono))}'

    def _drop(self, key: Key) -> None:
        """Forget a document that nobody reads any more."""
        self._documents.pop(key, None)
        self._pieces.pop(key, None)

    def _make_one(self, key: Key, make: Callable[[], Any]) -> bool:
        """Make a document; returns whether that succeeded. Otherwise it is null until the next update, and no other
        document misses anything."""
        try:
            self._put(key, make())
            return True
        except Exception as error:  # whatever a message or a translation does
            report_once(f"Document {' '.join(key)} of the web pages cannot be made", error)
            self._put(key, None)
            return False

    def _put(self, key: Key, data: Any) -> None:
        text = json.dumps(data, ensure_ascii=False, separators=(",", ":"))
        before = self.document(key)
        if text != before.text:
            self._documents[key] = Document(before.number + 1, text)
            self.changes += 1
            self._pieces.pop(key, None)
