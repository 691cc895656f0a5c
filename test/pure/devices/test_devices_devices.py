"""The home devices of a program, with the dummy controller on loopback; and their file in log_dir."""

import asyncio
import json
import logging
import queue
import socket
import threading
import time

import pytest

from helpers.waiting import News
from roah_rsbb.devices import devices as client_module
from roah_rsbb.devices.devices import FILE, HomeDevices, SmartIfClient, open_settings
from roah_rsbb.devices.dummy_server import DummyServer
from roah_rsbb.devices.smartif import (
    RING,
    TO_CONTROLLER,
    BadSetting,
    Busy,
    Changed,
    DeviceEvent,
    Home,
    SmartIfDecoder,
    devices_state,
    encode,
)
from roah_rsbb.model.messages import DevicesState

LIMIT_S = 10


class Program:
    """A program with home devices and the dummy controller. Every event wakes `until`."""

    def __init__(self, saved=None, save=None):
        self.saved = queue.Queue()
        self.states, self.statuses, self.reports, self.rings = [], [], [], 0
        self._given, self._save = saved, save or self.saved.put
        self._news = News()

    async def open(self):
        self.server = DummyServer("127.0.0.1", 0, lambda text: self._take(self.reports.append, text))
        await self.server.open()
        self.devices = HomeDevices(
            asyncio.get_event_loop(), "127.0.0.1", self.server.port,
            on_state=lambda home: self._take(self.states.append, devices_state(home)), on_bell=self._on_bell,
            on_status=lambda connected, text: self._take(self.statuses.append, (connected, text)),
            saved=self._given, save=self._save)

    async def until(self, condition, what):
        await self._news.until(condition, lambda: f"{what}; {self.states}, {self.statuses}, {self.reports}")

    async def until_connected(self):
        await self.until(lambda: self.statuses[-1][0] and any("blinds is set to" in text for text in self.reports),
                         "it is connected")

    def _on_bell(self):
        self.rings += 1
        self._news.set()

    def _take(self, add, value):
        add(value)
        self._news.set()


def played(script, **options):
    """Run a coroutine function with a program that has not started; returns the program when it has closed."""
    async def run():
        program = Program(**options)
        await program.open()
        try:
            await script(program)
        finally:
            program.devices.close()
            await program.until(lambda: program.server._client is None, "the controller is free")
            program.server.close()
        return program
    return asyncio.run(run())


def test_states_and_statuses_from_the_start_to_the_connection():
    async def script(program):
        program.devices.start()
        where = f"the SmartIF controller at 127.0.0.1:{program.server.port}"
        assert (program.states, program.statuses) == ([DevicesState()], [(False, f"connecting to {where}")])
        await program.until_connected()
        assert program.statuses[1:] == [(True, f"connected to {where}")]
    assert played(script).saved.empty(), "nothing has changed"


def test_a_setting_reaches_the_controller_the_program_and_what_is_saved():
    async def script(program):
        program.devices.start()
        await program.until_connected()
        for device, value in (("dimmer", 40), ("switch_2", 1)):
            program.devices.set(device, value)
        program.devices.set_door(True)
        assert program.states[1:] == [
            DevicesState(dimmer=40), DevicesState(dimmer=40, switch_2=True),
            DevicesState(dimmer=40, switch_2=True, door_win_detect=True)]
        assert program.states[-1].switch_2 is True
        await program.until(lambda: program.reports[-1] == "switch_2 is set to 1", "the controller has both")
        assert program.reports[-2] == "dimmer is set to 40"
    program = played(script)
    home = Home()
    while devices_state(home) != program.states[-1]:
        assert home.restore(program.saved.get(timeout=LIMIT_S))


def test_a_wrong_setting_is_refused_and_changes_nothing():
    async def script(program):
        program.devices.start()
        with pytest.raises(BadSetting, match="dimmer cannot be set to 101: it takes 0 to 100 per cent"):
            program.devices.set("dimmer", 101)
        assert len(program.states) == 1
    assert played(script).saved.empty()


def test_a_ring_of_the_controller_and_one_by_hand():
    async def script(program):
        program.devices.start()
        await program.until_connected()
        before = time.time_ns()
        program.server.ring()
        await program.until(lambda: program.rings == 1, "the ring")
        program.devices.ring()
        assert program.rings == 2
        first, second = (sec * 10**9 + nsec for sec, nsec in (state.bell for state in program.states[1:]))
        assert before <= first <= second <= time.time_ns()
    played(script)


def test_without_a_connection_a_setting_waits_and_is_a_warning(caplog):
    async def script(program):
        program.devices.set("blinds", 30)
        assert "blinds is set to 30, which the controller receives when it is connected" in caplog.text
        program.devices.start()
        await program.until(lambda: "blinds is set to 30" in program.reports, "it is sent")
        await program.until_connected()
        caplog.clear()
        program.devices.set("blinds", 31)
        assert caplog.text == ""
    played(script)


def test_another_program_continues_with_what_was_saved():
    home = Home()
    home.set("blinds", 35)
    home.bell, home.door = (7, 8), True

    async def script(program):
        program.devices.start()
        await program.until(lambda: "blinds is set to 35" in program.reports, "it is sent again")
    program = played(script, saved=json.loads(json.dumps(home.saved())))
    assert program.states == [DevicesState(bell=(7, 8), blinds=35, door_win_detect=True)]


def test_a_closed_program_leaves_the_controller_to_another():
    async def script(program):
        program.devices.start()
        await program.until_connected()
        program.devices.close()
        await program.until(lambda: program.reports[-1].endswith("(it closed the connection)") or
                            "the connection broke" in program.reports[-1], "it has left")
    played(script)


def test_slow_saving_delays_nothing_and_keeps_the_newest():
    begun, gate, saved = threading.Semaphore(0), threading.Event(), queue.Queue()

    def save(values):
        assert threading.current_thread() is not threading.main_thread()
        begun.release()
        assert gate.wait(LIMIT_S)
        saved.put(values["values"]["dimmer"])

    async def script(program):
        program.devices.set("dimmer", 1)
        assert begun.acquire(timeout=LIMIT_S)
        for value in range(2, 100):
            program.devices.set("dimmer", value)
        assert program.states[-1].dimmer == 99
        assert saved.empty()
    played(script, save=save)
    gate.set()
    assert [saved.get(timeout=LIMIT_S) for _ in range(2)] == [1, 99]


def test_values_that_cannot_be_saved_are_one_warning_until_they_can(caplog):
    done, fails = queue.Queue(), [True, True, False, True]

    def save(values):
        done.put(values)
        if fails.pop(0):
            raise OSError("the disk is full")

    async def script(program):
        for value in range(1, 5):
            program.devices.set("dimmer", value)
            done.get(timeout=LIMIT_S)
    program = played(script, save=save)
    program.devices._saver.shutdown(wait=True)
    warnings = [record.getMessage() for record in caplog.records if "saved" in record.getMessage()]
    assert warnings == ["the settings of the home devices cannot be saved for a restart: the disk is full"] * 2


def test_settings_are_kept_in_a_file(tmp_path):
    folder = str(tmp_path / "log")
    saved, save = open_settings(folder)
    assert saved is None
    home = Home()
    home.set("dimmer", 70)
    save(home.saved())
    saved, _ = open_settings(folder)
    other = Home()
    assert other.restore(saved)
    assert other.values == home.values
    assert [path.name for path in (tmp_path / "log").iterdir()] == [FILE]


def test_another_launch_starts_with_all_devices_off(tmp_path):
    home = Home()
    home.set("dimmer", 70)
    saved, save = open_settings(str(tmp_path), "first")
    assert saved is None
    save(home.saved())
    again = Home()
    assert again.restore(open_settings(str(tmp_path), "first")[0])
    assert again.values == home.values
    assert open_settings(str(tmp_path), "second")[0] is None


@pytest.mark.parametrize("content", [
    "", "{", "[]", "5", '{"values": {"dimmer": 101}, "bell": ["0", "0"], "door": false}'])
def test_a_damaged_file_is_moved_aside(tmp_path, caplog, content):
    (tmp_path / FILE).write_text(content)
    saved, save = open_settings(str(tmp_path))
    assert saved is None
    assert f"cannot read {tmp_path / FILE}" in caplog.text
    assert "every device is off" in caplog.text
    assert [record.levelno for record in caplog.records] == [logging.WARNING]
    assert (tmp_path / f"{FILE}.damaged").read_text() == content
    save(Home().saved())
    assert open_settings(str(tmp_path))[0] == Home().saved()


# -- the SmartIF client, against a controller of which each byte is the test's, over TCP on loopback --

class World:
    """A scripted controller and a client. Every event wakes `until`."""

    def __init__(self):
        self.home = Home()
        self.rings = 0
        self.statuses = []
        self.connections = []  # (reader, writer) of each that the client made
        self.heard = []  # the messages of each connection
        self.reads = True
        self._news = News()

    async def open(self, port=0):
        self.server = await asyncio.start_server(self._serve, "127.0.0.1", port)
        self.port = self.server.sockets[0].getsockname()[1]

    def start(self):
        self.client = SmartIfClient("127.0.0.1", self.port, self.home, self._on_ring, self._on_status)
        self.running = asyncio.get_event_loop().create_task(self.client.run())

    async def close(self):
        self.running.cancel()
        await asyncio.gather(self.running, return_exceptions=True)
        self.stop()

    def stop(self):
        """The controller is gone."""
        self.server.close()
        for _, writer in self.connections:
            writer.transport.abort()

    def say(self, data):
        """On the last connection."""
        self.connections[-1][1].write(data)

    def hang_up(self):
        self.connections[-1][1].close()

    async def until(self, condition, what):
        await self._news.until(condition, lambda: f"{what}; {self.statuses}, {self.heard}")

    async def until_connected(self, number):
        """Wait until the client's connection of this number has sent everything."""
        await self.until(lambda: len(self.heard) >= number and len(self.heard[number - 1]) >= 5, f"connection {number}")

    def happened(self):
        self._news.set()

    def _on_ring(self):
        self.rings += 1
        self.happened()

    def _on_status(self, connected, text):
        self.statuses.append((connected, text))
        self.happened()

    async def _serve(self, reader, writer):
        heard = []
        self.connections.append((reader, writer))
        self.heard.append(heard)
        decoder = SmartIfDecoder(TO_CONTROLLER)
        while self.reads:
            data = await reader.read(100)
            if not data:
                break
            heard += decoder.feed(data)
            self.happened()
        self.happened()


def scripted(script):
    """Run a coroutine function with a world whose client is connected."""
    async def run():
        world = World()
        await world.open()
        world.start()
        try:
            await world.until_connected(1)
            await script(world)
        finally:
            await world.close()
    asyncio.run(run())


def test_all_values_are_sent_on_each_connection():
    async def script(world):
        world.home.set("blinds", 40)
        world.client.send(world.home.set("dimmer", 30))
        await world.until(lambda: len(world.heard[0]) == 6, "the dimmer is set")
        assert world.heard[0][5] == ("58", 30)
        world.hang_up()
        await world.until_connected(2)
        assert dict(world.heard[1]) == {"11": 0, "33": 0, "40": 0, "58": 30, "77": 4000}
        await world.until(lambda: world.statuses[-1][0], "connected again")
        assert any("closed the connection" in text for connected, text in world.statuses if not connected)
    scripted(script)


def test_values_set_while_the_controller_is_away_are_sent_when_it_is_back():
    async def script(world):
        world.stop()
        await world.until(lambda: any("cannot be reached" in text for _, text in world.statuses), "it is reported")
        assert not world.client.connected
        world.client.send(world.home.set("switch_3", 1))
        await world.open(world.port)
        await world.until_connected(2)
        assert ("40", 1) in world.heard[1]
    scripted(script)


def test_a_controller_that_starts_with_the_client_is_no_fault(monkeypatch):
    monkeypatch.setattr(client_module, "STARTS_S", LIMIT_S)
    connect, tries = asyncio.open_connection, []

    async def count(*where):
        tries.append(where)
        return await connect(*where)

    monkeypatch.setattr(asyncio, "open_connection", count)

    async def run():
        world = World()
        await world.open()
        world.stop()
        world.start()
        while len(tries) < 2:
            await asyncio.sleep(0.01)
        await world.open(world.port)
        try:
            await world.until_connected(1)
            await world.until(lambda: world.statuses, "it is connected")
            assert [connected for connected, _ in world.statuses] == [True]
        finally:
            await world.close()
    asyncio.run(run())


def test_rings_come_one_by_one_merged_and_in_fragments():
    async def script(world):
        other = encode(Changed("11", 1, 0)) + encode(DeviceEvent("E", "11", "1")) + encode(DeviceEvent("E", "47", "0"))
        world.say(other + encode(RING) * 2 + encode(RING)[:5])
        await world.until(lambda: world.rings == 2, "two rings")
        for byte in encode(RING)[5:] + encode(RING):
            world.say(bytes([byte]))
            await asyncio.sleep(0)
        await world.until(lambda: world.rings == 4, "four rings")
        assert len(world.connections) == 1
        assert world.statuses[-1] == (True, f"connected to the SmartIF controller at 127.0.0.1:{world.port}")
    scripted(script)


def test_garbage_ends_the_connection_and_the_next_one_works():
    async def script(world):
        world.say(encode(RING) + b"HTTP/1.1 400 Bad Request\r\n")
        await world.until_connected(2)
        assert world.rings == 1
        assert any("does not use the SmartIF protocol" in text and "smartif_port" in text for _, text in world.statuses)
        world.say(encode(RING))
        await world.until(lambda: world.rings == 2, "the second connection rings")
    scripted(script)


def test_a_huge_length_is_garbage():
    async def script(world):
        world.say(b"2E\xff\xff" + b"x" * 100)
        await world.until_connected(2)
        assert any("65535 bytes" in text for _, text in world.statuses)
    scripted(script)


def test_half_a_message_does_not_block_the_connection_for_ever(monkeypatch):
    monkeypatch.setattr(client_module, "REST_S", 0.2)

    async def script(world):
        world.say(encode(RING)[:4])
        await world.until_connected(2)
        assert any("an incomplete message" in text for _, text in world.statuses)
        assert world.rings == 0
    scripted(script)


def test_another_client_is_named_and_the_client_keeps_trying():
    async def script(world):
        world.say(encode(Busy("10.0.0.9:4711")))
        await world.until_connected(2)
        world.say(encode(Busy("10.0.0.9:4711")))
        await world.until_connected(3)
        reported = [text for connected, text in world.statuses if not connected]
        assert [text for text in reported if "is connected to another client at 10.0.0.9:4711" in text]
        assert reported.count(reported[-1]) == 1, "the same is reported once"
        await world.until(lambda: world.statuses[-1][0], "connected in the end")
    scripted(script)


@pytest.mark.long
def test_a_controller_that_reads_nothing_does_not_make_it_grow(monkeypatch):
    monkeypatch.setattr(client_module, "KEEPALIVE", ())  # not the connection's supervision ends this, but the limit

    async def script(world):
        world.reads = False
        for end, size in ((world.client._writer, socket.SO_SNDBUF), (world.connections[0][1], socket.SO_RCVBUF)):
            end.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, size, 4096)
        for number in range(200_000):
            world.client.send(world.home.set("dimmer", number % 101))
            if number % 500 == 0:
                await asyncio.sleep(0)
        await world.until(lambda: len(world.connections) > 1, "a new connection")
    scripted(script)


def test_a_controller_that_does_not_answer_is_reported(monkeypatch):
    monkeypatch.setattr(client_module, "CONNECT_S", 0.1)

    async def never(*_args):
        await asyncio.sleep(100)

    async def run():
        monkeypatch.setattr(asyncio, "open_connection", never)
        world = World()
        world.port = 1
        world.start()
        await world.until(lambda: world.statuses, "a status")
        assert world.statuses[0][0] is False
        assert "does not answer" in world.statuses[0][1]
        world.running.cancel()
        await asyncio.gather(world.running, return_exceptions=True)
    asyncio.run(run())


@pytest.fixture
def reported():
    return []


def test_the_dummy_server_prints_rings_and_sends_a_second_client_away(reported):
    async def run():
        world = World()
        server = DummyServer("127.0.0.1", 0, lambda text: (reported.append(text), world.happened()))
        await server.open()
        world.port = server.port
        assert not server.ring()
        world.start()
        await world.until(lambda: "blinds is set to 0" in reported, "all values are sent")
        world.client.send(world.home.set("blinds", 35))
        await world.until(lambda: "blinds is set to 35" in reported, "the blinds")
        assert server.ring()
        await world.until(lambda: world.rings == 1, "the ring")

        first = next(text for text in reported if text.startswith("127.") and text.endswith("connected")).split()[0]
        second = World()
        second.port = server.port
        second.start()
        await second.until(lambda: second.statuses, "the second one is rejected")
        assert f"is connected to another client at {first}" in second.statuses[0][1]
        world.running.cancel()
        await asyncio.gather(world.running, return_exceptions=True)
        await second.until(lambda: second.statuses[-1][0], "the second one is served once the first is gone")
        server.close()
        second.running.cancel()
        await asyncio.gather(second.running, return_exceptions=True)
    asyncio.run(run())


def test_the_dummy_server_survives_garbage(reported):
    async def run():
        server = DummyServer("127.0.0.1", 0, reported.append)
        await server.open()
        for data in (b"GET / HTTP/1.0\r\n\r\n", b"I\xff\xff", encode(DeviceEvent("E", "47", "1"))):
            reader, writer = await asyncio.open_connection("127.0.0.1", server.port)
            writer.write(data)
            assert await asyncio.wait_for(reader.read(), LIMIT_S) == b""
            writer.close()
        server.close()
        assert sum("it does not use the SmartIF protocol" in text for text in reported) == 3
    asyncio.run(run())
