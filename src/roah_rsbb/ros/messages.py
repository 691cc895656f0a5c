"""Messages of ROS: the reasons of a refusal in the error text of a service call, limits of requests, and times.

A failed service call carries one text. One reason is that text. Several reasons are a JSON list of texts, because
a reason may contain any punctuation: prose cannot be split into reasons again.
"""

import ast
import json
import re
from typing import Any, List, Optional, Sequence

import genpy
import rospy

from roah_rsbb.protocol import WireTime, wire_ns

# rospy passes on the server's text as the repr of its bytes, after words of its own.
_ERROR = re.compile(r"responded with an error: (.*)$", re.DOTALL)
_PREFIXES = ("error processing request: ", "service cannot process request: ")
# Characters of a text, and entries of a list. The longest valid note has 500 characters, the longest list a few dozen
# entries.
MAX_TEXT = 5000
MAX_LIST = 1000
# The largest ROS time and ROS duration, seconds.
_MAX_TIME = 2**32 - 1
_MAX_DURATION = 2**31 - 1


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


def ros_time(utc: float) -> rospy.Time:
    """Return a UTC time in seconds as a ROS time, limited to its range."""
    return rospy.Time.from_sec(min(max(utc, 0.0), _MAX_TIME))


def ros_wire_time(wire_time: WireTime) -> rospy.Time:
    """Return a wire time as a ROS time, exactly, limited to its range."""
    nanoseconds = min(max(wire_ns(wire_time), 0), _MAX_TIME * 1_000_000_000)
    return rospy.Time(*divmod(nanoseconds, 1_000_000_000))


def ros_duration(seconds: float) -> rospy.Duration:
    """Return a duration in seconds as a ROS duration, limited to its range."""
    return rospy.Duration.from_sec(min(max(seconds, -_MAX_DURATION), _MAX_DURATION))
