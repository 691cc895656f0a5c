"""Robots: the client that teams use, on computers of their own."""

from roah_rsbb.protocol import RobotState
from roah_rsbb.robot.client import RobotClient
from roah_rsbb.robot.dummy import DummyOptions, DummyRobot

from .air import BROADCAST
from .scheduler import Process


class Robot:
    """A robot, and what starts its program again."""

    def __init__(self, world, computer, team, name, password, options):
        self.world, self.computer, self.team, self.name = world, computer, team, name
        self._password, self._options = password, options
        self.starts = 0
        self.saves_nothing = False  # its offline data
        self.process = self.client = None

    def start(self):
        """Switch it on."""
        if self.is_on:
            return
        self.starts += 1
        self.process = Process(self.computer, f"{self.name} {self.starts}")
        options = DummyOptions(seed=self.starts, save_nothing=self.saves_nothing, **self._options)
        self.client = RobotClient(
            self.team, self._password, DummyRobot(options), self.name, BROADCAST, 6666, self.computer.host,
            clock=self.computer.utc, make_peer=self.world.air.peer_maker(self.process),
            random_bytes=self.world.random_bytes)
        self.client.messages_saved = 0 if self.saves_nothing else 1
        self.process.loop.create_task(self.client.run())

    def crash(self, restart_s):
        """Its program ends, and is started again."""
        self.world.trace.note(f"{self.name} crashes")
        if self.is_on:
            self.process.end()
        self.world.scheduler.after(restart_s, self.start)

    def hang(self, seconds):
        """Its program does nothing for a while."""
        if self.is_on:
            self.process.hang(seconds)

    def complete_after(self, seconds):
        """From its next start on, it completes its task so long after it was let go."""
        self._options.update(execute_duration=seconds - self._options["prepare_duration"], never_end=False)

    @property
    def executes_s(self):
        """How long it executes."""
        return float("inf") if self._options["never_end"] else self._options["execute_duration"]

    @property
    def is_on(self):
        """Whether its program exists."""
        return self.process is not None and not self.process.is_ended

    @property
    def is_running(self):
        """Whether its program runs and does not hang."""
        return self.is_on and not self.process.is_hanging()

    @property
    def state(self):
        """What the robot does now, whatever the box thinks."""
        return self.client.state if self.is_on else RobotState.STOP

    @property
    def link(self):
        """Its end of the private channel; None: it has none."""
        runner = self.client._runner if self.is_on else None
        return None if runner is None else runner.session.link
