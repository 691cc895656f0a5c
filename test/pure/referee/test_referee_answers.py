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

    def play(self, *acts):
        """Each act: its name and what is given with it."""
        for name, *given in acts:
            getattr(self, name)(*given)


# -- by itself --------------------------------------------------------------------------------------


@pytest.mark.parametrize("answers, acts, given, notes", [
    # Each operation once, with its usual answer, also where an old message comes once more.
    ({}, [("asks", PLACE), ("asks", PLACE), ("asks",), ("asks", AGAIN)], [("operation", 1), ("operation", 2)],
     ["completed without a human referee: Place it", "completed without a human referee: No pose"]),
    # Switches are confirmed when the robot has finished.
    ({}, [("asks", (0,), TO_CONFIRM._replace(to_confirm=False))], [], []),
    ({}, [("asks", (0,), TO_CONFIRM)], [("confirm_switches",)], []),
    # What does not work is tried again.
    *(({"operation": [error, None]}, acts, given, ["completed without a human referee: Place it"] * len(given))
      for error in (Refused(["over"]), NoCore("gone"))
      for acts, given in (([("asks", PLACE)], []), ([("asks", PLACE), ("looks",)], [("operation", 1)]))),
])
def test_operations_are_completed_by_themselves(answers, acts, given, notes):
    table = Table(AutomaticAnswers)
    table.link.answers = {name: list(found) for name, found in answers.items()}
    table.play(*acts)
    assert (table.link.given, table.notes) == (given, notes)


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

PRESS, CHOOSE = "press Enter when it is done", "type try again / skip (Enter: try again)"
WHERE = Choice("place", say("Place"), choices=("the floor", "the chair"))
NAMES = form_of(form("Annie", "Tom", asks_text=True))
FILL_IN = (
    "type a value for each, in this order or as NAME=VALUE: held: Did the robot hold it? (yes / no); "
    "drops: How often did it fall? (0 to 9); place: Where is it now? (table / floor); "
    "pose: Pose of the cup (x y direction, in m and degrees)")
SWITCHES = "type 'switch NUMBER' for each switch that changed, 'damaged NUMBER', and an empty line to confirm"


@pytest.mark.parametrize("acts, given, notes", [
    # Enter completes what is asked, and nothing else.
    ([("types", "", "too early")], [], []),
    ([("asks", PLACE), ("looks", 5)], [], [PRESS]),
    ([("asks", PLACE), ("types", "", ""), ("asks", AGAIN), ("types", "SK")],
     [("operation", 1), ("operation", 2, "skip")], [PRESS, CHOOSE]),
    # An invalid answer is reported, and asked again.
    ([("asks", AGAIN), ("types", "what"), ("looks",), ("types", "skip")], [("operation", 2, "skip")],
     [CHOOSE, "not done: Answer: choose one of try again, skip", CHOOSE]),
    # Answers of each kind; one that is none of the choices is the text of the form.
    ([("asks", WHOM), ("types", "don't know")], [("operation", 1, "don't know")], ["type text (Enter: none)"]),
    ([("asks", WHOM), ("types", "")], [("operation", 1, "")], ["type text (Enter: none)"]),
    ([("asks", numbered(AGAIN, 1)), ("types", "")], [("operation", 1, "")], [CHOOSE]),
    ([("asks", (1, "How high?", MEASURED)), ("types", "1,5")], [("operation", 1, 1.5)], ["type 0 to 2.5 m"]),
    *(([("asks", (1, "Whom?", *NAMES)), ("types", typed)], [("operation", 1, given)],
       ["type Annie / Tom, or another answer (Enter: Annie)"])
      for typed, given in (("tom", "Tom"), ("a man", "a man"), ("", ""))),
    ([("asks", (1, "Where?", WHERE)), ("types", "the", "the c")], [],
     ["type the floor / the chair (Enter: the floor)",
      "not done: 'the' is the beginning of several choices: 'the floor', 'the chair'",
      "type the floor / the chair (Enter: the floor)"]),
    # The form of a module that nobody knows.
    ([("asks", (7, ODD_ASKED, *ODD)), ("types", "yes many"), ("looks",), ("types", "yes drop=2"), ("looks",),
      ("types", "yes 2 pose='1.25 0,40 90' fl")],
     [("operation", 7, True, 2, [1.25, 0.4, pytest.approx(math.pi / 2)], "floor")],
     [FILL_IN, "not done: How often did it fall?: a whole number from 0 to 9 is expected", FILL_IN,
      f"not done: 'drop' is not asked for: {FILL_IN.partition('NAME=VALUE: ')[2]}", FILL_IN]),
    # Switches are entered and confirmed.
    ([("asks", (0,), TO_CONFIRM), ("types", "switch 2", "switch 3", "switch 2", "damaged 1", "damaged two"), ("looks",),
      ("types", "2"), ("looks",), ("types", "", "2")],
     [("switch", 2), ("switch", 3), ("switch", 2), ("damaged", 1), ("confirm_switches",)],
     [SWITCHES, "not done: Number: a whole number from 0 to 255 is expected", SWITCHES,
      "not done: '2' is not asked for", SWITCHES]),
])
def test_operations_are_answered_as_the_referee_types(acts, given, notes):
    table = Table(Typed)
    table.play(*acts)
    assert (table.link.given, table.notes) == (given, notes)


@pytest.mark.parametrize("ahead", [True, False])
def test_what_is_shown_for_a_moment_longer_is_not_asked_again(ahead):
    table = Table(Typed, ahead)
    table.play(("asks", PLACE), ("types", ""), ("asks", PLACE), ("types", ""), ("looks", 3))
    assert len(table.link.given) == len(table.notes) == 1
    table.play(("asks", AGAIN), ("looks", 3))
    assert len(table.notes) == 2
    assert len(table.link.given) == (2 if ahead else 1)


def test_a_script_may_answer_ahead():
    table = Table(Typed, ahead=True)
    table.typed = ["", "skip", ""]
    for operation in (PLACE, AGAIN, numbered(PLACE, 3)):
        table.play(("asks", operation), ("looks", 3), ("asks",))
    assert table.link.given == [("operation", 1), ("operation", 2, "skip"), ("operation", 3)]


def test_another_referee_may_be_quicker():
    table = Table(Typed)
    table.asks(PLACE)
    table.link.answers["operation"] = [Refused(["that manual operation is over"])]
    table.types("")
    assert table.notes[1] == "not done: that manual operation is over"
    table.play(("asks",), ("asks", AGAIN), ("types", ""))
    assert table.link.given == [("operation", 2, "")]


# -- in a run ---------------------------------------------------------------------------------------


def _run(link, operations):
    reported = []
    plan = ScriptPlan("Home A", 20.0, operations=operations)
    outcome = RunScript(link, plan, reported.append).run()
    return outcome, [change.facts["text"] for change in reported if change.kind == "note"]


@pytest.mark.parametrize("operations, given, notes", [
    (Operations.AUTOMATIC, [("operation", 1), ("operation", 2)],
     ["completed without a human referee: Place it", "completed without a human referee: No pose"]),
    (Operations.OTHERS, [], []),
])
def test_a_run_with_manual_operations(operations, given, notes):
    link = FakeLink()
    link.at(3, lambda: link.ask(*PLACE))
    link.at(5, lambda: link.ask(*AGAIN))
    link.at(7, lambda: link.end("completed"))
    outcome, noted = _run(link, operations)
    assert (outcome.status, link.given, noted) == (Exit.OK, given, notes)


def test_a_run_that_needs_a_human_is_left():
    link = FakeLink()
    for number in range(1, 20):
        link.at(2 * number, lambda n=number: link.ask(*numbered(AGAIN, n)))
    outcome, _ = _run(link, Operations.AUTOMATIC)
    assert outcome.status is Exit.NOT_COMPLETED
    assert "asked 10 times in a row: No pose" in outcome.text
    assert link.commands[-2:] == ["stop_run", "disconnect"]
