"""Which windows a client opens, and how long it keeps them open."""

import os
import signal
import subprocess
import sys

import pytest

from roah_rsbb.ros import display
from roah_rsbb.rqt.app import gui


@pytest.mark.parametrize(("wanted", "has_rqt", "command"), [
    ("auto", True, gui.RQT), ("auto", False, gui.WINDOW), ("window", True, gui.WINDOW), ("window", False, gui.WINDOW),
    ("rqt", True, gui.RQT), ("public", True, gui.PUBLIC), ("public", False, gui.PUBLIC),
])
def test_what_is_opened(wanted, has_rqt, command):
    assert gui.choose(wanted, has_display=True, has_rqt=has_rqt) == (command, "", 0)


@pytest.mark.parametrize("wanted", ["auto", "rqt", "window", "public"])
def test_without_a_display_nothing_is_opened_and_nothing_failed(wanted):
    choice = gui.choose(wanted, has_display=False, has_rqt=True)
    assert choice == (None, display.NO_DISPLAY, 0)
    assert "\n" not in choice.text


@pytest.mark.parametrize(("platform", "found"), [("offscreen", True), ("missing", False)])
def test_qt_that_aborts_ends_only_the_process_that_tried(monkeypatch, platform, found):
    pytest.importorskip("PyQt5.QtWidgets")
    monkeypatch.setenv("QT_QPA_PLATFORM", platform)
    assert display.has_display() is found


def test_rqt_starts_with_a_clear_settings_file_of_its_own():
    """Else qt_gui 0.4.2 crashes at the second start; and the referee's own rqt must keep its settings."""
    assert "settings_filename='roah_rsbb_rqt'" in gui.RQT[2]
    assert "--clear-config" in gui.RQT


INTERRUPTED_WHILE_LOADING = """
import os, signal, sys
from roah_rsbb.rqt.app.application import for_rqt
from roah_rsbb.rqt.qt import QApplication, QTimer
app = for_rqt(QApplication, sys.argv[:1])
state = "loading"
def end(*_):
    print(state, flush=True)
    os._exit(0)
signal.signal(signal.SIGINT, end)
os.kill(os.getpid(), signal.SIGINT)
timer = QTimer()  # Python handles signals only while it runs
timer.timeout.connect(lambda: None)
timer.start(10)
state = "loaded"
app.exec_()
"""


def test_rqt_is_not_interrupted_while_it_loads_panels():
    """Else qt_gui closes its window in the middle of it, and crashes or hangs."""
    pytest.importorskip("PyQt5.QtWidgets")
    pytest.importorskip("rospy")
    assert "for_rqt(create, argv)" in gui.RQT[2]
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen", "PYTHONPATH": os.pathsep.join(sys.path)}
    program = [sys.executable, "-c", INTERRUPTED_WHILE_LOADING]
    ended = subprocess.run(program, stdout=subprocess.PIPE, text=True, check=True, env=environment)
    assert ended.stdout == "loaded\n"


def test_rqt_that_is_not_there_is_named_with_its_remedy():
    choice = gui.choose("rqt", has_display=True, has_rqt=False)
    assert (choice.command, choice.code) == (None, 1)
    assert "ros-noetic-rqt-gui-py" in choice.text
    assert "gui:=window" in choice.text


@pytest.fixture
def keep(monkeypatch):
    """Run a Python program under a Keeper, and return its exit code."""
    monkeypatch.setattr(gui, "REOPEN_S", 0.0)
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    yield lambda program, reopen: gui.Keeper([sys.executable, "-S", "-c", program], reopen).run()
    for number, handler in zip((signal.SIGINT, signal.SIGTERM), before):
        signal.signal(number, handler)


COUNT = "import sys; f = open({path!r}, 'a'); f.write('x'); f.close(); sys.exit({code})"


@pytest.mark.parametrize(("code", "reopen", "lives"), [
    (0, False, 1),  # it was closed
    (0, True, gui.MAX_SHORT_LIVES),  # it belongs to the box, but something closes it at once, each time
    (3, False, gui.MAX_SHORT_LIVES),  # it cannot work at all
])
def test_a_window_is_opened_again_but_not_for_ever(keep, tmp_path, code, reopen, lives):
    path = tmp_path / "lives"
    assert keep(COUNT.format(path=str(path), code=code), reopen) == code
    assert len(path.read_text()) == lives


def test_the_end_of_the_launch_is_the_windows_end(keep):
    asks_parent_to_end = "import os, signal, time; os.kill(os.getppid(), signal.SIGTERM); time.sleep(60)"
    assert keep(asks_parent_to_end, True) == 0
