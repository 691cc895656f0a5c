"""Overview and Devices, clicked on, with a fake core and fake devices."""

import re
import time
from types import SimpleNamespace

from support.fakes.core import Asked, FakeCore
from support.fakes.devices import FakeDevices
from support.gui_testing import LONG_S, QApplication, QPoint, Qt, QTest, click, limit, show, wait_until
from support.panel_case import PanelCase

from roah_rsbb.rqt import basic
from roah_rsbb.rqt.panels import devices, overview
from roah_rsbb.rqt.panels.devices import DevicesPanel
from roah_rsbb.rqt.panels.overview import OverviewPanel, TileArrangement, best_arrangement
from roah_rsbb.rqt.qt import QEvent, QMouseEvent, QPointF, QWheelEvent
from roah_rsbb.wording import whole_box as wording


class TestOverview(PanelCase):
    PANEL = OverviewPanel

    def setUp(self) -> None:
        super().setUp()
        self.other = self.core.zones["Home B"]
        wait_until(lambda: self.panel.tiles, "the zones are shown")
        self.tile, self.other_tile = self.panel.tiles["Home A"], self.panel.tiles["Home B"]

    def replace_core(self, *zones: str) -> None:
        """The core is started again with other zones."""
        self.core.close()
        self.core = FakeCore(zones, box_uuid="another")
        self.addCleanup(self.core.close)
        self.zone, self.other = self.core.zones["Home A"], self.core.zones["Home B"]

    def run_both(self) -> None:
        for zone in (self.zone, self.other):
            zone.command("connect")
            zone.command("start")
        wait_until(lambda: "Home A, Home B" in self.panel.head.text(), "both are running")

    # -- showing ------------------------------------------------------------------------------------

    def test_each_zone_is_shown_with_its_phase_team_and_countdown(self) -> None:
        self.zone.command("next")
        self.zone.command("connect")
        self.zone.command("start")
        wait_until(lambda: self.tile.phase.text() == "▶ RUNNING", "the zone runs")
        # Phase and event come in two messages.
        wait_until(lambda: self.tile.event.text() == "AnotherTeam  ·  HWV  ·  round 1, run 2",
                   lambda: f"the event is shown, not {self.tile.event.text()}")
        wait_until(lambda: re.fullmatch(r"(\d:[0-5]\d|10:00)", self.tile.countdown.text()), "the time left is shown")
        self.wait_heard()
        self.assertEqual(self.other_tile.phase.text(), "○ NOT CONNECTED")
        self.assertEqual(self.other_tile.todo.text(), "→ Connect is possible")
        self.assertEqual(self.panel.head.text(), "▶ RUNNING: Home A")

    def test_the_next_task_is_highlighted(self) -> None:
        self.run_both()
        self.other.warnings = ["The clock is off", "No message"]
        wait_until(lambda: self.other_tile.todo.text() == "⚠ The clock is off   (⚠ 1 more)", "warnings are shown")
        self.other.asked = Asked(1, "Place the <b>mug</b>")
        text = "☛ DO NOW: Place the <b>mug</b>   (⚠ 2 more)"
        wait_until(lambda: self.other_tile.todo.text() == text, "the request is shown")
        self.assertIn("☛ DO NOW: Home B", self.panel.head.text())
        self.other.asked = None
        wait_until(lambda: "DO NOW" not in self.panel.head.text(), "it is done")

    def test_a_new_call_beeps_once_also_of_a_zone_that_is_not_chosen(self) -> None:
        beeps = []
        beep, overview.QApplication.beep = QApplication.beep, lambda: beeps.append(1)
        self.addCleanup(setattr, QApplication, "beep", beep)
        for number in (1, 2):  # the same words again are another request
            self.other.asked = Asked(number, "Place it")
            wait_until(lambda n=number: len(beeps) >= n, "it beeps")
            self.wait_heard()
            self.assertEqual(len(beeps), number)
        self.other.asked = None
        for number in (3, 4):
            self.other.switches, self.other.switches_asked = set(), True
            wait_until(lambda n=number: len(beeps) >= n, "switches are to be entered")
            self.other.switches_asked = False
            wait_until(lambda: "DO NOW" not in self.panel.head.text(), "they were")
        self.assertEqual(len(beeps), 4)

    def test_a_silent_core_is_marked_here_too(self) -> None:
        self.run_both()
        self.fall_silent()
        wait_until(lambda: self.tile.countdown.text().startswith("("), "the countdown is old")
        self.assertTrue(self.panel.head.text().startswith("("))
        self.assertFalse(self.tile.todo.isEnabled())
        self.assertTrue(self.strip.stop_all.is_on())  # it may still get through
        self.core.silent = False
        wait_until(lambda: not self.tile.countdown.text().startswith("("), "it is live again")

    def test_a_click_chooses_the_zone_for_all_panels(self) -> None:
        QTest.mouseClick(self.other_tile, Qt.LeftButton, Qt.NoModifier, QPoint(5, 5))
        self.assertEqual(self.client.model.zone_name, "Home B")
        wait_until(lambda: self.other_tile.name.text() == "◆ Home B", "it is marked as the chosen one")
        self.assertEqual(self.tile.name.text(), "Home A")
        self.tile.setFocus()
        QTest.keyClick(self.tile, Qt.Key_Return)
        self.assertEqual(self.client.model.zone_name, "Home A")

    def test_other_zones_of_another_schedule(self) -> None:
        self.replace_core("Home A", "Home B", "Arena")
        wait_until(lambda: list(self.panel.tiles) == ["Home A", "Home B", "Arena"], "the new zone has a tile")
        kind = type(self.panel.tiles["Arena"])
        wait_until(lambda: len(self.panel.findChildren(kind)) == 3, "the tiles from before are gone")

    def test_tiles_grow_with_the_panel(self) -> None:
        def size() -> float:
            return self.tile.name.font().pointSizeF()

        show(self.panel, 380, 230)
        wait_until(lambda: self.tile.minimumHeight() < overview.HIGH_EMS * basic.em(), "there is little room")
        small = size()
        show(self.panel, 1300, 740)
        wait_until(lambda: size() > 1.5 * small, "there is room")

    def test_tiles_fill_the_panel(self) -> None:
        self.assertEqual(best_arrangement(2, 22.0, 13.0).columns, 1)
        self.assertEqual(best_arrangement(4, 60.0, 13.0), TileArrangement(2, 1.1))
        self.assertEqual(best_arrangement(1, 900.0, 900.0).factor, overview.MOST)
        self.assertEqual(best_arrangement(9, 10.0, 10.0), TileArrangement(1, overview.LEAST))


class TestDevices(PanelCase):
    PANEL = DevicesPanel

    def setUp(self) -> None:
        self.devices = FakeDevices()
        self.addCleanup(self.devices.close)
        super().setUp()
        self.rows = self.panel.rows
        # The panel shows what the model has heard a moment later; until then its controls are off.
        wait_until(self.rows["blinds"].slider.isEnabled, "the devices are heard and shown")

    def tearDown(self) -> None:
        self.devices.answer_gate.set()
        super().tearDown()

    def wait_set(self, device: str, value: object) -> None:
        wait_until(lambda: (device, value) in self.devices.calls, f"{device} is set; calls: {self.devices.calls}")

    def test_switches_and_door(self) -> None:
        for device, word in (("switch_1", "ON"), ("switch_3", "ON"), ("door_win_detect", "OPEN")):
            row = self.rows[device]
            click(row.commands[0])
            self.wait_set(device, True)
            wait_until(lambda row=row, word=word: row.state.text() == f"● {word}", f"{device} is shown")
        click(self.rows["switch_1"].commands[1])
        self.wait_set("switch_1", False)
        wait_until(lambda: self.rows["switch_1"].state.text() == "○ off", "it is off")
        self.assertEqual(self.rows["switch_2"].state.text(), "○ off")

    def test_values_set_by_others_are_shown(self) -> None:
        self.devices.publish(switch_2=True, blinds=80, door_win_detect=True)
        wait_until(lambda: self.rows["blinds"].number.value() == 80, "the blinds are shown")
        self.assertEqual(self.rows["blinds"].slider.value(), 80)
        self.assertEqual(self.rows["switch_2"].state.text(), "● ON")
        self.assertEqual(self.rows["door_win_detect"].state.text(), "● OPEN")
        self.assertEqual(self.devices.calls, [])

    def test_the_exact_number(self) -> None:
        number = self.rows["dimmer"].number
        number.setFocus()
        number.selectAll()
        QTest.keyClicks(number, "37")
        self.assertEqual(self.devices.calls, [])
        self.devices.publish(dimmer=5)  # while it is being typed
        wait_until(lambda: self.client.model.devices.dimmer == 5, "the message has come")
        self.assertEqual(number.text(), "37 %")
        QTest.keyClick(number, Qt.Key_Return)
        self.wait_set("dimmer", 37)
        wait_until(lambda: self.rows["dimmer"].slider.value() == 37, "the slider follows")
        self.assertEqual(self.devices.calls, [("dimmer", 37)])

    def test_a_slider_that_is_dragged_is_the_referees(self) -> None:
        row = self.rows["blinds"]
        slider = row.slider
        QTest.mousePress(slider, Qt.LeftButton, Qt.NoModifier, QPoint(6, slider.height() // 2))
        self.assertTrue(slider.isSliderDown())
        middle = QPointF(slider.rect().center())
        # QTest's own movement does not hold the button.
        QApplication.sendEvent(slider, QMouseEvent(QEvent.MouseMove, middle, Qt.NoButton, Qt.LeftButton, Qt.NoModifier))
        wait_until(lambda: 30 < row.number.value() < 70, "the number goes with the hand")
        dragged = row.number.value()
        self.devices.publish(blinds=99)
        wait_until(lambda: self.client.model.devices.blinds == 99, "the message has come")
        self.wait_heard()
        self.assertEqual((row.number.value(), slider.sliderPosition()), (dragged, dragged))
        self.assertEqual(self.devices.calls, [])
        QTest.mouseRelease(slider, Qt.LeftButton, Qt.NoModifier, slider.rect().center())
        self.wait_set("blinds", dragged)

    def test_an_older_message_does_not_overwrite(self) -> None:
        now = [100.0]  # states carry no time: how long an older one may still come is measured by a clock
        limit(self, devices, "time", SimpleNamespace(monotonic=lambda: now[0], time=time.time))
        click(self.rows["dimmer"].commands[1])
        self.wait_set("dimmer", 100)
        wait_until(lambda: not self.panel._edits.is_waiting("dimmer"), "it is answered")
        self.devices.publish(dimmer=0)  # as if it had been on its way since before
        wait_until(lambda: self.client.model.devices.dimmer == 0, "the message has come")
        self.assertEqual(self.rows["dimmer"].number.value(), 100)
        # What is still so after that is true.
        now[0] += devices.LATE_S + 0.1
        wait_until(lambda: self.rows["dimmer"].number.value() == 0, "what is published is shown")

    def test_a_failed_call_is_shown_and_the_widget_goes_back(self) -> None:
        self.devices.refuse = "the blinds are stuck"
        click(self.rows["blinds"].commands[1])
        wait_until(lambda: "the blinds are stuck" in self.panel.answer.text(), "the failure is shown")
        self.assertIn("Blinds: 100 % failed", self.panel.answer.text())
        wait_until(lambda: self.rows["blinds"].slider.value() == 0, "it goes back")
        click(self.rows["switch_1"].commands[0])
        wait_until(lambda: "Switch 1: 1 failed" in self.panel.answer.text(), "this one failed, too")
        self.assertEqual(self.rows["switch_1"].state.text(), "○ off")

    def test_quick_clicks_arrive_in_order(self) -> None:
        self.devices.answer_gate.clear()
        click(self.rows["switch_1"].commands[0])
        wait_until(lambda: self.devices.calls, "the first call is made")
        self.assertEqual(self.rows["switch_1"].state.text(), "● ON …")
        click(self.rows["switch_1"].commands[1])
        self.devices.answer_gate.set()
        self.wait_set("switch_1", False)
        self.assertEqual(self.devices.calls, [("switch_1", True), ("switch_1", False)])

    def test_the_bell(self) -> None:
        self.assertIn("never", self.panel.bell.text())
        limit(self, wording, "RINGS_S", LONG_S)
        click(self.panel.ring)
        wait_until(lambda: "♪ RINGS" in self.panel.bell.text(), "the ring is shown")
        self.assertEqual(self.devices.calls, [("bell", None)])
        limit(self, wording, "RINGS_S", 1.5)
        wait_until(lambda: "RINGS" not in self.panel.bell.text(), "it is over")
        self.assertRegex(self.panel.bell.text(), r"\d+ (s|min) ago")

    def test_a_controller_that_is_away_is_said(self) -> None:
        wait_until(lambda: self.panel.connection.text() == "● connected", "it is connected")
        self.devices.connect(False, "the controller at 192.168.1.56 cannot be reached")
        wait_until(lambda: "NOT CONNECTED" in self.panel.connection.text(), "it is away")
        self.assertIn("cannot be reached", self.panel.reason.text())
        self.assertIn(wording.AWAY, self.panel.reason.text())
        self.assertTrue(self.rows["switch_1"].commands[0].isEnabled())  # it takes effect later

    def test_a_devices_node_that_is_gone_is_said_and_found_again(self) -> None:
        self.devices.leave()
        wait_until(lambda: "NO DEVICES" in self.panel.connection.text(), "it is gone")
        self.assertFalse(self.rows["switch_1"].commands[0].isEnabled())
        self.assertIn("not with devices:=true", self.rows["switch_1"].commands[0].toolTip())
        self.assertFalse(self.rows["dimmer"].slider.isEnabled())
        again = FakeDevices()
        self.addCleanup(again.close)
        wait_until(lambda: self.panel.connection.text() == "● connected", "it is back")

    def test_they_do_not_depend_on_the_core(self) -> None:
        self.fall_silent()
        wait_until(lambda: "OLD" in self.panel.news.text(), "the core is silent")
        click(self.rows["switch_1"].commands[0])
        self.wait_set("switch_1", True)
        wait_until(lambda: self.rows["switch_1"].state.text() == "● ON", "it is shown")

    def test_the_wheel_sets_nothing(self) -> None:
        for widget in (self.rows["dimmer"].slider, self.rows["dimmer"].number):
            middle = QPointF(widget.rect().center())
            QApplication.sendEvent(widget, QWheelEvent(
                middle, QPointF(widget.mapToGlobal(widget.rect().center())), QPoint(), QPoint(0, 120),
                Qt.NoButton, Qt.NoModifier, Qt.NoScrollPhase, False,
            ))
        self.assertEqual((self.rows["dimmer"].slider.value(), self.rows["dimmer"].number.value()), (0, 0))
