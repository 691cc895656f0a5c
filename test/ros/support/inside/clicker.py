"""Clicks in the referee's window of a launch file, from inside its process: real clicks on what can be seen there.

Service /test/click (String): "<panel>/<what>", as "BenchmarkControlPanel/connect". It fails where a referee could not
click: what is not there, cannot be seen or is off. Topic /test/window (String, JSON) says what the window shows.
"""

import json
import threading
from typing import Callable

import rospy
from std_msgs.msg import String as StringMsg

from roah_rsbb.rqt import application
from roah_rsbb.rqt.qt import QApplication, QObject, QPoint, Qt, QTabBar, QTest, QTimer, QWidget, Signal
from roah_rsbb.srv import String

SHOW_MS = 200
LIMIT_S = 60.0  # a click that comes later would come twice


def arm() -> None:
    """Start when the window's program runs its Qt loop."""
    run = application.run

    def run_with_clicker(app, host) -> int:
        clicker = Clicker()
        code = run(app, host)
        clicker.end()
        return code

    application.run = run_with_clicker


class _Request:
    def __init__(self, path: str) -> None:
        self.path = path
        self.error = "no answer"
        self.done = threading.Event()


class Clicker(QObject):
    """Lives in the Qt thread of the window."""

    _asked = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self._window = next(w for w in QApplication.topLevelWidgets() if hasattr(w, "panels"))
        self._asked.connect(self._on_asked)
        self._topic = rospy.Publisher("/test/window", StringMsg, queue_size=1, latch=True)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._say)
        self._timer.start(SHOW_MS)
        self._service = rospy.Service("/test/click", String, self._serve)

    def end(self) -> None:
        """The window was closed."""
        self._service.shutdown()

    def _serve(self, message: object) -> list:
        request = _Request(message.data)
        self._asked.emit(request)
        request.done.wait(LIMIT_S)
        if request.error:
            raise rospy.ServiceException(request.error)
        return []

    def _on_asked(self, request: _Request) -> None:
        try:
            self._click(*request.path.split("/", 1))
            request.error = ""
        except (KeyError, IndexError, AssertionError) as error:
            request.error = f"{request.path}: {error!r}"
        request.done.set()

    def _say(self) -> None:
        panels = self._window.panels
        control = panels["BenchmarkControlPanel"]
        self._topic.publish(StringMsg(json.dumps({
            "phase": control.phase.text(),
            "leaves_at_once": not control._leaving(control.model.zone_name)[1],
            "zone": control.zones.currentText(),
            "event": control.event_labels["name"].text(),
            "head": panels["OverviewPanel"].head.text(),
            "operation": panels["ManualOperationPanel"].text.text(),
            "operation_seen": _is_seen(panels["ManualOperationPanel"]),
            "log": panels["LogDisplayPanel"].view.toPlainText(),
        })))

    # -- clicking -------------------------------------------------------------------------------------

    def _click(self, panel: str, what: str) -> None:
        if panel == "tab":
            self._click_tab(what)
            return
        finders: dict = {
            "BenchmarkControlPanel": lambda p: p.buttons[what],
            "OverviewPanel": lambda p: p.tiles[what],
            "ManualOperationPanel": lambda p: p.buttons[int(what)],
            "ScoringPanel": lambda p: {desc: row for (_, desc), row in p.rows.items()}[what].toggle,
        }
        finder: Callable[[QWidget], QWidget] = finders[panel]
        widget = finder(self._window.panels[panel])
        assert _is_seen(widget), "it invisible"
        assert widget.isEnabled(), f"it is off: {widget.toolTip()}"
        at = QPoint(5, 5) if panel == "OverviewPanel" else QPoint()
        QTest.mouseClick(widget, Qt.LeftButton, Qt.NoModifier, at)

    def _click_tab(self, title: str) -> None:
        for bar in self._window.findChildren(QTabBar):
            for index in range(bar.count()):
                if bar.tabText(index) == title and _is_seen(bar):
                    QTest.mouseClick(bar, Qt.LeftButton, Qt.NoModifier, bar.tabRect(index).center())
                    return
        raise AssertionError("there is no such tab")


def _is_seen(widget: QWidget) -> bool:
    """Whether any of it is on the screen: Qt calls also visible what is behind another tab."""
    return not widget.visibleRegion().isEmpty()
