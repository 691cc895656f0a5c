"""The journal of a box that runs, as `rosrun roah_rsbb results` shows it."""

import json
import os
import pathlib
import subprocess
import tempfile
from typing import Any, Dict, List

import rospy
from support.box_case import BoxCase
from support.programs import own
from support.robots import host_of
from support.waiting import LIMIT_S, wait_until

from roah_rsbb.ground.installed import shipped_folder
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.journal.reader import JournalReader

ZONE = "Home"
DOOR = ("Achievements", "Detects the door whose state has changed")
BUMPS = ("Penalized Behaviors", "Bumps into the furniture")
# Nobody answers there: results need no ROS master.
NO_MASTER = "http://127.0.0.1:1"


class ResultsCase(BoxCase):
    def setUp(self) -> None:
        super().setUp()
        self.log_dir = rospy.get_param("/roah_rsbb_core/log_dir")

    def results(self, *arguments: str) -> str:
        """Return the program's output."""
        done = subprocess.run(
            [own("results"), "--log-dir", self.log_dir, *arguments], text=True, timeout=LIMIT_S,
            capture_output=True, env={**os.environ, "ROS_MASTER_URI": NO_MASTER},
        )
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def exported(self, identity: str) -> Dict[str, Any]:
        """A run as JSON."""
        [run] = json.loads(self.results("export", "--json", "-", identity))["runs"]
        return run

    def links(self, port: int) -> List[Dict[str, Any]]:
        """The link record of a robot so far."""
        return [link.sample for link in JournalReader(os.path.join(self.log_dir, JOURNAL)).links(port)]

    def wait_link(self, port: int, **sums: int) -> None:
        """Wait until the link record has reached these counts."""
        def counted() -> Dict[str, int]:
            return {key: sum(sample.get(key, 0) for sample in self.links(port)) for key in sums}
        wait_until(lambda: counted() == sums, lambda: f"the link record says {sums}, not {counted()}")


class TestResults(ResultsCase):
    def test_a_run_in_progress_and_one_that_is_over(self) -> None:
        robot = self.robot("Alpha")
        port = self.box.connect(ZONE)
        identity = self.box.wait_details(ZONE, lambda d: d.identity, "the run has a name")
        self.assertIn("  connected", self.results("list"))
        self.box.start(ZONE)
        robot.wait_did("execute HGTKMH")
        robot.request("notify", "<b>at the door</b>")
        robot.wait_said()
        self.box.set_score(ZONE, *DOOR, 1)
        self.box.act("mark", ZONE, identity, "Anna", group=BUMPS[0], desc=BUMPS[1], value=2, note="the vase")
        wait_until(lambda: self.links(port), "the first second of the link record")
        shown = self.results("show", identity, "--utc")
        for expected in ("running", "yes  Detects the door", "2  Bumps into", "; the vase",
                         "Anna     Penalized Behaviors: Bumps into the furniture",
                         "0 → 2", "notification: <b>at the door</b>", "Box: WAITING_RESULT", "Robot: EXECUTING",
                         "start", f"robot's address: {host_of('Alpha')}"):
            self.assertIn(expected, shown)
        self.assertNotIn("Rank  Team", self.results("standings", "HGTKMH").partition("Alpha")[2])

        self.box.command("stop", ZONE)
        self.box.wait_phase(ZONE, "ended")
        robot.wait_did("stop")
        self.box.act("stop_reason", ZONE, identity, "Anna", reason="the door was locked")
        self.wait_link(port, answers=4)  # PREPARE, WAITING_RESULT, what was notified, and STOP
        self.box.command("disconnect", ZONE)
        self.box.act("sign_off", ZONE, identity, "Chief")
        self.over(identity, port)

    def over(self, identity: str, port: int) -> None:
        run = self.exported(identity)
        self.assertEqual((run["end_reason"], run["stops"][0]["reason"]), ("stopped", "the door was locked"))
        self.assertIn("Chief", run["sign_off"]["who"])
        self.assertEqual([entry["value"] for entry in run["history"]], [1, 2])
        [part] = run["robot_parts"]
        self.assertEqual((part["port"], part["team"]), (port, "Alpha"))
        wait_until(lambda: os.path.isfile(part["log_file"]), "the bag is made, beside everything else")
        self.assertGreater(sum(sample["received"] for sample in part["link"]), 10)
        commands = [entry["value"]["command"] for entry in run["entries"] if entry["kind"] == "command"]
        self.assertEqual([c for c in commands if c in ("connect", "start", "stop", "disconnect", "sign_off")],
                         ["connect", "start", "stop", "disconnect", "sign_off"])
        ranked = self.results("standings", "HGTKMH", "--signed-off")
        self.assertIn("1     Alpha  3                 1", ranked, "as this box ranks, which has no standings_file")
        shipped = os.path.join(str(shipped_folder()), "standings.yaml")
        self.assertIn("1     Alpha  1             2", self.results("standings", "HGTKMH", "--rules", shipped))
        self.pages(identity)
        self.bag(identity, part["log_file"])

    def pages(self, identity: str) -> None:
        with tempfile.TemporaryDirectory() as directory:
            self.results("export", identity, "--html", directory)
            [sheet, index] = sorted(pathlib.Path(directory).iterdir())
            self.assertIn(f'href="{sheet.name}"', index.read_text(encoding="utf-8"))
            text = sheet.read_text(encoding="utf-8")
            self.assertIn("&lt;b&gt;at the door&lt;/b&gt;", text)
            self.assertIn("<svg", text)
            self.assertIn("the door was locked", text)

    def bag(self, identity: str, log_file: str) -> None:
        with tempfile.TemporaryDirectory() as directory:
            path = os.path.join(directory, "again.bag")
            self.results("bag", identity, path)
            self.assertEqual(self.read_log(path).entries, self.read_log(log_file).entries)
