"""What is heard on real loopback sockets, with root's rights and without."""

import contextlib
import select
import socket

import pytest

from helpers import slots
from helpers.box_beacon import box_beacon
from helpers.small_box import BOX, BROADCAST, PASSWORD, ROBOT, free_ports
from roah_rsbb.capture.decoding import DatagramKind, Decoder, Speaker
from roah_rsbb.capture.listening import PlainListener, RawListener
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.comm.frame import encode
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

TIMEOUT_S = 10
BEACON = pb.RobotBeacon(team_name="Team", robot_name="Robot", time=pb.Time(sec=1, nsec=2))
STATE = encode(
    pb.BenchmarkState(benchmark_type="HWV", benchmark_state=pb.BenchmarkState.STOP), Cipher.AES_128_CBC, Key(PASSWORD)
)


def listing(*ports):
    """The datagram of a box that lists a robot on each port."""
    return encode(box_beacon(*(("Team", "Robot", port) for port in ports)))


def participant(host, port=0):
    """A socket of a box or robot."""
    one = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    one.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
    one.bind((host, port))
    one.settimeout(TIMEOUT_S)
    return one


def hear(listener, decoder, count):
    """The next entries; what came with them may be more."""
    entries = []
    while len(entries) < count:
        ready = select.select(listener.sockets, [], [], TIMEOUT_S)[0]
        assert ready, "nothing came"
        entries += [decoder.decode(one) for endpoint in ready for one in listener.read(endpoint)]
        listener.follow()
    return entries


def test_broadcasts_are_heard_and_unicast_stays_with_whom_it_was_sent_to():
    port, notices = free_ports(), []
    decoder = Decoder(port, {})
    with contextlib.closing(PlainListener(decoder, BROADCAST, notices.append)) as listener, \
            participant(ROBOT, port) as robot, participant(BOX, port) as box:  # they can still open their ports
        robot.sendto(b"unicast", (BOX, port))
        robot.sendto(encode(BEACON), (BROADCAST, port))
        robot.sendto(encode(BEACON)[:5], (BROADCAST, port))
        entries = hear(listener, decoder, 2)
        assert box.recv(100) == b"unicast"
    assert [entry.kind for entry in entries] == [DatagramKind.MESSAGE, DatagramKind.ERROR]
    assert entries[0].message == BEACON and entries[0].datagram[1:5] == (ROBOT, port, BROADCAST, port)
    assert entries[1].speaker == Speaker("Robot", "Team")  # known by its address
    assert not notices


def test_a_box_that_broadcasts_is_heard_on_private_ports_while_it_lists_them():
    port, notices = free_ports(), []
    decoder = Decoder(port, {"Team": PASSWORD})
    with contextlib.closing(PlainListener(decoder, BROADCAST, notices.append)) as listener, participant(BOX) as box:
        box.sendto(listing(port + 1, port + 2), (BROADCAST, port))
        hear(listener, decoder, 1)
        assert len(listener.sockets) == 3
        box.sendto(STATE, (BROADCAST, port + 2))
        assert hear(listener, decoder, 1)[0].message.benchmark_type == "HWV"
        box.sendto(listing(port + 2), (BROADCAST, port))
        hear(listener, decoder, 1)
        assert {one.getsockname()[1] for one in listener.sockets} == {port, port + 2}
    assert not notices and listener.sockets[0].fileno() == -1


@pytest.mark.parametrize("who, offset, notice", [
    (ROBOT, 0, "private channels are not heard:"),  # they are left to a robot on this machine
    (BROADCAST, 1, "private channel {} is not heard: cannot open UDP")])
def test_private_ports_that_are_not_heard_are_reported(who, offset, notice):
    port, notices = free_ports(), []
    decoder = Decoder(port, {})
    with contextlib.closing(PlainListener(decoder, BROADCAST, notices.append)) as listener, \
            participant(who, port + offset), participant(BOX) as box:
        box.sendto(listing(port + 1), (BROADCAST, port))
        hear(listener, decoder, 1)
        assert len(listener.sockets) == 1
    assert len(notices) == 1 and notices[0].startswith(notice.format(port + 1))


@pytest.fixture
def raw():
    """A decoder and a listener that hears everything; skipped without root's rights."""
    with slots.free_slot() as slot:  # the 99 ports above the first one count as private channels: no others are near
        decoder = Decoder(slots.first_port(slot), {"Team": PASSWORD})
        try:
            listener = RawListener(decoder, BROADCAST, lambda text: pytest.fail(text))
        except PermissionError:
            pytest.skip("run as root or with CAP_NET_RAW (CAP_NET_RAW)")
        with contextlib.closing(listener):
            yield decoder, listener


def test_with_roots_rights_every_datagram_of_the_channels_is_heard_once(raw):
    decoder, listener = raw
    port = decoder.rsbb_port
    with participant(ROBOT, port) as robot, participant(BOX, port) as box, \
            participant(ROBOT, port + 50) as private, participant(BOX) as stranger:
        private_port = port + 50
        # Each arrives before the next one is sent: those of two processors may arrive in another order.
        robot.sendto(encode(BEACON), (BOX, port))
        box.recv(1000)
        robot.sendto(encode(BEACON), (BROADCAST, port))
        entries = hear(listener, decoder, 2)
        stranger.sendto(b"nothing to us", (ROBOT, private_port))
        private.recv(100)
        box.sendto(listing(private_port), (BROADCAST, port))
        entries += hear(listener, decoder, 1)
        stranger.sendto(STATE, (ROBOT, private_port))
        entries += hear(listener, decoder, 1)
        private.recv(100)
    assert [entry.message.DESCRIPTOR.name for entry in entries] == [
        "RobotBeacon", "RobotBeacon", "RoahRsbbBeacon", "BenchmarkState",
    ]
    assert [entry.datagram.dst for entry in entries] == [BOX, BROADCAST, BROADCAST, ROBOT]
    assert [entry.datagram.dport for entry in entries] == [port, port, port, private_port]
