"""A core that is killed (kill -9) at any moment: every run continues unchanged, and is recorded once and completely."""

import contextlib
import itertools
import os
import pathlib
import random
import tempfile
import threading
import unittest
from typing import List

import rospy
from support.box_client import BoxClient, Refusal
from support.own_core import Core, OwnCoreCase
from support.robots import CONFIG, Robot
from support.waiting import wait_until

from roah_rsbb.journal.file import FILE_NAME

GROUP, OBJECTS = ITEM = ("Achievements", "Objects")
STATES = ["STOP", "PREPARE", "WAITING_RESULT", "STOP"]
BENCHMARKS = {"benchmarks_file": CONFIG / "kill_benchmarks.yaml"}
KILLS = int(os.environ.get("ROAH_TEST_KILLS", "8"))
# Seconds from one start to the next kill, at most.
LIFE_S = 2.5
SCORES = 6
# In a zone; a test has 98 private ports.
MOST_RUNS = 40


class KillCase(OwnCoreCase):
    def setUp(self) -> None:
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.log_dir = self.folder / "logs"

    def run_on_record(self, port: int):
        """The journal's record of the run with this port."""
        reader = self.journal(self.log_dir)
        return next(run for run in reader.runs() for m in reader.members(run.identity) if m.port == port)

    def log_on_record(self, port: int):
        """The run log that the journal names for this port, once it is complete."""
        reader = self.journal(self.log_dir)
        paths = [m.log_file for run in reader.runs() for m in reader.members(run.identity) if m.port == port]
        return self.complete_log(pathlib.Path(paths[0]))


class TestKilledOnce(KillCase):
    def start(self, *inside: str) -> None:
        self.start_core(self.log_dir, inside, schedule_file=CONFIG / "kill.yaml", **BENCHMARKS)

    def begin(self, zone: str, robot: Robot, benchmark: str) -> int:
        """Connect and start; returns the port once the robot executes."""
        port = self.box.connect(zone)
        self.box.start(zone)
        robot.wait_did(f"execute {benchmark}")
        self.box.wait_phase(zone, "running")
        return port

    def ends(self, zone: str) -> float:
        """Return when a zone's run will time out (UTC)."""
        gui = self.box.wait_zone(zone, lambda z: z.timer.to_sec() < 600 and self.box.gui, "the time runs")
        return gui.clock.to_sec() + next(z.timer.to_sec() for z in gui.zones if z.zone == zone)

    def test_three_runs_at_once(self) -> None:
        self.start()
        box = self.box
        alpha, beta, gamma = self.robot("Alpha"), self.robot("Beta"), self.robot("Gamma")
        ports = [self.begin("Home", alpha, "HGTKMH"), self.begin("Kitchen", beta, "HCFGAC")]
        alpha.request("notify", "before")
        alpha.wait_said()
        beta.request("final_command", "bring the cup")
        beta.wait_said()
        box.set_score("Home", *ITEM, 2)
        box.set_score("Kitchen", *ITEM, 5)
        ends = [self.ends("Home"), self.ends("Kitchen")]
        ports.append(self.begin("Door", gamma, "HWV"))
        up = self.ends("Door")

        self.core.kill()
        alpha.request("notify", "while it was dead")  # is repeated until it is acknowledged
        rospy.sleep(max(0.0, up - rospy.get_time()))  # HWV's time is up
        self.start()
        self.assertEqual([box.zone_details(zone).port for zone in ("Home", "Kitchen")], ports[:2])
        for zone, end in zip(("Home", "Kitchen"), ends):
            box.wait_phase(zone, "running")
            box.wait_zone(zone, lambda z: ": the run continues" in z.log, "it is marked")
            self.assertLess(abs(self.ends(zone) - end), 1.0)
        box.wait_details("Door", lambda d: (d.phase, d.end_reason) == ("ended", "timeout"), "HWV ended by timeout")
        gamma.wait_did("stop")
        wait_until(lambda: box.timeouts, "the sound is asked for, although nobody counted the time when it was up")
        box.wait_scored("Home", (*ITEM, 1, 2))
        box.set_score("Home", *ITEM, 3)
        alpha.wait_said()
        for robot, zone in ((alpha, "Home"), (beta, "Kitchen")):
            robot.let("execute")
            box.wait_text(zone, "Benchmark completed by the robot")
        self.assertEqual([line.split(" ", 1)[1] for line in self.lines("Home")],
                         ["notifications: before", "notifications: while it was dead"])
        self.assertEqual(len(self.lines("Kitchen")), 1)
        for zone in ("Home", "Kitchen", "Door"):
            box.command("disconnect", zone)
            box.wait_phase(zone, "idle")
        for robot, benchmark in ((alpha, "HGTKMH"), (beta, "HCFGAC"), (gamma, "HWV")):
            self.assertEqual(robot.did, [f"prepare {benchmark}", f"execute {benchmark}", "stop"])
        self.assert_records(ports)
        self.assertEqual(box.timeouts, 1)

    def test_damage_in_what_no_start_reads_is_found(self) -> None:
        self.start()
        self.begin("Home", self.robot("Alpha"), "HGTKMH")
        for _ in range(2):
            self.core.kill()
            self.start()
        self.core.kill()
        # Not a draft that the core left when it was killed.
        first = min(path for path in (self.log_dir / FILE_NAME).iterdir() if b'"command"' in path.read_bytes())
        first.write_bytes(first.read_bytes().replace(b'"command"', b'"kommand"', 1))
        self.start()
        self.assertIn("A copy may have what is missing", self.wait_warned("damaged or missing, between"))

    def test_a_core_that_hangs(self) -> None:
        """The next one waits for its end, says how to end it, and continues its run."""
        self.start()
        alpha = self.robot("Alpha")
        port = self.begin("Home", alpha, "HGTKMH")
        hung, before = self.core, self.box.uuid
        self.addCleanup(hung.kill)
        hung.stop()
        waiting = self._leaving(Core({**BENCHMARKS, "schedule_file": CONFIG / "kill.yaml", "log_dir": self.log_dir}))
        wait_until(lambda: f"in use by process {hung.pid}, which is stopped" in waiting.text
                   and f"kill -9 {hung.pid}" in waiting.text, lambda: f"it waits; it printed\n{waiting.text}")
        self.assertEqual(self.box.uuid, before, "it does not speak yet")
        hung.kill()
        self.box.wait_other_core(before, lambda: f"a core is heard; it printed\n{waiting.text}")
        self.box.wait_phase("Home", "running")
        self.assertEqual(self.box.zone_details("Home").port, port, "the run continues")
        folders = [path.name for path in self.log_dir.iterdir() if path.is_dir()]
        self.assertEqual(folders, [FILE_NAME], "in the same journal")
        alpha.let("execute")
        self.box.wait_text("Home", "Benchmark completed by the robot")

    def lines(self, zone: str) -> List[str]:
        """A zone's online data."""
        return self.box.zone(zone).online_data.splitlines()

    def assert_records(self, ports: List[int]) -> None:
        """Check that the bag, the journal and the outcome agree."""
        reasons, scores, strings = ["completed", "completed", "timeout"], [[2, 3], [5], []], []
        for port, reason, score in zip(ports, reasons, scores):
            log = self.log_on_record(port)
            self.assert_log_is_the_journals(self.log_dir, port, log)
            self.assertEqual(log.values("/rsbb_log/rsbb_state_str"), STATES)
            self.assertEqual([message.value for message in log.messages("/rsbb_log/score")], score)
            strings.append(log.values("/notification") + log.values("/command"))
            outcome = self.run_on_record(port).outcome
            self.assertEqual(outcome["end_reason"], reason)
            self.assertEqual([entry["value"] for entry in outcome.get("history", [])], score)
        self.assertEqual(strings, [["before", "while it was dead"], ["bring the cup"], []])
        self.assertLess(abs(self.run_on_record(ports[2]).outcome["elapsed_s"] - 6.0), 1.0)


class Conducted:
    """A run as its referee and its robot remember it."""

    def __init__(self, port: int) -> None:
        self.port = port
        self.scored = 0  # the last value that the box accepted
        self.said: List[str] = []
        self.is_let = False


class Referee:
    """Conducts one run after the other in a zone, even if the core is killed in the meantime."""

    def __init__(self, box: BoxClient, zone: str, robot: Robot, benchmark: str) -> None:
        self.runs: List[Conducted] = []
        self.zone, self.robot, self._box = zone, robot, box
        self._executed = f"execute {benchmark}"

    def remembers(self) -> str:
        """Return details for the message of a failure."""
        return f"{[vars(run) for run in self.runs]}; its robot did {self.robot.did}"

    def step(self, resumes: bool) -> bool:
        """Do the next step. Returns False if the zone is idle and no further run is wanted."""
        details = self._box.last_details(self.zone)
        with contextlib.suppress(Refusal, AssertionError, rospy.ROSException):  # the core died, or is ahead
            if details.phase == "idle":
                if not resumes:
                    return False
                self._box.command("connect", self.zone)
            elif details.phase == "connected":
                self._box.command("start", self.zone)
            elif details.phase == "running":
                self._conduct(details.port)
            else:
                self._box.command("disconnect", self.zone)
        return True

    def _conduct(self, port: int) -> None:
        if not self.runs or self.runs[-1].port != port:
            self.runs.append(Conducted(port))
        run = self.runs[-1]
        if run.is_let or self.robot.did.count(self._executed) < len(self.runs):
            return
        if run.scored < SCORES:
            if self.robot.client.strings_pending == 0:
                run.said.append(f"{port}: {len(run.said)}")
                self.robot.request("notify", run.said[-1])
            self._box.set_score(self.zone, *ITEM, run.scored + 1)
            run.scored += 1
        elif self.robot.client.strings_pending == 0:
            run.is_let = True
            self.robot.let("execute")


def conduct(referees: List[Referee], enough: threading.Event) -> None:
    """Conduct runs until there are enough."""
    while not enough.wait(0.05):
        for referee in referees:
            referee.step(resumes=len(referee.runs) < MOST_RUNS)


@unittest.skipUnless(os.environ.get("ROAH_TEST_ALL") == "yes", "only in make test-all")
class TestKilledAtRandom(KillCase):
    def schedule(self) -> pathlib.Path:
        """Two zones with many runs."""
        path = self.folder / "schedule.yaml"
        with path.open("w") as file:
            for zone, team in (("Home", "Alpha"), ("Kitchen", "Beta")):
                file.write(f"- zone: {zone}\n  schedule:\n")
                for run in range(1, 41):
                    file.write(f"    - {{ benchmark: HGTKMH, team: {team}, round: 1, run: {run}, "
                               f"scheduled_time: 2015-12-31 09:{run:02}:00 }}\n")
        return path

    def test_killed_again_and_again(self) -> None:
        seed = os.environ.get("ROAH_TEST_SEED", "") or os.urandom(4).hex()
        print(f"ROAH_TEST_SEED={seed} has the core killed at the same moments again")
        schedule = self.schedule()
        self.start_core(self.log_dir, schedule_file=schedule, **BENCHMARKS)
        referees = [Referee(self.box, "Home", self.robot("Alpha"), "HGTKMH"),
                    Referee(self.box, "Kitchen", self.robot("Beta"), "HGTKMH")]
        enough = threading.Event()
        conducting = threading.Thread(target=conduct, args=(referees, enough))
        conducting.start()
        self.addCleanup(conducting.join)
        self.addCleanup(enough.set)
        moments, never = random.Random(seed), threading.Event()
        for _ in range(KILLS):
            never.wait(moments.uniform(0.0, LIFE_S))
            self.core.kill()
            # Programs end with the thread that starts them: it is this one.
            self.start_core(self.log_dir, schedule_file=schedule, **BENCHMARKS)
        enough.set()
        conducting.join()
        for referee in referees:
            wait_until(lambda r=referee: not r.step(resumes=False),
                       lambda r=referee: f"the last run is over: {r.remembers()}; the core printed\n{self.core.text}")
        self.assertIsNone(self.core.ended_mono, f"the last core lives; it printed\n{self.core.text}")
        for referee in referees:
            self.assertTrue(referee.runs)
            self.assertEqual(referee.robot.did, ["prepare HGTKMH", "execute HGTKMH", "stop"] * len(referee.runs))
            for run in referee.runs:
                self.assert_on_record(run)
        ports = [member.port for run in self.journal(self.log_dir).runs()
                 for member in self.journal(self.log_dir).members(run.identity)]
        self.assertEqual(len(set(ports)), len(ports), "no port is given twice")

    def assert_on_record(self, run: Conducted) -> None:
        """All that referee and robot remember of a run is in its bag and in the journal, once and in order."""
        log = self.log_on_record(run.port)
        self.assert_log_is_the_journals(self.log_dir, run.port, log)
        self.assertEqual(log.values("/rsbb_log/rsbb_state_str"), STATES)
        self.assertEqual(log.values("/notification"), run.said)
        # What a core took and could not answer any more the referee does again.
        scores = [value for value, _ in itertools.groupby(m.value for m in log.messages("/rsbb_log/score"))]
        self.assertEqual(scores, list(range(1, SCORES + 1)))
        record = self.run_on_record(run.port)
        self.assertEqual(record.outcome["end_reason"], "completed")
        self.assertIsNotNone(record.closed_utc)
        # The sheet counts quick changes of an item as one: each continues the one before.
        changes = [(entry["old"], entry["value"]) for entry in record.outcome["history"]]
        self.assertEqual([old for old, _ in changes] + [SCORES], [0] + [value for _, value in changes])
