"""Benchmark Control and Scoring, clicked on, with a fake core: real messages, real services."""

import time
from dataclasses import replace

import rospy
from support.fakes.core import FakeCore
from support.gui_testing import QMessageBox, Qt, QTest, answer, click, limit, question, settle, wait_until
from support.panel_case import BUMPS, DOOR, PanelCase

from roah_rsbb.model.reason import RunName
from roah_rsbb.rqt import basic, calls
from roah_rsbb.rqt.node import failure_text
from roah_rsbb.rqt.panels.scoring import ScoringPanel
from roah_rsbb.rqt.qt import QLabel
from roah_rsbb.rulebook.benchmarks import EventRules, PhaseRule
from roah_rsbb.scoring.sheet import Mark


class TestBenchmarkControl(PanelCase):
    def setUp(self) -> None:
        super().setUp()
        self.buttons = self.panel.buttons

    def wait_phase(self, text: str) -> None:
        wait_until(lambda: text in self.panel.phase.text(),
                   lambda: f"the phase is {text}, not {self.panel.phase.text()}")

    def run_zones(self, *zones: str) -> None:
        """Start a run in these zones, and wait until the panel shows all about it."""
        for zone in zones or ("Home A",):
            self.core.zones[zone].command("connect", "start")
        self.wait_heard()
        self.wait_phase("RUNNING")
        wait_until(self.strip.stop.is_on, "stop is on")

    def test_a_run_by_clicks(self) -> None:
        self.wait_phase("NOT CONNECTED")
        wait_until(lambda: self.panel.times.main.figure.text() == "10:00", "the time limit is shown")
        for command, phase in (("connect", "● CONNECTED"), ("start", "RUNNING"), ("stop", "ENDED"),
                               ("disconnect", "NOT CONNECTED")):
            click(self.strip.stop if command == "stop" else self.buttons[command])
            self.wait_phase(phase)
        self.assertEqual([call for call, _ in self.core.calls], ["connect", "start", "stop_run", "disconnect"])

    def test_phases_and_pauses(self) -> None:
        self.assertFalse(self.panel.rules.isVisible())
        rules = EventRules(pause=True, phases=(PhaseRule("Enter", 3600.0), PhaseRule("Leave")))
        zone, buttons = self.core.box.zones["Home A"], self.panel.rules.buttons
        zone.events = tuple(replace(e, benchmark=replace(e.benchmark, rules=rules)) for e in zone.events)
        for command in ("connect", "start"):
            click(self.buttons[command])
        label = self.panel.times.goal.label.text
        wait_until(lambda: label() == "Phase 1 of 2, Enter: time left", "the phase is shown")
        self.assertFalse(buttons["previous_phase"].isEnabled())
        click(buttons["next_phase"])
        wait_until(lambda: label() == "Phase 2 of 2, Leave: time used", "the next phase is shown")
        wait_until(lambda: buttons["next_phase"].why_off == "This is the last phase", "there are no more phases")
        click(buttons["pause"])
        wait_until(buttons["resume"].isVisible, "the clock can be resumed")
        self.assertFalse(buttons["pause"].isVisible())
        wait_until(lambda: "PAUSED" in self.panel.phase.text(), "the pause is shown")
        click(buttons["resume"])
        wait_until(buttons["pause"].isVisible, "the clock can be paused")
        click(buttons["previous_phase"])
        wait_until(lambda: label() == "Phase 1 of 2, Enter: time left", "the phase before is shown")

    def test_a_run_without_a_robot_and_a_team_that_does_not_appear(self) -> None:
        actions = self.panel.more.actions_of
        wait_until(actions["open_sheet"].isEnabled, "a sheet can be opened")
        actions["open_sheet"].trigger()
        self.wait_phase("● CONNECTED")
        wait_until(lambda: not actions["open_sheet"].isEnabled(), "no other sheet can be opened")
        for command, phase in (("start", "RUNNING"), ("stop", "ENDED"), ("disconnect", "NOT CONNECTED")):
            click(self.strip.stop if command == "stop" else self.buttons[command])
            self.wait_phase(phase)
        wait_until(actions["no_show"].isEnabled, "a no-show is possible")
        actions["no_show"].trigger()
        answer(question(), QMessageBox.RejectRole)
        actions["no_show"].trigger()
        answer(question(), QMessageBox.AcceptRole)
        self.wait_call("no_show", "Home A", "TestingTeam")
        self.wait_answered()
        ends = [record.end_reason for record in self.core.box.finished.records()]
        self.assertEqual(ends, ["no_show", "stopped"])

    def test_a_question_that_outlives_its_zone_is_answered_in_vain(self) -> None:
        actions = self.panel.more.actions_of
        wait_until(actions["no_show"].isEnabled, "a no-show is possible")
        actions["no_show"].trigger()
        asked = question()
        self.core.close()
        self.core = FakeCore(("Elsewhere",), box_uuid="another")
        self.wait_phase("NO SUCH ZONE")
        answer(asked, QMessageBox.AcceptRole)
        self.assertIn("Not done: Home A", self.panel.answer.text())
        self.assertEqual(self.core.calls, [])

    def test_whatever_begins_a_run_asks_at_an_event_that_is_signed_off(self) -> None:
        for command in ("connect", "start", "stop", "disconnect"):
            self.zone.command(command)
        record = next(iter(self.core.box.finished.records()))
        self.core.event(self.core.box.scores.sign_off, RunName("Home A", record.identity), "Cleo")
        wait_until(lambda: not self.buttons["connect"].styleSheet(), "it does not stand out")
        menu = self.panel.more
        presses = (lambda: click(self.buttons["connect"]), menu.robots[1].trigger,
                   menu.actions_of["open_sheet"].trigger, menu.actions_of["no_show"].trigger)
        for press in presses:
            press()
            self.assertTrue(question().informativeText().startswith("This event is signed off"))
            answer(question(), QMessageBox.RejectRole)
        click(self.buttons["connect"])
        answer(question(), QMessageBox.AcceptRole)
        self.wait_phase("● CONNECTED")
        self.assertEqual(self.core.calls, [("connect", "Home A")])

    def test_one_of_several_robots_connects(self) -> None:
        wait_until(lambda: len(self.panel.more.robots) == 2, "both robots are listed")
        robot = self.client.model.zone.robots_to_choose[1]
        self.panel.more.robots[1].trigger()
        wait_until(lambda: self.client.model.zone.robot_name == robot, "this robot is connected")
        wait_until(lambda: not self.panel.more.robots, "there is no choice any more")

    def test_next_and_previous(self) -> None:
        click(self.buttons["next"])
        wait_until(lambda: "HWV" in self.panel.event_labels["name"].text(), "the next event is shown")
        self.assertEqual(self.panel.event_labels["team"].text(), "AnotherTeam")
        click(self.buttons["previous"])
        wait_until(lambda: "HGTKMH" in self.panel.event_labels["name"].text(), "the first event is shown again")

    def test_each_reason_why_a_button_is_off_is_its_tooltip(self) -> None:
        self.zone.extra_off = {"connect": ["The robot sleeps", "The referee sleeps <b>too</b>"]}
        tip = self.buttons["connect"].toolTip
        wait_until(lambda: "sleeps" in tip(), "the reasons are shown")
        self.assertEqual(tip(), "<p>• The robot sleeps<br>• The referee sleeps &lt;b&gt;too&lt;/b&gt;</p>")
        self.assertFalse(self.buttons["connect"].isEnabled())
        start_off = "No run is connected: press connect first"
        wait_until(lambda: self.buttons["start"].why_off == start_off, "start's reason is shown")

    def test_warnings_of_the_box_are_shown_to_every_referee(self) -> None:
        self.core.box_warnings = ["ANOTHER RSBB <here>"]
        self.zone.warnings = ["No message from the robot for 4 s"]
        text = self.panel.state.toPlainText
        wait_until(lambda: "⚠ ANOTHER RSBB <here>" in text() and "⚠ No message" in text(), "both warnings are shown")
        self.assertLess(text().index("No message"), text().index("ANOTHER"), "the zone's own come first")

    def test_a_refused_command_says_why_and_may_be_given_again(self) -> None:
        self.core.refuse = "The robot has just left"
        click(self.buttons["connect"])
        wait_until(lambda: "The robot has just left" in self.panel.answer.text(), "the reason is shown")
        self.assertIn("Connect in Home A failed", self.panel.answer.text())
        self.core.refuse = None
        click(self.buttons["connect"])
        self.wait_phase("● CONNECTED")

    def test_a_core_that_does_not_answer_blocks_nothing(self) -> None:
        self.core.answer_gate.clear()
        limit(self, calls, "TIMEOUT_S", 1.0)
        click(self.buttons["connect"])
        self.wait_heard()
        wait_until(lambda: "no answer within 1 s" in self.panel.answer.text(), "the referee is warned")

    def test_a_failed_stop_is_forgotten_when_the_run_has_stopped_after_all(self) -> None:
        self.run_zones()
        self.core.refuse = "The core cannot stop it now"
        click(self.strip.stop)
        wait_until(lambda: "The core cannot stop it now" in self.strip.way.whole, "the failure is shown")
        self.core.refuse = None
        self.zone.command("stop")
        self.wait_phase("ENDED")
        wait_until(lambda: "the robot has stopped" in self.strip.way.whole, "the failure is no longer shown")

    def test_a_double_click_on_stop_stops_and_does_not_leave(self) -> None:
        self.run_zones()
        for _ in range(2):
            QTest.mouseClick(self.strip.stop, Qt.LeftButton)
        self.wait_phase("ENDED")
        wait_until(lambda: not self.strip.stop.is_on(), "stop is off")
        self.wait_answered()
        self.assertEqual(set(self.core.calls), {("stop_run", "Home A")})

    def test_a_stop_in_the_moment_in_which_the_run_ends_does_not_leave_it(self) -> None:
        self.run_zones()
        self.hush()
        self.zone.end("completed")
        click(self.strip.stop)
        self.core.silent = False
        self.wait_call("stop_run", "Home A")
        self.wait_answered()
        self.wait_phase("ENDED")

    def test_start_asks_only_after_a_run_that_nobody_stopped(self) -> None:
        self.run_zones()
        self.zone.command("stop")
        self.wait_phase("ENDED")
        click(self.buttons["start"])
        self.wait_phase("RUNNING")
        self.zone.end("completed")
        self.wait_phase("ENDED")
        for role in (QMessageBox.RejectRole, QMessageBox.AcceptRole):
            self.core.calls.clear()
            click(self.buttons["start"])
            self.assertEqual(question().text(), "The run is over. Start it again?")
            self.assertIn("START would continue the run", question().informativeText())
            answer(question(), role)
        self.wait_phase("RUNNING")
        self.assertEqual(self.core.calls, [("start", "Home A")])

    def test_disconnect_asks_while_the_run_is_in_progress(self) -> None:
        self.run_zones()
        click(self.buttons["disconnect"])
        answer(question(), QMessageBox.RejectRole)
        click(self.buttons["disconnect"])
        answer(question(), QMessageBox.AcceptRole)
        self.wait_phase("NOT CONNECTED")
        self.assertEqual(self.core.calls, [("disconnect", "Home A")])

    def test_disconnect_and_withdrawal_ask_while_the_robot_has_not_stopped(self) -> None:
        self.zone.not_stopped = ["<b>mbot</b> of team A"]
        self.run_zones()
        self.zone.command("stop")
        self.wait_phase("ENDED")
        self.assertEqual(self.buttons["disconnect"].styleSheet(), "", "it does not stand out")
        warning = ("<b>mbot</b> of team A did not answer STOP. After the disconnect the box does not repeat it: stop "
                   "by hand first")
        click(self.buttons["disconnect"])
        box = question()
        self.assertEqual((box.text(), box.informativeText()), ("The robot has not stopped. Disconnect?", warning))
        self.assertEqual({label.textFormat() for label in box.findChildren(QLabel) if label.text()}, {Qt.PlainText})
        answer(box, QMessageBox.RejectRole)
        self.panel.more.actions_of["withdrawn"].trigger()
        self.assertTrue(question().informativeText().startswith(f"{warning}\n\nDid team"))
        answer(question(), QMessageBox.RejectRole)
        self.assertEqual(self.core.calls, [])
        self.zone.not_stopped = []
        wait_until(lambda: self.buttons["disconnect"].styleSheet(), "it stands out")
        click(self.buttons["disconnect"])
        self.wait_call("disconnect", "Home A")

    def test_the_question_of_disconnect_stays_true(self) -> None:
        limit(self, basic, "HOLD_MS", 3_600_000)
        self.run_zones()
        click(self.buttons["disconnect"])
        box = question()
        accept = next(one for one in box.buttons() if box.buttonRole(one) == QMessageBox.AcceptRole)
        box.setInformativeText("")  # as of a question without details
        self.assertEqual(box.text(), "The run is in progress. Disconnect?")
        self.zone.not_stopped = ["mbot"]
        self.zone.command("stop")
        wait_until(lambda: box.text() == "The robot has not stopped. Disconnect?", "it says so")
        self.assertEqual({label.textFormat() for label in box.findChildren(QLabel) if label.text()}, {Qt.PlainText})
        self.assertFalse(accept.isEnabled(), "nobody has read it")
        limit(self, basic, "HOLD_MS", 0)
        self.zone.not_stopped = []
        wait_until(lambda: (box.text(), box.informativeText()) == ("The run is over. Disconnect?", ""), "it says so")
        wait_until(accept.isEnabled, "it can be confirmed again")
        answer(box, QMessageBox.AcceptRole)
        self.wait_call("disconnect", "Home A")
        self.wait_heard()

    # -- keys -----------------------------------------------------------------------------------------

    def press(self, key: int) -> None:
        QTest.keyClick(self.panel.windowHandle(), key)
        pressed = time.monotonic()
        wait_until(lambda: time.monotonic() - pressed > 0.15, "the key has stopped bouncing")

    def test_a_key_pressed_twice_starts(self) -> None:
        self.zone.command("connect")
        wait_until(self.buttons["start"].isEnabled, "start is on")
        self.press(Qt.Key_F5)
        self.assertIn("Press F5 again", self.panel.answer.text())
        self.press(Qt.Key_F5)
        self.wait_phase("RUNNING")

    def test_a_second_press_after_the_zone_changed_stops_nothing(self) -> None:
        self.run_zones("Home A", "Home B")
        self.press(Qt.Key_Escape)
        self.client.model.choose_zone("Home B")
        self.press(Qt.Key_Escape)
        self.assertEqual(self.core.calls, [])
        self.press(Qt.Key_Escape)
        self.wait_call("stop_run", "Home B")

    def test_a_key_whose_button_is_off_says_why(self) -> None:
        self.press(Qt.Key_F5)
        self.assertIn("press connect first", self.panel.answer.text())
        self.assertEqual(self.core.calls, [])

    # -- zones ----------------------------------------------------------------------------------------

    def test_the_zone_chosen_here_is_the_clients_zone(self) -> None:
        box = self.panel.zones
        box.setCurrentIndex(box.findText("Home B"))
        box.activated.emit(box.currentIndex())
        self.assertEqual(self.client.model.zone_name, "Home B")
        wait_until(lambda: rospy.get_param("current_zone") == "Home B", "other processes of the client see it")

    def test_the_clients_parameter_is_followed(self) -> None:
        rospy.set_param("current_zone", "Home B")
        wait_until(lambda: self.panel.zones.currentText() == "Home B", "the panel shows the zone")
        click(self.buttons["connect"])
        self.wait_call("connect", "Home B")

    def test_without_a_choice_the_first_zone_is_shown(self) -> None:
        wait_until(lambda: self.client.node.zone.value == "Home A", "the parameter is read")
        rospy.set_param("current_zone", "")
        wait_until(lambda: self.client.node.zone.value == "", "the parameter is read")
        self.assertEqual(self.client.model.zone_name, "Home A")

    def test_a_zone_that_there_is_not_is_not_replaced_by_another(self) -> None:
        rospy.set_param("current_zone", "Nowhere")
        self.wait_phase("NO SUCH ZONE")
        self.assertFalse(any(b.isEnabled() for b in self.buttons.values()))
        self.assertIn("Nowhere", self.panel.state.toPlainText())

    # -- a silent core --------------------------------------------------------------------------------

    def test_a_silent_core_is_seen_at_once_and_forgotten_when_it_is_back(self) -> None:
        self.run_zones()
        self.fall_silent()
        wait_until(lambda: "OLD" in self.panel.news.text(), "it is marked as old")
        self.assertTrue(self.panel.times.main.figure.text().startswith("("))
        wait_until(lambda: not any(button.isEnabled() for button in self.buttons.values()), "all buttons are off")
        self.assertTrue(self.strip.stop.is_on())  # it may still get through
        self.assertIn("silent", self.buttons["disconnect"].why_off)
        self.core.silent = False
        time_left = self.panel.times.main.figure
        wait_until(lambda: "live" in self.panel.news.text() and not time_left.text().startswith("("), "it is live")

    def test_a_superseded_box_does_not_look_live(self) -> None:
        self.run_zones()
        self.core.superseded_by = "10.0.0.3"
        wait_until(lambda: "superseded" in self.panel.news.text(), "it is marked")
        self.assertTrue(self.panel.times.main.figure.text().startswith("("))
        self.assertIn("Another box has taken over", self.buttons["disconnect"].why_off)
        self.core.superseded_by, self.core.box_uuid = "", "another"
        wait_until(lambda: self.panel.news.text() == "● live", "another box is shown")

    def test_a_call_without_answer_names_what_to_check(self) -> None:
        for raised in ("service [/core/stop] unavailable", "unable to connect to service: [Errno 104] Connection reset",
                       "transport error completing service call: unable to receive data from sender"):
            with self.subTest(raised):
                self.assertIn("is the box running?", failure_text(raised))
                self.assertIn(raised, failure_text(raised))

    def test_nothing_moves_under_the_referees_hand(self) -> None:
        places = set()

        def look() -> None:
            settle(self.panel)
            places.add(tuple(str(self.buttons[name].geometry()) for name in ("start", "connect", "disconnect")))

        self.zone.robot = "a robot with a long name " * 3
        self.panel.resize(1, 1)  # as small as it can be: then anything that needs more room makes it grow
        look()
        for command, phase in (("connect", "● CONNECTED"), ("start", "RUNNING")):
            self.zone.command(command)
            self.wait_phase(phase)
            look()
        self.zone.end("no_messages_saved")
        self.wait_phase("ENDED")
        look()
        self.zone.warnings = [f"Warning {n}, which is somewhat longer than a line of the panel is" for n in range(9)]
        self.core.refuse = "for many good reasons; " * 10
        click(self.buttons["start"])
        wait_until(lambda: "good reasons" in self.panel.answer.text(), "the refusal is shown")
        wait_until(lambda: "Warning 8" in self.panel.state.toPlainText(), "the warnings are shown")
        look()
        self.fall_silent()
        wait_until(lambda: "OLD" in self.panel.news.text(), "it is marked as old")
        look()
        self.assertEqual(len(places), 1, places)


class TestScoring(PanelCase):
    PANEL = ScoringPanel

    def setUp(self) -> None:
        super().setUp()
        self.zone.command("connect")
        wait_until(lambda: self.panel.rows, "the sheet is shown")

    @property
    def bumps(self):
        return self.panel.rows[BUMPS]

    def test_marking_items(self) -> None:
        click(self.panel.rows[DOOR].toggle)
        self.wait_call("score", "Home A", *DOOR, 1)
        wait_until(lambda: self.panel.rows[DOOR].toggle.text() == "✔ Yes", "it is marked")
        click(self.panel.rows[DOOR].toggle)
        self.wait_call("score", "Home A", *DOOR, 0)
        click(self.bumps.more)
        self.wait_call("score", "Home A", *BUMPS, "+1")
        click(self.bumps.less)
        self.wait_call("score", "Home A", *BUMPS, "-1")
        wait_until(lambda: self.bumps.number.text() == "0", "it is counted")
        self.assertFalse(self.bumps.less.isEnabled())

    def test_quick_clicks_arrive_in_order(self) -> None:
        self.core.answer_gate.clear()
        for _ in range(5):
            click(self.bumps.more)
        self.assertEqual(self.bumps.number.text(), "5 …")
        wait_until(lambda: self.core.calls, "the first call is made")
        self.core.answer_gate.set()
        wait_until(lambda: self.zone.scores.get(BUMPS) == 5, "the last value is set")
        wait_until(lambda: self.bumps.number.text() == "5", "it is confirmed")
        self.assertEqual([call[-1] for call in self.core.calls], ["+1", "+4"])

    def test_what_another_referee_counts_at_the_same_time_is_not_lost(self) -> None:
        self.core.answer_gate.clear()
        for _ in range(3):
            click(self.bumps.more)
        wait_until(lambda: self.core.calls, "the first call is made")
        self.zone.mark(Mark(*BUMPS, added="2"), "Ben")
        self.core.answer_gate.set()
        wait_until(lambda: self.bumps.number.text() == "5", "all counts are shown")
        self.assertEqual(self.zone.scores, {BUMPS: 5})
        (first, *_, last) = self.zone.book.sheet.history
        self.assertEqual((first.who, last.role), ("Ben", "referee"))
        self.assertEqual(len(self.zone.book.sheet.marks.entries), 2, "each mark has its own identity")

    def test_counts_for_one_run_never_go_into_the_next(self) -> None:
        self.core.answer_gate.clear()
        for _ in range(2):
            click(self.bumps.more)
        wait_until(lambda: self.core.calls, "the first call is made")
        self.zone.command("disconnect", "connect")
        wait_until(lambda: self.panel._sheet[1] == self.zone.identity, "the sheet of the next run is shown")
        self.core.answer_gate.set()
        self.wait_answered()
        self.assertEqual((len(self.core.calls), self.zone.scores), (1, {}))

    def test_a_failed_call_is_shown_and_the_item_goes_back(self) -> None:
        self.core.refuse = "The run is over"
        click(self.panel.rows[DOOR].toggle)
        wait_until(lambda: "The run is over" in self.panel.answer.text(), "the failure is shown")
        wait_until(lambda: self.panel.rows[DOOR].toggle.text() == "No", "the item goes back")

    def test_an_answer_after_the_zone_changed_touches_no_other_sheet(self) -> None:
        self.core.zones["Home B"].command("connect")
        self.core.answer_gate.clear()
        click(self.bumps.more)
        wait_until(lambda: self.core.calls, "the call is made")
        self.client.model.choose_zone("Home B")
        wait_until(lambda: "Home B" in self.panel._where.text() and self.panel.rows, "the other sheet is shown")
        self.core.answer_gate.set()
        wait_until(lambda: self.zone.scores.get(BUMPS) == 1, "the core has set it in the first zone")
        self.wait_answered()
        wait_until(lambda: self.bumps.more.isEnabled(), "the other sheet may be marked")
        self.assertEqual(self.bumps.number.text(), "0")
        self.assertEqual(self.core.zones["Home B"].scores, {})

    def test_without_a_run_there_is_no_sheet(self) -> None:
        self.zone.command("disconnect")
        wait_until(lambda: not self.panel.rows and "connected" in self.panel._nothing.text(), "there is no sheet")

    def test_nothing_can_be_marked_while_the_core_is_silent(self) -> None:
        self.fall_silent()
        wait_until(lambda: not self.bumps.more.isEnabled() and "OLD" in self.panel.news.text(), "it cannot be marked")
        self.core.silent = False
        wait_until(self.bumps.more.isEnabled, "it can be marked again")
