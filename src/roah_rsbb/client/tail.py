"""Finds what was added to a text of which only the end is published."""

from typing import Optional

# A shorter overlap could be a coincidence.
MIN_OVERLAP = 80


def added(old: str, new: str) -> Optional[str]:
    """Return the text that `new` adds to `old`. `new` may lack the beginning of `old`. None: `new` does not
    continue `old`."""
    if new.startswith(old):
        return new[len(old):]
    # Find the longest end of `old` with which `new` begins: search `old` for the start of `new`.
    first = new[:MIN_OVERLAP]
    if len(first) < MIN_OVERLAP:
        return None
    at = old.find(first)
    while at >= 0:
        if new.startswith(old[at:]):
            return new[len(old) - at:]
        at = old.find(first, at + 1)
    return None
