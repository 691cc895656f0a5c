"""Manual operations during a run: by itself, or as the referee types."""

import math

import pytest

from helpers.forms import MEASURED, ODD, ODD_ASKED, form
from helpers.referee_box import FakeLink
from roah_rsbb.model.fields import Choice, form_of
from roah_rsbb.model.reason import Refused, say
from roah_rsbb.model.zone import Switches
from roah_rsbb.referee.at_once import Exit, NoCore
from roah_rsbb.referee.run import MAX_IN_A_ROW, AutomaticAnswers, GivenUp, Operations, RunScript, ScriptPlan, Typed

PLACE = (1, "Place it")
AGAIN = (2, "No pose", *form_of(form("try again", "skip")))
WHOM = (1, "Whom?", *form_of(form(asks_text=True)))
TO_CONFIRM = Switches((1,), 0, True)


def numbered(operation, number):
    """An operation with another number."""
    return (number, *operation[1:])


class Table:
    """A referee's terminal: the questions in a running zone, the typed lines, the output."""

    def __init__(self, kind, ahead=False):
        self.link = FakeLink()
        self.notes = []
        self.typed = []
        self.kind = kind
        self.answers = (
            AutomaticAnswers(self.link, self.notes.append) if kind is AutomaticAnswers
            else Typed(self.link, self.notes.append, self._lines, ahead)
        )

    def _lines(self):
        typed, self.typed = self.typed, []
        return typed

    def asks(self, operation=(0,), switches=None):
        """`operation`: its number, text and fields."""
        self.link.ask(*operation)
        self.link.change(switches=switches)
        self.looks()

    def looks(self, times=1):
        for _ in range(times):
            self.link.next(0.1)
            self.answers.look(self.link.zone)

    def types(self, *lines):
        """On a terminal, a line at a time."""
        for line in lines:
            self.typed.append(line)
            self.looks()


def test_an_answer_that_is_none_of_the_choices_is_the_text_of_the_form():
    table = Table(Typed)
    fields = form_of(form("Annie", "Tom", asks_text=True))
    for number, (typed, given) in enumerate((("tom", "Tom"), ("a man", "a man"), ("", "")), 1):
        table.asks((number, "Whom?", *fields))
        table.types(typed)
        assert table.link.given[-1] == ("operation", number, given)
    assert "type Annie / Tom, or another answer (Enter: Annie)" in table.notes


# -- by itself --------------------------------------------------------------------------------------


def test_each_operation_is_completed_once_with_its_usual_answer():
    table = Table(AutomaticAnswers)
    table.asks(PLACE)
    table.asks(PLACE)  # an old message once more
    table.asks()
    table.asks(AGAIN)
    assert table.link.given == [("operation", 1), ("operation", 2)]
    assert table.notes == ["completed without a human referee: Place it", "completed without a human referee: No pose"]


def test_switches_are_confirmed_when_the_robot_has_finished():
    table = Table(AutomaticAnswers)
    table.asks(switches=TO_CONFIRM._replace(to_confirm=False))
    assert table.link.given == []
    table.asks(switches=TO_CONFIRM)
    assert table.link.given == [("confirm_switches",)]


@pytest.mark.parametrize("error", [Refused(["over"]), NoCore("gone")])
def test_what_does_not_work_is_tried_again(error):
    table = Table(AutomaticAnswers)
    table.link.answers["operation"] = [error, None]
    table.asks(PLACE)
    assert (table.link.given, table.notes) == ([], [])
    table.looks()
    assert table.link.given == [("operation", 1)]


def test_what_only_a_human_can_measure_is_given_up():
    with pytest.raises(GivenUp, match="Look at the cup.*: Did the robot hold it.*, Pose of the cup"):
        Table(AutomaticAnswers).asks((1, ODD_ASKED, *ODD))


def test_the_same_thing_again_is_waited_for_and_not_for_ever():
    table = Table(AutomaticAnswers)
    table.asks(numbered(AGAIN, 1))
    for number in range(2, MAX_IN_A_ROW + 1):
        table.asks(numbered(AGAIN, number))
        assert len(table.link.given) == number - 1, "not at once"
        while len(table.link.given) < number:
            table.looks()
    with pytest.raises(GivenUp, match="asked 10 times in a row: No pose"):
        table.asks(numbered(AGAIN, 99))
        table.looks(12)


def test_something_else_in_between_is_patience():
    table = Table(AutomaticAnswers)
    for number in range(1, 40, 2):
        table.asks(numbered(AGAIN, number))
        table.asks(numbered(PLACE, number + 1))
    assert len(table.link.given) == 40


# -- typed ------------------------------------------------------------------------------------------


def test_enter_completes_what_is_asked_and_nothing_else():
    table = Table(Typed)
    table.types("", "too early")
    assert table.link.given == []
    table.asks(PLACE)
    assert table.notes == ["press Enter when it is done"]
    table.looks(5)
    assert table.link.given == []
    table.types("", "")
    assert table.link.given == [("operation", 1)]
    table.asks(AGAIN)
    assert table.notes[1:] == ["type try again / skip (Enter: try again)"]
    table.types("SK")
    assert table.link.given[1:] == [("operation", 2, "skip")]


@pytest.mark.parametrize("ahead", [True, False])
def test_what_is_shown_for_a_moment_longer_is_not_asked_again(ahead):
    table = Table(Typed, ahead)
    table.asks(PLACE)
    table.types("", "")
    table.looks(3)
    assert len(table.link.given) == len(table.notes) == 1
    table.asks(AGAIN)
    table.looks(3)
    assert len(table.notes) == 2
    assert len(table.link.given) == (2 if ahead else 1)


def test_an_invalid_answer_is_reported_and_asked_again():
    table = Table(Typed)
    table.asks(AGAIN)
    table.types("what")
    assert table.link.given == []
    assert table.notes[1] == "not done: Answer: choose one of try again, skip"
    table.looks()
    assert table.notes[2] == table.notes[0]
    table.types("skip")
    assert table.link.given == [("operation", 2, "skip")]


@pytest.mark.parametrize(("operation", "prompt", "line", "answer"), [
    (WHOM, "type text (Enter: none)", "don't know", "don't know"),
    (WHOM, "type text (Enter: none)", "", ""),
    (numbered(AGAIN, 1), "type try again / skip (Enter: try again)", "", ""),
    ((1, "How high?", MEASURED), "type 0 to 2.5 m", "1,5", 1.5),
])
def test_an_answer_may_be_typed(operation, prompt, line, answer):
    table = Table(Typed)
    table.asks(operation)
    assert table.notes == [prompt]
    table.types(line)
    assert table.link.given == [("operation", 1, answer)]


def test_the_form_of_a_module_that_nobody_knows_is_filled_in():
    table = Table(Typed)
    table.asks((7, ODD_ASKED, *ODD))
    assert table.notes == [
        "type a value for each, in this order or as NAME=VALUE: held: Did the robot hold it? (yes / no); "
        "drops: How often did it fall? (0 to 9); place: Where is it now? (table / floor); "
        "pose: Pose of the cup (x y direction, in m and degrees)"]
    table.types("yes many")
    assert table.notes[1] == "not done: How often did it fall?: a whole number from 0 to 9 is expected"
    table.looks()
    table.types("yes drop=2")
    assert table.notes[3].startswith("not done: 'drop' is not asked for: held: Did the robot hold it? (yes / no)")
    table.looks()
    table.types("yes 2 pose='1.25 0,40 90' fl")
    (action, number, *values), = table.link.given
    assert (action, number, values) == ("operation", 7, [True, 2, [1.25, 0.4, pytest.approx(math.pi / 2)], "floor"])


def test_the_beginning_of_several_choices_is_none_of_them():
    table = Table(Typed)
    place = Choice("place", say("Place"), choices=("the floor", "the chair"))
    table.asks((1, "Where?", place))
    table.types("the", "the c")
    assert table.notes[1] == "not done: 'the' is the beginning of several choices: 'the floor', 'the chair'"


def test_switches_are_entered_and_confirmed():
    table = Table(Typed)
    table.asks(switches=TO_CONFIRM)
    assert "damaged" in table.notes[0]
    table.types("switch 2", "switch 3", "switch 2", "damaged 1")
    assert table.link.given == [("switch", 2), ("switch", 3), ("switch", 2), ("damaged", 1)]
    table.types("damaged two")
    assert table.notes[1] == "not done: Number: a whole number from 0 to 255 is expected"
    table.looks()
    table.types("2")
    assert table.notes[3] == "not done: '2' is not asked for"
    table.looks()
    table.types("", "2")
    assert table.link.given[4:] == [("confirm_switches",)]


def test_a_script_may_answer_ahead():
    table = Table(Typed, ahead=True)
    table.typed = ["", "skip", ""]
    for operation in (PLACE, AGAIN, numbered(PLACE, 3)):
        table.asks(operation)
        table.looks(3)
        table.asks()
    assert table.link.given == [("operation", 1), ("operation", 2, "skip"), ("operation", 3)]


def test_another_referee_may_be_quicker():
    table = Table(Typed)
    table.asks(PLACE)
    table.link.answers["operation"] = [Refused(["that manual operation is over"])]
    table.types("")
    assert table.notes[1] == "not done: that manual operation is over"
    table.asks()
    table.asks(AGAIN)
    table.types("")
    assert table.link.given == [("operation", 2, "")]


# -- in a run ---------------------------------------------------------------------------------------


def _run(link, operations):
    reported = []
    plan = ScriptPlan("Home A", 20.0, operations=operations)
    outcome = RunScript(link, plan, reported.append).run()
    return outcome, [change.facts["text"] for change in reported if change.kind == "note"]


def test_a_run_with_manual_operations():
    link = FakeLink()
    link.at(3, lambda: link.ask(*PLACE))
    link.at(5, lambda: link.ask(*AGAIN))
    link.at(7, lambda: link.end("completed"))
    outcome, notes = _run(link, Operations.AUTOMATIC)
    assert outcome.status is Exit.OK
    assert link.given == [("operation", 1), ("operation", 2)]
    assert notes[0] == "completed without a human referee: Place it"


def test_a_run_leaves_them_to_others():
    link = FakeLink()
    link.at(3, lambda: link.ask(*PLACE))
    link.at(5, lambda: link.end("completed"))
    assert _run(link, Operations.OTHERS) == (_run_outcome(link), [])
    assert link.given == []


def _run_outcome(link):
    again = FakeLink()
    again.at(3, lambda: again.ask(*PLACE))
    again.at(5, lambda: again.end("completed"))
    return RunScript(again, ScriptPlan("Home A", 20.0), lambda change: None).run()


def test_a_run_that_needs_a_human_is_left():
    link = FakeLink()
    for number in range(1, 20):
        link.at(2 * number, lambda n=number: link.ask(*numbered(AGAIN, n)))
    outcome, _ = _run(link, Operations.AUTOMATIC)
    assert outcome.status is Exit.NOT_COMPLETED
    assert "asked 10 times in a row: No pose" in outcome.text
    assert link.commands[-2:] == ["stop_run", "disconnect"]
