"""Following a text of which only the end is published."""

from typing import Optional

# A shorter overlap could be a coincidence.
MIN_OVERLAP = 80


def added(old: str, new: str) -> Optional[str]:
    """What came behind `old` in `new`, when `new` may have lost its beginning; None: it is another text."""
    if new.startswith(old):
        return new[len(old):]
    # The longest end of `old` that `new` begins with: look where the first line of `new` stood in `old`.
    first = new[:MIN_OVERLAP]
    if len(first) < MIN_OVERLAP:
        return None
    at = old.find(first)
    while at >= 0:
        if new.startswith(old[at:]):
            return new[len(old) - at:]
        at = old.find(first, at + 1)
    return None
