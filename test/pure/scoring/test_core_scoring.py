"""The score sheet of a run, and its history: values that are set, and marks that add, so that referees who count at
once lose nothing; marks with an identity apply once."""

from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.competition import BUMPS, DOOR, OBJECTS, SCORING, UTC0
from helpers.examples import examples
from roah_rsbb.model.as_json import from_json, to_json
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.records import TakenMarks
from roah_rsbb.model.rules import ItemChoice
from roah_rsbb.model.scoring import ScoreKind, ScoringItem
from roah_rsbb.scoring import sheet as sheets
from roah_rsbb.scoring.sheet import (
    MAX_ENTRIES,
    MAX_MARKS,
    MAX_NOTED,
    MAX_VALUE,
    ONE_ENTRY_S,
    Mark,
    ScoreSheet,
    SheetState,
)


class Referee:
    """Marks a sheet; each mark comes `pause` seconds after the one before."""

    def __init__(self, items=SCORING, pause=60.0):
        self.items = items
        self.sheet = ScoreSheet(items)
        self.now = Now(1000.0, UTC0)
        self.pause = pause

    def set(self, item, value=0, who="Anna", pause=None, **fields):
        """Mark an item; `fields` of a Mark, or `correction`."""
        correction = fields.pop("correction", False)
        self.now = self.now.later(self.pause if pause is None else pause)
        return self.sheet.set(self.now, who, Mark(*item.key, value, **fields), correction)

    def add(self, item, added=1, who="Anna", **fields):
        self.set(item, 0, who, added=str(added), **fields)

    def withdraw(self, number, who="Ben", note="", correction=False):
        self.now = self.now.later(self.pause)
        return self.sheet.withdraw(self.now, who, number, note, correction)

    def restart(self):
        self.sheet = again(self.sheet, self.items)

    def item(self, item):
        return self.sheet.item(*item.key)

    def value(self, item):
        """Its value as it is shown; "-": not attempted."""
        record = self.item(item)
        return "-" if record.not_attempted else record.text or record.value

    def entries(self, *fields):
        """These fields of all entries."""
        return [tuple(getattr(entry, field) for field in fields) for entry in self.sheet.history]


def again(sheet, items):
    """The sheet after a restart."""
    return ScoreSheet(items, from_json(SheetState, to_json(sheet.state)))


@pytest.fixture
def referee():
    return Referee()


def _values(sheet):
    return [[value for _, value in group.items] for group in sheet.groups()]


# -- items and values -------------------------------------------------------------------------------


def test_items_come_in_their_groups_and_order_and_begin_at_0(referee):
    assert [(g.name, [item for item, _ in g.items]) for g in referee.sheet.groups()] == [
        ("Achievements", [DOOR, OBJECTS]), ("Penalized", [BUMPS])
    ]
    assert _values(referee.sheet) == [[0, 0], [0]]
    assert [(i.desc, i.kind, i.value, i.not_attempted, i.corrected) for i in referee.sheet.items()] == [
        (DOOR.desc, "bool", 0, False, False), (OBJECTS.desc, "uint", 0, False, False),
        (BUMPS.desc, "uint", 0, False, False),
    ]


def test_a_value_is_set_and_how_the_item_stood_is_returned(referee):
    assert referee.set(DOOR, 1).value == 0
    assert referee.set(BUMPS, 3).value == 0
    assert referee.set(BUMPS, 2).value == 3
    assert _values(referee.sheet) == [[1, 0], [2]]


@pytest.mark.parametrize("item, value", [(DOOR, 0), (DOOR, 1), (OBJECTS, 0), (OBJECTS, MAX_VALUE)])
def test_values_that_are_taken(referee, item, value):
    referee.set(item, value)
    assert referee.value(item) == value


@pytest.mark.parametrize("group, desc, value, reason", [
    ("Achievements", DOOR.desc, 2, "is yes or no: its value must be 0 or 1, not 2"),
    ("Achievements", DOOR.desc, -1, "is yes or no"),
    ("Achievements", OBJECTS.desc, -1, "its value must be 0 or more, not -1"),
    ("Achievements", OBJECTS.desc, MAX_VALUE + 1, "its value must be"),
    ("Achievments", DOOR.desc, 1, "no scoring group 'Achievments': did you mean 'Achievements'?"),
    ("Penalized", "bump", 1, "no scoring item 'bump' in group 'Penalized': did you mean 'bumps'?"),
    ("Penalized", DOOR.desc, 1, "no scoring item 'detects the door' in group 'Penalized'"),
    ("xyz", "", 1, "no scoring group 'xyz': there is 'Achievements', 'Penalized'"),
])
def test_a_refused_request_changes_nothing(referee, group, desc, value, reason):
    with pytest.raises(Refused) as refused:
        referee.set(ScoringItem(group, desc, ScoreKind.UINT), value)
    assert reason in str(refused.value)
    assert _values(referee.sheet) == [[0, 0], [0]]
    assert referee.sheet.history == ()


def test_a_benchmark_without_items():
    referee = Referee(())
    assert (referee.sheet.groups(), referee.sheet.items()) == ((), ())
    with pytest.raises(Refused, match="no scoring items"):
        referee.set(BUMPS, 1)


# -- history ----------------------------------------------------------------------------------------


def test_each_change_has_who_when_and_both_values(referee):
    referee.set(BUMPS, 1, who="Anna")
    then = referee.now.utc
    referee.set(BUMPS, 3, who="Ben", note="the vase, too")
    assert referee.entries("number", "who", "desc", "old", "value", "note", "correction") == [
        (1, "Anna", "bumps", 0, 1, "", False), (2, "Ben", "bumps", 1, 3, "the vase, too", False)
    ]
    assert referee.entries("utc") == [(then,), (then + 60.0,)]


def test_a_score_without_change_is_an_entry_only_with_a_note(referee):
    referee.set(BUMPS, 0)
    assert referee.sheet.history == ()
    referee.set(BUMPS, 0, note="watched the video: no bump")
    assert referee.entries("old", "value", "note") == [(0, 0, "watched the video: no bump")]


def test_not_attempted_is_not_0_and_a_value_takes_the_mark_away(referee):
    referee.set(OBJECTS, 2)
    referee.set(OBJECTS, 7, not_attempted=True)
    assert referee.value(OBJECTS) == "-"
    assert referee.set(OBJECTS, 0).not_attempted
    assert referee.value(OBJECTS) == 0
    assert referee.entries("old", "old_not_attempted", "value", "not_attempted") == [
        (0, False, 2, False), (2, False, 0, True), (0, True, 0, False)
    ]


def test_one_entry_is_withdrawn_without_touching_the_others(referee):
    referee.set(DOOR, 1)
    for value in (1, 2, 3):
        referee.set(BUMPS, value)
    assert referee.withdraw(3, who="Ben", note="wrong robot").value == 2
    assert _values(referee.sheet) == [[1, 0], [3]]
    referee.withdraw(4)
    assert _values(referee.sheet) == [[1, 0], [1]]
    referee.withdraw(2)
    assert _values(referee.sheet) == [[1, 0], [0]]
    assert referee.entries("number", "value", "withdrawn_by", "withdrawn_note") == [
        (1, 1, "", ""), (2, 1, "Ben", ""), (3, 2, "Ben", "wrong robot"), (4, 3, "Ben", "")
    ]
    assert [entry.withdrawn_utc > entry.utc for entry in referee.sheet.history] == [False, True, True, True]


def test_withdrawing_a_mark_of_not_attempted_gives_the_value_back(referee):
    referee.set(OBJECTS, 2)
    referee.set(OBJECTS, not_attempted=True)
    referee.withdraw(2)
    assert referee.value(OBJECTS) == 2


def test_only_an_entry_that_counts_is_withdrawn(referee):
    with pytest.raises(Refused, match="no entry 1: no entry can be withdrawn"):
        referee.withdraw(1)
    referee.set(BUMPS, 1)
    referee.set(DOOR, 1)
    referee.withdraw(1, who="Ben")
    with pytest.raises(Refused, match="entry 1 was withdrawn already, by Ben"):
        referee.withdraw(1)
    with pytest.raises(Refused, match="no entry 7: choose from 2$"):
        referee.withdraw(7)


# -- corrections ------------------------------------------------------------------------------------


def test_an_item_is_corrected_while_it_differs_from_the_end_of_the_run(referee):
    referee.set(BUMPS, 1)
    referee.set(BUMPS, 2)
    assert not referee.item(BUMPS).corrected
    referee.set(BUMPS, 5, correction=True)
    assert (referee.value(BUMPS), referee.item(BUMPS).corrected, referee.item(DOOR).corrected) == (5, True, False)
    referee.withdraw(3, correction=True)
    assert (referee.value(BUMPS), referee.item(BUMPS).corrected) == (2, False)
    referee.withdraw(1, correction=True)
    assert (referee.value(BUMPS), referee.item(BUMPS).corrected) == (2, False)
    referee.withdraw(2, correction=True)
    assert (referee.value(BUMPS), referee.item(BUMPS).corrected) == (0, True)


def test_a_withdrawal_during_the_run_is_not_a_correction(referee):
    referee.set(BUMPS, 1)
    referee.withdraw(1)
    assert not referee.item(BUMPS).corrected


# -- how much is kept -------------------------------------------------------------------------------


def test_changes_of_one_moment_by_one_person_are_one_entry():
    referee = Referee(pause=ONE_ENTRY_S / 10)
    for value in (1, 2, 3):
        referee.set(BUMPS, value)
        referee.set(OBJECTS, value)
    assert referee.entries("number", "desc", "old", "value") == [(1, "bumps", 0, 3), (2, "changed objects", 0, 3)]
    referee.set(BUMPS, 4, pause=ONE_ENTRY_S)
    assert referee.entries("desc", "old", "value")[2:] == [("bumps", 3, 4)]


def test_a_moment_is_counted_from_its_first_change():
    referee = Referee(pause=ONE_ENTRY_S * 0.6)
    for value in (1, 2, 3, 4):
        referee.set(BUMPS, value)
    assert referee.entries("old", "value") == [(0, 2), (2, 4)]


def test_a_slip_undone_at_once_is_not_an_entry():
    referee = Referee(pause=0.1)
    referee.set(BUMPS, 1)
    referee.set(BUMPS, 0)
    assert referee.sheet.history == ()
    referee.set(BUMPS, not_attempted=True)
    assert referee.entries("value", "not_attempted") == [(0, True)]


@pytest.mark.parametrize("first, second", [
    ({}, {"who": "Ben"}), ({}, {"note": "really"}), ({"note": "really"}, {}), ({}, {"correction": True}),
    ({}, {"not_attempted": True}), ({"not_attempted": True}, {}),
])
def test_what_matters_is_an_entry_of_its_own(first, second):
    referee = Referee(pause=0.1)
    referee.set(BUMPS, 1, **first)
    referee.set(BUMPS, 2, **second)
    assert len(referee.sheet.history) == 2


def test_a_withdrawn_entry_is_not_changed_any_more():
    referee = Referee(pause=0.1)
    referee.set(BUMPS, 1)
    referee.withdraw(1)
    referee.set(BUMPS, 2)
    assert [(e.value, bool(e.withdrawn_utc)) for e in referee.sheet.history] == [(1, True), (2, False)]


@pytest.mark.long
def test_wild_clicking_grows_nothing_and_loses_nothing_that_matters():
    referee = Referee()
    referee.set(DOOR, 1, note="through the window")
    referee.set(BUMPS, 77, who="Ben")
    for i in range(1000):
        referee.set(OBJECTS, i % 2 + 1, who="Anna")
    referee.set(BUMPS, 78)
    for i in range(1000):
        referee.set(OBJECTS, 10 + i % 2, correction=True)
    assert len(referee.sheet.history) <= MAX_ENTRIES + 2 * len(SCORING)
    values = {entry.value for entry in referee.sheet.history if entry.desc == OBJECTS.desc}
    assert values - {1} == {2, 10, 11}  # 2: how it stood when the run was over
    assert referee.entries("desc", "who", "note")[0] == (DOOR.desc, "Anna", "through the window")
    assert {(BUMPS.desc, 0, 77), (BUMPS.desc, 77, 78)} <= set(referee.entries("desc", "old", "value"))
    olds = [entry.old for entry in referee.sheet.history if entry.desc == OBJECTS.desc]
    assert olds[1:] == [entry.value for entry in referee.sheet.history if entry.desc == OBJECTS.desc][:-1]
    assert _values(referee.sheet) == [[1, 11], [78]]


@pytest.mark.long
def test_it_is_the_oldest_that_is_left_out():
    referee = Referee()
    for i in range(1000):
        referee.set(OBJECTS, i + 1)
    assert [value for (value,) in referee.entries("value")][-100:] == list(range(901, 1001))


@pytest.mark.long
def test_entries_of_two_people_stay_longer_than_those_of_one():
    referee = Referee()
    for i in range(50):
        referee.set(BUMPS, i + 1, who=("Anna", "Ben")[i % 2])
    for i in range(1000):
        referee.set(OBJECTS, i % 2 + 1)
    assert len([entry for entry in referee.sheet.history if entry.desc == BUMPS.desc]) == 50
    for i in range(1000):
        referee.set(OBJECTS, i % 2 + 1, who=("Anna", "Ben")[i % 2])
    assert len(referee.sheet.history) <= MAX_ENTRIES + 2 * len(SCORING)


@pytest.mark.long
def test_notes_and_withdrawals_are_bounded_and_leave_room_for_values(referee):
    for i in range(MAX_NOTED):
        referee.set(BUMPS, i + 1, note=f"bump {i + 1}")
    with pytest.raises(Refused, match="set the value without a note"):
        referee.set(BUMPS, 0, note="again")
    referee.set(BUMPS, 500)
    with pytest.raises(Refused, match="set the value instead"):
        referee.withdraw(MAX_NOTED + 1)
    referee.withdraw(1)  # it is among those that are kept in any case
    for i in range(1000):
        referee.set((BUMPS, OBJECTS)[i % 2], i + 1)
    assert len(referee.sheet.history) <= MAX_ENTRIES + 2 * len(SCORING)
    assert [e.note for e in referee.sheet.history if e.note] == [f"bump {i + 1}" for i in range(MAX_NOTED)]


# -- restart ----------------------------------------------------------------------------------------


def test_items_that_came_or_went_since_raise_nothing_and_the_history_stays(referee):
    referee.set(DOOR, 1)
    referee.set(OBJECTS, 2)
    new = ScoringItem("Achievements", "new", ScoreKind.UINT)
    fresh = again(referee.sheet, (OBJECTS, new))
    assert fresh.history == referee.sheet.history
    assert [(item.desc, item.value) for item in fresh.items()] == [("changed objects", 2), ("new", 0)]
    fresh.withdraw(referee.now, "Ben", 1)
    fresh.set(referee.now, "Ben", Mark("Achievements", "new", 4))
    assert [item.value for item in fresh.items()] == [2, 4]


CUPS = ScoringItem("Table", "cups", ScoreKind.UINT, most=Decimal(3))
HEIGHT = ScoringItem("Table", "height", ScoreKind.INT, least=Decimal(-2), most=Decimal(2))
WATER = ScoringItem("Table", "water", ScoreKind.DECIMAL, least=Decimal(0), most=Decimal(10))
HELP = ScoringItem("Table", "help", ScoreKind.CHOICE, choices=(ItemChoice("none"), ItemChoice("some")))
SHOW = ScoringItem("Table", "show", ScoreKind.RATING, judges=("Anna", "Ben"))
ITEMS = (BUMPS, DOOR, CUPS, HEIGHT, WATER, HELP, SHOW)


@pytest.fixture
def referees():
    return Referee(ITEMS)


# -- adding -----------------------------------------------------------------------------------------


def test_two_referees_who_count_at_once_lose_nothing():
    referees = Referee(ITEMS, 0.05)
    for _ in range(10):
        referees.add(BUMPS, who="Anna")
        referees.add(BUMPS, who="Ben")
    assert referees.value(BUMPS) == 20
    for who in ("Anna", "Ben"):
        assert sum(int(added) for by, added in referees.entries("who", "added") if by == who) == 10


def test_each_entry_has_what_was_added_and_both_values(referees):
    referees.add(BUMPS, role="referee", device="phone 3")
    referees.add(BUMPS, "+2", who="Ben")
    referees.set(BUMPS, 7)
    assert referees.entries("who", "role", "device", "added", "old", "value") == [
        ("Anna", "referee", "phone 3", "1", 0, 1), ("Ben", "", "", "2", 1, 3), ("Anna", "", "", "", 3, 7)]


def test_decimals_are_added_exactly(referees):
    for added in ("0,1", ".2", "+1.005"):
        referees.add(WATER, added)
    assert (referees.value(WATER), referees.item(WATER).value) == ("1.305", 1)
    referees.withdraw(1)
    assert referees.value(WATER) == "1.205"


def test_changes_of_one_moment_are_one_entry_and_a_slip_is_none():
    referees = Referee(ITEMS, 0.1)
    for number in range(3):
        referees.add(BUMPS, id=f"up {number}")
    assert (referees.entries("number", "old", "added", "value"), referees.value(BUMPS)) == ([(1, 0, "3", 3)], 3)
    for number in range(3):
        referees.add(BUMPS, -1, id=f"down {number}")
    assert (referees.sheet.history, referees.value(BUMPS)) == ((), 0)
    referees.add(CUPS, id="other")
    assert list(referees.sheet.marks.entries.items()) == [
        ("up 0", 0), ("up 1", 0), ("up 2", 0), ("down 0", 0), ("down 1", 0), ("down 2", 0), ("other", 2)]
    assert referees.sheet.marks.last == 2


@pytest.mark.parametrize("first, second", [
    ({}, {"who": "Ben"}), ({}, {"device": "phone"}), ({"role": "judge"}, {"role": "referee"}), ({}, {"note": "n"}),
    ({}, {"correction": True}),
])
def test_what_matters_is_an_entry_of_its_own_also_when_it_is_counted(first, second):
    referees = Referee(ITEMS, 0.1)
    referees.add(BUMPS, **first)
    referees.add(BUMPS, **second)
    referees.set(BUMPS, 9)
    assert len(referees.sheet.history) == 3


def test_a_mark_that_sets_is_taken_back_alone_and_once():
    referees = Referee(ITEMS, 0.1)
    for number in (1, 2):
        referees.set(CUPS, number, id=f"mark {number}")
    referees.set(CUPS, 3)
    assert referees.entries("number", "value") == [(1, 1), (2, 2), (3, 3)]
    referees.withdraw(3)
    assert referees.sheet.take_back(referees.now, "Anna", "mark 2").number == 2
    assert referees.sheet.take_back(referees.now, "Anna", "mark 2") is None, "it arrived again"
    assert (referees.value(CUPS), len(referees.sheet.history)) == (1, 3)


def test_a_number_of_an_entry_is_not_used_again():
    """A withdrawal that arrives late would meet another mark."""
    referees = Referee(ITEMS, 0.1)
    referees.set(CUPS, 1)
    referees.set(CUPS, 0)
    assert referees.sheet.history == ()
    referees.set(CUPS, 2)
    with pytest.raises(Refused, match="the score sheet has no entry 1"):
        referees.withdraw(1)
    assert referees.value(CUPS) == 2


def test_a_number_is_not_used_again_after_a_restart_or_the_end_of_the_run():
    referees = Referee(ITEMS, 0.1)
    referees.add(BUMPS, id="slip")
    referees.add(BUMPS, -1, id="undone")
    again = ScoreSheet(ITEMS, SheetState(list(referees.sheet.history), referees.sheet.marks))
    again.set(referees.now, "Anna", Mark(*CUPS.key, 2, id="other"))
    assert [entry.number for entry in again.history] == [2]
    assert again.set(referees.now, "Anna", Mark(*CUPS.key, 1)).value == 2  # a mark without identity is applied


def test_only_a_mark_with_its_own_entry_is_taken_back():
    referees = Referee(ITEMS, 0.1)
    referees.add(BUMPS, id="one")
    referees.add(BUMPS, id="two")
    referees.set(CUPS, 0, id="no change")
    for mark_id, why in (("one", "added to its item"), ("no change", "has no entry"), ("none", "was not applied")):
        with pytest.raises(Refused, match=why):
            referees.sheet.take_back(referees.now, "Anna", mark_id)
    assert referees.value(BUMPS) == 2


def test_the_id_of_a_mark_of_another_item_is_refused():
    """The mark would be lost without a word."""
    referees = Referee(ITEMS, 0.1)
    referees.add(BUMPS, id="one")
    with pytest.raises(Refused, match="the id 'one' was used for 'bumps': give each mark a new UUID"):
        referees.add(CUPS, id="one")
    referees.add(BUMPS, id="one")
    assert (referees.value(BUMPS), referees.value(CUPS)) == (1, 0)


def test_an_item_is_corrected_if_something_was_added_or_withdrawn_after_the_end(referees):
    referees.add(BUMPS)
    referees.add(BUMPS, who="Ben")
    assert not referees.item(BUMPS).corrected
    referees.add(BUMPS, correction=True)
    assert referees.item(BUMPS).corrected
    referees.withdraw(3, correction=True)
    assert not referees.item(BUMPS).corrected
    referees.withdraw(1, correction=True)
    assert (referees.value(BUMPS), referees.item(BUMPS).corrected) == (1, True)


# -- limits -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("item, start, added, why", [
    (CUPS, 3, "1", "'cups' is a count: its value must be from 0 to 3, not 4"),
    (CUPS, 0, "-1", "'cups' is a count: its value must be from 0 to 3, not -1"),
    (HEIGHT, -2, "-1", "'height' is a whole number: its value must be from -2 to 2, not -3"),
    (BUMPS, 0, "-1", "'bumps' is a count: its value must be 0 or more, not -1"),
    (BUMPS, 2**31 - 1, "1", "its value must be 0 or more, not 2147483648"),
    (BUMPS, 0, "0", "'bumps' cannot be changed by '0': give a number such as +1 or -1"),
    (BUMPS, 0, "one", "'bumps' cannot be changed by 'one'"),
    (BUMPS, 0, "1.5", "'bumps' is counted in whole numbers, not by '1.5'"),
    (WATER, 0, "10.5", "'water' takes a number from 0 to 10 with at most 3 decimals, not '10.5'"),
    (WATER, 0, "nan", "'water' cannot be changed by 'nan'"),
    (DOOR, 0, "1", "'detects the door' cannot be counted: set its value"),
    (HELP, 0, "1", "'help' cannot be counted: set its value"),
    (SHOW, 0, "1", "'show' cannot be counted: set its value"),
])
def test_a_count_beyond_the_limits_is_refused_and_changes_nothing(referees, item, start, added, why):
    if start:
        referees.set(item, start)
    before = referees.sheet.history, referees.value(item)
    with pytest.raises(Refused) as refused:
        referees.add(item, added, id="a mark")
    assert why in str(refused.value)
    assert (referees.sheet.history, referees.value(item)) == before
    assert referees.sheet.taken("a mark") is None


def test_a_withdrawal_on_which_later_counts_depend_is_refused(referees):
    referees.set(HEIGHT, 2)
    referees.add(HEIGHT, -3)
    referees.add(HEIGHT, -1)
    before = referees.sheet.history
    with pytest.raises(Refused) as refused:
        referees.withdraw(1)
    assert str(refused.value) == (
        "entry 1 cannot be withdrawn, because later entries count from it: without it, 'height' is a whole number: its "
        "value must be from -2 to 2, not -4. Withdraw those first, or set the value")
    assert (referees.sheet.history, referees.value(HEIGHT)) == (before, -2)
    referees.withdraw(3)
    referees.withdraw(2)
    referees.withdraw(1)
    assert referees.value(HEIGHT) == 0


# -- how much is kept -------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize("many, noted", [(1000, 0), (300, MAX_NOTED)])
def test_wild_counting_grows_nothing_and_loses_no_count(many, noted):
    referees = Referee(ITEMS)
    referees.set(BUMPS, 5)
    for number in range(noted):
        referees.add(BUMPS, note=f"bump {number}")
    for number in range(many):
        referees.add(BUMPS, 1, who=("Anna", "Ben", "Cleo")[number % 3], correction=number > many // 2)
        if number == many // 2:
            referees.set(CUPS, 2)
    assert len(referees.sheet.history) <= MAX_ENTRIES + 2 * (len(ITEMS) + 2)
    assert (referees.value(BUMPS), referees.value(CUPS)) == (5 + noted + many, 2)
    assert again(referees.sheet, ITEMS).items() == referees.sheet.items()


def test_entries_that_are_joined_for_lack_of_room_change_the_item_as_both_did(referees, monkeypatch):
    monkeypatch.setattr(sheets, "MAX_ENTRIES", -2 * referees.sheet._places + 1)
    referees.set(BUMPS, 5)
    for number in range(3):
        referees.add(BUMPS, 2, id=f"mark {number}")
    assert referees.entries("number", "old", "value", "added") == [(3, 0, 9, ""), (4, 9, 11, "2")]
    assert (referees.value(BUMPS), referees.sheet.marks) == (
        11, TakenMarks({"mark 0": 3, "mark 1": 3, "mark 2": 4}, 4))
    referees.set(BUMPS, not_attempted=True)
    referees.add(BUMPS, 3)
    assert (referees.value(BUMPS), referees.item(BUMPS).not_attempted) == (3, False)


# -- any order --------------------------------------------------------------------------------------

STEPS = st.lists(st.one_of(
    st.tuples(st.just("add"), st.integers(-3, 3).filter(bool), st.sampled_from(["Anna", "Ben"])),
    st.tuples(st.just("set"), st.integers(0, 5), st.sampled_from(["Anna", "Ben"])),
    st.tuples(st.just("not attempted"), st.just(0), st.just("Anna")),
    st.tuples(st.just("withdraw"), st.integers(1, 12), st.just("Cleo")),
    st.tuples(st.just("restart"), st.just(0), st.just("")),
), max_size=15)


@examples(300)
@given(STEPS, st.sampled_from([0.3, 60.0]))
def test_the_value_is_the_last_one_set_and_what_was_added_since(steps, pause):
    referees = Referee(ITEMS, pause)
    for what, number, who in steps:
        try:
            if what == "add":
                referees.add(BUMPS, number, who)
            elif what == "set":
                referees.set(BUMPS, number, who)
            elif what == "not attempted":
                referees.set(BUMPS, not_attempted=True)
            elif what == "withdraw":
                referees.withdraw(number)
            else:
                referees.restart()
        except Refused:
            pass
        expected = 0
        for entry in referees.sheet.history:
            if not entry.withdrawn_utc:
                added = int(entry.added or 0)
                expected = (0 if expected == "-" else expected) + added if entry.added else (
                    "-" if entry.not_attempted else entry.value)
        assert referees.value(BUMPS) == expected
        assert expected == "-" or expected >= 0


# -- identities -------------------------------------------------------------------------------------


def test_a_mark_is_applied_once_also_after_a_withdrawal_and_a_restart(referees):
    for _ in range(3):
        referees.add(BUMPS, id="one")
        referees.set(DOOR, 1, id="two")
        referees.set(DOOR, 0, who="Ben", id="three")
        referees.restart()
    assert (referees.value(BUMPS), referees.value(DOOR), len(referees.sheet.history)) == (1, 0, 3)
    referees.withdraw(1)
    referees.add(BUMPS, id="one")
    assert referees.value(BUMPS) == 0
    assert referees.sheet.taken("one") == 1


def test_a_mark_without_an_identity_counts_each_time(referees):
    for _ in range(2):
        referees.add(BUMPS)
    assert (referees.value(BUMPS), referees.sheet.marks.entries, referees.sheet.taken("")) == (2, {}, None)


def test_a_mark_that_changes_nothing_is_known_too(referees):
    referees.set(BUMPS, 0, id="no change")
    referees.set(BUMPS, 4)
    referees.set(BUMPS, 0, id="no change")
    assert (referees.value(BUMPS), referees.sheet.taken("no change")) == (4, 0)


@pytest.mark.long
def test_a_number_is_not_used_again_however_many_marks_followed_without_an_entry():
    referees = Referee(ITEMS, 0.1)
    referees.add(BUMPS, id="slip")
    referees.add(BUMPS, -1, id="undone")
    for number in range(MAX_MARKS + 5):
        referees.set(CUPS, 0, id=str(number))
    referees.restart()
    referees.add(BUMPS)
    assert referees.entries("number") == [(2,)]


@pytest.mark.long
def test_the_newest_identities_are_kept(referees):
    for number in range(MAX_MARKS + 5):
        referees.add(BUMPS, id=str(number))
    assert list(referees.sheet.marks.entries) == [str(number) for number in range(5, MAX_MARKS + 5)]
    assert [referees.sheet.taken(mark_id) is None for mark_id in ("4", "5")] == [True, False]
    assert again(referees.sheet, ITEMS).taken("5") == referees.sheet.taken("5")
