"""Whole runs by `referee run`: the real core, robots over real sockets, the referee as a separate program."""

import signal

from support.box_case import BoxCase
from support.referee_program import Referee, referee

from roah_rsbb.model.as_json import from_json
from roah_rsbb.model.results import RunSheet


class TestRun(BoxCase):
    """The robot of zone Door's team is in the test's hand."""

    ZONE = "Door"  # one event: HWV

    def start(self, *words: str) -> Referee:
        """A referee that is ended with the test."""
        run = Referee("run", self.ZONE.lower(), "--json", *words)
        self.addCleanup(run.close)
        return run

    def last_sheet(self) -> RunSheet:
        """The score sheet of the last run."""
        self.box.wait_current()
        run = next(run for run in self.box.document.runs() if run.zone == self.ZONE)
        return from_json(RunSheet, self.box.ask("sheet", zone=self.ZONE, run=run.identity))

    def test_a_robot_completes_it(self) -> None:
        run = self.start("--score", "kimble rings=yes", "--score", "false alarm=+2", "--by", "Ada")
        run.event("note", text="waiting to connect: No robot of team Beta is active: none of its beacons arrives on "
                               f"UDP port {self.box.gui.port}")
        robot = self.robot("Beta")
        run.event("robot", what="came", team="Beta")
        run.event("score", value=2)
        robot.wait_did("execute HWV")
        robot.request("visitor", "postman")
        self.assertRegex(run.event("online_data")["text"], r"^\d\d:\d\d:\d\dZ visitor: postman$")
        robot.wait_said()
        robot.let("execute")
        result = run.event("result")
        self.assertEqual(run.wait_ended(), 0)
        self.assertEqual((result["ok"], result["end_reason"], result["robot"]), (True, "completed", "Robot"))
        self.assertEqual([(i["number"], i["value"]) for i in result["score"] if i["value"]], [(1, 1), (10, 2)])
        self.assertEqual(self.read_log(result["log_file"]).values("/visitor"), ["postman"])
        sheet = self.last_sheet()
        self.assertEqual({entry.who.partition(" ")[0] for entry in sheet.history}, {"Ada"})
        self.box.wait_details(self.ZONE, lambda d: d.phase == "idle", "it is disconnected")

    def test_an_interrupt_stops_the_robot(self) -> None:
        robot = self.robot("Beta")
        run = self.start("--by", "Ada")
        robot.wait_did("execute HWV")
        run.signal(signal.SIGINT)
        robot.wait_did("stop")
        self.assertEqual(run.event("result")["end_reason"], "stopped")
        self.assertEqual(run.wait_ended(), 130)
        self.box.wait_details(self.ZONE, lambda d: d.phase == "idle", "it is disconnected")
        sheet = self.last_sheet()
        self.assertTrue(sheet.ends[-1].who.startswith("Ada "), sheet.ends)

    def test_every_word_of_the_core_fits_the_program(self) -> None:
        done = referee("status", self.ZONE)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for text in ("Task Benchmark 2: Welcoming visitors", "HWV, team Beta, round 1, run 1",
                     "no start: No run is connected: press connect first", "no next: This is the zone's last event"):
            self.assertIn(text, done.stdout)
