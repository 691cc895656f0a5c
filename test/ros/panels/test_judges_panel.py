"""The head referee at the table: a run with two judges in the whole window, with a real mouse."""

import pathlib
from typing import List

from support.fakes.core import FakeCore
from support.gui_testing import QMessageBox, QTest, question, wait_until
from support.real_input import click_on
from support.window_case import WindowCase, in_sight, is_closed

from roah_rsbb.core.scoring.sheet import Mark
from roah_rsbb.model.referee import RunName
from roah_rsbb.model.scoring import JudgesRule, ScoreKind, ScoringItem
from roah_rsbb.rqt.widgets.judge_dialogs import ChoiceDialog, ObjectionDialog, PublishDialog, ReasonDialog, SettleDialog

OBJECTS = ScoringItem("Table", "Objects put away", ScoreKind.UINT)
EMPTY = ScoringItem("Table", "Table is empty", ScoreKind.BOOL)
SHOW = ScoringItem("Show", "Presentation", ScoreKind.DECIMAL)
SHOTS = pathlib.Path(__file__).resolve().parents[3] / "build" / "screenshots"


class TestJudgesPanel(WindowCase):
    """Two judges score each run."""

    def setUp(self) -> None:
        super().setUp()
        self.client.referee.set("Hugo")
        self.zone.command("connect", "start")
        self.name = RunName(self.ZONE, self.zone.identity)
        self.judges = self.panel("JudgesPanel")
        self.window.docks["JudgesPanel"].raise_()
        wait_until(self.judges.isVisible, "the panel is in front")

    def new_core(self) -> FakeCore:
        return FakeCore(self.ZONES, items=(OBJECTS, EMPTY, SHOW), judges=JudgesRule(2))

    def submit(self, judge: str, objects: int) -> None:
        """A judge fills in a sheet, and submits it."""
        desk = self.core.box.judges
        for number, (item, value) in enumerate(((OBJECTS, objects), (EMPTY, 1))):
            self.core.event(desk.mark, self.name, Mark(*item.key, value, id=f"{judge} {objects} {number}"), judge)
        self.core.event(desk.submit, self.name, judge)

    def rows(self) -> List[tuple]:
        """The items as they are shown."""
        return [tuple(text for text in texts if text) for texts in self.judges.items.texts()]

    def wait_progress(self, text: str) -> None:
        """Wait until the lines about the judges contain a text."""
        wait_until(lambda: text in self.judges.progress.toPlainText(),
                   lambda: f"'{text}' is shown; it is {self.judges.progress.toPlainText()}")

    def wait_answer(self, text: str) -> None:
        """Wait until the line with the result of the last command contains a text."""
        wait_until(lambda: text in self.judges._answer.text(),
                   lambda: f"'{text}' is answered; it is {self.judges._answer.text()}")

    def confirm(self, dialog, reason: str) -> None:
        """Type a reason, without which a dialog cannot be confirmed."""
        self.assertFalse(dialog.yes.isEnabled())
        click_on(dialog.note)
        QTest.keyClicks(dialog.note, reason)
        click_on(dialog.yes)
        wait_until(lambda: is_closed(dialog), "the dialog is closed")

    def shot(self, name: str) -> None:
        """Leave a screenshot to look at."""
        SHOTS.mkdir(parents=True, exist_ok=True)
        self.wait_quiet()
        self.window.grab().save(str(SHOTS / f"panel_judges_{name}.png"))

    def test_from_differences_to_the_final_result(self) -> None:
        panel = self.judges
        self.submit("Ann", 2)
        self.wait_progress("Sheets that are missing: 1 of 2")
        self.assertFalse(panel.settle.isEnabled())
        self.submit("Ben", 3)
        self.wait_progress("Items to settle: 1")
        wait_until(lambda: self.rows() == [
            ("Table", "Objects put away", "2", "3", "≠ differs"), ("Table is empty", "yes", "yes", "yes"),
            ("Show", "Presentation", "0", "0", "0"),
        ], lambda: f"the values are side by side: {self.rows()}")
        self.shot("differ")
        buttons = (panel.settle, panel.hand_back, panel.withdraw, panel.waive, panel.publish, panel.sign, panel.which)
        wait_until(lambda: all(map(in_sight, buttons)),
                   lambda: f"in sight: {[(one.width(), in_sight(one)) for one in buttons]}")
        click_on(panel.hand_back)
        dialog = self.dialog(ChoiceDialog)
        dialog.chosen.setCurrentIndex(1)
        self.confirm(dialog, "count once more")
        self.wait_progress("Ben: looks again (count once more)")
        wait_until(lambda: not panel.settle.isEnabled(), "nothing can be settled")
        self.submit("Ben", 4)
        click_on(panel.settle)
        dialog = self.dialog(SettleDialog)
        click_on(dialog.note)
        QTest.keyClicks(dialog.note, "the video")
        self.assertFalse(dialog.yes.isEnabled(), "no value is chosen yet")
        click_on(dialog.given[1])
        self.assertEqual(dialog.number.value(), 4)
        dialog.grab().save(str(SHOTS / "panel_judges_settle.png"))
        click_on(dialog.yes)
        wait_until(lambda: ("Table", "Objects put away", "2", "4", "4", "Settled by Hugo: the video") in self.rows(),
                   lambda: f"it is settled: {self.rows()}")
        self.assertIn("still connected", panel.publish.toolTip())
        self.zone.command("stop", "disconnect")
        # The overview and the log get their space back, and the buttons of this panel move.
        wait_until(lambda: not any(self.panel(name).is_collapsed for name in ("OverviewPanel", "LogDisplayPanel")),
                   "they are back")
        self.wait_quiet()
        self.publish("60 minutes")
        self.wait_progress("provisional · objections until")
        click_on(panel.tabs.tabBar(), panel.tabs.tabBar().tabRect(1).center())
        click_on(panel.object)
        dialog = self.dialog(ObjectionDialog)
        QTest.keyClicks(dialog.who, "Epsilon")
        self.confirm(dialog, "the cup was away")
        wait_until(lambda: panel.objections.texts()[0][2:4] == ("Epsilon", "the cup was away"), "it is listed")
        self.assertIn("⚠", panel.tabs.tabText(1))
        self.shot("objection")
        click_on(panel.reply)
        dialog = self.dialog(ChoiceDialog)
        dialog.chosen.setCurrentIndex(1)
        self.confirm(dialog, "it was there")
        wait_until(lambda: panel.objections.texts()[0][4] == "rejected: it was there", "it is answered")
        self.sign_off()
        self.wait_answer("objections are possible until")
        self.publish("None")
        self.wait_progress("the time for objections is over")
        self.sign_off()
        wait_until(lambda: panel.which.currentData() == "", "the run is final")
        self.assertEqual(self.core.box.scores.record_of(self.core._now(), self.name).sign_off.who.split(" ")[0], "Hugo")

    def publish(self, limit: str) -> None:
        """Publish the result with this time for objections."""
        click_on(self.judges.publish)
        dialog = self.dialog(PublishDialog)
        dialog.chosen.setCurrentText(limit)
        click_on(dialog.yes)
        wait_until(lambda: is_closed(dialog), "the dialog is closed")

    def sign_off(self) -> None:
        """Sign the run off."""
        click_on(self.judges.sign)
        box = question()
        click_on(next(b for b in box.buttons() if box.buttonRole(b) == QMessageBox.AcceptRole))
        wait_until(lambda: is_closed(box), "the question is gone")

    def test_a_judge_who_leaves(self) -> None:
        panel = self.judges
        self.submit("Ann", 2)
        self.core.event(self.core.box.judges.mark, self.name, Mark(*EMPTY.key, 1, id="b1"), "Ben")
        self.wait_progress("Ben: is judging")
        click_on(panel.withdraw)
        dialog = self.dialog(ChoiceDialog)
        dialog.chosen.setCurrentIndex(1)
        self.confirm(dialog, "left the hall")
        wait_until(lambda: "Ben" not in panel.progress.toPlainText(), "the sheet is withdrawn")
        click_on(panel.waive)
        self.confirm(self.dialog(ReasonDialog), "nobody else is here")
        self.wait_progress("Missing judges are not waited for: nobody else is here")
        wait_until(lambda: self.rows()[0] == ("Table", "Objects put away", "2", "2"), "Ann's values count")
        self.assertIn("No judge is waited for", panel.waive.toolTip())
        self.client.referee.set("")
        wait_until(lambda: "Enter your name" in panel.withdraw.toolTip(), "a decision needs a name")
