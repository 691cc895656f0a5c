"""Remembers the ciphertexts of a whole competition, so that recorded datagrams are not accepted again.

A sender encrypts each datagram with a new random initialisation vector, so only a copy has a known ciphertext: the
network duplicated it, or somebody recorded it and sends it again. The protocol itself cannot distinguish a copy
(docs/protocol.md, "Frame").

This is a Bloom filter. It never forgets one of the last `bits // BITS_PER_ENTRY` ciphertexts. It mistakes about one in
2,000 new ones for a copy, and that datagram counts as lost. Two filters take turns, so that neither fills up.
"""

from typing import List

# Bits for each ciphertext in a full filter, which then mistakes one in 2,000 new ciphertexts for a copy.
BITS_PER_ENTRY = 24
_PROBES = 4


class Seen:
    """A set of ciphertexts of bounded size."""

    def __init__(self, bits: int = 2**26) -> None:
        """`bits`: size of each of the two filters, a power of two. Memory is used only as they fill."""
        self._bits = bits
        self._capacity = bits // BITS_PER_ENTRY
        self._count = 0
        self._filter = bytearray(bits // 8)
        self._before = bytearray()  # the previous, full filter; empty: none yet

    def add(self, ciphertext: bytes) -> None:
        """Remember a ciphertext."""
        if self._count >= self._capacity:
            self._before, self._filter = self._filter, bytearray(self._bits // 8)
            self._count = 0
        for position in self._positions(ciphertext):
            self._filter[position >> 3] |= 1 << (position & 7)
        self._count += 1

    def __contains__(self, ciphertext: bytes) -> bool:
        positions = self._positions(ciphertext)
        return _has(self._filter, positions) or (bool(self._before) and _has(self._before, positions))

    def _positions(self, ciphertext: bytes) -> List[int]:
        # Python's hash of bytes has a secret of this process: nobody can choose ciphertexts that collide.
        number = hash(ciphertext)
        first, step = number & 0xFFFFFFFF, (number >> 32) | 1
        return [(first + i * step) % self._bits for i in range(_PROBES)]


def _has(bits: bytearray, positions: List[int]) -> bool:
    return all(bits[position >> 3] >> (position & 7) & 1 for position in positions)
