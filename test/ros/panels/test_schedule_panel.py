"""The schedule, clicked with a real mouse, with a fake core: real messages, real services."""

import rospy
from support.fakes.core import EVENTS, FakeCore
from support.gui_testing import QApplication, QMessageBox, Qt, question, settle, wait_until
from support.panel_case import PanelCase
from support.real_input import click_on, press_key

from roah_rsbb.rqt.panels import schedule
from roah_rsbb.rqt.panels.schedule import SchedulePanel

STATE, TEAM, EVENT, SHEET = (schedule.COLUMNS.index(name) for name in ("State", "Team", "Event", "Sheet"))


class TestSchedule(PanelCase):
    PANEL = SchedulePanel

    def setUp(self) -> None:
        super().setUp()
        self.panel.resize(1100, 600)
        wait_until(lambda: len(self.rows()) == 2 * len(EVENTS), "all events are shown")

    def rows(self) -> list:
        return [row for row in self.panel.rows.texts() if row[0]]

    def of_zone(self, zone: str) -> list:
        return [row for row in self.rows() if zone in row]

    def click_row(self, zone: str, index: int, times: int = 1) -> None:
        """Click the event with this index in its zone with the mouse."""
        row = self.panel.rows.texts().index(self.of_zone(zone)[index])
        rows = self.panel.rows
        settle(self.panel)
        for _ in range(times):
            click_on(rows.viewport(), rows.visualItemRect(rows.item(row, STATE)).center())

    def choose(self) -> None:
        click_on(self.panel.choose)

    def select(self, box, text: str) -> None:
        """Choose an entry of a filter as a referee does, with the keyboard."""
        # Not with the mouse: a button that is held for a moment too long chooses the entry under it.
        box.setFocus(Qt.TabFocusReason)
        down = box.findText(text) - box.currentIndex()
        for _ in range(abs(down)):
            press_key("Down" if down > 0 else "Up")
        wait_until(lambda: box.currentText() == text, f"{text} is chosen")

    def answer(self, box: QMessageBox, role: int) -> None:
        click_on(next(button for button in box.buttons() if box.buttonRole(button) == role))
        wait_until(lambda: not self.is_asked(), "the question is gone")

    def is_asked(self) -> bool:
        return any(isinstance(widget, QMessageBox) and widget.isVisible() for widget in QApplication.topLevelWidgets())

    def calls(self) -> list:
        return [call for call in self.core.calls if call[0] == "choose_event"]

    def test_events_states_and_delays_are_shown(self) -> None:
        self.assertEqual([row[STATE] for row in self.of_zone("Home A")], ["→ next", "later", "later"])
        self.assertEqual([row[TEAM] for row in self.of_zone("Home A")], [event[3] for event in EVENTS])
        self.assertEqual({row[2] for row in self.rows()}, {"+12 min"})
        self.assertTrue(all(row[1].startswith("~ ") for row in self.rows()), "estimates are marked")
        self.zone.command("connect")
        self.zone.command("start")
        wait_until(lambda: self.of_zone("Home A")[0][STATE] == "▶ running", "the run is shown")
        self.assertFalse(self.of_zone("Home A")[0][1].startswith("~"), "it has begun")

    def test_filters(self) -> None:
        self.select(self.panel.zones, "Home B")
        self.assertEqual({row[4] for row in self.rows()}, {"Home B"})
        self.select(self.panel.teams, "AnotherTeam")
        self.assertEqual([row[TEAM] for row in self.rows()], ["AnotherTeam"])
        self.select(self.panel.shows, "not signed off")
        wait_until(lambda: schedule.NO_EVENTS in self.panel.rows.texts()[0], "nothing fits")
        self.select(self.panel.teams, "All teams")
        self.select(self.panel.zones, "All zones")
        self.select(self.panel.shows, "to come")
        self.assertEqual(len(self.rows()), 2 * len(EVENTS))

    def test_an_event_is_chosen(self) -> None:
        self.assertFalse(self.panel.choose.isEnabled(), "none is selected")
        self.click_row("Home B", 2)
        self.choose()
        self.wait_call("choose_event", "Home B", EVENTS[2][0], False)
        wait_until(lambda: self.of_zone("Home B")[2][STATE] == "→ next", "it is next")
        self.assertEqual(self.core.zones["Home A"].index, 0)
        wait_until(lambda: "Home B is at this event already" in self.panel.choose.toolTip(), "the zone is there")
        self.assertFalse(self.panel.choose.isEnabled())

    def test_a_run_that_is_not_signed_off_is_left_after_a_question(self) -> None:
        self.zone.command("connect")
        self.zone.command("start")
        self.click_row("Home A", 1)
        wait_until(lambda: "Stop it first" in self.panel.choose.toolTip(), "a running run stays")
        self.assertFalse(self.panel.choose.isEnabled())
        self.zone.not_stopped = ["mbot"]
        self.zone.command("stop")
        self.choose()
        box = question()
        self.assertIn(f"Leave {EVENTS[0][0]}", box.text())
        self.assertTrue(box.informativeText().startswith("mbot did not answer STOP. After the disconnect"))
        self.answer(box, QMessageBox.RejectRole)
        self.assertEqual(self.calls(), [])
        self.choose()
        self.answer(question(), QMessageBox.AcceptRole)
        self.wait_call("choose_event", "Home A", EVENTS[1][0], True)
        wait_until(lambda: self.of_zone("Home A")[0][SHEET] == "not signed off", "it is to be signed off")
        self.assertIn("1 not signed off", self.panel.where())

    def test_what_a_question_asked_must_still_hold_when_it_is_answered(self) -> None:
        self.zone.command("connect", "start", "stop")
        wait_until(lambda: self.of_zone("Home A")[0][SHEET] == "not signed off", "the run is over")
        self.click_row("Home A", 2)
        self.choose()
        box = question()
        first = self.client.model.document.schedule
        self.zone.command("disconnect", "next", "connect", "start", "stop")  # another run would be left
        wait_until(lambda: self.of_zone("Home A")[1][SHEET] == "not signed off", "the next run is over")
        self.assertIsNot(self.client.model.document.schedule, first)
        self.answer(box, QMessageBox.AcceptRole)
        self.assertIn("Not done", self.panel._answer.text())
        self.choose()
        box = question()
        self.core.close()
        self.core = FakeCore(("Home B",), box_uuid="another")
        wait_until(lambda: not self.of_zone("Home A"), "another core has no such zone")
        self.panel._answer.clear_answer()
        self.answer(box, QMessageBox.AcceptRole)
        self.assertIn("Not done", self.panel._answer.text())
        self.assertEqual(self.calls(), [])

    def test_a_double_click_chooses(self) -> None:
        self.addCleanup(QApplication.setDoubleClickInterval, QApplication.doubleClickInterval())
        QApplication.setDoubleClickInterval(60_000)  # the machine may be busy between the clicks
        self.click_row("Home A", 1, times=2)
        self.wait_call("choose_event", "Home A", EVENTS[1][0], False)

    def test_a_refusal_is_shown(self) -> None:
        self.core.refuse = "the schedule was changed"
        self.click_row("Home A", 2)
        self.choose()
        wait_until(lambda: "the schedule was changed" in self.panel._answer.text(), "the reason is shown")

    def test_a_silent_core_takes_no_choice(self) -> None:
        self.click_row("Home A", 2)
        self.fall_silent()
        wait_until(lambda: schedule.OLD in self.panel.choose.toolTip(), "it says that the core is silent")
        self.assertFalse(self.panel.choose.isEnabled())
        self.assertEqual(len(self.rows()), 2 * len(EVENTS), "what was heard last stays")
        self.assertFalse(rospy.is_shutdown())
