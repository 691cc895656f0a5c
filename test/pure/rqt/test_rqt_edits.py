"""A change of the referee is shown until what is published contains it."""

import pytest

from roah_rsbb.rqt.calls import Edits

ITEM, OTHER = ("Achievements", "opens the door"), ("Achievements", "finds Annie")


class Published:
    """What is published."""

    def __init__(self):
        self.number = 1
        self.edits = Edits(lambda number: self.number >= number)


@pytest.fixture(name="published")
def _published():
    return Published()


@pytest.fixture(name="edits")
def _edits(published):
    return published.edits


def test_without_a_change_the_core_is_shown(edits):
    assert edits.value(ITEM, 4) == 4


def test_a_change_is_shown_while_it_waits_whatever_is_published(published, edits):
    assert edits.wish(ITEM, 1) == 1
    assert edits.is_waiting(ITEM)
    assert edits.value(ITEM, 0) == 1
    published.number = 9
    assert edits.value(ITEM, 0) == 1
    assert edits.value(OTHER, 7) == 7


def test_what_was_published_before_the_change_does_not_overwrite_it(published, edits):
    edits.wish(ITEM, 1)
    assert edits.carried_out(ITEM, 3) is None
    assert not edits.is_waiting(ITEM)
    published.number = 2
    assert edits.value(ITEM, 0) == 1
    published.number = 3
    assert edits.value(ITEM, 5) == 5, "another referee's value"
    assert edits.value(ITEM, 6) == 6, "the change is forgotten from then on"


def test_what_the_answer_says_is_shown_until_it_is_published(published, edits):
    edits.wish(ITEM, 1)
    assert edits.carried_out(ITEM, 2, is_now=3) is None  # another referee counted two
    assert edits.value(ITEM, 0) == 3
    published.number = 2
    assert edits.value(ITEM, 4) == 4


def test_an_answer_shows_no_older_wish_while_the_next_call_waits(published, edits):
    edits.wish(ITEM, 1)
    edits.wish(ITEM, 2)
    assert edits.carried_out(ITEM, 2, is_now=1) == 2
    published.number = 2
    assert edits.value(ITEM, 1) == 2


def test_calls_of_one_item_do_not_overtake_each_other(published, edits):
    assert edits.wish(ITEM, 1) == 1
    assert edits.wish(ITEM, 2) is None
    assert edits.wish(ITEM, 3) is None
    assert edits.value(ITEM, 0) == 3
    assert edits.carried_out(ITEM, 2) == 3
    assert edits.is_waiting(ITEM)
    published.number = 2
    assert edits.carried_out(ITEM, 3) is None
    assert edits.value(ITEM, 1) == 3
    published.number = 3
    assert edits.value(ITEM, 3) == 3


def test_a_change_back_and_forth_needs_no_second_call(edits):
    edits.wish(ITEM, 1)
    edits.wish(ITEM, 0)
    edits.wish(ITEM, 1)
    assert edits.carried_out(ITEM, 2) is None


def test_after_a_failed_call_the_field_shows_the_cores_value(edits):
    edits.wish(ITEM, 1)
    edits.failed(ITEM)
    assert edits.value(ITEM, 0) == 0


def test_an_answer_for_another_sheet_changes_nothing(edits):
    edits.wish(ITEM, 1)
    edits.clear()
    assert edits.carried_out(ITEM, 2) is None
    edits.failed(ITEM)
    assert edits.value(ITEM, 0) == 0
