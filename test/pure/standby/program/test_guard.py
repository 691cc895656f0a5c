"""What the standby prepared ends with the program that keeps the copy, but not the box that it became."""

import os
import subprocess
import sys
import time

import pytest

from helpers.waiting import wait_until
from roah_rsbb.standby.pairing import PairedBox, PairedStandby, write_box, write_standby

KEEPER = """
import subprocess, sys, time
from roah_rsbb.standby.program.guard import guarded
subprocess.Popen(guarded(sys.argv[1], [sys.executable, "-c", sys.argv[2], sys.argv[1]]))
time.sleep(1000)
"""
BOX = """
import os, signal, sys, time
open(sys.argv[1] + "/pid", "w").write(str(os.getpid()))
os.rename(sys.argv[1] + "/pid", sys.argv[1] + "/started")
try:
    while True:
        time.sleep(0.01)
        if os.path.exists(sys.argv[1] + "/look"):
            open(sys.argv[1] + "/lives", "w").close()
except KeyboardInterrupt:
    open(sys.argv[1] + "/ended", "w").close()
"""


@pytest.fixture
def keeper(tmp_path):
    write_box(str(tmp_path), PairedBox("10.0.0.1", 8083, "ff", "key"))
    process = subprocess.Popen([sys.executable, "-c", KEEPER, str(tmp_path), BOX])
    wait_until((tmp_path / "started").exists)
    yield process
    process.kill()
    process.wait()
    if not (tmp_path / "ended").exists():
        os.kill(int((tmp_path / "started").read_text()), 2)
        wait_until((tmp_path / "ended").exists)


def test_a_box_that_waits_ends_with_the_program_that_keeps_the_copy(keeper, tmp_path):
    keeper.kill()
    wait_until((tmp_path / "ended").exists)


def test_after_the_takeover_it_continues(keeper, tmp_path):
    write_standby(str(tmp_path), PairedStandby("the box before", "hash", "10.0.0.1", 8083))
    keeper.kill()
    keeper.wait()
    time.sleep(1.5)  # three looks of the guard
    assert not (tmp_path / "ended").exists()
    (tmp_path / "look").touch()
    wait_until((tmp_path / "lives").exists)
