"""A box on real sockets whose process is busy: it reads each datagram late."""

import asyncio
import socket
import time

import pytest

from helpers.competition import competition
from roah_rsbb.comm import frame
from roah_rsbb.comm.channels import Network
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.box import Box
from roah_rsbb.core.settings import Settings
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import RobotState
from roah_rsbb.radio.driver import NetworkDriver
from roah_rsbb.radio.radio import beacon_size

BROADCAST, BOX, ROBOT, FORGER = "127.255.255.255", "127.0.0.1", "127.0.0.2", "127.0.0.66"
# Longer than the allowed skew.
BUSY_S = 0.25
# A machine may also stop for as long as the allowed skew between the robot's look at its clock and its sending.
TRIES = 40


def _port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1] - 1  # the next one is for the private channel


class Field:
    """A box, and sockets that send to it."""

    def __init__(self):
        self.loop = asyncio.new_event_loop()
        self.port = _port()
        config = competition(tbm=["HGTKMH"])
        self.key = Key(config.passwords["Alpha"])
        box = Box(config, Settings(self.port, listen_duration=0.0), beacon_size)
        network = Network(BROADCAST, self.port, BOX, Cipher.AES_128_CBC, False, 1024)
        self.driver = NetworkDriver(self.loop, box, network, dict(config.passwords), lambda text: None)
        self.driver.open()
        self.senders = {}

    def close(self):
        self.driver.close()
        for sender in self.senders.values():
            sender.close()
        self.loop.close()

    def _send(self, host, datagram, port):
        if host not in self.senders:
            self.senders[host] = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self.senders[host].bind((host, 0))
        self.senders[host].sendto(datagram, (BOX, port))

    def beacon(self, host=ROBOT, skew=0.0):
        message = pb.RobotBeacon(team_name="Alpha", robot_name="r1")
        _set(message.time, skew)
        self._send(host, frame.encode(message), self.port)

    def state(self, host=ROBOT):
        message = pb.RobotState(messages_saved=1, robot_state=int(RobotState.STOP))
        _set(message.time, 0.0)
        self._send(host, frame.encode(message, Cipher.AES_128_CBC, self.key), self.port + 1)

    def read(self):
        """The box reads what came."""
        for _ in range(3):
            self.loop.run_until_complete(asyncio.sleep(0))

    def off(self, command):
        box = self.driver.box
        return box.actions.off(self.driver.now(), box.zones["tbm"], command)

    def press(self, command):
        self.driver.event(self.driver.box.act, Target("tbm"), command)


def _set(field, skew):
    field.sec, field.nsec = divmod(round((time.time() + skew) * 1e9), 1_000_000_000)


@pytest.fixture
def field():
    made = Field()
    yield made
    made.close()


def _try(say, is_so):
    for _ in range(TRIES):
        say()
        if is_so():
            return
    raise AssertionError("it never was so")


def test_a_busy_box_starts_robots_whose_clocks_are_right(field):
    def busy(send):
        send()
        time.sleep(BUSY_S)
        field.read()

    _try(lambda: busy(field.beacon), lambda: field.off("connect") == [])
    field.press("connect")
    _try(lambda: busy(field.state), lambda: field.off("start") == [])
    field.press("start")


def test_a_forger_on_the_network_keeps_no_robot_from_its_run(field):
    def both():
        field.beacon(FORGER, skew=60.0)
        field.beacon()
        field.read()

    field.beacon(FORGER, skew=60.0)
    field.read()
    _try(both, lambda: field.off("connect") == [])
    both()  # the forger is still there: it is no robot that moved
    assert any(FORGER in text and ROBOT in text for text in field.driver.box.warnings(field.driver.now()))
    field.press("connect")

    def answers():
        field.beacon(FORGER, skew=60.0)
        time.sleep(0.02)  # as a robot's repetitions; the first ones may be older than the forged time
        field.state()
        field.read()

    _try(answers, lambda: field.off("start") == [])
    assert field.driver.box.zones["tbm"].run.link.host == ROBOT
    field.press("start")
