"""A core whose disk is full, read-only, removed or broken: referees are warned, runs continue, nothing is lost."""

import os
import pathlib
import tempfile
from typing import List

from support.box_client import Refusal
from support.own_core import OwnCoreCase
from support.robots import Robot
from support.waiting import wait_until

from helpers.small_disk import CannotMount, SmallDisk

ZONE = "Home"
GROUP, DOOR = "Achievements", "Detects the door whose state has changed"
JOURNAL, LOG = "The journal", "The run logs"
# Not that the killed core left a torn tail, which its successor says for a minute.
NOT_WRITTEN = "cannot be written"
# A text that is too long for the rest of the disk.
MUCH = tuple(f"{number} {'x' * 400}" for number in range(30))


class DiskCase(OwnCoreCase):
    def use_disk(self) -> SmallDisk:
        """A disk that exists during the test. Skips the test if no disk can be created."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        try:
            self.disk = self._leaving(SmallDisk(pathlib.Path(folder.name) / "disk", 1024))
        except (CannotMount, OSError) as error:
            self.skipTest(f"no file system can be mounted here: {error}")
        self.log_dir = self.disk.path / "logs"
        return self.disk

    def start(self) -> None:
        """Start the core, with its log_dir on the disk."""
        self.start_core(pathlib.Path(self.disk.mount_point) / "logs", self.disk.inside)

    def running(self) -> Robot:
        """Connect and start; returns the robot, which executes. Its run's port and log are kept."""
        robot = self.robot("Alpha")
        self.port = self.box.connect(ZONE)
        self.box.start(ZONE)
        robot.wait_did("execute HGTKMH")
        log_file = self.box.wait_details(ZONE, lambda d: d.log_file, "the run has a log")
        self.path = self.log_dir / os.path.basename(log_file)
        return robot

    def score_without_disk(self) -> str:
        """Enter a score that counts although it cannot be saved. Returns the referee's message."""
        with self.assertRaises(Refusal) as refused:
            self.box.set_score(ZONE, GROUP, DOOR, 1)
        self.box.wait_scored(ZONE, (GROUP, DOOR, 0, 1))
        self.wait_unsaved([1])
        return str(refused.exception)

    def wait_unsaved(self, entries: List[int]) -> None:
        """Wait until panels know that these entries of the run's history are not saved."""
        wait_until(lambda: [n for run in self.box.document.box.unsaved for n in run.entries] == entries,
                   lambda: f"{entries} are not saved; published:\n{self.box.document.box.unsaved}")

    def say(self, robot: Robot, *sayings: str) -> None:
        """Let the robot send a text, and wait until the box has it."""
        for saying in sayings:
            robot.request("notify", saying)
        robot.wait_said()

    def to_the_end(self, robot: Robot, saying: str) -> None:
        """Complete the run. The robot sends texts during it."""
        self.say(robot, saying)
        robot.let("execute")
        self.box.wait_text(ZONE, "Benchmark completed by the robot")
        self.assertIn(saying, self.box.zone(ZONE).online_data)
        self.box.command("disconnect", ZONE)
        self.box.wait_phase(ZONE, "idle")

    def assert_all_is_written(self, *sayings: str) -> None:
        """Bag and journal hold the whole run, and no warning is left."""
        self.wait_no_warning(JOURNAL)
        self.wait_no_warning(LOG)
        log = self.complete_log(self.path)
        self.assert_log_is_the_journals(self.log_dir, self.port, log)
        self.assertEqual(log.values("/rsbb_log/rsbb_state_str"), ["STOP", "PREPARE", "WAITING_RESULT", "STOP"])
        self.assertEqual(log.values("/notification"), list(sayings))
        self.assertEqual([(score.desc, score.value) for score in log.messages("/rsbb_log/score")], [(DOOR, 1)])
        run = self.journal(self.log_dir).runs()[-1]
        self.assertEqual((run.outcome["end_reason"], run.closed_utc is not None), ("completed", True))
        self.assertEqual([(entry["desc"], entry["value"]) for entry in run.outcome["history"]], [(DOOR, 1)])


class TestDisk(DiskCase):
    def test_a_disk_that_is_full(self) -> None:
        disk = self.use_disk()
        self.start()
        robot = self.running()
        self.say(robot, "there is room")
        disk.fill()
        self.say(robot, *MUCH)  # the last block of a file may have room for a little
        self.assertIn("Free or repair the disk", self.wait_warned(JOURNAL))
        self.assertIn("not saved: the disk is full", self.score_without_disk())
        self.wait_unsaved([1])
        self.to_the_end(robot, "there is none")
        self.assertFalse(self.path.exists(), "the journal does not have the end")
        disk.free()
        self.wait_unsaved([])
        self.assert_all_is_written("there is room", *MUCH, "there is none")

    def test_a_core_that_is_killed_while_its_disk_is_full(self) -> None:
        disk = self.use_disk()
        self.start()
        robot = self.running()
        self.box.set_score(ZONE, GROUP, DOOR, 1)
        disk.fill()
        self.say(robot, *MUCH)
        self.wait_warned(JOURNAL)
        self.core.kill()
        self.start()
        self.assertEqual(self.box.zone_details(ZONE).port, self.port, "the run continues from what was written")
        self.wait_warned(NOT_WRITTEN)
        disk.free()
        self.to_the_end(robot, "there is room again")
        self.wait_no_warning(NOT_WRITTEN)
        log = self.complete_log(self.path)
        self.assert_log_has_all_of_the_journal(self.log_dir, self.port, log)
        self.assertEqual([score.value for score in log.messages("/rsbb_log/score")], [1])
        sessions = self.journal(self.log_dir).sessions()
        self.assertEqual(len(sessions), 2)
