"""`rosrun roah_rsbb dummy_box` and `roah-rsbb dummy-box`: the box for a laptop, without ROS and panels.

It is the same core as in a competition, with the shipped rules and parameters. A script stands for the referee, and a
simulated test bed for the ground truth.
"""

import argparse
import asyncio
import contextlib
import enum
import math
import sys
import time
from types import SimpleNamespace
from typing import Callable, List, Optional, Sequence

from roah_rsbb.bmbox.framework.ground_truth import GroundTruth, Pose2D, Pose3
from roah_rsbb.bmbox.framework.parameters import read_parameters
from roah_rsbb.bmbox.framework.rule_files import modules
from roah_rsbb.bmbox.framework.runner import ModuleRunner
from roah_rsbb.bmbox.host.dummy_world import DummyWorld
from roah_rsbb.check.box import another_box
from roah_rsbb.comm import sockets
from roah_rsbb.comm.channels import MakePeer, Network
from roah_rsbb.comm.ciphers import PASSWORD_VARIABLE, Cipher, own_password
from roah_rsbb.core import effects
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.box import Box
from roah_rsbb.core.effects import Effect
from roah_rsbb.core.runs.functionality import FunctionalityRun
from roah_rsbb.core.runs.run import ZoneRun
from roah_rsbb.core.settings import Settings
from roah_rsbb.ground import linux
from roah_rsbb.ground.arguments import Parser, add_network, add_password, called, number
from roah_rsbb.ground.installed import NotShipped, shipped_folder, warn_if_replaced
from roah_rsbb.model.modules import ModuleInfo, ModulesState, Progress, RequestKind, RunForModule
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.records import EndReason, Phase, ScoreValue
from roah_rsbb.protocol import RobotState
from roah_rsbb.radio.driver import NetworkDriver
from roah_rsbb.radio.radio import beacon_size
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, Benchmark, Config, ScheduledEvent, ZonePlan
from roah_rsbb.rulebook.config import load_benchmarks
from roah_rsbb.rulebook.errors import ConfigErrors
from roah_rsbb.rulebook.registry import PROFILES, BenchmarkKind, GoalForm
from roah_rsbb.wording.sheets import score_line
from roah_rsbb.wording.texts import escaped

PROGRAM = called("dummy_box")
ZONE = "laptop"
STEP_S = 0.1
# The robot must have reported STOP, and its clock must be known.
RETRY_S = 0.5
STOPPED_S = 3.0


class DummyExit(enum.IntEnum):
    """Exit statuses. `--help` lists them."""

    COMPLETED = 0
    NOT_COMPLETED = 1
    USAGE = 2
    NOT_STARTED = 3
    INTERRUPTED = 130


class WorldTruth(GroundTruth):
    """The poses of a simulated test bed."""

    def __init__(self, world: DummyWorld) -> None:
        self._world = world

    def pose(self, frame: str, at_utc: Optional[float] = None) -> Pose3:
        """See `GroundTruth.pose`."""
        return self._world.poses()[frame]


class DummyBox(NetworkDriver):
    """The box, its benchmarking module, and a referee who does everything at once."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        network: Network,
        team: str,
        password: str,
        benchmark: Benchmark,
        parameters: SimpleNamespace,
        say: Callable[[str], None],
        listen_duration: float,
        seed: int = 0,
        utc: Callable[[], float] = time.time,
        make_peer: Optional[MakePeer] = None,
    ) -> None:
        """`say` shows a line. `parameters`: of the benchmark's module, if it has one."""
        owner = ALL_TEAMS if benchmark.kind is BenchmarkKind.ALL_ROBOTS else team
        event = ScheduledEvent(benchmark, owner, 1, 1, utc())
        config = Config({benchmark.code: benchmark}, {team: password}, (ZonePlan(ZONE, (event,)),))
        settings = Settings(network.rsbb_port, listen_duration=listen_duration, auto_next=False,
                            max_datagram=network.max_datagram)
        super().__init__(loop, Box(config, settings, beacon_size), network, config.passwords, say, utc, make_peer)
        self.gave_up: Optional[str] = None
        self._code = benchmark.code
        self._say = say
        self._world = DummyWorld(seed)
        self._kind = modules().get(benchmark.code)
        self._parameters = parameters
        self._runner: Optional[ModuleRunner] = None
        self._identity = ""

    @property
    def run(self) -> Optional[ZoneRun]:
        """The run; None: no robot is connected."""
        return self.box.zones[ZONE].run

    async def conduct(self, robot: str) -> Optional[EndReason]:
        """Lead the team's robot through one run. Returns how it ended; None: another box is on the network."""
        working = self._loop.create_task(self._work())
        try:
            await self._press("connect", robot)
            await self._press("start")
            while self.gave_up is None and self.run is not None and self.run.phase is Phase.RUNNING:
                await asyncio.sleep(STEP_S)
            run = self.run
            await self._stopped()
            return None if run is None else run.end_reason
        except asyncio.CancelledError:
            await self._halt()
            raise
        finally:
            working.cancel()
            self._leave()

    async def _halt(self) -> None:
        """Stop the robot, and wait until it reports that it has stopped."""
        with contextlib.suppress(Refused):
            self.event(self.box.act, Target(ZONE), "stop")
        await self._stopped()

    def scores(self) -> List[str]:
        """The module's scores, as lines."""
        run = self.run
        return [] if run is None else [escaped(_score_line(score)) for score in run.scores]

    def on_effect(self, effect: Effect) -> None:
        """Show what the referee sees, and let the module answer."""
        if isinstance(effect, effects.Notice):
            self._say(escaped(effect.text))
        elif isinstance(effect, effects.ModuleRunsChanged):
            self._loop.call_soon(self._modules)
        elif isinstance(effect, effects.AnotherBox):
            self.gave_up = another_box(effect.host)

    async def _press(self, command: str, robot: str = "") -> None:
        """Press a button as soon as it is possible, and show why it is not."""
        shown: List[str] = []
        while self.gave_up is None:
            reasons = self.box.actions.off(self.now(), self.box.zones[ZONE], command)
            if not reasons:
                with contextlib.suppress(Refused):
                    self.event(self.box.act, Target(ZONE), command, "", {"robot": robot} if robot else {})
                    return
            if reasons != shown and "listening" not in "".join(reasons):
                self._say(f"waiting to {command}: {'; '.join(map(escaped, reasons))}")
                shown = reasons
            await asyncio.sleep(RETRY_S)

    async def _stopped(self) -> None:
        end = self._loop.time() + STOPPED_S
        while self.run is not None and self._loop.time() < end and any(
                member.robot_state not in (None, RobotState.STOP) for member in self.run.members()):
            await asyncio.sleep(STEP_S)

    def _leave(self) -> None:
        for line in self.scores():
            self._say(line)
        with contextlib.suppress(Refused):
            self.event(self.box.act, Target(ZONE), "disconnect", "", {"running": True})

    # -- test bed, module and manual operations --------------------------------------------------------

    async def _work(self) -> None:
        """Move the test bed, publish the module's state, and do the manual operations."""
        while True:
            self._world.step(self._loop.time(), self.box.modules.runs())
            self._modules()
            self._operate()
            await asyncio.sleep(STEP_S)

    def _modules(self) -> None:
        if self._kind is None:
            return
        runs = self.box.modules.runs()
        progress = [self._progress(run) for run in runs]
        state = ModulesState(PROGRAM, (ModuleInfo(self._code),), tuple(one for one in progress if one is not None))
        self.event(self.box.modules.on_modules, state)

    def _progress(self, run: RunForModule) -> Optional[Progress]:
        if self._runner is None or run.run != self._identity:
            self._runner = ModuleRunner(self._kind, lambda: self._parameters, WorldTruth(self._world))
            self._identity = run.run
        self._runner.on_run(run)
        self._runner.tick(self.now().utc)
        return self._runner.progress()

    def _operate(self) -> None:
        run = self.run
        asked = run.asked if isinstance(run, FunctionalityRun) else None
        if asked is None:
            return
        if asked.kind is RequestKind.SWITCHES:
            goal = next(step.request for step in reversed(run.steps) if step.request.switches)
            for switch in goal.switches:
                self.event(self.box.act, Target(ZONE), "switch", "", {"number": switch})
            self.event(self.box.act, Target(ZONE), "confirm_switches")
        else:
            self.event(self.box.act, Target(ZONE), "operation", "", {"operation": asked.number})


def _score_line(score: ScoreValue) -> str:
    return ": ".join(part for part in (score.group, *score_line(score)) if part)


# -- the program ------------------------------------------------------------------------------------

_DESCRIPTION = """\
The referee's box for a laptop: leads one robot of a team through a run. It is the same core as in a competition, with
the shipped rules. Manual operations count as done at once, and a simulated test bed gives the ground truth, so scores
are invented. It needs no ROS. Ctrl-C stops the robot and ends the run.
"""

_EPILOG = f"""\
The team's password comes from --password-file, the environment variable {PASSWORD_VARIABLE}, or --password, which is
visible in this machine's list of processes.

Robot and box on one machine: give each its own address, for example
  {PROGRAM} --team TestingTeam --password-file key.txt --benchmark HNF --host 127.255.255.255 --bind 127.0.0.1
and 127.0.0.2 for the robot.

exit status: 0 the robot completed the benchmark, 1 it did not, 2 wrong arguments, 3 the box could not start,
  130 interrupted
"""


def _waypoints(text: str) -> List[Pose2D]:
    found = []
    for part in filter(None, (part.strip() for part in text.split(";"))):
        try:
            numbers = [float(number) for number in part.split(",")]
        except ValueError:
            numbers = []
        if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
            raise argparse.ArgumentTypeError(
                f"{part!r} is not a waypoint: give x,y,theta in metres and radians, such as '1,0.5,0; 2,1.5,1.57'")
        found.append(Pose2D(*numbers))
    if not found:
        raise argparse.ArgumentTypeError("no waypoint is given: give x,y,theta, such as '1,0.5,0; 2,1.5,1.57'")
    return found


def _parser() -> argparse.ArgumentParser:
    parser = Parser(PROGRAM, _DESCRIPTION, _EPILOG)
    who = parser.add_argument_group("robot")
    who.add_argument("--team", required=True, help="team name, exactly as the robot sends it")
    who.add_argument("--robot", default="", help="robot name, if the team has several robots (default: any)")
    add_password(who)
    add_network(parser.add_argument_group("network"))
    what = parser.add_argument_group("run")
    what.add_argument("--benchmark", choices=tuple(PROFILES), default="HGTKMH", metavar="CODE",
                      help=f"one of {', '.join(PROFILES)} (default: %(default)s)")
    what.add_argument("--waypoints", type=_waypoints, metavar="POSES",
                      help="for HNF: 'x,y,theta; x,y,theta', in metres and radians (default: the shipped ones)")
    what.add_argument("--goal-timeout", type=number(0.1, 86400), metavar="S",
                      help="seconds for each goal (default: as in the shipped rules)")
    what.add_argument("--runs", type=int, choices=range(1, 1001), metavar="N", default=1,
                      help="how many runs in a row (default: %(default)s)")
    what.add_argument("--seed", type=int, default=0, help="random seed of the test bed (default: %(default)s)")
    return parser


def parameters_of(code: str, waypoints: Optional[Sequence[Pose2D]], goal_timeout: Optional[float]) -> SimpleNamespace:
    """The shipped parameters of a benchmark with these changes; raises ValueError, ConfigErrors and NotShipped."""
    if waypoints is not None and PROFILES[code].goal is not GoalForm.WAYPOINT:
        raise ValueError(f"--waypoints: {code} has no waypoints. Use --benchmark HNF")
    kind = modules().get(code)
    if kind is None:
        if goal_timeout is not None:
            raise ValueError(f"--goal-timeout: {code} has no goals. Use it with a functionality benchmark")
        return SimpleNamespace()
    found = read_parameters(str(shipped_folder() / "modules" / f"{code}.yaml"), code, kind.PARAMETERS)
    if waypoints is not None:
        found.waypoints = list(waypoints)
    if goal_timeout is not None:
        if "goal_timeout" not in kind.PARAMETERS:
            raise ValueError(f"--goal-timeout: {code} has no timeout of its goals")
        found.goal_timeout = goal_timeout
    return found


async def _conduct(box: DummyBox, options: argparse.Namespace) -> DummyExit:
    loop = asyncio.get_event_loop()
    box.open(Settings().listen_duration)
    completed = 0
    task: Optional[asyncio.Task] = None
    try:
        for count in range(options.runs):
            task = loop.create_task(box.conduct(options.robot))
            linux.on_end(loop, task.cancel)
            ended = await task
            if box.gave_up is not None:
                print(f"{PROGRAM}: {box.gave_up}", file=sys.stderr)
                return DummyExit.NOT_STARTED
            completed += ended is EndReason.COMPLETED
            print(f"run {count + 1} of {options.runs}: {ended.value if ended is not None else 'not begun'}", flush=True)
    except asyncio.CancelledError:
        return DummyExit.INTERRUPTED
    finally:
        box.close()
    return DummyExit.COMPLETED if completed == options.runs else DummyExit.NOT_COMPLETED


def _say(text: str) -> None:
    print(f"{time.strftime('%H:%M:%S')} {text}", flush=True)


async def _start(options: argparse.Namespace, password: str, benchmark: Benchmark,
                 parameters: SimpleNamespace) -> DummyExit:
    network = Network(sockets.resolve(options.host, "--host"), options.port, sockets.resolve(options.bind, "--bind"),
                      Cipher.AES_128_CBC, False, Settings().max_datagram)
    box = DummyBox(asyncio.get_event_loop(), network, options.team, password, benchmark, parameters, _say,
                   Settings().listen_duration, options.seed)
    return await _conduct(box, options)


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    warn_if_replaced()
    parser = _parser()
    given = sys.argv[1:] if arguments is None else arguments
    options = parser.parse_args([argument for argument in given if ":=" not in argument])
    try:
        password = own_password(options.password, options.password_file)
        if not password:
            raise ValueError("the password is missing: use --password-file or the environment variable "
                             f"{PASSWORD_VARIABLE}")
        parameters = parameters_of(options.benchmark, options.waypoints, options.goal_timeout)
        benchmark = load_benchmarks(str(shipped_folder() / "benchmarks.yaml"))[options.benchmark]
    except (ValueError, ConfigErrors, NotShipped) as error:
        parser.error(str(error))
    try:
        sys.exit(asyncio.run(_start(options, password, benchmark, parameters)))
    except OSError as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)
        sys.exit(DummyExit.NOT_STARTED)
