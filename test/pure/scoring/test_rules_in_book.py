"""The rules of a sheet in the book of a run: incidents, late marks, percentages; taken back, restarted, corrected."""

from dataclasses import replace
from decimal import Decimal

import pytest

from helpers.competition import UTC0
from roah_rsbb.core.views.sheets import sheet_items
from roah_rsbb.model.as_json import from_json, to_json
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.records import By, JudgeSheet, JudgingRecord, RunRecord, Settlement, SignOff
from roah_rsbb.model.rules import Incident, Item, ItemChoice, Measure, Sheet, Voids
from roah_rsbb.model.scoring import INCIDENTS, NO_SECTION, SheetForm, rows
from roah_rsbb.rulebook.benchmarks import Benchmark
from roah_rsbb.scoring.book import BookState, FinishedRun, RunBook, rescored
from roah_rsbb.scoring.sheet import Mark, SheetState
from roah_rsbb.scoring.timeline import version_lines
from roah_rsbb.wording.sheets import difference_text

TABLE, SPECIAL = "Table", "Special"
SHEET = Sheet((
    Item("test", "Test", amount=Measure.SECTION, least=Decimal(0)),
    Item("table", TABLE, "test", Measure.SECTION),
    Item("finds", "Finds an object", "table", points=Decimal(10), times=12),
    Item("solves", "Solves a problem", "table", Measure.PERCENT, Decimal(650), least=Decimal(0), each=True),
    Item("again", "The same kind again", "solves", points=Decimal(-300)),
    Item("help", "With help", "solves", Measure.PERCENT, percent=Decimal(-100)),
    Item("drops", "Drops an object", "table", points=Decimal(-40)),
    Item("special", SPECIAL, amount=Measure.SECTION),
    Item("away", "Does not attend", "special", Measure.YES, Decimal(-500), times=1),
), (
    Incident("restart", times=1, below=Decimal(40), voids=Voids.EARLIER),
    Incident("absent", marks="away"),
    Incident("disqualified", voids=Voids.ALL),
), Decimal(420))


class Book:
    """A run of 420 s; `at` marks at its counted clock."""

    def __init__(self, sheet=SHEET, state=None):
        self.form = SheetForm(rows(sheet), sheet=sheet)
        self.book = RunBook(self.form, state)
        self.now = Now(100.0, UTC0)
        self.ended = ""

    def at(self, clock_s, desc, value=0, group=TABLE, **fields):
        self.now = Now(100.0 + clock_s, UTC0 + clock_s)
        self.book.mark(self.now, "Anna", Mark(group, desc, value, **fields), None if self.ended else clock_s)
        return self

    def incident(self, clock_s, name):
        return self.at(clock_s, name.capitalize(), group=INCIDENTS, added="1")

    def end(self, clock_s, reason="timeout"):
        self.ended = reason
        self.now = Now(100.0 + clock_s, UTC0 + clock_s)
        self.book.ended(self.now, reason, "", By(), clock_s)
        return self

    def withdraw(self, number):
        self.book.withdraw(self.now, By("Ben"), number)
        return self

    def total(self):
        return self.book.counted(self.ended).points.total

    def steps(self):
        return list(self.book.counted(self.ended).points.steps)

    def value(self, desc, group=TABLE):
        record = self.book.sheet.item(group, desc)
        return record.text or record.value


def test_a_restart_voids_what_was_before_and_can_be_withdrawn():
    book = Book().at(30, "Finds an object", added="3").incident(40, "restart").at(60, "Finds an object", added="2")
    assert (book.total(), book.value("Finds an object")) == ("20", 2)
    (void,) = [entry for entry in book.book.sheet.history if entry.void]
    assert (void.number, str(void.void)) == (1, "Finds an object (0:30.0): void because of: Restart")
    kept = BookState(SheetState(list(book.book.sheet.history)))  # as a record has it
    for each in (book, Book(state=kept)):
        each.withdraw(2)
        assert (each.total(), each.value("Finds an object")) == ("50", 5)
        assert not any(entry.void for entry in each.book.sheet.history)


@pytest.mark.parametrize("voids, below, total", [
    (Voids.EARLIER_POINTS, None, "-40"),  # one penalty is left
    (Voids.EARLIER, Decimal(25), "0"),  # 20 points so far
    (Voids.EARLIER, Decimal(20), "-20")])
def test_what_corrects_a_count_belongs_to_its_row(voids, below, total):
    sheet = Sheet((Item("table", TABLE, amount=Measure.SECTION), Item("finds", "Finds", "table", points=Decimal(10)),
                   Item("drops", "Drops", "table", points=Decimal(-40))),
                  (Incident("restart", below=below, voids=voids),))
    book = Book(sheet)
    for clock_s, desc, added in ((1, "Finds", "3"), (3, "Finds", "-1"), (5, "Drops", "2"), (7, "Drops", "-1")):
        book.at(clock_s, desc, added=added)
    assert book.incident(9, "restart").total() == total


REMOVED = replace(SHEET, incidents=(Incident("removed", voids=Voids.LATER),))


def test_nobody_takes_away_more_than_there_is():
    book = Book().end(420).at(425, "Drops an object", added="1")
    book.book.say_in_time("Ben", 1, True)
    book.at(430, "Drops an object", added="-1").book.say_in_time("Ben", 1, False)
    assert (book.value("Drops an object"), book.total()) == (0, "0")
    book.at(435, "Drops an object", added="1").book.say_in_time("Ben", 3, True)
    assert (book.value("Drops an object"), book.total()) == (1, "0")
    assert book.at(440, "Drops an object", added="-1").total() == "0"


def test_what_takes_something_away_corrects_a_mark_before_an_incident():
    book = Book(REMOVED).at(1, "Finds an object", added="3").incident(2, "removed").at(3, "Finds an object", added="1")
    assert (book.total(), book.value("Finds an object")) == ("30", 3)
    assert book.at(5, "Finds an object", added="-1").total() == "20"
    assert book.at(7, "Finds an object", 1).total() == "10"
    assert [bool(entry.void) for entry in book.book.sheet.history] == [False, False, True, False, False]


def test_what_was_corrected_then_counts_for_an_incident_that_makes_both_void():
    """Whether it was corrected depends on what counted until then, not on what counts at last."""
    restart = Incident("restart", below=Decimal(30), voids=Voids.EARLIER)
    book = Book(replace(SHEET, incidents=(restart, *REMOVED.incidents))).at(1, "Finds an object", 4)
    book.incident(2, "removed").at(3, "Finds an object", 2)
    assert book.total() == "20"
    assert (book.incident(4, "restart").total(), book.value("Finds an object")) == ("0", 0)
    assert [bool(entry.void) for entry in book.book.sheet.history] == [True, False, True, False]


def test_faces_say_at_once_that_a_mark_does_not_count():
    book = Book(REMOVED).at(1, "Finds an object", added="3").incident(2, "removed")

    def void():
        shown = sheet_items(book.book.sheet.items(), book.form, book.book.sheet.history)
        return [(item.desc, item.void) for item in shown if item.void]

    assert not void()  # those before it count
    book.at(3, "Finds an object", added="1")
    assert void() == [("Finds an object", "Finds an object (0:03.0): void because of: Removed")]
    book.withdraw(3)
    assert not void()


@pytest.mark.parametrize("after, total", [
    ([{"added": "1"}, {"added": "-1"}], "20"), ([{"value": 3}, {"value": 2}], "20"), ([{"added": "-1"}], "10"),
    ([{"added": "-1"}, {"added": "1"}], "-480"), ([{"added": "1"}], "-470"),
])
def test_what_was_corrected_was_not_scored_after_an_incident(after, total):
    costs = replace(SHEET, incidents=(Incident("restart", marks="away", scored_after=True),))
    book = Book(costs).at(20, "Finds an object", added="2").at(25, "Drops an object", added="1").incident(30, "restart")
    book.withdraw(2)
    for clock_s, mark in enumerate(after):
        book.at(40 + 2 * clock_s, "Finds an object", **mark)
    assert book.total() == total


def test_a_penalty_that_was_taken_back_after_an_incident_is_no_point():
    costs = replace(SHEET, incidents=(Incident("restart", marks="away", scored_after=True),))
    book = Book(costs).at(20, "Finds an object", added="5").at(25, "Drops an object", added="1").incident(30, "restart")
    assert book.at(40, "Drops an object", added="-1").total() == "50"


@pytest.mark.parametrize("restarted", [False, True])
def test_a_history_whose_clock_goes_back_counts_in_its_order(restarted):
    """The time of day was set back after the end, or the run began again."""
    book = Book().at(100, "Finds an object", 1).end(420).at(430, "Finds an object", 5)
    book.book.say_in_time("Ben", 2, True)
    now = book.now._replace(mono=book.now.mono + 5, utc=book.now.utc - 8)
    book.book.mark(now, "Anna", Mark(TABLE, "Finds an object", 3), 5.0 if restarted else None)
    if not restarted:
        book.book.say_in_time("Ben", 3, True)
    assert (book.value("Finds an object"), book.total()) == (3, "30")


def test_a_restart_that_comes_too_late_has_no_effect():
    book = Book().at(30, "Finds an object", added="4").incident(40, "restart")
    assert book.total() == "40"
    assert "Restart (0:40.0): 40 points, allowed below 40: it has no effect" in book.steps()


@pytest.mark.parametrize("clock_s, entries, total", [(89.9, 1, "20"), (90.3, 2, "10")])
def test_entries_of_one_second_are_two_if_a_time_ends_between_them(clock_s, entries, total):
    removed = Incident("removed", of="inactive", after=Decimal(30), voids=Voids.LATER)
    book = Book(replace(SHEET, incidents=(Incident("inactive"), removed))).incident(60, "inactive")
    book.at(89.7, "Finds an object", added="1").at(clock_s, "Finds an object", added="1")
    assert (len(book.book.sheet.history), book.total()) == (1 + entries, total)


def test_entries_of_one_second_are_two_if_the_run_ends_between_them():
    book = Book().at(419.7, "Finds an object", added="1").at(420.3, "Finds an object", added="1")
    assert (len(book.book.sheet.history), book.total()) == (2, "10")


def test_entries_of_one_second_are_one_unless_an_incident_divides_them():
    book = Book().at(30, "Finds an object", added="1").at(30.5, "Finds an object", added="1")
    assert len(book.book.sheet.history) == 1
    book = Book().at(30, "Finds an object", added="1").incident(30.3, "restart").at(30.5, "Finds an object", added="1")
    assert [entry.group for entry in book.book.sheet.history] == [TABLE, INCIDENTS, TABLE]
    assert book.total() == "10"


def test_marks_after_the_end_of_a_run_that_ended_before_its_limit_count():
    book = Book().at(100, "Finds an object", added="1").end(200, "completed").at(900, "Finds an object", added="2")
    assert (book.total(), book.value("Finds an object")) == ("30", 3)


def test_marks_after_the_time_limit_are_late_until_a_referee_says_otherwise():
    book = Book().at(100, "Finds an object", added="1").end(420).at(425, "Finds an object", added="2")
    assert (book.total(), book.value("Finds an object")) == ("10", 1)
    book.book.say_in_time("Ben", 2, True)
    assert book.total() == "30"
    assert not any(entry.void for entry in book.book.sheet.history)
    assert [(entry.in_time, entry.in_time_by) for entry in book.book.sheet.history] == [(False, ""), (True, "Ben")]
    book.book.say_in_time("Cleo", 2, False)
    assert book.total() == "10"
    assert (book.book.sheet.history[1].in_time, book.book.sheet.history[1].in_time_by) == (False, "Cleo")


@pytest.mark.parametrize("sheet, why", [
    (SHEET, "entry 1 was not late: the run had taken 1:40.0, and its time limit is 7:00.0"),
    (replace(SHEET, limit_s=None), "entry 1 was not late: no entry of this sheet is"),
])
@pytest.mark.parametrize("in_time", [True, False])
def test_an_entry_that_was_not_late(sheet, why, in_time):
    book = Book(sheet).at(100, "Finds an object", added="1").end(420)
    with pytest.raises(Refused) as refused:
        book.book.say_in_time("Ben", 1, in_time)
    assert (refused.value.reasons, book.book.sheet.history[0].in_time_by) == ([why], "")


def test_a_late_mark_that_takes_away_corrects():
    book = Book().at(100, "Finds an object", added="3").end(420).at(430, "Finds an object", added="-1")
    assert book.total() == "20"
    assert book.at(440, "Finds an object", 1).total() == "10"


@pytest.mark.parametrize("late, total", [
    ([{"added": "2"}, {"value": 1}], "10"),  # none of it was there at the end
    ([{"added": "2"}, {"value": 5}, {"value": 4}, {"value": 3}, {"value": 2}], "10"),
    ([{"value": 0}, {"value": 1}], "0"),
])
def test_a_late_mark_that_corrects_a_late_one_is_late(late, total):
    book = Book().at(100, "Finds an object", added="1").end(420)
    for number, mark in enumerate(late):
        book.at(430 + 10 * number, "Finds an object", **mark)
    assert book.total() == total


def test_a_late_mark_does_not_bring_back_what_a_restart_took():
    book = Book().at(30, "Finds an object", added="3").incident(40, "restart").end(420)
    assert book.at(430, "Finds an object", 2).total() == "0"
    assert book.value("Finds an object") == 0


@pytest.mark.parametrize("early, late, total", [
    ("half", "all", "50"), ("all", "half", "50"), ("half", "nothing", "0"), ("nothing", "all", "0"), ("", "half", "0"),
])
def test_a_late_choice_corrects_only_to_less(early, late, total):
    choices = tuple(ItemChoice(name, Decimal(points)) for name, points in (("all", 100), ("half", 50), ("nothing", 0)))
    sheet = Sheet((Item("pours", "Pours", amount=Measure.CHOICE, choices=choices),), limit_s=Decimal(420))
    book = Book(sheet)
    (row,) = book.form.items
    for clock_s, text in ((100, early), (430, late)):
        if clock_s == 430:
            book.end(420)
        if text:
            book.at(clock_s, "Pours", group=row.group, text=text)
    assert book.total() == total


def test_what_is_entered_after_the_end_counts_in_its_order():
    """The clock has stopped at the end, so all of it has one time."""
    book = Book().at(20, "Finds an object", added="3").end(200, "completed").incident(210, "restart")
    assert book.total() == "0"
    assert book.at(215, "Finds an object", added="2").at(220, "Drops an object", added="1").total() == "0"
    assert book.at(230, "Finds an object", added="5").total() == "30"
    assert book.incident(240, "restart").total() == "30"  # only one is allowed


def test_points_after_a_restart_that_was_entered_after_the_end():
    costs = replace(SHEET, incidents=(Incident("restart", marks="away", scored_after=True),))
    book = Book(costs).at(20, "Finds an object", added="3").end(200, "completed").incident(210, "restart")
    assert book.total() == "30"
    assert book.at(215, "Finds an object", added="2").total() == "-450"


def test_times_with_their_own_percentages():
    book = Book().at(10, "Solves a problem", added="100").at(20, "With help", added="60")
    book.at(30, "Solves a problem", added="100").at(31, "The same kind again", added="1")
    book.at(32, "With help", added="60")
    assert book.total() == "400"
    assert book.at(50, "Solves a problem", added="50").total() == "725"
    assert book.value("Solves a problem") == "250"


def test_an_incident_marks_its_item_below_zero_and_disqualified_is_nothing():
    book = Book().at(30, "Finds an object", added="3").incident(40, "absent")
    assert book.total() == "-470"
    assert book.incident(50, "disqualified").total() == "-500"


def test_withdrawing_everything_leaves_nothing():
    book = Book().at(30, "Finds an object", added="3").incident(40, "restart").incident(41, "absent")
    book.at(50, "Solves a problem", added="50")
    for entry in reversed(book.book.sheet.history):
        book.withdraw(entry.number)
    assert book.total() == "0"


def test_a_restart_of_the_box_and_a_finished_run_keep_all_of_it():
    book = Book().at(30, "Finds an object", added="3").incident(40, "restart").at(60, "Finds an object", added="2")
    again = Book(state=from_json(BookState, to_json(book.book.state)))
    assert (again.total(), again.steps()) == (book.total(), book.steps())
    book.end(420).at(430, "Finds an object", added="1")
    record = book.book.into(RunRecord("X-1-2", "Home", "X", "Alpha", 1, 1, UTC0, UTC0, end_reason="timeout"))
    record = from_json(RunRecord, to_json(record))
    finished = FinishedRun(record, Benchmark("X", "X", "", 420.0, 420.0, ()))
    assert finished.book.counted("timeout").points == record.points
    finished.say_in_time(book.now, By("Ben"), 4, True)
    assert finished.record.points.total == "30"


def test_a_percentage_of_an_item_that_counts_once_is_one_number():
    once = Sheet((Item("all", TABLE, amount=Measure.SECTION),
                  Item("one", "Solves it", "all", Measure.PERCENT, Decimal(250), times=1)))
    book = Book(once).at(10, "Solves it", text="50").at(20, "Solves it", added="30")
    assert (book.total(), book.value("Solves it")) == ("200", "80")
    assert book.at(30, "Solves it", added="-60").total() == "50"


def test_referees_mark_no_pauses_and_nothing_that_a_choice_says():
    kinds = Item("how", "How they came", amount=Measure.CHOICE)
    incidents = (Incident("pause", pauses=True, ends=("resume",)), Incident("resume"), Incident("came", marks="how"),
                 Incident("restart"))
    assert [row.desc for row in rows(Sheet((kinds,), incidents)) if row.group == INCIDENTS] == ["Restart"]


def test_what_an_incident_marks_is_offered_once_and_has_its_points_there():
    book = Book().incident(40, "absent").incident(50, "absent")
    rows_of_both = [(row.group, row.desc) for row in book.form.items if row.points == -500]
    assert rows_of_both == [(INCIDENTS, "Absent")]
    assert [(item.desc, item.value, item.points) for item in book.book.counted("").items if item.value] == [
        ("Absent", 2, "-500")]
    collision = (Incident("collision, restart", marks="away"), Incident("collision, stop", marks="away"))
    assert [row.points for row in rows(replace(SHEET, incidents=collision)) if row.group == INCIDENTS] == [None, None]


def test_an_item_in_no_section_can_be_marked():
    book = Book(Sheet((Item("one", "Finds it", points=Decimal(5)),)))
    (row,) = book.form.items
    assert row.group
    assert book.at(10, "Finds it", 2, group=row.group).total() == "10"


@pytest.mark.parametrize("end, total", [("no_show", "-500"), ("withdrawn", "0"), ("stopped", "0")])
def test_an_incident_comes_with_a_no_show_and_can_be_withdrawn(end, total):
    book = Book(replace(SHEET, incidents=(Incident("absent", marks="away", at_end=("no_show",)),))).end(0, end)
    assert book.total() == total
    for entry in book.book.sheet.history:
        book.withdraw(entry.number)
    assert (book.total(), len(book.book.sheet.history)) == ("0", int(end == "no_show"))


def test_an_incident_does_not_happen_without_end():
    """A slip of a finger must not fill the memory of the core."""
    with pytest.raises(Refused, match="'Restart' is a count: its value must be from 0 to 100, not 2147483647"):
        Book().at(40, "Restart", 2147483647, group=INCIDENTS)
    book = Book().at(30, "Finds an object", added="3").at(40, "Restart", 100, group=INCIDENTS)
    assert book.total() == "0"
    earlier = [entry._replace(value=2147483647) if entry.group == INCIDENTS else entry
               for entry in book.book.sheet.history]
    assert Book(state=BookState(SheetState(earlier))).total() == "0"


def test_marks_follow_their_rows_to_other_names():
    """A run that is over, scored by a sheet on which a section and two rows have other names, with the same ids."""
    book = Book().at(30, "Finds an object", added="5").at(40, "Drops an object", 1).end(200, "completed")
    entries = book.book.sheet.history
    settled = Settlement(1.0, "Hugo", TABLE, "Drops an object", 1, "", False, "seen", ())
    record = book.book.into(RunRecord("X", "Home", "X", "", 1, 1, "", 1.0))._replace(
        end_reason="completed", judging=JudgingRecord((JudgeSheet("Ann", 1.0, history=entries),), (settled,)))
    names = {"table": "Desk", "finds": "Drops an object", "drops": "Lets an object fall"}
    other = replace(SHEET, items=tuple(replace(item, name=names.get(item.id, item.name)) for item in SHEET.items))
    benchmark = Benchmark("X", "X", "", 420.0, 420.0, rows(other), sheet=other)
    (scored,) = rescored([record], {record.benchmark: benchmark})
    found = scored.signed(SignOff(2.0, "Hugo"), "other names")
    assert found.points.total == record.points.total == "10"
    places = [("Desk", "Drops an object"), ("Desk", "Lets an object fall")]
    assert [(entry.group, entry.desc) for entry in found.history] == places
    assert [(item.group, item.desc, item.value) for item in found.items if item.value] == [
        (*places[0], 5), (*places[1], 1)]
    assert [(entry.group, entry.desc) for entry in found.judging.sheets[0].history] == places
    assert [(each.group, each.desc) for each in found.judging.settlements] == places[1:]
    # The row of the finds is removed, and the drops have its name.
    less = tuple(replace(item, name={"drops": "Finds an object"}.get(item.id, item.name))
                 for item in SHEET.items if item.id != "finds")
    benchmark = replace(benchmark, scoring=rows(replace(SHEET, items=less)), sheet=replace(SHEET, items=less))
    (scored,) = rescored([record], {record.benchmark: benchmark})
    assert [(item.desc, item.value) for item in scored.after.items if item.value] == [("Finds an object", 1)]
    assert [entry.desc for entry in scored.after.history] == ["Finds an object (finds)", "Finds an object"]


def test_a_version_names_the_rows_that_are_worth_something_else_now():
    record = Book().at(30, "Finds an object", added="5").end(200, "completed").book.into(RunRecord(
        "X", "Home", "X", "", 1, 1, "", 1.0, end_reason="completed", sign_off=SignOff(1.0, "Anna")))
    items = (replace(item, points=Decimal(7)) if item.id == "finds" else item for item in SHEET.items)
    other = replace(SHEET, items=tuple(items))
    (scored,) = rescored([record], {"X": Benchmark("X", "X", "", 420.0, 420.0, rows(other), sheet=other)})
    (version,) = version_lines(scored.signed(SignOff(2.0, "Hugo"), "other points"))
    assert difference_text(version) == "Total: 50, now 35; Finds an object: 50 points, now 35 points"


def test_points_for_the_team_are_in_the_record_beside_the_total():
    sheet = replace(SHEET, items=tuple(replace(item, for_team=item.id == "away") for item in SHEET.items))
    book = Book(sheet).at(30, "Finds an object", added="3").incident(40, "absent")
    points = book.book.counted("").points
    assert (points.total, points.for_team) == ("30", "-500")


def test_points_name_the_groups_that_are_part_of_another_one():
    sheet = Sheet((*SHEET.items, Item("bonus", "Bonus", "test", points=Decimal(5))))
    points = Book(sheet).at(1.0, "Finds an object", added="1").book.counted("").points
    assert [(group.name, group.points) for group in points.groups] == [("Test", "10"), (TABLE, "10"), (SPECIAL, "0")]
    assert points.inner == (TABLE,)
    alone = Sheet((*SHEET.items, Item("half", "Half", percent=Decimal(-50))))
    points = Book(alone).at(1.0, "Finds an object", added="2").at(2.0, "Half", 1, NO_SECTION).book.counted("").points
    assert [tuple(group) for group in points.groups] == [(TABLE, "20"), (SPECIAL, "0"), (NO_SECTION, "-10")]
    assert (points.total, points.inner) == ("10", ())
    assert Book().book.counted("").points.inner == ()  # nobody lists the test, which has no items of its own


def test_an_entry_after_a_time_that_was_left_out_is_later_than_those_before():
    """After a restart of the box the clock of a run may go back."""
    book = Book().at(8.95, "Finds an object", 3).at(5.983, "Finds an object", 0)
    assert (book.value("Finds an object"), book.total()) == (0, "0")
    book = Book().at(8.95, "Finds an object", added="3").incident(5.983, "restart")
    book.at(6.5, "Finds an object", added="1")
    assert (book.value("Finds an object"), book.total()) == (1, "10")
    # An entry that is late does not make those late that follow in a run that was started again.
    assert Book().at(430, "Finds an object", added="1").at(20, "Finds an object", added="2").total() == "20"


def test_a_mark_that_waited_has_its_place_between_those_before_and_after_it():
    book = Book().at(10, "Finds an object", 1).at(20, "Finds an object", 3)
    book.book.sheet.set(Now(115.0, UTC0 + 15), "Ben", Mark(TABLE, "Finds an object", 2), False, 15.0, UTC0 + 30)
    assert [entry.value for entry in book.book.sheet.history] == [1, 2, 3]
    assert (book.value("Finds an object"), book.total()) == (3, "30")
