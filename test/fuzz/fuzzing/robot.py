"""The robot's side: messages of a box, or of a false one, to a robot."""

from typing import Iterator, List

from fuzzing.reader import Reader
from fuzzing.target import Step, Target
from helpers.box_beacon import box_beacon
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.robot.goals import BadGoal, read_goal
from roah_rsbb.robot.machine import IllegalEvent
from roah_rsbb.robot.session import Session

BOX = ("10.0.0.1", 6666)
HOSTS = (BOX[0], "10.0.0.9")
_CODES = ("HGTKMH", "HWV", "HNF", "HGMF", "HOMF", "STB", "HOPF", "XX", "")
_PASSED_S = (0.0, 0.05, 1.0, 6.0)
_UTC0 = 1_800_000_000.0


class Play:
    """A robot in a run, and the messages that it receives."""

    def __init__(self, data: bytes) -> None:
        self.reader = Reader(data)
        self.now = 100.0
        self.session = Session("Team", "Robot", self.now)
        self._beacon(6667, BOX)
        self._poll()

    def _poll(self) -> None:
        for effect in self.session.poll(self.now, _UTC0 + self.now):
            message = getattr(effect, "message", None)
            if message is not None and hasattr(message, "SerializeToString"):
                message.SerializeToString()

    def _beacon(self, port: int, sender) -> None:
        self.session.public_message(self.now, box_beacon(("Team", "Robot", port)), sender)

    def steps(self) -> Iterator[Step]:
        """Pass the messages to the robot one by one, and check its effects."""
        acts = (self._hear_state, self._hear_state, self._hear_state, self._hear_beacon, self._hear_other, self._own)
        while self.reader:
            self.now += self.reader.choice(_PASSED_S)
            yield self.reader.choice(acts)()
            yield self._poll
            assert self.session.deadline() > self.now - 1e-9

    def _sender(self):
        return self.reader.choice(HOSTS), self.reader.integer(signed=False, size=2)

    def _hear_state(self) -> Step:
        r = self.reader
        message = pb.BenchmarkState(benchmark_type=r.choice(_CODES), benchmark_state=r.byte() % 4)
        if r.flag():
            message.acknowledgement.sec, message.acknowledgement.nsec = r.integer(), r.integer()
        if r.flag():
            message.generic_goal = r.text()
        if r.flag():
            message.target_pose_x, message.target_pose_y, message.target_pose_theta = r.double(), r.double(), r.double()
        message.switches.extend(r.list_of(lambda: r.integer(signed=False, size=4)))
        message.initial_state.extend(r.list_of(r.flag))
        sender = self._sender()
        return lambda: self.session.private_message(self.now, message, sender)

    def _hear_beacon(self) -> Step:
        port, sender = self.reader.integer(signed=False, size=4), self._sender()
        return lambda: self._beacon(port, sender)

    def _hear_other(self) -> Step:
        r = self.reader
        sender = self._sender()
        time = pb.Time(sec=r.integer(), nsec=r.integer())
        return r.choice((
            lambda: self.session.private_undecodable(self.now, sender[0]),
            lambda: self.session.channel_failed("in use"),
            lambda: self.session.public_message(
                self.now, pb.RobotBeacon(team_name="Team", robot_name="Robot", time=time), sender),
            lambda: self.session.private_message(
                self.now, pb.RobotState(time=time, messages_saved=0, robot_state=0), sender),
        ))

    def _own(self) -> Step:
        r = self.reader
        text, value = r.text(), r.byte()
        act = r.choice((
            self.session.end_prepare, lambda: self.session.end_execute(text),
            lambda: self.session.add_string("notifications", text), lambda: self.session.set_device("dimmer", value),
        ))

        def do() -> None:
            try:
                act()
            except (IllegalEvent, ValueError) as error:
                assert str(error)
        return do


def session_steps(data: bytes) -> Iterator[Step]:
    """Everything that happens to a robot."""
    return Play(data).steps()


def goal_steps(data: bytes) -> Iterator[Step]:
    """A goal is read, or BadGoal."""
    reader = Reader(data)
    message = pb.BenchmarkState(benchmark_type=reader.choice(_CODES), benchmark_state=2)
    if reader.flag():
        message.target_pose_x, message.target_pose_y, message.target_pose_theta = (reader.double() for _ in range(3))
    message.generic_goal = reader.rest().decode("utf-8", "ignore")

    def read() -> None:
        try:
            goal = read_goal(message)
        except BadGoal as bad:
            assert len(str(bad)) < 1000
            return
        if goal.pose is not None:
            assert all(abs(part) < float("inf") for part in goal.pose)

    yield read


def session_seeds() -> List[bytes]:
    """Runs of several benchmarks, and senders that are not the box."""
    states = bytes([0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0])
    goal = bytes([1, 0, 2, 2, 0, 1, 9]) + b"[1, 2, 3]" + bytes([0, 0, 0, 0, 0])
    return [
        b"", bytes(range(256)), states * 4, states + goal, states + bytes([0, 5, 0, 0, 0]) + goal,
        bytes([3, 3, 7, 0, 0]) * 3, bytes([2, 4, 1, 0, 200, 200, 2]) * 3, goal.replace(b"\x09[1, 2, 3]", b"\xff[1, "),
    ]


def goal_seeds() -> List[bytes]:
    """Goals as boxes send them, and invalid ones."""
    texts = (
        b"[1.0, 2.0, 3.0]", b"- 1\n- 2\n- 3\n", b"--- [1, 2, 3]", b"[1, 2, 65535]", b"[1e999, 0, 0]", b"[1, 2]", b"",
        b"[" * 190, b"[ " + b" " * 190, b"[" + b"9" * 199, b"- " + b"\n" * 190, b"[1,2,3" + b" " * 60_000,
        b"[1e99999,1,1]", "[١, ٢, ٣]".encode(),
    )
    return [bytes([code, 0]) + text for text in texts for code in (2, 3, 5)] + [b"\x02\x01\xc0\x7f\xf8\0\0\0\0\0\0"]


SESSION = Target("session", session_steps, session_seeds, tuple(bytes([kind]) for kind in range(6)))
GOALS = Target("goals", goal_steps, goal_seeds, (
    b"[", b"]", b",", b"- ", b"\n", b"---", b"1e999", b".5", b"nan", b"\t", b"+", b"e",
))
