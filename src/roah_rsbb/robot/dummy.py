"""A simulated robot: takes part in every benchmark, and misbehaves on request.

As a program: `python -m roah_rsbb.robot.dummy --help`, `rosrun roah_rsbb dummy_robot`. It needs no ROS. Arguments that
roslaunch adds for nodes are ignored.
"""

import argparse
import asyncio
import contextlib
import logging
import os
import random
import sys
import time
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Optional, Tuple

from roah_rsbb.comm.channels import MakePeer
from roah_rsbb.comm.ciphers import PASSWORD_VARIABLE, Cipher, cipher_by_label, own_password
from roah_rsbb.comm.sockets import ANY_HOST
from roah_rsbb.ground import linux
from roah_rsbb.ground.arguments import Parser, add_network, add_password, called, number, read_by
from roah_rsbb.ground.installed import warn_if_replaced
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.client import Behaviour, RobotClient
from roah_rsbb.robot.goals import Goal, HopfResult, HppfResult, Pose, Result
from roah_rsbb.rulebook.registry import DEVICES, OTHER, GoalForm, Profile, ResultForm, profile_of

_log = logging.getLogger("dummy_robot")

SAVE_PERIOD_S = 1.0
CRASH_STATUS = 70  # exit status after a requested crash
PHASES = ("prepare", "execute")

Action = Callable[[RobotClient], None]


@dataclass(frozen=True)
class DummyOptions:
    """How a dummy robot behaves. Durations and skew in seconds."""

    prepare_duration: float = 3.0
    execute_duration: float = 3.0
    never_end: bool = False  # executes until stopped
    crash_in: Optional[str] = None  # one of PHASES
    skew: float = 0.0  # its clock minus the true time
    save_nothing: bool = False  # messages_saved stays 0
    loss: float = 0.0  # share of lost datagrams, in both directions
    seed: Optional[int] = None  # None: a different one each time


# What it does while executing, spread evenly over the time: what a visitor makes it do, and what Granny Annie asks for.
_WELCOME: Tuple[Action, ...] = (
    lambda client: client.activation_event("the bell rang"),
    lambda client: client.notify("going to the door"),
    lambda client: client.visitor("Deli Man"),
    lambda client: client.notify("guiding the visitor"),
    lambda client: client.notify("going to the door"),  # again: the box logs it twice
)
_CATER: Tuple[Action, ...] = (
    lambda client: client.final_command("close the blinds, light, and show me the map"),
    lambda client: client.set_device("switch_1", True),
    lambda client: client.set_device("switch_2", True),
    lambda client: client.set_device("switch_3", True),
    lambda client: client.set_device("dimmer", 70),
    lambda client: client.set_device("blinds", 100),
    lambda client: client.display_map(True),
    lambda client: client.set_device("switch_3", False),
    lambda client: client.set_device("blinds", 0),
    lambda client: client.display_map(False),
)


def _actions(profile: Profile) -> Tuple[Action, ...]:
    """What the dummy does in a benchmark. In an unknown one, it only sends a notification."""
    if profile is not OTHER and "visitor" in profile.uses:
        return _WELCOME
    if profile is not OTHER and DEVICES in profile.uses:
        return _CATER
    text = "switching" if profile.goal is GoalForm.SWITCHES else "on my way"
    return (lambda client: client.notify(text),) if "notifications" in profile.uses else ()


class _NamedLog(logging.LoggerAdapter):
    """Begins each line with a robot's name, if it has one."""

    def process(self, msg: Any, kwargs: Any) -> Tuple[Any, Any]:
        name = self.extra["name"].replace("%", "%%")
        return (f"{name}: {msg}" if name else msg), kwargs


def _crash(status: int) -> None:
    """End the process at once, but say why."""
    logging.shutdown()
    os._exit(status)


class DummyRobot(Behaviour):
    """Waits where a robot would work, and sends what a robot would send."""

    def __init__(
        self, options: DummyOptions, crash: Callable[[int], None] = _crash, name_in_log: str = ""
    ) -> None:
        """`crash` ends the process with this exit status. `name_in_log` is for several robots in one log."""
        self._log = _NamedLog(_log, {"name": name_in_log})
        self._options = options
        self._crash = crash
        self._rng = random.Random(options.seed)

    async def prepare(self, benchmark: str) -> None:
        """Take `prepare_duration`."""
        self._log.info("%s: preparing", benchmark)
        await self._spend("prepare", self._options.prepare_duration, ())
        self._log.info("%s: ready", benchmark)

    async def execute(self, benchmark: str, goal: Optional[Goal]) -> Result:
        """Take `execute_duration`, and return a result that fits the benchmark."""
        profile = profile_of(benchmark)
        self._log.info("%s: executing%s", benchmark, "" if goal is None else f" {_goal_text(goal)}")
        await self._spend("execute", self._options.execute_duration, _actions(profile))
        if self._options.never_end or profile.runs_until_timeout:
            await asyncio.get_event_loop().create_future()
        result = self._result(profile.result)
        self._log.info("%s: complete%s", benchmark, "" if result is None else f", {result}")
        return result

    def stop(self, why: str) -> None:
        """Log it; there is nothing to stop."""
        self._log.info("stopped: %s", why)

    def on_bell(self) -> None:
        """Log it."""
        self._log.info("the bell rings")

    def on_tablet_call(self) -> None:
        """Log it."""
        self._log.info("the tablet calls")

    def on_tablet_position(self, x: float, y: float) -> None:
        """Log it."""
        self._log.info("the tablet sends me to %.2f, %.2f", x, y)

    def on_report(self, report: fx.ProblemIs) -> None:
        """Log it."""
        self._log.log(logging.INFO if report.over else logging.WARNING, "%s", report.text)

    async def _spend(self, phase: str, duration: float, actions: Tuple[Action, ...]) -> None:
        """Wait for `duration`, with the actions evenly spread over it. Offline data is saved each second."""
        count = len(actions) + 1
        plan = [(duration * (number + 1) / count, action) for number, action in enumerate(actions)]
        plan += [(second * SAVE_PERIOD_S, self._save) for second in range(int(duration / SAVE_PERIOD_S) + 1)]
        if self._options.crash_in == phase:
            plan.append((duration / 2, self._die))
        loop = asyncio.get_event_loop()
        began = loop.time()
        for moment, action in sorted(plan, key=lambda entry: entry[0]):
            await asyncio.sleep(began + moment - loop.time())
            action(self.client)
        await asyncio.sleep(began + duration - loop.time())

    def _save(self, client: RobotClient) -> None:
        if not self._options.save_nothing:
            client.messages_saved += 1

    def _die(self, _client: RobotClient) -> None:
        self._log.error("crashing on request")
        self._crash(CRASH_STATUS)

    def _result(self, form: ResultForm) -> Result:
        x, y, theta = (round(self._rng.uniform(0.0, 0.5), 3) for _ in range(3))
        pose = Pose(x, y, theta)
        results: Dict[ResultForm, Result] = {
            ResultForm.OBJECT: HopfResult("cups", "red_cup", pose),
            ResultForm.PERSON: HppfResult("Annie", pose),
            ResultForm.ANY: "SOME RESULT",
            ResultForm.TEXT: "SOME RESULT",
        }
        return results.get(form)


def _goal_text(goal: Goal) -> str:
    """A goal in one line."""
    fields = goal._replace(text=None)._asdict().items()
    return ", ".join(f"{name} {value}" for name, value in fields if value not in (None, ())) or repr(goal.text)


def dummy_client(
    team: str, password: str, robot: str = "DummyRobot", options: Optional[DummyOptions] = None,
    rsbb_host: str = "10.255.255.255", rsbb_port: int = 6666, bind_host: str = ANY_HOST,
    cipher: Cipher = Cipher.AES_128_CBC, name_in_log: str = "", make_peer: Optional[MakePeer] = None,
) -> RobotClient:
    """A client that runs a dummy robot; for arguments and exceptions see `RobotClient` and `DummyRobot`."""
    options = options or DummyOptions()
    network = random.Random(options.seed)
    return RobotClient(
        team, password, DummyRobot(options, name_in_log=name_in_log), robot, rsbb_host, rsbb_port, bind_host, cipher,
        clock=lambda: time.time() + options.skew,
        passes=lambda: network.random() >= options.loss, make_peer=make_peer,
    )


# -- the program ------------------------------------------------------------------------------------

PROGRAM = called("dummy_robot")

_DESCRIPTION = """\
A simulated robot. It joins every run in which the box lists it, prepares and executes for the given times, and sends
what a robot would send. It needs no ROS. Ctrl-C ends it.
"""

_EPILOG = f"""\
The team's password comes from --password-file, the environment variable {PASSWORD_VARIABLE}, or --password, which is
visible in this machine's list of processes.

On the same machine as the box, give each participant its own address, for example 127.0.0.1 for the box and
  {PROGRAM} --team TestingTeam --host 127.255.255.255 --bind 127.0.0.2
"""


def _parser() -> argparse.ArgumentParser:
    parser = Parser(PROGRAM, _DESCRIPTION, _EPILOG)
    who = parser.add_argument_group("identity")
    who.add_argument("--team", required=True, help="team name, as in the box's schedule and passwords")
    who.add_argument("--robot", default="DummyRobot", help="robot name (default: %(default)s)")
    add_password(who)
    network = parser.add_argument_group("network")
    add_network(network)
    network.add_argument("--cipher", type=read_by(cipher_by_label), default=Cipher.AES_128_CBC, metavar="NAME",
                         help="cipher of its messages, such as aes-256-cbc (default: aes-128-cbc)")
    _add_behaviour(parser)
    return parser


def _add_behaviour(parser: argparse.ArgumentParser) -> None:
    usual = DummyOptions()
    work = parser.add_argument_group("behaviour")
    work.add_argument("--prepare-duration", type=number(0, 1e6), default=usual.prepare_duration, metavar="S",
                      help="seconds from PREPARE until ready (default: %(default)s)")
    work.add_argument("--execute-duration", type=number(0, 1e6), default=usual.execute_duration, metavar="S",
                      help="seconds for each goal (default: %(default)s)")
    wrong = parser.add_argument_group("misbehaviour")
    wrong.add_argument("--never-end", action="store_true", help="execute until the box stops it")
    wrong.add_argument("--crash-in", choices=PHASES, help="crash while preparing or executing")
    wrong.add_argument("--skew", type=number(-1e9, 1e9), default=usual.skew, metavar="S",
                       help="offset of its clock in seconds (default: %(default)s)")
    wrong.add_argument("--save-nothing", action="store_true", help="report that no offline data is saved")
    wrong.add_argument("--loss", type=number(0, 1), default=usual.loss, metavar="SHARE",
                       help="share of lost datagrams, in both directions (default: %(default)s)")
    wrong.add_argument("--seed", type=int, help="random seed, for reproducible losses and results")


def _password(options: argparse.Namespace) -> str:
    """Find the password; ValueError if there is none."""
    password = own_password(options.password, options.password_file)
    if password is None:
        raise ValueError(f"no password: use --password-file or the environment variable {PASSWORD_VARIABLE}")
    return password


async def _run(client: RobotClient) -> None:
    """Run until SIGINT or SIGTERM."""
    loop = asyncio.get_event_loop()
    running = loop.create_task(client.run())
    linux.on_end(loop, running.cancel)
    with contextlib.suppress(asyncio.CancelledError):
        await running


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    warn_if_replaced()
    given = sys.argv[1:] if arguments is None else arguments
    # roslaunch appends __name:=... and __log:=..., and may add other remappings.
    options = _parser().parse_args([argument for argument in given if ":=" not in argument])
    robot = options.robot.replace("%", "%%")
    logging.basicConfig(
        level=logging.INFO, stream=sys.stdout, format=f"%(asctime)s {robot}: %(message)s", datefmt="%H:%M:%S"
    )
    behaviour = DummyOptions(
        options.prepare_duration, options.execute_duration, options.never_end, options.crash_in,
        options.skew, options.save_nothing, options.loss, options.seed,
    )
    try:
        client = dummy_client(
            options.team, _password(options), options.robot, behaviour,
            options.host, options.port, options.bind, options.cipher,
        )
        asyncio.run(_run(client))
    except (ValueError, OSError) as error:
        sys.exit(f"{PROGRAM}: {error}")
