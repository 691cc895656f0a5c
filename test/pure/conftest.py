"""Processes that tests start find the package where the tests do."""

import os
import sys

import pytest


@pytest.fixture(autouse=True, scope="session")
def _package():
    os.environ["PYTHONPATH"] = os.pathsep.join(sys.path)
