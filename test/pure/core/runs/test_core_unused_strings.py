"""Strings that a benchmark does not use: they are logged, and the referee may be warned."""

import dataclasses

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import competition, event
from roah_rsbb.core.effects import Level
from roah_rsbb.model import run_log
from roah_rsbb.protocol import RobotState
from roah_rsbb.rulebook.registry import PROFILES, BenchmarkKind, new_profile


def run_of(code, uses=None):
    """A box with a robot in a benchmark; `uses` are those of benchmarks.yaml."""
    planned = event(code)
    profile = PROFILES.get(code) or new_profile(BenchmarkKind.TASK)
    if uses is not None:
        profile = dataclasses.replace(profile, uses=frozenset(uses))
    benchmark = dataclasses.replace(planned.benchmark, own=profile)
    driver = BoxDriver(competition(tbm=[dataclasses.replace(planned, benchmark=benchmark)]))
    robot = driver.connected()
    driver.taken()
    return driver, robot


@pytest.mark.parametrize("code, uses, warned", [
    ("HGTKMH", None, 0),  # as ever: robots have always sent strings in any benchmark
    ("HWV", None, 0),
    ("HWV", ["visitor"], 1),
    ("HGTKMH", ["notifications"], 0),
    ("SetTable", ["notifications"], 0),
    ("SetTable", [], 1),
    ("SetTable", None, 1),
])
def test_a_notification_that_is_not_used(code, uses, warned):
    driver, robot = run_of(code, uses)
    robot.says(RobotState.STOP, notifications=("hello",))
    robot.says(RobotState.STOP, notifications=("hello", "again"))
    assert driver.logged(robot.port, run_log.NOTIFICATION) == ["hello", "again"]
    texts = [text for text in driver.notices(Level.WARNING) if "'notifications'" in text]
    assert len(texts) == warned
    if warned:
        assert f"which {code} does not use" in texts[0]
