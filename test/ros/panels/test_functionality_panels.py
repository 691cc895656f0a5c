"""Manual Operation, OMF Switches and a module's score, clicked on, with a fake core."""

from typing import Any
from unittest import mock

from support.fakes.core import Asked
from support.gui_testing import Qt, QTest, click, wait_until
from support.panel_case import PanelCase

from helpers.forms import ODD, ODD_ASKED
from roah_rsbb.model.records import ScoreValue
from roah_rsbb.rqt import basic
from roah_rsbb.rqt.panels import operations
from roah_rsbb.rqt.panels.operations import NO_SWITCHES, ManualOperationPanel, OmfSwitchesPanel
from roah_rsbb.rqt.panels.scoring import ScoringPanel
from roah_rsbb.rqt.qt import QLabel


class TestManualOperation(PanelCase):
    PANEL = ManualOperationPanel

    def setUp(self) -> None:
        super().setUp()
        self.zone.command("connect")
        self.zone.command("start")

    def ask(self, *asked: object) -> None:
        self.zone.asked = Asked(*asked)
        wait_until(lambda: self.panel.text.text() == asked[1] and (self.panel._request or (0, 0, 0))[2] == asked[0],
                   "the request is shown")

    def editor(self, name: str) -> Any:
        return self.panel.form.editors[name]

    def test_without_a_request_there_is_nothing_to_do(self) -> None:
        wait_until(lambda: self.panel.text.text() == operations.NOTHING, "nothing is to be done")
        self.assertFalse(self.panel.buttons[0].isEnabled())
        self.assertFalse(self.panel.form.isVisible())

    def test_a_request_is_completed_by_a_click(self) -> None:
        self.ask(3, "Place the <b>mug</b> on the table")
        click(self.panel.buttons[0])
        self.wait_call("operation", "Home A", 3, "")
        wait_until(lambda: self.panel.text.text() == operations.NOTHING, "it is gone")

    def test_a_new_request_flashes_and_then_stays_marked(self) -> None:
        self.ask(1, "Place it")
        styles = set()
        wait_until(lambda: styles.add(self.panel.text.styleSheet()) or len(styles) >= 2, "it flashes")
        wait_until(lambda: not self.panel._flash.isActive(), "it stops flashing")
        self.assertIn("background", self.panel.text.styleSheet())
        self.assertTrue(self.panel.text.font().bold(), "its colours leave its size as it was")
        self.ask(2, "Place it")
        wait_until(self.panel._flash.isActive, "the same words again are another request")

    def test_a_click_meant_for_the_request_before_does_not_answer_the_next(self) -> None:
        self.ask(1, "first")
        wait_until(self.panel.buttons[0].isEnabled, "it can be completed")
        with mock.patch.object(basic, "HOLD_MS", 3600_000):  # the test may be slow
            self.ask(2, "second")
        self.assertFalse(self.panel.buttons[0].isEnabled())
        self.panel.buttons[0].let_go()
        click(self.panel.buttons[0])
        self.wait_call("operation", "Home A", 2, "")

    def test_each_choice_is_a_button(self) -> None:
        self.ask(4, "No pose of the robot", ("try again", "skip"))
        self.assertEqual([button.text() for button in self.panel.buttons], ["try again", "skip"])
        click(self.panel.buttons[1])
        self.wait_call("operation", "Home A", 4, "skip")
        texts = [operations.COMPLETE]
        wait_until(lambda: [button.text() for button in self.panel.buttons] == texts, "the choices are gone")

    def test_an_answer_is_typed(self) -> None:
        self.ask(5, "Which person came?", (), True)
        wait_until(self.panel.form.isVisible, "there is a line to type in")
        QTest.keyClicks(self.editor("answer"), "the postman")
        wait_until(self.panel.buttons[0].isEnabled, "it can be completed")
        QTest.keyClick(self.editor("answer"), Qt.Key_Return)
        self.wait_call("operation", "Home A", 5, "the postman")

    def test_what_was_typed_for_one_request_is_not_the_next_ones_answer(self) -> None:
        self.ask(5, "Which person came?", (), True)
        QTest.keyClicks(self.editor("answer"), "the postman")
        self.ask(6, "And now?", (), True)
        wait_until(lambda: not self.editor("answer").text(), "the line is empty again")

    def test_the_form_of_a_module_that_nobody_knows_is_filled_in(self) -> None:
        self.ask(7, ODD_ASKED, (), False, ODD)
        wait_until(self.panel.form.isVisible, "the form is there")
        found = self.panel.form.findChildren(QLabel)
        self.assertEqual({label.textFormat() for label in found}, {Qt.PlainText})
        labels = [label.text() for label in found]
        self.assertLessEqual({str(field.label) for field in ODD}, set(labels))
        wait_until(self.panel.buttons[0].isEnabled, "it can be completed")
        click(self.panel.buttons[0])
        wait_until(lambda: "Pose of the cup" in self.panel.form.problem.text(), "what is missing is named")
        self.assertEqual(self.core.calls, [])
        self.editor("held").setChecked(True)
        self.editor("drops").setValue(2)
        self.editor("place").setCurrentText("floor")
        QTest.keyClicks(self.editor("pose"), "1,25 0.40 90")
        click(self.panel.buttons[0])
        wait_until(lambda: self.core.calls, "it is answered")
        (action, zone, number, *values), = self.core.calls
        self.assertEqual((action, zone, number, values[:3]), ("operation", "Home A", 7, [True, 2, "floor"]))
        self.assertEqual([round(part, 4) for part in values[3]], [1.25, 0.4, 1.5708])

    def test_a_failed_call_is_shown_and_may_be_given_again(self) -> None:
        self.core.refuse = "that manual operation is over"
        self.ask(7, "Place it")
        click(self.panel.buttons[0])
        wait_until(lambda: "that manual operation is over" in self.panel.answer.text(), "the failure is shown")
        self.core.refuse = None
        click(self.panel.buttons[0])
        wait_until(lambda: self.panel.text.text() == operations.NOTHING, "it is done")

    def test_a_double_click_answers_one_request_only(self) -> None:
        self.ask(8, "first")
        wait_until(self.panel.buttons[0].isEnabled, "it can be completed")
        for _ in range(2):
            QTest.mouseClick(self.panel.buttons[0], Qt.LeftButton)
        self.wait_call("operation", "Home A", 8, "")
        wait_until(lambda: self.panel.text.text() == operations.NOTHING, "it is gone")
        self.ask(9, "second")
        self.assertEqual(len(self.core.calls), 1)

    def test_a_silent_core_is_answered_nothing(self) -> None:
        self.ask(10, "Place it")
        self.fall_silent()
        wait_until(lambda: "silent" in self.panel.buttons[0].why_off, "it cannot be completed, and says why")
        self.assertEqual(self.panel.text.text(), "Place it")

    def test_another_zone_has_its_own(self) -> None:
        self.ask(11, "Place it")
        self.client.model.choose_zone("Home B")
        wait_until(lambda: self.panel.text.text() == operations.NOTHING, "that zone asks nothing")
        self.client.model.choose_zone("Home A")
        wait_until(lambda: self.panel.text.text() == "Place it", "the first one still asks")


class TestOmfSwitches(PanelCase):
    PANEL = OmfSwitchesPanel

    def test_only_homf_has_switches(self) -> None:
        wait_until(lambda: self.panel.hint.text() == NO_SWITCHES, "there are none")
        self.assertFalse(any(button.isEnabled() for button in self.panel.switches))

    def test_switches_damaged_and_confirmed(self) -> None:
        self.zone.switches = {1, 3}
        panel = self.panel
        wait_until(lambda: [b.text() for b in panel.switches[:2]] == ["1\nON", "2\noff"], "they are shown")
        click(panel.switches[1])
        self.wait_call("switch", "Home A", 2)
        wait_until(lambda: panel.switches[1].text() == "2\nON", "the change is shown")
        click(panel.more)
        self.wait_call("damaged", "Home A", 1)
        wait_until(lambda: panel.damaged.text() == "1", "it is counted")
        click(panel.less)
        self.wait_call("damaged", "Home A", 0)
        self.assertFalse(panel.complete.isEnabled())
        self.zone.switches_asked = True
        click(panel.complete)
        self.wait_call("confirm_switches", "Home A")

    def test_a_refusal_is_shown(self) -> None:
        self.zone.switches = set()
        self.core.refuse = "there is no switch 10"
        click(self.panel.switches[9])
        wait_until(lambda: "there is no switch 10" in self.panel.answer.text(), "the reason is shown")


class TestScoreValue(PanelCase):
    PANEL = ScoringPanel

    def test_the_modules_score_is_shown_as_it_grows(self) -> None:
        scores = self.panel.module_scores
        self.assertFalse(scores.isVisible())
        self.zone.command("connect")
        self.zone.module_scores = [ScoreValue("", "reached", "1", "", "Waypoints <reached>"),
                                   ScoreValue("waypoint 1", "distance_error", "0.12345", "m", "")]
        wait_until(scores.isVisible, "there is a score")
        text = scores.text.text()
        for part in ("Waypoints &lt;reached&gt;", "distance error", "0.123 m", "waypoint 1"):
            self.assertIn(part, text)
        self.zone.module_scores = [ScoreValue("", "reached", "2", "", "")]
        wait_until(lambda: "0.123" not in scores.text.text(), "it changes")
        self.zone.module_scores = []
        wait_until(lambda: not scores.isVisible(), "it goes with the run")
