"""Answers to referees wait for the standby; the core's loop does not."""

import heapq
import itertools
from dataclasses import replace

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import competition
from roah_rsbb.box.standby_answers import StandbyAnswers, wait
from roah_rsbb.core.copies import STANDBY, SYNC_S, CopyReport, unconfirmed
from roah_rsbb.core.effects import Level
from roah_rsbb.rulebook.benchmarks import Durable
from roah_rsbb.rulebook.errors import Place

TWO = replace(competition(tbm=["HWV"]), durable=Durable.TWO, durable_at=Place("schedule.yaml", 7, 1))


class SimulatedLoop:
    """A loop whose time a test advances."""

    def __init__(self, driver):
        self.driver = driver
        self.calls = []
        self.numbers = itertools.count()

    def call_later(self, seconds, function, *arguments):
        heapq.heappush(self.calls, (self.driver.now.mono + seconds, next(self.numbers), function, arguments))

    def run(self, seconds):
        end = self.driver.now.mono + seconds
        while self.calls and self.calls[0][0] <= end:
            mono, _, function, arguments = heapq.heappop(self.calls)
            self.driver.run(mono - self.driver.now.mono)
            function(*arguments)
        self.driver.run(end - self.driver.now.mono)


class Box:
    """A box whose referees' answers wait for a standby."""

    def __init__(self):
        self.driver = BoxDriver(TWO)
        self.driver.box.copies.expect(self.driver.now, STANDBY)
        self.loop = SimulatedLoop(self.driver)
        self.asked = []
        self.ticket = self.in_file = 0  # of the newest event, and of what is in the journal's file
        self.answers = StandbyAnswers(self.loop, self.driver.box, lambda: self.driver.now, self.driver.event,
                                      self.asked.append, lambda: self.in_file)

    def enter(self, is_in_file=True):
        """A referee's entry; returns its answer."""
        self.ticket += 1
        self.in_file = self.ticket if is_in_file else self.in_file
        return self.answers.ask(self.ticket)

    def hear(self, trouble="", is_of_this_box=True):
        report = CopyReport(STANDBY, is_of_this_box, 0.0, 0, trouble)
        self.driver.event(self.driver.box.copies.report, report)
        self.answers.look()

    @property
    def warnings(self):
        return [text for text in self.driver.box.warnings(self.driver.now) if "standby" in text]


@pytest.fixture
def box():
    made = Box()
    made.hear()
    return made


def test_an_entry_is_confirmed_when_the_standby_has_it(box):
    answer = box.enter()
    box.loop.run(SYNC_S - 0.1)
    assert not answer.done()
    assert box.answers.saved(1) == 0
    box.answers.on_answer(1)
    assert wait(answer) == ""
    assert box.answers.saved(1) == 1
    box.loop.run(1.0)
    assert not box.warnings


def test_one_answer_ends_all_earlier_waits(box):
    answers = [box.enter() for _ in range(3)]
    assert box.asked == [1, 2, 3]
    box.answers.on_answer(2)
    assert [answer.done() for answer in answers] == [True, True, False]


def test_a_silent_standby_delays_the_first_answer_only(box):
    first = box.enter()
    box.loop.run(0.1)
    second = box.enter()
    box.loop.run(SYNC_S - 0.1)
    assert wait(first) == unconfirmed(
        "the standby did not answer within 2 s. To continue with one computer, delete 'durable: two' in "
        "schedule.yaml:7 and reload")
    assert not second.done()
    assert box.warnings
    box.loop.run(0.1)
    assert wait(second)
    assert box.enter().done()  # at once
    box.answers.on_answer(2)
    assert box.warnings
    box.answers.on_answer(3)
    assert not box.warnings
    assert not box.enter().done()
    logged = box.driver.notices(Level.WARNING, Level.INFO)[-2:]
    assert logged[0].startswith("NOT CONFIRMED: the standby does not have the last entries: the standby did not answer")
    assert logged[1] == "The standby has all entries again"


def test_a_standby_that_is_not_connected_confirms_nothing_and_delays_nothing(box):
    box.hear("the standby is not connected")
    assert "not connected" in box.enter().result(0)
    (warning,) = box.warnings
    assert "not connected" in warning
    assert box.answers.saved(1) == 0


def test_a_lost_question_is_repeated(box):
    """Otherwise nothing would be confirmed any more: nobody enters anything while the box says so."""
    box.enter()
    box.loop.run(SYNC_S)
    assert box.warnings
    box.asked.clear()  # the node that copies was started again
    box.hear()
    assert box.asked == [1]
    box.answers.on_answer(1)
    assert not box.warnings
    box.hear()
    assert box.asked == [1]  # the standby has everything


def test_an_entry_that_waits_for_a_full_disk_is_not_confirmed_by_an_answer_to_earlier_ones(box):
    box.enter()
    waiting = box.enter(is_in_file=False)
    assert box.asked == [1, 1]
    box.answers.on_answer(1)
    assert not waiting.done()
    box.in_file = 2
    box.hear()
    box.answers.on_answer(2)
    assert wait(waiting) == ""


def test_an_answer_is_newer_than_a_report_from_before_the_first_copy(box):
    box.hear(is_of_this_box=False)
    assert box.enter().result(0)
    box.answers.on_answer(1)
    assert not box.enter().done()


def test_a_reload_that_ends_it_confirms_what_waits(box):
    answer = box.enter()
    one = replace(TWO, durable=Durable.ONE)
    box.driver.event(box.driver.box.reload.take, one, 1, ["durable: two, now one"], "Olga")
    box.loop.run(SYNC_S)
    assert wait(answer) == ""
    assert box.enter() is None
    assert box.answers.saved(2) == 2


def test_an_entry_of_a_box_that_is_superseded_meanwhile_is_not_called_saved(box):
    """No standby of this box will ever have it, and the new box may not."""
    answer = box.enter()
    box.driver.event(lambda now: box.driver.box.authority.supersede(2, 17, "10.0.0.3"))
    box.loop.run(SYNC_S)
    assert wait(answer) == (
        "not confirmed: the box at 10.0.0.3 has taken over, and may not have this entry. Look there, and enter it "
        "there if it is missing")


def test_one_computer_is_enough_by_default():
    box = Box()
    box.driver.box.copies.use(replace(TWO, durable=Durable.ONE))
    box.hear("the standby is not connected")
    assert box.enter() is None
    assert box.asked == []
    assert not box.warnings


def test_a_loop_that_has_ended_keeps_no_referee_waiting(box, monkeypatch):
    monkeypatch.setattr("roah_rsbb.box.standby_answers.LIMIT_S", 0.0)
    assert wait(box.enter()) == unconfirmed("the box has ended")
    assert wait(None) == ""
