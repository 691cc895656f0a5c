"""Of the programs that copy a journal, one works: the newest one whose supervisor is there."""

import os
import subprocess
import sys
import time

import pytest

from helpers.waiting import wait_until
from roah_rsbb.box.settings import BoxSettings, defaults, of_words
from roah_rsbb.ground import linux
from roah_rsbb.ground.params import KnownParams
from roah_rsbb.journal import log_dir as log_dirs
from roah_rsbb.journal.copy_follower import PARENT, copy_settings
from roah_rsbb.standby.program.copying import LOCK, _only_one

# It soon finds that nobody is left.
COPIES = """
import sys
from roah_rsbb.standby.program import copying
copying.PERIOD_S, copying.LEFT_S = 0.01, 0.1
copying.main([f"log_dir:={sys.argv[1]}", f"backup_dir:={sys.argv[1]}/stick"])
"""
SUPERVISOR = """
import subprocess, sys, time
subprocess.Popen([sys.executable, "-c", sys.argv[2], sys.argv[1]])
time.sleep(1000)
"""


@pytest.fixture
def box(tmp_path):
    """A box that writes the journal."""
    return log_dirs.lock(str(tmp_path))


@pytest.fixture
def supervisor(tmp_path, box):
    """A supervisor, and its program that copies."""
    process = subprocess.Popen([sys.executable, "-c", SUPERVISOR, str(tmp_path), COPIES])
    wait_until(lambda: (tmp_path / LOCK).exists() and (tmp_path / LOCK).read_text("ascii"))
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


def test_without_supervisor_it_ends_when_no_box_writes_the_journal(supervisor, box, tmp_path):
    """Until then it copies and hands over."""
    supervisor.kill()
    supervisor.wait()
    time.sleep(1.0)  # far longer than it stays without a box
    assert linux.is_locked(str(tmp_path / LOCK))
    os.close(box.fd)
    wait_until(lambda: not linux.is_locked(str(tmp_path / LOCK)))


def test_one_whose_supervisor_was_killed_before_it_had_started_ends(tmp_path):
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    copying = subprocess.Popen([sys.executable, "-c", COPIES, str(tmp_path)],
                               env={**os.environ, PARENT: str(gone.pid)})
    assert copying.wait(60.0) == 0


@pytest.mark.parametrize("params", [
    BoxSettings({**defaults(), "devices": "false", "tablet": "false", "smartif_host": "10.1.0.56", "web_port": "9000",
                 "web_title": "A Cup 2026", "public_results": "scores", "standby_port": "8083"}),
    KnownParams({"devices": False, "tablet": False, "web": True, "smartif_host": "10.1.0.56", "web_port": 9000,
                 "title": "A Cup 2026", "public_results": "scores", "standby_port": 8083}),  # of a node of ROS
])
def test_a_standby_is_given_the_settings_that_depend_on_no_computer(params):
    """Without them, its box would connect to the usual SmartIF controller, which may be somebody else's."""
    settings = copy_settings(params)
    assert settings.of_venue == {
        "devices": "false", "tablet": "false", "web": "true", "public_provisional": "false",
        "public_robot_texts": "false", "smartif_host": "10.1.0.56", "smartif_port": "6665", "tablet_port": "8080",
        "web_port": "9000", "public_results": "scores", "team_pages": "code", "web_title": "A Cup 2026"}
    assert copy_settings(BoxSettings(of_words(settings.words))) == settings
