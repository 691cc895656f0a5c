"""Limits the texts and lists in a request. Processing a huge text would delay all zones."""

from typing import Any

import genpy

# Characters of a text, and entries of a list. The longest valid note has 500 characters, the longest list a few dozen
# entries.
MAX_TEXT = 5000
MAX_LIST = 1000


def too_long(message: genpy.Message, at_most: int = MAX_TEXT) -> str:
    """Describe the first text or list in a message that is too long, as an error message does; "": all are accepted."""
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
