"""Makes values from bytes, so that every input is a message. Each additional byte adds a detail."""

import struct
from typing import List, Sequence, Tuple, TypeVar

T = TypeVar("T")

# Lengths of texts are one byte; the last two mean more than any honest sender would send.
_LONG, _LONGEST = 254, 255
LONG_TEXT, LONGEST_TEXT = 3000, 60_000
# A message on a private channel has no more fields.
MANY_TEXTS = 390
_DOUBLES = (0.0, -1.0, float("nan"), float("inf"), float("-inf"), 1e308, 5e-324, 1.5)
_INTEGERS = (0, 1, -1, 2**31, 2**32 - 1, 2**32, 2**63 - 1, -(2**63), 999_999_999, 10**9)


class Reader:
    """Reads values from the front of an input; from its end on everything is 0 and empty."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0
        self._had_many = False

    def __bool__(self) -> bool:
        return self._at < len(self._data)

    def take(self, count: int) -> bytes:
        """Return this many bytes, or all that are left."""
        taken = self._data[self._at:self._at + count]
        self._at += len(taken)
        return taken

    def rest(self) -> bytes:
        """All that is left."""
        return self.take(len(self._data))

    def byte(self) -> int:
        return int.from_bytes(self.take(1), "big")

    def flag(self) -> bool:
        return bool(self.byte() & 1)

    def choice(self, choices: Sequence[T]) -> T:
        return choices[self.byte() % len(choices)]

    def integer(self, signed: bool = True, size: int = 8) -> int:
        """Return a small number, a large one, or one at the limit of a range."""
        kind = self.byte()
        if kind < 128:
            return kind
        at_edge = kind < 192
        number = _INTEGERS[kind % len(_INTEGERS)] if at_edge else int.from_bytes(self.take(size), "big", signed=True)
        if not signed:
            number = abs(number)
        most = 2**(size * 8 - signed) - 1
        return min(max(number, -most - 1 if signed else 0), most)

    def double(self) -> float:
        kind = self.byte()
        if kind < 128:
            return (kind - 64) / 8
        if kind < 192:
            return _DOUBLES[kind % len(_DOUBLES)]
        return struct.unpack(">d", self.take(8).ljust(8, b"\0"))[0]

    def text(self) -> str:
        """Any characters that UTF-8 has."""
        length = self.byte()
        if length >= _LONG:
            piece = self.take(4).decode("utf-8", "ignore") or "x"
            return piece * ((LONGEST_TEXT if length == _LONGEST else LONG_TEXT) // len(piece.encode()))
        return self.take(length).decode("utf-8", "ignore")

    def texts(self) -> Tuple[str, ...]:
        """A few texts, or very many."""
        count = self.byte()
        if count == _LONGEST and not self._had_many:
            self._had_many = True
            piece = self.text()[:50]
            return tuple(f"{piece}{number}" for number in range(MANY_TEXTS))
        return tuple(self.text() for _ in range(count % 5))

    def new_message(self) -> None:
        """Very many texts fit into a message once."""
        self._had_many = False

    def list_of(self, item, most: int = 4) -> List:
        """Return a few values that `item()` reads."""
        return [item() for _ in range(self.byte() % (most + 1))]
