"""Warnings about copies of the journal that are behind."""

import pytest

from helpers.box_driver import BoxDriver
from roah_rsbb.core.clock import Now
from roah_rsbb.core.copies import LATE_S, SILENT_S, STANDBY, Copies, CopyReport
from roah_rsbb.core.effects import Level

STICK = "/media/stick"


def at(mono):
    return Now(float(mono), 1e9 + mono)


def report(is_of_this_box=True, behind=0.05, missing=0, trouble=""):
    return CopyReport(STICK, is_of_this_box, behind, missing, trouble)


@pytest.fixture
def copies():
    copies = Copies()
    copies.expect(at(0), STICK)
    return copies


def test_a_complete_copy_is_no_warning(copies):
    for second in range(20):
        assert copies.report(at(second), report()) is None
        assert not copies.warnings(at(second + 0.9))


def test_a_missing_stick_is_logged_once_and_shown_until_it_is_complete_again(copies):
    copies.report(at(1), report())
    logged = [copies.report(at(1 + s), report(behind=s, missing=7 * s, trouble="no stick")) for s in range(1, 10)]
    assert [text for text in logged if text is not None] == [
        f"The copy of the journal ({STICK}) is 3 s, 21 entries behind: no stick"]
    assert copies.warnings(at(11)) == [f"The copy of the journal ({STICK}) is 10 s, 63 entries behind: no stick"]
    assert copies.report(at(12), report()) == ""
    assert not copies.warnings(at(12))


def test_a_short_trouble_is_no_warning(copies):
    assert copies.report(at(1), report(behind=LATE_S - 0.1, trouble="busy")) is None
    assert not copies.warnings(at(1))


def test_a_copy_that_never_reports(copies):
    assert not copies.warnings(at(LATE_S - 0.1))
    assert "roah_rsbb_backup does not report" in copies.warnings(at(LATE_S))[0]


def test_reports_that_end(copies):
    copies.report(at(1), report())
    assert not copies.warnings(at(2))
    assert "does not report" in copies.warnings(at(1 + SILENT_S))[0]


def test_the_copy_of_another_core(copies):
    for second in range(1, 5):
        copies.report(at(second), report(is_of_this_box=False))
    assert "the journal of another core" in copies.warnings(at(5))[0]


def test_a_slow_stick(copies):
    copies.report(at(10), report(behind=9.0, missing=400))
    assert "9 s, 400 entries behind: it is being written" in copies.warnings(at(10))[0]


def test_a_copy_that_nobody_expects_is_forgotten_when_it_is_silent():
    copies = Copies()
    copies.report(at(1), report(trouble="no stick"))
    copies.report(at(5), report(behind=9.0, trouble="no stick"))
    assert "no stick" in copies.warnings(at(5))[0]
    assert not copies.warnings(at(5 + SILENT_S))


def test_no_copy_is_expected():
    assert not Copies().warnings(at(100))


def test_referees_see_it_and_the_log_has_it():
    driver = BoxDriver()
    driver.box.copies.expect(driver.now, STICK)
    driver.event(driver.box.on_copy_report, report(behind=50.0, trouble="no stick"))
    driver.run(LATE_S)
    assert any("no stick" in text for text in driver.box.warnings(driver.now))
    driver.event(driver.box.on_copy_report, report(behind=50.0, trouble="no stick"))
    assert any("no stick" in text for text in driver.notices(Level.ERROR))
    driver.event(driver.box.on_copy_report, report())
    assert not driver.box.warnings(driver.now)
    assert driver.notices(Level.INFO)[-1] == f"The copy of the journal ({STICK}) is complete again"


# -- answers that wait for the standby ------------------------------------------------------------------


@pytest.fixture
def standby():
    made = Copies()
    made.expect(at(0), STANDBY)
    return made


def of_standby(trouble="", is_of_this_box=True):
    return CopyReport(STANDBY, is_of_this_box, 0.05, 0, trouble)


@pytest.mark.parametrize("reported, is_worth", [
    (None, False), (of_standby(), True), (of_standby("not connected"), False),
    (of_standby(is_of_this_box=False), False)])
def test_only_a_connected_standby_is_waited_for(standby, reported, is_worth):
    if reported is not None:
        standby.report(at(1), reported)
    assert standby.is_worth_waiting(at(2)) is is_worth
    assert not standby.is_worth_waiting(at(1 + SILENT_S))


def test_a_standby_that_does_not_answer_is_waited_for_once(standby):
    standby.report(at(1), of_standby())
    first, second = standby.ask(), standby.ask()
    assert standby.give_up(at(2), first) == standby.warnings(at(2))[0]
    assert "did not answer within 0.5 s" in standby.warnings(at(2))[0]
    assert standby.give_up(at(2), second) is None  # logged already
    assert not standby.is_worth_waiting(at(2))
    assert standby.answer(first) is False
    assert standby.warnings(at(2))
    assert standby.answer(second) is True
    assert not standby.warnings(at(2))
    assert standby.is_worth_waiting(at(2))


def test_a_standby_that_answers_is_connected(standby):
    """Reports come once a second only."""
    standby.report(at(1), of_standby("not connected"))
    number = standby.ask()
    standby.give_up(at(1), number)
    assert not standby.is_worth_waiting(at(1))
    standby.answer(number)
    assert standby.is_worth_waiting(at(1))


def test_late_and_doubled_answers_are_no_news(standby):
    standby.report(at(1), of_standby())
    first, second = standby.ask(), standby.ask()
    assert standby.answer(second) is False
    assert standby.answer(first) is False
    assert standby.give_up(at(1), second) is None
    assert not standby.warnings(at(1))


def test_answers_that_nobody_asked_for_do_not_count(standby):
    """A node may still have questions for the core before its restart."""
    standby.answer(1000)
    standby.give_up(at(1), standby.ask())
    assert standby.warnings(at(1))


def test_a_missing_standby_is_one_warning(standby):
    standby.report(at(1), of_standby("not connected"))
    standby.give_up(at(1), standby.ask())
    (warning,) = standby.warnings(at(1))
    assert "last entries" in warning
    assert "not connected" in warning
    (warning,) = standby.warnings(at(1 + LATE_S))
    assert warning == f"The copy of the journal (standby) is {LATE_S:.0f} s behind: not connected"
