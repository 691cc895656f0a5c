"""All scenarios of the check against the dummy robot, in simulated time."""

import pytest

from helpers import simulated_air
from helpers.checked_robot import Checked, usual_robot
from roah_rsbb.check.engine import scenarios_of
from roah_rsbb.check.report import Verdict
from roah_rsbb.check.scenarios import SCENARIOS, Depth
from roah_rsbb.comm import peer
from roah_rsbb.robot.dummy import DummyOptions
from roah_rsbb.rulebook.registry import PROFILES

ALL = tuple(PROFILES)


@pytest.mark.long
def test_the_dummy_robot_passes_all_scenarios_within_eight_minutes(monkeypatch):
    checked = Checked(monkeypatch, lambda loop: usual_robot(loop, DummyOptions(seed=1)), Depth.FULL, benchmarks=ALL)
    assert [(r.name, r.findings) for r in checked.engine.results if r.verdict is not Verdict.PASSED] == []
    assert [r.name for r in checked.engine.results] == [
        one.name for one in SCENARIOS if one.name != f"run-{ALL[0].lower()}"]
    assert checked.seconds < 480.0


@pytest.mark.random
@pytest.mark.parametrize("seed", range(4))
def test_no_bad_network_is_the_robots_fault(monkeypatch, seed):
    robot = lambda loop: usual_robot(loop, DummyOptions(1.0, 2.0, seed=seed))  # noqa: E731
    names = ("bad-network", "run-hwv", "run-hnf", "next-waypoint", "goal-timeout", "restart", "moved")
    assert Checked(monkeypatch, robot, names=names, seed=seed).findings == []


@pytest.mark.long
def test_a_quick_robot_is_not_blamed(monkeypatch):
    """It prepares and executes at once, so some scenarios are not possible."""
    checked = Checked(monkeypatch, lambda loop: usual_robot(loop, DummyOptions(0.0, 0.0, seed=1)), Depth.FULL,
                      benchmarks=ALL)
    assert [f for f in checked.findings if f.verdict not in (Verdict.SKIPPED, Verdict.PASSED)] == []


def test_without_a_second_address_its_scenarios_are_skipped(monkeypatch):
    checked = Checked(monkeypatch, names=("moved", "other-box"), second_host="")
    assert [(f.verdict, f.came) for f in checked.findings] == [
        (Verdict.SKIPPED, "This machine has no second address: give one with --second-bind")] * 2


def test_only_the_given_benchmarks_are_run():
    names = [one.name for one in scenarios_of(Depth.FULL, ("HNF", "HWV"))]
    assert [name for name in names if name.startswith("run")] == ["run", "run-hwv"]
    assert "next-waypoint" in names and "goal-timeout" not in names and "burst" not in names
    assert "unknown-code" in names


def test_a_robot_that_obeys_a_timeout_before_the_check_looks_is_judged(monkeypatch):
    def call_at(loop, when, *arguments, **fields):
        handle = usual(loop, when, *arguments, **fields)
        if when - loop.time() < 1e-6:
            loop.stall(1e-6)  # a datagram has arrived before the loop continues
        return handle

    usual = simulated_air.SimulatedLoop.call_at
    monkeypatch.setattr(peer, "DELAY_S", 0.0)
    monkeypatch.setattr(simulated_air.SimulatedLoop, "call_at", call_at)
    checked = Checked(monkeypatch, names=["next-waypoint", "goal-timeout"])
    assert [result.verdict for result in checked.engine.results] == [Verdict.PASSED] * 3, checked.findings
