"""A core that is killed (kill -9): every run continues unchanged, and is recorded once and completely."""

import pathlib
import signal
import tempfile
from typing import List

import rospy
from support.own_core import PARAMS, OwnCoreCase
from support.programs import Program, own
from support.robots import CONFIG, Robot
from support.waiting import wait_until

GROUP, OBJECTS = ITEM = ("Achievements", "Objects")
STATES = ["STOP", "PREPARE", "WAITING_RESULT", "STOP"]
BENCHMARKS = {"benchmarks_file": CONFIG / "kill_benchmarks.yaml"}


class TestKilledOnce(OwnCoreCase):
    def setUp(self) -> None:
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.log_dir = self.folder / "logs"

    def run_on_record(self, port: int):
        """The journal's record of the run with this port."""
        reader = self.journal(self.log_dir)
        return next(run for run in reader.runs() for m in reader.members(run.identity) if m.port == port)

    def log_on_record(self, port: int):
        """The run log that the journal names for this port, once it is complete."""
        reader = self.journal(self.log_dir)
        paths = [m.log_file for run in reader.runs() for m in reader.members(run.identity) if m.port == port]
        return self.complete_log(pathlib.Path(paths[0]))

    def start(self, *inside: str) -> None:
        self.start_core(self.log_dir, inside, schedule_file=CONFIG / "kill.yaml", **BENCHMARKS)

    def begin(self, zone: str, robot: Robot, benchmark: str) -> int:
        """Connect and start; returns the port once the robot executes."""
        port = self.box.connect(zone)
        self.box.start(zone)
        robot.wait_did(f"execute {benchmark}")
        self.box.wait_phase(zone, "running")
        return port

    def ends(self, zone: str) -> float:
        """Return when a zone's run will time out (UTC)."""
        gui = self.box.wait_zone(zone, lambda z: z.timer.to_sec() < 600 and self.box.gui, "the time runs")
        return gui.clock.to_sec() + next(z.timer.to_sec() for z in gui.zones if z.zone == zone)

    def test_three_runs_at_once(self) -> None:
        self.start()
        box = self.box
        alpha, beta, gamma = self.robot("Alpha"), self.robot("Beta"), self.robot("Gamma")
        ports = [self.begin("Home", alpha, "HGTKMH"), self.begin("Kitchen", beta, "HCFGAC")]
        alpha.request("notify", "before")
        alpha.wait_said()
        beta.request("final_command", "bring the cup")
        beta.wait_said()
        box.set_score("Home", *ITEM, 2)
        box.set_score("Kitchen", *ITEM, 5)
        ends = [self.ends("Home"), self.ends("Kitchen")]
        ports.append(self.begin("Door", gamma, "HWV"))
        up = self.ends("Door")

        self.core.kill()
        alpha.request("notify", "while it was dead")  # is repeated until it is acknowledged
        rospy.sleep(max(0.0, up - rospy.get_time()))  # HWV's time is up
        self.start()
        self.assertEqual([box.zone_details(zone).port for zone in ("Home", "Kitchen")], ports[:2])
        for zone, end in zip(("Home", "Kitchen"), ends):
            box.wait_phase(zone, "running")
            box.wait_zone(zone, lambda z: ": the run continues" in z.log, "it is marked")
            self.assertLess(abs(self.ends(zone) - end), 1.0)
        box.wait_details("Door", lambda d: (d.phase, d.end_reason) == ("ended", "timeout"), "HWV ended by timeout")
        gamma.wait_did("stop")
        wait_until(lambda: box.timeouts, "the sound is asked for, although nobody counted the time when it was up")
        box.wait_scored("Home", (*ITEM, 1, 2))
        box.set_score("Home", *ITEM, 3)
        alpha.wait_said()
        for robot, zone in ((alpha, "Home"), (beta, "Kitchen")):
            robot.let("execute")
            box.wait_text(zone, "Benchmark completed by the robot")
        self.assertEqual([line.split(" ", 1)[1] for line in self.lines("Home")],
                         ["notifications: before", "notifications: while it was dead"])
        self.assertEqual(len(self.lines("Kitchen")), 1)
        for zone in ("Home", "Kitchen", "Door"):
            box.command("disconnect", zone)
            box.wait_phase(zone, "idle")
        for robot, benchmark in ((alpha, "HGTKMH"), (beta, "HCFGAC"), (gamma, "HWV")):
            self.assertEqual(robot.did, [f"prepare {benchmark}", f"execute {benchmark}", "stop"])
        self.assert_records(ports)
        self.assertEqual(box.timeouts, 1)

    def lines(self, zone: str) -> List[str]:
        """A zone's online data."""
        return self.box.zone(zone).online_data.splitlines()

    def assert_records(self, ports: List[int]) -> None:
        """Check that the bag, the journal and the outcome agree."""
        reasons, scores, strings = ["completed", "completed", "timeout"], [[2, 3], [5], []], []
        for port, reason, score in zip(ports, reasons, scores):
            log = self.log_on_record(port)
            self.assert_log_is_the_journals(self.log_dir, port, log)
            self.assertEqual(log.values("/rsbb_log/rsbb_state_str"), STATES)
            self.assertEqual([message.value for message in log.messages("/rsbb_log/score")], score)
            strings.append(log.values("/notification") + log.values("/command"))
            outcome = self.run_on_record(port).outcome
            self.assertEqual(outcome["end_reason"], reason)
            self.assertEqual([entry["value"] for entry in outcome.get("history", [])], score)
        self.assertEqual(strings, [["before", "while it was dead"], ["bring the cup"], []])
        self.assertLess(abs(self.run_on_record(ports[2]).outcome["elapsed_s"] - 6.0), 1.0)

    def test_a_second_core_waits_until_the_first_one_has_ended(self) -> None:
        """It takes nothing over at the same ROS master: clients would lose their box."""
        first, second = self.folder / "first", self.folder / "second"
        self.start_core(first)
        uuid, core = self.box.uuid, self.core
        for name in ((), ("__name:=second_core",)):
            other = self._leaving(Program(own("roah_rsbb_core"), *name, *(
                f"_{key}:={value}" for key, value in {**PARAMS, "log_dir": second}.items())))
            other.wait_printed("is running at this ROS master. This one takes nothing over")
            if not name:
                other.signal(signal.SIGINT)
                other.wait_ended()
        self.robot("Alpha")
        self.box.connect("Home")
        self.box.command("disconnect", "Home")
        self.assertEqual(self.box.uuid, uuid)
        core.kill()
        other.wait_printed("the other core has ended")
        self.box.wait_other_core(uuid)
