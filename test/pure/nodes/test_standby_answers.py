"""Answers to referees wait for the standby; the core's loop does not."""

import heapq
import itertools

import pytest

from helpers.box_driver import BoxDriver
from roah_rsbb.core.copies import STANDBY, SYNC_S, CopyReport
from roah_rsbb.core.effects import Level
from roah_rsbb.nodes.core.standby_answers import StandbyAnswers, wait


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
        self.driver = BoxDriver()
        self.driver.box.copies.expect(self.driver.now, STANDBY)
        self.loop = SimulatedLoop(self.driver)
        self.asked = []
        self.answers = StandbyAnswers(self.loop, self.driver.box, lambda: self.driver.now, self.driver.event,
                                      self.asked.append)

    def hear(self, trouble="", is_of_this_box=True):
        report = CopyReport(STANDBY, is_of_this_box, 0.0, 0, trouble)
        self.driver.event(self.driver.box.on_copy_report, report)

    @property
    def warnings(self):
        return [text for text in self.driver.box.warnings(self.driver.now) if "standby" in text]


@pytest.fixture
def box():
    made = Box()
    made.hear()
    return made


def test_an_answer_waits_until_the_standby_has_the_entry(box):
    answer = box.answers.ask()
    box.loop.run(0.3)
    assert not answer.done()
    box.answers.on_answer(1)
    assert answer.result(0) is True
    box.loop.run(1.0)
    assert not box.warnings


def test_one_answer_ends_all_earlier_waits(box):
    answers = [box.answers.ask() for _ in range(3)]
    assert box.asked == [1, 2, 3]
    box.answers.on_answer(2)
    assert [answer.done() for answer in answers] == [True, True, False]


def test_a_silent_standby_delays_the_first_answer_only(box):
    first = box.answers.ask()
    box.loop.run(0.1)
    second = box.answers.ask()
    box.loop.run(SYNC_S - 0.1)
    assert first.result(0) is False
    assert not second.done()
    assert box.warnings
    box.loop.run(0.1)
    assert second.result(0) is False
    assert box.answers.ask().result(0) is False  # at once
    box.answers.on_answer(2)
    assert box.warnings
    box.answers.on_answer(3)
    assert not box.warnings
    assert not box.answers.ask().done()
    assert box.driver.notices(Level.WARNING, Level.INFO)[-2:] == [
        "The standby does not have the referees' last entries yet. They are saved on this computer only: it did not "
        "answer within 0.5 s", "The standby has all entries again"]


def test_a_standby_that_is_not_connected_delays_nothing(box):
    box.hear("the standby is not connected")
    assert box.answers.ask().result(0) is False
    (warning,) = box.warnings
    assert "not connected" in warning


def test_an_answer_is_newer_than_a_report_from_before_the_first_copy(box):
    box.hear(is_of_this_box=False)
    assert box.answers.ask().result(0) is False
    box.answers.on_answer(1)
    assert not box.answers.ask().done()


def test_a_loop_that_has_ended_keeps_no_referee_waiting(box, monkeypatch):
    monkeypatch.setattr("roah_rsbb.nodes.core.standby_answers.LIMIT_S", 0.0)
    wait(box.answers.ask())
    wait(None)
