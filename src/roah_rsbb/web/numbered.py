"""Documents with numbers, and the messages with which readers get them (docs/web.md, "Live data"). No I/O, no clock.

Each document has a number, which grows by one with each change. A reader who gets a document compares its number with
the one before and so notices changes that it missed. A document is always complete.
"""

import json
import logging
import uuid
from typing import (
    Any,
    Callable,
    Dict,
    List,
    NamedTuple,
    Optional,
    Protocol,
    Sequence,
    Set,
    Tuple,
)

from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document

# A document's name first, then what distinguishes documents of this name, such as the language of the texts.
Key = Tuple[str, ...]
# Messages that were made at one moment. Readers of the same documents share them.
Made = Dict[Tuple[Any, ...], str]


_log = logging.getLogger(__name__)
_reported: Set[str] = set()
MAX_REPORTED = 100


def report_once(what: str, error: Exception) -> None:
    """Log a fault that must not end what feeds the other readers. Each distinct one is logged once."""
    text = f"{what} ({type(error).__name__}: {error})"
    if text not in _reported and len(_reported) < MAX_REPORTED:
        _reported.add(text)
        _log.error("%s. STOP and all other readers continue. Please report it", text, exc_info=error)


class NumberedDocument(NamedTuple):
    """A document."""

    number: int
    text: str  # JSON


EMPTY = NumberedDocument(0, "null")


class BoxShown(Protocol):
    """The box that is shown: a `client.Client`."""

    @property
    def why(self) -> str:
        """Why there is no connection to it; empty: there is one."""

    @property
    def document(self) -> Optional[Document]:
        """The document; None: none has come yet."""

    @property
    def is_old(self) -> bool:
        """Whether the document may no longer be true."""

    def now(self) -> Now:
        """Return the box's clocks."""


class Numbered:
    """Documents by key, made from the document of a box."""

    def __init__(self, box: BoxShown, session: str = "") -> None:
        self.box = box
        self.session = session or uuid.uuid4().hex  # of this process: numbers begin again with each
        self.changes = 0  # of all documents
        self._documents: Dict[Key, NumberedDocument] = {}
        self._pieces: Dict[Key, str] = {}  # parts of messages
        self._made_of: Dict[Key, Any] = {}

    @property
    def is_heard(self) -> bool:
        """Whether the box is heard. Without a connection no command would reach it, even if it was heard just now; and
        one that another box has superseded knows no run any more."""
        document, box = self.box.document, self.box
        return document is not None and not box.is_old and not box.why and not document.box.superseded_by

    def clock(self) -> Optional[float]:
        """Return the box's clock in UTC seconds, or None before it was heard."""
        return round(self.box.now().utc, 3) or None

    def document(self, key: Key) -> NumberedDocument:
        """Return a document; before the core is heard it is empty."""
        return self._documents.get(key, EMPTY)

    def message(self, kind: str, keys: Sequence[Key], made: Made) -> str:
        """Return a message with these documents."""
        return self._once(made, kind, keys, lambda: ",".join(map(self.piece, keys)), "documents")

    def beat(self, keys: Sequence[Key], made: Made) -> str:
        """Return the message that repeats the clock, and the numbers of these documents."""
        return self._once(made, "clock", keys, lambda: ",".join(
            f'"{key[0]}":{self.document(key).number}' for key in keys), "numbers")

    def _once(self, made: Made, kind: str, keys: Sequence[Key], content: Callable[[], str], name: str) -> str:
        """Return a message, and make it if it is not among those that were made."""
        what = (self, kind, *keys)
        text = made.get(what)
        if text is None:
            text = made[what] = (f'{{"type":"{kind}","session":"{self.session}",{self._now()},'
                                 f'"{name}":{{{content()}}}}}')
        return text

    def piece(self, key: Key) -> str:
        """Return a document as a part of a message."""
        piece = self._pieces.get(key)
        if piece is None:
            document = self.document(key)
            piece = self._pieces[key] = f'"{key[0]}":{{"number":{document.number},"data":{document.text}}}'
        return piece

    def _now(self) -> str:
        return f'"clock":{json.dumps(self.clock())},"heard":{json.dumps(self.is_heard)}'

    def _drop(self, key: Key) -> None:
        """Forget a document that nobody reads any more."""
        self._documents.pop(key, None)
        self._pieces.pop(key, None)

    def _renew(self, key: Key, parts: Any, make: Callable[[], Any]) -> None:
        """Make a document if the parts of which it is made are others. Equal parts usually are the same objects."""
        if (key not in self._made_of or self._made_of[key] != parts) and self._make_one(key, make):
            self._made_of[key] = parts

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
            self._documents[key] = NumberedDocument(before.number + 1, text)
            self.changes += 1
            self._pieces.pop(key, None)


class Viewer:
    """A reader of some documents. Ask `next` for a message only when the one before is sent."""

    def __init__(self, store: Numbered, keys: List[Key]) -> None:
        self._store = store
        self._keys = keys
        self._sent: Optional[Dict[Key, int]] = None  # the number of each document; None: nothing was sent
        self._beat_is_due = False

    def beat(self) -> None:
        """The reader is to be sent the clock."""
        self._beat_is_due = True

    def next(self, made: Optional[Made] = None) -> Optional[str]:
        """Return the next message; None: nothing is to be sent. `made`: what other readers were sent at this moment."""
        made = {} if made is None else made
        numbers = {key: self._store.document(key).number for key in self._keys}
        if self._sent is None:
            self._sent = numbers
            return self._store.message("snapshot", self._keys, made)
        if self._sent != numbers:
            changed = [key for key in self._keys if self._sent[key] != numbers[key]]
            self._sent = numbers
            return self._store.message("change", changed, made)
        if self._beat_is_due:
            self._beat_is_due = False
            return self._store.beat(self._keys, made)
        return None
