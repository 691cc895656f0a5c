"""What a referee scores with, in the whole window: the sheet, keys, undo, and who did what."""

from support.fakes.core import EVENTS, Asked
from support.gui_testing import LONG_S, QApplication, Qt, QWidget, click, limit, settle, wait_until
from support.panel_case import BUMPS, DOOR
from support.real_input import click_on, press_key
from support.window_case import WindowCase, in_sight

from roah_rsbb.rqt import basic
from roah_rsbb.rqt.keys import KeysPage
from roah_rsbb.rqt.panels.panel import MOST_ATTEMPTS
from roah_rsbb.rqt.panels.score_sheet import placed
from roah_rsbb.rqt.qt import QPushButton
from roah_rsbb.scoring.sheet import Mark
from roah_rsbb.wording import times
from roah_rsbb.wording.sheets import HistoryEntry

PERSON = ("Disqualifying behaviours", "Hits Annie or another person")


class TestCollapse(WindowCase):
    def setUp(self) -> None:
        super().setUp()
        self.overview, self.log = self.panel("OverviewPanel"), self.panel("LogDisplayPanel")

    def test_overview_and_log_come_back_when_the_run_is_left_and_not_while_it_is_scored(self) -> None:
        self.wait_quiet()
        before = self.window.docks["OverviewPanel"].height()
        self.run_zone()
        self.assertTrue(self.log.is_collapsed)
        self.assertFalse(self.overview.tiles["Home A"].isVisible())
        self.zone.command("stop")
        wait_until(lambda: "ENDED" in self.control.phase.text(), "the run has ended")
        self.assertTrue(self.overview.is_collapsed)
        updated, again = self.client.model.updated, []

        def update_again() -> None:  # as on a busy machine, before Qt comes to anything else
            if not self.overview.is_collapsed and not again:
                again.append(1)
                updated.emit()

        updated.connect(update_again)
        self.addCleanup(updated.disconnect, update_again)
        # As on a busy machine: Scoring leaves the space of its sheet later.
        self.scoring.setMinimumHeight(self.window.docks["ScoringPanel"].height())
        self.zone.command("disconnect")
        wait_until(lambda: not self.overview.is_collapsed and not self.log.is_collapsed, "they are back")
        wait_until(lambda: again, "the panels were updated again")
        ticks: list = []
        self.client.model.ticked.connect(lambda: ticks.append(1))
        wait_until(lambda: len(ticks) > 2 * MOST_ATTEMPTS, "they looked many times")
        self.scoring.setMinimumHeight(0)
        dock = self.window.docks["OverviewPanel"]
        wait_until(lambda: abs(dock.height() - before) < 2 * basic.em(),
                   lambda: f"with the height from before, {before} (kept: {self.overview._height}), not {dock.height()}"
                           f" beside {self.window.docks['ScoringPanel'].height()}")
        self.assertTrue(self.log.view.isVisible())
        self.assertTrue(again)

    def test_a_sheet_that_comes_moves_no_other_panel(self) -> None:
        self.zone.command("connect")
        wait_until(lambda: self.scoring.rows, "a sheet is shown")
        self.zone.command("disconnect")
        wait_until(lambda: not self.scoring.rows, "no sheet is shown")
        self.wait_quiet()
        before = self.places()
        self.zone.command("connect")
        wait_until(lambda: self.scoring.rows, "another sheet is shown")
        self.wait_quiet()
        self.assertEqual(self.places(), before)

    def places(self) -> dict:
        """Where the panels are that can be seen. Qt keeps a dock behind another tab outside the window."""
        return {name: dock.geometry() for name, dock in self.window.docks.items() if not dock.visibleRegion().isEmpty()}

    def test_a_button_shows_them_during_the_run(self) -> None:
        self.run_zone()
        click(self.overview.toggle)
        wait_until(self.overview.tiles["Home A"].isVisible, "the tiles are shown")
        click(self.overview.toggle)
        wait_until(lambda: not self.overview.tiles["Home A"].isVisible(), "the tiles are hidden")

    def test_what_runs_can_be_read_while_the_core_is_silent(self) -> None:
        self.run_zone()
        self.fall_silent()
        wait_until(lambda: self.overview.news.text() == "⚠", "the overview is marked as old")
        self.assertIn("OLD", self.overview.news.toolTip())
        settle(self.window)
        self.assertEqual(self.overview.head.shown(), "(▶ RUNNING: Home A)")

    def test_without_a_sheet_nothing_scrolls_and_there_is_nothing_to_undo(self) -> None:
        self.wait_quiet()
        self.assertFalse(self.scoring.undo.isVisible())
        self.assertFalse(self.scoring.area.verticalScrollBar().isVisible())

    def test_a_run_without_items_for_the_referee_needs_no_space(self) -> None:
        self.zone.has_items = False
        self.zone.command("connect")
        self.zone.command("start")
        wait_until(lambda: "Home A" in self.client.model.running_zones(), "the run is in progress")
        self.wait_heard()
        self.assertFalse(self.overview.is_collapsed)


class TestKeys(WindowCase):
    def setUp(self) -> None:
        super().setUp()
        self.run_zone()

    def test_a_number_scores_the_item_and_shift_takes_it_back(self) -> None:
        press_key("1")
        self.wait_call("score", "Home A", *DOOR, 1)
        press_key("1", "Shift_L")
        self.wait_call("score", "Home A", *DOOR, 0)
        for _ in range(2):
            press_key("6")
        wait_until(lambda: self.zone.scores.get(BUMPS) == 2, "both are counted")
        press_key("6", "Shift_L")
        wait_until(lambda: self.zone.scores.get(BUMPS) == 1, "one is taken back")
        self.assertEqual(len(self.core.calls), 5)

    def test_a_number_in_a_text_scores_nothing(self) -> None:
        click_on(self.scoring.referee)
        for key in ("A", "6", "question"):
            press_key(key)
        wait_until(lambda: self.client.referee.name.lower().startswith("a6"), "it is typed")
        self.assertEqual(self.core.calls, [])

    def test_every_item_is_reached_by_tab_and_space_presses_the_button_in_the_frame(self) -> None:
        first = self.scoring.rows[DOOR].toggle
        first.setFocus(Qt.TabFocusReason)
        seen = []
        for _ in range(60):
            widget = QApplication.focusWidget()
            frame = widget.parentWidget().findChild(QWidget, "focus ring", Qt.FindDirectChildrenOnly)
            self.assertIsNotNone(frame, f"{widget} has a frame")
            self.assertTrue(frame.isVisible())
            self.assertTrue(frame.geometry().contains(widget.geometry()))
            if widget in seen:
                break
            seen.append(widget)
            press_key("Tab")
        rows = list(self.scoring.rows.values())
        controls = [getattr(row, "toggle", None) or row.more for row in rows]
        places = [seen.index(control) for control in controls]
        self.assertEqual(places, sorted(places), "in the order of the sheet")
        first.setFocus(Qt.TabFocusReason)
        press_key("space")
        self.wait_call("score", "Home A", *DOOR, 1)

    def test_a_key_pressed_twice_is_no_other_command(self) -> None:
        """Qt would move the focus on from a button that is switched off."""
        click(self.scoring.rows[BUMPS].more)
        less = self.scoring.rows[BUMPS].less
        wait_until(less.isEnabled, "it is counted")
        less.setFocus(Qt.TabFocusReason)
        for _ in range(3):
            press_key("space")
        self.wait_call("score", "Home A", *BUMPS, "-1")
        self.wait_answered()
        self.assertEqual([call[-1] for call in self.core.calls], ["+1", "-1"])
        press_key("6")
        wait_until(lambda: QApplication.focusWidget() is less, "the focus is back when the button is on again")
        stop = self.window.strip.stop
        stop.setFocus(Qt.TabFocusReason)
        for _ in range(2):
            press_key("space")
        wait_until(lambda: "ENDED" in self.control.phase.text(), "the run has ended")
        self.assertEqual({call for call in self.core.calls if call[0] != "score"}, {("stop_run", "Home A")})
        self.assertIs(QApplication.focusWidget(), stop)

    def test_what_is_typed_while_the_core_falls_silent_is_no_command(self) -> None:
        self.zone.command("stop")
        reason = self.control.reason
        wait_until(reason.isEnabled, "a reason can be typed")
        click_on(reason)
        press_key("a")
        self.fall_silent()
        wait_until(lambda: not reason.isEnabled(), "nothing can be changed")
        for key in ("space", "1", "space"):
            press_key(key)
        self.core.silent = False
        wait_until(lambda: QApplication.focusWidget() is reason, "the focus is back")
        press_key("1")
        self.assertEqual(reason.text(), "a1")
        self.wait_answered()
        self.assertEqual({call[0] for call in self.core.calls}, {"stop_reason"})

    def test_a_question_mark_shows_all_keys_and_esc_closes_them(self) -> None:
        press_key("question", "Shift_L")
        page = self.dialog(KeysPage)
        click_on(self.window.strip.stop)
        self.wait_call("stop_run", "Home A")
        page.activateWindow()
        wait_until(lambda: QApplication.activeWindow() is page, "the page has the focus")
        press_key("Escape")
        wait_until(lambda: not any(isinstance(w, KeysPage) and w.isVisible() for w in QApplication.topLevelWidgets()),
                   "it is closed")
        press_key("question", "Shift_L")
        self.dialog(KeysPage).close()


class TestUndo(WindowCase):
    def test_a_button_withdraws_its_entry_and_no_other(self) -> None:
        self.client.referee.set("Anna")
        self.run_zone()
        for item in (DOOR, BUMPS, PERSON):
            self.zone.mark(Mark(*item, 1), "Anna (/somewhere)")
        undo = self.scoring.undo
        wait_until(lambda: len(undo.buttons) == 3 and undo.buttons[1].isEnabled(), "the marks are shown")
        self.assertIn("Undo: Bumps into the furniture +1", undo.buttons[1].toolTip())
        self.assertIn("by Anna,", undo.buttons[1].toolTip())
        others = [undo.buttons[0], undo.buttons[2]]
        click_on(undo.buttons[1])
        self.wait_call("withdraw", "Home A", 2)
        wait_until(lambda: undo.buttons == others, "it is gone, and the others stay where they are")
        self.assertEqual([entry.number for entry in self.zone.book.sheet.history if entry.withdrawn_utc], [2])
        self.assertRegex(self.zone.book.sheet.history[1].withdrawn_by, r"^Anna \(/")

    def test_a_new_mark_takes_the_place_of_the_oldest_and_nothing_else_moves(self) -> None:
        entries = [HistoryEntry(n, 0.0, "Anna", "G", f"item {n}", "uint", 0, False, 1, False) for n in range(1, 8)]
        places = placed([None] * 5, entries[4::-1])
        self.assertEqual([entry.number for entry in places], [1, 2, 3, 4, 5])
        places = placed(places, entries[5:0:-1])
        self.assertEqual([entry.number for entry in places], [6, 2, 3, 4, 5])
        places = placed(places, [entries[5], entries[3], entries[2], entries[1], entries[0]])  # 5 was withdrawn
        self.assertEqual([entry.number for entry in places], [6, 2, 3, 4, 1])

    def test_a_mark_that_has_just_come_cannot_be_undone_by_a_click_that_meant_another(self) -> None:
        self.run_zone()
        limit(self, basic, "HOLD_MS", round(1000 * LONG_S))
        self.zone.mark(Mark(*BUMPS, 1), "Anna")
        wait_until(lambda: self.scoring.undo.buttons, "the mark is shown")
        self.assertFalse(self.scoring.undo.buttons[0].isEnabled())
        self.scoring.undo.buttons[0].let_go()  # that time is over
        wait_until(self.scoring.undo.buttons[0].isEnabled, "it can be undone a moment later")

    def test_equal_numbers_of_another_run_are_other_marks(self) -> None:
        for zone in self.ZONES:
            self.run_zone(zone)
            self.core.zones[zone].mark(Mark(*BUMPS, 1), "Anna")
        undo = self.scoring.undo

        def show(zone: str) -> None:
            self.client.model.choose_zone(zone)
            wait_until(lambda: self.scoring._sheet[0] == zone and undo.buttons, "the mark is shown")
            self.wait_quiet()

        show("Home B")
        show("Home A")
        limit(self, basic, "HOLD_MS", round(1000 * LONG_S))
        undo.buttons[0].let_go()
        wait_until(undo.buttons[0].isEnabled, "it can be undone")
        self.client.model.choose_zone("Home B")
        self.assertEqual(len(undo.buttons), 1)
        self.assertFalse(undo.buttons[0].isEnabled())


class TestOperation(WindowCase):
    def test_scoring_comes_back_after_a_manual_operation(self) -> None:
        self.run_zone()
        panel = self.panel("ManualOperationPanel")
        self.assertTrue(in_sight(self.scoring.referee))
        for number in (1, 2):
            self.zone.asked = Asked(number, "Place the mug")
            wait_until(lambda: in_sight(panel.text), "the request comes to the front")
            click_on(panel.buttons[0])
            wait_until(lambda: in_sight(self.scoring.referee), "Scoring is back in front")
        self.another_panel_that_the_referee_chose_stays_in_front()

    def another_panel_that_the_referee_chose_stays_in_front(self) -> None:
        self.zone.asked = Asked(3, "Place the mug")
        panel, devices = self.panel("ManualOperationPanel"), self.panel("DevicesPanel")
        wait_until(lambda: in_sight(panel.text), "the request comes to the front")
        self.window.docks["DevicesPanel"].raise_()
        wait_until(lambda: in_sight(devices.ring), "the referee looks at the devices")
        self.zone.asked = None
        wait_until(lambda: panel._request is None, "the request is over")
        self.wait_quiet()
        self.assertTrue(in_sight(devices.ring))


class TestTimes(WindowCase):
    def test_a_pause_is_a_band_and_run_and_goal_have_their_own_figures(self) -> None:
        self.run_zone()
        times = self.control.times
        self.assertFalse(times.goal.isVisible())
        self.assertEqual(times.main.label.text(), "Run: time left")
        self.zone.pause("manual operation")
        wait_until(lambda: "PAUSED: manual operation" in self.control.phase.text(), "the pause is shown")
        self.assertIn("PAUSED", self.panel("OverviewPanel").tiles["Home A"].phase.text())
        self.zone.pause("")
        wait_until(lambda: "RUNNING" in self.control.phase.text(), "the run continues")
        self.after_the_end_the_final_time_is_the_largest_figure()

    def after_the_end_the_final_time_is_the_largest_figure(self) -> None:
        self.core.pass_time(92.0)
        self.zone.command("stop")
        main = self.control.times.main
        wait_until(lambda: main.label.text() == "Final time of the run", "the label changes with the figure")
        took_s = self.zone.book.state.elapsed_s
        self.assertGreaterEqual(took_s, 92.0)
        self.assertEqual(main.figure.text(), times.elapsed(took_s))
        self.assertIn("Time left after the stop: ", self.control.times.aside.text())
        others = [w for kind in (QPushButton,) for w in self.control.findChildren(kind)]
        self.assertGreater(main.figure.fitted_font().pixelSize(), max(w.fontInfo().pixelSize() for w in others))

    def test_the_last_seconds_stand_out_without_colour(self) -> None:
        limit(self, times, "SOON_S", 500.0)  # a busy machine may need some seconds to show it
        limit(self, times, "LAST_S", 250.0)
        self.run_zone()
        self.core.pass_time(EVENTS[0][4] - 500.0)
        main = self.control.times.main
        wait_until(lambda: main.figure.tone is basic.OLD, "it is amber")
        self.assertFalse(main.figure.framed)
        self.core.pass_time(250.0)
        wait_until(lambda: main.figure.framed and "LAST SECONDS" in main.label.text(), "it has a frame and words")
