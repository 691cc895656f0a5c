"""Which entries to show."""

from collections import OrderedDict
from typing import Any, Optional, Tuple

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.tools.capture.decoding import Entry, Kind

_MAX_REMEMBERED = 1000  # senders whose last message is known
_TIMES = ("time", "acknowledgement")  # what differs in every message


class Filter:
    """Passes the entries that fulfil all of its conditions."""

    def __init__(self, team: Optional[str] = None, message: Optional[str] = None, errors_only: bool = False,
                 changes_only: bool = False) -> None:
        """`team`: of that team, and beacons that list it. `message`: of that type. `changes_only`: not what repeats."""
        self._team = team
        self._message = message
        self._errors_only = errors_only
        self._changes_only = changes_only
        self._last: OrderedDict[Tuple[Any, ...], bytes] = OrderedDict()

    def passes(self, entry: Entry) -> bool:
        """Whether to show an entry. Call it once for each, in order."""
        if self._errors_only and entry.kind is not Kind.ERROR:
            return False
        if self._message is not None and not self._is_message(entry):
            return False
        if self._team is not None and not self._is_team(entry):
            return False
        return not self._changes_only or self._changed(entry)

    def _is_message(self, entry: Entry) -> bool:
        return entry.kind is Kind.MESSAGE and entry.message.DESCRIPTOR.name == self._message

    def _is_team(self, entry: Entry) -> bool:
        if isinstance(entry.message, pb.RoahRsbbBeacon):
            return any(robot.team_name == self._team for robot in entry.message.benchmarking_teams)
        return entry.team == self._team

    def _changed(self, entry: Entry) -> bool:
        """Whether it says something else than the last one of its sender and type, times apart."""
        if entry.kind is not Kind.MESSAGE:
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
        self._last.move_to_end(key)
        if len(self._last) > _MAX_REMEMBERED:
            self._last.popitem(last=False)
        return True
