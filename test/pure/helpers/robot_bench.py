"""A robot's session on a test bench: simulated time, a box's messages, and the session's effects."""

from helpers.box_beacon import box_beacon
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.session import Session

BOX = "127.0.0.1"
OTHER_BOX = "127.0.0.9"
TEAM, ROBOT, PORT = "Team", "Robot", 6667
UTC0 = 1_800_000_000.0


class Bench:
    """A session, the time, and the session's effects."""

    def __init__(self):
        self.now = 1000.0
        self.clock_offset = 0.0
        self.session = Session(TEAM, ROBOT, self.now)
        self.sent = []  # (time, RobotState)
        self.beacons = []  # (time, RobotBeacon)
        self.news = []  # all other effects, in order
        self.last_time = None  # in the last state that was sent
        self.poll()

    def poll(self):
        """Poll the session, and sort its effects."""
        utc = UTC0 + self.now - 1000.0 + self.clock_offset
        for effect in self.session.poll(self.now, utc):
            if isinstance(effect, (fx.SendState, fx.WouldSendState)):
                self.sent.append((self.now, effect.message))
                self.last_time = effect.message.time
            elif isinstance(effect, fx.SendBeacon):
                self.beacons.append((self.now, effect.message))
            else:
                self.news.append(effect)

    def run(self, seconds):
        """Advance the time, and poll when the session requires it."""
        end = self.now + seconds
        for _ in range(100_000):
            deadline = self.session.deadline()
            if deadline > end:
                break
            self.now = max(self.now, deadline)
            self.poll()
        else:
            raise AssertionError("the session wants to be polled all the time")
        self.now = end
        self.poll()

    def take_news(self, *kinds):
        """Return the effects since the last call without sent messages; only of these kinds, if any are given."""
        news, self.news = self.news, []
        return [effect for effect in news if not kinds or isinstance(effect, kinds)]

    def take_sent(self):
        """The states sent since the last call."""
        sent, self.sent = self.sent, []
        return [message for _, message in sent]

    def beacon(self, port=PORT, host=BOX, **fields):
        """The box's beacon; it lists the robot with `port`, or not at all for None."""
        listed = [("X", ROBOT, 7000), *((TEAM, ROBOT, number) for number in (port,) if number is not None)]
        self.session.public_message(self.now, box_beacon(*listed, **fields), (host, 6666))
        self.poll()

    def box_says(self, state, code="HGTKMH", host=BOX, acknowledge=None, **fields):
        """The box sends its state; it acknowledges the last message, or `acknowledge`."""
        time = acknowledge or self.last_time
        message = pb.BenchmarkState(benchmark_type=code, benchmark_state=int(state), **fields)
        if time is not None:
            message.acknowledgement.CopyFrom(time)
        self.session.private_message(self.now, message, (host, PORT))
        self.poll()

    def do(self, method, *arguments):
        """The owner calls a method of the session."""
        getattr(self.session, method)(*arguments)
        self.poll()

    @property
    def state(self):
        return self.session.progress.state

    @property
    def last(self):
        return self.sent[-1][1]


def linked_bench():
    """A bench with a robot in a run: listed, its channel open, in STOP, its effects taken."""
    bench = Bench()
    bench.beacon()
    bench.take_news()
    return bench


def executing(bench, code="HGTKMH", **goal):
    """Bring the robot of a linked bench to EXECUTING; `goal`: fields of the GOAL_TX message."""
    bench.box_says(BoxState.PREPARE, code)
    bench.do("end_prepare")
    bench.box_says(BoxState.GOAL_TX if goal else BoxState.WAITING_RESULT, code, **goal)
    assert bench.state is RobotState.EXECUTING
    bench.take_news()
    return bench
