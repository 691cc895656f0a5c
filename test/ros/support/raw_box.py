"""A box of which each datagram is the test's, for the team's side: node roah_rsbb_comm and robots."""

import time
from typing import Any, Callable, Dict, List, Optional, Tuple

from helpers.box_beacon import box_beacon
from roah_rsbb.comm.channels import Network as WireNetwork
from roah_rsbb.comm.channels import PrivateChannel
from roah_rsbb.comm.ciphers import Key
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState
from support.robots import BOX, BROADCAST, PASSWORDS, Network, PublicParticipant
from support.waiting import happened, wait_until


class RawBox:
    """It sends beacons and states only on request; `answers` are what it does by itself.

    `received` are the robot's messages on the private channel, in their order, of all channels of the test.
    """

    def __init__(
        self, network: Network, team: str, robot: str = "Robot", password: Optional[str] = None, host: str = BOX
    ) -> None:
        self.team, self.robot, self.host = team, robot, host
        self.received: List[pb.RobotState] = []
        self.complaints: List[str] = []  # about what came on the private channel
        # The robot's state -> what is sent as soon as it is heard, each once.
        self.answers: Dict[RobotState, Callable[[], Any]] = {}
        self.answered: Dict[RobotState, float] = {}  # when these were sent (UTC in seconds)
        self._key = Key(PASSWORDS[team] if password is None else password)
        self._network = network
        self._public = PublicParticipant(network, host)
        self._private: Optional[PrivateChannel] = None
        self._robot_host: Optional[str] = None
        self.beacon_message = box_beacon()

    def close(self) -> None:
        """Close the sockets without a last message."""
        self.close_channel()
        self._public.close()

    # -- public channel -----------------------------------------------------------------------------

    @property
    def robots_heard(self) -> List[Tuple[pb.RobotBeacon, str]]:
        """The robot's beacons, each with its sender's address."""
        return [(m, host) for m, host in list(self._public.heard)
                if isinstance(m, pb.RobotBeacon) and (m.team_name, m.robot_name) == (self.team, self.robot)]

    def wait_robot(self) -> None:
        """Wait until the robot sends a new beacon."""
        before = len(self.robots_heard)
        self._robot_host = wait_until(
            lambda: len(self.robots_heard) > before and self.robots_heard[-1][1], "the robot sends beacons"
        )

    def beacon(self, port: Optional[int] = None, **home: Any) -> None:
        """One beacon: lists the robot with that port; `home`: fields that change, and stay so."""
        for field, value in home.items():
            if isinstance(value, pb.Time):
                getattr(self.beacon_message, field).CopyFrom(value)
            else:
                setattr(self.beacon_message, field, value)
        del self.beacon_message.benchmarking_teams[:]
        if port is not None:
            self.beacon_message.benchmarking_teams.add(
                team_name=self.team, robot_name=self.robot, rsbb_port=port
            )
        self._public.send(self.beacon_message)

    # -- private channel ----------------------------------------------------------------------------

    def run(self, port: int) -> None:
        """A new run on that port: the robot is heard, listed, and sends its state."""
        self.wait_robot()
        self.listen(port)
        self.beacon(port)
        before = len(self.received)
        wait_until(lambda: len(self.received) > before, "the robot sends its state")

    def listen(self, port: int) -> None:
        """Open the private channel."""
        self.close_channel()
        self._private = PrivateChannel(
            self._network.loop, WireNetwork(BROADCAST, bind_host=self.host), port, self._key, self._on_state,
            self._on_complaint,
        )
        self._private.remote = self._robot_host
        self._network.do(self._private.open)

    def close_channel(self) -> None:
        """Close the private channel."""
        if self._private is not None:
            self._network.do(self._private.close)
            self._private = None

    def state(self, benchmark: str, state: BoxState, **fields: Any) -> pb.BenchmarkState:
        """A state that acknowledges what was received last."""
        message = pb.BenchmarkState(benchmark_type=benchmark, benchmark_state=int(state), **fields)
        if self.received:
            message.acknowledgement.CopyFrom(self.received[-1].time)
        return message

    def send(self, benchmark: str, state: BoxState, **fields: Any) -> None:
        """Send one state."""
        self._network.do(lambda: self._private.send(self.state(benchmark, state, **fields)))

    def wait_state(self, state: RobotState) -> pb.RobotState:
        """Wait until the last message of the robot says that it is in a state; returns that message."""
        return self.wait_received(lambda m: m.robot_state == state, f"the robot says that it is in {state.name}")

    def wait_received(self, condition: Callable[[pb.RobotState], Any], what: str) -> pb.RobotState:
        """Wait until the last message of the robot fulfils a condition; returns it."""
        return wait_until(
            lambda: self.received and condition(self.received[-1]) and self.received[-1],
            lambda: f"{what}; the last of {len(self.received)} is\n{self.received[-1:]}",
        )

    def _on_state(self, message: pb.RobotState, _sender: Tuple[str, int]) -> None:
        self.received.append(message)
        state = RobotState(message.robot_state)
        answer = self.answers.pop(state, None)
        if answer is not None:
            self._private.send(answer())
            self.answered[state] = time.time()
        happened()

    def _on_complaint(self, text: str) -> None:
        self.complaints.append(text)
        happened()


def now() -> pb.Time:
    """The present time, for a beacon."""
    ns = time.time_ns()
    return pb.Time(sec=ns // 10**9, nsec=ns % 10**9)
