"""The journal's copy on a stick: a core on it continues the run, and referees are warned while it is missing."""

import pathlib
import re
import tempfile
from typing import Any, Optional

import rospy
from support.own_core import PARAMS, OwnCoreCase
from support.programs import Program, own, run
from support.robots import BOX, BROADCAST, RSBB_PORT
from support.waiting import LIMIT_S, wait_until

from roah_rsbb.journal.file import FILE_NAME
from roah_rsbb.journal.reader import JournalError
from roah_rsbb.msg import CopyState

ZONE = "Home"
PORT = RSBB_PORT + 94
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

    def start_with(self, **params: Any) -> None:
        """Start the core and the node that copies, both with these parameters."""
        # Parameters stay on the master after a test.
        params = {"backup_dir": "none", "standby_port": 0, **params}
        self.start_core(self.log_dir, **params)
        params = {"log_dir": self.log_dir, "bind_host": BOX, "passwords_file": PARAMS["passwords_file"],
                  "rsbb_host": BROADCAST, "rsbb_port": RSBB_PORT, **params}
        self.backup = self._leaving(Program(
            own("roah_rsbb_backup"), *(f"_{name}:={value}" for name, value in params.items())))

    def wait_copied(self, text: str, folder: Optional[pathlib.Path] = None) -> None:
        """Wait until the copy in a folder, the stick if none is given, has an entry."""
        self.wait_no_warning(COPY)

        def has_it() -> bool:
            if not (folder or self.stick).joinpath(FILE_NAME).exists():
                return False
            try:
                copy = self.journal(folder or self.stick)
            except JournalError:  # it has only begun
                return False
            return any(text in str(entry.value) for run in copy.runs() for entry in copy.entries(run.identity))

        wait_until(has_it, f"the copy has {text}")

    def test_a_core_continues_from_the_copy(self) -> None:
        self.start_with(backup_dir=self.stick)
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

    def test_a_core_continues_from_the_copy_on_a_standby(self) -> None:
        far = self.folder / "far"
        self.start_with(standby_port=PORT)
        self.backup.wait_printed("with the code")
        code = re.search("with the code ([A-Z0-9-]+)", self.backup.text).group(1)
        follower = self._leaving(Program(
            own("standby"), "follow", BOX, "--port", str(PORT), "--code", code, "--log-dir", str(far)))
        robot = self.robot("Alpha")
        port = self.box.connect(ZONE)
        self.box.start(ZONE)
        robot.wait_did("execute HGTKMH")
        self.box.set_score(ZONE, *DOOR, 1)
        self.wait_copied(DOOR[1], far)
        refused = run(own("standby"), "takeover", "--log-dir", str(far), "bind_host:=127.0.0.99")
        self.assertEqual(refused.returncode, 1)
        # On a busy machine, one of both may be late.
        self.assertRegex(refused.stderr, f"The box at {BOX} answers|another RSBB transmits")

        self.core.kill()
        self.backup.close()
        follower.close()
        self.log_dir.rename(self.folder / "burnt")
        self.start_core(far, passwords_file=far / "passwords.yaml")
        details = self.box.zone_details(ZONE)
        self.assertEqual((details.phase, details.port), ("running", port))
        self.box.wait_scored(ZONE, (*DOOR, 0, 1))
        robot.let("execute")
        self.box.wait_text(ZONE, "Benchmark completed by the robot")

    def test_a_stick_that_is_pulled_out(self) -> None:
        self.start_with(backup_dir=self.stick)
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
        self.start_with(backup_dir=self.stick)
        state = rospy.wait_for_message("/copies/state", CopyState, LIMIT_S)
        self.assertEqual(state.place, str(self.stick))
        self.backup.close()
        self.assertIn(COPY, self.wait_warned("does not report"))
