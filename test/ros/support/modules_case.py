"""Whole runs of functionality benchmarks: the real modules, a dummy robot, and a referee who answers."""

import json
import pathlib
import shutil
import tempfile
from typing import Callable, Dict, List, Tuple

import rospy

from roah_rsbb.msg import ModulesState
from support.box_case import BoxCase
from support.programs import Program, own
from support.robots import BROADCAST, CONFIG, PASSWORDS, RSBB_PORT, Robot, host_of
from support.run_logs import RunLog
from support.waiting import happened

Scores = Dict[Tuple[str, str], object]


class FunctionalityCase(BoxCase):
    """A test case in which zones are named by their benchmarks."""

    def dummy_robot(self, team: str, *options: str, execute_s: float = 0.3) -> Program:
        """A dummy robot as a program."""
        return self._leaving(Program(
            own("dummy_robot"), "--team", team, "--password", PASSWORDS[team], "--host", BROADCAST,
            "--port", str(RSBB_PORT), "--bind", host_of(team), "--prepare-duration", "0.1", "--execute-duration",
            str(execute_s), *options,
        ))

    def begin(self, zone: str) -> None:
        """Connect and start."""
        self.box.connect(zone)
        self.box.start(zone)
        self.box.wait_details(zone, lambda d: d.phase != "connected", "the run is started")

    def answer(self, zone: str, after: int = 0, answer: str = "") -> int:
        """Complete the next manual operation after that number; returns its number."""
        number = self.box.wait_details(zone, lambda d: d.operation > after and d.operation, "the referee is asked")
        self.box.act("operation", zone, operation=number, answer=answer)
        return number

    def conduct(self, zone: str, switches: Callable[[], None] = lambda: None) -> Tuple[Scores, RunLog]:
        """From connect to disconnect, with the first answer to each manual operation."""
        self.begin(zone)
        return self.to_the_end(zone, switches=switches)

    def to_the_end(
        self, zone: str, after: int = 0, switches: Callable[[], None] = lambda: None, end_reason: str = "completed"
    ) -> Tuple[Scores, RunLog]:
        """The rest of a run: its scores, in the details and in the log, and the log."""
        def something(details) -> bool:
            return details.phase == "ended" or details.operation > after or self.box.last_zone(zone).omf_complete

        while True:
            details = self.box.wait_details(
                zone, lambda d: something(d) and d, "the run ends, or the referee has something to do"
            )
            if details.phase == "ended":
                break
            if details.operation > after:
                after = self.answer(zone, after)
            else:
                switches()
        self.assertEqual(details.end_reason, end_reason, self.box.zone(zone).state)
        scores = {(s.group, s.name): json.loads(s.value) for s in details.module_scores}
        log = self.leave(zone)
        logged = json.loads(log.values("/rsbb_log/bmbox/score")[-1])
        self.assertEqual({(s["group"], s["name"]): s["value"] for s in logged}, scores)
        return scores, log

    def of_each(self, scores: Scores, name: str) -> List[object]:
        """The values of that name in all groups."""
        return [value for (group, known), value in scores.items() if group and known == name]


class ModulesProcess(Program):
    """A node of benchmarking modules."""

    def __init__(self, name: str, folder: pathlib.Path, benchmarks: str = "all") -> None:
        super().__init__(own("roah_rsbb_modules"), f"__name:={name}", f"_parameters_dir:={folder}",
                         f"_benchmarks:={benchmarks}")

    def kill(self) -> None:
        """As a crash would."""
        self._process.kill()
        self.wait_ended()


class FaultsCase(FunctionalityCase):
    """A test case with its own processes of modules and its own folder of parameters."""

    def setUp(self) -> None:
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name) / "modules"
        shutil.copytree(str(CONFIG / "modules"), str(self.folder))

    def listen(self) -> List[ModulesState]:
        """Follow /modules/state from now on."""
        heard: List[ModulesState] = []

        def on_state(message: ModulesState) -> None:
            heard.append(message)
            happened()

        subscriber = rospy.Subscriber("/modules/state", ModulesState, on_state)
        self.addCleanup(subscriber.unregister)
        return heard

    def modules(self, name: str = "modules_of_the_test", benchmarks: str = "all") -> ModulesProcess:
        """A process that ends with the test."""
        return self._leaving(ModulesProcess(name, self.folder, benchmarks))

    def goals_done(self, robot: Robot, times: int) -> None:
        """Let the robot complete the goal that it executes, which is its goal of this number."""
        robot.wait_did("execute STB", times)
        robot.let("execute")

    def scored(self, zone: str, name: str) -> float:
        """The first value of that name, once there is one."""
        def found(details):
            return next((float(s.value) for s in details.module_scores if s.name == name), None)
        return self.box.wait_details(zone, found, f"there is a {name}")
