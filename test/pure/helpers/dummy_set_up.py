"""The dummy set-up in simulated time: the box, a benchmarking module, a robot, a referee and a pretended test bed."""

from helpers.config_files import SHIPPED
from helpers.module_player import functionality
from roah_rsbb.bmbox.framework.ground_truth import GroundTruth
from roah_rsbb.bmbox.framework.parameters import read_parameters
from roah_rsbb.bmbox.framework.rule_files import modules
from roah_rsbb.bmbox.framework.runner import ModuleRunner
from roah_rsbb.bmbox.host.dummy_world import DummyWorld
from roah_rsbb.core.actions.table import Target
from roah_rsbb.model.modules import ModuleInfo, ModulesState
from roah_rsbb.model.records import Phase
from roah_rsbb.protocol import BoxState, RobotState

PREPARE_S, EXECUTE_S = 1.0, 3.0
ZONE = "tbm"


class WorldTruth(GroundTruth):
    """Where things are in a dummy world."""

    def __init__(self, world):
        self.world = world

    def pose(self, frame, at_utc=None):
        return self.world.poses()[frame]


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
    """A benchmark with the shipped parameters, from its start to its end."""

    def __init__(self, code, result=lambda: None, goal=120.0, total=1000.0):
        """`result` gives the robot's results; None instead of it: the robot does not end a goal."""
        self.driver, self.fake, robot = functionality(code, goal=goal, total=total)
        self.world = DummyWorld(seed=3)
        self.truth = WorldTruth(self.world)
        self.kind = modules()[code]
        self.worker = Worker(robot, result)
        self.restarts = 0
        self.restart()
        self.driver.command("start", ZONE)

    def restart(self):
        """The modules' process crashes and restarts."""
        self.runner = ModuleRunner(self.kind, self._parameters, self.truth)
        self.restarts += 1

    def _parameters(self):
        code = self.kind.CODE
        return read_parameters(str(SHIPPED / "modules" / f"{code}.yaml"), code, self.kind.PARAMETERS)

    @property
    def run(self):
        return self.driver.run_in(ZONE)

    @property
    def score(self):
        return self.runner.module.score

    def go(self, period_s=0.1, limit_s=2000.0, restart_every_s=None):
        """Go through the run to its end."""
        begin = self.driver.now.mono
        while self.run.phase is Phase.RUNNING:
            since = self.driver.now.mono - begin
            assert since < limit_s, self.runner.progress()
            if restart_every_s and since > restart_every_s * self.restarts:
                self.restart()
            self.step(period_s)

    def step(self, period_s=0.1):
        """All participants do what is due. Then the time advances by this much."""
        driver = self.driver
        self.world.step(driver.now.mono, driver.box.modules.runs())
        self._module()
        asked = self.run.asked
        if asked is not None:
            driver.event(driver.box.act, Target(ZONE), "operation", "", {"operation": asked.number})
            self.world.step(driver.now.mono, driver.box.modules.runs())
        self.worker.step(driver.now.mono, driver.box_state(ZONE))
        driver.run(period_s)

    def _module(self):
        """Exchange messages until neither side has news."""
        said = None
        self.runner.on_run(self.fake.run(ZONE))
        self.runner.tick(self.driver.now.utc)
        while self.runner.progress() != said:
            said = self.runner.progress()
            info = ModuleInfo(self.kind.CODE)
            state = ModulesState(f"node {self.restarts}", (info,), () if said is None else (said,))
            self.driver.event(self.driver.box.modules.on_modules, state)
            self.runner.on_run(self.fake.run(ZONE))
