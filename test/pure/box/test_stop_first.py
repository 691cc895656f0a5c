"""STOP leaves before its record, and nothing undoes it: beside a disk that hangs, kills and takeovers.

The box, its copy, the standby and the robot are the simulator's, which are built from the real parts.
"""

import contextlib
import dataclasses
import json
import random

import pytest

from helpers.commands import given_with
from helpers.competition import competition, event
from roah_rsbb.box.calls import BoxCalls, Disks
from roah_rsbb.box.journal import MOST_WHO, PREFIX, NoMemory, StopNotes, unrecorded
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.runs.run import UnrecordedStop
from roah_rsbb.core.views.document import END_UNSAVED, Documents
from roah_rsbb.document.calls import Caller
from roah_rsbb.ground.signs_of_life import CHANNEL
from roah_rsbb.model.clock import Now
from roah_rsbb.model.fields import MAX_TEXT
from roah_rsbb.model.reason import Refused, RunName, decode
from roah_rsbb.model.records import By, EndReason, Phase, RunRecord, StopRecord
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.rulebook.benchmarks import Durable
from roah_rsbb.standby.beside_copy import LONGEST, add_stops, read_stops, stops_in
from simulation.air import Air
from simulation.box import Box
from simulation.disk import Storage
from simulation.robots import Robot
from simulation.scheduler import Computer, Scheduler
from simulation.standby import PORT, Standby
from simulation.trace import Trace

STILL_S = 1e6  # the disk hangs for the rest of the test
LIMIT_S = 60.0


class Oracles:
    """Internal errors count, and what leaves after the STOP that it is older than."""

    def bug(self, text):
        raise AssertionError(text)

    def opened(self, box, core):
        send = core.radio.send_state

        def sent(port, message, how):
            run = core.box.zones.run_at(port)
            if message.state is not BoxState.STOP:
                assert run is not None and (run.phase is Phase.RUNNING or run.end_reason is EndReason.COMPLETED)
            send(port, message, how)
        core.radio.send_state = sent

    def __getattr__(self, name):
        return lambda *_: None


class Stage:
    """A box with one zone, a robot, and a standby if there is one."""

    def __init__(self, folder, has_standby=False, durable=Durable.ONE, **of_robot):
        self.folder, self.can_wait, self.documents, self.clocks_were_set = str(folder), True, [], set()
        self.bytes = random.Random(1)
        self.scheduler = Scheduler()
        self.trace = Trace(self.scheduler, self.folder)
        self.air = Air(self.scheduler, random.Random(2), self.trace)
        self.oracles = Oracles()
        self.config = dataclasses.replace(
            competition(home=[event("HGTKMH", timeout=LIMIT_S), event("HGTKMH")]), durable=durable)
        computer = Computer(self.scheduler, "box", "10.0.0.1")
        self.storage = Storage(folder / "log", self.scheduler, random.Random(3), self.random_bytes)
        self.box = Box(self, computer, self.storage, self.config, PORT if has_standby else 0)
        self.standby = None
        if has_standby:
            self.standby = Standby(self, Computer(self.scheduler, "standby", "10.0.0.50"), str(folder / "copy"),
                                   self.box)
            self.box.copy()
        self.robot = Robot(self, Computer(self.scheduler, "robot", "10.0.0.2"), "Alpha", "r1",
                           self.config.passwords["Alpha"],
                           {"prepare_duration": 0.5, "execute_duration": 1000.0, "never_end": True, **of_robot})
        self.states = []  # of the robot, each when it changed
        self.box.start()
        self.robot.start()
        self.pass_time(4.0)

    def random_bytes(self, count):
        return bytes(self.bytes.getrandbits(8) for _ in range(count))

    def taken_over(self, box):
        """The standby is the box."""
        self.box, self.storage = box, box.storage
        box.start()

    def pass_time(self, seconds):
        """Let time pass, and note what the robot does."""
        end = self.scheduler.now + seconds
        while self.scheduler.now < end and not self.scheduler.bugs:
            self.scheduler.run(min(end, self.scheduler.now + 0.001))
            if self.states[-1:] != [self.robot.state]:
                self.states.append(self.robot.state)
        if self.scheduler.bugs:
            raise self.scheduler.bugs[0]

    def do(self, command, who="Anna"):
        """A referee presses a button."""
        core = self.box.core

        def act():
            with contextlib.suppress(Refused):
                if command == "stop":
                    core.event(core.box.scores.stop, RunName("home", ""), who)
                else:
                    core.event(core.box.act, Target("home"), command, who, given_with(command, "Alpha"))
        self.box.process.soon(act)
        self.scheduler.run(self.scheduler.now)

    def until(self, state):
        """Let time pass until the robot does this."""
        for _ in range(100):
            if self.robot.state is state:
                return
            self.pass_time(0.1)
        raise AssertionError(f"the robot stays in {self.robot.state}")

    def execute(self):
        """The robot executes its task."""
        self.do("connect")
        self.pass_time(2.0)
        self.do("start")
        self.until(RobotState.EXECUTING)
        self.pass_time(1.0)

    def freeze(self, seconds=STILL_S):
        """The disk takes no writes."""
        self.storage.frozen_until = self.scheduler.now + seconds

    def lose_core(self, takes_over=False):
        """The core is killed and starts again, or the box is lost and its standby takes over. The disks are well then.
        Returns some time later, with what the robot did since."""
        self.box.kill(float("inf") if takes_over else 0.5, power=takes_over)
        self.storage.frozen_until = self.storage.full_until = 0.0
        self.states.clear()
        if takes_over:
            self.pass_time(4.0)
            self.standby.take_over()
        self.pass_time(10.0)

    @property
    def run(self):
        return self.box.core.box.zones["home"].run

    def end(self):
        self.box.process.end()
        for process in self.scheduler.processes:
            process.end()
            process.bury()
        self.box.storage.killed()


@pytest.fixture
def stage(tmp_path):
    made = []

    def make(**how):
        made.append(Stage(tmp_path, **how))
        return made[-1]

    yield make
    for each in made:
        each.end()


STOPS = ("stop", "time limit", "disconnect")


def stop(stage, how):
    """The run ends, one way or another. Returns with the first effect of that."""
    if how == "time limit":
        stage.pass_time(stage.run.clock.left(stage.box.core.now()) + 0.002)
    else:
        stage.do(how)


@pytest.mark.parametrize("how", STOPS)
def test_stop_does_not_wait_for_a_disk_that_hangs(stage, how):
    stage = stage()
    stage.execute()
    stage.freeze()
    stop(stage, how)
    stage.pass_time(0.05)
    assert stage.robot.state is RobotState.STOP
    assert stage.box.core.store.is_waiting(stage.box.core.store.next_ticket - 1)


@pytest.mark.parametrize("how", STOPS)
@pytest.mark.parametrize("after_s", [0.0, 0.001, 0.003, 0.03, 0.3, 3.0])
@pytest.mark.parametrize("is_frozen", [False, True])
def test_a_core_that_is_killed_after_stop_leaves_the_robot_stopped(stage, how, after_s, is_frozen):
    stage = stage()
    stage.execute()
    if is_frozen:
        stage.freeze()
    stop(stage, how)
    stage.pass_time(after_s)
    stage.box.kill(0.5)
    stage.storage.frozen_until = 0.0
    stage.until(RobotState.STOP)
    stage.states.clear()
    stage.pass_time(15.0)
    assert stage.states == [RobotState.STOP]
    record = stage.box.core.box.finished.records()[-1] if stage.run is None else stage.run.record(stage.box.core.now())
    assert record.end_reason == ("timeout" if how == "time limit" else "stopped")
    assert [end.who for end in record.stops] == ["" if how == "time limit" else "Anna"]
    assert not [name for name in stage.box.memory.texts if name.startswith(PREFIX)]


@pytest.mark.parametrize("how", STOPS)
@pytest.mark.parametrize("is_frozen", [False, True])
def test_a_takeover_after_stop_leaves_the_robot_stopped(stage, how, is_frozen):
    stage = stage(has_standby=True)
    stage.execute()
    if is_frozen:
        stage.freeze()
    stop(stage, how)
    stage.until(RobotState.STOP)
    stage.pass_time(0.5)
    stage.box.kill(float("inf"), power=True)
    stage.states.clear()
    stage.pass_time(4.0)
    stage.standby.take_over()
    stage.pass_time(15.0)
    assert stage.states == [RobotState.STOP]
    assert len(stage.box.core.box.zones["home"].run.record(stage.box.core.now()).stops
               if stage.run is not None else stage.box.core.box.finished.records()[-1].stops) == 1


@pytest.mark.parametrize("takes_over", [False, True])
def test_a_robot_that_stopped_after_a_loss_is_not_prepared_while_the_other_computer_may_be_the_box(stage, takes_over):
    """The other one may have stopped it, though this core has never heard it, and the run began here."""
    stage = stage(has_standby=True)
    stage.pass_time(2.0)
    stage.air.weather["10.0.0.50" if not takes_over else "10.0.0.1"].is_cut = True
    stage.lose_core(takes_over)
    stage.execute()
    stage.robot.crash(0.1)  # as if it was stopped: it reports STOP
    stage.pass_time(10.0)
    assert stage.run.is_doubted and stage.robot.state is RobotState.STOP
    stage.do("continue")
    stage.until(RobotState.EXECUTING)


@pytest.mark.parametrize("is_killed", [False, True])
@pytest.mark.parametrize("takes_over", [False, True])
def test_a_robot_that_was_silent_since_a_restart_is_stopped_beside_a_disk_that_hangs(stage, is_killed, takes_over):
    """Nothing was sent to it until then, because the box before might have stopped it."""
    stage = stage(has_standby=takes_over)
    stage.execute()
    weather = stage.air.weather[stage.robot.computer.host]
    weather.is_cut = True
    stage.box.kill(float("inf") if takes_over else 0.5, power=takes_over)
    stage.pass_time(4.0)
    if takes_over:
        stage.standby.take_over()
        stage.pass_time(4.0)
    stage.freeze()
    stage.do("stop")
    stage.pass_time(0.1)
    if is_killed:
        stage.box.kill(0.5)
        stage.storage.frozen_until = 0.0
    weather.is_cut = False
    stage.until(RobotState.STOP)
    stage.states.clear()
    stage.pass_time(10.0)
    assert stage.states == [RobotState.STOP]
    assert stage.run.end_reason is EndReason.STOPPED


def test_a_run_in_doubt_is_stopped_beside_a_disk_that_hangs(stage):
    """Its robot had STOP before the referee decided."""
    stage = stage()
    stage.execute()
    stage.robot.crash(0.1)
    stage.box.kill(0.5)
    stage.pass_time(6.0)
    assert stage.run.is_doubted
    stage.freeze()
    stage.do("stop")
    stage.pass_time(0.1)
    stage.box.kill(0.5)
    stage.storage.frozen_until = 0.0
    stage.pass_time(3.0)
    assert stage.run.end_reason is EndReason.STOPPED


@pytest.mark.parametrize("seed", range(3))
def test_nothing_older_follows_stop_whatever_referees_do_beside_a_disk_that_hangs_at_times(stage, seed):
    stage, chance, held = stage(execute_duration=3.0, never_end=False), random.Random(seed), 0
    for _ in range(150):
        if chance.random() < 0.2:
            stage.freeze(chance.choice((0.005, 0.3, 3.0)))
        stage.do(chance.choice(("connect", "start", "start", "stop", "disconnect", "pause", "next")))
        stage.pass_time(chance.choice((0.0, 0.002, 0.3, 1.0)))
        held += bool(stage.box.core._waiting)
    assert held > 10


def answer_to_stop(stage):
    """Return the answer of the door, in words."""
    core, asked = stage.box.core, []
    calls = BoxCalls(core.box, core.event, Disks(core.journal.ticket, lambda ticket: "", core.standby.ask,
                                                core.why_not_recorded)).named()
    stage.box.process.soon(lambda: asked.append(calls["stop"]({"zone": "home", "by": "Anna"}, Caller())))
    stage.pass_time(0.1)
    return asked[0] and str(decode(asked[0]["unsaved"]))


def test_the_answer_to_stop_says_if_the_standby_does_not_have_it(stage):
    stage = stage(has_standby=True, durable=Durable.TWO)
    stage.execute()
    assert answer_to_stop(stage) is None
    stage.do("start")
    stage.air.weather[stage.standby.computer.host].is_cut = True
    stage.pass_time(8.0)
    assert "stopped, not yet recorded: the standby does not have it" in answer_to_stop(stage)
    assert stage.robot.state is RobotState.STOP


def test_the_answer_to_stop_says_if_it_is_not_recorded(stage):
    stage = stage()
    stage.execute()
    core = stage.box.core
    documents = Documents(core.box, "", "")
    stage.freeze(3.0)
    assert answer_to_stop(stage) == "stopped, not yet recorded", "a busy computer is as slow"
    stage.pass_time(1.0)
    assert "stopped, not yet recorded: the disk of log_dir" in answer_to_stop(stage)
    assert END_UNSAVED in documents.look(core.now(), unsaved=core.unsaved()).zones["home"].warnings
    stage.pass_time(3.0)
    assert END_UNSAVED not in documents.look(core.now(), unsaved=core.unsaved()).zones["home"].warnings
    stage.do("start")
    stage.pass_time(0.1)
    assert answer_to_stop(stage) is None


def test_the_answer_to_stop_says_if_the_disk_is_full(stage):
    stage = stage()
    stage.execute()
    stage.storage.full_until = STILL_S
    stage.pass_time(3.0)
    assert "stopped, not yet recorded: the journal cannot be written: the disk is full" in answer_to_stop(stage)
    stage.storage.full_until = 0.0
    stage.pass_time(3.0)
    stage.do("start")
    stage.pass_time(0.1)
    assert answer_to_stop(stage) is None


@pytest.mark.parametrize("takes_over, after_s", [(False, 0.0), (False, 0.5), (True, 0.5)])
def test_a_stop_after_a_start_that_waits_for_a_disk_that_hangs_is_known_to_the_next_box(stage, takes_over, after_s):
    """The robot was not sent to prepare, so this STOP sends it nothing new."""
    stage = stage(has_standby=takes_over)
    stage.execute()
    stage.freeze()
    stage.do("stop")
    stage.pass_time(0.5)
    stage.do("start")
    stage.pass_time(1.5)
    stage.do("stop", "Ben")
    stage.pass_time(after_s)
    assert set(stage.states[-1:]) == {RobotState.STOP}
    stage.lose_core(takes_over)
    assert stage.states == [RobotState.STOP]
    record = stage.run.record(stage.box.core.now())
    assert record.end_reason == "stopped" and record.stops[-1].who == "Ben"


def test_a_start_that_waits_for_a_disk_that_hangs_does_not_undo_the_stop_before_it(stage):
    stage = stage()
    stage.execute()
    stage.freeze()
    stage.do("stop")
    stage.pass_time(0.5)
    stage.do("start")
    stage.pass_time(1.5)
    stage.lose_core()
    assert stage.states == [RobotState.STOP]
    assert [end.who for end in stage.run.record(stage.box.core.now()).stops] == ["Anna"]


@pytest.mark.parametrize("state, after_s", [(RobotState.EXECUTING, 1.5), (RobotState.PREPARING, 0.0)])
@pytest.mark.parametrize("takes_over", [False, True])
def test_a_run_that_was_started_again_is_not_ended_by_its_earlier_stop(stage, takes_over, state, after_s):
    """A full disk has a record of neither."""
    stage = stage(has_standby=takes_over)
    stage.execute()
    stage.storage.full_until = STILL_S
    stage.do("stop")
    stage.until(RobotState.STOP)
    stage.pass_time(0.5)
    stage.do("start")
    stage.until(state)
    stage.pass_time(after_s)
    stage.lose_core(takes_over)
    assert RobotState.STOP not in stage.states and stage.robot.state is RobotState.EXECUTING


@pytest.mark.parametrize("takes_over", [False, True])
def test_a_stop_after_a_power_failure_has_its_time_though_the_journal_has_none_of_this_start(stage, takes_over):
    """The disk is full since the computer was switched on again: the newest record is of its start before."""
    stage = stage(has_standby=takes_over)
    stage.execute()
    started = stage.scheduler.now - stage.run.record(stage.box.core.now()).elapsed_s
    stage.box.kill(2.0, power=True)
    stage.storage.full_until = STILL_S
    stage.pass_time(6.0)
    stage.do("stop")
    stopped = stage.scheduler.now
    stage.pass_time(0.5)
    stage.lose_core(takes_over)
    record = stage.run.record(stage.box.core.now())
    assert record.end_reason == "stopped" and record.elapsed_s == pytest.approx(stopped - started, abs=0.1)


@pytest.mark.parametrize("sign", ["a", "ü", "\U0001f600", '"', "\x01"])
def test_a_stop_with_the_longest_reason_is_kept_and_one_that_is_too_long_keeps_out_no_other(tmp_path, sign):
    passed, who, why = {}, sign * MOST_WHO, sign * MAX_TEXT
    record = RunRecord("run", "home", "HGTKMH", "Alpha", 1, 1, 0.0, 0.0,
                       stops=(StopRecord(5.0, who, "stopped", "", why),))
    StopNotes(NoMemory(), passed.update, "boot").sent(Now(1.0, 5.0), record, 1)
    assert stops_in({"other": "x" * (LONGEST + 1), **passed, "third": 5}) == passed
    add_stops(str(tmp_path), passed)
    assert unrecorded(read_stops(str(tmp_path)), [], lambda anchor: 0.0) == {
        "run": UnrecordedStop(Now(1.0, 5.0), EndReason.STOPPED, By(who, why))}


def test_a_start_is_not_ended_by_a_stop_of_a_start_that_was_lost(stage):
    """The standby keeps what it has heard."""
    stage = stage(has_standby=True)
    stage.do("connect")
    stage.pass_time(2.0)
    stage.freeze()
    stage.do("start")
    stage.do("stop")
    stage.pass_time(0.5)
    stage.box.kill(float("inf"), power=True)
    stage.pass_time(4.0)
    stage.standby.take_over()
    stage.pass_time(4.0)
    stage.do("start")
    stage.until(RobotState.EXECUTING)
    stage.pass_time(1.0)
    stage.box.kill(0.5)
    stage.pass_time(4.0)
    assert stage.run.phase is Phase.RUNNING


def channels(stage):
    return {int(name[len(CHANNEL):]): json.loads(text) for name, text in stage.box.memory.texts.items()
            if name.startswith(CHANNEL)}


def test_the_barest_core_knows_each_channel_at_once(stage):
    """A box may fail within the second in which its robot starts."""
    stage = stage()
    stage.do("connect")
    stage.pass_time(0.01)
    assert [(port, channel[2]) for port, channel in channels(stage).items()] == [(stage.run.port, "10.0.0.2")]
    stage.do("disconnect")
    stage.pass_time(0.01)
    assert not channels(stage)


def test_a_start_that_waits_for_the_disk_is_dropped_by_stop(stage):
    stage = stage()
    stage.execute()
    stage.do("stop")
    stage.until(RobotState.STOP)
    stage.freeze(20.0)
    stage.do("start")
    stage.pass_time(8.0)
    assert stage.run.phase is Phase.RUNNING
    assert stage.robot.state is RobotState.STOP, "the start waits for its record"
    stage.do("stop")
    stage.states.clear()
    stage.pass_time(20.0)
    assert stage.states == [RobotState.STOP]
    stage.do("start")
    stage.until(RobotState.EXECUTING)


def test_a_run_that_waits_for_the_disk_begins_when_the_disk_takes_data_again(stage):
    stage = stage()
    stage.freeze(6.0)
    stage.do("connect")
    stage.pass_time(5.0)
    assert stage.robot.link is None, "no beacon names a channel that is not open"
    assert any("takes no data" in text for text in stage.box.core.box.warnings(stage.box.core.now()))
    stage.pass_time(3.0)
    assert stage.robot.link is not None
    stage.freeze(8.0)
    stage.do("start")
    stage.pass_time(7.5)
    assert stage.robot.state is RobotState.STOP
    stage.until(RobotState.EXECUTING)
    assert not any("takes no data" in text for text in stage.box.core.box.warnings(stage.box.core.now()))


def test_what_a_robot_says_is_not_acknowledged_before_it_is_recorded(stage):
    stage = stage()
    stage.execute()
    stage.freeze(5.0)
    stage.robot.client.notify("once")
    stage.pass_time(0.01)
    stage.do("stop")
    stage.pass_time(2.0)
    assert stage.robot.state is RobotState.STOP
    assert stage.robot.client.strings_pending == 1, "it is repeated"
    stage.box.kill(0.5)
    stage.storage.frozen_until = 0.0
    stage.pass_time(5.0)
    assert "once" in [said.text for said in stage.run.state.said]


def test_a_robot_that_has_completed_repeats_its_result_until_it_is_recorded(stage):
    stage = stage(execute_duration=2.0, never_end=False)
    stage.execute()
    stage.freeze(6.0)
    stage.until(RobotState.RESULT_TX)
    stage.pass_time(3.0)
    assert stage.robot.state is RobotState.RESULT_TX
    stage.box.kill(0.5)
    stage.storage.frozen_until = 0.0
    stage.until(RobotState.STOP)
    assert stage.run.end_reason is EndReason.COMPLETED
