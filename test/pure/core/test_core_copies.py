"""Warnings about copies of the journal that are behind; and a box from which a standby took over."""

import math
from dataclasses import replace

import pytest

from helpers.box_driver import BoxDriver
from helpers.commands import COMMANDS
from helpers.competition import competition
from roah_rsbb.core import effects
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.continuing import Saved
from roah_rsbb.core.copies import LATE_S, SILENT_S, STANDBY, Copies, CopyReport
from roah_rsbb.core.effects import Level, Outbox
from roah_rsbb.core.views import document
from roah_rsbb.model.actions import ENTRIES
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.rulebook.benchmarks import Durable
from roah_rsbb.rulebook.errors import Place

STICK = "/media/stick"


def at(mono):
    return Now(float(mono), 1e9 + mono)


def report(is_of_this_box=True, behind=0.05, missing=0, trouble=""):
    return CopyReport(STICK, is_of_this_box, behind, missing, trouble)


class Logged(Copies):
    """Copies, and what is logged of them."""

    def __init__(self):
        self._lines = Outbox()
        super().__init__(self._lines)

    def logged(self, change, *arguments):
        """The line after a report, or after another change; None: there is none."""
        self._lines.take()
        change(*arguments)
        return next((line.text for line in self._lines.take()), None)


@pytest.fixture
def copies():
    copies = Logged()
    copies.expect(at(0), STICK)
    return copies


def test_a_complete_copy_is_no_warning(copies):
    for second in range(20):
        assert copies.logged(copies.report, at(second), report()) is None
        assert not copies.warnings(at(second + 0.9))


def test_a_missing_stick_is_logged_once_and_shown_until_it_is_complete_again(copies):
    copies.report(at(1), report())
    logged = [copies.logged(copies.report, at(1 + s), report(behind=s, missing=7000 * s - 1, trouble="no stick"))
              for s in range(1, 10)]
    assert [text for text in logged if text is not None] == [
        f"The copy of the journal ({STICK}) is 3 s, 21 kB behind: no stick"]
    assert copies.warnings(at(11)) == [f"The copy of the journal ({STICK}) is 10 s, 63 kB behind: no stick"]
    assert copies.logged(copies.report, at(12), report()) == f"The copy of the journal ({STICK}) is complete again"
    assert not copies.warnings(at(12))


def test_a_short_trouble_is_no_warning(copies):
    assert copies.logged(copies.report, at(1), report(behind=LATE_S - 0.1, trouble="busy")) is None
    assert not copies.warnings(at(1))


def test_a_copy_that_never_reports(copies):
    assert not copies.warnings(at(LATE_S - 0.1))
    assert "the program that copies it does not report" in copies.warnings(at(LATE_S))[0]


def test_reports_that_end(copies):
    copies.report(at(1), report())
    assert not copies.warnings(at(2))
    assert "does not report" in copies.warnings(at(1 + SILENT_S))[0]


def test_a_journal_that_is_not_copied(copies):
    """The node that copies may have started just now: it does not follow that there is another core."""
    for second in range(1, 5):
        copies.report(at(second), report(is_of_this_box=False))
    assert copies.warnings(at(5))[0].endswith(
        "the journal of this box is not copied yet. If this lasts, the program that copies it has another log_dir: "
        "end it, and the box starts it again")


def test_a_node_that_started_again_and_has_copied_nothing_yet(copies):
    """The copy was complete before, and is not because the node runs."""
    copies.report(at(1), report())
    assert copies.logged(copies.report, at(6), report(behind=math.inf, trouble="no stick")).endswith(
        "is 5 s behind: no stick")
    assert copies.logged(copies.report, at(7), report(behind=math.inf, missing=7)).endswith(
        "is 6 s, 1 kB behind: the copy is being written. If this lasts, its disk or its connection is too slow")


def test_a_slow_stick(copies):
    copies.report(at(10), report(behind=9.0, missing=400_000))
    assert "9 s, 400 kB behind: the copy is being written" in copies.warnings(at(10))[0]


def test_a_copy_that_nobody_expects_is_forgotten_when_it_is_silent():
    copies = Logged()
    copies.report(at(1), report(trouble="no stick"))
    copies.report(at(5), report(behind=9.0, trouble="no stick"))
    assert "no stick" in copies.warnings(at(5))[0]
    assert not copies.warnings(at(5 + SILENT_S))


def test_no_copy_is_expected():
    assert not Logged().warnings(at(100))


def test_referees_see_it_and_the_log_has_it():
    driver = BoxDriver()
    driver.box.copies.expect(driver.now, STICK)
    driver.event(driver.box.copies.report, report(behind=50.0, trouble="no stick"))
    driver.run(LATE_S)
    assert any("no stick" in text for text in driver.box.warnings(driver.now))
    driver.event(driver.box.copies.report, report(behind=50.0, trouble="no stick"))
    assert any("no stick" in text for text in driver.notices(Level.ERROR))
    driver.event(driver.box.copies.report, report())
    assert not driver.box.warnings(driver.now)
    assert driver.notices(Level.INFO)[-1] == f"The copy of the journal ({STICK}) is complete again"


@pytest.mark.parametrize("trouble, warnings", [("", 1), ("not connected", 2)])
def test_every_referee_reads_that_the_standby_was_replaced(trouble, warnings):
    """Whatever else is wrong, and also when one copy is enough. It ends with the reports that say so."""
    driver = BoxDriver()
    driver.box.copies.expect(driver.now, STANDBY)
    notice = "The standby is stranger at 10.0.0.66 now, instead of second at 10.0.0.3"
    said = CopyReport(STANDBY, True, 50.0 if trouble else 0.1, 0, trouble, notice)
    driver.event(driver.box.copies.report, said)
    driver.run(LATE_S)
    driver.event(driver.box.copies.report, said)
    found = driver.box.warnings(driver.now)
    assert len(found) == warnings and found[-1] == notice
    driver.event(driver.box.copies.report, said._replace(notice=""))
    assert notice not in driver.box.warnings(driver.now)


# -- two copies -----------------------------------------------------------------------------------------

TWO = replace(competition(tbm=["HWV"]), durable=Durable.TWO, durable_at=Place("schedule.yaml", 7, 1))
WHAT_TO_DO = "To continue with one computer, delete 'durable: two' in schedule.yaml:7 and reload"
FULL = "the standby reports: the disk is full. Free space for /far"


@pytest.fixture
def standby():
    made = Logged()
    made.expect(at(0), STANDBY)
    made.use(TWO)
    return made


def of_standby(trouble="", is_of_this_box=True, behind=0.05):
    return CopyReport(STANDBY, is_of_this_box, behind, 0, trouble)


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
    standby.ask(12)
    assert standby.logged(standby.give_up, at(2), 11) == standby.warnings(at(2))[0]
    assert standby.warnings(at(2)) == [
        "NOT CONFIRMED: the standby does not have the last entries: the standby did not answer within 2 s. "
        f"{WHAT_TO_DO}"]
    assert standby.logged(standby.give_up, at(2), 12) is None  # logged already
    assert not standby.is_worth_waiting(at(2))
    assert standby.logged(standby.answer, at(3), 11) is None
    assert standby.warnings(at(2))
    assert standby.logged(standby.answer, at(3), 12) == "The standby has all entries again"
    assert not standby.warnings(at(2))
    assert standby.is_worth_waiting(at(2))
    assert standby.answered == 12


def test_a_standby_that_answers_is_connected(standby):
    """Reports come once a second only."""
    standby.report(at(1), of_standby("not connected"))
    standby.ask(1)
    standby.give_up(at(1), 1)
    assert not standby.is_worth_waiting(at(1))
    standby.answer(at(1), 1)
    assert standby.is_worth_waiting(at(1))


def test_late_and_doubled_answers_are_no_news(standby):
    standby.report(at(1), of_standby())
    standby.ask(2)
    assert standby.logged(standby.answer, at(1), 2) is None
    assert standby.logged(standby.answer, at(1), 1) is None
    assert standby.logged(standby.give_up, at(1), 2) is None
    assert not standby.warnings(at(1))


def test_answers_that_nobody_asked_for_do_not_count(standby):
    """A node may still have questions for the core before its restart."""
    standby.answer(at(1), 1000)
    standby.ask(1)
    standby.give_up(at(1), 1)
    assert standby.warnings(at(1))


@pytest.mark.parametrize("why", [
    FULL, "the standby is not connected. It connects by itself: check that it runs, and its cable",
    "no standby is paired yet. Enter on the box: rosrun roah_rsbb standby code --log-dir /log"])
def test_each_reason_is_one_line_with_what_to_do(standby, why):
    """Also before anything is entered, so that a referee knows it."""
    line = f"NOT CONFIRMED: the standby does not have the last entries: {why}. {WHAT_TO_DO}"
    assert standby.logged(standby.report, at(4), of_standby(why, behind=4.0)) == line
    assert standby.warnings(at(4)) == [line]
    standby.ask(1)
    standby.give_up(at(5), 1)
    assert standby.warnings(at(5)) == [line]
    assert standby.logged(standby.report, at(6), of_standby()) == "The copy of the journal (standby) is complete again"
    standby.answer(at(1), 1)
    assert not standby.warnings(at(6))


def test_a_reload_ends_it(standby):
    standby.report(at(4), of_standby(FULL, behind=4.0))
    standby.ask(1)
    standby.give_up(at(4), 1)
    standby.use(replace(TWO, durable=Durable.ONE))
    assert not standby.are_two
    assert standby.warnings(at(4)) == [f"The copy of the journal (standby) is 4 s behind: {FULL}"]


def test_two_copies_need_a_standby():
    driver = BoxDriver(competition(tbm=["HWV"]))
    assert driver.box.reload.off(TWO) == [
        "schedule.yaml:7: 'durable: two' needs a standby: start the box with standby_port:=8083, or delete this line"]
    driver.box.copies.expect(driver.now, STANDBY)
    assert driver.box.reload.off(TWO) == []
    driver.event(driver.box.reload.take, TWO, 1, ["durable: one, now two"], "Olga")
    assert driver.box.copies.are_two
    driver.event(driver.box.reload.take, replace(TWO, durable=Durable.ONE), 2, ["durable: two, now one"], "Olga")
    assert not driver.box.copies.are_two


HOST = "10.0.0.3"
RUN = RunName("tbm")
MARK = {"group": "Achievements", "desc": "Detects the door", "value": 1, "id": "1", "judge": "Ben"}


@pytest.fixture
def driver():
    made = BoxDriver()
    made.executing()
    made.event(lambda now: made.box.authority.supersede(2, 17, HOST))
    return made


def test_it_is_recorded_once(driver):
    driver.event(lambda now: driver.box.authority.supersede(3, 18, HOST))
    assert driver.taken(effects.Superseded) == [effects.Superseded(2, 17, HOST)]


def test_every_panel_shows_it(driver):
    (warning,) = driver.box.warnings(driver.now)
    assert warning.startswith(f"This box is superseded: the box at {HOST}")
    assert driver.box.authority.superseded_by == HOST
    assert document.box_status(driver.box, driver.now) == warning
    assert all(driver.off(command) == [warning] for command in COMMANDS)


def test_panels_offer_no_command_any_more():
    """Also of a run in progress, whose view is kept while nothing happens."""
    driver = BoxDriver()
    driver.executing()
    shown = document.ZoneViews(driver.box)
    assert any(view.is_on("stop") for view in shown.look(driver.now).values())
    driver.event(lambda now: driver.box.authority.supersede(2, 17, HOST))
    assert all(view.off(command) for view in shown.look(driver.now).values() for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_is_refused(driver, command):
    with pytest.raises(Refused, match="has taken over"):
        driver.command(command)


@pytest.mark.parametrize("call", [
    *[lambda box, now, name=name: box.act(now, Target("tbm"), name, "who", MARK if "mark" in name else {})
      for name in ENTRIES],
    lambda box, now: box.scores.stop(now, RUN, "who"),
    lambda box, now: box.act(now, Target("tbm"), "operation"),
    lambda box, now: box.reload.take(now, None, 2, ()),
], ids=(*ENTRIES, "stop", "operation", "reload"))
def test_scores_are_refused(driver, call):
    """They would be lost: the other box does not have them."""
    record = driver.run_in().record(driver.now)
    with pytest.raises(Refused, match="has taken over"):
        driver.event(lambda now: call(driver.box, now))
    assert driver.run_in().record(driver.now)._replace(elapsed_s=0.0) == record._replace(elapsed_s=0.0)


def test_the_runs_do_not_continue(driver):
    """Neither does a run time out, nor is anything sent."""
    state = driver.box_state()
    driver.effects.clear()
    assert driver.box.timers.deadline() is None
    driver.jump(10_000.0)
    driver.event(driver.box.timers.tick)
    assert driver.box_state() == state
    assert driver.effects == []


@pytest.mark.parametrize("by, where", [("", " if its robot does"), (HOST, f" on the box at {HOST}")])
def test_after_a_restart_it_says_where_its_runs_continue(by, where):
    first, second = BoxDriver(), BoxDriver()
    first.executing()
    if by:
        second.box.authority.stay_superseded(by)
    second.event(second.box.restart.resume, Saved(
        second.now.utc, first.box.restart.saved(), {name: zone.saved() for name, zone in first.box.zones.items()}))
    assert second.run_in().state.log.endswith(f": the run continues{where}\n")
    outages = second.run_in().record(second.now).outages
    assert (outages == ()) is bool(by), "on the box that took over, there was none"


def test_after_a_restart_it_is_not_recorded_again():
    driver = BoxDriver()
    driver.effects.clear()
    driver.box.authority.stay_superseded(HOST)
    driver.event(driver.box.timers.tick)
    assert driver.effects == [] and driver.box.authority.is_superseded


def test_it_does_not_ask_for_a_copy_of_its_own_journal(driver):
    driver.effects.clear()
    driver.event(driver.box.copies.report, CopyReport(STANDBY, True, 60.0, 7, "the standby is not connected"))
    assert driver.notices() == []
