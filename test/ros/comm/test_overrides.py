"""The override sequences of the comm node's documentation, for every benchmark, in one running node."""

import rospy
from geometry_msgs.msg import Pose2D
from rosgraph_msgs.msg import Log
from std_msgs.msg import String as StringMsg
from std_msgs.msg import UInt32
from support.box_case import LISTENER
from support.comm_case import (
    ALWAYS,
    GOAL_TX,
    GOALS,
    NUMBERS,
    PREPARE,
    SAYS_EXECUTE,
    SAYS_PREPARE,
    SAYS_STOP,
    STOP,
    WAITING_RESULT,
    CommCase,
    CommRefusal,
    reported_with,
)
from support.programs import Program
from support.waiting import wait_until

from roah_rsbb.msg import Benchmark, BenchmarkState, GoalOMF
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.srv import Bool, OverrideGoal, Percentage, ResultHOPF, ResultHPPF, String

_EMPTY, _STRING = "std_srvs/Empty", "roah_rsbb/String"
# Services that there are only in one benchmark, with their types.
OWN = {
    "HWV": dict.fromkeys(("notifications", "activation_event", "visitor"), _STRING),
    "HNF": {"notifications": _STRING},
    "HOMF": {"notifications": _STRING},
    "HCFGAC": {
        "final_command": _STRING,
        **{f"devices/{switch}/{word}": _EMPTY for switch in ("switch_1", "switch_2", "switch_3")
           for word in ("on", "off")},
        **{f"devices/{switch}/set": "roah_rsbb/Bool" for switch in ("switch_1", "switch_2", "switch_3")},
        **{f"devices/{device}/{word}": _EMPTY for device in ("blinds", "dimmer") for word in ("max", "min")},
        **{f"devices/{device}/set": "roah_rsbb/Percentage" for device in ("blinds", "dimmer")},
        "tablet/buttons": _EMPTY, "tablet/map": _EMPTY,
    },
}
RESULTS = {
    "HOPF": ("roah_rsbb/ResultHOPF", ResultHOPF, ("cups", "red_cup", Pose2D(0.1, 0.2, 1.23))),
    "HPPF": ("roah_rsbb/ResultHPPF", ResultHPPF, ("Annie", Pose2D(0.1, 0.2, 1.23))),
}


class OverrideCase(CommCase):
    def setUp(self) -> None:
        super().setUp()
        self.addCleanup(self.end_override)  # the next case begins without

    def tearDown(self) -> None:
        self.assertEqual(self.logged(Log.ERROR) + self.logged(Log.FATAL), [], "nothing here is the node's fault")

    def wait_would_send(self, *parts: str, since: int = 0) -> str:
        return self.wait_logged(Log.DEBUG, "Not sent, because of the override: RobotState", *parts, since=since)


class TestSequences(OverrideCase):
    """Each sequence, with the topics and services that must exist or not exist at each moment."""

    def test_each_benchmark_in_one_node(self) -> None:
        self.assertEqual((self.services, self.published), (set(), ALWAYS))
        self.assertEqual(self.type_of("override"), "roah_rsbb/Override")
        self.assertEqual([m.benchmark for m in self.benchmarks.messages], [Benchmark.NONE])
        # The topic of goals has another type each time.
        said = [SAYS_STOP]
        codes = ["HNF", "HGMF", "HOMF", "STB", *(code for code in NUMBERS if code not in GOALS), "HNF"]
        for code in codes:
            with reported_with(code):
                self.begin(code)
                self.one_goal(code)
                if code in GOALS:
                    self.one_goal(code)
                self.override(NUMBERS[code], STOP)
                self.wait_said(SAYS_STOP)
                goals = [SAYS_PREPARE, SAYS_EXECUTE] * (2 if code in GOALS else 1)
                said += [*goals, SAYS_STOP]
                self.assertEqual(self.said, said)
                self.assertEqual(self.services, set(OWN.get(code, {})))
        self.end_override()
        self.assertEqual((self.services, self.published), (set(), ALWAYS))
        self.assertNotIn("/roah_rsbb/messages_saved", self.subscribed)
        self.assertEqual([m.benchmark for m in self.benchmarks.messages], [0, *(NUMBERS[c] for c in codes), 0])

    def begin(self, code: str) -> None:
        """The benchmark starts in stop state."""
        self.override(NUMBERS[code], STOP)
        self.wait_benchmark(NUMBERS[code])
        # Who hears of the benchmark finds all that belongs to it.
        own = OWN.get(code, {})
        self.assertEqual({name: self.type_of(name) for name in self.services}, own)
        goal = {"goal": GOALS[code]._type, "goal/text": "std_msgs/String"} if code in GOALS else {}
        self.assertEqual(self.published, {**ALWAYS, "benchmark/state": "roah_rsbb/BenchmarkState", **goal})
        self.assertIn("messages_saved", self.subscribed)
        self.wait_said(SAYS_STOP)
        self.late(NUMBERS[code], SAYS_STOP)

    def one_goal(self, code: str) -> None:
        """Override from PREPARE until the goal is completed. Each state is repeated, as the box does."""
        own, number = set(OWN.get(code, {})), NUMBERS[code]
        end_type, end_kind, result = RESULTS.get(code, (_EMPTY, None, ()))
        self.override(number, PREPARE)
        self.wait_said(SAYS_PREPARE)
        self.assertEqual(self.services, own | {"end_prepare"})
        self.assertEqual(self.type_of("end_prepare"), _EMPTY)
        self.override(number, PREPARE)
        self.late(number, SAYS_PREPARE)
        self.call("end_prepare")
        self.wait_services(*own)
        self.override(number, PREPARE)

        self.override(number, GOAL_TX)
        self.wait_said(SAYS_EXECUTE)
        self.assertEqual(self.services, own | {"end_execute"})
        self.assertEqual(self.type_of("end_execute"), end_type)
        self.override(number, WAITING_RESULT)
        if end_kind is None:
            self.call("end_execute")
        else:
            self.call("end_execute", end_kind, *result)
        self.wait_services(*own)
        self.override(number, WAITING_RESULT)
        self.late(number, SAYS_EXECUTE)

    def late(self, number: int, state: int) -> None:
        """A new listener receives the last message of both topics."""
        self.assertEqual(self.latched("benchmark", Benchmark).benchmark, number)
        self.assertEqual(self.latched("benchmark/state", BenchmarkState).benchmark_state, state)


class TestCommandLine(OverrideCase):
    """The commands of the documentation, unchanged."""

    def rosservice(self, *words: str) -> str:
        """Run rosservice call. Returns its output."""
        program = Program("rosservice", "call", *words)
        self.addCleanup(program.close)
        program.wait_ended()
        # Of ROS itself, on a busy machine: somebody who wanted to look at it was gone before it answered.
        return "\n".join(line for line in program.lines if "Inbound TCP/IP connection failed" not in line).strip()

    def commanded_override(self, number: int, state: int) -> None:
        text = f"{{benchmark_type: {number}, benchmark_state: {state}}}"
        self.assertEqual(self.rosservice("/roah_rsbb/override", text), "")

    def test_object_perception(self) -> None:
        self.log_sent()
        self.commanded_override(4, 0)
        self.wait_benchmark(4)
        self.commanded_override(4, 1)
        self.wait_said(SAYS_PREPARE)
        self.assertIn("not available", self.rosservice("/roah_rsbb/end_execute"))
        self.assertEqual(self.rosservice("/roah_rsbb/end_prepare"), "")
        self.commanded_override(4, 2)
        self.wait_said(SAYS_EXECUTE)
        self.assertIn("not available", self.rosservice("/roah_rsbb/end_prepare"))
        self.commanded_override(4, 3)
        result = "{object_class: cups, object_name: red_cup, object_pose: {x: 0.1, y: 0.2, theta: 1.23} }"
        self.assertEqual(self.rosservice("/roah_rsbb/end_execute", result), "")
        sent = self.wait_would_send("RESULT_TX")
        for part in ('object_class: "cups"', 'object_name: "red_cup"', "object_pose_x: 0.1", "object_pose_y: 0.2",
                     "object_pose_theta: 1.23",
                     r'generic_result: "{class: \"cups\", instance: \"red_cup\", x: 0.1, y: 0.2, theta: 1.23}"'):
            self.assertIn(part, sent)
        self.commanded_override(4, 0)
        self.wait_said(SAYS_STOP)
        self.assertEqual(self.rosservice("/roah_rsbb/override", "{benchmark_type: 0}"), "")
        self.wait_benchmark(0)
        self.assertEqual(self.said, [SAYS_STOP, SAYS_PREPARE, SAYS_EXECUTE, SAYS_STOP])


class TestWhatWouldBeSent(OverrideCase):
    """The debug output, and that nothing leaves while somebody else plays the box."""

    def setUp(self) -> None:
        super().setUp()
        self.log_sent()

    def test_nothing_is_sent_and_then_it_is_again(self) -> None:
        listener = self.participant(LISTENER)

        def beacons() -> int:
            return sum(isinstance(message, pb.RobotBeacon) for message, _ in listener.heard)

        wait_until(lambda: beacons() > 1, "the robot sends beacons")
        self.wait_logged(Log.DEBUG, "Sent: RobotBeacon", 'team_name: "Alpha"', 'robot_name: "Robot"')
        self.override(NUMBERS["HGTKMH"], PREPARE)
        self.wait_would_send("robot_state: PREPARING")
        self.network.read_all()
        before, logged = beacons(), len(self.log)
        # A burst, and then one each second: longer than between two beacons.
        wait_until(lambda: len(self.logged(Log.DEBUG, logged)) > 13, "the state would be sent again and again")
        self.assertEqual([text for text in self.logged(Log.DEBUG, logged) if text.startswith("Sent")], [])
        self.assertEqual(beacons(), before)
        self.end_override()
        wait_until(lambda: beacons() > before, "the robot sends beacons again")

    def test_commands_of_devices_and_tablet(self) -> None:
        self.override(NUMBERS["HCFGAC"], STOP)
        for switch in ("switch_1", "switch_2", "switch_3"):
            for word, request, value in (("on", (), "true"), ("off", (), "false"), ("set", (Bool, True), "true"),
                                         ("set", (Bool, False), "false")):
                self.commanded(f"devices/{switch}/{word}", request, f"devices_{switch}: {value}")
        for device in ("dimmer", "blinds"):
            for word, request, value in (("max", (), 100), ("min", (), 0), ("set", (Percentage, 35), 35)):
                self.commanded(f"devices/{device}/{word}", request, f"devices_{device}: {value}")
            with self.assertRaisesRegex(CommRefusal, f"{device} takes a whole percentage from 0 to 100, not 101"):
                self.call(f"devices/{device}/set", Percentage, 101)
        self.commanded("tablet/map", (), "tablet_display_map: true")
        self.commanded("tablet/buttons", (), "tablet_display_map: false")
        self.commanded("final_command", (String, "close the blinds"), 'final_command: "close the blinds"')
        last = self.logged(Log.DEBUG)[-1]
        self.assertIn("devices_dimmer: 35", last)  # commands stay
        # Of the next run they are not.
        before = self.end_override_in_log()
        self.override(NUMBERS["HCFGAC"], STOP)
        self.assertNotIn("devices", self.wait_would_send(since=before))

    def end_override_in_log(self) -> int:
        """End the override, and return the number of log entries up to a message after it."""
        before = len(self.log)
        self.end_override()
        self.wait_logged(Log.DEBUG, "Sent: RobotBeacon", since=before)
        return len(self.log)

    def commanded(self, service: str, request: tuple, field: str) -> None:
        before = len(self.log)
        self.call(service, *request)
        self.wait_would_send(field, since=before)

    def test_messages_saved(self) -> None:
        topic = rospy.Publisher("/roah_rsbb/messages_saved", UInt32, queue_size=1, latch=True)
        topic.publish(7)
        for code in ("HGTKMH", "HPFF"):
            before = len(self.log)
            self.override(NUMBERS[code], STOP)
            self.wait_would_send("messages_saved: 7", since=before)
        topic.publish(2**32 - 1)
        self.wait_would_send("messages_saved: 4294967295")
        # It does not count for the next run, whose first message says so.
        topic.unregister()
        before = self.end_override_in_log()
        self.override(NUMBERS["HSUF"], STOP)
        self.assertIn("messages_saved: 0", self.wait_would_send(since=before))


class TestGoals(OverrideCase):
    """The parts of a goal that an override can contain."""

    def test_switches(self) -> None:
        number = NUMBERS["HOMF"]
        for attempt in ([3, 1], [2]):
            self.override(number, PREPARE)
            self.wait_said(SAYS_PREPARE)
            self.call("end_prepare")
            self.override(number, GOAL_TX, initial_state=[True, False], switches=attempt)
            goal = self.heard("goal", GoalOMF).wait_last(lambda m, a=attempt: list(m.switches) == a, "the goal")
            self.assertEqual(list(goal.initial_state), [True, False])
            self.wait_said(SAYS_EXECUTE)
            self.call("end_execute")


class TestOverrideGoal(OverrideCase):
    """Goals at home: the service override_goal."""

    def play(self, benchmark: str, state: int, goal: str = "") -> None:
        """Play the box."""
        self.call("override_goal", OverrideGoal, benchmark=benchmark, benchmark_state=state, goal=goal)

    def tearDown(self) -> None:
        self.play("", STOP)
        self.wait_benchmark(0)

    def test_a_waypoint(self) -> None:
        self.play("HNF", PREPARE)
        self.call("end_prepare")
        with self.assertRaisesRegex(CommRefusal, r"the goal is '\[1, 2\]': expected \[x, y, theta\], in numbers"):
            self.play("HNF", GOAL_TX, "[1, 2]")
        self.play("HNF", GOAL_TX, "[1.5, 2, 0.25]")
        self.wait_said(SAYS_EXECUTE)
        self.assertEqual(self.heard("goal", Pose2D).wait_count(1), Pose2D(1.5, 2.0, 0.25))
        self.assertEqual(self.heard("goal/text", StringMsg).wait_count(1).data, "[1.5, 2, 0.25]")
        self.call("end_execute")

    def test_a_benchmark_with_another_code(self) -> None:
        self.play("FetchMug", STOP)
        self.wait_benchmark(255)
        self.assertEqual(self.heard("benchmark/name", StringMsg).wait_count(1).data, "FetchMug")
        self.play("FetchMug", PREPARE)
        self.call("end_prepare")
        self.play("FetchMug", GOAL_TX, '{"colour": "red"}')
        self.wait_said(SAYS_EXECUTE)
        texts = self.heard("goal/text", StringMsg)
        self.assertEqual(texts.wait_count(1).data, '{"colour": "red"}')
        self.assertEqual(self.type_of("end_execute"), "roah_rsbb/String")
        self.call("end_execute", String, '{"fetched": true}')
        self.play("FetchMug", PREPARE)
        self.wait_said(SAYS_PREPARE)
        self.call("end_prepare")
        self.play("FetchMug", WAITING_RESULT)
        texts.wait_last(lambda m: m.data == "", "the next one has no goal")

    def test_another_code_after_the_other(self) -> None:
        names = self.heard("benchmark/name", StringMsg)
        for code in ("FetchMug", "SetTable"):
            self.play(code, STOP)
            names.wait_last(lambda m, code=code: m.data == code, code)
        self.benchmarks.wait_count(3)
        self.assertEqual([m.benchmark for m in self.benchmarks.messages[-2:]], [255, 255])


class TestEnd(OverrideCase):
    """The benchmark ends while the robot does something, and the next one begins at once."""

    def test_the_last_stop_is_not_lost_with_its_topic(self) -> None:
        for _ in range(6):
            before = len(self.said)  # rospy may drop the STOP of the time before
            self.override(NUMBERS["HGTKMH"], PREPARE)
            wait_until(lambda before=before: SAYS_PREPARE in self.said[before:], "the next one is to be prepared")
            listener = self.listener("benchmark/state", BenchmarkState)
            self.assertEqual(self.next_of(listener).benchmark_state, SAYS_PREPARE)
            self.end_override()
            self.assertEqual(self.next_of(listener).benchmark_state, SAYS_STOP)
