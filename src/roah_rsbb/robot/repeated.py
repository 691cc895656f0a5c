"""The sender of repeated strings (docs/protocol.md, "Repeated strings").

The rules of the link: a string is put into every message until the box acknowledges a message that
contained it. The box logs a text when a message contains it and the message that it received before
did not; so a text that is to be logged a second time must first be absent from a message *that the box
has received*. It is not enough that such a message was sent.

Messages are known here by their number: 1, 2, 3 ... in the order of sending, each newer than the one
before in the box's eyes. The box ignores a message that comes after a newer one, so an acknowledgement
of number n says that the box has seen n, and from now on sees only later ones. Therefore:

- a string first sent in message f stays in all messages until some n >= f is acknowledged: every
  message from f on contained it, so n did;
- then it is left out, for the first time in message g; the same text may come back once some n >= g
  is acknowledged: every message from g on was without it, so n was.

Strings enter in the order of `add`, whatever their field: a text that must wait for its twin holds
back those behind it, for a round trip, and so the order is kept.
"""

from collections import deque
from typing import Deque, Dict, List, Sequence, Tuple

from roah_rsbb.robot.machine import IllegalEvent

# Field and text of a string.
_Key = Tuple[str, str]

# Bytes that a string takes in a message beside its text: tag (up to 2) and length (up to 2).
_OVERHEAD_BYTES = 4


class RepeatedStrings:
    """The strings of one private channel, of all its string fields."""

    def __init__(self, fields: Sequence[str], budget_bytes: int, max_waiting: int = 1000) -> None:
        """`budget_bytes`: what all strings of a message may take together; `max_waiting`: strings."""
        self._fields = tuple(fields)
        self._budget_bytes = budget_bytes
        self._max_waiting = max_waiting
        self._last = 0  # number of the last message
        self._waiting: Deque[_Key] = deque()
        self._sent: Dict[_Key, int] = {}  # -> first message with it
        self._left_out: Dict[_Key, int] = {}  # -> first message without it, until that is acknowledged

    @property
    def pending(self) -> int:
        """How many strings the box has not acknowledged yet."""
        return len(self._waiting) + len(self._sent)

    @property
    def waiting(self) -> int:
        """How many strings no message has carried yet."""
        return len(self._waiting)

    def add(self, field: str, text: str) -> None:
        """Queue `text`, to be logged once more than it was so far.

        Raises `IllegalEvent` for a text that no message can carry, and when too many wait.
        """
        if field not in self._fields:
            raise IllegalEvent(f"there is no string field {field!r}: choose from {', '.join(self._fields)}")
        size = encoded_size(text)
        if size + _OVERHEAD_BYTES > self._budget_bytes:
            raise IllegalEvent(
                f"this string for {field} has {size} bytes in UTF-8: "
                f"at most {self._budget_bytes - _OVERHEAD_BYTES} fit into a message"
            )
        if len(self._waiting) >= self._max_waiting:
            raise IllegalEvent(
                f"{self._max_waiting} strings wait for the box to acknowledge those before: "
                "send fewer, or see why the box does not hear this robot"
            )
        self._waiting.append((field, text))

    def for_message(self, number: int) -> Dict[str, List[str]]:
        """The strings of message `number`, by field, in order. Call once for each message sent."""
        self._last = number
        used = sum(map(_size, self._sent))
        while self._waiting:
            key = self._waiting[0]
            used += _size(key)
            if key in self._sent or key in self._left_out or used > self._budget_bytes:
                break
            self._sent[self._waiting.popleft()] = number
        content: Dict[str, List[str]] = {}
        for field, text in self._sent:
            content.setdefault(field, []).append(text)
        return content

    def acknowledged(self, number: int) -> bool:
        """The box has seen message `number`. True when another message brings waiting strings on."""
        absent = [key for key, without in self._left_out.items() if without <= number]
        for key in absent:
            del self._left_out[key]
        arrived = [key for key, first in self._sent.items() if first <= number]
        for key in arrived:
            del self._sent[key]
            self._left_out[key] = self._last + 1
        return bool(self._waiting) and bool(absent or arrived)


def encoded_size(text: str) -> int:
    """The bytes of `text` in UTF-8; `IllegalEvent` when it is no text that UTF-8 can hold."""
    try:
        return len(text.encode("utf-8"))
    except UnicodeEncodeError as error:
        raise IllegalEvent(f"{text!r} is no valid Unicode text: {error.reason}") from None


def _size(key: _Key) -> int:
    return _OVERHEAD_BYTES + encoded_size(key[1])
