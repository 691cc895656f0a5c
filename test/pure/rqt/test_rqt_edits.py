"""An older message never overwrites the referee's change."""

from roah_rsbb.rqt.model.edits import Edits

ITEM, OTHER = ("Achievements", "opens the door"), ("Achievements", "finds Annie")


def test_without_a_change_the_core_is_shown():
    edits = Edits()
    assert edits.value(ITEM, 4, 100.0) == 4


def test_a_change_is_shown_while_it_waits_whatever_is_published():
    edits = Edits()
    assert edits.wish(ITEM, 1) == 1
    assert edits.is_waiting(ITEM)
    assert edits.value(ITEM, 0, 100.0) == 1
    assert edits.value(ITEM, 0, 900.0) == 1
    assert edits.value(OTHER, 7, 100.0) == 7


def test_a_message_from_before_the_answer_does_not_overwrite():
    edits = Edits()
    edits.wish(ITEM, 1)
    assert edits.carried_out(ITEM, 100.0) is None
    assert not edits.is_waiting(ITEM)
    assert edits.value(ITEM, 0, 99.9) == 1
    # The same, but it looks as if it confirmed the change: it is older all the same.
    assert edits.value(ITEM, 1, 99.9) == 1
    assert edits.value(ITEM, 0, 100.0) == 1


def test_a_message_from_after_the_answer_does_also_with_another_referees_value():
    edits = Edits()
    edits.wish(ITEM, 1)
    edits.carried_out(ITEM, 100.0)
    assert edits.value(ITEM, 5, 100.001) == 5
    assert edits.value(ITEM, 6, 99.0) == 6  # the change is forgotten from then on


def test_what_the_answer_says_is_shown_until_a_later_message_comes():
    edits = Edits()
    edits.wish(ITEM, 1)
    assert edits.carried_out(ITEM, 100.0, is_now=3) is None  # another referee counted two
    assert edits.value(ITEM, 0, 99.9) == 3
    assert edits.value(ITEM, 4, 100.1) == 4


def test_an_answer_shows_no_older_wish_while_the_next_call_waits():
    edits = Edits()
    edits.wish(ITEM, 1)
    edits.wish(ITEM, 2)
    assert edits.carried_out(ITEM, 100.0, is_now=1) == 2
    assert edits.value(ITEM, 1, 100.1) == 2


def test_calls_of_one_item_do_not_overtake_each_other():
    edits = Edits()
    assert edits.wish(ITEM, 1) == 1
    assert edits.wish(ITEM, 2) is None
    assert edits.wish(ITEM, 3) is None
    assert edits.value(ITEM, 0, 100.0) == 3
    assert edits.carried_out(ITEM, 100.0) == 3
    assert edits.is_waiting(ITEM)
    assert edits.carried_out(ITEM, 101.0) is None
    assert edits.value(ITEM, 1, 100.5) == 3
    assert edits.value(ITEM, 3, 101.001) == 3


def test_a_change_back_and_forth_needs_no_second_call():
    edits = Edits()
    edits.wish(ITEM, 1)
    edits.wish(ITEM, 0)
    edits.wish(ITEM, 1)
    assert edits.carried_out(ITEM, 100.0) is None


def test_after_a_failed_call_the_field_shows_the_cores_value():
    edits = Edits()
    edits.wish(ITEM, 1)
    edits.failed(ITEM)
    assert edits.value(ITEM, 0, 100.0) == 0


def test_an_answer_for_another_sheet_changes_nothing():
    edits = Edits()
    edits.wish(ITEM, 1)
    edits.clear()
    assert edits.carried_out(ITEM, 100.0) is None
    edits.failed(ITEM)
    assert edits.value(ITEM, 0, 100.0) == 0


def test_how_late_an_older_message_may_be_is_the_panels_choice():
    edits = Edits(margin_s=5.0)
    edits.wish(ITEM, 1)
    edits.carried_out(ITEM, 100.0)
    assert edits.value(ITEM, 0, 104.9) == 1
    assert edits.value(ITEM, 0, 105.1) == 0
