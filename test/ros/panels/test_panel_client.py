"""The other panels, the plugins and the window, with a fake core."""

import gc
import importlib
import pathlib
import sys
import tempfile
import threading
import types
import unittest
import unittest.mock
import weakref
from typing import Any, Dict, List, Mapping
from xml.etree import ElementTree

import rosgraph
import rospy
from PyQt5 import sip
from std_srvs.srv import Empty
from support.fakes.core import FakeCore
from support.gui_testing import (
    LONG_S,
    QApplication,
    QMessageBox,
    Qt,
    QTest,
    answer,
    click,
    limit,
    opened,
    question,
    show,
    wait_until,
)
from support.panel_case import CoreCase, Settings

from roah_rsbb.box.configuration import Reloaded
from roah_rsbb.document.calls import Caller
from roah_rsbb.model.document import REPLAY as PREFIX
from roah_rsbb.rqt import calls, windows
from roah_rsbb.rqt.basic import ALARM, OLD
from roah_rsbb.rqt.client import RefereeClient
from roah_rsbb.rqt.keys import FocusRing
from roah_rsbb.rqt.node import WindowNode
from roah_rsbb.rqt.panels import PANELS, load
from roah_rsbb.rqt.panels.overview import OverviewPanel
from roah_rsbb.rqt.panels.score_sheet import SheetView
from roah_rsbb.rqt.panels.scoring import ScoringPanel
from roah_rsbb.rqt.panels.texts import LogDisplayPanel, OnlineDataPanel
from roah_rsbb.rqt.panels.whole_box import ActiveRobotsPanel, CoreStatusPanel, ReloadDialog, TabletStatusPanel
from roah_rsbb.rqt.qt import QHBoxLayout, QLabel, QObject, QPushButton, QSettings, QSpinBox, QWidget
from roah_rsbb.rqt.windows import Window
from roah_rsbb.wording.whole_box import ROBOT_COLUMNS

PLUGIN_XML = pathlib.Path(__file__).resolve().parents[3] / "plugin.xml"


class TestCalls(unittest.TestCase):
    """How many calls wait at the same time."""

    def setUp(self) -> None:
        limit(self, calls, "TIMEOUT_S", LONG_S)
        self.calls = calls.Calls(None, calls.RefereeName(), lambda: "")  # without a box
        self.gate = threading.Event()
        self.outcomes: List[calls.CallOutcome] = []
        self.addCleanup(lambda: wait_until(lambda: not self.calls.are_waiting, "all calls have ended"))
        self.addCleanup(self.gate.set)

    def call(self, what: str, times: int) -> None:
        for _ in range(times):
            self.calls.run(self, what, self.gate.wait, self.outcomes.append)

    def test_a_node_that_hangs_keeps_no_command_for_another_one_from_being_sent(self) -> None:
        self.call("/devices/dimmer", calls.MAX_WAITING + 1)
        self.assertEqual(len(self.outcomes), 1)
        self.assertIn("/devices/dimmer: not sent", self.outcomes[0].error)
        self.call("/devices/bell/mock", 1)
        self.assertEqual(len(self.outcomes), 1)


class TestFocusRing(unittest.TestCase):
    def test_it_leaves_a_widget_that_qt_destroys_while_it_is_hidden(self) -> None:
        ring = FocusRing(lambda widget: True)
        self.addCleanup(ring.end)
        spin_box = QSpinBox()
        changed = QApplication.instance().focusChanged
        changed.emit(None, spin_box.lineEdit())  # Qt created it; the next focus in a window that closes
        sip.delete(spin_box)
        changed.emit(None, None)  # would use a destroyed widget


class Row(QWidget):
    """A row of a score sheet."""

    def __init__(self, text: str) -> None:
        super().__init__()
        line = QHBoxLayout(self)
        self.button = QPushButton("Yes")
        line.addWidget(QLabel(text, wordWrap=True), 1)
        line.addWidget(self.button)


class TestReplay(CoreCase):
    """A replay identifies itself in the messages. Nobody may take it for a live box."""

    def new_core(self) -> FakeCore:
        return FakeCore(box_uuid=f"{PREFIX}fake")

    def test_every_panel_is_marked_until_a_live_core_is_heard(self) -> None:
        panels = [self.open(kind) for kind in (LogDisplayPanel, CoreStatusPanel)]
        for panel in panels:
            wait_until(lambda panel=panel: panel.news.text() == "▶ REPLAY: not live", "the panel is marked")
            self.assertEqual(panel.windowTitle(), f"REPLAY – {panel.TITLE}")
        self.core.close()
        self.core = FakeCore()
        for panel in panels:
            wait_until(lambda panel=panel: panel.news.text() == "● live", "the mark is gone")
            self.assertEqual(panel.windowTitle(), panel.TITLE)

    def test_the_run_is_shown_as_running_and_nothing_can_be_changed(self) -> None:
        zone = self.core.zones["Home A"]
        zone.command("connect")
        zone.command("start")
        self.core.box.restart.begin_replay("a run")
        overview, scoring = self.open(OverviewPanel), self.open(ScoringPanel)
        wait_until(lambda: overview.head.text() == "▶ RUNNING: Home A" and scoring.rows, "the run is shown")
        reason = "This is a replay: commands have no effect"
        wait_until(lambda: reason in self.strip.way.whole, "the reason is shown")
        self.assertFalse(self.strip.stop.is_on() or self.strip.stop_all.is_on())
        buttons = [button for row in scoring.rows.values() for button in row._buttons]
        self.assertGreater(len(buttons), 9)
        self.assertEqual({(button.isEnabled(), reason in button.toolTip()) for button in buttons}, {(False, True)})


class TestSheetView(unittest.TestCase):
    def test_the_arrangement_does_not_depend_on_the_one_before(self) -> None:
        view = SheetView()
        self.addCleanup(view.close)
        view.clear()
        for group in ("Achievements", "Penalized behaviours"):
            for number in range(6):
                view.add(group, Row(f"{number} something that a robot does, in words that need two lines"))
        show(view, 900, 1400)
        view.columns = 0  # as of a new sheet, however much Qt has handled since the window was shown
        view.settle()
        needed = view._needed()
        self.assertEqual(view.columns, 1)
        QApplication.processEvents()
        self.assertEqual(needed, view._needed())
        for height in (needed, needed // 3, needed // 2, needed, needed // 2, needed // 3, needed // 2):
            view.resize(900, height)
            view._settle()
            at_once = view.columns
            QApplication.processEvents()
            view._settle()
            self.assertEqual(at_once, view.columns, f"at {height} of {needed}")


class TestGarbage(unittest.TestCase):
    def test_it_is_collected_in_qts_thread_only(self) -> None:
        collected_in: List[threading.Thread] = []

        def use_memory() -> None:
            cycle = QObject()
            cycle.itself = cycle
            weakref.finalize(cycle, lambda: collected_in.append(threading.current_thread()))
            del cycle
            # Far more objects than Python waits for before it collects garbage.
            kept = [[] for _ in range(10 * gc.get_threshold()[0])]
            kept.clear()

        thread = threading.Thread(target=use_memory)
        thread.start()
        thread.join()
        self.assertEqual(collected_in, [])
        kept = []

        def is_collected() -> bool:
            kept.extend([] for _ in range(gc.get_threshold()[0]))
            return bool(collected_in)

        wait_until(is_collected, "the garbage is collected")
        self.assertEqual(collected_in, [threading.main_thread()])


class TestPanels(CoreCase):
    def test_active_robots(self) -> None:
        self.zone.command("connect")
        table = self.open(ActiveRobotsPanel).table

        def lines():
            return [[table.item(row, column).text() for column in (0, 1, 3, 4)] for row in range(table.rowCount())]

        wait_until(lambda: lines() == [["AnotherTeam", "amigo", "-0.087 s", "–"],
                                       ["TestingTeam", "mbot", "+0.012 s", "Home A"]], "both robots are shown")
        self.core.zones["Home B"].all_robots = ["amigo of team AnotherTeam: ready"]
        wait_until(lambda: [line[3] for line in lines()] == ["Home B", "Home A"], "one of all robots at once is shown")
        link = ROBOT_COLUMNS.index("Link")
        wait_until(lambda: table.item(0, link).text() == "▮▮▮ good", "the link is good")
        self.core.heard_ago_s = 5.0
        wait_until(lambda: table.item(0, link).text().startswith("▮▯▯ poor, 5"), "it is poor")
        self.core.robots = []
        wait_until(lambda: lines()[0][0] == "No robot is heard" and len(lines()) == 1, "they are gone")

    def test_core_status(self) -> None:
        self.zone.command("connect")
        self.zone.command("start")
        panel = self.open(CoreStatusPanel)
        wait_until(lambda: panel.values[3].text() == "1 of 2 zones", "the run is counted")
        self.assertEqual(panel.notices.toPlainText(), "OK")
        self.assertEqual(panel.values[0].text(), "127.255.255.255")
        self.core.box_warnings = ["ANOTHER RSBB"]
        wait_until(lambda: panel.notices.toPlainText() == "⚠ ANOTHER RSBB", "the warning is shown, once")

    def test_tablet_status(self) -> None:
        panel = self.open(TabletStatusPanel)
        heard, display, _, position, _ = (value.text() for value in panel.values)
        self.assertIn("just now", heard)
        self.assertEqual((display, position), ("Map", "x 1.50 m, y 3.25 m"))
        self.core.tablet_heard = False
        wait_until(lambda: panel.values[0].text() == "never", "a tablet that was never heard")

    def test_the_log_is_followed_and_can_be_held(self) -> None:
        panel = self.open(LogDisplayPanel)
        show(panel, 400, 200)
        text, bar = panel.view.toPlainText, panel.view.verticalScrollBar()
        self.zone.log = "".join(f"line {n}\n" for n in range(100))
        wait_until(lambda: "line 99" in text() and bar.value() == bar.maximum(), "the end is shown")
        click(panel.follow)
        bar.setValue(10)
        # The core publishes only the end: the panel keeps what it saw.
        self.zone.log = self.zone.log[200:] + "line 100\n"
        wait_until(lambda: "line 100" in text(), "a line more")
        self.assertEqual(bar.value(), 10)
        self.assertTrue(text().startswith("line 0\n"))
        click(panel.follow)
        self.assertEqual(bar.value(), bar.maximum())
        self.zone.log = "a new run\n"
        wait_until(lambda: text() == "a new run\n", "another text replaces it")

    def test_levels_of_the_log_stand_out(self) -> None:
        panel = self.open(LogDisplayPanel)
        self.zone.log = "08:00:00 a WARNING: in words\n08:00:01 WARNING: silent\n08:00:02 ERROR: gone\n"
        wait_until(lambda: "ERROR" in panel.view.toPlainText(), "the log is shown")

        def tone(number: int) -> str:
            looks = panel.view.document().findBlockByNumber(number).layout().formats()
            return looks[0].format.background().color().name() if looks else ""

        wait_until(lambda: tone(2), "the highlighter has worked")
        self.assertEqual([tone(number) for number in range(3)], ["", OLD.background, ALARM.background])

    def test_searching_the_log(self) -> None:
        panel = self.open(LogDisplayPanel)
        show(panel, 500, 260)
        search, bar = panel.search, panel.view.verticalScrollBar()
        self.zone.log = "".join(f"line {n}{' Robot' if n % 40 == 7 else ''}\n" for n in range(100))
        wait_until(lambda: "line 99" in panel.view.toPlainText(), "the log is shown")
        self.assertFalse(search.next.isEnabled())
        QTest.keyClick(panel.view, Qt.Key_F, Qt.ControlModifier)
        wait_until(search.line.hasFocus, "the key goes to the search")
        QTest.keyClicks(search.line, "robot")
        self.assertEqual(search.count.text(), "3 found")
        self.assertEqual(len(panel.view.extraSelections()), 3)
        for number, line in ((1, 7), (2, 47), (3, 87), (1, 7)):
            click(search.next)
            self.assertEqual(search.count.text(), f"{number} of 3")
            self.assertEqual(panel.view.textCursor().blockNumber(), line)
        QTest.keyClick(search.line, Qt.Key_F3, Qt.ShiftModifier)
        self.assertEqual(panel.view.textCursor().blockNumber(), 87)
        # What comes moves neither the view nor the place.
        self.assertFalse(panel.follow.isChecked())
        at = bar.value()
        self.zone.log += "line 100 Robot\n"
        wait_until(lambda: search.count.text() == "3 of 4", "the new one is counted")
        self.assertEqual(bar.value(), at)
        search.line.setText("nobody")
        self.assertEqual(search.count.text(), "none")
        self.assertFalse(search.next.isEnabled())
        search.line.clear()
        self.assertEqual((search.count.text(), panel.view.extraSelections()), ("", []))

    def test_online_data(self) -> None:
        panel = self.open(OnlineDataPanel)
        self.zone.online_data = "visitor: <b>postman</b>\n"
        wait_until(lambda: panel.view.toPlainText() == "visitor: <b>postman</b>\n", "it is shown as it is")

    def test_exit_asks_and_says_what_it_ends(self) -> None:
        ended = []
        service = rospy.Service("/roah_rsbb_shutdown", Empty, lambda _request: ended.append(1) or [])
        self.addCleanup(service.shutdown)
        panel = self.open(CoreStatusPanel)
        click(panel.exit)
        box = question()
        # This process lives in the root namespace: the service there is the core's.
        self.assertIn("End the whole RSBB", box.text())
        answer(box, QMessageBox.RejectRole)
        self.assertEqual(ended, [])
        click(panel.exit)
        answer(question(), QMessageBox.AcceptRole)
        wait_until(lambda: ended, "the service is called")

    def test_reload_lists_the_changes_before_they_are_applied(self) -> None:
        answers = [
            {"errors": ["schedule.yaml:4: found team 'Bet'", "benchmarks.yaml:5: found the text 'soon'"]},
            {"digest": "d1", "warnings": ["passwords.yaml: readable"], "changes": ["team 'Late': added"]},
            {"digest": "d1", "changes": ["team 'Late': added"], "applied": True},
            {"digest": "d1"},
        ]
        asked = []

        def reload(found: Mapping[str, Any], _caller: Caller) -> Dict[str, Any]:
            asked.append(found["digest"])
            return Reloaded(**answers[len(asked) - 1])._asdict()

        self.core.add_call("reload", reload)
        panel = self.open(CoreStatusPanel)

        def press_reload() -> None:
            wait_until(panel.reload.isEnabled, "the button is on")
            click(panel.reload)

        press_reload()
        wrong = opened(ReloadDialog)
        self.assertEqual(wrong.lines.toPlainText().splitlines(), answers[0]["errors"])
        self.assertIsNone(wrong.yes)
        wrong.reject()
        wait_until(lambda: not panel.findChildren(ReloadDialog), "it is closed")
        press_reload()
        listed = opened(ReloadDialog)
        self.assertEqual(listed.lines.toPlainText(), "team 'Late': added\nWarning: passwords.yaml: readable")
        self.assertEqual(asked, ["", ""])
        click(listed.yes)
        wait_until(lambda: "✔ Reload: done" in panel.answer.text(), "it is applied")
        self.assertEqual(asked, ["", "", "d1"])
        press_reload()
        wait_until(lambda: "what is in force" in panel.answer.text(), "nothing differs")

    def test_exit_without_its_service_says_so(self) -> None:
        panel = self.open(CoreStatusPanel)
        click(panel.exit)
        answer(question(), QMessageBox.AcceptRole)
        wait_until(lambda: "Exit failed" in panel.answer.text() and panel.answer.isVisible(), "the failure is shown")


class _Context(QObject):
    """The context that rqt passes to a plugin."""

    def __init__(self) -> None:
        super().__init__()
        self.widgets = []

    def serial_number(self) -> int:
        return 2

    def add_widget(self, widget) -> None:
        self.widgets.append(widget)
        show(widget)


def _load_rqt() -> None:
    """rqt's base class, or the like of it where rqt is not installed."""
    try:
        importlib.import_module("rqt_gui_py.plugin")
    except ImportError:
        package, module = types.ModuleType("rqt_gui_py"), types.ModuleType("rqt_gui_py.plugin")
        module.Plugin = type("Plugin", (QObject,), {})
        sys.modules.update({"rqt_gui_py": package, "rqt_gui_py.plugin": module})


class TestPlugins(CoreCase):
    def test_each_plugin_of_plugin_xml_opens_keeps_its_settings_and_ends(self) -> None:
        _load_rqt()
        logs_failures, sys.excepthook = sys.excepthook, sys.__excepthook__  # as in rqt, which an exception would end
        self.addCleanup(setattr, sys, "excepthook", logs_failures)
        opened = []
        for element in ElementTree.parse(PLUGIN_XML).getroot().iter("class"):
            module, _, name = element.get("type").rpartition(".")
            plugin = getattr(importlib.import_module(module), name)(_Context())
            opened.append(plugin)
            label = element.findtext("qtgui/label")
            self.assertEqual(plugin.panel.windowTitle(), f"{label} (2)")
            settings = Settings()
            plugin.save_settings(Settings(), settings)
            plugin.restore_settings(Settings(), settings)
        self.assertEqual({type(plugin.panel) for plugin in opened}, set(map(load, PANELS)))
        self.assertIs(sys.excepthook, logs_failures)
        wait_until(lambda: all("live" in plugin.panel.news.text() for plugin in opened), "all of them show the core")
        self.assertEqual(dict(rosgraph.Master("/t").getSystemState()[1])["/devices/state"], [rospy.get_name()])
        for plugin in opened:
            plugin.shutdown_plugin()
            plugin.panel.close()
        self.assertIsNone(RefereeClient._shared)
        # A busy master may take longer than the client waits for it at its end.
        wait_until(lambda: "/devices/state" not in dict(rosgraph.Master("/t").getSystemState()[1]), "it has left")


class TestWindow(CoreCase):
    def test_the_window_keeps_its_layout_and_its_panels_settings(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            settings = QSettings(f"{folder}/window.ini", QSettings.IniFormat)
            window = Window(WindowNode(), settings)
            show(window, 1200, 700)
            wait_until(lambda: "live" in window.panels["ScoringPanel"].news.text(), "the core is shown")
            self.assertTrue(all(dock.isVisible() or window.tabifiedDockWidgets(dock) for dock in window.docks.values()))
            window.docks["TabletStatusPanel"].hide()
            window.panels["LogDisplayPanel"].follow.setChecked(False)
            window.shutdown()
            window.close()
            again = Window(WindowNode(), QSettings(f"{folder}/window.ini", QSettings.IniFormat))
            show(again, 1200, 700)
            self.assertFalse(again.docks["TabletStatusPanel"].isVisible())
            self.assertFalse(again.panels["LogDisplayPanel"].follow.isChecked())
            again.shutdown()
            again.close()

    def test_no_window_is_larger_than_the_screen(self) -> None:
        """Its lower edge is STOP, and without a window manager nobody could move it."""
        screen = QApplication.primaryScreen().availableGeometry()
        with tempfile.TemporaryDirectory() as folder:
            for name in ("first", "saved"):
                settings = QSettings(f"{folder}/{name}.ini", QSettings.IniFormat)
                if name == "saved":  # on a larger screen
                    larger = QWidget()
                    larger.setGeometry(40, 40, 2 * screen.width(), 2 * screen.height())
                    settings.setValue("geometry", larger.saveGeometry())
                with unittest.mock.patch.multiple(windows, WIDE_EMS=1000, HIGH_EMS=1000):
                    window = windows.PanelWindow("overview", WindowNode(), settings)
                window.show()
                place = window.geometry()
                window.shutdown()
                window.close()
                self.assertTrue(screen.contains(place), f"{name}: {place}")

    def test_closing_the_window_of_a_launch_asks(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            window = Window(WindowNode(), QSettings(f"{folder}/window.ini", QSettings.IniFormat), of_launch=True)
            show(window, 1200, 700)
            window.close()
            self.assertTrue(window.isVisible())
            answer(question(), QMessageBox.RejectRole)
            window.shutdown()
            window.hide()
