"""The box's reactions to attacks and mistakes, as in docs/security.md, with real datagrams and processes."""

import contextlib
import os
import pathlib
import socket
import time
from typing import Callable, Dict, List, Optional

import rospy
from rosgraph_msgs.msg import Log
from support.box_case import CORE, BoxCase
from support.connections import wait_sends
from support.robots import BOX, PASSWORDS, RSBB_PORT, host_of, wire
from support.waiting import happened, wait_until

from helpers.box_beacon import box_beacon
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.comm.frame import encode
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState

ATTACKER = "127.0.0.9"
STOP, PREPARE, WAITING_RESULT = BoxState.STOP, BoxState.PREPARE, BoxState.WAITING_RESULT


class Attacker:
    """Sends arbitrary datagrams to the box from its own address."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind((ATTACKER, 0))

    def close(self) -> None:
        """Close the sockets without a last message."""
        self._socket.close()

    def send(self, port: int, message: object, team: Optional[str] = None) -> None:
        """Send a message, either plain or encrypted with that team's password."""
        sealed = (Cipher.NONE,) if team is None else (Cipher.AES_128_CBC, Key(PASSWORDS[team]))
        self._socket.sendto(encode(message, *sealed), (BOX, port))


def result_of(time_s: float) -> pb.RobotState:
    """A message that would end a run: the robot has finished."""
    return pb.RobotState(
        time=wire(time_s), messages_saved=9, robot_state=int(RobotState.RESULT_TX), notifications=["forged"],
    )


class TestAttacks(BoxCase):
    def setUp(self) -> None:
        super().setUp()
        self.said: List[str] = []  # in the nodes' logs
        subscriber = rospy.Subscriber("/rosout", Log, self._on_log)
        self.addCleanup(subscriber.unregister)
        wait_sends(CORE, subscriber)

    def _on_log(self, log: Log) -> None:
        self.said.append(log.msg)
        happened()

    def reported(self, text: str, meanwhile: Callable[[], object] = lambda: None) -> None:
        """Wait until the box reports it; then it has read the datagram."""
        wait_until(lambda: (meanwhile(), any(text in said for said in self.said))[1],
                   lambda: f"the box reports '{text}': {self.said}")

    def test_no_other_program_moves_a_run(self) -> None:
        box, robot = self.box, self.robot("Epsilon")
        attacker = self._leaving(Attacker())
        port = box.connect("Attacked")
        box.start("Attacked")
        robot.wait_did("execute HGTKMH")
        box.wait_details("Attacked", lambda d: d.box_state == "WAITING_RESULT", "the robot executes")

        attacker.send(port, result_of(time.time() + 10.0))
        self.reported("not encrypted")
        attacker.send(port, result_of(time.time() + 10.0), team="Alpha")
        self.reported("does not decrypt")
        attacker.send(port, result_of(time.time() - 3600.0), team="Epsilon")  # recorded an hour ago

        # While the robot is heard: after a silence of a few seconds another address may replace it.

        def attack_after_the_robot() -> None:
            robot.client.notify("here")
            self.network.loop.call_soon(attacker.send, port, result_of(time.time() + 10.0), "Epsilon")

        self.network.do(attack_after_the_robot)
        self.reported(f"also come from {ATTACKER}. They are ignored: the robot is at {host_of('Epsilon')}")
        # A robot that is in a run is known by what it says there.
        self.reported("Two robots call themselves Robot of team Epsilon", lambda: attacker.send(
            RSBB_PORT, pb.RobotBeacon(team_name="Epsilon", robot_name="Robot", time=wire(time.time() + 9.0))))
        attacker.send(RSBB_PORT, box_beacon())
        self.reported(f"ANOTHER RSBB is transmitting from {ATTACKER}")
        attacker.send(port, pb.BenchmarkState(benchmark_type="HGTKMH", benchmark_state=0), team="Epsilon")

        details = box.zone_details("Attacked")
        self.assertEqual((details.phase, details.box_state), ("running", "WAITING_RESULT"))
        robot.let("execute")
        box.wait_text("Attacked", "Benchmark completed by the robot")
        log = self.leave("Attacked")
        self.assertEqual(log.values("/rsbb_log/rsbb_state"), [STOP, PREPARE, WAITING_RESULT, STOP])
        self.assertNotIn("forged", log.values("/rsbb_log/notification"))

    def test_a_name_commands_no_terminal_and_forges_no_line(self) -> None:
        attacker = self._leaving(Attacker())
        # No other case has this team: the box would still list this robot beside that of the case.
        name = "\x1b[2Jred\n[ERROR] forged"
        attacker.send(RSBB_PORT, pb.RobotBeacon(team_name="Eta", robot_name=name, time=wire(time.time())))
        self.reported("Robot \\x1b[2Jred\\n[ERROR] forged of team Eta is active")
        self.assertFalse([said for said in self.said if "\x1b" in said or "\n[ERROR]" in said])


class TestTexts(BoxCase):
    def test_a_text_of_megabytes_is_refused_before_anything_is_done_with_it(self) -> None:
        for size in (5_001, 10_000_000):
            reason = self.box.refusal("stop", "H" * size)
            self.assertEqual(reason, f"zone has {size} characters: at most 5000 are accepted")


class TestPasswords(BoxCase):
    def setUp(self) -> None:
        super().setUp()
        self.published: Dict[str, bytes] = {}  # by topic
        subscribers = [
            rospy.Subscriber(topic, rospy.AnyMsg, self._on_message, topic)
            for topic, _ in rospy.get_published_topics()
        ]
        for subscriber in subscribers:
            self.addCleanup(subscriber.unregister)

    def _on_message(self, message: object, topic: str) -> None:
        # Where this process follows a topic already, rospy hands its message over read.
        raw = isinstance(message, rospy.AnyMsg)
        data = message._buff if raw else str(message).encode()
        self.published[topic] = self.published.get(topic, b"") + data
        happened()

    def test_passwords_are_in_their_file_and_nowhere_else(self) -> None:
        box, robot = self.box, self.robot("Gamma")
        guessing = self.robot("Delta", password="no password of Delta")
        box.connect("Secrets")
        box.start("Secrets")
        robot.wait_did("execute HWV")
        robot.request("notify", "all is well")
        robot.wait_said()
        wait_until(lambda: b"all is well" in self.published.get("/core/to_gui", b""), "the topics are heard")
        box.connect("Guessed")
        box.wait_details(
            "Guessed", lambda d: any("password" in r for r in d.off("start")),
            "the referee sees the reason")
        robot.let("execute")
        box.wait_text("Secrets", "Benchmark completed by the robot")
        log_dir = pathlib.Path(rospy.get_param("/roah_rsbb_core/log_dir"))
        self.leave("Secrets")
        self.leave("Guessed")
        guessing.close()

        places = {f"topic {topic}": data for topic, data in self.published.items()}
        places["parameters"] = str(rospy.get_param("/")).encode()
        places.update(_files(log_dir))
        places.update(_files(pathlib.Path(os.environ["ROS_LOG_DIR"])))
        places.update(_processes())
        self.assertTrue(any(b"roah_rsbb_core" in data for place, data in places.items() if "process" in place))
        self.assertTrue(any(b"all is well" in data for place, data in places.items() if "/journal-" in place))
        for password in PASSWORDS.values():
            for place, data in places.items():
                self.assertNotIn(password.encode(), data, place)


def _files(folder: pathlib.Path) -> Dict[str, bytes]:
    """All files in a folder and below, except those that are removed or renamed at this moment."""
    found: Dict[str, bytes] = {}
    for path in folder.rglob("*"):
        with contextlib.suppress(FileNotFoundError, IsADirectoryError):
            found[f"file {path}"] = path.read_bytes()
    return found


def _processes() -> Dict[str, bytes]:
    """Command lines and environments of all processes that belong to this ROS master: what lists of processes show."""
    ours = f"ROS_MASTER_URI={os.environ['ROS_MASTER_URI']}".encode()
    found: Dict[str, bytes] = {}
    candidates: List[pathlib.Path] = [path for path in pathlib.Path("/proc").iterdir() if path.name.isdigit()]
    for path in candidates:
        try:
            environment = (path / "environ").read_bytes()
            if ours in environment.split(b"\0"):
                found[f"process {path.name}"] = (path / "cmdline").read_bytes() + environment
        except OSError:
            continue  # it is gone, or somebody else's
    return found
