"""One private channel: the times of its messages, the strings that it repeats, and what the box acknowledged.

All of this belongs to one run and is discarded with the channel: strings that the box did not acknowledge, device
commands (original clients can repeat those of their last run), and the result.
"""

import math
from collections import deque
from typing import Deque, Dict, List, Optional, Sequence, Tuple, Union

from roah_rsbb.comm.sender import StateSender
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import PERCENTAGES, SWITCHES, BoxState, RobotState, WireTime
from roah_rsbb.robot.goals import RESULT_BUDGET_BYTES, result_size, write_result
from roah_rsbb.robot.machine import IllegalEvent, RobotProgress
from roah_rsbb.rulebook.registry import STRINGS

# A box counts as silent after this time; it sends once a second on each channel.
SILENCE_S = 5.0
SET_BACK_S = 1.0

# Number of messages whose acknowledgement is recognised: 50 s of the fastest burst, usually many minutes.
_REMEMBERED = 1000

_NS = 1_000_000_000


def wire_time(utc: float) -> WireTime:
    """Convert seconds since 1970 to the form in messages."""
    return divmod(_nanoseconds(utc), _NS)


def _nanoseconds(utc: float) -> int:
    # Convert whole seconds separately, because multiplying the float would lose precision.
    seconds = math.floor(utc)
    return seconds * _NS + int((utc - seconds) * _NS)


class Silence:
    """Detects, once, that nothing was received for `limit_s` seconds."""

    def __init__(self, limit_s: float, now_mono: float) -> None:
        self._limit_s = limit_s
        self._heard_mono = now_mono
        self._reported = False

    @property
    def deadline(self) -> float:
        """When `begins` becomes True if nothing is received; infinity after it was reported."""
        return float("inf") if self._reported else self._heard_mono + self._limit_s

    def heard(self, now_mono: float) -> bool:
        """Note that something was received. Returns whether this ends a reported silence."""
        ended, self._reported = self._reported, False
        self._heard_mono = now_mono
        return ended

    def begins(self, now_mono: float) -> bool:
        """True once, when the limit is reached."""
        if now_mono < self.deadline:
            return False
        self._reported = True
        return True

    def lasts(self, now_mono: float) -> bool:
        """Whether nothing was received for `limit_s` seconds."""
        return now_mono >= self._heard_mono + self._limit_s


class MessageTimes:
    """Assigns times to the messages of one channel, and finds a message's number by its time.

    The box orders a robot's messages by their `time` and ignores older ones (docs/protocol.md, "State machines").
    Therefore times always rise, even if the clock is stopped or NTP sets it back a little. If the clock is set back
    by more than `SET_BACK_S`, the times follow it: hiding that would show the referee a skew that no longer exists.
    """

    def __init__(self) -> None:
        self._last_ns: Optional[int] = None
        self._count = 0
        self._numbers: Dict[int, int] = {}  # number of the message by its time in ns

    def next(self, now_utc: float) -> Tuple[WireTime, int]:
        """Time and number (1, 2, 3 ...) of the message sent now; `now_utc` in seconds."""
        now_ns = _nanoseconds(now_utc)
        if self._last_ns is not None and self._last_ns - SET_BACK_S * _NS <= now_ns <= self._last_ns:
            now_ns = self._last_ns + 1
        self._last_ns = now_ns
        self._count += 1
        self._numbers.pop(now_ns, None)
        self._numbers[now_ns] = self._count
        if len(self._numbers) > _REMEMBERED:
            del self._numbers[next(iter(self._numbers))]
        return divmod(now_ns, _NS), self._count

    def number_of(self, acknowledged: WireTime) -> Optional[int]:
        """The number of the message with exactly this time; None if it is unknown.

        Boxes repeat the time exactly. An unknown time is from before this program or the box started.
        """
        return self._numbers.get(acknowledged[0] * _NS + acknowledged[1])

    def number_reached(self, acknowledged: WireTime) -> Optional[int]:
        """The number of the latest message up to this time, for times that are typed manually."""
        limit = acknowledged[0] * _NS + acknowledged[1]
        return max((number for time, number in self._numbers.items() if time <= limit), default=None)


# -- repeated strings -------------------------------------------------------------------------------

# A string: field and text.
_Key = Tuple[str, str]

# Bytes of a string in addition to its text: tag (up to 2) and length (up to 2).
_OVERHEAD_BYTES = 4


class RepeatedStrings:
    """Repeats the strings of one private channel until they are acknowledged (docs/protocol.md, "Repeated strings").

    Every message contains a string until the box acknowledges a message with it. The box logs a string when a message
    contains it and the previous message that it *received* did not. So before a text can be logged again, the box must
    have received a message without it.

    Messages are numbered in the order of sending. The box ignores a message that arrives after a newer one. So an
    acknowledgement of message n means that the box has received n and will only accept later ones. Therefore:

    - a string that was first sent in message f stays in all messages until some n >= f is acknowledged;
    - then it is omitted, from message g on. The same text may be sent again after some n >= g is acknowledged.

    Strings are sent in the order of `add`, whatever their field. A text that must wait delays those behind it for one
    round trip, which preserves the order.
    """

    def __init__(self, fields: Sequence[str], budget_bytes: int, max_waiting: int = 1000) -> None:
        """`budget_bytes`: limit for all strings of a message; `max_waiting`: limit of waiting strings."""
        self._fields = tuple(fields)
        self._budget_bytes = budget_bytes
        self._max_waiting = max_waiting
        self._last = 0  # number of the latest message
        self._waiting: Deque[_Key] = deque()
        self._sent: Dict[_Key, int] = {}  # number of the first message with it
        self._left_out: Dict[_Key, int] = {}  # number of the first message without it

    @property
    def pending(self) -> int:
        """Number of strings that the box has not acknowledged."""
        return len(self._waiting) + len(self._sent)

    @property
    def size(self) -> int:
        """The size of the strings in the latest message (bytes)."""
        return sum(map(_size, self._sent))

    @property
    def waiting(self) -> int:
        """Number of strings that were not sent yet."""
        return len(self._waiting)

    def add(self, field: str, text: str) -> None:
        """Queue `text` to be logged once. Raises `IllegalEvent` if it is too long or too many texts wait."""
        if field not in self._fields:
            raise IllegalEvent(f"unknown string field {field!r}: choose from {', '.join(self._fields)}")
        size = encoded_size(text)
        if size + _OVERHEAD_BYTES > self._budget_bytes:
            raise IllegalEvent(
                f"this string for {field} has {size} bytes in UTF-8: "
                f"at most {self._budget_bytes - _OVERHEAD_BYTES} fit into a message"
            )
        if len(self._waiting) >= self._max_waiting:
            raise IllegalEvent(
                f"{self._max_waiting} strings already wait for acknowledgements of the box: "
                "send fewer, or check why the box does not receive this robot's messages"
            )
        self._waiting.append((field, text))

    def for_message(self, number: int) -> Dict[str, List[str]]:
        """The strings of message `number` by field, in order. Call this once for each message."""
        self._last = number
        used = self.size
        while self._waiting:
            key = self._waiting[0]
            used += _size(key)
            if key in self._sent or key in self._left_out or used > self._budget_bytes:
                break
            self._sent[self._waiting.popleft()] = number
        content: Dict[str, List[str]] = {}
        for field, text in self._sent:
            content.setdefault(field, []).append(text)
        return content

    def acknowledged(self, number: int) -> bool:
        """Note that the box has received message `number`. Returns whether waiting strings can be sent now."""
        absent = [key for key, without in self._left_out.items() if without <= number]
        for key in absent:
            del self._left_out[key]
        arrived = [key for key, first in self._sent.items() if first <= number]
        for key in arrived:
            del self._sent[key]
            self._left_out[key] = self._last + 1
        return bool(self._waiting) and bool(absent or arrived)


def encoded_size(text: str) -> int:
    """The size of `text` in UTF-8 (bytes); `IllegalEvent` for invalid Unicode."""
    try:
        return len(text.encode("utf-8"))
    except UnicodeEncodeError as error:
        raise IllegalEvent(f"{text!r} is not valid Unicode: {error.reason}") from None


def _size(key: _Key) -> int:
    return _OVERHEAD_BYTES + encoded_size(key[1])


# -- the channel ------------------------------------------------------------------------------------

# Limit for all strings of a message, which leaves room for short results. A longer result waits until the box has
# acknowledged the strings (`BoxLink.message`).
STRINGS_BUDGET_BYTES = 500

# Datagrams that arrive out of order do so within this time. If a STOP acknowledges older messages for longer, the box
# has restarted or no longer receives this robot, and the STOP counts.
STALE_S = 2.0
# A beacon of the box that no longer gives the robot this channel counts once the box sent nothing on it for so long. It
# sends each second. Anybody can forge the beacon.
LEFT_S = 1.5
# A state that arrives so soon after such a beacon was sent before it.
OVERTAKEN_S = 0.5


class BoxLink:
    """One private channel from opening to closing."""

    def __init__(self, host: str, port: int, now_mono: float, by_hand: bool = False) -> None:
        """`host`: the box's address. `by_hand`: no channel; the user plays the box (override)."""
        self.host = host
        self.port = port
        self.by_hand = by_hand
        self.sender = StateSender()
        self.sender.changed(now_mono)
        self.silence = Silence(SILENCE_S, now_mono)
        self.decoded = False  # a message of the box could be decrypted
        self._strings = RepeatedStrings(STRINGS, STRINGS_BUDGET_BYTES)
        self._result_waits = False  # it does not fit beside the strings
        self._times = MessageTimes()
        self._commands: Dict[str, Union[bool, int]] = {}  # by field of RobotState
        self._acknowledged = 0  # number of the latest message that the box has seen; 0: none
        self._begun = -1  # the number that its latest STOP or PREPARE acknowledged; -1: a goal followed
        self._fresh_mono = now_mono
        self._left_mono: Optional[float] = None  # when the first beacon arrived that takes the channel away

    def continue_at(self, now_mono: float, host: str) -> None:
        """The box at this address continues the run. It gets what the one before has not acknowledged."""
        self.host, self.decoded, self.silence = host, False, Silence(SILENCE_S, now_mono)
        self.sender.changed(now_mono)

    def is_left(self, now_mono: float) -> bool:
        """Take a beacon of the box that takes this channel away. Returns whether it counts."""
        if not self.decoded:
            return True
        if self._left_mono is None:
            self._left_mono = now_mono
        return now_mono >= self.left_from

    @property
    def left_from(self) -> float:
        """When the channel ends (monotonic s), unless the box says something on it before."""
        return math.inf if self._left_mono is None else self._fresh_mono + LEFT_S

    def continues(self, now_mono: float) -> bool:
        """The box said something new. Returns whether a beacon took the channel away before, which was not the box's
        then."""
        if self._left_mono is None or now_mono - self._left_mono < OVERTAKEN_S:
            return False
        self._left_mono = None
        return True

    @property
    def strings_pending(self) -> int:
        """Number of strings that the box has not acknowledged."""
        return self._strings.pending

    def add_string(self, field: str, text: str) -> None:
        """Queue a string of online data; `IllegalEvent` if it cannot be sent."""
        self._strings.add(field, text)

    def command_device(self, name: str, value: Union[bool, int]) -> None:
        """Request a device's state from now on; `IllegalEvent` for an unknown device or value."""
        if name in SWITCHES:
            if not isinstance(value, bool):
                raise IllegalEvent(f"{name} takes True (on) or False (off), not {value!r}")
        elif name in PERCENTAGES:
            if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= 100:
                raise IllegalEvent(f"{name} takes a whole percentage from 0 to 100, not {value!r}")
        else:
            names = ", ".join(SWITCHES + PERCENTAGES)
            raise IllegalEvent(f"unknown device {name!r}: choose from {names}")
        self._commands["devices_" + name] = value

    def command_map(self, display: bool) -> None:
        """Request that the tablet shows the map (True) or the call button (False) from now on."""
        self._commands["tablet_display_map"] = bool(display)

    def take(self, now_mono: float, message: pb.BenchmarkState) -> bool:
        """Note what `message` acknowledges. Returns False if it is not of this run, or out of order.

        A BenchmarkState has no time, but its acknowledgement never goes back while the box runs. So a message is late
        if it acknowledges less than an earlier one. A GOAL_TX or WAITING_RESULT is also late if it acknowledges no more
        than an earlier STOP or PREPARE, because the box reaches the goal only after a newer message of the robot. A
        state that moves the robot without acknowledging a message of this run is a recording, or it was meant for this
        robot before it restarted: the box acknowledges the next message within a second.
        """
        number = self._acknowledged_number(message) or 0
        stops = message.benchmark_state == BoxState.STOP
        begins = stops or message.benchmark_state == BoxState.PREPARE
        overtaken = number < self._acknowledged or (number <= self._begun and not begins)
        if not self.by_hand:
            if not stops and (number == 0 or number < self._acknowledged):
                return False
            if overtaken and now_mono - self._fresh_mono < STALE_S:
                return False
        self._acknowledged = number
        self._begun = number if begins else -1
        self._fresh_mono = now_mono
        size = self._strings.size
        if self._strings.acknowledged(number) or (self._result_waits and self._strings.size < size):
            self.sender.changed(now_mono)
        return True

    def _acknowledged_number(self, message: pb.BenchmarkState) -> Optional[int]:
        if not message.HasField("acknowledgement"):
            return None
        time = (message.acknowledgement.sec, message.acknowledgement.nsec)
        return self._times.number_reached(time) if self.by_hand else self._times.number_of(time)

    def message(self, now_utc: float, progress: RobotProgress) -> pb.RobotState:
        """Build the next message to the box. It must be sent.

        While strings and result do not fit into one message, it reports EXECUTING instead of RESULT_TX, because the box
        may end the run at the first RESULT_TX.
        """
        message = pb.RobotState(messages_saved=progress.messages_saved, robot_state=int(progress.state))
        (message.time.sec, message.time.nsec), number = self._times.next(now_utc)
        for field, texts in self._strings.for_message(number).items():
            getattr(message, field).extend(texts)
        for field, value in self._commands.items():
            setattr(message, field, value)
        if progress.state is RobotState.RESULT_TX:
            room = RESULT_BUDGET_BYTES - self._strings.size
            self._result_waits = (self._strings.waiting > 0 or result_size(progress.result) > room) and not self.by_hand
            if self._result_waits:
                message.robot_state = int(RobotState.EXECUTING)
            else:
                write_result(message, progress.result)
        return message
