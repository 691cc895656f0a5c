"""The dummy set-up without ROS, in simulated time: box, host of modules with simulated frames, robot and referee."""

from helpers.config_files import SHIPPED
from helpers.module_player import functionality
from roah_rsbb.bmbox.host.dummy_world import DummyFrames
from roah_rsbb.bmbox.host.ground_truth_of_frames import ZonesGroundTruth
from roah_rsbb.bmbox.host.host import ModulesHost
from roah_rsbb.core.actions.table import Target
from roah_rsbb.model.records import Phase
from roah_rsbb.protocol import BoxState, RobotState

PREPARE_S, EXECUTE_S = 1.0, 3.0
ZONE = "tbm"


class Timers:
    """The timers of an asyncio loop, at the test's time."""

    class Timer:
        """A call at a time."""

        def __init__(self, at, function):
            self.at, self.function, self.is_cancelled = at, function, False

        def cancel(self):
            self.is_cancelled = True

    def __init__(self, mono):
        self.mono = mono  # returns the time
        self.waiting = []

    def call_later(self, seconds, function):
        self.waiting.append(self.Timer(self.mono() + seconds, function))
        return self.waiting[-1]

    def turn(self):
        """Call what is due."""
        due = [timer for timer in self.waiting if timer.at <= self.mono() + 1e-9 or timer.is_cancelled]
        self.waiting = [timer for timer in self.waiting if timer not in due]
        for timer in due:
            if not timer.is_cancelled:
                timer.function()


class Worker:
    """A robot that prepares and executes for a while, as a dummy robot does; its results are those of `result`."""

    def __init__(self, robot, result):
        self.robot = robot
        self.result = result
        self.since = 0.0  # seconds of the box's clock
        self.texts = {}

    def step(self, now_s, box_state):
        """Report the robot's position."""
        state = self.robot.state
        new = state
        if box_state is BoxState.STOP:
            new = RobotState.STOP
        elif box_state is BoxState.PREPARE and state in (RobotState.STOP, RobotState.RESULT_TX, RobotState.EXECUTING):
            new = RobotState.PREPARING
        elif state is RobotState.PREPARING and now_s - self.since >= PREPARE_S:
            new = RobotState.WAITING_GOAL
        elif state is RobotState.WAITING_GOAL and box_state in (BoxState.GOAL_TX, BoxState.WAITING_RESULT):
            new = RobotState.EXECUTING
        elif state is RobotState.EXECUTING and self.result is not None and now_s - self.since >= EXECUTE_S:
            new, self.texts = RobotState.RESULT_TX, {"generic_result": self.result()}
        if new is not state:
            self.since = now_s
        if new is not RobotState.RESULT_TX:
            self.texts = {}
        self.robot.says(new, **self.texts)


class DummySetUp:
    """A benchmark with the shipped parameters and ground truth, from its start to its end."""

    def __init__(self, code, result=lambda: None, goal=120.0, total=1000.0):
        """`result` gives the robot's results; None instead of it: the robot does not end a goal."""
        self.driver, _, robot = functionality(code, goal=goal, total=total)
        self.code = code
        self.frames = DummyFrames(3, lambda: self.driver.now.utc)
        self.worker = Worker(robot, result)
        self.restarts = 0
        self.restart()
        self.driver.command("start", ZONE)

    def restart(self):
        """The process of the modules crashes and restarts."""
        folder, driver = str(SHIPPED / "modules"), self.driver
        self.timers, self.taken = Timers(lambda: driver.now.mono), None
        self.truth = ZonesGroundTruth(folder, lambda: self.frames)
        self.host = ModulesHost(
            self.timers, folder, [self.code], self.truth,
            lambda state: driver.event(driver.box.modules.on_modules, state), lambda: driver.now.utc)
        self.host.start()
        self.restarts += 1

    @property
    def run(self):
        return self.driver.run_in(ZONE)

    def go(self, period_s=0.1, limit_s=2000.0, restart_every_s=None):
        """Go through the run to its end."""
        begin = self.driver.now.mono
        while self.run.phase is Phase.RUNNING:
            since = self.driver.now.mono - begin
            assert since < limit_s, self.run.asked
            if restart_every_s and since > restart_every_s * self.restarts:
                self.restart()
            self.step(period_s)

    def step(self, period_s=0.1):
        """All participants do what is due. Then the time advances by this much."""
        driver = self.driver
        self.timers.turn()
        while self.taken != driver.box.modules.runs():
            self.taken = driver.box.modules.runs()
            self.host.take(self.taken)
        asked = self.run.asked
        if asked is not None:
            driver.event(driver.box.act, Target(ZONE), "operation", "", {"operation": asked.number})
        self.worker.step(driver.now.mono, driver.box_state(ZONE))
        driver.run(period_s)
