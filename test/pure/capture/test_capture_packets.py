"""UDP datagrams in IPv4 packets, and in whatever else a network brings."""

import random
import socket
import struct

import pytest

from roah_rsbb.capture.decoding import Datagram
from roah_rsbb.capture.listening import Fragment, parse_packet

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
