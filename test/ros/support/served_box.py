"""A whole box without ROS, with its pages and a dummy robot, in a thread of the test."""

import asyncio
import inspect
import pathlib
import threading
from typing import Any, Callable, List

from roah_rsbb.box.program.demo import settings
from roah_rsbb.box.program.neighbours import InProcessClient
from roah_rsbb.box.program.program import BoxProgram
from roah_rsbb.comm.peer import MemoryAir
from roah_rsbb.comm.sockets import LOOPBACK_BROADCAST
from roah_rsbb.devices.dummy_server import DummyServer
from roah_rsbb.model.document import Document
from roah_rsbb.robot.dummy import DummyOptions, dummy_client
from support.waiting import LIMIT_S, happened, wait_until

TEAM = "TestingTeam"
LOOPBACK = "127.0.0.1"
# Longer than any test: the run is stopped.
RUN_S = 3600.0


class ServedBox:
    """The box. Methods are called by the test's thread; close it at the end."""

    def __init__(self, folder: pathlib.Path, robots: int = 1, has_devices: bool = False, **changes: str) -> None:
        """`has_devices`: home devices, with a dummy controller. `changes`: other settings than those of the
        demonstration."""
        self.controlled: List[str] = []  # what the controller reports
        self.controller = DummyServer(LOOPBACK, 0, lambda text: self.controlled.append(text) or happened())
        self._has_devices = has_devices
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._run, name="box", daemon=True)
        self._thread.start()
        self._folder = folder
        self.program: BoxProgram = self.do(lambda: self._open(robots, changes))
        running = self.program
        self._client = InProcessClient(running.door, self._loop, self._loop, happened, "referee")

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        self._loop.run_forever()

    def do(self, act: Callable[[], Any]) -> Any:
        """Do something in the box's thread; returns its result."""
        async def run() -> Any:
            found = act()
            return await found if inspect.isawaitable(found) else found

        return asyncio.run_coroutine_threadsafe(run(), self._loop).result(LIMIT_S)

    async def _open(self, robots: int, changes: Any) -> BoxProgram:
        air = MemoryAir()
        if self._has_devices:
            await self.controller.open()
            changes = {**changes, "devices": "true", "bell_ring_command": "true", "smartif_host": LOOPBACK,
                       "smartif_port": str(self.controller.port)}
        found = settings(str(self._folder), **{"web_port": "0", "tablet": "false", **changes})
        program = BoxProgram(self._loop, found, "", air.peer, is_dummy=True)
        await program.start(str(self._folder / "door.json"))
        teams = [TEAM, *(team for team in program.config.passwords if team != TEAM)]
        for number, team in enumerate(teams[:robots], 2):
            program.keep(dummy_client(
                team, program.config.passwords[team], options=DummyOptions(execute_duration=RUN_S),
                rsbb_host=LOOPBACK_BROADCAST, bind_host=f"127.0.0.{number}", make_peer=air.peer).run())
        return program

    def close(self) -> None:
        """End it."""
        self.do(self.program.close)
        self.do(self.controller.close)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(LIMIT_S)

    @property
    def document(self) -> Document:
        """What the faces show."""
        document = self.do(lambda: self._client.document)
        assert document is not None, "the box was started"
        return document

    def wait(self, condition: Callable[[Document], Any], what: str) -> Any:
        """Wait until a condition holds for the document."""
        return wait_until(lambda: condition(self.document), what)

    def call(self, name: str, **arguments: Any) -> Any:
        """Make a call of the door; returns its answer."""
        answer = self.do(lambda: asyncio.wrap_future(self._client.call(name, **arguments)))
        assert not answer.reasons, [str(reason) for reason in answer.reasons]
        return answer.answer

    def act(self, action: str, zone: str, **given: Any) -> Any:
        """Do an action as another referee."""
        shown = self.document.zones[zone]
        return self.call("act", action=action, zone=zone, run=shown.identity, given=given, by="Rita")
