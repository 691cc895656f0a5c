"""A robot in a few lines, for teams without ROS.

    class MyRobot(Behaviour):
        async def prepare(self, benchmark):
            await drive_to_start(benchmark)

        async def execute(self, benchmark, goal):
            return await do_it(benchmark, goal)

    asyncio.run(RobotClient("MyTeam", "password", MyRobot()).run())

Everything runs in the asyncio loop of `RobotClient.run`. Behaviours must not block it (use `loop.run_in_executor` for
long calls). Other threads must call the client through `loop.call_soon_threadsafe`.
"""

import abc
import asyncio
import logging
import os
import time
from typing import Any, Awaitable, Callable, Optional, Set, Union

from roah_rsbb.comm.channels import MakePeer
from roah_rsbb.comm.ciphers import Cipher
from roah_rsbb.comm.sockets import ANY_HOST
from roah_rsbb.ground.installed import warn_if_replaced
from roah_rsbb.protocol import RobotState
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.goals import Goal, Result
from roah_rsbb.robot.machine import IllegalEvent
from roah_rsbb.robot.runner import SessionRunner, always

_log = logging.getLogger(__name__)

# Time limit for a cancelled behaviour to end; after that, the next one begins in parallel.
CANCEL_S = 5.0


class Behaviour(abc.ABC):
    """What a robot does. Override what you need; `client` is the `RobotClient` that runs it.

    `prepare` and `execute` are cancelled (asyncio.CancelledError is raised in them) when the box stops the robot, and
    when a waypoint timed out and the next one follows. Their exceptions are logged; the robot then keeps its state
    until the box's timeout.
    """

    client: "RobotClient"

    async def prepare(self, benchmark: str) -> None:  # noqa: B027
        """Prepare for a goal of the benchmark with this code; return when ready."""

    @abc.abstractmethod
    async def execute(self, benchmark: str, goal: Optional[Goal]) -> Result:
        """Execute a goal; return when it is complete.

        `goal` is None in benchmarks without explicit goals. Return a `HopfResult` in Object Perception, a
        `HppfResult` in People Perception, else a text or None. Person Following ends by its timeout: wait until
        cancelled.
        """

    def stop(self, why: str) -> None:  # noqa: B027
        """Stop all motion now. `prepare` or `execute` is cancelled."""

    def on_devices(self, devices: fx.Devices) -> None:  # noqa: B027
        """The state of the home devices, initially and after changes."""

    def on_tablet(self, tablet: fx.TabletIs) -> None:  # noqa: B027
        """The state of the tablet, initially and after changes."""

    def on_bell(self) -> None:  # noqa: B027
        """Somebody rang the bell."""

    def on_tablet_call(self) -> None:  # noqa: B027
        """The call button on the tablet was pressed."""

    def on_tablet_position(self, x: float, y: float) -> None:  # noqa: B027
        """A position (metres) was selected on the tablet."""

    def on_report(self, report: fx.ProblemIs) -> None:
        """A problem that the client noticed, or its end."""
        _log.log(logging.INFO if report.over else logging.WARNING, "%s", report.text)


def _warn(text: str) -> None:
    _log.warning("%s", text)


class RobotClient:
    """One robot: joins the runs in which the box lists it, and runs a `Behaviour`.

    Its methods raise `machine.IllegalEvent`, whose text says why, if they are not possible now: there is no run, or a
    value is invalid.
    """

    def __init__(
        self,
        team: str,
        password: str,
        behaviour: Behaviour,
        robot: str = "Robot",
        rsbb_host: str = "10.255.255.255",
        rsbb_port: int = 6666,
        bind_host: str = ANY_HOST,
        cipher: Cipher = Cipher.AES_128_CBC,
        clock: Callable[[], float] = time.time,
        passes: Callable[[], bool] = always,
        make_peer: Optional[MakePeer] = None,
        random_bytes: Callable[[int], bytes] = os.urandom,
    ) -> None:
        """`rsbb_host`: broadcast address of the network, or address of the box. For the rest see `SessionRunner`."""
        self._behaviour = behaviour
        behaviour.client = self
        self._settings = {
            "team": team, "password": password, "robot": robot, "rsbb_host": rsbb_host,
            "rsbb_port": rsbb_port, "bind_host": bind_host, "cipher": cipher, "clock": clock,
            "passes": passes, "make_peer": make_peer, "random_bytes": random_bytes,
        }
        self._runner: Optional[SessionRunner] = None
        # What `run` waits for, because callbacks do the work. Without it here, both were garbage: a loop does not keep
        # its tasks.
        self._forever: Optional[asyncio.Future] = None
        self._messages_saved = 0
        self._phases: Set[asyncio.Task] = set()  # that have not ended, including cancelled ones
        self._phase: Optional[asyncio.Task] = None  # the present one

    async def run(self) -> None:
        """Run until cancelled. Raises ValueError or OSError, which name the remedy, if it cannot start."""
        warn_if_replaced()
        loop = asyncio.get_event_loop()
        self._runner = SessionRunner(loop, on_effect=self._follow, on_complaint=_warn, **self._settings)
        self._runner.session.progress.messages_saved = self._messages_saved
        self._forever = loop.create_future()
        try:
            self._runner.open()
            await self._forever
        finally:
            self._runner.close()
            self._runner = None
            self._cancel_phase()
            if self._phases:
                await asyncio.wait(self._phases, timeout=CANCEL_S)

    # State.

    @property
    def state(self) -> RobotState:
        """The robot's state, as sent to the box."""
        return self._runner.session.progress.state if self._runner else RobotState.STOP

    @property
    def benchmark(self) -> Optional[str]:
        """The code of the present benchmark; None without a run."""
        return self._runner.session.progress.benchmark if self._runner else None

    @property
    def strings_pending(self) -> int:
        """Number of strings that the box has not acknowledged."""
        link = self._runner.session.link if self._runner else None
        return link.strings_pending if link else 0

    # Messages to the box.

    @property
    def messages_saved(self) -> int:
        """The amount of recorded offline data (count or bytes). The box ends a run if this stays 0."""
        return self._messages_saved

    @messages_saved.setter
    def messages_saved(self, count: int) -> None:
        if self._runner is not None:
            self._runner.session.progress.messages_saved = count
        self._messages_saved = count

    def notify(self, text: str) -> None:
        """Online data: a notification."""
        self._request("add_string", "notifications", text)

    def activation_event(self, text: str) -> None:
        """Online data: what activated the robot."""
        self._request("add_string", "activation_event", text)

    def visitor(self, text: str) -> None:
        """Online data: who the visitor is."""
        self._request("add_string", "visitor", text)

    def final_command(self, text: str) -> None:
        """Online data: the command that the robot understood."""
        self._request("add_string", "final_command", text)

    def set_device(self, name: str, value: Union[bool, int]) -> None:
        """Set a device: switch_1 to switch_3 to a bool, dimmer and blinds to 0 to 100 per cent."""
        self._request("set_device", name, value)

    def display_map(self, display: bool) -> None:
        """Let the tablet show its map (True) or its call button (False)."""
        self._request("display_map", display)

    def _request(self, method: str, *arguments: Any) -> None:
        if self._runner is None:
            raise IllegalEvent("the client is not running: await its run()")
        getattr(self._runner.session, method)(*arguments)
        self._runner.wake()

    # Effects of the session.

    def _follow(self, effect: fx.Effect) -> None:
        behaviour = self._behaviour
        if isinstance(effect, fx.Prepare):
            benchmark = effect.benchmark
            self._begin_phase(lambda: behaviour.prepare(benchmark), self._end_prepare)
        elif isinstance(effect, fx.Execute):
            benchmark, goal = effect.benchmark, effect.goal
            self._begin_phase(lambda: behaviour.execute(benchmark, goal), self._end_execute)
        elif isinstance(effect, fx.Stop):
            self._cancel_phase()
            behaviour.stop(effect.why)
        elif isinstance(effect, fx.Devices):
            behaviour.on_devices(effect)
        elif isinstance(effect, fx.TabletIs):
            behaviour.on_tablet(effect)
        elif isinstance(effect, fx.BellRang):
            behaviour.on_bell()
        elif isinstance(effect, fx.TabletCalled):
            behaviour.on_tablet_call()
        elif isinstance(effect, fx.PositionSelected):
            behaviour.on_tablet_position(effect.x, effect.y)
        elif isinstance(effect, fx.ProblemIs):
            behaviour.on_report(effect)

    def _begin_phase(self, work: Callable[[], Awaitable[Any]], end: Callable[[Any], None]) -> None:
        self._cancel_phase()
        self._phase = asyncio.get_event_loop().create_task(self._run_phase(work, end, set(self._phases)))
        self._phases.add(self._phase)
        self._phase.add_done_callback(self._phases.discard)

    def _cancel_phase(self) -> None:
        if self._phase is not None:
            self._phase.cancel()
            self._phase = None

    async def _run_phase(
        self, work: Callable[[], Awaitable[Any]], end: Callable[[Any], None], before: Set[asyncio.Task]
    ) -> None:
        """Do `work` after the cancelled phases `before` have ended; then call `end`."""
        if before:
            _, late = await asyncio.wait(before, timeout=CANCEL_S)
            if late:
                _log.error(
                    "a behaviour has not ended %.0f s after it was cancelled: it must not suppress "
                    "asyncio.CancelledError. The next one starts in parallel", CANCEL_S,
                )
        try:
            result = await work()
        except Exception:
            _log.exception("a behaviour failed: the robot stays in %s until the box stops it", self.state.name)
            return
        if self._phase is asyncio.current_task() and self._runner is not None:
            self._phase = None
            end(result)
            self._runner.wake()

    def _end_prepare(self, _result: None) -> None:
        self._runner.session.end_prepare()

    def _end_execute(self, result: Result) -> None:
        try:
            self._runner.session.end_execute(result)
        except ValueError as error:
            _log.error("the goal is completed without a result: %s", error)
            self._runner.session.end_execute(None)
