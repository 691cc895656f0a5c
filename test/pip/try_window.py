"""Run by tools/test_pip_install with the Python of a venv that has the wheel roah-rsbb[window], on a virtual display.

A whole competition day without ROS: the referee's window beside `roah-rsbb demo`. A real mouse and keyboard (events of
the X server) choose, connect, mark, start, stop, do what the module asks for, look at all panels, and end the box.
"""

import ctypes
import os
import pathlib
import subprocess
import sys
import tempfile
import time

LIMIT_S = 60.0
STILL = 3  # looks in which nothing has moved
PROGRAM = str(pathlib.Path(sys.executable).parent / "roah-rsbb")
DOOR = "Detects the door whose state has changed"

_x11, _xtst = ctypes.CDLL("libX11.so.6"), ctypes.CDLL("libXtst.so.6")
_x11.XOpenDisplay.restype = ctypes.c_void_p
_x11.XKeysymToKeycode.argtypes = [ctypes.c_void_p, ctypes.c_ulong]
_x11.XKeysymToKeycode.restype = ctypes.c_ubyte
_x11.XSync.argtypes = [ctypes.c_void_p, ctypes.c_int]
_xtst.XTestFakeMotionEvent.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_ulong]
_xtst.XTestFakeButtonEvent.argtypes = [ctypes.c_void_p, ctypes.c_uint, ctypes.c_int, ctypes.c_ulong]
_xtst.XTestFakeKeyEvent.argtypes = [ctypes.c_void_p, ctypes.c_uint, ctypes.c_int, ctypes.c_ulong]
ESCAPE = 0xFF1B


def start_display():
    """Start an X server that ends with this process's display; returns the server."""
    reading, writing = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(writing), "-screen", "0", "1366x768x24", "-nolisten", "tcp"],
                              pass_fds=(writing,), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        os.environ.update(DISPLAY=f":{pipe.readline().strip()}", QT_QPA_PLATFORM="xcb")
    return server


class Referee:
    """A hand on mouse and keyboard, and an eye on the window."""

    def __init__(self, window):
        from roah_rsbb.rqt import qt

        self.qt, self.window, self.panels = qt, window, window.panels
        self.control = window.panels["BenchmarkControlPanel"]
        self.model = self.control.model
        self.display = ctypes.c_void_p(_x11.XOpenDisplay(None))

    def until(self, what, condition):
        """Let Qt work until a condition holds."""
        began = time.monotonic()
        while not condition():
            assert time.monotonic() - began < LIMIT_S, f"not within {LIMIT_S} s: {what}"
            self.qt.QTest.qWait(20)

    def places(self):
        """Where all visible parts of the window are."""
        return [(part.mapToGlobal(self.qt.QPoint()), part.size()) for part in self.window.findChildren(self.qt.QWidget)
                if part.isVisible()]

    def click(self, what, widget, place=None):
        """Click as soon as a referee could: when nothing moves any more."""
        seen = []  # where everything was

        def at():
            return widget.mapToGlobal(widget.rect().center() if place is None else place)

        def is_seen():
            there = self.qt.QApplication.widgetAt(at())
            is_on = getattr(widget, "is_on", widget.isEnabled)
            seen[:] = [*seen[-STILL + 1:], self.places()]
            return (is_on() and there is not None and (there is widget or widget.isAncestorOf(there))
                    and len(seen) == STILL and all(places == seen[0] for places in seen))

        self.until(f"{what} can be clicked", is_seen)
        _xtst.XTestFakeMotionEvent(self.display, 0, at().x(), at().y(), 0)
        for is_press in (1, 0):
            _xtst.XTestFakeButtonEvent(self.display, 1, is_press, 0)
        _x11.XSync(self.display, 0)

    def press_escape(self):
        """Press Esc twice, and not so soon that it counts as a key that bounces."""
        code = _x11.XKeysymToKeycode(self.display, ESCAPE)
        for _ in range(2):
            for is_press in (1, 0):
                _xtst.XTestFakeKeyEvent(self.display, code, is_press, 0)
            _x11.XSync(self.display, 0)
            self.qt.QTest.qWait(300)

    def to_phase(self, command, phase):
        """Click a command, and see the phase that follows."""
        self.click(command, self.control.buttons[command])
        self.until(phase, lambda: phase in self.control._phase.text())

    def run_a_task(self):
        """A run that is marked, and stopped with the mouse."""
        self.until("the box is heard", lambda: "HGTKMH" in self.control._event["name"].text())
        self.to_phase("connect", "CONNECTED")
        scoring = self.panels["ScoringPanel"]
        self.until("the sheet", lambda: DOOR in {desc for _, desc in scoring.rows})
        self.click(DOOR, next(row for (_, desc), row in scoring.rows.items() if desc == DOOR).toggle)
        self.until("the mark counts", lambda: any(
            item.desc == DOOR and item.value == 1 for item in self.model.zone.items))
        self.to_phase("start", "RUNNING")
        self.click("STOP", self.window.strip.stop)
        self.until("it has ended", lambda: "ENDED" in self.control._phase.text())
        # Until the robot has stopped, the window asks before it leaves the run.
        self.until("it is left at once", lambda: not self.control._leaving(self.control.model.zone_name)[1])
        self.to_phase("disconnect", "NOT CONNECTED")

    def run_with_a_module(self):
        """A run whose module asks for something, stopped with the keyboard."""
        while not self.control._event["name"].text().startswith("STB"):
            before = self.control._event["name"].text()
            self.click("next", self.control.buttons["next"])
            self.until("another event", lambda shown=before: self.control._event["name"].text() != shown)
        self.to_phase("connect", "CONNECTED")
        self.to_phase("start", "PAUSED: manual operation")
        manual = self.panels["ManualOperationPanel"]
        self.until("it is asked for", lambda: manual.text.text() == "First Manual Operation")
        self.click("it is done", manual.buttons[0])
        self.until("the robot works", lambda: "RUNNING" in self.control._phase.text())
        self.press_escape()
        self.until("it has ended", lambda: "ENDED" in self.control._phase.text())

    def look_at_all_panels(self):
        """Bring each panel to the front with a click on its tab."""
        for name, dock in self.window.docks.items():
            for bar in self.window.findChildren(self.qt.QTabBar):
                for index in range(bar.count()):
                    if bar.tabText(index) == dock.windowTitle():
                        self.click(name, bar, bar.tabRect(index).center())
            self.until(name, lambda panel=self.panels[name]: not panel.visibleRegion().isEmpty())

    def end_the_box(self):
        """A run is in progress: the window asks, and ends the box nevertheless."""
        self.to_phase("start", "PAUSED: manual operation")
        status, kind = self.panels["CoreStatusPanel"], self.qt.QMessageBox
        self.window.docks["CoreStatusPanel"].raise_()
        self.click("exit", status.exit)

        def question():
            found = [w for w in self.qt.QApplication.topLevelWidgets() if isinstance(w, kind) and w.isVisible()]
            return found[0] if found else None

        self.until("it asks", question)
        box = question()
        assert self.model.zone_name in box.informativeText(), box.informativeText()
        self.click("yes", next(b for b in box.buttons() if box.buttonRole(b) == kind.AcceptRole))


def main():
    """Play it."""
    from roah_rsbb.client.places import OWN_VARIABLE
    from roah_rsbb.rqt.app import application, program
    from roah_rsbb.rqt.model import failures

    server = start_display()
    failed = []
    with tempfile.TemporaryDirectory() as folder:
        os.environ.update({"HOME": folder, "XDG_CONFIG_HOME": folder, "BROWSER": "true",
                           OWN_VARIABLE: os.path.join(folder, "log", "door.json")})
        demo = subprocess.Popen([PROGRAM, "demo", "--log-dir", f"{folder}/log", "--execute-duration", "1000"],
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

        def play(app, host):
            failures.listeners.append(failed.append)
            try:
                window = next(w for w in app.topLevelWidgets() if hasattr(w, "panels"))
                referee = Referee(window)
                referee.run_a_task()
                referee.run_with_a_module()
                referee.look_at_all_panels()
                referee.end_the_box()
                referee.until("the box has ended", lambda: demo.poll() is not None)
                assert demo.returncode == 0, demo.returncode
                assert not failed, failed
                python = sys.version.split()[0]
                print(f"window test: Python {python}, {application.QTimer.__module__}: works", flush=True)
                return 0
            except BaseException:
                sys.excepthook(*sys.exc_info())
                return 1
            finally:
                demo.kill()
                demo.wait()

        def leave(host, code):
            server.terminate()
            os._exit(code)

        application.run, application.leave = play, leave
        program.main([])


main()
