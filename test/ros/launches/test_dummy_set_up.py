"""The dummy set-up from its launch to its end, with robots of several teams; dummy robots that cannot start."""

import contextlib
import os
import pathlib
import time

import rospy
from std_srvs.srv import Empty
from support.box_case import LISTENER, PACKAGE, NetworkCase
from support.box_client import BoxClient
from support.connections import process_of
from support.programs import Program, own
from support.robots import BOX, BROADCAST, CONFIG, PASSWORDS, RSBB_PORT, PublicParticipant
from support.run_logs import RunLog
from support.waiting import LIMIT_S, wait_until

from roah_rsbb.protocol import BoxState

# On a busy machine, the test hears the box seconds after its start.
LISTEN_S = 10.0
LOG_DIR = os.path.join(os.environ.get("ROS_HOME", os.path.expanduser("~/.ros")), "roah_rsbb_test")
FILES = {
    "benchmarks_file": CONFIG.parents[2] / "config" / "benchmarks.yaml", "schedule_file": CONFIG / "dummy_set_up.yaml",
    "passwords_file": CONFIG / "passwords.yaml",
}


def command_lines() -> str:
    """The data of processes that every user of this machine can read."""
    lines = []
    for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):  # processes end meanwhile
            lines.append(path.read_text(errors="replace").replace("\0", " "))
    return "\n".join(lines)


class TestDummySetUp(NetworkCase):
    def test_from_launch_to_shutdown(self) -> None:
        """All of it but what test_devices.py and test_tablet.py launch."""
        listener = self.participant(LISTENER)
        rospy.set_param("/roah_rsbb_core/listen_duration", LISTEN_S)
        self.addCleanup(rospy.delete_param, "/roah_rsbb_core/listen_duration")
        files = (f"{name}:={path}" for name, path in FILES.items())
        launched = self._leaving(Program(
            "roslaunch", PACKAGE, "roah_rsbb_dummy.launch", "robots:=3", "gui:=none", "tablet:=false",
            "web:=false", "devices:=false", f"rsbb_host:={BROADCAST}", f"rsbb_port:={RSBB_PORT}", f"bind_host:={BOX}",
            f"log_dir:={LOG_DIR}", *files,
        ))
        box = BoxClient()
        self.addCleanup(box.close)
        box.wait_heard()
        self.listens_at_first(box, listener)
        self.robots_of_three_teams(box, launched)
        box.connect("Hall")
        box.start("Hall")
        box.wait_text("Hall", "Benchmark completed by the robot")
        launched.wait_printed("Gamma: HGTKMH: complete")
        self.assertGreater(box.zone_details("Hall").messages_saved, 0)
        path = box.zone_details("Hall").log_file
        box.command("disconnect", "Hall")
        self.a_functionality_benchmark_can_start(box)

        rospy.wait_for_service("/roah_rsbb_shutdown", LIMIT_S)
        rospy.ServiceProxy("/roah_rsbb_shutdown", Empty)()
        self.assertEqual(launched.wait_ended(), 0)
        self.assertNotIn("Traceback", launched.text)
        states = RunLog.complete(path).values("/rsbb_log/rsbb_state")
        self.assertEqual(states, [BoxState.STOP, BoxState.PREPARE, BoxState.WAITING_RESULT, BoxState.STOP])

    def listens_at_first(self, box: BoxClient, listener: PublicParticipant) -> None:
        box.wait_details("Hall", lambda d: any("still listening" in reason for reason in d.off("connect")),
                         "connect is off while the box only listens")
        self.assertIn("The box is still listening for another box", box.refusal("connect", "Hall"))
        self.assertIsNone(listener.beacon)
        wait_until(lambda: listener.beacon, "the box transmits")
        utc = time.time()
        wait_until(lambda: box.gui.clock.to_sec() >= utc, "the box's state after its first beacon")
        self.assertRegex(box.gui.status, r"^OK$|: [01] s$", "it listened for the whole time")

    def robots_of_three_teams(self, box: BoxClient, launched: Program) -> None:
        """The teams of the schedule come first, then others that have a password."""
        wait_until(lambda: len(box.gui.active_robots) == 3, lambda: f"three robots are active:\n{box.gui}")
        self.assertEqual({robot.team for robot in box.gui.active_robots}, {"Gamma", "Beta", "Alpha"})
        for number, team in enumerate(("Gamma", "Beta", "Alpha"), 2):
            launched.wait_printed(f"A dummy robot of team {team} at 127.0.0.{number}")
        self.assertNotIn(PASSWORDS["Gamma"], command_lines() + launched.text)

    def a_functionality_benchmark_can_start(self, box: BoxClient) -> None:
        """The set-up as it is has modules, and ground truth for them."""
        box.connect("Lab")
        self.assertNotEqual(process_of("/roah_rsbb_modules"), 0)
        box.wait_details("Lab", lambda d: not d.off("start"), "nothing is missing")
        box.command("disconnect", "Lab")


class TestThatCannotBe(NetworkCase):
    """The node alone, on its own public ports."""

    def node(self, port: int, **params: object) -> Program:
        given = {"rsbb_port": RSBB_PORT + port, **FILES, **params}
        return self._leaving(Program(
            own("dummy_robots"), f"__name:=dummies_{port}",
            *(f"_{name}:={value}" for name, value in given.items()),
        ))

    def assert_ended(self, node: Program, *texts: str) -> None:
        self.assertEqual(node.wait_ended(), 1)
        for text in texts:
            self.assertIn(text, node.text)
        self.assertNotIn("Traceback", node.text)

    def test_more_than_there_are_teams(self) -> None:
        teams = len(PASSWORDS)
        node = self.node(50, robots=teams + 1)
        node.wait_printed(f"{teams} dummy robots instead of {teams + 1}: {CONFIG}")
        node.wait_printed("A dummy robot of team", times=teams)

    def test_wrong_parameters(self) -> None:
        self.assert_ended(self.node(60, robots=0, execute_duration=-1, passwords_file=""),
                          "parameter /dummies_60/robots: found 0, expected a whole number from 1 to 200",
                          "parameter /dummies_60/execute_duration: found -1",
                          "parameter /dummies_60/passwords_file: found nothing, expected a path")

    def test_files_with_errors(self) -> None:
        self.assert_ended(self.node(70, schedule_file=CONFIG / "broken" / "schedule.yaml"),
                          "no dummy robots: the configuration is invalid, see the errors of the core")

    def test_a_name_for_no_address(self) -> None:
        self.assert_ended(self.node(80, rsbb_host="no.such.host.invalid"),
                          "the dummy robot of team Gamma ended: ", "no.such.host.invalid")
