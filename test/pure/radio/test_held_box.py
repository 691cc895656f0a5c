"""A box that heard another one at first sends nothing until a referee connects a robot. A robot that it cannot reach is
reported."""

import asyncio

from helpers.competition import competition
from helpers.simulated_air import SimulatedLoop
from roah_rsbb.comm import sockets
from roah_rsbb.comm.channels import Network, PublicChannel
from roah_rsbb.comm.ciphers import Cipher
from roah_rsbb.comm.peer import MemoryAir
from roah_rsbb.comm.sockets import LOOPBACK_BROADCAST
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.box import Box
from roah_rsbb.core.robots import NO_ROUTE
from roah_rsbb.core.settings import Settings
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.radio import wire_convert
from roah_rsbb.radio.driver import NetworkDriver
from roah_rsbb.radio.radio import beacon_size

BOX, OTHER, FAR = "127.0.0.1", "127.0.0.66", "10.2.0.7"


def test_a_held_box_sends_no_beacon_until_a_robot_is_connected():
    loop = SimulatedLoop()
    air, config, heard = MemoryAir(), competition(tbm=["HGTKMH"]), []
    box = Box(config, Settings(), beacon_size)
    driver = NetworkDriver(loop, box, Network(LOOPBACK_BROADCAST, 6666, BOX, Cipher.AES_128_CBC, False, 1024),
                           dict(config.passwords), lambda text: None, loop.utc, air.peer)
    other = PublicChannel(loop, Network(LOOPBACK_BROADCAST, bind_host=OTHER),
                          lambda message, sender: heard.append((type(message), sender[0])), lambda text: None,
                          make_peer=air.peer)
    other.open()
    driver.open(Settings().listen_duration)

    def passes(seconds):
        loop.run_until_complete(asyncio.sleep(seconds))

    def robot_says():
        seconds, nanoseconds = divmod(round(loop.utc() * 1e9), 10**9)
        other.send(pb.RobotBeacon(team_name="Alpha", robot_name="r1", time=pb.Time(sec=seconds, nsec=nanoseconds)))
        passes(1.0)

    other.send(wire_convert.beacon_message(Box(config, Settings(), beacon_size).beacon()))
    passes(10.0)
    robot_says()
    assert heard == []
    assert box.watches.held_by
    driver.event(box.act, Target("tbm"), "connect")
    passes(0.5)
    assert set(heard) == {(pb.RoahRsbbBeacon, BOX)}
    passes(5.0)
    assert len(heard) >= 5
    driver.close()
    other.close()
    loop.close()


def test_a_robot_of_a_network_without_a_route_is_reported(monkeypatch):
    loop, config, asked = SimulatedLoop(), competition(tbm=["HGTKMH"]), []
    monkeypatch.setattr(sockets, "source_host", lambda host: asked.append(host) or (None if host == FAR else BOX))
    box = Box(config, Settings(listen_duration=0.0), beacon_size)
    driver = NetworkDriver(loop, box, Network(LOOPBACK_BROADCAST, 6666, BOX, Cipher.AES_128_CBC, False, 1024),
                           dict(config.passwords), lambda text: None, loop.utc)

    def hears(host):
        seconds, nanoseconds = divmod(round(loop.utc() * 1e9), 10**9)
        driver.radio._on_public(pb.RobotBeacon(
            team_name="Alpha", robot_name="r1", time=pb.Time(sec=seconds, nsec=nanoseconds)), (host, 6666))
        return [one.template for one in box.candidates.off(driver.now(), box.zones["tbm"])]

    assert hears(FAR) == hears(FAR) == [NO_ROUTE.template]
    assert asked == [FAR], "once in a while is enough"
    assert hears(OTHER) == []
    driver.close()
    loop.close()
