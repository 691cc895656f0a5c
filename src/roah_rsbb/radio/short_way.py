"""The short way of a robot's datagrams that only repeat what it said before (docs/architecture.md, "The short way").

Three of four datagrams of a robot in a run repeat the one before, but for their time. Such a datagram is decrypted and
compared, and then waits for its turn. `Turns.now` passes on all that wait, as if each was read at the moment at which
it came, before anything else happens in the box and before anybody looks at it; otherwise within `GRID_S`. So the box
and everybody see what they would see without this file. What is saved is the time to fetch the code and data of each
layer from memory for each datagram: of several in a row, only the first one needs it.

What a robot has not said just before never waits. A repetition does not wait either if it can have an effect: because
the run changed or did not take the same content before, because something is due, or because of the clocks. The core
promises when there is none (`Run.settled_at`, `Timers.is_calm`, `RobotLink.calm_skews`, `RobotPast.saved`).
"""

import asyncio
import logging
from typing import Callable, Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.comm.channels import PrivateChannel
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.comm.complaints import OnceASecond
from roah_rsbb.comm.frame import HEADER_SIZE, open_private
from roah_rsbb.comm.peer import Address
from roah_rsbb.comm.sender import GRID_S, on_grid
from roah_rsbb.core.box import Box
from roah_rsbb.core.link.freshness import RobotPast
from roah_rsbb.core.runs.run import NO_REVISION, Run
from roah_rsbb.model.clock import SAME_MOMENT_S, Now, one_moment
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.protocol import WireTime, wire_seconds
from roah_rsbb.radio.wire_convert import ReportReader

# The box takes so many datagrams in less than a millisecond.
MOST_WAITING = 40
# A robot's reports have two or three lengths, as their times have.
MAX_FRAMES = 16
UNKNOWN = 0, Cipher.NONE

_log = logging.getLogger(__name__)


class WaitingDatagram(NamedTuple):
    """A datagram that waits."""

    mono: float  # when it was read (s)
    utc: float
    way: "ShortWay"
    datagram: bytes
    cipher: Cipher
    time: WireTime  # of the robot
    size: int  # of its payload (bytes)
    sender: Address
    received_utc: Optional[float]  # when the system received it (s)


class Turns:
    """The box's clocks, and the datagrams of all channels that wait."""

    def __init__(self, loop: asyncio.AbstractEventLoop, mono: Callable[[], float], utc: Callable[[], float],
                 can_wait: bool = True) -> None:
        """`mono` and `utc` are the clocks (s). `can_wait`: whether datagrams may wait at all."""
        self.mono, self.utc, self.can_wait = mono, utc, can_wait
        self.waiting: List[WaitingDatagram] = []
        self._loop = loop
        self._moment: Optional[Now] = None  # of the datagram that is taken
        self._timer: Optional[asyncio.TimerHandle] = None
        self._bugs = OnceASecond()

    def now(self) -> Now:
        """Return the present moment, for whatever happens next or looks at the box. All that wait are taken first."""
        if self._moment is not None:
            return self._moment
        self.take()
        return one_moment(self.mono, self.utc)

    def now_mono(self) -> float:
        """Return the present moment (s) of the monotonic clock. Nothing is taken."""
        return self.mono() if self._moment is None else self._moment.mono

    def close(self) -> None:
        """Forget all that wait."""
        self.waiting.clear()
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def add(self, one: WaitingDatagram) -> None:
        """Let a datagram wait."""
        self.waiting.append(one)
        if self._timer is None:
            self._timer = self._loop.call_at(on_grid(one.mono) + GRID_S, self._on_timer)
        elif len(self.waiting) >= MOST_WAITING:
            self.take()

    def _on_timer(self) -> None:
        self._timer = None
        self.take()

    def take(self) -> None:
        """Take all datagrams that wait, each at its own moment."""
        if not self.waiting:
            return
        waiting = self.waiting[:]
        self.waiting.clear()
        try:
            for one in waiting:
                self._moment = Now(one.mono, one.utc)
                try:
                    one.way.take_late(one)
                except Exception:
                    # A mistake in a report must not keep the others, nor a referee's STOP, from the box.
                    self._bugs.count()
                    if self._bugs.take(self._loop.time()):
                        _log.exception("a datagram that waited could not be taken")
        finally:
            self._moment = None


class ShortWay:
    """The short way of one private channel."""

    def __init__(self, turns: Turns, key: Key, reader: ReportReader, box: Box) -> None:
        """`reader` reads the channel's payloads."""
        self._turns, self._key, self._reader, self._is_calm = turns, key, reader, box.timers.is_calm
        self._revisions = box.outbox.revisions
        self._channel: Optional[PrivateChannel] = None
        self._zone, self._revision = "", NO_REVISION  # as long as the zone has it, no repetition has an effect
        self._skews, self._offset = (0.0, 0.0), 0.0  # (s) as long as these hold, neither has a clock
        self._host: Optional[str] = None  # of the robot
        self._past = RobotPast(0.0)  # the journal must have a time before it is taken
        self._datagram = b""  # the one that takes the long way just now
        self._frames: Dict[bytes, Tuple[int, Cipher]] = {}  # of reports: length and cipher by `_shape`

    def begin(self, channel: PrivateChannel) -> None:
        """Take the channel, which passes its datagrams to `take`."""
        self._channel = channel

    def settle(self, run: Run, report: RobotReport) -> None:
        """Take the core's promise, after a report from the host of the run's robot. It is for repetitions of the run's
        last report, which is not this one if this one was old."""
        link = run.link
        self._skews, heard, self._past = link.calm_skews, link.last_heard, link.past
        self._offset = 0.0 if heard is None else heard.utc - heard.mono
        is_for_it = link.last is report and self._skews[0] < self._skews[1]
        self._zone, self._revision, self._host = run.zone, run.settled_at if is_for_it else NO_REVISION, link.host
        shape = _shape(self._datagram)
        if shape and self._turns.can_wait and shape not in self._frames and len(self._frames) < MAX_FRAMES:
            self._frames[shape] = len(self._datagram), open_private(self._datagram).cipher

    def take(self, datagram: bytes, sender: Address) -> None:
        """Let a datagram wait, or pass it on at once."""
        channel, turns = self._channel, self._turns
        assert channel is not None, "it was begun"
        if sender[0] == self._host and self._revisions.get(self._zone) == self._revision:
            length, cipher = self._frames.get(_shape(datagram), UNKNOWN)
            if length == len(datagram):
                payload = self._key.decrypt_body(cipher, datagram[HEADER_SIZE:])
                time = None if payload is None else self._reader.time_of_repeat(payload)
                if time is not None:
                    mono, utc, received_utc = turns.mono(), turns.utc(), channel.stamp
                    least, most = self._skews
                    seconds = wire_seconds(time)
                    skew = seconds - (utc if received_utc is None else received_utc)
                    # If the clocks are not as far apart as before, one was set, or this process paused between both.
                    if (least < skew < most and seconds < self._past.saved.near
                            and abs(utc - mono - self._offset) < SAME_MOMENT_S
                            and self._is_calm(mono)):
                        turns.add(WaitingDatagram(
                            mono, utc, self, datagram, cipher, time, len(payload), sender, received_utc))
                        return
        turns.take()
        if sender[0] != self._host:
            self._revision = NO_REVISION  # the reader may read another content, which the run ignores
        self._datagram = datagram
        channel.receive(datagram, sender)
        self._datagram = b""

    def take_late(self, one: WaitingDatagram) -> None:
        """Pass on a datagram that has waited."""
        assert self._channel is not None, "it was begun"
        self._channel.receive_late(
            one.datagram[HEADER_SIZE + one.cipher.iv_size:], lambda: self._reader.again(one.time, one.size), one.sender,
            one.received_utc)


def _shape(datagram: bytes) -> bytes:
    """Return the header of a frame without its reserved bytes, in which original robots send anything."""
    return datagram[:2] + datagram[4:HEADER_SIZE]
