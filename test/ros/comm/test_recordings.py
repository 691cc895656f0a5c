"""Sessions of the original box with the original robot, replayed to the comm node: its states, topics and services.

The box's messages go to the node as they were recorded, whenever they contain something new; the robot's owner calls a
service when the original one did. Then the node must say what the original said.
"""

import itertools
import json
import pathlib
from typing import Any, Iterator, List, Optional, Tuple

import yaml
from geometry_msgs.msg import Pose2D
from support.comm_case import GOALS, NUMBERS, SAYS_EXECUTE, SAYS_PREPARE, SAYS_STOP, ChannelCase
from support.raw_box import RawBox

from roah_rsbb.comm.ciphers import Key
from roah_rsbb.comm.frame import decode_private, decode_public
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import RobotState
from roah_rsbb.srv import Bool, Percentage, String

DATA = pathlib.Path(__file__).resolve().parents[2] / "data"
PASSWORD, TEAM, ROBOT = "PASSWORD", "TestingTeam", "TestingRobot"
BOX, PUBLIC_PORT = "10.99.0.1", 6666
# What the node's documentation calls the robot's states.
SAID_AS = {
    RobotState.STOP: SAYS_STOP, RobotState.PREPARING: SAYS_PREPARE, RobotState.WAITING_GOAL: SAYS_PREPARE,
    RobotState.EXECUTING: SAYS_EXECUTE, RobotState.RESULT_TX: SAYS_EXECUTE,
}
# The robot's own steps -> the service with which its owner makes them.
OWN_STEPS = {
    (RobotState.PREPARING, RobotState.WAITING_GOAL): "end_prepare",
    (RobotState.EXECUTING, RobotState.RESULT_TX): "end_execute",
}
COMMANDS = ("devices_switch_1", "devices_dimmer", "devices_blinds", "tablet_display_map")


def recording(name: str) -> Iterator[Tuple[bool, Any]]:
    """(from the box, message) of a session, in order."""
    key = Key(PASSWORD)
    for record in json.loads((DATA / f"{name}.json").read_text(encoding="utf-8")):
        datagram = bytes.fromhex(record["hex"])
        public = record["dport"] == PUBLIC_PORT
        yield record["src"] == BOX, decode_public(datagram) if public else decode_private(datagram, key)


def news(values) -> List[Any]:
    """Remove consecutive repetitions."""
    return [value for value, _ in itertools.groupby(values)]


class TestRecordings(ChannelCase):
    def new_box(self, **how: object) -> RawBox:
        return super().new_box(**how) if how else self._leaving(RawBox(self.network, TEAM, ROBOT, PASSWORD))

    def test_these_are_all_recordings(self) -> None:
        recorded = {path.stem for path in DATA.glob("*_20[0-9][0-9].json")}
        self.assertEqual({f"test_{name}" for name in recorded} - set(dir(self)), set())

    def test_HCFGAC_2015(self) -> None:
        self.session("HCFGAC_2015")
        self.assertEqual((list(self.commands.values()), self.strings), ([True, 70, 100, True], ["open the blinds"]))

    def test_HGTKMH_2015(self) -> None:
        self.session("HGTKMH_2015")

    def test_HGTKMH_2020(self) -> None:
        self.session("HGTKMH_2020")

    def test_HNF_2020(self) -> None:
        self.session("HNF_2020")

    def test_STB_2020(self) -> None:
        self.session("STB_2020")

    def test_TIMEOUT_2015(self) -> None:
        self.session("TIMEOUT_2015")

    def session(self, name: str) -> None:
        self.port: Optional[int] = None
        self.state, self.commands = RobotState.STOP, dict.fromkeys(COMMANDS)
        self.strings: List[str] = []
        messages = list(recording(name))
        code = next(m.benchmark_type for box, m in messages if isinstance(m, pb.BenchmarkState))
        for heard in (self.states, self.benchmarks):
            heard.messages.clear()
        goals = self.heard("goal", GOALS[code]) if code in GOALS else None
        last = None
        for from_box, message in messages:
            if isinstance(message, pb.RobotState):
                self.robot_says(message)
            elif isinstance(message, pb.RoahRsbbBeacon):
                self.box_beacons(message)
            elif from_box and self.port is not None:
                message.ClearField("acknowledgement")
                if last is None:
                    self.box_says(message)
                    self.wait_said(SAYS_STOP)
                    if goals is not None:
                        goals.wait_connected()
                elif message != last:
                    self.box_says(message)
                last = message
        self.wait_benchmark(0)
        self.assertEqual([m.benchmark for m in self.benchmarks.messages], [NUMBERS[code], 0])
        original = [SAID_AS[RobotState(m.robot_state)] for _, m in messages if isinstance(m, pb.RobotState)]
        self.assertEqual(self.said, news([SAYS_STOP, *original]))
        if goals is not None:
            sent = [m.generic_goal for box, m in messages if isinstance(m, pb.BenchmarkState) and m.generic_goal]
            expected = [GOALS[code](text) if code == "STB" else Pose2D(*yaml.safe_load(text)) for text in news(sent)]
            self.assertGreater(len(expected), 1)
            goals.wait_count(len(expected))
            self.assertEqual(goals.messages, expected)
            goals.close()

    def box_beacons(self, message: pb.RoahRsbbBeacon) -> None:
        """A message without news publishes nothing, as in the original."""
        listed = bool(message.benchmarking_teams)
        self.box.beacon_message.CopyFrom(message)
        if listed and self.port is None:
            self.port = self.new_port()
            self.box.run(self.port)
        else:
            self.box.beacon(self.port if listed else None)

    def box_says(self, message: pb.BenchmarkState) -> None:
        fields = {field.name: value for field, value in message.ListFields()}
        self.box.send(fields.pop("benchmark_type"), fields.pop("benchmark_state"), **fields)

    def robot_says(self, message: pb.RobotState) -> None:
        """The node reports it, too, after the same actions of its owner."""
        after = RobotState(message.robot_state)
        service = OWN_STEPS.get((self.state, after))
        if service is not None:
            self.call(service)
        self.state = after
        self.command(message)
        said = self.box.wait_state(after)
        if self.benchmarks.messages:
            self.wait_said(SAID_AS[after])
        for field in COMMANDS:
            self.assertEqual(getattr(said, field), getattr(message, field), field)

    def command(self, message: pb.RobotState) -> None:
        """The owner's commands and strings, when they are new."""
        for field in COMMANDS:
            value = getattr(message, field)
            if value != self.commands[field] and message.HasField(field):
                if field == "tablet_display_map":
                    self.call("tablet/map" if value else "tablet/buttons")
                else:
                    kind = Bool if field == "devices_switch_1" else Percentage
                    self.call(f"{field.replace('devices_', 'devices/')}/set", kind, value)
                self.commands[field] = value
                self.box.wait_received(lambda m, f=field, v=value: getattr(m, f) == v, f"{field} is sent")
        for text in message.final_command:
            if text not in self.strings:
                self.strings.append(text)
                self.call("final_command", String, text)
                self.box.wait_received(lambda m, t=text: list(m.final_command) == [t], "the string is sent")
