"""Damage to a file as disks and memory cause it: changed bits, lost sectors, a lost end."""

import random

# Bytes that a disk loses at once.
SECTORS = (512, 4096)


def damaged(content: bytes, chance: random.Random) -> bytes:
    """Return the content with one to three changed bits, or with lost sectors, or without its end."""
    found, kind = bytearray(content), chance.random()
    if kind < 0.5:
        for _ in range(chance.choice((1, 1, 2, 3))):
            found[chance.randrange(len(found))] ^= 1 << chance.randrange(8)
    elif kind < 0.95:
        size = chance.choice(SECTORS)
        for _ in range(chance.choice((1, 1, 2, 5))):
            at = chance.randrange(-(-len(found) // size)) * size
            end = min(at + size, len(found))
            found[at:end] = chance.choice((bytes(end - at), b"\xff" * (end - at), chance.randbytes(end - at)
                                           if hasattr(chance, "randbytes") else bytes(end - at)))
    else:
        del found[chance.randrange(len(found)):]
    return bytes(found)
