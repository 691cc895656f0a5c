"""Why a service call failed, out of what rospy makes of it."""

import ast
import re
from typing import List

# rospy hands the server's text on as the repr of its bytes, behind words of its own.
_ERROR = re.compile(r"responded with an error: (.*)$", re.DOTALL)
_PREFIXES = ("error processing request: ", "service cannot process request: ")


def reason(raised: str) -> str:
    """The server's own text in the text of a ServiceException; the whole text if there is none in it."""
    match = _ERROR.search(raised)
    if match is None:
        return raised
    text = match.group(1)
    if text.startswith(("b'", 'b"')):
        try:
            text = ast.literal_eval(text).decode("utf-8", errors="replace")
        except (SyntaxError, ValueError):
            return text
    for prefix in _PREFIXES:
        if text.startswith(prefix):
            return text[len(prefix):]
    return text


def reasons(raised: str) -> List[str]:
    """The same, one for one: the core joins its reasons with semicolons (`roah_rsbb.core.referee`)."""
    return reason(raised).split("; ")


def was_answered(raised: str) -> bool:
    """Whether the service answered at all; False: it is not there, or the way to it is broken."""
    return _ERROR.search(raised) is not None
