"""Modules in a thread beside a box: rules that hang stop neither the box nor its end."""

import threading

import pytest

from helpers.competition import competition, event
from helpers.module_player import FunctionalityDriver
from roah_rsbb.bmbox.framework import registry
from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.host import thread
from roah_rsbb.bmbox.host.ground_truth_of_frames import NoFrames, ZonesGroundTruth
from roah_rsbb.bmbox.host.host import ModulesHost
from roah_rsbb.bmbox.host.thread import ModulesThread
from roah_rsbb.core.effects import Level
from roah_rsbb.core.modules.presence import GONE_S
from roah_rsbb.model.records import EndReason

LIMIT_S = 60.0


class Beside:
    """A core in simulated time, and its modules in a thread, whose messages arrive in the test's loop."""

    def __init__(self, running, folder):
        self.running, self.states = running, []
        self.driver = FunctionalityDriver(competition(tbm=[event("HNF", timeout=60.0, total_timeout=600.0)]))
        self.thread = ModulesThread(
            lambda loop, send: ModulesHost(loop, folder, None, ZonesGroundTruth(folder, NoFrames), send),
            self.send, running.loop.call_soon_threadsafe)
        self.thread.start()
        running.until(lambda: self.states)

    def send(self, state):
        assert threading.current_thread() is threading.main_thread()
        self.states.append(state)
        self.driver.event(self.driver.box.modules.on_modules, state)

    def take(self):
        """Hand the runs over."""
        self.thread.take(self.driver.box.modules.runs())


class Hanging:
    """Rules whose first step returns when the test says so."""

    def __init__(self):
        self.entered, self.release = threading.Event(), threading.Event()
        hanging = self

        class Rules(Module):
            """They wait for the test."""

            CODE = "HNF"

            async def execute(self):
                hanging.entered.set()
                assert hanging.release.wait(LIMIT_S)

        self.kinds = {"HNF": Rules}


@pytest.fixture
def hanging(monkeypatch):
    made = Hanging()
    monkeypatch.setattr(registry, "modules", lambda report: made.kinds)
    yield made
    made.release.set()


@pytest.fixture
def beside(hanging, running, tmp_path):
    made = Beside(running, str(tmp_path))
    yield made
    hanging.release.set()
    made.thread.close()


def hang(beside, hanging):
    """Start a run. Its rules hang."""
    beside.driver.connected()
    beside.driver.command("start")
    beside.take()
    assert hanging.entered.wait(LIMIT_S)
    beside.running.turn_once()  # what was sent before
    beside.driver.notices()


def test_rules_that_hang_are_missed_by_the_core_whose_loop_continues(beside, hanging):
    hang(beside, hanging)
    driver, sent = beside.driver, len(beside.states)
    driver.run(GONE_S - 0.01)
    assert not driver.run_in().held
    driver.run(0.01)
    assert driver.run_in().held
    assert driver.notices(Level.ERROR) == ["Benchmarking module is missing: the run is paused"]
    called = []
    beside.running.loop.call_soon(called.append, 1)
    for _ in range(100):
        beside.take()
    beside.running.turn_once()
    assert (called, len(beside.states)) == ([1], sent), "the loop continues, and no message comes"
    hanging.release.set()
    beside.running.until(lambda: driver.run_in().end_reason is not None)
    assert driver.run_in().end_reason is EndReason.COMPLETED
    assert "Benchmarking module is heard again: the run continues" in driver.notices(Level.WARNING)


def test_while_rules_hang_only_the_newest_runs_wait(beside, hanging, caplog):
    hang(beside, hanging)
    taken = []
    beside.thread._host.take = taken.append
    for number in range(5):
        beside.thread.take((number,))
    hanging.release.set()
    beside.running.until(lambda: taken)
    beside.thread.close()
    assert (taken, caplog.text) == ([(4,)], "")


def test_rules_that_hang_do_not_delay_the_end(beside, hanging, monkeypatch, caplog):
    monkeypatch.setattr(thread, "LEAVE_S", 0.01)
    hang(beside, hanging)
    sent = len(beside.states)
    beside.thread.close()
    assert "The rules of a benchmark hang and were abandoned" in caplog.text
    beside.take()
    hanging.release.set()
    beside.thread._thread.join(LIMIT_S)
    assert not beside.thread._thread.is_alive()
    beside.running.turn_once()
    assert len(beside.states) == sent, "nothing is sent to a box that has ended"


def test_at_its_end_the_core_misses_the_module_at_once(beside):
    driver = beside.driver
    driver.connected()
    assert driver.off("start") == []
    beside.thread.close()
    assert not beside.thread._thread.is_alive()
    beside.running.turn_once()
    assert "no node drives HNF" in "".join(driver.off("start"))
    beside.take()  # harmless


def test_modules_that_cannot_start_are_logged(running, caplog):
    def fail(loop, send):
        raise SystemExit("no rules")

    failing = ModulesThread(fail, print, running.loop.call_soon_threadsafe)
    failing.take(())
    failing.start()
    failing._thread.join(LIMIT_S)
    failing.take(())
    failing.close()
    assert "the benchmarking modules ended" in caplog.text and "SystemExit: no rules" in caplog.text
