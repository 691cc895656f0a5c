"""Robots' sessions in simulated time."""

import pytest

from helpers.robot_bench import Bench, linked_bench


@pytest.fixture
def bench():
    return Bench()


@pytest.fixture
def linked():
    return linked_bench()
