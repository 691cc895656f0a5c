"""Notes, reasons and names, clicked on and typed, with a fake core: real messages, real services."""

import unittest
from types import SimpleNamespace
from typing import Callable, List

from support.fakes.core import NOT_ATTEMPTED
from support.gui_testing import Qt, QTest, QWidget, click, limit, opened, wait_until
from support.panel_case import BUMPS, DOOR, PanelCase, Settings

from roah_rsbb.model.as_json import to_json
from roah_rsbb.model.reason import RunName
from roah_rsbb.model.results import RunLine, RunSheet
from roah_rsbb.rqt.calls import CallOutcome
from roah_rsbb.rqt.model import Sheets
from roah_rsbb.rqt.panels import benchmark_control, scoring
from roah_rsbb.rqt.panels.score_sheet import ScoreDialog


class TestSheets(unittest.TestCase):
    def test_an_answer_that_was_overtaken_is_ignored(self) -> None:
        done: List[Callable[[CallOutcome], None]] = []
        owner = QWidget()
        self.addCleanup(owner.close)
        sheets = Sheets(owner, SimpleNamespace(call=lambda _owner, _name, then, **run: done.append(then)),
                        lambda: None)
        runs = [RunLine("a run", revision, "Home A", "HGTKMH", "Team", 1, 1, 0.0) for revision in (1, 2)]
        for run in runs:
            self.assertIsNone(sheets.newest(run))
        for number in (1, 0):
            done[number](CallOutcome("", to_json(RunSheet(runs[number], (), 0.0, (), (), ()))))
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

    def test_a_note(self) -> None:
        self.bumps.with_note.trigger()
        dialog = opened(ScoreDialog)
        dialog.field.setValue(3)
        QTest.keyClicks(dialog.note, "the vase, twice")
        click(dialog.yes)
        self.wait_call("score", "Home A", *BUMPS, "+3")
        self.wait_words(self.zone.identity, "the vase, twice", "Anna")
        self.door.with_note.trigger()
        dialog = opened(ScoreDialog)
        dialog.not_attempted.setChecked(True)
        self.assertFalse(dialog.field.isEnabled())
        click(dialog.yes)
        self.wait_call("score", "Home A", *DOOR, NOT_ATTEMPTED)
        self.door.with_note.trigger()
        click(opened(ScoreDialog).cancel)
        self.assertEqual(len(self.core.calls), 2)

    def test_the_name_is_one_for_all_panels_and_kept(self) -> None:
        settings = Settings()
        self.panel.referee.clear()
        QTest.keyClicks(self.panel.referee, "Cleo ")
        self.assertEqual(self.client.referee.name, "Cleo")
        self.panel.save_settings(settings)
        self.client.referee.set("")
        self.assertEqual(self.panel.referee.text(), "")
        self.panel.restore_settings(settings)
        self.assertEqual((self.client.referee.name, self.panel.referee.text()), ("Cleo", "Cleo"))



class TestStopReason(WordsCase):
    PANEL = benchmark_control.BenchmarkControlPanel

    def setUp(self) -> None:
        super().setUp()
        self.line = self.panel.reason

    def stop(self) -> None:
        self.zone.command("stop")
        wait_until(self.line.isEnabled, "a reason may be typed")

    def type(self, text: str) -> None:
        QTest.keyClicks(self.line, text)
        QTest.keyClick(self.line, Qt.Key_Return)

    def test_it_is_typed_after_the_stop(self) -> None:
        line, identity = self.line, self.zone.identity
        wait_until(lambda: "RUNNING" in self.panel.phase.text(), "the run is shown")
        self.assertFalse(line.isEnabled())
        click(self.strip.stop)
        wait_until(line.isEnabled, "a reason may be typed")
        self.type("fire alarm")
        self.wait_words(identity, "fire alarm", "Anna")
        wait_until(lambda: self.zone.run.book.state.stops[0].reason == "fire alarm", "it is saved")
        wait_until(lambda: line.text() == "fire alarm", "it stays")
        self.type(" in the kitchen")
        self.wait_words(identity, "fire alarm in the kitchen", "Anna")
        wait_until(lambda: line.text() == "fire alarm in the kitchen", "the longer one stays")

    def test_a_sheet_from_before_does_not_take_the_text_away(self) -> None:
        line = self.line
        self.stop()
        known = line._sheets.newest
        wait_until(lambda: known(line._summary) is not None and known(line._summary).ends, "the sheet is known")
        before = known(line._summary)
        before = before._replace(run=before.run._replace(revision=before.run.revision + 1))
        limit(self, line._sheets, "newest", lambda summary: before)
        self.type("fire alarm")
        self.wait_words(self.zone.identity, "fire alarm", "Anna")
        self.wait_heard()
        self.assertEqual(line.text(), "fire alarm")

    def test_it_stays_visible_and_editable_until_the_sign_off(self) -> None:
        line, identity = self.line, self.zone.identity
        self.zone.command("stop")
        scores = self.core.box.scores
        self.core.event(scores.give_stop_reason, RunName("Home A"), "fire alarm", "Ben")  # by another client
        wait_until(lambda: line.text() == "fire alarm", "it is shown")
        self.zone.command("disconnect")
        wait_until(lambda: "NOT CONNECTED" in self.panel.phase.text(), "the run is left")
        wait_until(line.isEnabled, "it can be changed")
        self.assertEqual(line.text(), "fire alarm")
        self.core.event(scores.sign_off, RunName("Home A", identity), "Cleo")
        wait_until(lambda: not line.isEnabled(), "it is final")
        self.assertEqual(line.text(), "fire alarm")
        self.assertIn("signed off by Cleo", line.toolTip())

    def test_it_is_of_the_run_that_was_stopped_also_after_it_is_left(self) -> None:
        line, identity = self.line, self.zone.identity
        self.stop()
        QTest.keyClicks(line, "the door ")
        self.zone.command("disconnect")
        wait_until(lambda: "NOT CONNECTED" in self.panel.phase.text(), "the run is left")
        self.type("was locked")
        self.wait_words(identity, "the door was locked", "Anna")
        QTest.keyClicks(line, " twice")
        self.zone.command("connect")
        self.wait_words(identity, "the door was locked twice", "Anna")
        wait_until(lambda: not line.isEnabled() and not line.text(), "another run begins")

    def test_a_refusal_keeps_what_was_typed(self) -> None:
        line = self.line
        self.stop()
        self.core.refuse = "signed off"
        self.type("why")
        wait_until(lambda: "signed off" in self.panel.answer.text(), "the refusal is shown")
        self.assertEqual(line.text(), "why")
