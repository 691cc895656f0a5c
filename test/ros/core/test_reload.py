"""An organiser changes the configuration in the middle of a competition, in a terminal. The core is killed."""

import pathlib
import shutil
import tempfile

from support.own_core import OwnCoreCase
from support.referee_program import called
from support.robots import CONFIG

LATE = """\
- zone: Door
  schedule:
    - { benchmark: HWV,    team: Gamma, round: 1, run: 1, scheduled_time: 2015-12-31 09:00:00 }
"""


class TestReload(OwnCoreCase):
    """Team Gamma and its zone are not in the files at first."""

    def setUp(self) -> None:
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name, source in (("benchmarks", "kill_benchmarks"), ("schedule", "kill"), ("passwords", "passwords")):
            shutil.copy(str(CONFIG / f"{source}.yaml"), str(self.folder / f"{name}.yaml"))
        self.edit("schedule", LATE, "")
        self.late_password = next(
            line for line in self.text("passwords").splitlines(keepends=True) if line.startswith("Gamma"))
        self.edit("passwords", self.late_password, "")
        self.start()

    def start(self) -> None:
        files = {f"{name}_file": self.folder / f"{name}.yaml" for name in ("benchmarks", "schedule", "passwords")}
        self.start_core(self.folder / "logs", **files)

    def text(self, name: str) -> str:
        return (self.folder / f"{name}.yaml").read_text("utf-8")

    def edit(self, name: str, old: str, new: str) -> None:
        text = self.text(name)
        self.assertIn(old, text)
        (self.folder / f"{name}.yaml").write_text(text.replace(old, new, 1), "utf-8")

    def zones(self) -> list:
        return [zone.zone for zone in self.box.gui.zones]

    def test_a_late_team_a_new_time_and_a_core_that_is_killed(self) -> None:
        robot = self.robot("Alpha")
        self.box.connect("Home")
        self.box.start("Home")
        robot.wait_did("execute HGTKMH")
        port = self.box.zone_details("Home").port

        # Errors change nothing, and all of them are reported at once.
        self.edit("benchmarks", "timeout: 600", "timeout: soon")
        self.edit("schedule", "team: Beta, ", "team: Bet, ")
        wrong = called("reload", "--yes")
        self.assertEqual((wrong.returncode, wrong.stdout), (1, ""))
        self.assertRegex(wrong.stderr, r"benchmarks\.yaml:5: found the text 'soon'")
        self.assertRegex(wrong.stderr, r"schedule\.yaml:\d+: found team 'Bet'")
        self.assertIn("Nothing was changed", wrong.stderr)

        # What changes is listed before it is applied.
        self.edit("benchmarks", "timeout: soon", "timeout: 300")
        self.edit("schedule", "team: Bet, ", "team: Beta, ")
        self.edit("schedule", self.text("schedule"), self.text("schedule") + LATE)
        self.edit("passwords", "Delta:", self.late_password + "Delta:")
        listed = called("reload", "--check")
        self.assertEqual((listed.returncode, listed.stderr), (0, ""))
        changes = ["benchmark HGTKMH: timeout 600, now 300", "benchmark HGTKMH: total timeout 600, now 300",
                   "team 'Gamma': added", "zone 'Door': added, with 1 event"]
        self.assertEqual([line for line in listed.stdout.splitlines() if not line.startswith("warning")], changes)
        self.assertEqual(called("reload").returncode, 2)  # nobody can be asked here
        self.assertEqual(self.zones(), ["Home", "Kitchen"])
        done = called("reload", "--yes", "--by", "Olga")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(done.stdout.splitlines()[-1], "The changes are in force")
        schedule = self.text("schedule")
        self.assertEqual(schedule.count("{ id: "), schedule.count("scheduled_time: "), "each event has an id now")
        self.assertIn("The files contain what is in force", called("reload").stdout)

        # The late team takes part. The run in progress keeps its time.
        self.box.wait_zone("Home", lambda z: self.zones() == ["Home", "Kitchen", "Door"], "the late team has its zone")
        late = self.robot("Gamma")
        self.box.connect("Door")
        self.box.start("Door")
        late.wait_did("execute HWV")
        self.box.command("stop", "Door")

        # Another benchmark at an event that had a run: the organiser is warned before it is applied.
        self.edit("schedule", "benchmark: HWV,    team: Gamma", "benchmark: HGTKMH, team: Gamma")
        listed = called("reload", "--check").stdout.splitlines()
        event = "zone 'Door': HWV of Gamma, round 1, run 1, 2015-12-31 "
        self.assertTrue([line for line in listed if line.startswith(event)
                         and line.endswith(": now HGTKMH of Gamma, round 1, run 1")], listed)
        warning, = (line for line in listed if "is no attempt at this event" in line)
        self.assertTrue(warning.startswith("warning: zone 'Door': HWV of Gamma, round 1, run 1 is HGTKMH"), warning)
        self.edit("schedule", "benchmark: HGTKMH, team: Gamma", "benchmark: HWV,    team: Gamma")
        self.assertGreater(self.box.zone("Home").timer.to_sec(), 400.0)

        # A core that is killed continues with all of it, although an editor has left a file with errors.
        self.edit("schedule", "benchmark: HGTKMH", "benchmark: NOTHING")
        self.core.kill()
        self.start()
        self.assertEqual(self.zones(), ["Home", "Kitchen", "Door"])
        self.wait_warned("The configuration files were changed since the box read them")
        details = self.box.zone_details("Home")
        self.assertEqual((details.phase, details.port), ("running", port))
        self.assertGreater(self.box.zone("Home").timer.to_sec(), 400.0)
        self.box.command("stop", "Home")
        self.box.command("disconnect", "Home")
        self.box.wait_phase("Home", "idle")
        self.box.connect("Home")
        self.assertLessEqual(self.box.zone("Home").timer.to_sec(), 300.0)

        reader = self.journal(self.folder / "logs")
        reloads = [entry for entry in reader.entries("") if entry.kind == "reload"]
        self.assertEqual([(entry.value["version"], entry.value["changes"]) for entry in reloads], [(1, changes)])
        self.assertIn("Olga", reloads[0].who)
