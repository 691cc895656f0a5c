"""Which windows a client opens, and how long it keeps them open."""

import os
import signal
import subprocess
import sys

import pytest

from roah_rsbb.ros import display
from roah_rsbb.rqt import programs


@pytest.mark.parametrize(("wanted", "has_rqt", "command"), [
    ("auto", True, programs.RQT), ("auto", False, programs.WINDOW), ("window", True, programs.WINDOW),
    ("window", False, programs.WINDOW), ("rqt", True, programs.RQT),
])
def test_what_is_opened(wanted, has_rqt, command):
    assert programs.choose(wanted, has_display=True, has_rqt=has_rqt) == (command, "", 0)


@pytest.mark.parametrize("wanted", ["auto", "rqt", "window"])
def test_without_a_display_nothing_is_opened_and_nothing_failed(wanted):
    choice = programs.choose(wanted, has_display=False, has_rqt=True)
    assert choice == (None, display.NO_DISPLAY, 0)
    assert "\n" not in choice.text


@pytest.mark.parametrize(("platform", "found"), [("offscreen", True), ("missing", False)])
def test_qt_that_aborts_ends_only_the_process_that_tried(monkeypatch, platform, found):
    pytest.importorskip("PyQt5.QtWidgets")
    monkeypatch.setenv("QT_QPA_PLATFORM", platform)
    assert display.has_display() is found


def test_rqt_starts_with_a_clear_settings_file_of_its_own():
    """Else qt_gui 0.4.2 crashes at the second start; and the referee's own rqt must keep its settings."""
    assert "settings_filename='roah_rsbb_rqt'" in programs.RQT[2]
    assert "--clear-config" in programs.RQT


# Like rqt_gui's Main, up to the moment in which something happens to it. A destructor would print a line.
RQT = """
import signal, sys, time
from roah_rsbb.rqt.application import run_rqt
from roah_rsbb.rqt.qt import QApplication, QMainWindow, QTimer, Signal

class Window(QMainWindow):
    save_settings_before_close_signal = Signal(object, object)

    def closeEvent(self, event):
        self.save_settings_before_close_signal.emit(None, None)
        print("qt_gui closes the window")

class Main:
    def create_application(self, argv):
        return QApplication(argv)

    def _add_plugin_providers(self):
        pass

    def main(self):
        app = self.create_application(sys.argv[:1])
        self.window = Window()
        signal.signal(signal.SIGINT, lambda *_: self.window.close())
        self._add_plugin_providers()
        HAPPENS
        print("rqt has ended by itself")
        return 3

run_rqt(Main())
"""


@pytest.mark.parametrize(("happens", "printed", "status"), [
    ("signal.raise_signal(signal.SIGINT); time.sleep(600)", "", 0),  # while it loads its panels
    ("signal.raise_signal(signal.SIGTERM); time.sleep(600)", "", 0),
    ("QTimer.singleShot(0, self.window.close); self.window.show(); app.exec_()", "", 0),
    ("", "rqt has ended by itself\n", 3),  # as for --help
])
def test_rqt_ends_at_once_without_closing_its_window(happens, printed, status):
    """Else qt_gui crashes or hangs sometimes."""
    pytest.importorskip("PyQt5.QtWidgets")
    pytest.importorskip("rospy")
    assert "run_rqt(Main(" in programs.RQT[2]
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen"}
    program = [sys.executable, "-c", RQT.replace("HAPPENS", happens)]
    ended = subprocess.run(program, stdout=subprocess.PIPE, text=True, check=False, env=environment, timeout=300)
    assert (ended.stdout, ended.returncode) == (printed, status)


def test_rqt_that_is_not_there_is_named_with_its_remedy():
    choice = programs.choose("rqt", has_display=True, has_rqt=False)
    assert (choice.command, choice.code) == (None, 1)
    assert "ros-noetic-rqt-gui-py" in choice.text
    assert "gui:=window" in choice.text


@pytest.fixture
def keep(monkeypatch):
    """Run a Python program under a Keeper, and return its exit code."""
    monkeypatch.setattr(programs, "REOPEN_S", 0.0)
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    yield lambda program, reopen: programs.Keeper([sys.executable, "-S", "-c", program], reopen).run()
    for number, handler in zip((signal.SIGINT, signal.SIGTERM), before):
        signal.signal(number, handler)


COUNT = "import sys; f = open({path!r}, 'a'); f.write('x'); f.close(); sys.exit({code})"


@pytest.mark.parametrize(("code", "reopen", "lives"), [
    (0, False, 1),  # it was closed
    (0, True, programs.MAX_SHORT_LIVES),  # it belongs to the box, but something closes it at once, each time
    (3, False, programs.MAX_SHORT_LIVES),  # it cannot work at all
])
def test_a_window_is_opened_again_but_not_for_ever(keep, tmp_path, code, reopen, lives):
    path = tmp_path / "lives"
    assert keep(COUNT.format(path=str(path), code=code), reopen) == code
    assert len(path.read_text()) == lives


def test_the_end_of_the_launch_is_the_windows_end(keep):
    asks_parent_to_end = "import os, signal, time; os.kill(os.getppid(), signal.SIGTERM); time.sleep(60)"
    assert keep(asks_parent_to_end, True) == 0


def test_a_signal_before_the_window_is_started_ends_the_window(keep, monkeypatch):
    start = subprocess.Popen

    def interrupted(command):
        monkeypatch.setattr(subprocess, "Popen", start)
        os.kill(os.getpid(), signal.SIGINT)
        return start(command)

    monkeypatch.setattr(subprocess, "Popen", interrupted)
    assert keep("import time; time.sleep(600)", True) == 0


def test_a_window_that_does_not_end_is_killed(keep, monkeypatch):
    monkeypatch.setattr(programs, "KILL_S", 0.1)
    deaf = ("import os, signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); "
            "os.kill(os.getppid(), signal.SIGINT); time.sleep(600)")
    assert keep(deaf, True) == 0
