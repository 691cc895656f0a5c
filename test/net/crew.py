"""The other participants on the network: robots, the tablet, and attackers."""

import asyncio
import contextlib
import time
from typing import Any, Callable, List, NamedTuple, Optional, Tuple

from namespaces import BROADCAST, LIMIT_S, Station
from support.waiting import happened, wait_until

from helpers.box_beacon import box_beacon
from roah_rsbb.comm.channels import Network, PrivateChannel, PublicChannel
from roah_rsbb.comm.ciphers import Key
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import RobotState
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.client import RobotClient
from roah_rsbb.robot.dummy import DummyOptions, DummyRobot
from roah_rsbb.robot.link import wire_time
from roah_rsbb.tablet.radio import ShownTablet, TabletRadio

RSBB_PORT = 6666
ROBOT = "Robot"  # the name of each team's first one
PREPARE_S = 0.5
HELD_S = 0.05
# The dummy world needs so long to drive there, or to carry an object.
EXECUTE_S = {"HNF": 2.0, "HGMF": 3.0, "HCFGAC": 6.0}
USUAL_EXECUTE_S = 3.0

# By this a robot's first sight of our home differs from that of another box's.
FOREIGN_BLINDS = 97


def password_of(team: str) -> str:
    """The password of a team."""
    return f"password of {team}"


class Moment(NamedTuple):
    """Something that a robot did: the name of its new state, or another event."""

    utc: float
    what: str
    goal: Any = None


class _Noting(DummyRobot):
    """The dummy robot, noting when it is in which state."""

    def __init__(self, options: DummyOptions, note: Callable[..., None], is_held: Callable[[], bool]) -> None:
        super().__init__(options)
        self._note = note
        self._is_held = is_held

    async def prepare(self, benchmark: str) -> None:
        self._note(RobotState.PREPARING.name)
        await super().prepare(benchmark)
        self._note(RobotState.WAITING_GOAL.name)

    async def execute(self, benchmark: str, goal: Any) -> Any:
        self._note(RobotState.EXECUTING.name, goal)
        result = await super().execute(benchmark, goal)
        while self._is_held():
            await asyncio.sleep(HELD_S)
        self._note(RobotState.RESULT_TX.name)
        return result

    def stop(self, why: str) -> None:
        self._note(RobotState.STOP.name)

    def on_tablet_call(self) -> None:
        self._note("call")

    def on_devices(self, devices: fx.Devices) -> None:
        self._note("foreign home" if devices.blinds == FOREIGN_BLINDS else "home")


class Robot:
    """A robot on a host; it begins at once."""

    def __init__(
        self, station: Station, team: str, execute_s: float, seed: int, name: str = ROBOT, host: str = BROADCAST,
    ) -> None:
        """`execute_s`: seconds for each goal."""
        self.station, self.team, self.name = station, team, name
        self._rsbb_host = host
        self.address = station.address
        self.moments: List[Moment] = []
        self.troubles: List[fx.ProblemIs] = []
        self.clock_s: Optional[float] = None  # what its clock shows instead of the time
        self.held = False  # it completes no goal
        self._options = DummyOptions(PREPARE_S, execute_s, seed=seed)
        self._behaviour: Optional[_Noting] = None
        self._running: Any = None
        self.begin()

    def begin(self) -> None:
        """Switch it on."""
        self._running = self.station.host.begin(self._live())

    def end(self) -> None:
        """Switch it off without a last message."""
        if self._running is not None:
            self._running.cancel()
            with contextlib.suppress(Exception):
                self._running.result(LIMIT_S)
            self.station.host.begin(asyncio.sleep(0)).result(LIMIT_S)
            self._running = None

    async def _live(self) -> None:
        behaviour = self._behaviour = _Noting(self._options, self._note, lambda: self.held)
        behaviour.on_report = self.troubles.append
        await RobotClient(
            self.team, password_of(self.team), behaviour, self.name, self._rsbb_host, RSBB_PORT, clock=self._clock,
        ).run()

    def _clock(self) -> float:
        return time.time() if self.clock_s is None else self.clock_s

    def _note(self, what: str, goal: Any = None) -> None:
        self.moments.append(Moment(time.time(), what, goal))
        happened()

    @property
    def is_in_run(self) -> bool:
        """Whether it hears a box on its private channel."""
        return self._behaviour is not None and self._behaviour.client.benchmark is not None

    def did(self, what: str) -> List[float]:
        """When it did something, UTC in seconds."""
        return [moment.utc for moment in list(self.moments) if moment.what == what]

    @property
    def states(self) -> List[str]:
        """The states that it was in, in their order, without the one it began with."""
        names = set(RobotState.__members__)
        return [moment.what for moment in list(self.moments) if moment.what in names]

    def wait_did(self, what: RobotState, limit_s: float) -> None:
        """Wait until it was in a state."""
        wait_until(lambda: self.did(what.name), lambda: f"{self.team} is {what.name}; it was {self.states}", limit_s)

    def wait_did_again(self, what: RobotState, since_utc: float, limit_s: float) -> None:
        """Wait until it was in a state after that time."""
        wait_until(lambda: any(utc > since_utc for utc in self.did(what.name)),
                   lambda: f"{self.team} is {what.name} again; it was {self.states}", limit_s)


class Tablet:
    """The tablet, on its own host."""

    def __init__(self, station: Station) -> None:
        self._host = station.host
        self._state = ShownTablet()
        self._radio = self._host.do(self._open)

    def _open(self) -> TabletRadio:
        radio = TabletRadio(self._host.loop, self._state, lambda changed: None, lambda text: None,
                            Network(BROADCAST, RSBB_PORT))
        radio.open()
        radio.present = True
        return radio

    def call(self) -> None:
        """Somebody touches the call button."""
        def touch() -> None:
            self._state.call(time.time_ns())
            self._radio.changed()
        self._host.do(touch)

    def close(self) -> None:
        """Switch it off."""
        self._host.do(self._radio.close)


class Stranger:
    """Repeatedly sends false messages on the public channel."""

    def __init__(self, station: Station, messages: Callable[[], List[Any]], period_s: float = 0.2) -> None:
        """`messages` gives what to broadcast each time."""
        self._host = station.host
        self._messages, self._period_s = messages, period_s
        self._sending = self._host.begin(self._send())

    async def _send(self) -> None:
        channel = PublicChannel(
            self._host.loop, Network(BROADCAST, RSBB_PORT), lambda message, sender: None, lambda text: None)
        channel.open()
        try:
            while True:
                for message in self._messages():
                    channel.send(message)
                await asyncio.sleep(self._period_s)
        finally:
            channel.close()

    def close(self) -> None:
        """Stop sending."""
        self._sending.cancel()
        self._host.begin(asyncio.sleep(0)).result(LIMIT_S)


class Impostor:
    """Knows a team's password, and sends false messages to the box on the robot's private channel."""

    def __init__(self, station: Station, team: str, port: int, box: str) -> None:
        self._host = station.host
        self._channel = PrivateChannel(
            self._host.loop, Network(BROADCAST), port, Key(password_of(team)), lambda message, sender: None,
            lambda text: None)
        self._channel.remote = box
        self._sending = self._host.begin(self._send())

    async def _send(self) -> None:
        self._channel.open()
        try:
            while True:
                for seconds in (-1, 2 ** 32, 2 ** 62, time.time()):
                    self._channel.send(pb.RobotState(
                        time=wire(seconds), messages_saved=1, robot_state=int(RobotState.RESULT_TX),
                        notifications=["not what the robot says"]))
                await asyncio.sleep(0.2)
        finally:
            self._channel.close()

    def close(self) -> None:
        """Stop sending."""
        self._sending.cancel()
        self._host.begin(asyncio.sleep(0)).result(LIMIT_S)


def wire(seconds: float) -> pb.Time:
    """A time for a message."""
    sec, nsec = (seconds, 0) if isinstance(seconds, int) else wire_time(seconds)
    return pb.Time(sec=sec, nsec=nsec)


def foreign_beacon(*listed: Tuple[str, str, int]) -> pb.RoahRsbbBeacon:
    """The beacon of a box that is none of ours."""
    return box_beacon(
        *listed, devices_switch_1=True, devices_switch_2=True, devices_switch_3=True, devices_dimmer=1,
        devices_blinds=FOREIGN_BLINDS, devices_door_win_detect=True, tablet_display_map=True, tablet_position_x=9.0,
        tablet_position_y=9.0,
    )
