"""Robot session and the box's core, linked through a network that loses, doubles, delays and reorders."""

import heapq
import itertools
import random

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import competition
from roah_rsbb.comm.sender import StateSender
from roah_rsbb.core import effects
from roah_rsbb.core.effects import How
from roah_rsbb.nodes.core.wire_convert import beacon_message, report_of, state_message, time_of
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.session import Session

BOX, ROBOT, TEAM, NAME = "10.0.0.1", "10.0.0.2", "Alpha", "r1"
PHASE_S = 3.0  # that preparing and executing take
DATA = (
    ("activation_event", "bell"), ("notifications", "going"), ("visitor", "Deli Man"), ("notifications", "going"),
    ("notifications", "there"), ("visitor", "Deli Man"), ("notifications", "going"),
)


class Network:
    """Datagrams under way, each with the moment of its arrival; chance decides what happens to them."""

    def __init__(self, rng, loss, doubled, latest_s):
        self._rng, self._loss, self._doubled, self._latest_s = rng, loss, doubled, latest_s
        self._under_way = []
        self._order = itertools.count()

    def send(self, now, arrive, message):
        """Send a message that calls `arrive(message)`, none, one or two times."""
        for _ in range(2 if self._rng.random() < self._doubled else 1):
            if self._rng.random() >= self._loss:
                at = now + self._rng.uniform(0.001, self._latest_s)
                heapq.heappush(self._under_way, (at, next(self._order), arrive, message))

    @property
    def deadline(self):
        return self._under_way[0][0] if self._under_way else float("inf")

    def deliver(self, now):
        while self.deadline <= now:
            _, _, arrive, message = heapq.heappop(self._under_way)
            arrive(message)


class Linked:
    """A box and a robot whose owner works for PHASE_S on everything, in one simulated time."""

    def __init__(self, seed, loss, doubled, latest_s, clock_step=0.0):
        self.driver = BoxDriver(competition(tbm=["HWV"]))
        self.session = Session(TEAM, NAME, self.now)
        self.session.progress.messages_saved = 1
        self.clock_step = clock_step  # of the robot's clock, in the middle of executing
        self.clock_offset = 0.0
        self.reports = []
        self._network = Network(random.Random(seed), loss, doubled, latest_s)
        self._sender = StateSender()  # the box's
        self._message = None
        self._beacon_due = self.now
        self._seen = 0  # of the driver's effects
        self._appointments = []  # (time, what the owner does)

    @property
    def now(self):
        return self.driver.now.mono

    def until(self, condition, limit_s=120.0):
        """Let time pass until `condition()` holds."""
        end = self.now + limit_s
        while not condition():
            assert self.now < end, f"{self.session.progress.state.name} after {limit_s} s"
            appointed = self._appointments[0][0] if self._appointments else float("inf")
            following = min(
                self.session.deadline(), self._sender.deadline, self._network.deadline, self._beacon_due, appointed
            )
            self.driver.run(max(0.0, following - self.now) + 1e-9)
            self._network.deliver(self.now)
            while self._appointments and self._appointments[0][0] <= self.now:
                self._appointments.pop(0)[1]()
            self._box_sends()
            self._robot_acts()

    def _box_sends(self):
        for effect in self.driver.effects[self._seen:]:
            if isinstance(effect, effects.SendState):
                self._message = effect.message
                if effect.how is How.CHANGE:
                    self._sender.changed(self.now)
                elif effect.how is How.REPLY:
                    self._sender.reply(self.now)
            elif isinstance(effect, effects.SendBeacon):
                self._beacon_due = self.now
        self._seen = len(self.driver.effects)
        if self._message is not None and self._sender.due(self.now):
            self._network.send(self.now, self._at_robot, state_message(self._message))
        if self.now >= self._beacon_due:
            self._beacon_due = self.now + 1.0
            self._network.send(self.now, self._at_robot_public, beacon_message(self.driver.box.beacon()))

    def _at_robot(self, message):
        self.session.private_message(self.now, message, (BOX, 6667))

    def _at_robot_public(self, message):
        self.session.public_message(self.now, message, (BOX, 6666))

    def _at_box(self, message):
        run = self.driver.run_in()
        if run is not None:
            self.driver.event(self.driver.box.on_robot_report, run.port, ROBOT, report_of(message))

    def _at_box_public(self, message):
        self.driver.event(self.driver.box.on_robot_beacon, ROBOT, TEAM, NAME, time_of(message.time))

    def _robot_acts(self):
        for effect in self.session.poll(self.now, self.driver.now.utc + self.clock_offset):
            if isinstance(effect, fx.SendState):
                self._network.send(self.now, self._at_box, effect.message)
            elif isinstance(effect, fx.SendBeacon):
                self._network.send(self.now, self._at_box_public, effect.message)
            elif isinstance(effect, fx.Prepare):
                self._appointments = [(self.now + PHASE_S, self.session.end_prepare)]
            elif isinstance(effect, fx.Execute):
                tell = [
                    (self.now + 0.1 * number, lambda datum=datum: self.session.add_string(*datum))
                    for number, datum in enumerate(DATA)
                ]
                step = (self.now + PHASE_S / 2, self._step_clock)
                self._appointments = sorted(
                    [*tell, step, (self.now + PHASE_S, self.session.end_execute)], key=lambda entry: entry[0]
                )
            elif isinstance(effect, fx.Stop):
                self._appointments = []
            elif isinstance(effect, fx.Report):
                self.reports.append(effect)

    def _step_clock(self):
        self.clock_offset += self.clock_step

    def run_through(self):
        """Connect, start, and wait until the robot has stopped again and the box has all its strings."""
        self.until(lambda: not self.driver.off("connect"))
        self.driver.command("connect")
        self.until(lambda: not self.driver.off("start"))
        self.driver.command("start")
        self.until(lambda: self.driver.box_state() is BoxState.WAITING_RESULT)
        self.until(lambda: self.driver.box_state() is BoxState.STOP)
        self.until(lambda: self.session.progress.state is RobotState.STOP and not self.session.link.strings_pending)
        return self


def _logged(linked):
    topics = {"activation_event": "activation_event", "notifications": "notification", "visitor": "visitor"}
    entries = linked.driver.bags[linked.driver.run_in().port]
    return {
        field: [value for topic, value in entries if topic.endswith(name)] for field, name in topics.items()
    }


EXPECTED = {field: [text for planned, text in DATA if planned == field] for field, _ in DATA}


@pytest.mark.parametrize("loss, doubled, latest_s", [
    (0.0, 0.0, 0.002), (0.3, 0.0, 0.01), (0.0, 0.5, 0.4), (0.3, 0.3, 0.4), (0.6, 0.2, 0.2)
])
@pytest.mark.parametrize("seed", range(6))
def test_a_run_completes_on_a_bad_network(seed, loss, doubled, latest_s):
    linked = Linked(seed, loss, doubled, latest_s).run_through()
    assert _logged(linked) == EXPECTED
    assert [report for report in linked.reports if report.problem is fx.Problem.UNEXPECTED_STATE] == []


@pytest.mark.parametrize("step", [-0.9, -5.0, -3600.0, 3600.0])
def test_a_run_completes_although_the_robots_clock_is_set(step):
    linked = Linked(1, 0.1, 0.1, 0.05, clock_step=step).run_through()
    assert _logged(linked) == EXPECTED
