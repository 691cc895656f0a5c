"""Results, histories, notes and reasons, clicked on and typed, with a fake core: real messages, real services."""

import unittest
from types import SimpleNamespace
from typing import Callable, List

from support.fakes.core import NOT_ATTEMPTED
from support.gui_testing import (
    QApplication,
    QMessageBox,
    Qt,
    QTest,
    QWidget,
    answer,
    click,
    limit,
    question,
    wait_until,
)
from support.panel_case import BUMPS, DOOR, PanelCase

from roah_rsbb.core.scoring.sheet import Mark
from roah_rsbb.document.written import write
from roah_rsbb.model.referee import RunName
from roah_rsbb.model.results import RunLine, RunSheet, UnsavedParts
from roah_rsbb.rqt.model.calls import CallOutcome
from roah_rsbb.rqt.model.fetched import run_sheets
from roah_rsbb.rqt.panels import benchmark_control, scoring
from roah_rsbb.rqt.panels.history import HistoryDialog
from roah_rsbb.rqt.panels.results import ResultsPanel
from roah_rsbb.rqt.widgets.score_dialogs import NoteDialog, ScoreDialog


def opened(kind: type):
    """The dialog of that kind that is open."""
    found = []

    def is_open() -> bool:
        found[:] = [w for w in QApplication.topLevelWidgets() if type(w) is kind and w.isVisible()]
        return bool(found)

    wait_until(is_open, f"a {kind.__name__} is open")
    return found[0]


class TestFetched(unittest.TestCase):
    def test_an_answer_that_was_overtaken_is_ignored(self) -> None:
        done: List[Callable[[CallOutcome], None]] = []
        owner = QWidget()
        self.addCleanup(owner.close)
        sheets = run_sheets(owner, SimpleNamespace(call=lambda _owner, _name, then, **run: done.append(then)),
                            lambda: None)
        runs = [RunLine("a run", revision, "Home A", "HGTKMH", "Team", 1, 1, 0.0) for revision in (1, 2)]
        for run in runs:
            self.assertIsNone(sheets.newest(run))
        for number in (1, 0):
            done[number](CallOutcome("", write(RunSheet(runs[number], (), 0.0, (), (), ()))))
            self.assertEqual(sheets.newest(runs[1]).run, runs[1])


class WordsCase(PanelCase):
    """The first zone has a run in progress."""

    def setUp(self) -> None:
        super().setUp()
        self.client.referee.set("Anna")
        self.zone.command("connect")
        self.zone.command("start")

    def wait_words(self, *words: object) -> None:
        wait_until(lambda: words in self.core.words, f"{words} is said; there were {self.core.words}")

    def leave(self) -> str:
        """Stop and leave the run; returns its identity."""
        identity = self.zone.identity
        self.zone.command("stop", "disconnect")
        return identity


class TestScoringWithWords(WordsCase):
    PANEL = scoring.ScoringPanel

    def setUp(self) -> None:
        super().setUp()
        model = self.client.model
        wait_until(lambda: self.panel.rows and model.identity_of(model.zone_name), "the sheet is shown")
        self.bumps, self.door = self.panel.rows[BUMPS], self.panel.rows[DOOR]

    def test_not_attempted_and_back(self) -> None:
        self.bumps.not_attempted.trigger()
        self.wait_call("score", "Home A", *BUMPS, NOT_ATTEMPTED)
        wait_until(lambda: self.bumps.number.text() == "n/a", "it is shown")
        self.assertTrue(self.bumps.not_attempted.isChecked())
        self.assertFalse(self.bumps.less.isEnabled())
        click(self.bumps.more)
        self.wait_call("score", "Home A", *BUMPS, "+1")
        wait_until(lambda: self.bumps.number.text() == "1", "a value takes the mark away")
        self.assertFalse(self.bumps.not_attempted.isChecked())
        self.door.not_attempted.trigger()
        wait_until(lambda: self.door.toggle.text() == "Not attempted", "it is shown")
        click(self.door.toggle)
        wait_until(lambda: self.door.toggle.text() == "✔ Yes", "a value takes the mark away")
        self.door.not_attempted.trigger()
        wait_until(lambda: self.door.toggle.text() == "Not attempted", "it is shown again")
        self.door.not_attempted.trigger()
        wait_until(lambda: self.door.toggle.text() == "No", "the mark is taken away by itself, too")
        self.assertEqual(self.core.calls[-1], ("score", "Home A", *DOOR, 0))

    def test_a_score_names_the_run_and_the_referee(self) -> None:
        click(self.bumps.more)
        self.wait_words(self.zone.identity, "", "Anna")

    def test_another_referees_mark_is_shown(self) -> None:
        self.zone.mark(Mark(*BUMPS, not_attempted=True), "Ben")
        wait_until(lambda: self.bumps.number.text() == "n/a", "it is shown")

    def test_a_note(self) -> None:
        self.bumps.with_note.trigger()
        dialog = opened(ScoreDialog)
        dialog.number.setValue(3)
        QTest.keyClicks(dialog.note, "the vase, twice")
        click(dialog.yes)
        self.wait_call("score", "Home A", *BUMPS, "+3")
        self.wait_words(self.zone.identity, "the vase, twice", "Anna")
        self.door.with_note.trigger()
        dialog = opened(ScoreDialog)
        dialog.not_attempted.setChecked(True)
        self.assertFalse(dialog.tick.isEnabled())
        click(dialog.yes)
        self.wait_call("score", "Home A", *DOOR, NOT_ATTEMPTED)
        self.door.with_note.trigger()
        click(opened(ScoreDialog).cancel)
        self.assertEqual(len(self.core.calls), 2)

    def test_the_history_and_a_withdrawal(self) -> None:
        self.zone.mark(Mark(*BUMPS, 1), "Ben")
        self.zone.mark(Mark(*BUMPS, 2, note="again"), "Cleo")
        click(self.panel.history)
        dialog = opened(HistoryDialog)
        rows, withdraw = dialog.history.rows, dialog.history.withdraw
        wait_until(lambda: len(rows.texts()) == 2, "the entries are shown")
        self.assertEqual([(n, who, change, notes) for n, _, who, _, change, notes in rows.texts()],
                         [("2", "Cleo", "1 → 2", "again"), ("1", "Ben", "0 → 1", "")])
        self.assertFalse(withdraw.isEnabled())
        rows.choose(2)
        click(withdraw)
        question = opened(NoteDialog)
        QTest.keyClicks(question.note, "another robot")
        click(question.yes)
        self.wait_call("withdraw", "Home A", 2)
        self.wait_words(self.zone.identity, "another robot", "Anna")
        wait_until(lambda: "withdrawn" in rows.texts()[0][-1], "it is marked")
        self.assertRegex(rows.texts()[0][-1], r"withdrawn by Anna at \d\d:\d\d:\d\d: another robot$")
        self.assertEqual([rows.item(0, column).font().strikeOut() for column in (3, 5)], [True, False])
        wait_until(lambda: not withdraw.isEnabled(), "once is enough")
        wait_until(lambda: self.bumps.number.text() == "1", "the entry before counts")
        dialog.close()

    def test_an_entry_that_is_not_saved_is_marked(self) -> None:
        self.zone.mark(Mark(*BUMPS, 1), "Ben")
        self.zone.mark(Mark(*BUMPS, 2), "Cleo")
        click(self.panel.history)
        dialog = opened(HistoryDialog)
        rows = dialog.history.rows
        self.core.unsaved = (UnsavedParts(self.zone.identity, "Home A", (2,)),)
        wait_until(lambda: [row[-1] for row in rows.texts()] == ["⚠ not saved yet", ""], "only the newer one is marked")
        self.core.unsaved = ()
        wait_until(lambda: [row[-1] for row in rows.texts()] == ["", ""], "it is saved")
        dialog.close()


class TestStopReason(WordsCase):
    PANEL = benchmark_control.BenchmarkControlPanel

    def test_it_is_typed_after_the_stop(self) -> None:
        line, identity = self.panel.reason, self.zone.identity
        wait_until(lambda: "RUNNING" in self.panel._phase.text(), "the run is shown")
        self.assertFalse(line.isEnabled())
        click(self.strip.stop)
        wait_until(line.isEnabled, "a reason may be typed")
        QTest.keyClicks(line, "fire alarm")
        QTest.keyClick(line, Qt.Key_Return)
        self.wait_words(identity, "fire alarm", "Anna")
        wait_until(lambda: self.zone.run.book.state.stops[0].reason == "fire alarm", "it is saved")
        wait_until(lambda: line.text() == "fire alarm", "it stays")
        QTest.keyClicks(line, " in the kitchen")
        QTest.keyClick(line, Qt.Key_Return)
        self.wait_words(identity, "fire alarm in the kitchen", "Anna")
        wait_until(lambda: line.text() == "fire alarm in the kitchen", "the longer one stays")

    def test_a_sheet_from_before_does_not_take_the_text_away(self) -> None:
        line = self.panel.reason
        self.zone.command("stop")
        wait_until(line.isEnabled, "a reason may be typed")
        known = line._sheets.newest
        wait_until(lambda: known(line._summary) is not None and known(line._summary).ends, "the sheet is known")
        before = known(line._summary)
        before = before._replace(run=before.run._replace(revision=before.run.revision + 1))
        limit(self, line._sheets, "newest", lambda summary: before)
        QTest.keyClicks(line, "fire alarm")
        QTest.keyClick(line, Qt.Key_Return)
        self.wait_words(self.zone.identity, "fire alarm", "Anna")
        self.wait_heard()
        self.assertEqual(line.text(), "fire alarm")

    def test_it_stays_visible_and_editable_until_the_sign_off(self) -> None:
        line, identity = self.panel.reason, self.zone.identity
        self.zone.command("stop")
        scores = self.core.box.scores
        self.core.event(scores.give_stop_reason, RunName("Home A"), "fire alarm", "Ben")  # by another client
        wait_until(lambda: line.text() == "fire alarm", "it is shown")
        self.zone.command("disconnect")
        wait_until(lambda: "NOT CONNECTED" in self.panel._phase.text(), "the run is left")
        wait_until(line.isEnabled, "it can be changed")
        self.assertEqual(line.text(), "fire alarm")
        self.core.event(scores.sign_off, RunName("Home A", identity), "Cleo")
        wait_until(lambda: not line.isEnabled(), "it is final")
        self.assertEqual(line.text(), "fire alarm")
        self.assertIn("signed off by Cleo", line.toolTip())

    def test_it_is_of_the_run_that_was_stopped_also_after_it_is_left(self) -> None:
        line, identity = self.panel.reason, self.zone.identity
        self.zone.command("stop")
        wait_until(line.isEnabled, "a reason may be typed")
        QTest.keyClicks(line, "the door ")
        self.zone.command("disconnect")
        wait_until(lambda: "NOT CONNECTED" in self.panel._phase.text(), "the run is left")
        QTest.keyClicks(line, "was locked")
        QTest.keyClick(line, Qt.Key_Return)
        self.wait_words(identity, "the door was locked", "Anna")
        QTest.keyClicks(line, " twice")
        self.zone.command("connect")
        self.wait_words(identity, "the door was locked twice", "Anna")
        wait_until(lambda: not line.isEnabled() and not line.text(), "another run begins")

    def test_a_refusal_keeps_what_was_typed(self) -> None:
        line = self.panel.reason
        self.zone.command("stop")
        wait_until(line.isEnabled, "a reason may be typed")
        self.core.refuse = "signed off"
        QTest.keyClicks(line, "why")
        QTest.keyClick(line, Qt.Key_Return)
        wait_until(lambda: "signed off" in self.panel._answer.text(), "the refusal is shown")
        self.assertEqual(line.text(), "why")


class TestResults(WordsCase):
    PANEL = ResultsPanel

    def setUp(self) -> None:
        super().setUp()
        self.zone.mark(Mark(*DOOR, 1), "Ben")
        self.identity = self.leave()
        self.wait_run("not signed off")
        wait_until(lambda: self.value(DOOR) == ("yes", ""), "the newest sheet is shown")

    def wait_run(self, state: str) -> None:
        wait_until(lambda: any(state in row[-1] for row in self.panel.runs.texts()), f"a run is '{state}'")
        wait_until(lambda: self.panel.items.texts(), "its sheet is shown")

    def value(self, item: tuple) -> tuple:
        """Return the shown value and mark of an item."""
        return next((row[2:] for row in self.panel.items.texts() if row[1] == item[1]), ())

    def test_the_zones_runs_are_shown(self) -> None:
        self.zone.command("next")
        self.zone.command("connect")
        self.core.zones["Home B"].command("connect")
        wait_until(lambda: len(self.panel.runs.texts()) == 2, "both runs of the zone are shown")
        now, over = self.panel.runs.texts()
        self.assertEqual((*now[:4], now[5]), ("now", "AnotherTeam", "HWV, round 1, run 2", "connected", "open"))
        self.assertEqual(over[1:], ("TestingTeam", "HGTKMH, round 1, run 1", "stopped, counts",
                                    "Achievements 1 · Penalized behaviours 0 · Disqualifying behaviours 0",
                                    "not signed off"))
        self.assertEqual(self.panel.runs.chosen, self.identity, "the choice stays with its run")
        self.panel.runs.choose(self.zone.identity)
        wait_until(lambda: self.panel.sign.toolTip() and "still connected" in self.panel.sign.toolTip(), "not over")
        self.client.model.choose_zone("Home B")
        wait_until(lambda: [row[0] for row in self.panel.runs.texts()] == ["now"], "the other zone is shown")
        self.client.model.choose_zone("Home A")

    def test_a_correction(self) -> None:
        self.assertEqual(self.value(DOOR), ("yes", ""))
        self.assertFalse(self.panel.correct.isEnabled())
        self.panel.items.choose(BUMPS)
        click(self.panel.correct)
        dialog = opened(ScoreDialog)
        dialog.number.setValue(4)
        QTest.keyClicks(dialog.note, "seen on video")
        click(dialog.yes)
        self.wait_words(self.identity, "seen on video", "Anna")
        wait_until(lambda: self.value(BUMPS) == ("4", "✎ corrected"), "the correction is marked")
        self.wait_run("✎ corrected, not signed off")
        self.panel.tabs.setCurrentWidget(self.panel.history)
        self.assertIn("✎ correction; seen on video", self.panel.history.rows.texts()[0])
        self.panel.history.rows.choose(1)
        click(self.panel.history.withdraw)
        click(opened(NoteDialog).yes)
        wait_until(lambda: self.value(DOOR) == ("no", "✎ corrected"), "the withdrawal is a correction, too")
        self.panel.tabs.setCurrentIndex(0)
        self.panel.items.choose(DOOR)
        click(self.panel.correct)
        dialog = opened(ScoreDialog)
        dialog.not_attempted.setChecked(True)
        click(dialog.yes)
        wait_until(lambda: self.value(DOOR) == ("not attempted", "✎ corrected"), "it differs from 0")

    def test_the_reason_of_a_stop(self) -> None:
        self.panel.tabs.setCurrentIndex(2)
        click(self.panel.give_reason)
        dialog = opened(NoteDialog)
        QTest.keyClicks(dialog.note, "fire alarm")
        click(dialog.yes)
        wait_until(lambda: self.panel.stops.texts()[0][-1] == "fire alarm (Anna)", "the reason is shown")

    def test_the_sign_off_asks_and_is_final(self) -> None:
        click(self.panel.sign)
        asked = question()
        self.assertIn("Signed by Anna. The sheet cannot be corrected afterwards", asked.informativeText())
        answer(asked, QMessageBox.RejectRole)
        click(self.panel.sign)
        asked = question()
        self.zone.mark(Mark(*BUMPS, 1), "Ben", self.identity)
        self.wait_run("✎ corrected, not signed off")
        answer(asked, QMessageBox.AcceptRole)
        self.assertIn("the score has changed", self.panel._answer.text())
        self.assertEqual(self.core.calls, [])
        click(self.panel.sign)
        asked = question()
        self.client.referee.set("Cleo")
        answer(asked, QMessageBox.AcceptRole)
        self.wait_words(self.identity, "", "Anna")
        self.wait_run("✔ signed off")
        wait_until(lambda: "✔ signed off by Anna at" in self.panel.what.text(), "it says who did")
        self.panel.items.choose(DOOR)
        for button in (self.panel.sign, self.panel.correct, self.panel.give_reason, self.panel.history.withdraw):
            wait_until(lambda b=button: "Final: signed off by Anna" in b.toolTip(), "each button says why")
            self.assertFalse(button.isEnabled())

    def test_a_silent_core_shows_and_takes_nothing_new(self) -> None:
        self.fall_silent()
        wait_until(lambda: "silent" in self.panel.sign.toolTip(), "the button says why it is off")
        self.assertEqual(self.value(DOOR), ("yes", ""))

    def test_the_name_is_one_for_all_panels_and_kept(self) -> None:
        kept = {}

        class Settings:
            def set_value(self, key, value):
                kept[key] = value

            def value(self, key, default):
                return kept.get(key, default)

        self.panel.referee.clear()
        QTest.keyClicks(self.panel.referee, "Cleo ")
        self.assertEqual(self.client.referee.name, "Cleo")
        self.panel.save_settings(Settings())
        self.client.referee.set("")
        self.assertEqual(self.panel.referee.text(), "")
        self.panel.restore_settings(Settings())
        self.assertEqual((self.client.referee.name, self.panel.referee.text()), ("Cleo", "Cleo"))
