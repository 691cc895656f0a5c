"""What is heard on real loopback sockets, with root's rights and without."""

import contextlib
import random
import select
import socket
import struct
import sys

import pytest

from helpers import slots
from helpers.box_beacon import box_beacon
from helpers.small_box import BOX, BROADCAST, PASSWORD, ROBOT, free_ports
from roah_rsbb.capture import listening
from roah_rsbb.capture.decoding import Datagram, DatagramKind, Decoder, Speaker
from roah_rsbb.capture.listening import Fragment, PlainListener, RawListener, parse_packet
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.comm.frame import encode
from roah_rsbb.comm.sockets import OpenError
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


# -- what the tables of a Linux machine say of its network --------------------------------------------

def hexadecimal(address):
    """An address as this machine's kernel writes it."""
    return f"{int.from_bytes(socket.inet_aton(address), sys.byteorder):08X}"


def route_table(*rows):
    """The text of /proc/net/route; a row: interface, destination, gateway, mask."""
    head = "Iface\tDestination\tGateway \tFlags\tRefCnt\tUse\tMetric\tMask\t\tMTU\tWindow\tIRTT\n"
    return head + "".join(
        f"{interface}\t{hexadecimal(destination)}\t{hexadecimal(gateway)}\t0001\t0\t0\t100\t{hexadecimal(mask)}\t0\t0\t0\n"
        for interface, destination, gateway, mask in rows
    )


NO_GATEWAY = "0.0.0.0"
DEFAULT = ("wlan0", "0.0.0.0", "192.168.1.1", "0.0.0.0")
HOME = ("wlan0", "192.168.1.0", NO_GATEWAY, "255.255.255.0")
ROBOTS = ("eth0", "10.0.0.0", NO_GATEWAY, "255.0.0.0")
PART = ("eth1", "10.2.0.0", NO_GATEWAY, "255.255.0.0")
BEHIND = ("eth1", "10.3.0.0", "10.2.0.1", "255.255.0.0")


@pytest.mark.parametrize("host, interface", [
    ("192.168.1.255", "wlan0"),
    ("10.255.255.255", "eth0"),
    ("10.2.255.255", "eth1"),  # the narrowest network
    ("10.3.255.255", None),  # another network, behind a router: no broadcast comes from there
    ("172.16.0.255", None),  # only the default route leads there
])
@pytest.mark.parametrize("rows", [
    (DEFAULT, HOME, ROBOTS, PART, BEHIND), (BEHIND, PART, ROBOTS, HOME, DEFAULT),
])
def test_the_interface_to_a_network(host, interface, rows):
    assert listening.route(host, route_table(*rows)) == interface


def test_of_two_ways_the_first_counts():
    rows = [("eth0", "10.0.0.0", NO_GATEWAY, "255.0.0.0"), ("eth1", "10.0.0.0", NO_GATEWAY, "255.0.0.0")]
    assert listening.route("10.255.255.255", route_table(*rows)) == "eth0"


def test_a_machine_without_a_network():
    assert listening.route("10.255.255.255", route_table()) is None
    assert listening.route("10.255.255.255", "") is None


def test_interfaces_to_a_network(monkeypatch):
    monkeypatch.setattr(listening, "_read_table", lambda path: {"/proc/net/route": route_table(DEFAULT, ROBOTS)}[path])
    assert listening.interfaces_to("10.255.255.255") == ["lo", "eth0"]
    assert listening.interfaces_to("127.255.255.255") == ["lo"]
    with pytest.raises(OpenError, match=r"--host 172\.16\.0\.255 is not in a network of this machine: give the "
                                        r"broadcast"):
        listening.interfaces_to("172.16.0.255")


def test_the_sockets_on_a_port():
    table = (
        "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode ref\n"
        "  10: 00000000:1A0A 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 4711 2 0 0\n"
        "  11: 0100007F:1A0A 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 4712 2 0 0\n"
        "  12: 00001A0A:0035 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 4713 2 0 0\n"
    )
    assert listening.udp_sockets(6666, table) == {4711, 4712}
    assert listening.udp_sockets(6667, table) == set()
    assert listening.udp_sockets(6666, "") == set()


def test_other_programs_on_a_port_are_seen_and_our_own_are_not():
    port = free_ports()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as own, \
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        own.bind(("127.0.0.1", port))
        assert not listening.others_use(port, [own])
        other.bind(("127.0.0.2", port))
        assert listening.others_use(port, [own])
        assert not listening.others_use(port, [own, other])


def test_only_a_broadcast_address_is_listened_to():
    assert listening.broadcast_address(BROADCAST) == BROADCAST
    with pytest.raises(OpenError, match=r"127\.0\.0\.1 is not a broadcast address of this machine: give the one"):
        listening.broadcast_address("127.0.0.1")


# -- uDP datagrams in IPv4 packets, and in whatever else a network brings -----------------------------

SRC, DST, TIME = "10.0.0.2", "10.0.0.255", 1700000000.5
DATA = bytes(range(40))


def packet(data=DATA, options=b"", fragment=0, protocol=socket.IPPROTO_UDP, version=4, udp_length=None, trailer=b""):
    """An IPv4 packet with a UDP datagram from port 6667 to port 6668; the checksums, which nobody reads, are 0."""
    udp = struct.pack(">HHHH", 6667, 6668, 8 + len(data) if udp_length is None else udp_length, 0) + data
    words = 5 + len(options) // 4
    head = struct.pack(
        ">BBHHHBBH4s4s", version << 4 | words, 0, words * 4 + len(udp), 1, fragment, 64, protocol, 0,
        socket.inet_aton(SRC), socket.inet_aton(DST),
    )
    return head + options + udp + trailer


EXPECTED = Datagram(TIME, SRC, 6667, DST, 6668, DATA)
DO_NOT_FRAGMENT, MORE_FRAGMENTS = 0x4000, 0x2000


@pytest.mark.parametrize("changes", [
    {},
    {"options": bytes(8)},
    {"options": bytes(40)},  # the most that there can be
    {"fragment": DO_NOT_FRAGMENT},
    {"trailer": bytes(6)},  # Ethernet fills short packets up
])
def test_a_datagram(changes):
    assert parse_packet(packet(**changes), TIME) == EXPECTED


def test_an_empty_datagram():
    assert parse_packet(packet(b""), TIME) == EXPECTED._replace(data=b"")


def test_a_datagram_shorter_than_its_packet():
    assert parse_packet(packet(udp_length=8 + 5), TIME) == EXPECTED._replace(data=DATA[:5])


def test_the_first_fragment_is_reported_and_the_others_are_ignored():
    assert parse_packet(packet(fragment=MORE_FRAGMENTS, udp_length=8 + 3000), TIME) == Fragment(SRC, 6668, 3000)
    assert parse_packet(packet(fragment=MORE_FRAGMENTS | 185), TIME) is None
    assert parse_packet(packet(fragment=185), TIME) is None


def test_a_fragment_that_announces_less_than_nothing():
    assert parse_packet(packet(fragment=MORE_FRAGMENTS, udp_length=3), TIME) == Fragment(SRC, 6668, 0)


@pytest.mark.parametrize("changes", [
    {"protocol": socket.IPPROTO_TCP},
    {"version": 6},
    {"udp_length": 7},
    {"udp_length": 8 + len(DATA) + 1},
    {"udp_length": 8 + len(DATA) + 1, "trailer": b"x"},
])
def test_incomplete_udp_datagrams(changes):
    assert parse_packet(packet(**changes), TIME) is None


def test_a_header_shorter_than_any():
    whole = bytearray(packet())
    whole[0] = 0x44
    whole[20:22] = (8 + len(DATA)).to_bytes(2, "big")  # a size that fits, where it would be then
    assert parse_packet(bytes(whole), TIME) is None


@pytest.mark.parametrize("options", [b"", bytes(8)])
def test_a_packet_that_is_cut_off_anywhere(options):
    whole = packet(options=options)
    assert [parse_packet(whole[:size], TIME) for size in range(len(whole))] == [None] * len(whole)


def test_noise_does_not_count_as_an_error():
    rng = random.Random(1)
    for _ in range(3000):
        noise = bytearray(packet(options=bytes(4 * rng.randrange(3))))
        for _ in range(rng.randrange(1, 6)):
            noise[rng.randrange(len(noise))] = rng.randrange(256)
        found = parse_packet(bytes(noise[:rng.randrange(len(noise) + 1)]), TIME)
        assert found is None or isinstance(found, (Datagram, Fragment))
