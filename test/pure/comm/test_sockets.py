"""The addresses that a peer binds, and errors with their remedies."""

import errno
import socket

import pytest

from helpers import slots
from helpers.small_box import free_ports
from roah_rsbb.comm import sockets

NOT_HERE = "203.0.113.77"  # an address for documentation: nobody's


def test_broadcast_addresses_are_recognised():
    assert sockets.is_broadcast("127.255.255.255")
    assert not sockets.is_broadcast("127.0.0.1")
    assert not sockets.is_broadcast("0.0.0.0")


@pytest.mark.parametrize("bind_host, rsbb_host, expected", [
    ("127.0.0.2", "127.255.255.255", "127.255.255.255"),
    ("127.0.0.2", "127.0.0.1", "127.255.255.255"),  # the box's own address: never bound to
    ("192.168.1.10", "192.168.1.1", None),
    ("192.168.1.10", "192.168.1.255", "192.168.1.255"),
])
def test_where_broadcasts_are_received(bind_host, rsbb_host, expected, monkeypatch):
    monkeypatch.setattr(sockets, "is_broadcast", lambda host: host.endswith(".255"))
    assert sockets.broadcast_host(bind_host, rsbb_host) == expected


def test_the_source_of_datagrams():
    assert sockets.source_host("127.255.255.255") == "127.0.0.1"


def test_the_source_is_unknown_without_a_way(monkeypatch):
    def connect(self, address):
        raise OSError(errno.ENETUNREACH, "Network is unreachable")

    class Unconnected(socket.socket):
        pass

    Unconnected.connect = connect
    monkeypatch.setattr(sockets.socket, "socket", Unconnected)
    assert sockets.source_host("10.0.0.1") is None
    assert not sockets.is_broadcast("10.0.0.1")


def test_a_test_gets_no_port_that_another_program_has(port):
    with slots.free_slot() as slot:
        bases = slots.first_port(slot), port + 5
    udp = socket.AF_INET, socket.SOCK_DGRAM
    with socket.socket(*udp) as one, socket.socket(*udp) as two:
        one.bind(("127.0.0.3", bases[0]))
        two.bind(("127.0.0.3", bases[1] + 2))
        with slots.free_slot() as another:
            assert another != slot
        assert free_ports() != bases[1]


def test_an_address_in_use(port):
    with sockets.listen("127.0.0.1", port, shared=False), pytest.raises(OSError) as caught:
        sockets.listen("127.0.0.1", port, shared=True)
    assert caught.value.errno == errno.EADDRINUSE
    assert str(caught.value).startswith(f"cannot open UDP 127.0.0.1:{port}: in use by another program")


def test_shared_sockets_share(port):
    with sockets.listen("127.0.0.1", port, shared=True), sockets.listen("127.0.0.1", port, shared=True):
        pass


def test_an_address_of_another_machine(port):
    with pytest.raises(OSError, match=f"cannot open UDP {NOT_HERE}:{port}: .*correct bind_host .option --bind"):
        sockets.listen(NOT_HERE, port, shared=False)


@pytest.mark.parametrize("port", [-1, 0, 65536])
def test_a_port_that_does_not_exist(port):
    with pytest.raises(OSError, match=f"{port} is not a UDP port: choose an rsbb_port"):
        sockets.listen("127.0.0.1", port, shared=False)


def test_sockets_neither_block_nor_lack_room(port):
    with sockets.listen("127.0.0.1", port, shared=False) as endpoint:
        assert not endpoint.getblocking()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as usual:
            room = usual.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
        assert endpoint.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF) >= room


def test_names_are_resolved_once_and_errors_name_the_parameter(monkeypatch):
    monkeypatch.setattr(sockets.socket, "gethostbyname", {"box": "10.0.0.1"}.__getitem__)
    assert sockets.resolve("127.0.0.1", "rsbb_host") == "127.0.0.1"
    assert sockets.resolve("box", "rsbb_host") == "10.0.0.1"

    def unknown(host):
        raise socket.gaierror(socket.EAI_NONAME, "Name or service not known")

    monkeypatch.setattr(sockets.socket, "gethostbyname", unknown)
    for host in ("nowhere", "", "10.0.0", "\ud800"):
        with pytest.raises(OSError, match=r"bind_host '.*' is neither an IPv4 address"):
            sockets.resolve(host, "bind_host")
    monkeypatch.setattr(sockets.socket, "gethostbyname", lambda host: "10.0.0.0")
    with pytest.raises(OSError, match="'10.0.0' is neither"):  # which the name service takes for an address
        sockets.resolve("10.0.0", "rsbb_host")
