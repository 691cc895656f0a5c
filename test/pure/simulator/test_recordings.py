"""Somebody records all datagrams of a robot and sends them again, at the box or its standby as they are."""

import itertools

import pytest

from helpers.competition import competition, event
from roah_rsbb.model.records import Phase
from roah_rsbb.protocol import RobotState
from simulation import world as simulated

STRANGER = "10.0.0.99"
# The box's own port: those above it are private channels.
PUBLIC_PORT = 6666
# Without a message for so long, a robot is silent.
SILENCE_S = 4.0


class Hall(simulated.World):
    """A robot that has completed one attempt, and executes in the next one; `story` continues from there."""

    def __init__(self, seed, folder, story):
        super().__init__(seed, str(folder), plan=())
        self.recorded = []  # the robot's private datagrams, each with the state that it reports
        self._story = story
        self.robot = self.robots[0]
        self.robot._options.update(prepare_duration=1.0, execute_duration=5.0, never_end=False)
        self.air.watchers.append(self._record)

    def _record(self, source, port, datagram, _host):
        if source == self.robot.computer.host and port > PUBLIC_PORT:
            self.recorded.append((self.robot.state, datagram))

    def _play(self):
        self.box.start()
        self.robot.start()
        self.wait(6.0)
        self.do("connect", "start")
        self.until(lambda: self.run_now.phase is Phase.ENDED)
        self.do("disconnect", "previous", "connect")
        self.until(lambda: not self.run_now.link.not_ready(self.box.core.now()))
        self.do("start")
        self.until(lambda: self.run_now.robot_state is RobotState.EXECUTING)
        self._story(self)

    @property
    def run_now(self):
        """The run as the box knows it."""
        return self.box.core.box.zones["a"].run

    def wait(self, seconds):
        """Let time pass."""
        self._pass(self.scheduler.now + seconds)

    def until(self, condition):
        """Let time pass until it holds."""
        end = self.scheduler.now + 60.0
        while not condition():
            assert self.scheduler.now < end, self.trace.lines[-20:]
            self.wait(0.1)

    def do(self, *commands):
        """The referee does these, one after the other."""
        for command in commands:
            self.referee._command("a", command)
            self.wait(0.5)

    def replay(self, host, recorded):
        """Send recorded datagrams to the present run, from an address."""
        for _state, datagram in list(recorded):
            self.air.send(host, self.run_now.port, datagram, self.box.computer.host)
            self.wait(0.05)

    @property
    def completion(self):
        """Seven recorded datagrams that completed the first attempt."""
        end = [state for state, _datagram in self.recorded].index(RobotState.RESULT_TX)
        return self.recorded[end - 6 : end + 1]

    @property
    def stopped(self):
        """Ten recorded datagrams that report STOP."""
        return [one for one in self.recorded if one[0] is RobotState.STOP][:10]


def _restarts(hall):
    hall.box.kill(0.5)


def _is_taken_over(hall):
    box = hall.box
    box.kill(float("inf"), power=True)
    hall.wait(4.0)
    hall.standby.take_over()
    assert hall.box is not box


def _plays(monkeypatch, tmp_path, story):
    events = [event("HWV", timeout=600.0), event("HWV", timeout=600.0, round=2)]
    monkeypatch.setattr(simulated, "_competition", lambda *draws: competition(a=events))
    halls = (Hall(seed, tmp_path / str(seed), story) for seed in itertools.count())
    next(hall for hall in halls if hall.standby is not None).run()


def _is_lost_with_the_robot(hall, lose):
    """The box is lost, and so is the robot. Somebody else may speak for both."""
    hall.robot.process.end()
    lose(hall)
    hall.until(lambda: hall.box.core is not None and not hall.box.process.is_ended)
    hall.wait(SILENCE_S)


@pytest.mark.parametrize("lose", [_restarts, _is_taken_over])
@pytest.mark.parametrize("is_forged", [False, True], ids=["stranger", "forged address"])
def test_recordings_neither_complete_a_run_nor_show_a_robot_that_is_off(monkeypatch, tmp_path, lose, is_forged):
    def story(hall):
        _is_lost_with_the_robot(hall, lose)
        host = hall.robot.computer.host if is_forged else STRANGER
        before = hall.run_now.link.last, hall.run_now.link.last_heard
        hall.replay(host, hall.completion)
        hall.replay(host, hall.recorded)
        assert hall.run_now.phase is Phase.RUNNING
        hall.do("stop")
        hall.wait(3.0)
        assert hall.run_now.phase is Phase.ENDED
        hall.replay(host, hall.stopped)
        assert (hall.run_now.link.last, hall.run_now.link.last_heard) == before
        assert any("old ones" in text for text in hall.run_now.link.warnings(hall.box.core.now()))

    _plays(monkeypatch, tmp_path, story)


@pytest.mark.parametrize("lose", [_restarts, _is_taken_over])
def test_a_robot_is_heard_again_at_once_and_completes(monkeypatch, tmp_path, lose):
    def story(hall):
        lose(hall)
        hall.until(lambda: hall.box.core is not None and not hall.box.process.is_ended)
        began = hall.scheduler.now
        hall.until(lambda: hall.run_now.link.last_heard.mono > hall.box.core.now().mono - 1.0)
        assert hall.scheduler.now - began <= 3.0
        hall.until(lambda: hall.run_now.phase is Phase.ENDED and hall.run_now.robot_state is RobotState.STOP)

    _plays(monkeypatch, tmp_path, story)
