"""What a core keeps in memory stays level, however many runs there were."""

import gc

import pytest

from helpers.competition import BUMPS, competition, event
from helpers.journaled import NO_LISTENING, JournaledDriver
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.protocol import RobotState
from roah_rsbb.scoring import book, unsaved
from roah_rsbb.scoring.sheet import Mark

KEPT = 5  # of the newest runs, the whole record
RUNS = 40
# Of an earlier run: its record without history, its sign-off, and whether it counts. With its history, it has 15.
OBJECTS_A_RUN = 6


class Runs:
    """A referee takes the same robot through one run after the other, with scores, and signs off each of them."""

    def __init__(self, folder):
        events = [event(run=run) for run in range(1, 4)]
        self.driver = JournaledDriver(folder, competition(tbm=events), NO_LISTENING)
        self.robot = self.driver.robot()
        self.done = 0

    def objects_after(self, runs):
        """Play so many runs; returns how many objects there are then."""
        for _ in range(runs):
            self._play()
        gc.collect()
        return len(gc.get_objects())

    def _play(self):
        driver, robot = self.driver, self.robot
        self.done += 1
        robot.beacon()
        driver.command("connect", again=True)
        name, robot.port = RunName("tbm", driver.run_in().identity), driver.run_in().port
        robot.says(RobotState.STOP)
        driver.command("start")
        robot.executes()
        for number in range(1, 4):
            mark = Mark(BUMPS.group, BUMPS.desc, number, id=f"{self.done} {number}")
            driver.mark(name, mark, "Anna")
        driver.command("stop")
        robot.says(RobotState.STOP)
        driver.command("disconnect")
        driver.enter("sign_off", name, "Anna")
        driver.core_journal.each_second(driver.now, {})
        assert driver.journal.why_not_saved(driver.core_journal.ticket()) == ""
        assert driver.core_journal.unsaved(driver.now) == ()
        driver.box.scores.rulings(driver.now)
        # What the test itself remembers.
        driver.effects.clear()
        for kept in (driver.bags, driver.states, driver.channels):
            kept.pop(robot.port, None)


def test_a_core_keeps_no_more_after_many_runs_than_after_a_few(tmp_path, monkeypatch):
    for module in (book, unsaved):
        monkeypatch.setattr(module, "MAX_KEPT", KEPT, raising=False)
    runs = Runs(tmp_path)
    first = runs.objects_after(2 * KEPT + RUNS)
    second = runs.objects_after(RUNS)
    assert second - first < OBJECTS_A_RUN * RUNS
    assert len(runs.driver.box.scores.rulings(runs.driver.now)) == runs.done, "all of them decide what counts"


@pytest.mark.parametrize("boot", (None, "boot 2"))
def test_a_core_that_restarts_decides_over_all_runs(tmp_path, monkeypatch, boot):
    monkeypatch.setattr(book, "MAX_KEPT", KEPT)
    runs = Runs(tmp_path)
    runs.objects_after(3 * KEPT)
    driver = runs.driver

    def whys():
        return [(ruling.record.identity, ruling.why) for ruling in driver.box.scores.rulings(driver.now)]

    expected = whys()
    driver.kill(boot=boot)
    assert whys() == expected and len(expected) == 3 * KEPT
    with pytest.raises(Refused, match="newest"):
        driver.box.finished.find(expected[0][0])
