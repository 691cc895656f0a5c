"""The journal's copy on a stick: a core on it continues the run, and referees are warned while it is missing."""

import pathlib
import tempfile

import rospy
from support.own_core import OwnCoreCase
from support.programs import Program, own
from support.waiting import LIMIT_S, wait_until

from roah_rsbb.msg import CopyState

ZONE = "Home"
DOOR = ("Achievements", "Detects the door whose state has changed")
COPY = "The copy of the journal"


class TestBackup(OwnCoreCase):
    def setUp(self) -> None:
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.log_dir, self.stick = self.folder / "logs", self.folder / "stick"
        self.stick.mkdir()
        self.start_core(self.log_dir, backup_dir=self.stick)
        self.backup = self._leaving(Program(
            own("roah_rsbb_backup"), f"_log_dir:={self.log_dir}", f"_backup_dir:={self.stick}"))

    def wait_copied(self, text: str) -> None:
        """Wait until the copy has an entry."""
        self.wait_no_warning(COPY)

        def has_it() -> bool:
            copy = self.journal(self.stick)
            return any(text in str(entry.value) for run in copy.runs() for entry in copy.entries(run.identity))

        wait_until(has_it, f"the copy has {text}")

    def test_a_core_continues_from_the_copy(self) -> None:
        robot = self.robot("Alpha")
        port = self.box.connect(ZONE)
        self.box.start(ZONE)
        robot.wait_did("execute HGTKMH")
        self.box.set_score(ZONE, *DOOR, 1)
        robot.request("notify", "at the door")
        robot.wait_said()
        self.wait_copied("at the door")
        left = self.box.zone(ZONE).timer
        self.core.kill()
        self.backup.close()
        self.log_dir.rename(self.folder / "burnt")

        self.start_core(self.stick)
        details = self.box.zone_details(ZONE)
        self.assertEqual((details.phase, details.port), ("running", port))
        self.box.wait_scored(ZONE, (*DOOR, 0, 1))
        self.box.wait_zone(ZONE, lambda z: z.timer < left, "the clock did not start again")
        robot.request("notify", "at the bed")
        robot.wait_said()
        robot.let("execute")
        self.box.wait_text(ZONE, "Benchmark completed by the robot")
        self.box.command("disconnect", ZONE)
        self.assertGreater(self.box.connect(ZONE), port)

    def test_a_stick_that_is_pulled_out(self) -> None:
        self.wait_no_warning(COPY)
        away = self.folder / "away"
        self.stick.rename(away)
        self.assertIn("Plug the stick in again", self.wait_warned(COPY))
        self.robot("Alpha")
        self.box.connect(ZONE)
        self.box.set_score(ZONE, *DOOR, 1)
        away.rename(self.stick)
        self.wait_copied(DOOR[1])

    def test_a_node_that_ends(self) -> None:
        state = rospy.wait_for_message("/copies/state", CopyState, LIMIT_S)
        self.assertEqual(state.place, str(self.stick))
        self.backup.close()
        self.assertIn(COPY, self.wait_warned("does not report"))
