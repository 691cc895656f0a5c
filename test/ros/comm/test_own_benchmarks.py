"""Benchmarks that only the competition's folder defines, from connect to the end, with robots of each kind."""

import json
from typing import Dict, List

import rospy
from std_msgs.msg import String as StringMsg
from std_msgs.msg import UInt32
from std_srvs.srv import Empty
from support.box_case import PACKAGE
from support.comm_case import Heard
from support.dummy_launch import DummyRobot
from support.modules_case import FunctionalityCase
from support.programs import Program
from support.robots import BROADCAST, PASSWORDS, RSBB_PORT, host_of
from support.waiting import LIMIT_S

from roah_rsbb.msg import Benchmark, BenchmarkState
from roah_rsbb.srv import String

ITEM = ("Achievements", "Puts an object at its place")
OTHER = 255


class OwnBenchmarks(FunctionalityCase):
    def mark_and_leave(self, zone: str):
        """The referee scores the task that the robot completed."""
        self.box.wait_details(zone, lambda d: d.end_reason == "completed", "the robot completed the task")
        self.box.set_score(zone, *ITEM, 3)
        return self.leave(zone)


class TestDummyRobots(OwnBenchmarks):
    def test_with_ros(self) -> None:
        robot = self._leaving(DummyRobot("Alpha", execute_duration=0.3))
        self.begin("SetTable Alpha")
        log = self.mark_and_leave("SetTable Alpha")
        self.assertEqual(log.values("/notification"), ["on my way"])
        scores, log = self.conduct("FetchMug Alpha")
        self.assertEqual((scores["", "fetched"], self.of_each(scores, "result")), (0, ["SOME RESULT"] * 2))
        self.assertEqual(log.values("/notification"), ["on my way"] * 2)
        robot.wait_printed("FetchMug: executing '{fetch: red}'")
        robot.wait_printed("FetchMug: executing '{fetch: blue}'")
        self.assertEqual(robot.warnings, [])
        self.assertNotIn("Traceback", robot.text)

    def test_without_ros(self) -> None:
        robot = self.dummy_robot("Delta")
        self.begin("SetTable Delta")
        self.mark_and_leave("SetTable Delta")
        scores, _ = self.conduct("FetchMug Delta")
        self.assertEqual(self.of_each(scores, "result"), ["SOME RESULT"] * 2)
        robot.wait_printed("FetchMug: executing '{fetch: red}'")


class TestClientWithoutRos(OwnBenchmarks):
    def test_a_task(self) -> None:
        robot = self.robot("Epsilon", prepares=False)
        self.begin("SetTable Epsilon")
        robot.wait_did("prepare SetTable")
        robot.let("prepare")
        robot.wait_did("execute SetTable")
        self.assertIsNone(robot.goals[-1])
        robot.request("notify", "the table is set")
        robot.wait_said()
        robot.let("execute")
        log = self.mark_and_leave("SetTable Epsilon")
        self.assertEqual(log.values("/notification"), ["the table is set"])
        robot.wait_did("stop")

    def test_a_goal_and_its_result_are_json(self) -> None:
        robot = self.robot("Gamma", messages_saved=0)  # this benchmark needs no offline data
        self.begin("FetchMug Gamma")
        after = self.answer("FetchMug Gamma")
        for colour, times in (("red", 1), ("blue", 2)):
            robot.wait_did("execute FetchMug", times)
            self.assertEqual(robot.goals[-1].text, f"{{fetch: {colour}}}")
            self.box.wait_zone("FetchMug Gamma", lambda z: z.timeout.to_sec() == 20.0, "the goal has its timeout")
            # A result that fills its datagram.
            robot.result = json.dumps({"colour": colour, "way": "x" * 850})
            robot.let("execute")
            if times == 1:
                after = self.answer("FetchMug Gamma", after)
        scores, _ = self.to_the_end("FetchMug Gamma", after)
        self.assertEqual(scores["", "fetched"], 2)


class TestTeamsProgram(OwnBenchmarks):
    """The test is the program that a team writes: it knows its benchmarks by their names."""

    def setUp(self) -> None:
        super().setUp()
        self.comm = self._leaving(Program(
            "roslaunch", PACKAGE, "robot_comm.launch", "team_name:=Beta", "robot_name:=Own",
            f"rsbb_key:={PASSWORDS['Beta']}", f"rsbb_host:={BROADCAST}", f"rsbb_port:={RSBB_PORT}",
            f"bind_host:={host_of('Beta')}",
        ))
        saved = rospy.Publisher("/roah_rsbb/messages_saved", UInt32, queue_size=1, latch=True)
        self.addCleanup(saved.unregister)
        saved.publish(7)
        self.topics: Dict[str, Heard] = {}
        for name, kind in (("benchmark", Benchmark), ("benchmark/name", StringMsg), ("benchmark/state", BenchmarkState),
                           ("goal/text", StringMsg)):
            self.topics[name] = Heard(name, kind)
            self.addCleanup(self.topics[name].close)

    def call(self, name: str, kind: type = Empty, *request: object) -> None:
        rospy.wait_for_service(f"/roah_rsbb/{name}", LIMIT_S)
        rospy.ServiceProxy(f"/roah_rsbb/{name}", kind)(*request)

    def wait_state(self, state: int) -> None:
        self.topics["benchmark/state"].wait_last(lambda m: m.benchmark_state == state, f"state {state}")

    def prepare(self) -> None:
        self.wait_state(BenchmarkState.PREPARE)
        self.call("end_prepare")
        self.wait_state(BenchmarkState.EXECUTE)

    def names(self) -> List[str]:
        return [message.data for message in self.topics["benchmark/name"].messages]

    def test_task_and_functionality(self) -> None:
        self.begin("SetTable Beta")
        self.topics["benchmark/name"].wait_last(lambda m: m.data == "SetTable", "the name of the task")
        self.topics["benchmark"].wait_last(lambda m: m.benchmark == OTHER, "the number of other benchmarks")
        self.prepare()
        self.topics["goal/text"].wait_last(lambda m: m.data == "", "there is no goal")
        self.call("notifications", String, "on my way")
        self.call("end_execute", String, "")
        log = self.mark_and_leave("SetTable Beta")
        self.assertEqual(log.values("/notification"), ["on my way"])
        self.topics["benchmark/name"].wait_last(lambda m: m.data == "", "the task is over")

        self.begin("FetchMug Beta")
        self.topics["benchmark/name"].wait_last(lambda m: m.data == "FetchMug", "the name of the next benchmark")
        after = self.answer("FetchMug Beta")
        self.fetch("red", '{"colour": "red"}')
        after = self.answer("FetchMug Beta", after)
        self.fetch("blue", '{"colour": "green"}')
        scores, _ = self.to_the_end("FetchMug Beta", after)
        self.assertEqual(scores["", "fetched"], 1)
        self.assertEqual(self.of_each(scores, "result"), ['{"colour": "red"}', '{"colour": "green"}'])
        self.assertEqual([name for name in self.names() if name], ["SetTable", "FetchMug"])

    def fetch(self, colour: str, result: str) -> None:
        self.prepare()
        self.topics["goal/text"].wait_last(lambda m: m.data == f"{{fetch: {colour}}}", f"the goal {colour}")
        with self.assertRaisesRegex(rospy.ServiceException, "at most 900"):
            self.call("end_execute", String, "x" * 900)
        self.call("end_execute", String, result)
