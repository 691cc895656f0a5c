"""Reasons of a refusal, carried through the error text of a ROS service call.

A failed service call carries one text. One reason is that text. Several reasons are a JSON list of texts, because
a reason may contain any punctuation: prose cannot be split into reasons again.
"""

import ast
import json
import re
from typing import List, Optional, Sequence

# rospy passes on the server's text as the repr of its bytes, after words of its own.
_ERROR = re.compile(r"responded with an error: (.*)$", re.DOTALL)
_PREFIXES = ("error processing request: ", "service cannot process request: ")


def error_text(reasons: Sequence[str]) -> str:
    """The error text of a service call that is refused for these reasons."""
    if len(reasons) == 1 and _list_in(reasons[0]) is None:
        return reasons[0]
    return json.dumps(list(reasons), ensure_ascii=False)


def reasons(raised: str) -> List[str]:
    """The reasons in the text of a ServiceException; the whole text if the service did not answer."""
    text = _server_text(raised)
    found = _list_in(text)
    return [text] if found is None else found


def reason(raised: str) -> str:
    """All reasons in the text of a ServiceException, as one text to show."""
    return "; ".join(reasons(raised))


def was_answered(raised: str) -> bool:
    """Whether the service answered. Otherwise it is missing or cannot be reached."""
    return _ERROR.search(raised) is not None


def _server_text(raised: str) -> str:
    match = _ERROR.search(raised)
    if match is None:
        return raised
    text = match.group(1)
    if text.startswith(("b'", 'b"')):
        try:
            text = ast.literal_eval(text).decode("utf-8", errors="replace")
        except (SyntaxError, ValueError):
            return text
    return _without_prefix(text)


def _without_prefix(text: str) -> str:
    for prefix in _PREFIXES:
        if text.startswith(prefix):
            return text[len(prefix):]
    return text


def _list_in(text: str) -> Optional[List[str]]:
    """The list of texts that `text` encodes as JSON; None: it does not encode one."""
    try:
        found = json.loads(text)
    except ValueError:
        return None
    is_list = isinstance(found, list) and all(isinstance(item, str) for item in found)
    return found if is_list else None
