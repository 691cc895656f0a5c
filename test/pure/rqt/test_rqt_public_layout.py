"""The positions of the texts of the public display."""

import pytest

from roah_rsbb.rqt.public import layout
from roah_rsbb.rqt.public.layout import Rect, Screen


def _fits(letters):
    return lambda text: len(text) <= letters


@pytest.mark.parametrize("parts, lines", [
    ((), ()), (("a", "b"), ("a · b",)), (("aaaa", "bbbb", "cc"), ("aaaa", "bbbb · cc")),
    (("one two three four",), ("one two", "three four")), (("", "a"), ("a",)),
    (("x" * 25,), ("x" * 10, "x" * 10, "x" * 5)), (("ab " + "x" * 12 + " c",), ("ab", "x" * 10, "xx c")),
])
def test_scores_take_as_many_lines_as_they_need(parts, lines):
    assert layout.wrapped(parts, _fits(10)) == lines


@pytest.mark.long
def test_hostile_scores_end():
    lines = layout.wrapped(["=cmd" * 500, "\u202e" * 99], _fits(0))
    assert "".join(lines) == "=cmd" * 500 + "\u202e" * 99, "also where not a single letter fits"


@pytest.mark.parametrize("high", [0.16, 0.25, 0.4, 0.8])
def test_pages_of_blocks_lose_nothing_and_are_not_too_high(high):
    blocks = [layout.Block(row, tuple(f"{row}.{n}" for n in range(row % 7))) for row in range(30)]
    pages = layout.filled(blocks, high)
    assert all(sum(block.height for block in page) <= high + 1e-6 for page in pages)
    assert {block.row for page in pages for block in page} == set(range(30))
    assert [line for page in pages for block in page for line in block.lines] == [
        line for block in blocks for line in block.lines]
    assert len(pages) > 1
    assert layout.filled([], high) == [()]


def test_a_page_that_is_too_small_has_a_line_nevertheless():
    pages = layout.filled([layout.Block(0, ("a", "b"))], 0.01)
    assert [block.lines for page in pages for block in page] == [("a",), ("b",)]

@pytest.mark.parametrize("count, expected", [(0, [0]), (1, [1]), (6, [6]), (7, [4, 3]), (20, [5, 5, 5, 5])])
def test_pages_are_even_and_lose_nothing(count, expected):
    pages = layout.pages(list(range(count)), 6)
    assert [len(page) for page in pages] == expected
    assert [item for page in pages for item in page] == list(range(count))


@pytest.mark.parametrize("size", [(1280, 720), (1920, 1080), (3840, 2160), (1024, 768), (2560, 1080)])
@pytest.mark.parametrize("count", range(layout.CARDS_ON_A_PAGE + 1))
def test_nothing_overlaps_and_there_is_room_for_what_follows(size, count):
    screen = Screen(*size)
    cards = screen.cards(count)
    below = screen.below(cards)
    places = [screen.head(), *cards, below]
    for i, one in enumerate(places):
        assert one.x >= 0 and one.y >= 0 and one.right <= size[0] and one.bottom <= size[1] + 1e-6
        for other in places[i + 1:]:
            assert (one.right <= other.x or other.right <= one.x
                    or one.bottom <= other.y + 1e-6 or other.bottom <= one.y + 1e-6)
    assert layout.rows_that_fit(below, screen.unit) >= 2
    assert below.h / screen.unit >= layout.TITLE + layout.ROW + layout.SCORES_ROW


@pytest.mark.parametrize("parts", [layout.wide_card, layout.flat_card, layout.narrow_card])
def test_the_parts_of_a_card_do_not_overlap(parts):
    inside = Rect(10.0, 20.0, 600.0, 120.0)
    found = parts(inside)
    for i, one in enumerate(found):
        assert one.x >= inside.x and one.right <= inside.right + 1e-6 and one.bottom <= inside.bottom + 1e-6
        for other in found[i + 1:]:
            assert (one.right <= other.x or other.right <= one.x
                    or one.bottom <= other.y + 1e-6 or other.bottom <= one.y + 1e-6)


@pytest.mark.parametrize("size", [(1366, 768), (1920, 1080)])
@pytest.mark.parametrize("count", range(1, layout.CARDS_ON_A_PAGE + 1))
def test_teams_of_runs_are_larger_than_those_that_follow(size, count):
    """Letters fill 0.7 of a card's row and 0.64 of a row below."""
    screen = Screen(*size)
    for place in screen.cards(count):
        edge = 0.12 * place.h
        inside = Rect(place.x + 2 * edge, place.y + edge / 3, place.w - 3 * edge, place.h - 2 * edge / 3)
        team = layout.card_parts(place, inside, screen).team
        assert 0.7 * team.h > 0.64 * layout.ROW * screen.unit
