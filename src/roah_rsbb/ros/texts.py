"""Limits what a request may hold before anything is done with it: one huge text would hold up all zones."""

from typing import Any

import genpy

# Characters of a text, and entries of a list. A note has at most 500, a list of a few dozen entries is the longest.
MAX_TEXT = 5000
MAX_LIST = 1000


def too_long(message: genpy.Message, at_most: int = MAX_TEXT) -> str:
    """What in a message is too long, as an error says it; "": nothing is."""
    for field in message.__slots__:
        problem = _problem(field, getattr(message, field), at_most)
        if problem:
            return problem
    return ""


def _problem(field: str, value: Any, at_most: int) -> str:
    if isinstance(value, str) and len(value) > at_most:
        return f"{field} has {len(value)} characters: at most {at_most} are accepted"
    if isinstance(value, genpy.Message):
        return too_long(value, at_most)
    if isinstance(value, (list, tuple)):
        if len(value) > MAX_LIST:
            return f"{field} has {len(value)} entries: at most {MAX_LIST} are accepted"
        return next((problem for problem in (_problem(field, entry, at_most) for entry in value) if problem), "")
    return ""
