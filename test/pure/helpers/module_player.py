"""A node of benchmarking modules that makes the test's requests, beside a box in simulated time."""

from helpers.box_driver import BoxDriver
from helpers.competition import competition, event
from roah_rsbb.core import effects
from roah_rsbb.model.modules import ModuleInfo, ModulesState, Progress, Request, RequestKind
from roah_rsbb.protocol import RobotState

BEAT_S = 0.5


class FunctionalityDriver(BoxDriver):
    """A box whose modules must be sent every change of their runs."""

    def event(self, method, *arguments):
        """See `BoxDriver.event`. Asserts that a change was sent, if the runs changed."""
        before, done = self._for_modules(), len(self.effects)
        try:
            return super().event(method, *arguments)
        finally:
            if self._for_modules() != before:
                assert any(isinstance(effect, effects.ModuleRunsChanged) for effect in self.effects[done:]), \
                    "a run changed, and its module does not know"

    def _for_modules(self):
        return [run._replace(elapsed_s=0.0) for run in self.box.modules.runs()]  # the time passes without a message


class FakeModules:
    """Publishes its benchmark and its progress in its run."""

    def __init__(self, driver, *codes, node="n1", problems=(), warnings=()):
        self.driver = driver
        self.node = node
        self.infos = tuple(ModuleInfo(code, tuple(problems), tuple(warnings)) for code in codes)
        self.progress = {}  # run's identity -> Progress

    def beat(self):
        """Publish the whole state once."""
        state = ModulesState(self.node, self.infos, tuple(self.progress.values()))
        self.driver.event(self.driver.box.modules.on_modules, state)

    def run(self, zone="tbm"):
        """What the core publishes of the run in a zone."""
        return next(run for run in self.driver.box.modules.runs() if run.zone == zone)

    def says(self, zone="tbm", **fields):
        """Continue from the last progress in this attempt, with these fields changed."""
        run = self.run(zone)
        last = self.progress.get(run.run)
        if last is None or last.attempt != run.attempt:
            last = Progress(run.run, run.attempt)
        self.progress[run.run] = last._replace(**fields)
        self.beat()

    def asks(self, kind=RequestKind.GOAL, zone="tbm", **fields):
        """Ask for the next thing."""
        request = Request(len(self.run(zone).steps) + 1, kind, **fields)
        self.says(zone, request=request)
        return request

    def outcome(self, zone="tbm"):
        """The outcome of the last step; None: it is still open."""
        return self.run(zone).steps[-1].outcome

    def lives(self, seconds, robot=None):
        """Advance the time. The node publishes twice a second, and the robot repeats its report once a second."""
        end = self.driver.now.mono + seconds
        beats = 0
        while self.driver.now.mono < end - 1e-9:
            self.driver.run(min(BEAT_S, end - self.driver.now.mono))
            self.beat()
            beats += 1
            if robot is not None and beats % 2 == 0:
                robot.says(after=0.0)


class ScriptedModules(FakeModules):
    """Makes a script's requests in order, and finishes after the last one."""

    def __init__(self, driver, code, script, **kwargs):
        super().__init__(driver, code, **kwargs)
        self.script = script  # (kind, fields of the request)

    def proceed(self):
        """Publish the present state: the next request, once the last one has its outcome."""
        for run in self.driver.box.modules.runs():
            steps = len(run.steps)
            if run.running and (not steps or run.steps[-1].outcome is not None):
                if steps < len(self.script):
                    kind, fields = self.script[steps]
                    self.asks(kind, run.zone, **fields)
                else:
                    self.says(run.zone, finished=True, request=run.steps[-1].request)
        self.beat()


def functionality(code="HNF", goal=120.0, total=600.0, settings=None, **of_event):
    """A box, its modules, and a robot: connected, not started yet."""
    config = competition(tbm=[event(code, timeout=goal, total_timeout=total, **of_event)])
    driver = FunctionalityDriver(config, settings)
    modules = FakeModules(driver, code)
    modules.beat()
    robot = driver.connected()
    modules.beat()
    return driver, modules, robot


def started(*args, **kwargs):
    """The same, started: the module may ask."""
    driver, modules, robot = functionality(*args, **kwargs)
    driver.command("start")
    return driver, modules, robot


def does_goal(robot, **result):
    """The robot goes from PREPARE through its goal to a result."""
    for state in (RobotState.PREPARING, RobotState.WAITING_GOAL, RobotState.EXECUTING):
        robot.says(state)
    robot.says(RobotState.RESULT_TX, **result)
