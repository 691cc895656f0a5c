"""Selects heard datagrams, and formats them as lines of text or JSON. Times are UTC."""

import json
import math
import time
from typing import Any, Dict, Optional

from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import Message

from roah_rsbb.capture.decoding import BOX, TABLET, DatagramKind, HeardDatagram, NewestEntries
from roah_rsbb.capture.recording import LAST_SECOND
from roah_rsbb.comm.complaints import likely_cause
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.wording.texts import escaped


def fields_of(message: Message) -> Dict[str, Any]:
    """The fields that a message contains: numbers, bools, texts, names of enum values, lists, and messages as dicts."""
    return {field.name: _field_value(field, value) for field, value in message.ListFields()}


def _field_value(field: FieldDescriptor, value: Any) -> Any:
    if hasattr(value, "extend"):  # repeated; its class depends on the version of protobuf
        return [_field_value(field, item) for item in value]
    if field.message_type is not None:
        return fields_of(value)
    if field.enum_type is not None:
        return field.enum_type.values_by_number[value].name
    return value


# -- filter -----------------------------------------------------------------------------------------

_TIMES = ("time", "acknowledgement")  # fields that differ in every message


class DatagramFilter:
    """Passes the datagrams that meet all conditions."""

    def __init__(self, team: Optional[str] = None, message: Optional[str] = None, errors_only: bool = False,
                 changes_only: bool = False) -> None:
        """`team`: only it, and beacons that list it. `message`: only this type. `changes_only`: no repetitions."""
        self._team = team
        self._message = message
        self._errors_only = errors_only
        self._changes_only = changes_only
        self._last = NewestEntries()  # contents by sender, port and type

    def passes(self, entry: HeardDatagram) -> bool:
        """Whether to show a datagram. Call it once for each one, in order."""
        if self._errors_only and entry.kind is not DatagramKind.ERROR:
            return False
        if self._message is not None and not self._is_message(entry):
            return False
        if self._team is not None and not self._is_team(entry):
            return False
        return not self._changes_only or self._changed(entry)

    def _is_message(self, entry: HeardDatagram) -> bool:
        return entry.kind is DatagramKind.MESSAGE and entry.message.DESCRIPTOR.name == self._message

    def _is_team(self, entry: HeardDatagram) -> bool:
        if isinstance(entry.message, pb.RoahRsbbBeacon):
            return any(robot.team_name == self._team for robot in entry.message.benchmarking_teams)
        return entry.team == self._team

    def _changed(self, entry: HeardDatagram) -> bool:
        """Whether a datagram differs from the latest one of the same sender and type, ignoring times."""
        if entry.kind is not DatagramKind.MESSAGE:
            kind, content = entry.kind.value, entry.text.encode("utf-8", "replace")
        else:
            message = type(entry.message)()
            message.CopyFrom(entry.message)
            for field in _TIMES:
                if field in message.DESCRIPTOR.fields_by_name:
                    message.ClearField(field)
            kind, content = message.DESCRIPTOR.name, message.SerializePartialToString()
        key = (entry.datagram.src, entry.datagram.dport, kind)
        if self._last.get(key) == content:
            return False
        self._last[key] = content
        return True


# -- lines ------------------------------------------------------------------------------------------

_DIM, _RED, _GREEN, _YELLOW, _MAGENTA, _CYAN = "2", "31", "32", "33", "35", "36"
_NS = 1_000_000_000
_WIDEST_COLUMN = 40
_HIGHLIGHTED = {"benchmark_state", "robot_state"}


class TextLines:
    """Formats datagrams as lines of text: time, channel, address, speaker, content.

    The columns for addresses and names grow with their content, up to a limit.
    """

    def __init__(self, color: bool = False) -> None:
        self._color = color
        self._widths = {"sender": len("255.255.255.255"), "speaker": len("TestingTeam/TestingRobot")}

    def line(self, entry: HeardDatagram) -> str:
        """The next line."""
        datagram = entry.datagram
        channel = str(datagram.dport) if entry.private else "public"
        sender = f"{datagram.src}:{datagram.sport}" if datagram.sport != datagram.dport else datagram.src
        speaker = escaped(str(entry.speaker)) if entry.speaker else "unknown"
        return " ".join([
            self._paint(_clock(datagram.time), _DIM), f"{channel:<6}", self._column("sender", sender),
            self._column("speaker", speaker), self._what(entry),
        ])

    def _what(self, entry: HeardDatagram) -> str:
        if entry.kind is DatagramKind.ERROR:
            return self._paint(f"ERROR {escaped(entry.text)}. {likely_cause(entry.reason)}", _RED)
        if entry.kind is DatagramKind.ENCRYPTED:
            return self._paint(f"encrypted, {escaped(entry.text)}", _YELLOW)
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


def json_line(entry: HeardDatagram) -> str:
    """Format everything that is known of a datagram as a JSON object. Unknown and inapplicable keys are absent."""
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
    if entry.kind is DatagramKind.MESSAGE:
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


def skew_s(entry: HeardDatagram) -> Optional[float]:
    """The robot's clock minus the listener's clock in seconds, for a robot's message with a time."""
    if entry.kind is not DatagramKind.MESSAGE or "time" not in entry.message.DESCRIPTOR.fields_by_name:
        return None
    sent = entry.message.time
    # Subtract whole seconds first: a float of this size cannot hold nanoseconds.
    seconds = math.floor(entry.datagram.time)
    return sent.sec - seconds + sent.nsec / _NS - (entry.datagram.time - seconds)


def _text(value: Any) -> str:
    """Format a field's value unambiguously in one line."""
    if isinstance(value, str):
        return value if value.isidentifier() else escaped(json.dumps(value, ensure_ascii=False))
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
    """Format a time as time of day with microseconds; an invalid time as numbers."""
    if (sec, nsec) == (0, 0):
        return "never"
    if 0 <= sec <= LAST_SECOND and 0 <= nsec < _NS:
        return time.strftime("%H:%M:%S", time.gmtime(sec)) + f".{nsec // 1000:06}"
    return f"{sec}s+{nsec}ns"


def _clock(utc: float) -> str:
    milliseconds = math.floor(utc * 1000)
    return time.strftime("%H:%M:%S", time.gmtime(milliseconds // 1000)) + f".{milliseconds % 1000:03}"


def _strict(value: Any) -> Any:
    """Replace numbers that JSON cannot express."""
    if isinstance(value, dict):
        return {key: _strict(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_strict(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value
