"""The sums of a score sheet in a line."""

from roah_rsbb.wording.sheet_sums import Group, sums_text


def test_sums_by_group_and_what_was_not_attempted():
    groups = [Group("Achievements", [1, 4, 0], 1), Group("Empty", [], 0), Group("Penalized", [2], 0)]
    assert sums_text(groups) == "Achievements 5 (1 not attempted) · Penalized 2"


def test_nothing_to_score_is_no_text():
    assert sums_text([]) == ""
