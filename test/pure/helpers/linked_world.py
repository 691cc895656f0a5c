"""Box and robots, linked in simulated time by a network that loses, doubles, delays and swaps datagrams.

All that passes between them are the bytes of `roah_rsbb.comm`. The box's side of the timing is what the core's
node does: a beacon each second and a `StateSender` for each channel.
"""

import heapq
import itertools

from helpers.box_driver import MONO0, BoxDriver
from helpers.competition import UTC0
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.comm.frame import decode_private, decode_public, encode
from roah_rsbb.comm.sender import StateSender
from roah_rsbb.core import effects
from roah_rsbb.core.effects import How
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState, wire_ns
from roah_rsbb.radio import wire_convert
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.session import Session

BOX_HOST = "10.0.0.1"
PUBLIC_PORT = 6666
SHORTEST_DELAY_S, SHORT_DELAY_S = 0.001, 0.003
BEACON_PERIOD_S = 1.0


class FakeLink:
    """When the copies of a datagram arrive. Probabilities from 0 to 1; `longest_delay` in seconds.

    Only without `jitter` (and late ones) do they arrive in the order in which they were sent.
    """

    def __init__(self, rng, loss=0.0, double=0.0, late=0.0, longest_delay=0.5, jitter=True):
        self._rng = rng
        self._loss = loss
        self._double = double
        self._late = late
        self._longest_delay = longest_delay
        self._short_delay = SHORT_DELAY_S if jitter else SHORTEST_DELAY_S

    def delays(self):
        copies = 0 if self._rng.random() < self._loss else 2 if self._rng.random() < self._double else 1
        return [self._delay() for _ in range(copies)]

    def _delay(self):
        is_late = self._rng.random() < self._late
        return self._rng.uniform(SHORTEST_DELAY_S, self._longest_delay if is_late else self._short_delay)


class RadioBox(BoxDriver):
    """A box whose states wait here for the world to send them."""

    def __init__(self, config, settings=None):
        self.senders = {}  # port -> StateSender
        super().__init__(config, settings)

    def _carry_out(self, effect):
        super()._carry_out(effect)
        if isinstance(effect, effects.OpenChannel):
            self.senders[effect.port] = StateSender()
        elif isinstance(effect, effects.CloseChannel):
            del self.senders[effect.port]
        elif isinstance(effect, effects.SendState) and effect.how is How.CHANGE:
            self.senders[effect.port].changed(self.now.mono)
        elif isinstance(effect, effects.SendState) and effect.how is How.REPLY:
            self.senders[effect.port].reply(self.now.mono)


class RadioRobot:
    """A robot that does its task; `prepare_s` and `execute_s` are the seconds that this takes it."""

    def __init__(self, world, team, name, host, key, skew=0.0, prepare_s=1.0, execute_s=5.0):
        self.world = world
        self.team, self.name, self.host, self.key, self.skew = team, name, host, key, skew
        self.prepare_s, self.execute_s = prepare_s, execute_s
        self.port = None  # of its open private channel
        self.states = [RobotState.STOP]
        self.tasks = 0  # how many were begun
        self.troubles = []
        self._next = None  # (time, what the robot does then)
        self.crash()

    def crash(self):
        """The robot's program ends, and starts again."""
        self.port = None
        self._next = None
        self.session = Session(self.team, self.name, self.world.mono)
        self.session.progress.messages_saved = 1

    def set_clock(self, skew):
        """Somebody sets the robot's clock."""
        self.skew = skew
        self.world.clocks_are_set = True

    def end_execute(self):
        """The robot ends its goal before its time. Raises `IllegalEvent`."""
        self.session.end_execute()
        self._next = None

    def deadline(self):
        return min(self.session.deadline(), self._next[0] if self._next else float("inf"))

    def _end_of(self, mono, execute):
        """When the robot ends a goal, and how; None: it does not end it."""
        return mono + self.execute_s, self.session.end_execute

    def poll(self):
        mono = self.world.mono
        if self._next and self._next[0] <= mono:
            act, self._next = self._next[1], None
            act()
        for effect in self.session.poll(mono, self.world.utc + self.skew):
            self._carry_out(mono, effect)

    def _carry_out(self, mono, effect):
        if isinstance(effect, fx.SendBeacon):
            self.world.send_public(self, encode(effect.message))
        elif isinstance(effect, fx.SendState):
            self.world.send_private(self, encode(effect.message, Cipher.AES_128_CBC, self.key))
        elif isinstance(effect, fx.OpenChannel):
            self.port = effect.port
        elif isinstance(effect, fx.CloseChannel):
            self.port = None
        elif isinstance(effect, fx.StateIs):
            self.states.append(effect.state)
        elif isinstance(effect, fx.Prepare):
            self._next = (mono + self.prepare_s, self.session.end_prepare)
        elif isinstance(effect, fx.Execute):
            self.tasks += 1
            self._next = self._end_of(mono, effect)
        elif isinstance(effect, fx.Stop):
            self._next = None
        elif isinstance(effect, fx.ProblemIs):
            self.troubles.append(effect)


class World:
    """The box (`box`), its robots, the time, and the datagrams on their way."""

    def __init__(self, config, link, settings=None):
        self.link = link
        self.box = RadioBox(config, settings)
        self.keys = {team: Key(password) for team, password in config.passwords.items()}
        self.robots = []
        self.companions = []  # what else lives in this world: deadline() and poll()
        self.mono = self.box.now.mono
        self.stale = 0  # datagrams of robots that came too late
        self.clocks_are_set = False  # then older times may be newer
        self._newest = {}  # port -> newest time of a robot's state that arrived, ns
        self._number = itertools.count()
        self._air = []  # heap of (time of arrival, number, deliver, arguments)
        self._beacon_due = self.mono

    @property
    def utc(self):
        return UTC0 + self.mono - MONO0

    def add_robot(self, team="Alpha", name="r1", host=None, **of_robot):
        host = host or f"10.0.0.{len(self.robots) + 2}"
        self.robots.append(RadioRobot(self, team, name, host, self.keys[team], **of_robot))
        return self.robots[-1]

    # -- time -----------------------------------------------------------------------------------------

    def run(self, seconds):
        self.run_until(lambda: False, seconds)

    def run_until(self, is_true, limit_s):
        """Advance the time until a condition is true. Returns whether it became true within the limit."""
        end = self.mono + limit_s
        while not is_true():
            due = self._next_due()
            if due > end:
                self._set_time(end)
                return is_true()
            self._set_time(max(due, self.mono))
            self._do_what_is_due()
        return True

    def _next_due(self):
        due = [self._beacon_due, self.box.box.timers.deadline(), *(s.deadline for s in self.box.senders.values())]
        due += [one.deadline() for one in (*self.robots, *self.companions)]
        due += [self._air[0][0]] if self._air else []
        return min(time for time in due if time is not None)

    def _set_time(self, mono):
        self.mono = mono
        self.box.now = Now(mono, self.utc)

    def _do_what_is_due(self):
        while self._air and self._air[0][0] <= self.mono:
            _, _, deliver, arguments = heapq.heappop(self._air)
            deliver(*arguments)
        self.box.event(self.box.box.timers.tick)
        if self._beacon_due <= self.mono:
            self._beacon_due = self.mono + BEACON_PERIOD_S
            self.box.effects.append(effects.SendBeacon())
        self._send_of_box()
        for one in (*self.robots, *self.companions):
            if one.deadline() <= self.mono:
                one.poll()

    # -- datagrams ------------------------------------------------------------------------------------

    def send_public(self, robot, datagram):
        self._send(self._at_box, robot.host, PUBLIC_PORT, datagram)

    def send_private(self, robot, datagram):
        self._send(self._at_box, robot.host, robot.port, datagram)

    def _send(self, deliver, *arguments):
        for delay in self.link.delays():
            heapq.heappush(self._air, (self.mono + delay, next(self._number), deliver, arguments))

    def _send_of_box(self):
        box = self.box.box
        for _ in self.box.taken(effects.SendBeacon):
            datagram = encode(wire_convert.beacon_message(box.beacon()))
            for robot in self.robots:
                self._send(self._at_robot, robot, PUBLIC_PORT, datagram)
        for port, sender in self.box.senders.items():
            run = box.zones.run_at(port)
            if not sender.due(self.mono):
                continue
            message = wire_convert.state_message(run.message)
            datagram = encode(message, Cipher.AES_128_CBC, self.keys[run.robot.team])
            for robot in self.robots:
                if robot.host == self.box.channels[port]:
                    self._send(self._at_robot, robot, port, datagram)

    def _at_robot(self, robot, port, datagram):
        address = (BOX_HOST, port)
        if port == PUBLIC_PORT:
            robot.session.public_message(self.mono, decode_public(datagram), address)
        elif port == robot.port:
            robot.session.private_message(self.mono, decode_private(datagram, robot.key), address)
        robot.poll()

    def _at_box(self, host, port, datagram):
        box = self.box.box
        if port == PUBLIC_PORT:
            message = decode_public(datagram)
            time = wire_convert.time_of(message.time)
            self.box.event(box.arrivals.on_robot_beacon, host, message.team_name, message.robot_name, time)
            return
        run = box.zones.run_at(port)
        if run is None:
            return
        message = decode_private(datagram, self.keys[run.robot.team])
        assert isinstance(message, pb.RobotState)
        report = wire_convert.report_of(message)
        before = self._moved(run)
        self.box.event(box.arrivals.on_robot_report, port, host, report)
        if wire_ns(report.time) <= self._newest.get(port, -1):
            self.stale += 1
            assert self.clocks_are_set or self._moved(run) == before, "a stale message moved something"
        self._newest[port] = max(wire_ns(report.time), self._newest.get(port, -1))

    def _moved(self, run):
        return run.message, run.phase, run.robot_state, run.log, len(self.box.bags[run.port])

    # -- the referee ----------------------------------------------------------------------------------

    def press(self, command, zone="tbm", limit_s=30.0):
        """Wait until a button is enabled, and press it."""
        assert self.run_until(lambda: not self.box.off(command, zone), limit_s), self.box.off(command, zone)
        try:
            self.box.command(command, zone)
        except Refused as refused:
            raise AssertionError(f"{command} was on and was refused: {refused}") from None
        self._send_of_box()

    def box_states(self, port):
        """The states that the box was in, each change."""
        states = (message.state for message in self.box.states[port])
        return [state for state, _ in itertools.groupby(states)]


# What may follow what in the box, where no goal is explicit (docs/protocol.md, "State machines").
LEGAL = {
    (BoxState.STOP, BoxState.PREPARE), (BoxState.PREPARE, BoxState.WAITING_RESULT),
    (BoxState.WAITING_RESULT, BoxState.STOP), (BoxState.WAITING_RESULT, BoxState.PREPARE),
    (BoxState.PREPARE, BoxState.STOP),
}
LEGAL_ROBOT = {
    (RobotState.STOP, RobotState.PREPARING), (RobotState.PREPARING, RobotState.WAITING_GOAL),
    (RobotState.WAITING_GOAL, RobotState.EXECUTING), (RobotState.EXECUTING, RobotState.RESULT_TX),
    (RobotState.RESULT_TX, RobotState.PREPARING),
    *((state, RobotState.STOP) for state in RobotState if state is not RobotState.STOP),
}


# What comes in addition where the robot is sent a goal.
LEGAL_GOAL = {
    (BoxState.PREPARE, BoxState.GOAL_TX), (BoxState.GOAL_TX, BoxState.WAITING_RESULT),
    (BoxState.GOAL_TX, BoxState.PREPARE), (BoxState.GOAL_TX, BoxState.STOP),
}


def assert_legal(world, port, robot, explicit_goal=False):
    """Both ends went from state to state as the tables allow it."""
    states = world.box_states(port)
    legal = LEGAL | LEGAL_GOAL if explicit_goal else LEGAL
    assert set(zip(states, states[1:])) <= legal, states
    assert set(zip(robot.states, robot.states[1:])) <= LEGAL_ROBOT, robot.states
