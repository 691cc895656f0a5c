"""The processes that a box without ROS starts find the package where the tests do."""

import os
import sys

import pytest


@pytest.fixture(autouse=True)
def _package(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(sys.path))
