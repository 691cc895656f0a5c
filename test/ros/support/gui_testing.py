"""What tests of panels share: a display of their own, waiting with Qt's events, clicking, and no hurry.

Import it before anything of Qt: it gives this process a virtual display, also where there is a real one.
"""

import atexit
import os
import subprocess
import tempfile
import time
import unittest
from typing import Any, Callable, Union
from unittest import mock

from support.waiting import LIMIT_S

# Windows with a large scale factor need a larger screen.
SCREEN = tuple(map(int, os.environ.get("ROAH_TEST_SCREEN", "1366x768").split("x")))
SECOND_SCREEN = (1920, 1080)


def _start_display() -> str:
    """Start an X server of our own; returns its name."""
    reading, writing = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(writing), "-screen", "0", f"{SCREEN[0]}x{SCREEN[1]}x24",
         "-screen", "1", f"{SECOND_SCREEN[0]}x{SECOND_SCREEN[1]}x24", "-nolisten", "tcp",
         "-terminate"],  # with its last client: also when a test is killed
        pass_fds=(writing,), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
    )
    atexit.register(server.wait)
    atexit.register(server.terminate)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        number = pipe.readline().strip()
    assert number, "Xvfb did not start: 'make install-deps' installs it"
    return f":{number}"


_settings = tempfile.TemporaryDirectory()
os.environ.update({"DISPLAY": _start_display(), "QT_QPA_PLATFORM": "xcb", "XDG_CONFIG_HOME": _settings.name,
                   "XDG_RUNTIME_DIR": _settings.name})

from roah_rsbb.client import client  # noqa: E402  (only now is there a display)
from roah_rsbb.rqt import calls, keys, stops  # noqa: E402
from roah_rsbb.rqt.application import make_application  # noqa: E402
from roah_rsbb.rqt.panels import panel  # noqa: E402
from roah_rsbb.rqt.qt import (  # noqa: E402
    QApplication,
    QCheckBox,
    QEvent,
    QMessageBox,
    QPoint,
    Qt,
    QTest,
    QWidget,
)
from roah_rsbb.wording import stop  # noqa: E402

app = QApplication.instance() or make_application(["test"])

LONG_S = 3600.0
# Limits of the panels that depend on the machine's speed: what is a silent core, a late answer, a slow second press,
# and how long a line about a success stays. A busy machine may stop for seconds at any moment.
_LIMITS = (
    (client, "OLD_S", LONG_S), (client, "SILENT_S", LONG_S), (client, "STOP_S", LONG_S), (calls, "TIMEOUT_S", LONG_S),
    (keys, "WITHIN_S", LONG_S), (stops, "DONE_S", LONG_S), (stops, "FAILED_S", LONG_S),
    (stop, "NOT_DELIVERED_S", LONG_S), (panel, "DONE_MS", round(1000 * LONG_S)),
)


def without_hurry(case: unittest.TestCase) -> None:
    """Put all these limits out of reach until the test case ends."""
    for place, name, value in _LIMITS:
        limit(case, place, name, value)


def limit(case: unittest.TestCase, place: object, name: str, value: object) -> None:
    """Set a limit of the panels until the test case ends."""
    patch = mock.patch.object(place, name, value)
    patch.start()
    case.addCleanup(patch.stop)


def wait_until(condition: Callable[[], object], what: Union[str, Callable[[], str]], limit_s: float = LIMIT_S) -> None:
    """Let Qt and ROS work until `condition` holds."""
    began = time.monotonic()
    while not condition():
        if time.monotonic() - began > limit_s:
            raise AssertionError(f"after {limit_s:.0f} s still not: {what if isinstance(what, str) else what()}")
        QTest.qWait(20)


def sync() -> None:
    """Let Qt handle all events that are under way from the X server, and what follows from them at once."""
    for _ in range(2):
        QApplication.sync()
        QApplication.sendPostedEvents(None, QEvent.DeferredDelete)


def settle(widget: QWidget) -> None:
    """Wait until the layout of a widget no longer changes."""
    seen = [[], places(widget)]

    def is_still() -> bool:
        sync()
        seen[:] = [seen[1], places(widget)]
        return seen[0] == seen[1]

    sync()
    wait_until(is_still, "nothing moves")


def places(widget: QWidget) -> list:
    """Where all visible parts of a widget are."""
    return [(w.objectName(), w.mapToGlobal(QPoint()), w.size()) for w in widget.findChildren(QWidget) if w.isVisible()]


def show(widget: QWidget, width: int = 640, height: int = 700) -> None:
    """Show a widget as the active window."""
    widget.resize(width, height)
    widget.show()
    widget.activateWindow()
    wait_until(lambda: QApplication.activeWindow() is widget, "the widget is shown and has the focus")
    sync()


def click(button: QWidget) -> None:
    """Click a button as a referee would: it must be visible and enabled."""
    is_on = getattr(button, "is_on", button.isEnabled)  # STOP is never disabled
    wait_until(lambda: button.isVisible() and is_on(), f"button {button.text()!r} is on: {button.toolTip()}")
    # The middle of a check box may be beside its text, where a click does nothing.
    place = QPoint(10, button.height() // 2) if isinstance(button, QCheckBox) else QPoint()
    QTest.mouseClick(button, Qt.LeftButton, Qt.NoModifier, place)


def opened(kind: type) -> Any:
    """The dialog of that kind that is open, once it is."""
    found = []

    def is_open() -> bool:
        found[:] = [w for w in QApplication.topLevelWidgets() if isinstance(w, kind) and w.isVisible()]
        return bool(found)

    wait_until(is_open, f"a {kind.__name__} is open")
    return found[0]


def question() -> QMessageBox:
    """The question that is asked now."""
    return opened(QMessageBox)


def answer(box: QMessageBox, role: int) -> None:
    """Click the button of that role."""
    click(next(b for b in box.buttons() if box.buttonRole(b) == role))
    wait_until(lambda: not box.isVisible(), "the question is gone")
