"""Launching and ending: the whole dummy set-up, configurations that cannot work, another box on the network."""

import os
import re
import unittest
from typing import List

import rospy
from std_srvs.srv import Empty
from support.box_case import LISTENER, PACKAGE, NetworkCase
from support.box_client import BoxClient
from support.programs import Program, own
from support.robots import BOX, BROADCAST, CONFIG, RSBB_PORT, empty_beacon
from support.run_logs import RunLog
from support.waiting import LIMIT_S, happened, wait_until

from roah_rsbb.msg import ModulesState
from roah_rsbb.protocol import BoxState
from roah_rsbb.rulebook.registry import PROFILES, BenchmarkKind

FOREIGN_BOX = "127.0.0.5"
LOST = "192.0.2.1"  # reserved for documentation: no machine has it
ROS_HOME = os.environ.get("ROS_HOME", os.path.expanduser("~/.ros"))
NETWORK = {"rsbb_host": BROADCAST, "rsbb_port": RSBB_PORT, "bind_host": BOX}
BROKEN = {f"{name}_file": CONFIG / "broken" / f"{name}.yaml" for name in ("benchmarks", "schedule", "passwords")}
GOOD = {
    "benchmarks_file": CONFIG / "short_benchmarks.yaml", "schedule_file": CONFIG / "boxes.yaml",
    "passwords_file": CONFIG / "passwords.yaml",
}
# A node that is interrupted while it still starts prints where it was.
CORE_ALONE = {"modules": "false", "tablet": "false", "devices": "false"}
# Line by line: file and line, what is found there.
ERRORS = (
    r"benchmarks\.yaml:2: found the text 'HGTKM' as code; expected .*did you mean 'HGTKMH'",
    r"benchmarks\.yaml:3: found a benchmark without desc",
    r"benchmarks\.yaml:3: found the text 'soon' as timeout; expected a number of seconds",
    r"passwords\.yaml:2: found a tab; expected spaces",
    r"schedule\.yaml:3: found the text 'yesterday' as scheduled_time; expected a date and time in UTC",
    r"schedule\.yaml:4: found a second zone 'Home'",
    r"schedule\.yaml:5: found an empty sequence as schedule of zone 'Home'",
)
# Every parameter of the ROS interface that can be wrong by itself, and those that are new.
WRONG_PARAMS = {
    "rsbb_port": 0, "rsbb_cypher": "rot13", "robot_timeout": 0, "allowed_skew": "wide", "after_stop_duration": -1,
    "display_log_size": 1.5, "check_messages_saved": "maybe", "check_messages_saved_timeout": -1,
    "private_mode": "loud", "max_datagram": 10, "auto_next": "perhaps", "listen_duration": 1000,
}
NO_PARAMS = ("benchmarks_file", "schedule_file", "passwords_file")


def log_dir(name: str) -> str:
    """A folder for each core. Otherwise one core would find the other's journal of another competition."""
    return os.path.join(ROS_HOME, f"roah_rsbb_{name}")


class LaunchCase(NetworkCase):
    def launch(self, name: str, **arguments: object) -> Program:
        """Start a launch file of the package."""
        return self._leaving(Program(
            "roslaunch", PACKAGE, name, "gui:=none", "tablet_port:=0",
            "smartif_host:=127.0.0.1", f"smartif_port:={RSBB_PORT + 96}",
            f"log_dir:={log_dir(self._testMethodName)}",
            *(f"{argument}:={value}" for argument, value in {**NETWORK, **arguments}.items()),
        ))


class TestCoresThatCannotStart(unittest.TestCase):
    """Several cores without other nodes, all started at once under different names."""

    PARAMS = {"broken_core": {**NETWORK, **BROKEN}, "wrong_core": WRONG_PARAMS,
              "lost_core": {**NETWORK, **GOOD, "bind_host": LOST}}

    @classmethod
    def setUpClass(cls) -> None:
        cls.cores = {}
        for name, params in cls.PARAMS.items():
            core = cls.cores[name] = Program(own("roah_rsbb_core"), f"__name:={name}",
                                             f"_log_dir:={log_dir(name)}",
                                             *(f"_{param}:={value}" for param, value in params.items()))
            cls.addClassCleanup(core.close)

    def ended(self, name: str) -> Program:
        """Wait until the core has ended with status 1, and not because of an internal error."""
        core = self.cores[name]
        self.assertEqual(core.wait_ended(), 1)
        self.assertNotIn("Traceback", core.text)
        self.assertNotIn("Listening on UDP", core.text)
        return core

    def test_errors_of_all_files_are_reported_at_once(self) -> None:
        core = self.ended("broken_core")
        reported = [line for line in core.lines if "[FATAL]" in line]
        self.assertEqual(len(reported), len(ERRORS), core.text)
        for line, error in zip(reported, ERRORS):
            self.assertRegex(line, error)

    def test_wrong_parameters_are_reported_at_once(self) -> None:
        core = self.ended("wrong_core")
        for param, value in WRONG_PARAMS.items():
            with self.subTest(param):
                self.assertIn(f"parameter /wrong_core/{param}: found {value!r}, expected ", core.text)
        for param in NO_PARAMS:
            with self.subTest(param):
                self.assertIn(f"parameter /wrong_core/{param}: found nothing, expected ", core.text)

    def test_an_address_that_this_machine_does_not_have(self) -> None:
        core = self.ended("lost_core")
        self.assertIn(f"{LOST} is not an address of this machine", core.text)
        self.assertIn("correct bind_host", core.text)


class TestShutdownNode(unittest.TestCase):
    def test_it_ends_when_whoever_started_it_is_killed(self) -> None:
        command = f"'{own('roah_rsbb_shutdown')}' __name:=orphan_shutdown roah_rsbb_shutdown:=/orphan & wait"
        starter = Program("sh", "-c", command)
        self.addCleanup(starter.close)
        rospy.wait_for_service("/orphan", LIMIT_S)
        starter.kill()
        starter.wait_ended()  # the node holds the output open, too


class TestLaunchesThatCannotWork(LaunchCase):
    """An error that a restart of the core cannot repair ends the launch."""

    def assert_not_repairable(self, launched: Program, texts: tuple) -> None:
        """The launch ended by itself after it reported the error once. No core was restarted."""
        launched.wait_ended()
        for text in texts:
            self.assertEqual(len(re.findall(text, launched.text)), 1, f"{text} in\n{launched.text}")
        self.assertEqual(launched.text.count("process[roah_rsbb_core-"), 1, launched.text)
        self.assertNotIn("Traceback", launched.text)

    def test_a_wrong_configuration(self) -> None:
        self.assert_not_repairable(self.launch("roah_rsbb.launch", **BROKEN, **CORE_ALONE), ERRORS)

    def test_another_box(self) -> None:
        foreign = self.participant(FOREIGN_BOX)
        launched = self.launch("roah_rsbb.launch", **GOOD, **CORE_ALONE)
        launched.wait_printed("Listening on UDP")
        foreign.send(empty_beacon())
        self.assert_not_repairable(launched, (rf"\[FATAL\].*Another RSBB is running at {re.escape(FOREIGN_BOX)}",))


class TestDummySetUp(LaunchCase):
    """One launch file starts all that is needed; a service ends it."""

    ZONE = "Testing TestingTeam"

    def test_from_launch_to_shutdown(self) -> None:
        listener = self.participant(LISTENER)
        launched = self.launch("roah_rsbb_dummy.launch")
        box = BoxClient()
        self.addCleanup(box.close)
        box.wait_heard(2 * LIMIT_S)  # a dozen programs start at once
        box.wait_details(self.ZONE, lambda d: any("still listening" in reason for reason in d.connect_off),
                         "connect is off while the box only listens")
        self.assertIn("The box is still listening for another box", box.refusal("connect", self.ZONE))
        self.assertIsNone(listener.beacon)
        wait_until(lambda: listener.beacon, "the box transmits")
        self.assertRegex(box.gui.status, r"^OK$|: [01] s$", "it listened for the whole time")

        box.connect(self.ZONE)
        box.start(self.ZONE)
        box.wait_text(self.ZONE, "Benchmark completed by the robot")
        self.assertGreater(box.zone_details(self.ZONE).messages_saved, 0)
        path = box.zone_details(self.ZONE).log_file
        self.modules_are_there(box)

        rospy.wait_for_service("/roah_rsbb_shutdown", LIMIT_S)
        rospy.ServiceProxy("/roah_rsbb_shutdown", Empty)()
        self.assertEqual(launched.wait_ended(), 0)
        self.assertNotIn("Traceback", launched.text)
        states = RunLog.complete(path).values("/rsbb_log/rsbb_state")
        self.assertEqual(states, [BoxState.STOP, BoxState.PREPARE, BoxState.WAITING_RESULT, BoxState.STOP])

    def modules_are_there(self, box: BoxClient) -> None:
        """A functionality benchmark with ground truth can be started in this set-up."""
        heard: List[ModulesState] = []

        def on_state(message: ModulesState) -> None:
            heard.append(message)
            happened()

        subscriber = rospy.Subscriber("/modules/state", ModulesState, on_state)
        self.addCleanup(subscriber.unregister)
        wait_until(
            lambda: heard and not any(module.problems or module.warnings for module in heard[-1].modules),
            lambda: f"the modules have all that they need; they say\n{heard[-1:]}",
        )
        self.assertEqual({module.benchmark for module in heard[-1].modules},
                         {code for code, profile in PROFILES.items() if profile.kind is BenchmarkKind.FUNCTIONALITY})
