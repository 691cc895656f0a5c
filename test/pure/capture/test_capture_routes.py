"""What the tables of a Linux machine say of its network."""

import socket
import sys

import pytest

from helpers.small_box import BROADCAST, free_ports
from roah_rsbb.capture import listening
from roah_rsbb.comm.sockets import OpenError


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
