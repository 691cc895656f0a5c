"""The window's safety for a referee under stress, with a real mouse and keyboard."""

from typing import List

import rospy
from support.gui_testing import LONG_S, QApplication, limit, places, settle, wait_until
from support.panel_case import BUMPS, DOOR
from support.real_input import click_on, press_key
from support.window_case import WindowCase, is_closed

from roah_rsbb.rqt import basic
from roah_rsbb.rqt.qt import QTimer

STOP_HOME_A = ("stop_run", "Home A")


class TestStop(WindowCase):
    def wait_stopped(self) -> None:
        wait_until(lambda: "Home A: the robot has stopped" in self.window.strip.way.whole, "the robot has stopped")

    def test_esc_twice_stops_with_a_dialog_open_and_the_first_closes_it(self) -> None:
        self.run_zone()
        dialog = self.ask_note()
        press_key("Escape")
        self.wait_prompt("STOP Home A?  Press Esc again")
        wait_until(lambda: is_closed(dialog), "the dialog is closed")
        self.assertEqual(self.core.calls, [])
        press_key("Escape")
        self.wait_call(*STOP_HOME_A)
        self.wait_stopped()

    def test_esc_twice_stops_with_a_menu_open(self) -> None:
        self.run_zone()
        row = self.scoring.rows[DOOR]
        was_open, look = [], QTimer()

        def press_in_menu() -> None:  # an open menu has an event loop of its own: nothing else runs here
            if row.menu_button.entries.isVisible():
                look.stop()
                was_open.append(True)
                press_key("Escape")

        look.timeout.connect(press_in_menu)
        look.start(50)
        click_on(row.menu_button)
        wait_until(lambda: was_open and not row.menu_button.entries.isVisible(), "the menu was open, and is closed")
        self.wait_prompt("Press Esc again")
        press_key("Escape")
        self.wait_call(*STOP_HOME_A)

    def test_esc_never_leaves_a_run(self) -> None:
        self.run_zone()
        for _ in range(2):
            press_key("Escape")
        self.wait_call(*STOP_HOME_A)
        wait_until(lambda: self.client.model.running_zones() == [], "the run has ended")
        self.wait_stopped()
        for _ in range(4):
            press_key("Escape")
        self.wait_prompt("No zone is running")
        self.prompt.hide()
        press_key("Escape", "Shift_L")
        self.wait_prompt("No zone is running")
        self.assertEqual(self.core.calls, [STOP_HOME_A])
        self.assertEqual(self.zone.phase, "ended")

    def test_esc_works_in_a_floating_dock(self) -> None:
        self.run_zone()
        dock = self.window.docks["ScoringPanel"]
        dock.setFloating(True)
        dock.activateWindow()
        wait_until(lambda: QApplication.activeWindow() is dock, "the dock has the focus")
        for _ in range(2):
            press_key("Escape")
        self.wait_call(*STOP_HOME_A)

    def test_shift_esc_twice_stops_all_zones_with_a_dialog_open(self) -> None:
        for zone in self.ZONES:
            self.run_zone(zone)
        self.ask_note()
        press_key("Escape", "Shift_L")
        self.wait_prompt("STOP Home A, Home B?  Press Shift+Esc again")
        press_key("Escape", "Shift_L")
        self.wait_call("stop_run", "Home A")
        self.wait_call("stop_run", "Home B")


class TestZone(WindowCase):
    def test_a_zone_survives_a_restart_of_the_master(self) -> None:
        self.client.model.choose_zone("Home B")
        wait_until(lambda: rospy.get_param("current_zone", "") == "Home B", "the choice is written")
        rospy.delete_param("current_zone")  # a new master knows no parameter
        wait_until(lambda: rospy.get_param("current_zone", "") == "Home B", "it is written again")
        self.assertEqual(self.client.model.zone_name, "Home B")

    def test_after_a_click_on_a_tile_start_is_off_until_the_referee_has_seen_the_zone(self) -> None:
        for zone in self.core.zones.values():
            zone.command("connect")
        start = self.control.buttons["start"]
        wait_until(start.isEnabled, "START is enabled")
        self.wait_quiet()
        limit(self, basic, "HOLD_MS", round(1000 * LONG_S))
        click_on(self.panel("OverviewPanel").tiles["Home B"])
        wait_until(lambda: self.control.zones.currentText() == "Home B", "the other zone is shown")
        self.assertFalse(start.isEnabled())
        self.assertIn("background", self.control.zones.styleSheet())
        for timer in (start._held, self.control._highlight):  # that time is over
            timer.start(0)
        wait_until(start.isEnabled, "START is enabled again")
        wait_until(lambda: self.control.zones.styleSheet() == "", "the zone is no longer highlighted")

    def test_an_answer_moves_nothing(self) -> None:
        self.run_zone()
        moved, panels = [], [name for name, panel in self.window.panels.items() if hasattr(panel, "answer")]
        self.assertGreater(len(panels), 5)
        for name in panels:
            panel = self.panel(name)
            self.window.docks[name].raise_()
            wait_until(panel.isVisible, "the panel is in front")
            panel.answer.clear_answer()
            self.wait_quiet()
            before = places(panel)
            panel.answer.warn("Something was done. " * 5)
            settle(panel)
            moved += [name] if places(panel) != before else []
        self.assertEqual(moved, [])


class TestBehind(WindowCase):
    """Panels behind others."""

    def test_they_are_not_drawn_and_are_right_at_once_when_they_are_shown(self) -> None:
        self.wait_quiet()
        drawn = []
        for name, panel in self.window.panels.items():
            if not panel.WORKS_BEHIND:
                show_model = panel.show_model
                panel.show_model = lambda name=name, show=show_model: drawn.append(name) or show()
        self.core.box_warnings = ["ANOTHER RSBB"]
        wait_until(lambda: self.client.model.box.warnings == ("ANOTHER RSBB",), "the warning is heard")
        self.hush()
        self.assertEqual(drawn, [])
        status = self.panel("CoreStatusPanel")
        self.window.docks["CoreStatusPanel"].raise_()
        self.assertIn("ANOTHER RSBB", status.notices.toPlainText())
        drawn.clear()
        self.core.silent = False
        self.core.box_warnings = []
        wait_until(lambda: status.notices.toPlainText() == "OK", "the end of the warning is shown")
        self.assertEqual(set(drawn), {"CoreStatusPanel"})

    def test_a_panel_is_drawn_again_only_when_what_it_shows_has_changed(self) -> None:
        drawn: List[str] = []
        needless: List[str] = []
        model = self.client.model
        self.run_zone()
        for name in ("OverviewPanel", "LogDisplayPanel", "ScoringPanel"):
            self._note_draws(name, drawn, needless)
        other = self.core.zones["Home B"]
        other.log = "a line\n"
        wait_until(lambda: model.zone_of("Home B").log == other.log, "it is heard")
        self.assertIn("OverviewPanel", drawn)
        self.zone.log = "another line\n"
        wait_until(lambda: "another line" in self.panel("LogDisplayPanel").view.toPlainText(), "it is shown")
        self.assertEqual((set(drawn), needless), ({"OverviewPanel", "LogDisplayPanel", "ScoringPanel"}, []))

    def _note_draws(self, name: str, drawn: List[str], needless: List[str]) -> None:
        """Note the name of a panel each time that it is drawn, and if nothing has changed since the last time."""
        panel, model = self.panel(name), self.client.model
        show = panel.show_model
        last: List[tuple] = [(*panel.parts(), model.box, model.is_old, model.why)]

        def draw() -> None:
            drawn.append(name)
            last.append((*panel.parts(), model.box, model.is_old, model.why))
            if all(part is before for part, before in zip(last[-1], last[-2])):
                needless.append(name)
            show()

        panel.show_model = draw

    def test_the_keys_of_scoring_score_the_run_of_this_moment(self) -> None:
        self.run_zone()
        self.window.docks["DevicesPanel"].raise_()
        self.zone.command("stop", "disconnect", "connect")
        wait_until(lambda: self.client.model.identity_of("Home A") == self.zone.identity, "the next run is heard")
        press_key("6")
        wait_until(lambda: self.zone.scores.get(BUMPS) == 1, "it is counted")


class TestManyZones(WindowCase):
    ZONES = ("Home A", *(f"Competition arena {number}" for number in range(2, 9)))

    def test_every_tile_shows_zone_and_team(self) -> None:
        overview = self.panel("OverviewPanel")
        for zone in self.core.zones.values():
            zone.command("connect")
        wait_until(lambda: all(tile.phase.text().startswith("●") for tile in overview.tiles.values()), "all are shown")
        self.wait_quiet()
        for name, tile in overview.tiles.items():
            shown = f"{tile.name.shown()}  ·  {tile.event.shown()}"
            zone, team = shown.replace("◆ ", "").split("  ·  ")[:2]
            self.assertGreaterEqual(len(zone), 6, shown)
            self.assertGreaterEqual(len(team), 4, shown)
            self.assertTrue(name.startswith(zone.rstrip("…")), shown)
            self.assertTrue("TestingTeam".startswith(team.rstrip("…")), shown)
            for label in (tile.name, tile.phase, tile.countdown):
                self.assertTrue(tile.rect().contains(label.geometry()), f"{name}: {label.text()} is cut off")
            self.assertLessEqual(tile.name.fontMetrics().horizontalAdvance(tile.name.shown()), tile.name.width(), shown)
