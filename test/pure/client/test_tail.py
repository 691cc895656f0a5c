"""Following a text of which only the last characters are published."""

from roah_rsbb.client.tail import added


def lines(first, last):
    return "".join(f"12:00:{number:02d} line number {number}\n" for number in range(first, last))


def test_what_was_appended():
    assert added("", "a\n") == "a\n"
    assert added("a\n", "a\nb\n") == "b\n"
    assert added("a\n", "a\n") == ""


def test_what_was_appended_while_the_beginning_went():
    assert added(lines(0, 20), lines(3, 22)) == lines(20, 22)


def test_nothing_new_while_the_beginning_went():
    assert added(lines(0, 20), lines(3, 20)) == ""


def test_another_text():
    assert added(lines(0, 20), lines(40, 60)) is None
    assert added(lines(0, 20), "") is None


def test_an_overlap_of_a_few_characters_is_a_coincidence():
    assert added("abc\nstart\n", "start\nmore\n") is None


def test_a_repeated_line_is_not_taken_for_the_overlap():
    same = "12:00:00 the very same line, long enough to be searched for in the text before\n" * 3
    old = same + lines(0, 20)
    assert added(old, old[len(same) // 3:] + "new\n") == "new\n"
