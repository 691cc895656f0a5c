"""What a sheet is worth: rows that depend on other rows, and on when they were marked."""

from dataclasses import replace
from decimal import Decimal
from fractions import Fraction

import pytest

from roah_rsbb.model.rules import Condition, Incident, Item, ItemChoice, Measure, Sheet, Voids
from roah_rsbb.scoring.tree import Course, Happened, SheetMark, count, number_text


def row(name, points, times=None, under="", **values):
    return Item(name, name, under, points=Decimal(points), times=times, **values)


def mark(item, number=1, at=None, share=1, **values):
    return SheetMark(item, Fraction(number), Fraction(share), at_s=None if at is None else Fraction(at), **values)


def worth(items, *marks, incidents=(), happened=(), **values):
    return count(Sheet(tuple(items), tuple(incidents)), Course(tuple(marks), tuple(happened), **values))


UNDERSTANDS = (row("understands", 80, 3, unless=(Condition("bypassed", each=True),)), row("bypassed", -50, 3))


@pytest.mark.parametrize("marks, points", [
    ([mark("understands", 3)], 240),
    ([mark("understands", 3), mark("bypassed")], 240 - 80 - 50),
    ([mark("understands"), mark("bypassed", 3)], -150),
    # What the referee has refused is not taken away again.
    ([mark("understands", 2), mark("understands", refused="typed"), mark("bypassed")], 160 - 50),
])
def test_each_count_of_another_row_takes_one_count_away(marks, points):
    assert worth(UNDERSTANDS, *marks).total == points


DOOR = (row("door", 200, 2, needs=(Condition("inside", since=2, after=True),)),
        Item("inside", "inside", amount=Measure.SECTION), row("plate", 70, 3, "inside"))


@pytest.mark.parametrize("marks, points", [
    ([mark("door", 2)], 200),
    ([mark("door", 2), mark("plate")], 470),
    ([mark("door", at=10), mark("plate", at=20), mark("door", at=30)], 470),
    ([mark("door", at=10), mark("door", at=20), mark("plate", at=30)], 270),
    ([mark("door", at=10), mark("door"), mark("plate", at=30)], 470),
    ([mark("door", at=10), mark("plate", at=20), mark("door", at=20)], 470),
    ([mark("door", at=Fraction(1, 4)), mark("door", at=Fraction(1, 2)), mark("plate")], 470),
    ([mark("door", at=10), mark("plate", at=20), mark("door", at=30), mark("plate", at=40)], 540),
])
def test_a_later_count_needs_another_row_before_it(marks, points):
    assert worth(DOOR, *marks).total == points


def test_what_modifies_a_row_does_not_give_it():
    rows = (*DOOR, row("help", -10, 3, "plate"))
    marks = [mark("door", at=10), mark("help", at=15), mark("door", at=20), mark("plate", at=30)]
    assert worth(rows, *marks).total == 200 + 70 - 10


SOLVED = (Item("solved", "solved", amount=Measure.PERCENT, points=Decimal(650), each=True, share_of_all=True),
          row("again", -300, None, "solved"),
          Item("help", "help", "solved", amount=Measure.PERCENT, percent=Decimal(-100)))


@pytest.mark.parametrize("marks, points", [
    # Repetition first, then the percentage.
    ([mark("solved", share=Fraction(1, 2)), mark("again")], Fraction(650 - 300) / 2),
    ([mark("solved"), mark("help", share=Fraction(3, 5))], 260),
    ([mark("solved", 2), mark("again"), mark("help", 2, share=Fraction(3, 5))], 260 + 140),
])
def test_the_percentage_of_a_time_is_of_what_is_left(marks, points):
    found = worth(SOLVED, *marks)
    assert (found.total, sum(found.own.values())) == (points, points)


def test_a_percentage_of_the_whole_sheet():
    items = row("done", 10, None), Item("bumps", "bumps", percent=Decimal(-5), times=4)
    assert worth(items, mark("done", 10), mark("bumps", 7)).total == 80


def test_points_for_the_team_are_not_part_of_the_sheet():
    found = worth([row("done", 10), row("absent", -500, for_team=True)], mark("done"), mark("absent"))
    assert (found.total, found.charged) == (10, -500)
    assert "absent: −500 for the team, whichever attempt counts" in found.steps


@pytest.mark.parametrize("completed, needs, elapsed_s, points, steps", [
    (True, (), 240, 60, []), (False, (), 240, 0, ["left: 0 of 60, because the robot did not complete the run"]),
    (True, ("done",), 240, 0, ["left: does not count without done: 0 of 60"]), (False, (), 300, 0, []),
])
def test_why_the_time_that_was_left_does_not_count(completed, needs, elapsed_s, points, steps):
    left = Item("left", "left", amount=Measure.CLOCK, points=Decimal(1), needs=tuple(map(Condition, needs)))
    found = count(Sheet((row("done", 10), left), clock_s=300.0),
                  Course((), ended=True, completed=completed, elapsed_s=Fraction(elapsed_s)))
    assert (found.total, [step for step in found.steps if "left" in step]) == (points, steps)


@pytest.mark.parametrize("net, points", [(False, 50 - 20 + 10), (True, 10)])
def test_points_that_limit_an_incident_without_and_with_penalties(net, points):
    items = [row("done", 10), Item("free", "free", amount=Measure.POINTS, points=Decimal(1))]
    marks = mark("free", 50, at=5), mark("free", -20, at=5), mark("done", at=20)
    rule = Incident("restart", below=Decimal(40), net=net, voids=Voids.EARLIER)
    assert worth(items, *marks, incidents=[rule], happened=[Happened("restart", Fraction(10))]).total == points


@pytest.mark.parametrize("ended, points", [(False, 10), (True, 10 + 60)])
def test_the_time_left_does_not_limit_an_incident_after_the_end(ended, points):
    sheet = Sheet((row("done", 10), Item("left", "left", amount=Measure.CLOCK, points=Decimal(1))),
                  (Incident("restart", below=Decimal(40), voids=Voids.EARLIER),), clock_s=300.0)
    course = Course((mark("done", at=20),), (Happened("restart", Fraction(10)),), ended=ended, completed=True,
                    elapsed_s=Fraction(240))
    found = count(sheet, course)
    assert (found.total, [step for step in found.steps if "no effect" in step]) == (points, [])


@pytest.mark.parametrize("at, points", [(None, 60), (20, 60), (5, 110)])
def test_an_incident_costs_points_only_if_some_were_scored_afterwards(at, points):
    items = row("done", 110), row("restarted", -50)
    rule = Incident("restart", marks="restarted", scored_after=True)
    found = worth(items, mark("done", at=at), incidents=[rule], happened=[Happened("restart", Fraction(10))])
    assert found.total == points


REMOVED = Incident("removed", of="inactive", after=Decimal(30), ends=("active again",), voids=Voids.LATER,
                   longer_by="longer time", requests=1)


@pytest.mark.parametrize("happened, points", [
    ([], 10),
    ([("active again", 89)], 20), ([("active again", 90)], 20), ([("active again", 91)], 10),
    # In the second in which the time is over, it can still be extended.
    ([("longer time", 90)], 20), ([("longer time", 91)], 10),
])
def test_the_second_in_which_a_time_is_over(happened, points):
    incidents = [Happened(name, Fraction(at_s), {"seconds": 60}) for name, at_s in [("inactive", 60), *happened]]
    found = worth([row("done", 10)], mark("done", at=90), mark("done", at=120), incidents=[REMOVED], happened=incidents)
    assert found.total == points


@pytest.mark.parametrize("seconds, points", [(20, 10), (0, 10), (40, 20), (None, 20), ("soon", 20)])
def test_who_does_not_say_how_long_asks_for_all_that_is_allowed(seconds, points):
    incidents = Happened("inactive", Fraction(60)), Happened("longer time", Fraction(70), {"seconds": seconds})
    found = worth([row("done", 10)], mark("done", at=80), mark("done", at=100), happened=incidents,
                  incidents=[replace(REMOVED, longer=Decimal(60))])
    assert found.total == points


def test_without_a_limit_who_does_not_say_how_long_gets_no_time():
    incidents = Happened("inactive", Fraction(60)), Happened("longer time", Fraction(90))
    marks = mark("done", at=80), mark("done", at=91)
    assert worth([row("done", 10)], *marks, happened=incidents, incidents=[REMOVED]).total == 10


@pytest.mark.parametrize("pauses, points", [
    ([("pause", 70), ("resume", 100)], 20), ([("pause", 70), ("resume", 85)], 10), ([("pause", 70)], 20),
    ([("pause", 50), ("resume", 65)], 10), ([("pause", 50), ("resume", 86)], 20),
    ([("pause", 60), ("resume", 60)], 10), ([("pause", 60), ("pause", 61)], 20),
    ([("pause", 89), ("resume", 90), ("pause", 90), ("resume", 114)], 20),
])
def test_a_pause_is_no_inactivity(pauses, points):
    times = [("inactive", 60), *pauses, ("active again", 115)]
    found = worth([row("done", 10)], mark("done", at=20), mark("done", at=118),
                  incidents=[REMOVED, Incident("pause", pauses=True, ends=("resume",))],
                  happened=[Happened(name, Fraction(at_s), order=order) for order, (name, at_s) in enumerate(times)])
    assert found.total == points


@pytest.mark.parametrize("pauses, points", [
    ([("pause", 0), ("resume", 0)], 0), ([("pause", 0), ("resume", 50)], 10),
    ([("pause", 10), ("resume", 35), ("pause", 40), ("resume", 65)], 0),  # only one is allowed
    ([("pause", 10), ("pause", 20), ("resume", 60)], 10),
])
def test_the_time_limit_with_pauses(pauses, points):
    sheet = Sheet((row("done", 10),), (Incident("pause", times=1, pauses=True, ends=("resume",)),), Decimal(100))
    happened = tuple(Happened(name, Fraction(at_s)) for name, at_s in pauses)
    assert count(sheet, Course((mark("done", at=150),), happened)).total == points


@pytest.mark.parametrize("limit_s, elapsed_s, points", [
    (None, 0, 0), (100, 0, 0), (90, 0, 0), (89, 0, 10), (100, 90, 0), (100, 80, 10), (None, 80, 10),
])
def test_what_comes_by_itself_does_not_come_after_the_end(limit_s, elapsed_s, points):
    removed = replace(REMOVED, voids=Voids.ALL)
    sheet = Sheet((row("done", 10),), (removed,), None if limit_s is None else Decimal(limit_s))
    found = count(sheet, Course((mark("done", at=20),), (Happened("inactive", Fraction(60)),), ended=True,
                                elapsed_s=Fraction(elapsed_s)))
    assert found.total == points


@pytest.mark.parametrize("minutes, points", [(60, 0), (59, -500), ("60", -500), (True, -500), (None, -500)])
def test_a_fact_of_which_there_must_be_enough(minutes, points):
    rule = Incident("absent", marks="away", unless=(Condition("announced", Decimal(60)),))
    found = worth([row("away", -500)], incidents=[rule], happened=[Happened("absent", facts={"announced": minutes})])
    assert found.total == points


@pytest.mark.parametrize("how, points", [("announced", 10), ("not announced", -490)])
def test_a_row_of_the_sheet_is_a_fact(how, points):
    items = row("done", 10), row("absent", -500), Item("how", "how", amount=Measure.CHOICE, choices=(
        ItemChoice("announced"), ItemChoice("not announced")))
    rule = Incident("absence", marks="absent", unless=(Condition("how", text="announced"),))
    found = worth(items, mark("done"), mark("how", text=how), incidents=[rule], happened=[Happened("absence")])
    assert found.total == points


def test_a_row_that_was_made_at_the_event_has_its_name_in_the_steps():
    found = worth([row("custom", 1)], mark("custom", name="Waters the plants", refused="too late"))
    assert found.steps[0] == "Waters the plants: must not count: too late"


@pytest.mark.parametrize("at", [70, 90])
def test_what_was_entered_does_not_come_by_itself_again(at):
    costs = replace(REMOVED, marks="costs", voids=Voids.NOTHING)
    found = worth([row("costs", -50)], mark("costs", at=100), incidents=[costs],
                  happened=[Happened("inactive", Fraction(60)), Happened("removed", Fraction(at))])
    assert found.total == -50


@pytest.mark.parametrize("ended, at, said", [(False, 80, False), (False, 90, True), (True, 80, True)])
def test_a_time_that_is_not_over_yet_has_no_consequence(ended, at, said):
    found = worth([row("done", 10)], mark("done", at=at), incidents=[REMOVED],
                  happened=[Happened("inactive", Fraction(60))], ended=ended)
    assert any("by itself" in step for step in found.steps) == said


@pytest.mark.parametrize("happened, step", [
    ([("inactive", 60)], "Removed at 1:30.0, by itself"),
    ([("removed", 60)], None),
    ([("restart", 10), ("restart", 20)], "Restart (0:20.0): time 2, 1 allowed: it has no effect"),
    ([("restart", 91)], "Restart (1:31.0): 10 points, allowed below 10: it has no effect"),
])
def test_steps_of_incidents(happened, step):
    restart = Incident("restart", times=1, below=Decimal(10), voids=Voids.EARLIER)
    found = worth([row("done", 10)], mark("done", at=90), incidents=[REMOVED, restart],
                  happened=[Happened(name, Fraction(at_s)) for name, at_s in happened], ended=True)
    assert [text for text in found.steps if not text.startswith("Total")] == ([step] if step else [
        "done (1:30.0): void because of: Removed"])


@pytest.mark.parametrize("marks, step", [
    ([mark("done")], "Total: 10"), ([mark("done"), mark("absent")], "Total: 10 − 500 = −490"), ([], "Total: 0"),
])
def test_the_last_step_is_the_total(marks, step):
    assert worth([row("done", 10), row("absent", -500)], *marks).steps[-1] == step


@pytest.mark.parametrize(("number", "text"), [
    (Fraction(1, 16), "0.063"), (Fraction(-1, 16), "−0.063"), (Fraction(-1, 3000), "0"), (Fraction(100), "100"),
    (Fraction(2, 3), "0.667"), (Fraction(-5, 2), "−2.5")])
def test_numbers_in_steps_are_rounded_as_in_standings(number, text):
    assert number_text(number) == text
