"""A peer on real loopback sockets: receiving, sending, and errors of both."""

import errno
import logging
import operator
import select
import socket
import time

import pytest

from roah_rsbb.comm import sockets
from roah_rsbb.comm.peer import Peer
from roah_rsbb.ground import linux

BROADCAST = "127.255.255.255"
BOX = "127.0.0.1"


@pytest.fixture
def peer(loop, port, inbox, opened):
    """Open a peer with inboxes `datagrams` and `complaints`."""
    def make(bind_host=BOX, rsbb_host=BROADCAST, on_datagram=None, **options):
        datagrams, complaints = inbox(), inbox()
        made = Peer(loop, rsbb_host, port, on_datagram or datagrams, complaints, bind_host, **options)
        made.datagrams, made.complaints = datagrams, complaints
        return opened(made)
    return make


@pytest.fixture
def raw():
    """A plain socket with its own address and port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as endpoint:
        endpoint.bind(("127.0.0.9", 0))
        yield endpoint


class Failing:
    """A socket that neither sends nor receives, for the reason given."""

    def __init__(self, number):
        self.number = number

    def sendto(self, datagram, address):
        raise OSError(self.number, "failed")

    def recvmsg(self, size, space):
        raise OSError(self.number, "failed")

    def fileno(self):
        return -1

    def close(self):
        pass


class Clock:
    """The loop, with a clock that tests set."""

    def __init__(self, loop):
        self.now = 100.0
        self.add_reader, self.remove_reader = loop.add_reader, loop.remove_reader

    def time(self):
        return self.now


@pytest.mark.parametrize("bind_host", [BOX, "0.0.0.0"])
@pytest.mark.parametrize("size", [0, 1, 1024, 60000])
def test_receives_datagrams_of_any_size(peer, raw, port, bind_host, size):
    receiver = peer(bind_host)
    raw.sendto(b"x" * size, (BOX, port))
    assert receiver.datagrams.wait() == [(b"x" * size, raw.getsockname())]


def test_the_time_of_a_datagram_is_that_of_its_arrival(peer, raw, port, inbox):
    """It lies between the arrivals of datagrams at another socket, which were sent before and after it."""
    times = inbox()
    receiver = peer(on_datagram=lambda datagram, sender: times(receiver.received_utc))
    assert receiver.received_utc is None
    with sockets.speak(BOX) as other:
        def arrival():
            """When a datagram arrives now, and a time between that and its reading."""
            raw.sendto(b"other", other.getsockname())
            select.select([other], [], [])
            return time.time(), linux.receive(other)[2]

        # The system begins to note arrivals some time after the first socket asks for it; until then it notes readings.
        until = time.monotonic() + 20
        while operator.lt(*arrival()):
            assert time.monotonic() < until, "the times are those of the readings"
        others = [arrival()[1]]
        for number in range(3):
            raw.sendto(b"%d" % number, (BOX, port))
            others.append(arrival()[1])
    assert all(before <= time <= after for before, time, after in zip(others, times.wait(3), others[1:]))


def test_a_port_elsewhere_on_the_same_address_is_not_its_own(peer, port):
    receiver = peer()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind((BOX, 0))
        other.sendto(b"hello", (BOX, port))
        assert receiver.datagrams.wait() == [(b"hello", other.getsockname())]


@pytest.mark.parametrize("bind_host", [BOX, "0.0.0.0"])
def test_own_broadcasts_are_ignored(peer, raw, port, bind_host):
    sender, other = peer(bind_host), peer("127.0.0.2")
    assert sender.send(b"mine", BROADCAST)
    assert other.datagrams.wait() == [(b"mine", (BOX, port))]
    raw.sendto(b"after", (BOX, port))
    assert sender.datagrams.wait() == [(b"after", raw.getsockname())]


@pytest.mark.parametrize("bind_host", [BOX, "0.0.0.0"])
def test_one_that_only_listens_hears_another_program_at_its_address(peer, port, bind_host):
    """A check of a robot must hear the box of the same computer before it disturbs it."""
    box, check = peer(bind_host), peer(bind_host)
    assert box.send(b"beacon", BROADCAST)
    assert check.datagrams.wait() == [(b"beacon", (BOX, port))]


@pytest.mark.parametrize("bind_host", [BOX, "0.0.0.0"])
def test_one_that_is_apart_is_heard_on_its_own_machine_and_takes_nothing_away(peer, raw, port, bind_host):
    box, apart = peer(bind_host), peer(bind_host, apart=True)
    assert apart.send(b"from apart", BROADCAST)
    ((datagram, sender),) = box.datagrams.wait()
    assert datagram == b"from apart" and sender[1] != port
    for number in range(20):
        raw.sendto(b"to the box alone %d" % number, (BOX, port))
    assert len(box.datagrams.wait(21)) == 21
    assert box.send(b"to all", BROADCAST)
    assert apart.datagrams.wait() == [(b"to all", (BOX, port))]


def test_one_that_is_apart_does_not_open_where_it_would_hear_nothing(peer):
    with pytest.raises(OSError, match="not a broadcast address of this machine") as raised:
        peer("0.0.0.0", rsbb_host="127.0.0.5", apart=True)
    assert "bind_host" not in str(raised.value)


def test_the_own_address_is_asked_for_once_a_second_and_kept_while_unknown(loop, port, inbox, monkeypatch):
    answers = ["10.0.0.1", None, "10.0.0.2"]
    monkeypatch.setattr(sockets, "source_host", lambda destination: answers.pop(0))
    clock = Clock(loop)
    asking = Peer(clock, BROADCAST, port, inbox(), inbox())
    heard = []
    for clock.now in (100.0, 100.5, 101.0, 101.9, 102.0):
        heard.append(asking._source_host())
    assert heard == ["10.0.0.1"] * 4 + ["10.0.0.2"]


def test_a_flood_leaves_the_loop_time_for_others(loop, peer, raw, port):
    received = []
    meanwhile = []

    def on_datagram(datagram, sender):
        if not received:
            loop.call_soon(lambda: meanwhile.append(len(received)))
        received.append(datagram)

    peer(on_datagram=on_datagram)
    for number in range(120):
        raw.sendto(b"%d" % number, (BOX, port))
    for _ in range(100):
        loop.run_until_complete(_one_turn())
    assert 1 <= meanwhile[0] <= 20
    assert len(received) == 120


async def _one_turn():
    pass


def test_a_handler_that_fails_does_not_end_the_reading(peer, raw, port, inbox, caplog):
    seen = inbox()

    def on_datagram(datagram, sender):
        seen(datagram)
        raise RuntimeError("a mistake")

    peer(on_datagram=on_datagram)
    with caplog.at_level(logging.ERROR):
        for _ in range(3):
            raw.sendto(b"x", (BOX, port))
        assert seen.wait(3) == [b"x"] * 3
    assert len(caplog.records) == 1
    assert "a mistake" in caplog.text
    assert "Traceback" in caplog.text


def test_a_handler_may_close_the_peer(peer, raw, port, inbox):
    seen = inbox()

    def on_datagram(datagram, sender):
        closing.close()
        seen(datagram)

    closing = peer(on_datagram=on_datagram)
    for _ in range(3):
        raw.sendto(b"x", (BOX, port))
    assert seen.wait() == [b"x"]
    assert not closing.is_open
    assert not closing.complaints
    closing.open()
    raw.sendto(b"again", (BOX, port))
    assert seen.wait(2) == [b"x", b"again"]


def test_too_large_a_datagram_is_not_sent(peer, raw):
    sender = peer(max_datagram=10)
    assert sender.send(b"x" * 10, "127.0.0.9")
    assert not sender.send(b"x" * 11, "127.0.0.9")
    assert not sender.send(b"x" * 11, "127.0.0.9")
    assert len(sender.complaints) == 1
    assert "11 bytes, but receivers may only read 10" in sender.complaints[0]
    assert "raise max_datagram" in sender.complaints[0]


def test_too_large_for_the_system(peer):
    sender = peer(max_datagram=100000)
    assert not sender.send(b"x" * 66000, "127.0.0.9")
    assert "lower max_datagram" in sender.complaints[0]


@pytest.mark.parametrize("number, remedy", [
    (errno.ENETUNREACH, "rsbb_host"), (errno.EHOSTUNREACH, "host is on"), (errno.ENETDOWN, "is down"),
    (errno.EPERM, "firewall"), (errno.EACCES, "firewall"), (errno.EAGAIN, "too slow"),
    (errno.ENOBUFS, "too slow"), (errno.EINVAL, "bind_host"), (errno.EIO, "check the network"),
])
def test_errors_of_sending_are_reported_with_a_remedy_once_a_second(loop, port, inbox, number, remedy):
    complaints, clock = inbox(), Clock(loop)
    sender = Peer(clock, BROADCAST, port, inbox(), complaints)
    sender._sockets = [Failing(number)]
    for clock.now in (100.0, 100.5, 100.9, 101.0):
        assert sender.send(b"x", "127.0.0.9") is False
    assert len(complaints) == 2
    assert complaints[0].startswith(f"could not send a datagram to 127.0.0.9:{port}: ")
    assert complaints[1].startswith(f"could not send 3 datagrams to 127.0.0.9:{port}: ")
    assert remedy in complaints[0]


def test_errors_of_reading_are_reported_once_a_second(loop, port, inbox):
    complaints, clock = inbox(), Clock(loop)
    reader = Peer(clock, BROADCAST, port, inbox(), complaints)
    for clock.now in (100.0, 100.5, 101.0):
        reader._read(Failing(errno.ENETDOWN))
    assert len(complaints) == 2
    assert f"could not read from UDP port {port}" in complaints[0]


def test_a_complaint_handler_that_fails_is_logged(loop, port, inbox, caplog):
    def fail(text):
        raise RuntimeError("a mistake")

    sender = Peer(loop, BROADCAST, port, inbox(), fail)
    sender._sockets = [Failing(errno.EPERM)]
    with caplog.at_level(logging.ERROR):
        assert sender.send(b"x", "127.0.0.9") is False
    assert "a mistake" in caplog.text


def test_a_closed_peer_sends_nothing_and_says_nothing(peer):
    sender = peer()
    sender.close()
    sender.close()
    assert sender.send(b"x" * 9999, "127.0.0.9") is False
    assert not sender.complaints


def test_open_twice_is_once(peer, raw, port):
    receiver = peer(shared=False)
    receiver.open()
    raw.sendto(b"x", (BOX, port))
    raw.sendto(b"y", (BOX, port))
    assert [datagram for datagram, _ in receiver.datagrams.wait(2)] == [b"x", b"y"]


def test_a_broadcast_address_to_bind_to_is_refused(peer):
    with pytest.raises(OSError, match="is a broadcast address: give an address"):
        peer(BROADCAST)


def test_without_a_broadcast_address_there_is_a_warning(peer, raw, port, monkeypatch):
    monkeypatch.setattr(sockets, "broadcast_host", lambda bind_host, rsbb_host: None)
    receiver = peer(rsbb_host="127.0.0.7")
    assert len(receiver.complaints) == 1
    assert "127.0.0.7 is not a broadcast address" in receiver.complaints[0]
    raw.sendto(b"unicast", (BOX, port))
    assert receiver.datagrams.wait() == [(b"unicast", raw.getsockname())]


def test_a_failure_to_open_leaves_nothing_open(peer, port):
    with sockets.listen(BROADCAST, port, shared=False):
        with pytest.raises(OSError, match=f"cannot open UDP {BROADCAST}:{port}: in use"):
            peer()
        with sockets.listen(BOX, port, shared=False):
            pass  # it was released
