"""Counts invalid datagrams by sender and reason, and reports them without flooding the log.

A robot with a wrong password sends twenty invalid datagrams a second. A faulty program may send thousands, with forged
senders. So memory is bounded, each (sender, reason) is reported at most once a second, and all of them together at most
ten times a second. No I/O and no clock.
"""

from collections import OrderedDict
from typing import Dict, Optional, Tuple

from roah_rsbb.comm.frame import BadDatagram, FrameFault

REPORT_PERIOD_S = 1.0
OTHERS = "others"
"""The sender that stands for all forgotten senders."""

_OTHER_PROGRAM = "Likely another program on this port: choose another rsbb_port, or end that program."
_OTHER_PORT = "Likely its rsbb_port differs from ours, so that it confuses the channels."
_PASSWORD = "Likely a wrong password in the robot (rsbb_key) or in the box (passwords file)."
_LIKELY_CAUSE = {
    FrameFault.TOO_SHORT: _OTHER_PROGRAM,
    FrameFault.VERSION_1: "Likely an old protobuf_comm: the sender must be updated to frames of version 2.",
    FrameFault.OTHER_VERSION: _OTHER_PROGRAM,
    FrameFault.UNKNOWN_CIPHER: _OTHER_PROGRAM,
    FrameFault.ENCRYPTED: _OTHER_PORT,
    FrameFault.PLAIN: "Likely its password is empty: set the robot's rsbb_key.",
    FrameFault.SIZE: "Likely another program on this port, or a sender that frames its messages wrongly.",
    FrameFault.UNDECRYPTABLE: _PASSWORD,
    FrameFault.UNKNOWN_TYPE: "Likely a participant of another competition or league on this network and port.",
    FrameFault.WRONG_CHANNEL: _OTHER_PORT,
    FrameFault.MALFORMED: "Likely a sender that was built from another .proto file.",
    FrameFault.NOT_UTF8: "Likely a name or text in another encoding: its configuration must be saved as UTF-8.",
    FrameFault.INCOMPLETE: "Likely a sender that was made from another .proto file, or that omits these fields.",
}


def likely_cause(reason: FrameFault) -> str:
    """The likely cause of an invalid datagram, with the remedy."""
    return _LIKELY_CAUSE[reason]


class OnceASecond:
    """Counts events, and reports their number at most once a second."""

    __slots__ = ("_next_mono", "_waiting")

    def __init__(self) -> None:
        self._waiting = 0
        self._next_mono = float("-inf")

    def count(self) -> None:
        """Count an event."""
        self._waiting += 1

    def take(self, now_mono: float) -> int:
        """The number of events to report now; 0 within a second after the previous report."""
        if now_mono < self._next_mono:
            return 0
        waiting, self._waiting = self._waiting, 0
        self._next_mono = now_mono + REPORT_PERIOD_S
        return waiting

    def ready(self, now_mono: float) -> bool:
        """Whether a report is allowed now."""
        return now_mono >= self._next_mono


class _Count:
    __slots__ = ("reports", "total")

    def __init__(self) -> None:
        self.total = 0
        self.reports = OnceASecond()


class Complaints:
    """Invalid datagrams of one or more channels, counted by (sender's host, reason)."""

    def __init__(self, max_entries: int = 200, max_reports_per_second: int = 10) -> None:
        """`max_entries`: number of remembered pairs of sender and reason."""
        self._max_entries = max_entries
        self._max_reports = max_reports_per_second
        self._entries: OrderedDict[Tuple[str, FrameFault], _Count] = OrderedDict()
        self._forgotten: Dict[FrameFault, int] = {}
        self._second_began_mono = float("-inf")
        self._reports_this_second = 0

    def add(self, now_mono: float, channel: str, sender: Tuple[str, int], bad: BadDatagram) -> Optional[str]:
        """Count an invalid datagram; returns the text to log now, or None. `channel` is the beginning of the text."""
        entry = self._entry((sender[0], bad.reason))
        entry.total += 1
        entry.reports.count()
        if not entry.reports.ready(now_mono) or not self._may_report(now_mono):
            return None
        count = entry.reports.take(now_mono)
        what = "a bad datagram" if count == 1 else f"{count} bad datagrams"
        host, port = sender
        return f"{channel}: {what} from {host}:{port}: {bad}. {likely_cause(bad.reason)}"

    def totals(self) -> Dict[Tuple[str, str], int]:
        """(sender's host, reason) to the number of datagrams since the start.

        Forgotten senders are summed by reason under `OTHERS`.
        """
        totals = {(OTHERS, reason.value): count for reason, count in self._forgotten.items()}
        totals.update({(host, reason.value): entry.total for (host, reason), entry in self._entries.items()})
        return totals

    def _entry(self, key: Tuple[str, FrameFault]) -> _Count:
        entry = self._entries.get(key)
        if entry is not None:
            self._entries.move_to_end(key)
            return entry
        while len(self._entries) >= self._max_entries:
            (_, reason), oldest = self._entries.popitem(last=False)
            self._forgotten[reason] = self._forgotten.get(reason, 0) + oldest.total
        entry = self._entries[key] = _Count()
        return entry

    def _may_report(self, now_mono: float) -> bool:
        if now_mono >= self._second_began_mono + REPORT_PERIOD_S:
            self._second_began_mono = now_mono
            self._reports_this_second = 0
        self._reports_this_second += 1
        return self._reports_this_second <= self._max_reports
