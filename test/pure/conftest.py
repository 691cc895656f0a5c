"""Processes that tests start find the package where the tests do, and get Ctrl-\\ as in a terminal: a shell lets what
it starts in the background ignore it."""

import os
import signal
import sys

import pytest


@pytest.fixture(autouse=True, scope="session")
def _package():
    os.environ["PYTHONPATH"] = os.pathsep.join(sys.path)
    signal.signal(signal.SIGQUIT, signal.SIG_DFL)
