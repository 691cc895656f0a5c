"""The barest core: what is left when the core cannot start any more stops all robots, and does nothing else."""

import asyncio
import threading
import time

import pytest

from box.program.test_box_program import Demonstration
from helpers.waiting import LIMIT_S
from roah_rsbb.box import barest
from roah_rsbb.box.barest import AFTER_FAILURES, KeptChannel, kept_channels
from roah_rsbb.box.parameters import parameters_of
from roah_rsbb.box.program.demo import settings
from roah_rsbb.comm.memory import MemoryAir
from roah_rsbb.comm.sockets import LOOPBACK_BROADCAST
from roah_rsbb.platform import run
from roah_rsbb.protocol import RobotState
from roah_rsbb.robot.dummy import DummyOptions, dummy_client
from roah_rsbb.signs_of_life import LOOK_S, SUPERVISOR, Signs, Watch


@pytest.fixture
def supervisor(tmp_path):
    """One who watches the core of this folder, in a thread."""
    watch, ended = Watch(str(tmp_path), SUPERVISOR, time.monotonic), threading.Event()
    watch.look()

    def work():
        while not ended.is_set():
            watch.look()
            watch.wait(LOOK_S)

    thread = threading.Thread(target=work)
    thread.start()
    yield watch
    ended.set()
    thread.join()
    watch.close()


class MovingRobot(Demonstration):
    """A demonstration whose robot outlives the box, and executes without end."""

    async def __aenter__(self):
        self.client.start()
        await self.program.start(self.door_file)
        self.robot = dummy_client("TestingTeam", "PASSWORD", options=DummyOptions(
            prepare_duration=0.05, execute_duration=1e6, seed=1), rsbb_host=LOOPBACK_BROADCAST,
            bind_host="127.0.0.2", make_peer=self.air.peer)
        self.robot_task = asyncio.get_event_loop().create_task(self.robot.run())
        return self


async def until(condition):
    async def wait():
        while not condition():
            await asyncio.sleep(0.01)
    await asyncio.wait_for(wait(), LIMIT_S)


def test_it_stops_the_robot_of_a_core_that_cannot_start_any_more(tmp_path, supervisor):
    async def play():
        demo = MovingRobot(tmp_path)
        async with demo:
            await demo.begin()
            await until(lambda: demo.robot.state is RobotState.EXECUTING)
            await until(lambda: b"channel/" in supervisor._kept)
            killed = supervisor._kept
        # A core that is killed says nothing, so the supervisor still has what that one kept.
        supervisor._kept = killed
        loop = asyncio.get_event_loop()
        signs = Signs(str(tmp_path))
        await loop.run_in_executor(None, signs.ask)
        (kept,) = kept_channels(signs)
        assert (kept.password, kept.host, kept.benchmark) == ("PASSWORD", "127.0.0.2", "HGTKMH")
        network = parameters_of(settings(str(tmp_path))).network
        robots = [barest._Stopping(loop, network, kept, demo.air.peer)]
        await barest._work(signs, robots, 3, lambda: robots[0].is_stopped)
        assert demo.robot.state is RobotState.STOP
        demo.robot_task.cancel()
    run(play())


def test_after_cores_that_failed_the_next_one_is_the_barest(tmp_path, supervisor, monkeypatch):
    """It reads neither the journal nor the configuration."""
    from roah_rsbb.box.program import program

    served = []
    monkeypatch.setattr(program, "serve", lambda signs, network, failures, is_ended: served.append(failures))
    monkeypatch.setattr(program, "RunningBox", lambda *given: pytest.fail("not the barest one"))
    for failures in range(AFTER_FAILURES):
        assert Signs(str(tmp_path)).ask() == failures
        supervisor.failed()

    async def start():
        program.BoxProgram(asyncio.get_event_loop(), settings(str(tmp_path), web="false", tablet="false"), "launch",
                           MemoryAir().peer)
    with pytest.raises(SystemExit):
        run(start())
    assert served == [AFTER_FAILURES]


def test_channels_that_cannot_be_opened_do_not_keep_the_others_from_stop(tmp_path, caplog):
    signs, air, ended = Signs(str(tmp_path)), MemoryAir(), []
    signs.kept = {
        f"channel/{port}": f'["A/{port}", "{password}", "127.0.0.2", "HGTKMH"]'
        for port, password in ((7001, ""), (7002, "secret"))}
    network = parameters_of(settings(str(tmp_path))).network
    heard = []
    air.peers.append(air.peer(None, LOOPBACK_BROADCAST, 7002, None, None, "127.0.0.2"))
    air.deliver = lambda source, datagram, host: (heard.append((source.port, host)), ended.append(1))
    barest.serve(signs, network, 3, lambda: len(ended) > 1, air.peer)
    assert set(heard) == {(7002, "127.0.0.2")}
    assert "A/7001 cannot be stopped" in caplog.text and "It only sends STOP now" in caplog.text
    assert KeptChannel(7001, "A/7001", "", "127.0.0.2", "HGTKMH") in kept_channels(signs)
