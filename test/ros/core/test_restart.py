"""A core that dies in the middle of a run comes back, and the run continues; no port is used twice."""

import contextlib
import signal
import socket

from support.box_case import LISTENER, BoxCase
from support.robots import BOX, listed

DOOR = ("Achievements", "Detects the door whose state has changed")


class TestRestart(BoxCase):
    def test_a_core_that_is_killed_in_a_run(self) -> None:
        robot, listener = self.robot("Alpha"), self.participant(LISTENER)
        port = self.box.connect("Home")
        self.box.start("Home")
        robot.wait_did("execute HGTKMH")
        robot.request("notify", "at the door")
        robot.wait_said()
        self.box.set_score("Home", *DOOR, 1)
        left = self.box.zone("Home").timer
        self.kill_core()
        listener.heard.clear()

        self.box.wait_text("Home", "no explicit goal")
        self.box.wait_zone("Home", lambda z: ": the run continues" in z.log, "it is marked")
        details = self.box.zone_details("Home")
        self.assertEqual((details.phase, details.port), ("running", port))
        self.box.wait_scored("Home", (*DOOR, 0, 1))
        self.box.wait_zone("Home", lambda z: z.timer < left, "the clock did not start again")
        listener.wait_beacon(lambda b: [entry[-1] for entry in listed(b)] == [port], "the beacon lists the robot")
        robot.request("notify", "at the bed")
        robot.wait_said()
        robot.let("execute")
        self.box.wait_text("Home", "Benchmark completed by the robot")
        robot.wait_did("stop")
        self.assertEqual(robot.did, ["prepare HGTKMH", "execute HGTKMH", "stop"])
        log = self.leave("Home")
        self.assertEqual(log.values("/rsbb_log/rsbb_state_str"), ["STOP", "PREPARE", "WAITING_RESULT", "STOP"])
        self.assertEqual(log.values("/notification"), ["at the door", "at the bed"])
        self.assertEqual([(score.group, score.desc, score.value) for score in log.messages("/rsbb_log/score")],
                         [(*DOOR, 1)])
        self.kill_core()
        self.box.wait_zone("Home", lambda z: z.code == "HWV", "the zone is at its next event")
        self.box.command("previous", "Home")
        self.assertGreater(self.box.connect("Home"), port)

    def test_a_core_that_is_ended_in_a_run(self) -> None:
        self.robot("Alpha")
        port = self.box.connect("Home")
        path = self.box.wait_details("Home", lambda d: d.log_file, "the run has a log")
        self.kill_core(signal.SIGTERM)
        details = self.box.zone_details("Home")
        self.assertEqual((details.phase, details.port, details.log_file), ("connected", port, path))
        self.assertEqual(self.leave("Home").values("/rsbb_log/rsbb_state_str"), ["STOP"])

    def test_a_core_that_is_killed_in_a_run_without_a_robot(self) -> None:
        self.box.command("open_sheet", "Sheet")
        self.box.start("Sheet")
        self.box.set_score("Sheet", *DOOR, 1)
        before = self.box.wait_details("Sheet", lambda d: d.phase == "running" and d, "the clock runs")
        self.assertEqual((before.by_hand, before.robot, before.port), (True, None, 0))
        left = self.box.zone("Sheet").timer
        self.kill_core()
        after = self.box.zone_details("Sheet")
        self.assertEqual((after.phase, after.identity, after.by_hand), ("running", before.identity, True))
        self.box.wait_zone("Sheet", lambda z: z.timer < left, "the clock did not start again")
        self.box.wait_scored("Sheet", (*DOOR, 0, 1))
        self.box.command("stop", "Sheet")
        self.box.command("withdrawn", "Sheet")
        self.box.wait_zone("Sheet", lambda z: z.code == "HWV", "the zone is at its next event")
        self.box.command("no_show", "Sheet")
        self.kill_core()
        self.box.wait_current()
        runs = [run for run in self.box.document.runs() if run.zone == "Sheet"]
        self.assertEqual([(run.code, run.end_reason) for run in runs], [("HWV", "no_show"), ("HGTKMH", "withdrawn")])

    def test_a_private_port_that_another_program_uses(self) -> None:
        robot = self.robot("Alpha")
        port = self.box.connect("Home")
        self.box.command("disconnect", "Home")
        with contextlib.ExitStack() as stack:
            for taken in (port + 1, port + 2):
                stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)).bind((BOX, taken))
            self.assertEqual(self.box.connect("Home"), port + 3)
        self.box.start("Home")
        robot.wait_did("execute HGTKMH")
