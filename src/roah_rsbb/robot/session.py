"""Everything a robot does between its behaviours and the network, without sockets and clocks.

Feed a `Session` with what was received and with what the robot's owner wants; after each call, and at
`deadline`, call `poll` and do what the effects say, in order. The session asks no clock: `now_mono`
is a monotonic time in seconds, `now_utc` the robot's clock in seconds since 1970.

Which box. The first box heard is the robot's box, and stays so while its beacon or its private messages
were heard within the last 5 s; the beacon of another one is reported and changes nothing. After a silence
in which nobody was heard, the network was away and not the box: another one must have been heard for 5 s
without it. Only a robot that has no private channel follows any box that lists it, and one whose private
channel never brought anything.
"""

from typing import List, Optional, Tuple, Union

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.goals import Result
from roah_rsbb.robot.link import Link
from roah_rsbb.robot.machine import IllegalEvent
from roah_rsbb.robot.progress import Progress
from roah_rsbb.robot.times import wire_time
from roah_rsbb.robot.watch import SILENCE_S, Alone, Home, Reports, Silence

BEACON_PERIOD_S = 1.0

PublicMessage = Union[pb.RoahRsbbBeacon, pb.RobotBeacon, pb.TabletBeacon]
PrivateMessage = Union[pb.BenchmarkState, pb.RobotState]

# Where a datagram came from: host and port.
Address = Tuple[str, int]


class Session:
    """One robot of one team: `progress` in its benchmark, `link` to the box (None: no private channel)."""

    def __init__(self, team: str, robot: str, now_mono: float) -> None:
        """ValueError when a name is empty."""
        if not team or not robot:
            raise ValueError("a robot needs a team name and a robot name, neither may be empty")
        self.team = team
        self.robot = robot
        self.progress = Progress()
        self.link: Optional[Link] = None
        self._box: Optional[str] = None  # address of the robot's box
        self._others = Alone()
        self._silence = Silence(SILENCE_S, now_mono)  # of the box's beacon
        self._beacon_due = now_mono
        self._changed = False  # the box is to hear at once
        self._home = Home()
        self._reports = Reports()
        self._effects: List[fx.Effect] = []

    # What the network brings.

    def public_message(self, now_mono: float, message: PublicMessage, sender: Address) -> None:
        """A message on the public channel, from another participant."""
        if isinstance(message, pb.RoahRsbbBeacon):
            self._hear_beacon(now_mono, message, sender[0])
        elif isinstance(message, pb.RobotBeacon) and self._is_me(message):
            self._hear_twin(sender[0])
        # A TabletBeacon is for the box: robots trust what the box says of the tablet (docs/protocol.md, "Messages").

    def private_message(self, now_mono: float, message: PrivateMessage, sender: Address) -> None:
        """A message on the private channel."""
        link = self.link
        if link is None or link.by_hand:
            return
        if isinstance(message, pb.RobotState):
            self._hear_twin(sender[0])
        elif sender[0] != link.host:
            self._effects += self._reports.once(
                fx.Trouble.ANOTHER_BOX, sender[0],
                f"a box at {sender[0]} sends on port {link.port}, where the box at {link.host} runs this "
                "robot: ignored",
            )
        else:
            link.decoded = True
            self._end_silence(now_mono, link)
            self._hear_state(now_mono, link, message)

    def private_undecodable(self, now_mono: float, sender_host: str) -> None:
        """A datagram on the private channel could not be decrypted or parsed."""
        link = self.link
        if link is None or link.by_hand or link.host != sender_host:
            return
        self._end_silence(now_mono, link)
        if not link.decoded:
            self._effects += self._reports.once(
                fx.Trouble.WRONG_PASSWORD, link.port,
                f"what the box at {link.host} sends on port {link.port} cannot be decrypted: this robot's "
                f"password of team {self.team} is not the one in the box's passwords file",
            )

    def channel_failed(self, reason: str) -> None:
        """The private channel could not be opened. It is tried again at the next beacon."""
        if self.link is not None and not self.link.by_hand:
            self._effects += self._reports.once(fx.Trouble.CHANNEL, reason, reason)
            self._drop(reason)

    # What the robot's owner wants. Each raises IllegalEvent, and changes nothing, when it makes no sense.

    def end_prepare(self) -> None:
        """The robot has prepared and waits for its goal."""
        self._follow(self.progress.end_prepare())

    def end_execute(self, result: Result = None) -> None:
        """The robot has finished the goal; ValueError for a result that does not fit the benchmark."""
        self._follow(self.progress.end_execute(result))

    def add_string(self, field: str, text: str) -> None:
        """Online data: `field` is one of `link.STRING_FIELDS`. The box logs each string once."""
        self._running(f"send {field}").add_string(field, text)
        self._changed = True

    def set_device(self, name: str, value: Union[bool, int]) -> None:
        """Ask the box to switch a device: switch_1 to switch_3 (bool), dimmer and blinds (0 to 100)."""
        self._running(f"set {name}").command_device(name, value)
        self._changed = True

    def display_map(self, display: bool) -> None:
        """Ask for the tablet's map (True) or its call button (False)."""
        self._running("command the tablet").command_map(display)
        self._changed = True

    def override(self, now_mono: float, message: Optional[pb.BenchmarkState]) -> None:
        """Play the box, to test a robot without one; None: back to normal.

        The private channel is closed, nothing is sent to anybody, and the states that would be sent
        come as `WouldSendState`. A goal that is missing in `message` does not matter then.
        """
        if message is None:
            if self.link is not None and self.link.by_hand:
                self._drop("the override has ended")
            return
        if self.link is None or not self.link.by_hand:
            self._drop("the owner overrides the box")
            self.link = Link("", 0, now_mono, by_hand=True)
        self._hear_state(now_mono, self.link, message)

    # Time.

    def deadline(self) -> float:
        """When `poll` has something to do next, in monotonic seconds."""
        if self.link is None:
            return min(self._silence.deadline, self._beacon_due)
        if self.link.by_hand:
            return self.link.sender.deadline
        return min(self._silence.deadline, self.link.silence.deadline, self.link.sender.deadline)

    def poll(self, now_mono: float, now_utc: float) -> List[fx.Effect]:
        """What is to be done now, in this order."""
        link = self.link
        if link is None or not link.by_hand:
            self._begin_silences(now_mono)
        if link is not None:
            if self._changed:
                link.sender.changed(now_mono)
            if link.sender.due(now_mono):
                message = link.message(now_utc, self.progress)
                self._effects.append(fx.WouldSendState(message) if link.by_hand else fx.SendState(message))
        elif now_mono >= self._beacon_due:
            self._beacon_due = now_mono + BEACON_PERIOD_S
            beacon = pb.RobotBeacon(team_name=self.team, robot_name=self.robot)
            beacon.time.sec, beacon.time.nsec = wire_time(now_utc)
            self._effects.append(fx.SendBeacon(beacon))
        self._changed = False
        effects, self._effects = self._effects, []
        return effects

    # The run.

    def _running(self, to_do: str) -> Link:
        if self.link is None:
            raise IllegalEvent(f"cannot {to_do}: there is no run, the box does not list this robot")
        return self.link

    def _follow(self, effects: List[fx.Effect]) -> None:
        """Pass on what a step brought; the box hears of a new state at once."""
        self._changed = self._changed or any(isinstance(effect, fx.StateIs) for effect in effects)
        self._effects += effects

    def _hear_state(self, now_mono: float, link: Link, message: pb.BenchmarkState) -> None:
        if not link.take(now_mono, message):
            return
        effects = self.progress.hear(message, goal_needed=not link.by_hand)
        if any(isinstance(effect, fx.Report) for effect in effects):
            link.sender.reply(now_mono)  # where the robot really is, so that the box can begin again
        self._follow(effects)

    def _drop(self, why: str) -> None:
        """End the run, as far as this robot goes."""
        self._effects += self.progress.leave(why)
        if self.link is not None and not self.link.by_hand:
            self._effects.append(fx.CloseChannel(why))
        self.link = None

    # Which box, and whether it is there.

    def _hear_beacon(self, now_mono: float, beacon: pb.RoahRsbbBeacon, host: str) -> None:
        port = self._listed_port(beacon, host)
        if not self._follows(now_mono, host, listed=port is not None):
            self._effects += self._reports.once(
                fx.Trouble.ANOTHER_BOX, host,
                f"there is another box at {host}, beside the one at {self._box}: its beacon is ignored while "
                "that one is heard",
            )
            return
        if host != self._box:
            self._box, self._home = host, Home()  # what another box tells at first is long past
        self._others.end()
        if self._silence.heard(now_mono):
            self._effects.append(fx.Report(fx.Trouble.NO_BOX, f"the box at {host} is heard", over=True))
        self._effects += self._home.see(beacon)
        link = self.link
        if link is not None:
            if link.by_hand or (link.host, link.port) == (host, port):
                return
            self._drop(
                "the box does not list this robot any more" if port is None
                else f"the box at {host} gave this robot port {port}"
            )
        if port is not None:
            self.link = Link(host, port, now_mono)
            self._effects.append(fx.OpenChannel(host, port))

    def _is_me(self, message: Union[pb.RobotBeacon, pb.BenchmarkingTeam]) -> bool:
        return (message.team_name, message.robot_name) == (self.team, self.robot)

    def _listed_port(self, beacon: pb.RoahRsbbBeacon, host: str) -> Optional[int]:
        """The port of this robot's private channel, where the beacon lists the robot with a valid one."""
        for entry in beacon.benchmarking_teams:
            if self._is_me(entry):
                if 0 < entry.rsbb_port < 65536:
                    return entry.rsbb_port
                self._effects += self._reports.once(
                    fx.Trouble.CHANNEL, entry.rsbb_port,
                    f"the box at {host} gave this robot port {entry.rsbb_port}: there is no such port",
                )
        return None

    def _follows(self, now_mono: float, host: str, listed: bool) -> bool:
        """Whether the box at `host` is, or becomes, the robot's box."""
        if self._box in (None, host):
            return True
        if listed and (self.link is None or (not self.link.decoded and self.link.silence.lasts(now_mono))):
            return True
        heard_alone_s = self._others.heard(now_mono)
        return (heard_alone_s >= SILENCE_S and self._silence.lasts(now_mono)
                and (self.link is None or self.link.silence.lasts(now_mono)))

    def _hear_twin(self, host: str) -> None:
        self._effects += self._reports.once(
            fx.Trouble.SAME_NAME, host,
            f"another robot at {host} also calls itself {self.robot} of team {self.team}: the box cannot "
            "tell them apart, stop one or give it another robot name",
        )

    def _end_silence(self, now_mono: float, link: Link) -> None:
        self._others.end()
        if link.silence.heard(now_mono):
            text = f"the box at {link.host} is heard again on port {link.port}"
            self._effects.append(fx.Report(fx.Trouble.BOX_SILENT, text, over=True))

    def _begin_silences(self, now_mono: float) -> None:
        if self._silence.begins(now_mono):
            self._effects.append(fx.Report(
                fx.Trouble.NO_BOX,
                f"no beacon of a box for {SILENCE_S:.0f} s: is the box on, on this network and on this "
                "public port, and does a firewall let its broadcast in?",
            ))
        if self.link is not None and self.link.silence.begins(now_mono):
            self._effects.append(fx.Report(
                fx.Trouble.BOX_SILENT,
                f"the box at {self.link.host} has sent nothing on port {self.link.port} for "
                f"{SILENCE_S:.0f} s: has it lost this robot, or does a firewall keep that port closed?",
            ))
