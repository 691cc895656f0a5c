"""The journal's copy on a stick: a core on it continues the run, and referees are warned while it is missing."""

import os
import pathlib
import re
import tempfile
from typing import Any, Dict, List, Optional

import rospy
from support.box_case import LISTENER
from support.box_client import BoxClient, Refusal
from support.own_core import OTHER, OTHER_CORE, PARAMS, OwnCoreCase
from support.programs import Program, own, run
from support.robots import BOX, BROADCAST, RSBB_PORT
from support.waiting import LIMIT_S, wait_until

from roah_rsbb.journal import kinds
from roah_rsbb.journal.file import FILE_NAME
from roah_rsbb.journal.reader import JournalError
from roah_rsbb.msg import CopyState, CoreToPublic, PublicDetails, Superseded

ZONE = "Home"
PORT = RSBB_PORT + 94
STANDBY = "127.0.0.7"
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
        params = {"backup_dir": "none", "standby_port": 0, "sync_standby": False, **params}
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

    def test_a_standby_takes_over(self) -> None:
        far = self.folder / "far"
        self.start_with(standby_port=PORT, sync_standby=True)
        self.backup.wait_printed("with the code")
        code = re.search("with the code ([A-Z0-9-]+)", self.backup.text).group(1)
        follower = self._leaving(Program(
            "env", own("standby"), "follow", BOX, "--port", str(PORT), "--code", code, "--log-dir", str(far)))
        robot = self.robot("Alpha")
        port = self.box.connect(ZONE)
        self.box.start(ZONE)
        robot.wait_did("execute HGTKMH")
        self.box.set_score(ZONE, *DOOR, 1)
        self.wait_copied(DOOR[1], far)
        self.assert_confirmed_with_copy(far)
        refused = run(own("standby"), "takeover", "--log-dir", str(far), "bind_host:=127.0.0.99")
        self.assertEqual(refused.returncode, 1)
        self.assertIn(f"The box at {BOX} is heard", refused.stderr)

        # The box hangs, and its standby takes over.
        self.core.stop()
        self.addCleanup(self.core.proceed)
        self.backup.close()
        taken = self.take_over(far)
        follower.wait_ended()
        other = self.start_other_core(taken)
        details = wait_until(lambda: other.zone_details(ZONE), "the other core has the zone")
        self.assertEqual((details.phase, details.port), ("running", port))
        other.wait_scored(ZONE, (*DOOR, 0, 1))

        # When the box continues, it hears its successor, and stops.
        self.core.proceed()
        self.assert_superseded()
        self.assert_not_live()
        listener = self.participant(LISTENER)
        with self.assertRaisesRegex(Refusal, "has taken over"):
            self.box.set_score(ZONE, *DOOR, 2)
        robot.wait_did("execute HGTKMH", 2)  # after 5 s without its first box
        robot.let("execute")
        other.wait_text(ZONE, "Benchmark completed by the robot")

        # When it starts again, it does not send anything either.
        self.core.kill()
        self.start_core(self.log_dir, standby_port=PORT)
        self.assert_superseded()
        # A beacon of the other box that is later than that shows that the listener hears boxes.
        clock = other.gui.clock
        heard = len(listener.heard)
        wait_until(lambda: STANDBY in {host for _, host in listener.heard[heard:]} and other.gui.clock > clock,
                   "the other box is heard")
        self.assertNotIn(BOX, {host for _, host in listener.heard})

    def assert_confirmed_with_copy(self, far: pathlib.Path) -> None:
        """The standby has each entry when its call returns. On a busy machine, a warning is logged instead."""
        warning, again = "The standby does not have the referees' last entries yet", "The standby has all entries again"
        for value in (0, 1, 0, 1):
            # While an earlier entry is missing, no other warning is logged.
            wait_until(lambda: self.core.text.count(again) >= self.core.text.count(warning), again)
            before = self.core.text.count(warning)
            self.box.set_score(ZONE, *DOOR, value)
            there, here = self.marks(far), self.marks(self.log_dir)
            self.assertEqual(there, here[:len(there)])
            if there != here:
                self.core.wait_printed(warning, before + 1)

    def marks(self, folder: pathlib.Path) -> List[Any]:
        """Return the referee's marks in a journal."""
        journal = self.journal(folder)
        return [entry.value for run in journal.runs() for entry in journal.entries(run.identity)
                if entry.kind == kinds.COMMAND and DOOR[1] in str(entry.value)]

    def take_over(self, far: pathlib.Path) -> Dict[str, str]:
        """Take over with the copy in a folder; returns the arguments with which roslaunch would start the box."""
        programs = self.folder / "bin"
        programs.mkdir()
        (programs / "roslaunch").write_text("#!/bin/sh\nprintf '%s\\n' \"$@\"\n")
        (programs / "roslaunch").chmod(0o755)
        done = run(own("standby"), "takeover", "--anyway", "--log-dir", str(far), f"bind_host:={STANDBY}",
                   PATH=f"{programs}:{os.environ['PATH']}")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("Epoch 2", done.stdout)
        words = done.stdout.splitlines()
        return dict(word.split(":=") for word in words[words.index("roah_rsbb.launch") + 1:])

    def start_other_core(self, params: Dict[str, str]) -> BoxClient:
        """Start the core of another computer."""
        params = {**PARAMS, **params}
        self._leaving(Program(own("roah_rsbb_core"), *OTHER_CORE, *(
            f"_{name}:={value}" for name, value in params.items())))
        return self._leaving(BoxClient(prefix=OTHER)).wait_heard()

    def assert_superseded(self) -> None:
        """The box says on each panel that it was superseded, and by whom."""
        warning = self.wait_warned("This box is superseded")
        wait_until(lambda: warning in self.box.gui.status, "the status says so, too")
        heard = rospy.wait_for_message("/core/superseded", Superseded, LIMIT_S)
        wait_until(lambda: self.box.details.box_uuid == heard.box_uuid, "that topic is from the same core")
        self.assertIn(f"the box at {heard.by} has taken over", warning)

    def assert_not_live(self) -> None:
        """Public displays hear no clock any more, so they say that there is no signal."""
        details, public = [], []
        for topic, kind, heard in (("public_details", PublicDetails, details), ("to_public", CoreToPublic, public)):
            self.addCleanup(rospy.Subscriber(f"/core/{topic}", kind, heard.append).unregister)
        # Both came twice a second. The first one may be an old one that is latched.
        wait_until(lambda: [message.clock for message in public].count("not live") > 4, "the box publishes")
        details = [message for message in details if message.box_uuid == self.box.details.box_uuid]
        self.assertLessEqual(len(details), 1, "only the latched one")
        self.assertFalse(public[-1].schedule)

    def test_a_stick_that_is_pulled_out(self) -> None:
        self.start_with(backup_dir=self.stick)
        self.wait_no_warning(COPY)
        away = self.folder / "away"
        self.stick.rename(away)
        self.assertIn(COPY, self.wait_warned("Plug the stick in again"))
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
