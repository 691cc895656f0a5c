"""The dummy box: the core and the shipped rules against the dummy robot, in simulated time, and its arguments."""

import asyncio
import re

import pytest

from helpers.checked_robot import BOX, BROADCAST, PASSWORD, TEAM, usual_robot
from helpers.simulated_air import SimulatedLoop
from roah_rsbb.bmbox.framework.ground_truth import Pose2D
from roah_rsbb.check import dummy_box
from roah_rsbb.check.dummy_box import DummyBox, parameters_of
from roah_rsbb.comm import channels
from roah_rsbb.comm.channels import Network
from roah_rsbb.comm.ciphers import Cipher
from roah_rsbb.comm.peer import MemoryAir
from roah_rsbb.ground.installed import shipped_folder
from roah_rsbb.model.records import EndReason
from roah_rsbb.protocol import RobotState
from roah_rsbb.robot.dummy import DummyOptions
from roah_rsbb.rulebook.config import load_benchmarks
from roah_rsbb.rulebook.registry import PROFILES

USUAL = ["--team", TEAM, "--password", PASSWORD]


class Laptop:
    """A dummy box and a dummy robot on one network."""

    def __init__(self, monkeypatch, code, waypoints=None, goal_timeout=None):
        self.loop = SimulatedLoop()
        air = MemoryAir()
        monkeypatch.setattr(channels, "Peer", air.peer)
        self.lines = []
        benchmark = load_benchmarks(str(shipped_folder() / "benchmarks.yaml"))[code]
        self.make = lambda: DummyBox(
            self.loop, Network(BROADCAST, 6666, BOX, Cipher.AES_128_CBC, False, 1024), TEAM, PASSWORD, benchmark,
            parameters_of(code, waypoints, goal_timeout), self.lines.append, 5.0, utc=self.loop.utc,
            make_peer=air.peer)

    def conduct(self, stop_in=None, clock=None, **options):
        """Return how the run ended; `stop_in`: press Ctrl-C in this state of the robot, in STOP after 10 s."""
        try:
            return self.loop.run_until_complete(self._conduct(stop_in, clock or self.loop.utc, options))
        finally:
            self.loop.close()

    async def _conduct(self, stop_in, clock, options):
        work = DummyOptions(**{"prepare_duration": 1.0, "execute_duration": 2.0, **options})
        robot = usual_robot(self.loop, work, clock=clock)
        running = self.loop.create_task(robot.run())
        box = self.make()
        box.open(5.0)
        conducting = self.loop.create_task(box.conduct(""))
        if stop_in is RobotState.STOP:
            await asyncio.sleep(10.0)
        while stop_in is not None and robot.state is not stop_in:
            await asyncio.sleep(0.05)
        if stop_in is not None:
            conducting.cancel()
        try:
            return await conducting
        finally:
            self.robot_state = robot.state
            box.close()
            running.cancel()
            await asyncio.gather(running, return_exceptions=True)


@pytest.mark.parametrize("code", PROFILES)
def test_the_dummy_robot_completes_every_benchmark(monkeypatch, code):
    laptop = Laptop(monkeypatch, code, goal_timeout=30.0 if PROFILES[code].runs_until_timeout else None)
    assert laptop.conduct() is EndReason.COMPLETED, laptop.lines
    assert laptop.robot_state is RobotState.STOP


def test_waypoints_are_the_given_ones_and_scored(monkeypatch):
    laptop = Laptop(monkeypatch, "HNF", [Pose2D(1.25, 0.5, 0.0)])
    assert laptop.conduct() is EndReason.COMPLETED
    assert "Waypoints reached: 1" in laptop.lines
    assert any(re.fullmatch(r"waypoint 1: Distance error: 0\.\d{1,3} m", line) for line in laptop.lines), laptop.lines
    assert "waypoint 1: Timed out: no" in laptop.lines
    assert not any("waypoint 2" in line for line in laptop.lines)


def test_a_goal_times_out(monkeypatch):
    laptop = Laptop(monkeypatch, "HNF", [Pose2D(1.0, 0.5, 0.0), Pose2D(2.0, 0.5, 0.0)], goal_timeout=5.0)
    assert laptop.conduct(never_end=True) is EndReason.GOALS_TIMED_OUT
    assert "Waypoints timed out: 2" in laptop.lines


def test_ctrl_c_stops_the_robot(monkeypatch):
    laptop = Laptop(monkeypatch, "HGTKMH")
    with pytest.raises(asyncio.CancelledError):
        laptop.conduct(RobotState.EXECUTING)
    assert laptop.robot_state is RobotState.STOP


def test_the_box_says_why_it_waits(monkeypatch):
    laptop = Laptop(monkeypatch, "HGTKMH")
    with pytest.raises(asyncio.CancelledError):
        laptop.conduct(stop_in=RobotState.STOP, clock=lambda: laptop.loop.utc() + 5.0)
    (line,) = [line for line in laptop.lines if line.startswith("waiting to connect")]
    assert line.startswith("waiting to connect: Clock skew of robot Robot of team Team is +4.999 s, but must be below")


@pytest.mark.parametrize("arguments, said", [
    ([*USUAL, "--waypoints", "1,2"], "'1,2' is not a waypoint: give x,y,theta in metres and radians"),
    ([*USUAL, "--benchmark", "HNF", "--waypoints", "1,2,nan"], "'1,2,nan' is not a waypoint"),
    ([*USUAL, "--waypoints", "1,2,3"], "--waypoints: HGTKMH has no waypoints. Use --benchmark HNF"),
    ([*USUAL, "--goal-timeout", "5"], "--goal-timeout: HGTKMH has no goals"),
    ([*USUAL, "--benchmark", "HVW"], "no 'HVW': did you mean 'HWV'?"),
    (["--team", "T"], "the password is missing: use --password-file or the environment variable ROAH_RSBB_KEY"),
    ([*USUAL, "--port", "0"], "'0' is not a UDP port from 1 to 65000"),
])
def test_wrong_arguments_name_the_remedy(capsys, monkeypatch, arguments, said):
    monkeypatch.delenv("ROAH_RSBB_KEY", raising=False)
    with pytest.raises(SystemExit) as ended:
        dummy_box.main(arguments)
    assert ended.value.code == 2
    assert said in capsys.readouterr().err
