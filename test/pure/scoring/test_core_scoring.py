"""The score sheet of a run, and its history."""

import pytest

from helpers.competition import BUMPS, DOOR, OBJECTS, SCORING, UTC0
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.saved import freeze, thaw
from roah_rsbb.model.scoring import ScoreKind, ScoringItem
from roah_rsbb.scoring.sheet import MAX_ENTRIES, MAX_NOTED, MAX_VALUE, ONE_ENTRY_S, Mark, ScoreSheet, SheetState


class Referee:
    """Marks a sheet; each mark comes `pause` seconds after the one before."""

    def __init__(self, items=SCORING, pause=60.0):
        self.sheet = ScoreSheet(items)
        self.now = Now(1000.0, UTC0)
        self.pause = pause

    def set(self, item, value=0, who="Anna", pause=None, **fields):
        """Mark an item; `fields` of a Mark, or `correction`."""
        correction = fields.pop("correction", False)
        self.now = self.now.later(self.pause if pause is None else pause)
        return self.sheet.set(self.now, who, Mark(item.group, item.desc, value, **fields), correction)

    def withdraw(self, number, who="Ben", note="", correction=False):
        self.now = self.now.later(self.pause)
        return self.sheet.withdraw(self.now, who, number, note, correction)

    def item(self, item):
        return self.sheet.item(item.group, item.desc)

    def value(self, item):
        return self.item(item).value

    def entries(self, *fields):
        """These fields of all entries."""
        return [tuple(getattr(entry, field) for field in fields) for entry in self.sheet.history]


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
    assert (referee.value(OBJECTS), referee.item(OBJECTS).not_attempted) == (0, True)
    assert referee.set(OBJECTS, 0).not_attempted
    assert (referee.value(OBJECTS), referee.item(OBJECTS).not_attempted) == (0, False)
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
    assert (referee.value(OBJECTS), referee.item(OBJECTS).not_attempted) == (2, False)


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


def _again(sheet, items=SCORING):
    return ScoreSheet(items, thaw(SheetState, freeze(sheet.state)))


def test_a_sheet_is_the_same_after_a_restart(referee):
    referee.set(DOOR, 1, note="late")
    referee.set(BUMPS, 2)
    referee.set(BUMPS, 3)
    referee.set(OBJECTS, not_attempted=True)
    referee.withdraw(3)
    fresh = _again(referee.sheet)
    assert (fresh.history, fresh.items()) == (referee.sheet.history, referee.sheet.items())
    referee.sheet = fresh
    referee.set(BUMPS, 9, pause=0.0)
    assert referee.entries("number", "old", "value")[-1] == (5, 2, 9)


def test_items_that_came_or_went_since_raise_nothing_and_the_history_stays(referee):
    referee.set(DOOR, 1)
    referee.set(OBJECTS, 2)
    new = ScoringItem("Achievements", "new", ScoreKind.UINT)
    fresh = _again(referee.sheet, (OBJECTS, new))
    assert fresh.history == referee.sheet.history
    assert [(item.desc, item.value) for item in fresh.items()] == [("changed objects", 2), ("new", 0)]
    fresh.withdraw(referee.now, "Ben", 1)
    fresh.set(referee.now, "Ben", Mark("Achievements", "new", 4))
    assert [item.value for item in fresh.items()] == [2, 4]
