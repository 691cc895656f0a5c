"""The journal's copy on a standby, which takes over, and referees who are warned while it is missing."""

import contextlib
import os
import pathlib
import re
import signal
import tempfile
from typing import Any, Dict, Iterable, List

import rospy
from support.box_case import LISTENER
from support.box_client import BoxClient, Refusal
from support.own_core import OTHER, OTHER_CORE, PARAMS, OwnCoreCase
from support.programs import Program, own, run
from support.robots import BOX, RSBB_PORT
from support.waiting import LIMIT_S, wait_until

from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.journal.reader import JournalError
from roah_rsbb.journal.records import Kind
from roah_rsbb.msg import CoreToPublic
from roah_rsbb.standby.program.copying import LOCK

ZONE = "Home"
PORT = RSBB_PORT + 94
STANDBY = "127.0.0.7"
DOOR = ("Achievements", "Detects the door whose state has changed")
COPY = "The copy of the journal"


def mode_of(path: pathlib.Path) -> int:
    """Who may do what with a file or folder."""
    return path.stat().st_mode & 0o777


def modes_of(paths: Iterable[pathlib.Path]) -> Dict[pathlib.Path, int]:
    """The permissions of files. The programs replace some of them meanwhile."""
    found = {}
    for path in paths:
        with contextlib.suppress(FileNotFoundError):
            found[path] = mode_of(path)
    return found


class TestBackup(OwnCoreCase):
    def setUp(self) -> None:
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.log_dir, self.stick = self.folder / "logs", self.folder / "stick"
        self.stick.mkdir()

    def start_with(self, durable: str = "", **params: Any) -> None:
        """Start the core, which starts the program that copies. `durable`: what the schedule says."""
        self.schedule = self.folder / "schedule.yaml"
        text = PARAMS["schedule_file"].read_text("utf-8")
        self.schedule.write_text(text + (f"- durable: {durable}\n" if durable else ""), "utf-8")
        # Parameters stay on the master after a test.
        params = {"backup_dir": "none", "standby_port": 0, **params}
        self.start_core(self.log_dir, schedule_file=self.schedule, **params)
        if params["standby_port"]:
            self.core.wait_printed("can be paired on TCP port")

    def end_copying(self) -> None:
        """End the program that copies. The core starts it again, if it runs."""
        os.kill(int((self.log_dir / LOCK).read_text("ascii").split()[0]), signal.SIGTERM)

    def wait_copied(self, text: str, folder: pathlib.Path) -> None:
        """Wait until the copy in a folder has an entry."""
        self.wait_no_warning(COPY)

        def has_it() -> bool:
            if not folder.joinpath(JOURNAL).exists():
                return False
            try:
                copy = self.journal(folder)
            except JournalError:  # it has only begun
                return False
            return any(text in str(entry.value) for run in copy.runs() for entry in copy.entries(run.identity))

        wait_until(has_it, f"the copy has {text}")

    def test_a_standby_takes_over(self) -> None:
        far = self.folder / "far"
        self.start_with("two", standby_port=PORT)
        follower = self.start_standby(far)
        robot = self.robot("Alpha")
        port = self.box.connect(ZONE)
        self.box.start(ZONE)
        robot.wait_did("execute HGTKMH")
        self.assert_confirmed_with_copy(far)
        self.wait_copied(DOOR[1], far)
        refused = run(own("standby"), "takeover", "--log-dir", str(far), "bind_host:=127.0.0.99")
        self.assertEqual(refused.returncode, 1)
        self.assertIn(f"The box at {BOX} is heard", refused.stderr)

        # The box hangs, and its standby takes over.
        self.core.stop()
        self.addCleanup(self.core.proceed)
        self.end_copying()
        taken = self.take_over(far)
        follower.wait_ended()
        other = self.start_other_core(taken)
        details = wait_until(lambda: other.zone_details(ZONE), "the other core has the zone")
        self.assertEqual((details.phase, details.port), ("running", port))
        other.wait_scored(ZONE, (*DOOR, 0, 1))

        # When the box continues, it asks before it does anything, hears its successor, and ends.
        listener = self.participant(LISTENER)
        wait_until(lambda: STANDBY in {host for _, host in listener.heard}, "the other box sends")
        listener.heard.clear()
        clock, document, entries = self.box.gui.clock, self.box.document, self.entries(self.log_dir)
        self.core.proceed()
        self.assertEqual(self.core.wait_ended(), 1)
        self.assertRegex(self.core.text, "was not running for .* The box at .* has taken over meanwhile")
        self.network.read_all()
        self.assertNotIn(BOX, {host for _, host in listener.heard}, "it sends nothing to robots")
        self.assertEqual((self.box.gui.clock, self.box.document), (clock, document), "and nothing to panels")
        self.assertEqual(self.entries(self.log_dir), entries, "and records nothing")
        # The robot changes to it after 5 s without its first box, and continues.
        robot.let("execute")
        other.wait_text(ZONE, "Benchmark completed by the robot")

        # When it starts again, it does not send anything either.
        self.start_core(self.log_dir, standby_port=PORT)
        self.assert_superseded()
        self.assert_not_live()
        with self.assertRaisesRegex(Refusal, "has taken over"):
            self.box.set_score(ZONE, *DOOR, 2)
        # A beacon of the other box that is later than that shows that the listener hears boxes.
        clock = other.gui.clock
        heard = len(listener.heard)
        wait_until(lambda: STANDBY in {host for _, host in listener.heard[heard:]} and other.gui.clock > clock,
                   "the other box is heard")
        self.assertNotIn(BOX, {host for _, host in listener.heard})

    def start_standby(self, far: pathlib.Path) -> Program:
        """Pair a standby that keeps its copy in this folder."""
        return self._leaving(Program(
            "env", own("standby"), "follow", BOX, "--port", str(PORT), "--code", self.code(), "--log-dir", str(far)))

    def code(self) -> str:
        """Make a code to pair a standby with, as the organiser does."""
        shown = run(own("standby"), "code", "--log-dir", str(self.log_dir))
        self.assertEqual(shown.returncode, 0, shown.stderr)
        return re.search("The code is ([A-Z0-9-]+)", shown.stdout).group(1)

    def enter(self, value: int) -> str:
        """Enter a score; returns why it is not confirmed; empty: it is."""
        try:
            self.box.set_score(ZONE, *DOOR, value)
        except Refusal as refused:
            self.assertIn("not confirmed: ", str(refused))
            return str(refused)
        return ""

    def assert_confirmed_with_copy(self, far: pathlib.Path) -> None:
        """The standby has each entry that was confirmed. A busy machine may not confirm some of them in time."""
        for value in (0, 1, 0, 1):
            wait_until(lambda value=value: not self.enter(value), "an entry is confirmed")
            there = self.marks(far)
            self.assertTrue(there)
            self.assertEqual(there, self.marks(self.log_dir))

    def test_others_may_read_neither_journal_nor_copies(self) -> None:
        far = self.folder / "far"
        self.start_core(self.log_dir, backup_dir=self.stick, standby_port=PORT)
        self.core.wait_printed("can be paired on TCP port")
        self.assertEqual(mode_of(self.log_dir), 0o750)
        self.start_standby(far).wait_printed("The copy is kept")
        self.wait_no_warning(COPY)
        self.assertEqual(mode_of(far), 0o750)
        for folder in (self.log_dir, self.stick, far):
            journal = folder / JOURNAL
            wait_until(lambda journal=journal: journal.is_dir() and list(journal.glob("*.log")), f"{journal} is there")
            self.assertEqual(mode_of(journal), 0o750)
            self.assertEqual(set(modes_of(journal.iterdir()).values()), {0o640})
            self.assertEqual([path for path, mode in modes_of(folder.rglob("*")).items() if mode & 0o007], [])

    def marks(self, folder: pathlib.Path) -> List[Any]:
        """Return the referee's marks in a journal."""
        journal = self.journal(folder)
        return [entry.value for run in journal.runs() for entry in journal.entries(run.identity)
                if entry.kind == Kind.COMMAND and DOOR[1] in str(entry.value)]

    def entries(self, folder: pathlib.Path) -> List[Any]:
        """Return all entries of runs in a journal."""
        journal = self.journal(folder)
        return [entry for run in journal.runs() for entry in journal.entries(run.identity)]

    def path_of_a_roslaunch_that_prints(self) -> str:
        """Return a PATH with a roslaunch that only prints its arguments."""
        programs = self.folder / "bin"
        programs.mkdir()
        (programs / "roslaunch").write_text("#!/bin/sh\nprintf '%s\\n' \"$@\"\n")
        (programs / "roslaunch").chmod(0o755)
        return f"{programs}:{os.environ['PATH']}"

    def arguments_in(self, text: str) -> Dict[str, str]:
        """Return the arguments with which roslaunch would start the box that took over."""
        self.assertIn("Epoch 2", text)
        words = text.splitlines()
        return dict(word.split(":=") for word in words[words.index("roah_rsbb.launch") + 1:] if ":=" in word)

    def take_over(self, far: pathlib.Path) -> Dict[str, str]:
        """Take over with the copy in a folder; returns the arguments with which roslaunch would start the box."""
        done = run(own("standby"), "takeover", "--anyway", "--log-dir", str(far), f"bind_host:={STANDBY}",
                   PATH=self.path_of_a_roslaunch_that_prints())
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.arguments_in(done.stdout)

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
        by = wait_until(lambda: self.box.document.box.superseded_by, "panels know who took over")
        self.assertIn(f"the box at {by} has taken over", warning)

    def assert_not_live(self) -> None:
        """The original's public displays are shown no clock and no events any more."""
        public = rospy.wait_for_message("/core/to_public", CoreToPublic, LIMIT_S)
        self.assertEqual((public.clock, public.schedule), ("not live", []))
