"""The handover to the standby: when it is due, and that the old core can do nothing after it."""

import os
import signal
import subprocess
import sys
import threading

import pytest

from helpers.journals import Writer
from helpers.waiting import wait_until
from roah_rsbb.ground.linux import is_locked
from roah_rsbb.ground.signs_of_life import LOOK_S, STARTING, Lifeline
from roah_rsbb.journal import epochs
from roah_rsbb.journal.log_dir import JOURNAL, JournalInUse, lock
from roah_rsbb.standby.program.copying import HUNG_S, NOBODY_S, STARTING_S, Handover, Owner, is_due
from roah_rsbb.standby.remote import CoreState

STANDBY = "10.1.0.3"
CORE = """
import sys
from roah_rsbb.journal.log_dir import lock
from roah_rsbb.ground.signs_of_life import Lifeline
found = lock(sys.argv[1])
Lifeline(sys.argv[1]).send()
print(flush=True)
sys.stdin.readline()
"""


@pytest.mark.parametrize("silent_s, owner, is_connected, expected", [
    (HUNG_S - 0.1, Owner.HUNG, True, False), (HUNG_S, Owner.HUNG, True, True),
    (NOBODY_S, Owner.NOBODY, True, True), (NOBODY_S, Owner.NOBODY, False, False),
    (STARTING_S - 0.1, Owner.NEXT, True, False), (STARTING_S, Owner.NEXT, True, True)])
def test_when_a_handover_is_due(silent_s, owner, is_connected, expected):
    """A core that is being started on this computer comes first: panels and pages keep their box."""
    assert is_due(silent_s, owner, is_connected) == expected


class Supervisor:
    """The lifeline to it."""

    def __init__(self):
        self.says, self.has_supervisor = set(), True
        self.signs = 0

    def keep(self, name, value):
        self.says = {value}

    def drop(self, name):
        self.says = set()

    def send(self):
        self.signs += 1


class Box:
    """A box with a journal, its core in a process, and what the standby does."""

    def __init__(self, folder):
        self.now, self.is_connected, self.answers = 0.0, True, True
        self.supervisor, self.has_lock = Supervisor(), True
        self.log_dir = str(folder)
        writer = Writer(folder)
        writer.entry("/notification", "now")
        writer.journal.close()
        self.said = []
        self.handover = Handover(self.log_dir, lambda: self.is_connected, self._ask, lambda: STANDBY,
                                 self.supervisor, lambda: self.now)
        self.handover.look()
        self.cores = []

    def start_core(self):
        core = subprocess.Popen([sys.executable, "-c", CORE, self.log_dir], stdin=subprocess.PIPE,
                                stdout=subprocess.PIPE)
        self.cores.append(core)
        core.stdout.readline()
        self.handover.look()
        return core

    def _ask(self, question):
        """The copy is completed, and the next message to the standby says that it takes over."""
        if self.has_lock:
            with pytest.raises(JournalInUse):
                lock(self.log_dir)
        self.said.append("copy")
        assert self.handover.complete(question)
        threading.Thread(target=self._answer).start()

    def _answer(self):
        while not self.handover.state().hand_over:
            pass
        self.said.append("hand over")
        if self.answers:
            self.handover.taken()

    def pass_time(self, seconds):
        for _ in range(round(seconds / LOOK_S)):
            self.now += LOOK_S
            self.handover.look()

    @property
    def standing(self):
        return epochs.standing_in(os.path.join(self.log_dir, JOURNAL))

    def close(self):
        for core in self.cores:
            core.kill()
            core.communicate()


@pytest.fixture
def box(tmp_path, monkeypatch):
    monkeypatch.setattr("roah_rsbb.standby.program.copying.ANSWER_S", 0.2)
    made = Box(tmp_path / "log")
    yield made
    made.close()


def test_a_hung_core_is_ended_and_the_standby_takes_over(box):
    core = box.start_core()
    assert box.handover.state() == CoreState(is_alive=True)
    core.send_signal(signal.SIGSTOP)
    box.pass_time(NOBODY_S - LOOK_S)
    assert box.handover.state() == CoreState(is_alive=False)
    assert core.poll() is None and not box.said
    box.now += LOOK_S
    box.handover.look()
    assert core.wait(60.0) == -signal.SIGKILL
    box.pass_time(2 * LOOK_S)
    assert box.said == ["copy", "hand over"]
    assert box.standing.superseded_by == 2 and box.standing.by == STANDBY and box.standing.cut > 0
    box.pass_time(60.0)
    assert box.said == ["copy", "hand over"], "it hands over once"
    assert box.supervisor.says == {"taken"}, "the supervisor is to send no STOP to robots of the new box"
    os.close(lock(box.log_dir).fd)


def test_a_handover_that_the_journal_cannot_take(box, monkeypatch):
    """The disk of the box is full. Its next core asks the standby before it begins."""
    def fail(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(epochs, "hand_over", fail)
    box.start_core().kill()
    box.cores[-1].wait(60.0)
    box.pass_time(NOBODY_S + 2 * LOOK_S)
    assert box.said == ["copy", "hand over"]
    os.close(lock(box.log_dir).fd)


def test_a_core_that_was_started_again_continues_here(box):
    box.start_core().kill()
    box.cores[-1].wait(60.0)
    box.pass_time(NOBODY_S - 2 * LOOK_S)
    box.start_core()
    box.pass_time(NOBODY_S - 2 * LOOK_S)
    assert not box.said and box.handover.state() == CoreState(is_alive=False)


def test_a_core_that_roslaunch_starts_is_waited_for(box):
    """It does not have the journal yet."""
    box.start_core().kill()
    box.cores[-1].wait(60.0)
    supervisor = Lifeline(box.log_dir)
    for _ in range(round((STARTING_S - 1.0) / LOOK_S)):
        supervisor.send(STARTING)
        box.pass_time(LOOK_S)
    assert not box.said
    box.pass_time(2.0 + 2 * LOOK_S)
    assert box.said, "nobody says so any more"


def test_a_core_that_is_starting_is_waited_for(box):
    """It has the journal, but does not answer yet."""
    box.start_core().kill()
    box.cores[-1].wait(60.0)
    held = lock(box.log_dir)
    box.pass_time(NOBODY_S + 1.0)
    assert not box.said
    os.close(held.fd)
    box.pass_time(LOOK_S)
    assert box.said


def test_a_standby_that_does_not_take_over(box):
    """A core that is started here continues."""
    box.answers = False
    box.start_core().kill()
    box.cores[-1].wait(60.0)
    while not box.said:
        box.pass_time(LOOK_S)
    assert not box.standing.is_superseded and not box.handover.state().hand_over
    os.close(lock(box.log_dir).fd)
    assert box.supervisor.signs > 10, "also while it waited for the answer"
    box.said.clear()
    box.pass_time(60.0)
    assert not box.said and box.supervisor.says == set(), "the supervisor stops the robots"
    box.start_core()
    box.pass_time(LOOK_S)
    assert box.supervisor.says == {"connected"}


def test_a_disk_that_gives_no_lock(box, monkeypatch):
    """It hangs. The core that was started on it cannot begin, and asks the standby before it does."""
    thawed, taken = threading.Event(), []

    def hang(log_dir):
        thawed.wait()
        found = lock(log_dir)
        taken.append(found)
        return found
    monkeypatch.setattr("roah_rsbb.standby.program.copying.LOCK_S", 0.2)
    monkeypatch.setattr("roah_rsbb.standby.program.copying.log_dirs.lock", hang)
    box.has_lock = False
    box.start_core().kill()
    box.cores[-1].wait(60.0)
    box.pass_time(HUNG_S + 2 * LOOK_S)
    assert box.said[:2] == ["copy", "hand over"] and box.supervisor.says == {"taken"}
    thawed.set()
    wait_until(lambda: taken and not is_locked(os.path.join(box.log_dir, f"{JOURNAL}.lock")))


def test_a_standby_that_is_not_connected(box):
    box.is_connected = False
    core = box.start_core()
    core.send_signal(signal.SIGSTOP)
    box.pass_time(60.0)
    assert core.poll() is None and not box.said
