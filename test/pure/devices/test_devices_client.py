"""The SmartIF client, against a controller of which each byte is the test's, over TCP on loopback."""

import asyncio
import socket

import pytest

from helpers.waiting import News
from roah_rsbb.devices import devices as client_module
from roah_rsbb.devices.devices import SmartIfClient
from roah_rsbb.devices.dummy_server import DummyServer
from roah_rsbb.devices.smartif import RING, TO_CONTROLLER, Busy, Changed, DeviceEvent, Home, SmartIfDecoder, encode

LIMIT_S = 10


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
