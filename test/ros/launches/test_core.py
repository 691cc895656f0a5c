"""Cores that cannot start, and launches that end with them."""

import os
import unittest

import rospy
from support.box_case import PACKAGE, NetworkCase
from support.programs import Program, own
from support.robots import BOX, BROADCAST, CONFIG, RSBB_PORT
from support.waiting import LIMIT_S

LOST = "192.0.2.1"  # reserved for documentation: no machine has it
ROS_HOME = os.environ.get("ROS_HOME", os.path.expanduser("~/.ros"))
NETWORK = {"rsbb_host": BROADCAST, "rsbb_port": RSBB_PORT, "bind_host": BOX}
BROKEN = {f"{name}_file": CONFIG / "broken" / f"{name}.yaml" for name in ("benchmarks", "schedule", "passwords")}
GOOD = {
    "benchmarks_file": CONFIG / "short_benchmarks.yaml", "schedule_file": CONFIG / "boxes.yaml",
    "passwords_file": CONFIG / "passwords.yaml",
}
CORE = {
    "public_results": "none", "public_provisional": "false", "public_robot_texts": "false",
    "standings_file": "none", "resume": "always",
}
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


class TestCoresThatCannotStart(unittest.TestCase):
    """Several cores without other nodes, all started at once under different names."""

    PARAMS = {"wrong_core": WRONG_PARAMS, "lost_core": {**NETWORK, **GOOD, "bind_host": LOST}}

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


class TestLaunchThatCannotWork(NetworkCase):
    def test_a_wrong_configuration_ends_the_launch(self) -> None:
        """A restart of the core cannot repair it. All errors of all files are reported, once."""
        launched = self._leaving(Program("roslaunch", PACKAGE, "core.launch.xml", *(
            f"{name}:={value}" for name, value in {**NETWORK, **BROKEN, **CORE, "log_dir": log_dir("broken")}.items())))
        launched.wait_ended()
        fatal = [line for line in launched.lines if "[FATAL]" in line]
        self.assertEqual(len(fatal), len(ERRORS), launched.text)
        for line, error in zip(fatal, ERRORS):
            self.assertRegex(line, error)
        self.assertEqual(launched.text.count("process[roah_rsbb_core-"), 1, launched.text)
        self.assertNotIn("Listening on UDP", launched.text)
        self.assertNotIn("Traceback", launched.text)
