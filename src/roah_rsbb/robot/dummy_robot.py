"""What the dummy robot does: takes part in every benchmark, without a robot, and misbehaves on request."""

import asyncio
import logging
import os
import random
import time
from dataclasses import dataclass
from typing import Any, Callable, Dict, Optional, Tuple

from roah_rsbb.comm.ciphers import Cipher
from roah_rsbb.comm.sockets import ANY_HOST
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.client import Behaviour, RobotClient
from roah_rsbb.robot.goals import Goal, HopfResult, HppfResult, Pose, Result

_log = logging.getLogger("dummy_robot")

SAVE_PERIOD_S = 1.0
CRASH_STATUS = 70  # exit status of a robot that crashes on request
PHASES = ("prepare", "execute")

Action = Callable[[RobotClient], None]


@dataclass(frozen=True)
class DummyOptions:
    """How a dummy robot behaves. Durations and skew in seconds."""

    prepare_duration: float = 3.0
    execute_duration: float = 3.0
    never_end: bool = False  # prepares, then executes until it is stopped
    crash_in: Optional[str] = None  # one of PHASES: dies in the middle of it
    skew: float = 0.0  # its clock minus the true one
    save_nothing: bool = False  # messages_saved stays 0
    loss: float = 0.0  # share of the datagrams that are lost, both ways
    seed: Optional[int] = None  # of all that is left to chance; None: another one each time


# What it does while it executes, spread evenly over the time.
_ACTIONS: Dict[str, Tuple[Action, ...]] = {
    "HWV": (
        lambda client: client.activation_event("the bell rang"),
        lambda client: client.notify("going to the door"),
        lambda client: client.visitor("Deli Man"),
        lambda client: client.notify("guiding the visitor"),
        lambda client: client.notify("going to the door"),  # a second time: the box logs it twice
    ),
    "HCFGAC": (
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
    ),
    "HNF": (lambda client: client.notify("on my way"),),
    "HOMF": (lambda client: client.notify("switching"),),
}


class _NamedLog(logging.LoggerAdapter):
    """Begins each line with a robot's name, if it has one."""

    def process(self, msg: Any, kwargs: Any) -> Tuple[Any, Any]:
        name = self.extra["name"].replace("%", "%%")
        return (f"{name}: {msg}" if name else msg), kwargs


class DummyRobot(Behaviour):
    """Waits where a robot would work, and does what it has to tell."""

    def __init__(
        self, options: DummyOptions, crash: Callable[[int], None] = os._exit, name_in_log: str = ""
    ) -> None:
        """`crash` ends the process at once, with this exit status. `name_in_log`: where several share a log."""
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
        self._log.info("%s: executing%s", benchmark, "" if goal is None else f" {_goal_text(goal)}")
        await self._spend("execute", self._options.execute_duration, _ACTIONS.get(benchmark, ()))
        if self._options.never_end or benchmark == "HPFF":
            # In HPFF the robot follows the person until the time is over (docs/benchmarks.md, "HPFF").
            await asyncio.get_event_loop().create_future()
        result = self._result(benchmark)
        self._log.info("%s: complete%s", benchmark, "" if result is None else f", {result}")
        return result

    def stop(self, why: str) -> None:
        """Say so: there is nothing that could stop."""
        self._log.info("stopped: %s", why)

    def on_bell(self) -> None:
        """Say so."""
        self._log.info("the bell rings")

    def on_tablet_call(self) -> None:
        """Say so."""
        self._log.info("the tablet calls")

    def on_tablet_position(self, x: float, y: float) -> None:
        """Say so."""
        self._log.info("the tablet sends me to %.2f, %.2f", x, y)

    def on_report(self, report: fx.Report) -> None:
        """Say so."""
        self._log.log(logging.INFO if report.over else logging.WARNING, "%s", report.text)

    async def _spend(self, phase: str, duration: float, actions: Tuple[Action, ...]) -> None:
        """Let `duration` pass, with the actions evenly in it, and offline data saved each second."""
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
        self._log.error("crashing, as I was told to")
        self._crash(CRASH_STATUS)

    def _result(self, benchmark: str) -> Result:
        x, y, theta = (round(self._rng.uniform(0.0, 0.5), 3) for _ in range(3))
        pose = Pose(x, y, theta)
        results: Dict[str, Result] = {
            "HOPF": HopfResult("cups", "red_cup", pose),
            "HPPF": HppfResult("Annie", pose),
            "STB": "SOME RESULT",
        }
        return results.get(benchmark)


def _goal_text(goal: Goal) -> str:
    """A goal in one line."""
    fields = goal._replace(text=None)._asdict().items()
    return ", ".join(f"{name} {value}" for name, value in fields if value not in (None, ())) or repr(goal.text)


def dummy_client(
    team: str, password: str, robot: str = "DummyRobot", options: Optional[DummyOptions] = None,
    rsbb_host: str = "10.255.255.255", rsbb_port: int = 6666, bind_host: str = ANY_HOST,
    cipher: Cipher = Cipher.AES_128_CBC, name_in_log: str = "",
) -> RobotClient:
    """A client that runs a dummy robot; see `RobotClient` for what is needed and raised, and `DummyRobot`."""
    options = options or DummyOptions()
    network = random.Random(options.seed)
    return RobotClient(
        team, password, DummyRobot(options, name_in_log=name_in_log), robot, rsbb_host, rsbb_port, bind_host, cipher,
        clock=lambda: time.time() + options.skew,
        passes=lambda: network.random() >= options.loss,
    )
