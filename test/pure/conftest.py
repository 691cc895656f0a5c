"""Processes that tests start find the package where the tests do, and get Ctrl-\\ as in a terminal: a shell lets what
it starts in the background ignore it. What a test writes into a journal is in its file however busy the computer is."""

import os
import signal
import sys

import pytest

from roah_rsbb.journal import store
from roah_rsbb.wording import times


@pytest.fixture(autouse=True)
def _no_zone():
    """No test shows times in the time zone of another one's competition."""
    times.use_zone("")


@pytest.fixture(autouse=True, scope="session")
def _package():
    os.environ["PYTHONPATH"] = os.pathsep.join(sys.path)
    signal.signal(signal.SIGQUIT, signal.SIG_DFL)
    store.WRITE_S = 60.0
