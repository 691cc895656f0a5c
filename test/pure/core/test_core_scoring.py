"""The score sheet of a run."""

import pytest

from helpers.competition import BUMPS, DOOR, OBJECTS, SCORING
from roah_rsbb.core.refused import Refused
from roah_rsbb.core.scoring import MAX_VALUE, ScoreSheet


@pytest.fixture
def sheet():
    return ScoreSheet(SCORING)


def _values(sheet):
    return [[value for _, value in group.items] for group in sheet.groups()]


def test_items_come_in_their_groups_and_order_and_begin_at_0(sheet):
    assert [(g.name, [item for item, _ in g.items]) for g in sheet.groups()] == [
        ("Achievements", [DOOR, OBJECTS]), ("Penalized", [BUMPS])
    ]
    assert _values(sheet) == [[0, 0], [0]]


def test_a_value_is_set_and_the_old_one_returned(sheet):
    assert sheet.set("Achievements", DOOR.desc, 1) == 0
    assert sheet.set("Penalized", BUMPS.desc, 3) == 0
    assert sheet.set("Penalized", BUMPS.desc, 2) == 3
    assert _values(sheet) == [[1, 0], [2]]


@pytest.mark.parametrize("group, desc, value", [
    ("Achievements", DOOR.desc, 0), ("Achievements", DOOR.desc, 1), ("Achievements", OBJECTS.desc, 0),
    ("Achievements", OBJECTS.desc, MAX_VALUE),
])
def test_values_that_are_taken(sheet, group, desc, value):
    sheet.set(group, desc, value)


@pytest.mark.parametrize("group, desc, value, reason", [
    ("Achievements", DOOR.desc, 2, "is yes or no: its value is 0 or 1, not 2"),
    ("Achievements", DOOR.desc, -1, "is yes or no"),
    ("Achievements", OBJECTS.desc, -1, "its value is 0 or more, not -1"),
    ("Achievements", OBJECTS.desc, MAX_VALUE + 1, "its value is"),
    ("Achievments", DOOR.desc, 1, "no scoring group 'Achievments': did you mean 'Achievements'?"),
    ("Penalized", "bump", 1, "no scoring item 'bump' in group 'Penalized': did you mean 'bumps'?"),
    ("Penalized", DOOR.desc, 1, "no scoring item 'detects the door' in group 'Penalized'"),
    ("xyz", "", 1, "no scoring group 'xyz': there is 'Achievements', 'Penalized'"),
])
def test_what_is_refused_changes_nothing(sheet, group, desc, value, reason):
    with pytest.raises(Refused) as refused:
        sheet.set(group, desc, value)
    assert reason in str(refused.value)
    assert _values(sheet) == [[0, 0], [0]]


def test_a_benchmark_without_items():
    sheet = ScoreSheet(())
    assert sheet.groups() == []
    with pytest.raises(Refused, match="no scoring items"):
        sheet.set("Penalized", "bumps", 1)
