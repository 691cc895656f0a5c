"""Everything a robot does between its behaviour and the network, without sockets and clocks.

Pass received messages and requests of the robot's software to a `Session`. After each call, and at `deadline`, call
`poll` and carry out the effects in order. The session has no clock: `now_mono` is a monotonic time in seconds,
`now_utc` the robot's clock in seconds since 1970.

Choice of the box. The first box that is received is the robot's box. It remains so while its beacons or private
messages arrive at least every 5 s; beacons of another box are reported and ignored, and so are beacons from its address
that take the robot out of its run while the box's private messages continue. If nothing at all was received, the
network was down, not the box: another box must then be received alone for 5 s. A robot without a private channel, or
whose private channel never delivered anything, follows any box that lists it.
"""

from typing import Hashable, List, NamedTuple, Optional, Set, Tuple, Union

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.goals import Result
from roah_rsbb.robot.link import SILENCE_S, BoxLink, Silence, wire_time
from roah_rsbb.robot.machine import IllegalEvent, RobotProgress

# -- what a robot monitors besides its run ------------------------------------------------------------

# A box that is started together with the robot loads its files and listens first. Until then, its silence is no fault.
BOX_STARTS_S = 15.0

# Boxes send once a second: a longer gap means that the network was down.
_GAP_S = 3.0

# After this many beacons in a row with an older time, the time was set back.
_SET_BACK_BEACONS = 5

# Limits the memory of reports, because datagrams can be forged.
_MAX_REPORTED = 100


class OtherBoxes:
    """Measures how long only other boxes were received, without a gap."""

    def __init__(self) -> None:
        self._since_mono = 0.0
        self._last_mono = float("-inf")

    def heard(self, now_mono: float) -> float:
        """Note that another box was received. Returns for how many seconds only other boxes were received."""
        if now_mono - self._last_mono > _GAP_S:
            self._since_mono = now_mono
        self._last_mono = now_mono
        return now_mono - self._since_mono

    def end(self) -> None:
        """Note that the robot's box was received."""
        self._last_mono = float("-inf")


class Reports:
    """Makes each report once per key, not with every datagram."""

    def __init__(self) -> None:
        self._reported: Set[Tuple[fx.Problem, Hashable]] = set()

    def once(self, problem: fx.Problem, key: Hashable, text: str) -> List[fx.ProblemIs]:
        """The report; empty if it was made before for this `problem` and `key`."""
        if (problem, key) in self._reported or len(self._reported) >= _MAX_REPORTED:
            return []
        self._reported.add((problem, key))
        return [fx.ProblemIs(problem, text)]


class _Seen(NamedTuple):
    devices: fx.Devices
    tablet: fx.TabletIs


class _Moments:
    """Detects a new event (such as a ring of the bell) by its time alone.

    An older time means that a beacon arrived out of order: the next one has the newer time again, which is not a second
    ring. If it stays older, the box restarted or its clock was set back.
    """

    def __init__(self) -> None:
        self._newest: Optional[Tuple[int, int]] = None
        self._older = 0  # times in a row

    def is_new(self, time: Tuple[int, int]) -> bool:
        """Whether the time in a beacon is that of a new event. The first beacon has none."""
        before = self._newest
        self._older = self._older + 1 if before is not None and time < before else 0
        if before is None or time > before or self._older >= _SET_BACK_BEACONS:
            self._newest = time
        return before is not None and time > before


class HomeWatch:
    """The devices and the tablet as the box's beacons show them.

    Beacons contain only the times of the latest ring, call and selected position. The first beacon gives old times, not
    new events.
    """

    def __init__(self) -> None:
        self._seen: Optional[_Seen] = None
        self._bell, self._call, self._position = _Moments(), _Moments(), _Moments()

    def see(self, beacon: pb.RoahRsbbBeacon) -> List[fx.Effect]:
        """Return the changes in a beacon."""
        now = _Seen(
            fx.Devices(
                _wire_time(beacon.devices_bell),
                beacon.devices_switch_1, beacon.devices_switch_2, beacon.devices_switch_3,
                beacon.devices_dimmer, beacon.devices_blinds,
                beacon.devices_door_win_detect,
            ),
            fx.TabletIs(
                beacon.tablet_display_map,
                _wire_time(beacon.tablet_call_time), _wire_time(beacon.tablet_position_time),
                beacon.tablet_position_x, beacon.tablet_position_y,
            ),
        )
        before, self._seen = self._seen, now
        news: List[fx.Effect] = [new for old, new in zip(before or (None, None), now) if old != new]
        if self._bell.is_new(now.devices.bell):
            news.append(fx.BellRang())
        if self._call.is_new(now.tablet.call_time):
            news.append(fx.TabletCalled())
        if self._position.is_new(now.tablet.position_time):
            news.append(fx.PositionSelected(now.tablet.position_x, now.tablet.position_y))
        return news


def _wire_time(time: pb.Time) -> Tuple[int, int]:
    return time.sec, time.nsec


# -- the session --------------------------------------------------------------------------------------

BEACON_PERIOD_S = 1.0

PublicMessage = Union[pb.RoahRsbbBeacon, pb.RobotBeacon, pb.TabletBeacon]
PrivateMessage = Union[pb.BenchmarkState, pb.RobotState]

# The sender of a datagram: host and port.
Address = Tuple[str, int]


class Session:
    """One robot of one team: `progress` in its benchmark, `link` to the box (None: no private channel)."""

    def __init__(self, team: str, robot: str, now_mono: float) -> None:
        """Raises ValueError for an empty name."""
        if not team or not robot:
            raise ValueError("team name and robot name must not be empty")
        self.team = team
        self.robot = robot
        self.progress = RobotProgress()
        self.link: Optional[BoxLink] = None
        self._box: Optional[str] = None  # address of the robot's box
        self._others = OtherBoxes()
        self._silence = Silence(SILENCE_S, now_mono + BOX_STARTS_S - SILENCE_S)  # of the box's beacon
        self._next_port: Optional[int] = None  # in the beacon that takes the private channel away; None: it has none
        self._beacon_due = now_mono
        self._changed = False  # send to the box immediately
        self._home = HomeWatch()
        self._reports = Reports()
        self._effects: List[fx.Effect] = []

    # Received messages.

    def public_message(self, now_mono: float, message: PublicMessage, sender: Address) -> None:
        """Take a message of another participant on the public channel."""
        if isinstance(message, pb.RoahRsbbBeacon):
            self._hear_beacon(now_mono, message, sender[0])
        elif isinstance(message, pb.RobotBeacon) and self._is_me(message):
            self._hear_twin(sender[0])
        # A TabletBeacon is for the box. Robots use the tablet's state in the box's beacon (docs/protocol.md,
        # "Messages").

    def private_message(self, now_mono: float, message: PrivateMessage, sender: Address) -> None:
        """Take a message on the private channel."""
        link = self.link
        if link is None or link.by_hand:
            return
        if isinstance(message, pb.RobotState):
            self._hear_twin(sender[0])
        elif sender[0] != link.host:
            self._effects += self._reports.once(
                fx.Problem.ANOTHER_BOX, sender[0],
                f"a box at {sender[0]} sends on port {link.port}, which belongs to the box at {link.host}: ignored",
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
                fx.Problem.WRONG_PASSWORD, link.port,
                f"messages of the box at {link.host} on port {link.port} cannot be decrypted: this robot's "
                f"password of team {self.team} differs from the one in the box's passwords file",
            )

    def channel_failed(self, reason: str) -> None:
        """The private channel could not be opened. It is retried at the next beacon."""
        if self.link is not None and not self.link.by_hand:
            self._effects += self._reports.once(fx.Problem.CHANNEL, reason, reason)
            self._drop(reason)

    # Requests of the robot's software. Each raises IllegalEvent, and changes nothing, if it is not possible now.

    def end_prepare(self) -> None:
        """The robot has prepared and waits for a goal."""
        self._follow(self.progress.end_prepare())

    def end_execute(self, result: Result = None) -> None:
        """The robot has finished the goal; ValueError for an unsuitable result."""
        self._follow(self.progress.end_execute(result))

    def add_string(self, field: str, text: str) -> None:
        """Online data: `field` is one of `registry.STRINGS`. The box logs each string once."""
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
        """Play the box to test a robot without one; None ends this.

        The private channel is closed, and nothing is sent. States become `WouldSendState` effects. A missing goal in
        `message` is ignored.
        """
        if message is None:
            if self.link is not None and self.link.by_hand:
                self._drop("the override has ended")
            return
        if self.link is None or not self.link.by_hand:
            self._drop("the box is overridden")
            self.link = BoxLink("", 0, now_mono, by_hand=True)
        self._hear_state(now_mono, self.link, message)

    # Time.

    def deadline(self) -> float:
        """When to call `poll` next, in monotonic seconds."""
        if self.link is None:
            return min(self._silence.deadline, self._beacon_due)
        if self.link.by_hand:
            return self.link.sender.deadline
        return min(self._silence.deadline, self.link.silence.deadline, self.link.sender.deadline, self.link.left_from)

    def poll(self, now_mono: float, now_utc: float) -> List[fx.Effect]:
        """Return what is to be done now, in order."""
        link = self.link
        if link is None or not link.by_hand:
            self._begin_silences(now_mono)
        if link is not None and now_mono >= link.left_from:
            self._follow_beacon(now_mono, link.host, self._next_port)
            link = self.link
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

    def _running(self, to_do: str) -> BoxLink:
        if self.link is None:
            raise IllegalEvent(f"cannot {to_do}: the box does not list this robot in a run")
        return self.link

    def _follow(self, effects: List[fx.Effect]) -> None:
        """Add effects. A new state is sent to the box immediately."""
        self._changed = self._changed or any(isinstance(effect, fx.StateIs) for effect in effects)
        self._effects += effects

    def _hear_state(self, now_mono: float, link: BoxLink, message: pb.BenchmarkState) -> None:
        if not link.take(now_mono, message):
            return
        if link.continues(now_mono):
            self._effects += self._reports.once(
                fx.Problem.ANOTHER_BOX, link.port,
                f"beacons from {link.host} take this robot out of its run, but the box there continues it on port "
                f"{link.port}: another program sends them, and they are ignored. Find it and take it off the network",
            )
        effects = self.progress.hear(message, goal_needed=not link.by_hand)
        if any(isinstance(effect, fx.ProblemIs) for effect in effects):
            link.sender.reply(now_mono)  # send the real state, so that the box can start again
        self._follow(effects)

    def _drop(self, why: str) -> None:
        """End the run for this robot."""
        self._effects += self.progress.leave(why)
        if self.link is not None and not self.link.by_hand:
            self._effects.append(fx.CloseChannel())
        self.link = None

    # Choice of the box, and silences.

    def _hear_beacon(self, now_mono: float, beacon: pb.RoahRsbbBeacon, host: str) -> None:
        port = self._listed_port(beacon, host)
        takes_over = port is not None and self.link is not None and port == self.link.port
        if not self._follows(now_mono, host, port is not None, takes_over):
            self._effects += self._reports.once(
                fx.Problem.ANOTHER_BOX, host,
                f"there is another box at {host} besides the one at {self._box}: it is ignored while the other "
                "one is received",
            )
            return
        link = self.link
        if (link is not None and not link.by_hand and link.host == host and link.port != port
                and not link.is_left(now_mono)):
            self._next_port = port
            return
        if host != self._box:
            self._box, self._home = host, HomeWatch()  # the first beacon of another box has old times
        self._others.end()
        if self._silence.heard(now_mono):
            self._effects.append(fx.ProblemIs(fx.Problem.NO_BOX, f"the box at {host} is received", over=True))
        self._effects += self._home.see(beacon)
        if link is None or not (link.by_hand or (link.host, link.port) == (host, port)):
            self._follow_beacon(now_mono, host, port)

    def _follow_beacon(self, now_mono: float, host: str, port: Optional[int]) -> None:
        """Go to the private channel that a beacon gives this robot; None: to none."""
        if self.link is not None and not self.link.by_hand and self.link.port == port:
            # Another box continues the run, so the robot stays in its state: one that stopped does not move.
            self.link.continue_at(now_mono, host)
            self._effects.append(fx.OpenChannel(host, port))
            return
        if self.link is not None:
            self._drop(
                "the box no longer lists this robot" if port is None
                else f"the box at {host} gave this robot port {port}"
            )
        if port is not None:
            self.link = BoxLink(host, port, now_mono)
            self._effects.append(fx.OpenChannel(host, port))

    def _is_me(self, message: Union[pb.RobotBeacon, pb.BenchmarkingTeam]) -> bool:
        return (message.team_name, message.robot_name) == (self.team, self.robot)

    def _listed_port(self, beacon: pb.RoahRsbbBeacon, host: str) -> Optional[int]:
        """The port of this robot's private channel if the beacon lists it with a valid one."""
        for entry in beacon.benchmarking_teams:
            if self._is_me(entry):
                if 0 < entry.rsbb_port < 65536:
                    return entry.rsbb_port
                self._effects += self._reports.once(
                    fx.Problem.CHANNEL, entry.rsbb_port,
                    f"the box at {host} gave this robot the invalid port {entry.rsbb_port}",
                )
        return None

    def _follows(self, now_mono: float, host: str, listed: bool, takes_over: bool) -> bool:
        """Whether the box at `host` is, or becomes, the robot's box.

        `takes_over`: it lists the robot with the port of its present run, as a standby does that continues this run.
        """
        if self._box in (None, host):
            return True
        if listed and (self.link is None or (not self.link.decoded and self.link.silence.lasts(now_mono))):
            return True
        if takes_over and self._silence.lasts(now_mono) and self.link.silence.lasts(now_mono):
            return True
        heard_alone_s = self._others.heard(now_mono)
        return (heard_alone_s >= SILENCE_S and self._silence.lasts(now_mono)
                and (self.link is None or self.link.silence.lasts(now_mono)))

    def _hear_twin(self, host: str) -> None:
        self._effects += self._reports.once(
            fx.Problem.SAME_NAME, host,
            f"another robot at {host} also has the name {self.robot} of team {self.team}: the box cannot "
            "distinguish them. Stop one of them, or change its robot name",
        )

    def _end_silence(self, now_mono: float, link: BoxLink) -> None:
        self._others.end()
        if link.silence.heard(now_mono):
            text = f"the box at {link.host} is received again on port {link.port}"
            self._effects.append(fx.ProblemIs(fx.Problem.BOX_SILENT, text, over=True))

    def _begin_silences(self, now_mono: float) -> None:
        if self._silence.begins(now_mono):
            self._effects.append(fx.ProblemIs(
                fx.Problem.NO_BOX,
                f"no beacon of a box for {SILENCE_S:.0f} s: check that the box runs on this network and public port, "
                "and that no firewall blocks its broadcasts",
            ))
        if self.link is not None and self.link.silence.begins(now_mono):
            # A box does not answer what it cannot decrypt.
            password = "" if self.link.decoded else f"team {self.team} has the same password in the box, and that "
            self._effects.append(fx.ProblemIs(
                fx.Problem.BOX_SILENT,
                f"the box at {self.link.host} has sent nothing on port {self.link.port} for "
                f"{SILENCE_S:.0f} s: check that {password}no firewall blocks this port",
            ))
