"""Remembers the ciphertexts of a whole competition, so that recorded datagrams are not accepted again.

A sender encrypts each datagram with a new random initialisation vector, so only a copy has a known ciphertext: the
network duplicated it, or somebody recorded it and sends it again. The protocol itself cannot distinguish a copy
(docs/protocol.md, "Frame").

This is a Bloom filter whose bits of one ciphertext are in one word, so that it touches little memory. It never forgets
one of the last `bits // BITS_PER_ENTRY` ciphertexts. It mistakes some new ones for a copy, at most about one in 1,000,
and that datagram counts as lost. Two filters take turns, so that neither fills up.
"""

import mmap
from typing import NamedTuple, Optional

# Bits for each ciphertext in a full filter, which then mistakes one in 2,000 new ciphertexts for a copy.
BITS_PER_ENTRY = 32


class FilterPlace(NamedTuple):
    """Where a ciphertext is in a filter."""

    word: int
    bits: int


class Seen:
    """A set of ciphertexts of bounded size."""

    def __init__(self, bits: int = 2**26) -> None:
        """`bits`: size of each of the two filters, a power of two. Memory is used only as they fill."""
        self._bits = bits
        self._capacity = bits // BITS_PER_ENTRY
        self._count = 0
        self._filter = _words(bits)
        self._before: Optional[memoryview] = None  # the previous, full filter

    def place(self, ciphertext: bytes) -> FilterPlace:
        """Return the place of a ciphertext, for the other methods: five bits of one word."""
        # Python's hash of bytes has a secret of this process: nobody can choose ciphertexts that collide.
        number = hash(ciphertext)
        return FilterPlace((number >> 30) % len(self._filter), (
            1 << (number & 63) | 1 << (number >> 6 & 63) | 1 << (number >> 12 & 63) | 1 << (number >> 18 & 63)
            | 1 << (number >> 24 & 63)))

    def add(self, place: FilterPlace) -> None:
        """Remember a ciphertext."""
        if self._count >= self._capacity:
            self._before, self._filter = self._filter, _words(self._bits)
            self._count = 0
        self._filter[place.word] |= place.bits
        self._count += 1

    def __contains__(self, place: FilterPlace) -> bool:
        word, bits = place
        return self._filter[word] & bits == bits or (self._before is not None and self._before[word] & bits == bits)


def _words(bits: int) -> memoryview:
    # The system gives each page of it when a bit there is set first. A bytearray would write all of them at once.
    return memoryview(mmap.mmap(-1, bits // 8)).cast("Q")
