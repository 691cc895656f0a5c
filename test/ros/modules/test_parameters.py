"""Parameters of modules that are wrong: they keep start off until they are repaired, without a restart."""

import re
import shutil

from support.modules_case import FaultsCase
from support.robots import CONFIG


class TestParameters(FaultsCase):
    def test_wrong_parameters_can_be_repaired_without_a_restart(self) -> None:
        good = (self.folder / "STB.yaml").read_text(encoding="utf-8")
        (self.folder / "STB.yaml").write_text("goals: []\ngoal_timeout: soon\n", encoding="utf-8")
        (self.folder / "HNF.yaml").unlink()  # the folder of a zone has one
        (self.folder / "HPPF.yaml").unlink()
        modules = self.modules()
        robot = self.robot("Eta")
        self.robot("Beta")
        self.box.connect("STB")
        self.box.connect("HNF")
        self.wait_off("STB", r"STB\.yaml:1: found an empty sequence as goals", r"STB\.yaml:2: found the text 'soon'")
        self.wait_off("HNF", r"HNF\.yaml")
        modules.wait_printed("No parameters there for HPPF, which cannot run")
        modules.wait_printed("found the text 'soon'")  # the last error
        self.assertNotIn("HPPF.yaml", modules.text, "an error about a benchmark that the competition does not have")
        self.assertRegex(self.box.refusal("start", "STB"), r"STB\.yaml:1: found an empty sequence")
        (self.folder / "STB.yaml").write_text(good.replace("GOAL 1", "GOAL 7"), encoding="utf-8")
        self.box.start("STB")
        self.answer("STB")
        robot.wait_did("execute STB")
        self.assertIn("GOAL 7", robot.goals[0].text)
        self.wait_off("HNF", r"HNF\.yaml")
        self.box.command("stop", "STB")

        shutil.copy(str(CONFIG / "modules" / "HNF.yaml"), str(self.folder))
        truth = self.folder / "ground_truth.yaml"
        text = truth.read_text(encoding="utf-8")
        truth.write_text(text.replace("mocap_robot", "mocap_robt"), encoding="utf-8")
        self.box.wait_details("HNF", lambda d: "frame 'mocap_robt'" in " ".join(d.warnings), "a warning")
        truth.write_text(text.replace("robot:  ", "robt:  "), encoding="utf-8")
        self.wait_off("HNF", "found the marker of 'robot' without frame")
        truth.write_text(text, encoding="utf-8")
        self.box.wait_zone("HNF", lambda z: z.start_enabled, "start is on")
        self.box.wait_details("HNF", lambda d: not d.warnings, "and there is no warning any more")

    def test_rules_and_files_of_a_zone_are_taken_without_a_restart(self) -> None:
        """A new CODE.py replaces the shipped rules, and its removal restores them. No process restarts."""
        shutil.rmtree(str(self.folder / "HNF 2"))
        heard = self.listen()
        self.modules()
        self.robot("Theta")
        self.box.connect("HNF 2")
        self.box.wait_zone("HNF 2", lambda z: z.start_enabled, "start is on")
        (self.folder / "HNF.py").write_text("CODE = 1 / 0\n", encoding="utf-8")
        self.wait_off("HNF 2", r"HNF\.py:1: found ZeroDivisionError")
        (self.folder / "HNF.py").unlink()
        self.box.wait_zone("HNF 2", lambda z: z.start_enabled, "the shipped rules are back")
        own = self.folder / "HNF 2"
        own.mkdir()
        (own / "HNF.yaml").write_text("starting_pose: [0, 0, 0]\nwaypoints: []\n", encoding="utf-8")
        self.wait_off("HNF 2", r"HNF 2/HNF\.yaml:2: found an empty sequence as waypoints")
        good = "starting_pose: [0, 0, 0]\nwaypoints: [[1, 2, 0]]\ngoal_timeout: 1\n"
        (own / "HNF.yaml").write_text(good, encoding="utf-8")
        (own / "ground_truth.yaml").write_text("source: none\n", encoding="utf-8")
        self.box.wait_details("HNF 2", lambda d: "ground truth is off" in " ".join(d.warnings), "a warning")
        self.box.wait_details("HNF 2", lambda d: not d.off("start"), "nothing is wrong")
        self.box.start("HNF 2")
        placed = self.answer("HNF 2")
        scores, _ = self.to_the_end("HNF 2", placed, end_reason="goals_timed_out")
        self.assertEqual(scores["", "timed_out"], 1)
        self.assertNotIn(("waypoint 1", "distance_error"), scores)
        self.assertEqual(len({state.node for state in heard}), 1, "the process restarted")

    def wait_off(self, zone: str, *patterns: str) -> None:
        """Wait until start is off for exactly these reasons."""
        def fits(details) -> bool:
            off = details.off("start")
            return len(off) == len(patterns) and all(map(re.search, patterns, off)) and details.robot_state
        self.box.wait_details(zone, fits, f"off: {patterns}")

    def test_a_process_drives_the_selected_benchmarks(self) -> None:
        wrong = self.modules(benchmarks="HNF,HOPV")
        self.assertEqual(wrong.wait_ended(), 1)
        self.assertIn("no module for HOPV: did you mean 'HOPF'?", wrong.text)
        self.assertNotIn("Traceback", wrong.text)
        self.modules(benchmarks="STB")
        self.robot("Eta")
        self.robot("Beta")
        self.begin("STB")
        self.box.connect("HNF")
        self.wait_off("HNF", "nothing drives HNF")
