"""What a robot remembers of one private channel: all of it is forgotten with the channel.

A new channel is a new run, so nothing of the last one may leak into it: neither strings that the box
did not acknowledge any more, nor device commands (the 2015 client repeated those of its last run), nor
a result.
"""

from typing import Dict, Optional, Union

from roah_rsbb.comm.sender import StateSender
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot.goals import write_result
from roah_rsbb.robot.machine import IllegalEvent
from roah_rsbb.robot.progress import Progress
from roah_rsbb.robot.repeated import RepeatedStrings
from roah_rsbb.robot.times import MessageTimes
from roah_rsbb.robot.watch import SILENCE_S, Silence

STRING_FIELDS = ("notifications", "activation_event", "visitor", "final_command")
SWITCHES = ("switch_1", "switch_2", "switch_3")
PERCENTAGES = ("dimmer", "blinds")

# What all strings of a message may take: of the 987 bytes that there are with aes-128-cbc (docs/protocol.md, "Frame"),
# 400 are for a result and less than 80 for everything else.
STRINGS_BUDGET_BYTES = 500

# A datagram that was overtaken comes within this time. A STOP that is older in the box's own words for longer
# is no straggler: the box started again, or does not hear this robot any more. Then it is obeyed.
STALE_S = 2.0


class Link:
    """One private channel, from its opening to its closing."""

    def __init__(self, host: str, port: int, now_mono: float, by_hand: bool = False) -> None:
        """`host`: the box's address. `by_hand`: no channel, the owner plays the box (override)."""
        self.host = host
        self.port = port
        self.by_hand = by_hand
        self.sender = StateSender()
        self.sender.changed(now_mono)
        self.silence = Silence(SILENCE_S, now_mono)
        self.decoded = False  # anything of the box could be read
        self._strings = RepeatedStrings(STRING_FIELDS, STRINGS_BUDGET_BYTES)
        self._times = MessageTimes()
        self._commands: Dict[str, Union[bool, int]] = {}  # by field of RobotState
        self._acknowledged = 0  # number of the last message that the box has seen; 0: none
        self._begun = -1  # the same, where it last said STOP or PREPARE
        self._fresh_mono = now_mono

    @property
    def strings_pending(self) -> int:
        """How many strings the box has not acknowledged yet."""
        return self._strings.pending

    def add_string(self, field: str, text: str) -> None:
        """Queue a string of online data; `IllegalEvent` when it cannot be sent."""
        self._strings.add(field, text)

    def command_device(self, name: str, value: Union[bool, int]) -> None:
        """Ask for a device's state, from now on; `IllegalEvent` for an unknown device or value."""
        if name in SWITCHES:
            if not isinstance(value, bool):
                raise IllegalEvent(f"{name} is True (on) or False (off), not {value!r}")
        elif name in PERCENTAGES:
            if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= 100:
                raise IllegalEvent(f"{name} takes a whole percentage from 0 to 100, not {value!r}")
        else:
            names = ", ".join(SWITCHES + PERCENTAGES)
            raise IllegalEvent(f"there is no device {name!r}: choose from {names}")
        self._commands["devices_" + name] = value

    def command_map(self, display: bool) -> None:
        """Ask the tablet to show the map (True) or its call button (False), from now on."""
        self._commands["tablet_display_map"] = bool(display)

    def take(self, now_mono: float, message: pb.BenchmarkState) -> bool:
        """Note what `message` acknowledges. False when it does not count: it is not of this run, or was overtaken.

        A BenchmarkState has no time of its own, but what it acknowledges never goes back while the
        box lives: one that acknowledges less than an earlier one is a straggler. So is one that wants the goal
        done and acknowledges no more than an earlier STOP or PREPARE did: only a newer message of the robot
        takes the box from there to the goal. A state that moves the robot and acknowledges no message of this run
        is a recording, or meant for this robot before it was started again: the box acknowledges its next message
        within a second.
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
        if self._strings.acknowledged(number):
            self.sender.changed(now_mono)
        return True

    def _acknowledged_number(self, message: pb.BenchmarkState) -> Optional[int]:
        if not message.HasField("acknowledgement"):
            return None
        time = (message.acknowledgement.sec, message.acknowledgement.nsec)
        return self._times.number_reached(time) if self.by_hand else self._times.number_of(time)

    def message(self, now_utc: float, progress: Progress) -> pb.RobotState:
        """The next message to the box. Each message that this returns must be sent.

        The robot still executes while there is something to say that does not fit into this message: the box may
        end the run at the first RESULT_TX, and hear no more.
        """
        message = pb.RobotState(messages_saved=progress.messages_saved, robot_state=int(progress.state))
        (message.time.sec, message.time.nsec), number = self._times.next(now_utc)
        for field, texts in self._strings.for_message(number).items():
            getattr(message, field).extend(texts)
        for field, value in self._commands.items():
            setattr(message, field, value)
        if progress.state is RobotState.RESULT_TX:
            if self._strings.waiting and not self.by_hand:
                message.robot_state = int(RobotState.EXECUTING)
            else:
                write_result(message, progress.result)
        return message
