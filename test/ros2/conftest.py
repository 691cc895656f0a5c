"""The box for all tests, and a ROS domain of their own."""

import contextlib
import os
import pathlib
import sys
from typing import Callable, Iterator

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "ros"))
# Several runs on one machine, each in a domain of its own.
os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 100)

import rclpy
from probe import Probe
from programs import Box, Program


@pytest.fixture(scope="session")
def _box(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Box]:
    running = Box(tmp_path_factory.mktemp("box"))
    yield running
    running.close()


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    outcome = yield
    item.has_failed = getattr(item, "has_failed", False) or outcome.get_result().failed


@pytest.fixture
def box(_box: Box, request: pytest.FixtureRequest) -> Iterator[Box]:
    """The box, without a run. A failed test must not make the next one fail."""
    yield _box
    if getattr(request.node, "has_failed", False):
        for zone in ("Testing", "Second"):
            for command in ("stop", "disconnect"):
                _box.referee(command, zone).wait_ended()


@pytest.fixture(scope="session", autouse=True)
def ros() -> Iterator[None]:
    rclpy.init()
    yield
    rclpy.try_shutdown()


@pytest.fixture
def running() -> Iterator[Callable[[Program], Program]]:
    """Programs that end with the test."""
    with contextlib.ExitStack() as programs:
        def add(program: Program) -> Program:
            programs.callback(program.close)
            return program
        yield add


@pytest.fixture
def probe() -> Iterator[Probe]:
    node = Probe()
    yield node
    node.close()
