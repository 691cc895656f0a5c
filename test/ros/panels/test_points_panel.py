"""Scoring with items of every type, and the points of the sheet."""

from decimal import Decimal

from support.fakes.core import FakeCore
from support.gui_testing import QTest, click, opened, wait_until
from support.panel_case import PanelCase
from support.window_case import WindowCase, in_sight

from roah_rsbb.model.reason import RunName
from roah_rsbb.model.scoring import INCIDENTS, ItemChoice, JuryResult, ScoreKind, ScoringItem
from roah_rsbb.rqt.panels.score_sheet import ScoreDialog
from roah_rsbb.rqt.panels.scoring import ScoringPanel
from roah_rsbb.scoring.sheet import Mark

OBJECTS = ScoringItem("Table", "Objects in the dishwasher", ScoreKind.UINT, Decimal(20), most=Decimal(5))
EMPTY = ScoringItem("Table", "Table is empty", ScoreKind.BOOL, Decimal(30), needs=(OBJECTS.key,))
OPENS = ScoringItem("Table", "Opens the dishwasher", ScoreKind.CHOICE, choices=(
    ItemChoice("alone", Decimal(50)), ItemChoice("with help", Decimal(10)), ItemChoice("not at all", Decimal(0))))
HEIGHT = ScoringItem("Table", "Steps up or down", ScoreKind.INT, Decimal("-1.5"), Decimal(-2), Decimal(2))
DROPS = ScoringItem("Penalties", "Drops an object", ScoreKind.UINT, Decimal(-10))
WATER = ScoringItem("Penalties", "Water on the floor (l)", ScoreKind.DECIMAL, Decimal("-2.5"), most=Decimal(10))
SHOW = ScoringItem("Jury", "Presentation", ScoreKind.RATING, Decimal(2), Decimal(0), Decimal(10),
                   judges=("Anna", "Ben", "Chris"), jury=JuryResult.MEDIAN)
FOLDS = ScoringItem("Jury", "Folds a shirt", ScoreKind.DECIMAL, least=Decimal(0), most=Decimal(100), unit="%")
RESTART = ScoringItem(INCIDENTS, "restart", ScoreKind.UINT)
SEEN = (OBJECTS, EMPTY, OPENS, HEIGHT, DROPS, WATER, SHOW)
ITEMS = (*SEEN, FOLDS, RESTART)


class TestPoints(PanelCase):
    """A run with a sheet of all types."""

    PANEL = ScoringPanel

    def new_core(self) -> FakeCore:
        return FakeCore(items=ITEMS)

    def row(self, item):
        return self.scoring.rows[item.key]

    def setUp(self) -> None:
        super().setUp()
        self.scoring = self.panel
        self.zone.command("connect")
        self.zone.command("start")
        wait_until(lambda: len(self.scoring.rows) == len(ITEMS), "the sheet is shown")

    def record(self):
        """What the core has written down."""
        return {item.key: item for item in self.zone.book.sheet.items()}

    def test_points_of_items_groups_and_in_total_are_live(self) -> None:
        self.zone.mark(Mark(*OBJECTS.key, 3), "Anna")
        self.zone.mark(Mark(*EMPTY.key, 1), "Anna")
        self.zone.mark(Mark(*DROPS.key, 2), "Anna")
        wait_until(lambda: self.scoring.points.text() == "70 points: Table 90 · Penalties -20", "the total")
        self.assertEqual([self.row(item).points.text() for item in ITEMS],
                         ["60", "30", "0", "0", "-20", "0", "0", "", ""])
        titles = [group.box.title() for group in self.scoring.sheet._groups.values()]
        self.assertEqual(titles, ["Table: 90 points", "Penalties: -20 points", "Jury: 0 points", ""])
        self.assertIn("Objects in the dishwasher", self.row(EMPTY).text.toolTip())

    def test_incidents_are_in_a_drawer_whose_title_says_what_happened(self) -> None:
        drawer = self.scoring.sheet.drawer
        row = self.row(RESTART)
        self.assertEqual((drawer.text(), row.isVisible(), row.key), ("▸ Incidents", False, ""))
        self.zone.mark(Mark(*RESTART.key, 1), "Anna")
        wait_until(lambda: drawer.text() == "▸ Incidents: restart 1", "it is said although the drawer is closed")
        click(drawer)
        wait_until(row.isVisible, "the drawer is open")
        self.assertEqual(drawer.text(), "▾ Incidents: restart 1")
        click(row.more)
        wait_until(lambda: drawer.text() == "▾ Incidents: restart 2", "it is marked there")
        click(drawer)
        wait_until(lambda: not row.isVisible(), "the drawer is closed")

    def test_a_percentage_has_its_unit(self) -> None:
        field = self.row(FOLDS).field
        field.setFocus()
        field.selectAll()
        QTest.keyClicks(field, "60\r")
        wait_until(lambda: self.record()[FOLDS.key].text == "60", "the core has it")
        self.assertEqual(field.text(), "60 %")

    def test_a_number_is_typed(self) -> None:
        field = self.row(WATER).field
        field.setFocus()
        field.selectAll()
        QTest.keyClicks(field, "2,5\r")
        wait_until(lambda: self.record()[WATER.key].text == "2.5", "the core has it")
        wait_until(lambda: self.row(WATER).points.text() == "-6.25", "its points are shown")
        self.assertEqual(field.text(), "2.5")
        self.zone.mark(Mark(*WATER.key, text="1"), "Ben")
        self.row(DROPS).more.setFocus()
        wait_until(lambda: field.text() == "1", "another referee's value is shown")

    def test_a_whole_number_is_typed_with_any_minus(self) -> None:
        self.row(HEIGHT).with_note.trigger()
        dialog = opened(ScoreDialog)
        dialog.field.selectAll()
        dialog.field.lineEdit().insert("−2")  # QTest has no such key
        self.assertEqual(dialog.field.value(), -2)
        dialog.reject()

    def test_one_of_several_is_chosen(self) -> None:
        field = self.row(OPENS).field
        self.assertEqual([field.itemText(n) for n in range(field.count())], [
            "–", "alone (50)", "with help (10)", "not at all (0)"])
        field.setCurrentIndex(2)
        field.activated.emit(2)
        wait_until(lambda: self.record()[OPENS.key].text == "with help", "the core has it")
        wait_until(lambda: self.row(OPENS).points.text() == "10", "its points are shown")
        self.row(OPENS).not_attempted.trigger()
        wait_until(lambda: self.record()[OPENS.key].not_attempted, "it is marked")
        wait_until(lambda: field.currentIndex() == 0, "no choice is shown")

    def test_each_judge_gives_a_rating(self) -> None:
        fields = self.row(SHOW).ratings.fields
        self.assertEqual([field.text() for field in fields.values()], ["–"] * 3)
        fields["Anna"].setValue(8.0)
        wait_until(lambda: self.record()[SHOW.key].ratings == (("Anna", "8"),), "the first entry is hers")
        fields["Chris"].setValue(6.5)
        wait_until(lambda: self.record()[SHOW.key].ratings == (("Anna", "8"), ("Chris", "6.5")), "the core has them")
        wait_until(lambda: self.row(SHOW).result.text() == "7.25", "the result is shown")
        wait_until(lambda: self.row(SHOW).points.text() == "14.5", "its points are shown")
        self.core.event(self.core.box.scores.withdraw, RunName("Home A"), 1)
        wait_until(lambda: fields["Anna"].text() == "–", "the withdrawn rating is gone")

    def test_the_first_step_of_a_judge_without_a_rating_is_the_least_rating(self) -> None:
        field = self.row(SHOW).ratings.fields["Ben"]
        field.stepUp()
        wait_until(lambda: self.record()[SHOW.key].ratings == (("Ben", "0"),), "the core has it")

    def test_whole_numbers_stay_within_their_limits(self) -> None:
        for _ in range(2):
            click(self.row(HEIGHT).less)
        wait_until(lambda: self.record()[HEIGHT.key].value == -2, "it is counted")
        wait_until(lambda: self.row(HEIGHT).number.text() == "-2", "it is shown")
        self.assertFalse(self.row(HEIGHT).less.isEnabled())
        self.zone.mark(Mark(*OBJECTS.key, 5), "Anna")
        wait_until(lambda: not self.row(OBJECTS).more.isEnabled(), "there are no more objects")

    def test_a_rating_with_a_note(self) -> None:
        self.row(SHOW).with_note.trigger()
        dialog = opened(ScoreDialog)
        dialog.judge.setCurrentText("Ben")
        dialog.field.setValue(4.5)
        QTest.keyClicks(dialog.note, "too loud")
        click(dialog.yes)
        wait_until(lambda: self.record()[SHOW.key].ratings == (("Ben", "4.5"),), "the core has it")
        self.assertEqual(self.zone.book.sheet.history[-1].note, "too loud")


class TestInSight(WindowCase):
    ITEMS = SEEN

    def test_all_is_in_sight(self) -> None:
        self.run_zone()
        wait_until(lambda: len(self.scoring.rows) == len(SEEN), "the sheet is shown")
        for size in ((1366, 768), (1920, 1080)):
            self.window.resize(*size)
            self.wait_quiet()
            parts = [self.scoring.points]
            for row in self.scoring.rows.values():
                parts += [row.text, row.points, row.menu_button]
            parts += self.scoring.rows[SHOW.key].ratings.fields.values()
            parts += [self.scoring.rows[item.key].field for item in (OPENS, WATER)]
            wait_until(lambda: all(map(in_sight, parts)), lambda: f"at {size}, all is in sight")  # noqa: B023
