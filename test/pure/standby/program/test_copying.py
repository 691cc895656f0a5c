"""Of the programs that copy a journal, one works: the newest one whose supervisor is there."""

import os
import subprocess
import sys
import time

import pytest

from roah_rsbb.standby.program.copying import _only_one

LIMIT_S = 60.0
# It copies, and ends when it is asked to.
COPIES = """
import signal, sys, time
from roah_rsbb.standby.program.copying import _only_one
ends = []
signal.signal(signal.SIGTERM, lambda *_: ends.append(1))
lock = _only_one(sys.argv[1])
open(sys.argv[1] + "/copies", "w").close()
while not ends:
    time.sleep(0.01)
"""
SUPERVISOR = """
import subprocess, sys, time
subprocess.Popen([sys.executable, "-c", sys.argv[2], sys.argv[1]])
time.sleep(1000)
"""


@pytest.fixture
def supervisor(tmp_path):
    """A supervisor, and its program that copies."""
    process = subprocess.Popen([sys.executable, "-c", SUPERVISOR, str(tmp_path), COPIES],
                               env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    deadline = time.monotonic() + LIMIT_S
    while not (tmp_path / "copies").exists():
        assert time.monotonic() < deadline
        time.sleep(0.01)
    yield process
    process.kill()
    process.wait()
    _only_one(str(tmp_path)).close()  # which ends the one that is left


def test_a_second_one_is_refused_while_the_first_has_its_supervisor(supervisor, tmp_path):
    with pytest.raises(OSError, match="copies the journal in .* already: end it"):
        _only_one(str(tmp_path))


def test_one_whose_supervisor_is_gone_is_replaced(supervisor, tmp_path):
    supervisor.kill()
    supervisor.wait()
    _only_one(str(tmp_path)).close()
