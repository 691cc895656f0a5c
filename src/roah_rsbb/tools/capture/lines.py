"""An entry as a line of text or of JSON. Times are UTC."""

import json
import math
import time
from typing import Any, Dict, Optional

from roah_rsbb.comm.complaints import likely_cause
from roah_rsbb.tools.capture.decoding import BOX, TABLET, Entry, Kind
from roah_rsbb.tools.capture.fields import fields_of
from roah_rsbb.tools.capture.records import LAST_SECOND

_DIM, _RED, _GREEN, _YELLOW, _MAGENTA, _CYAN = "2", "31", "32", "33", "35", "36"
_NS = 1_000_000_000
_WIDEST_COLUMN = 40
_HIGHLIGHTED = {"benchmark_state", "robot_state"}


class TextLines:
    """Entries as lines for people: time, channel, address, who speaks, what.

    Addresses and names have columns, which grow with what comes, up to a width that leaves room for the rest.
    """

    def __init__(self, color: bool = False) -> None:
        self._color = color
        self._widths = {"sender": len("255.255.255.255"), "speaker": len("TestingTeam/TestingRobot")}

    def line(self, entry: Entry) -> str:
        """The next line."""
        datagram = entry.datagram
        channel = str(datagram.dport) if entry.private else "public"
        sender = f"{datagram.src}:{datagram.sport}" if datagram.sport != datagram.dport else datagram.src
        speaker = _plain(str(entry.speaker)) if entry.speaker else "unknown"
        return " ".join([
            self._paint(_clock(datagram.time), _DIM), f"{channel:<6}", self._column("sender", sender),
            self._column("speaker", speaker), self._what(entry),
        ])

    def _what(self, entry: Entry) -> str:
        if entry.kind is Kind.ERROR:
            return self._paint(f"ERROR {_plain(entry.text)}. {likely_cause(entry.reason)}", _RED)
        if entry.kind is Kind.ENCRYPTED:
            return self._paint(f"encrypted, {_plain(entry.text)}", _YELLOW)
        code = {BOX: _CYAN, TABLET: _MAGENTA}.get(entry.speaker, _GREEN)
        shown = [self._paint(entry.message.DESCRIPTOR.name, code)]
        for key, value in fields_of(entry.message).items():
            text = _text(value)
            shown.append(f"{key}={self._paint(text, code) if key in _HIGHLIGHTED else text}")
        skew = skew_s(entry)
        if skew is not None:
            shown.append(f"skew={skew:+.3f}s")
        return " ".join(shown)

    def _column(self, name: str, text: str) -> str:
        self._widths[name] = width = max(self._widths[name], min(len(text), _WIDEST_COLUMN))
        return text.ljust(width)

    def _paint(self, text: str, code: str) -> str:
        return f"\x1b[{code}m{text}\x1b[0m" if self._color else text


def json_line(entry: Entry) -> str:
    """All that is known of an entry as one JSON object; absent keys are not known or do not apply."""
    datagram = entry.datagram
    known: Dict[str, Any] = {
        "time": round(datagram.time, 6),
        "channel": "private" if entry.private else "public",
        "src": datagram.src, "sport": datagram.sport, "dst": datagram.dst, "dport": datagram.dport,
        "size": len(datagram.data),
        "kind": entry.kind.value,
    }
    if entry.speaker is not None:
        known["speaker"] = str(entry.speaker)
    if entry.team:
        known["team"] = entry.team
    if entry.kind is Kind.MESSAGE:
        known["message"] = entry.message.DESCRIPTOR.name
        known["fields"] = _strict(fields_of(entry.message))
        skew = skew_s(entry)
        if skew is not None:
            known["skew_s"] = round(skew, 6)
    else:
        known["text"] = entry.text
        if entry.reason is not None:
            known["reason"] = entry.reason.value
            known["likely_cause"] = likely_cause(entry.reason)
    return json.dumps(known)


def skew_s(entry: Entry) -> Optional[float]:
    """The robot's clock minus that of who listened, in seconds, in a message of a robot that says its time."""
    if entry.kind is not Kind.MESSAGE or "time" not in entry.message.DESCRIPTOR.fields_by_name:
        return None
    sent = entry.message.time
    # The seconds apart, because a float of their size cannot hold nanoseconds.
    seconds = math.floor(entry.datagram.time)
    return sent.sec - seconds + sent.nsec / _NS - (entry.datagram.time - seconds)


def _text(value: Any) -> str:
    """A field's value in one line, in which nothing can be mistaken for the end of it."""
    if isinstance(value, str):
        return value if value.isidentifier() else _plain(json.dumps(value, ensure_ascii=False))
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return "[" + ", ".join(map(_text, value)) + "]"
    if not isinstance(value, dict):
        return str(value)
    if set(value) == {"sec", "nsec"}:
        return _wire_time(value["sec"], value["nsec"])
    if set(value) == {"team_name", "robot_name", "rsbb_port"}:
        return f"{_text(value['team_name'])}/{_text(value['robot_name'])}:{value['rsbb_port']}"
    return "{" + ", ".join(f"{key}={_text(inner)}" for key, inner in value.items()) + "}"


def _wire_time(sec: int, nsec: int) -> str:
    """A time of day to the microsecond; a time that cannot be one as it is."""
    if (sec, nsec) == (0, 0):
        return "never"
    if 0 <= sec <= LAST_SECOND and 0 <= nsec < _NS:
        return time.strftime("%H:%M:%S", time.gmtime(sec)) + f".{nsec // 1000:06}"
    return f"{sec}s+{nsec}ns"


def _clock(utc: float) -> str:
    milliseconds = math.floor(utc * 1000)
    return time.strftime("%H:%M:%S", time.gmtime(milliseconds // 1000)) + f".{milliseconds % 1000:03}"


def _plain(text: str) -> str:
    """A text from the network without what would command a terminal."""
    return "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in text)


def _strict(value: Any) -> Any:
    """The value without numbers that JSON has no word for."""
    if isinstance(value, dict):
        return {key: _strict(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_strict(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value
