"""A program with windows, and signals while it starts."""

import os
import subprocess
import sys

import pytest

pytest.importorskip("python_qt_binding")

# Becomes a node with a stand-in for rospy's part, which is interrupted in the middle of it.
STARTING = """
import os, signal
from roah_rsbb.rqt import application, node

def register(name, **_):
    os.kill(os.getpid(), signal.SIGNAL)
    print("registered")

node.rosgraph.is_master_online = lambda: True
node.connections.init_node = register
window_node = node.WindowNode()
app = application.make_application(["test", "-platform", "offscreen"])
application.end_at_signals(window_node, application.ORDERLY_S)
print("started", window_node.begin("test", application.must_end))
print("ended with", application.run(app, window_node))
"""
WAITING = """
import os, signal
from roah_rsbb.rqt import application, node

application.display.has_display = lambda: True
node.rosgraph.is_master_online = lambda: os.kill(os.getpid(), signal.SIGNAL)
node.connections.init_node = lambda *_, **__: print("registered")
application.show("test", print)
"""
LEAVING = """
from roah_rsbb.ground.linux import open_in_browser
from roah_rsbb.rqt.application import leave
import pathlib

class Host:
    has_ended = property(lambda self: not list(pathlib.Path.home().iterdir()))
    end = lambda self: None

assert open_in_browser("http://127.0.0.1:1/pair#SECRET") and not Host().has_ended
leave(Host(), 0)
"""


def _printed(program, signal_name):
    done = subprocess.run(
        [sys.executable, "-c", program.replace("SIGNAL", signal_name)], stdout=subprocess.PIPE, text=True, timeout=300,
        check=False)
    return done.stdout.splitlines(), done.returncode


# Both signals have one handler: each is sent in one of the two moments.
def test_a_signal_while_the_node_registers_ends_the_program_after_that():
    """A program that ended at once would leave its name at the master."""
    assert _printed(STARTING, "SIGTERM") == (["registered", "started True", "ended with 0"], 0)


def test_a_signal_ends_the_wait_for_a_master():
    assert _printed(WAITING, "SIGINT") == ([], 0)


def test_a_window_that_ends_leaves_no_code_for_a_browser_in_a_file(tmp_path):
    subprocess.run([sys.executable, "-c", LEAVING], check=True, timeout=300,
                   env={**os.environ, "HOME": str(tmp_path), "DISPLAY": ":0", "BROWSER": "true %s"})
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("high_px", "em_px", "factor"), [
    (768, 17.0, 1.0), (1080, 17.0, 1.0), (1440, 17.0, 1.324), (2160, 17.0, 1.985), (2160, 34.0, 1.0), (9000, 17.0, 3.0),
])
def test_texts_and_buttons_grow_on_a_large_screen_without_scaling(high_px, em_px, factor):
    from roah_rsbb.rqt.application import growth

    assert growth(high_px, em_px) == pytest.approx(factor, abs=0.001)
