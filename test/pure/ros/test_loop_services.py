"""Calls that the loop reads and answers: STOP comes before all others, and nobody keeps others waiting."""

import contextlib
import socket
import struct
import threading

import pytest

rospy = pytest.importorskip("rospy")
network = pytest.importorskip("rosgraph.network")
srv = pytest.importorskip("roscpp.srv")

from rospy.impl import registration, tcpros_service  # noqa: E402

from roah_rsbb.comm.peer import Peer  # noqa: E402
from roah_rsbb.ros import loop_services  # noqa: E402  (only with ROS)
from roah_rsbb.ros.loop_services import LoopServices  # noqa: E402

Service = srv.SetLoggerLevel  # any with a text
TIMEOUT_S = 30.0
CALL, STOP = "/core/score", "/core/stop"
LONG_S = 600.0


class World:
    """A node with a service for STOP and one for other calls, and what they carried out, in its order."""

    def __init__(self, running):
        self.running = running
        self.done = []
        self.checked = []
        self.services = LoopServices(running.loop, lambda: self.checked.append(len(self.done)))
        for name in (CALL, STOP):
            self.services.add(name, Service, self._handle, is_urgent=name == STOP)
        self._clients = []

    def _handle(self, request):
        if request.logger == "refused":
            raise rospy.ServiceException("not now")
        if request.logger == "bug":
            raise KeyError("of the handler")
        self.done.append(request.logger)
        return srv.SetLoggerLevelResponse()

    def port(self, name):
        return int(self.services.services[name].uri.rpartition(":")[2])

    def connect(self, name, **header):
        """A client that has sent its handshake."""
        sock = socket.create_connection((network.get_local_address(), self.port(name)), TIMEOUT_S)
        self._clients.append(sock)
        sock.sendall(network.encode_ros_handshake_header({
            "callerid": "/me", "service": name, "md5sum": Service._md5sum, **header}))
        return sock

    def call(self, name, zone, **header):
        """Call in a thread, as a client does. Returns a function that runs the loop until its answer is there."""
        sock, answer = self.connect(name, **header), []

        def ask():
            network.decode_ros_handshake_header(received(sock))
            sock.sendall(request(zone))
            answer.append(sock.recv(4096))

        thread = threading.Thread(target=ask, daemon=True)
        thread.start()

        def answered():
            self.running.until(lambda: answer)
            return answer[0]

        return answered

    def close(self):
        for sock in self._clients:
            sock.close()
        self.services.close()
        for service in list(self.services.services.values()):
            tcpros_service.get_service_manager().unregister(service.resolved_name, service)


def request(zone):
    body = struct.pack("<I", len(zone)) + zone.encode() + struct.pack("<I", 0)
    return struct.pack("<I", len(body)) + body


def received(sock):
    """A handshake."""
    size = sock.recv(4, socket.MSG_WAITALL)
    return size + sock.recv(struct.unpack("<I", size)[0], socket.MSG_WAITALL)


DONE = b"\1" + struct.pack("<I", 0)


@pytest.fixture
def world(running, monkeypatch):
    monkeypatch.setattr(loop_services, "DEADLINE_S", LONG_S)
    made = World(running)
    yield made
    made.close()


def test_a_service_is_served_before_the_master_knows_of_it(world, monkeypatch):
    served = []

    class Listener(registration.RegistrationListener):
        def reg_added(self, resolved_name, data_type_or_uri, reg_type):
            served.append((resolved_name, resolved_name in world.services.services))

    monkeypatch.setattr(registration.get_registration_listeners(), "listeners", [Listener()])
    world.services.add("/core/new", Service, world._handle)
    assert served == [("/core/new", True)]


def test_the_core_is_checked_before_an_answer_leaves(world):
    """Another box may have taken over while this process was stopped."""
    assert world.call(CALL, "Home")().startswith(DONE[:1])
    assert world.checked == [1]


class Queued:
    """A call that waits, without its connection."""

    def __init__(self, order, name):
        self._order = order
        self._name = name

    def carry_out(self, service, body):
        self._order.append(self._name)

    def answer(self, answer):
        self._order.append(answer)


def test_a_stop_behind_a_thousand_calls_is_carried_out_first(world):
    order, services = [], world.services
    for number in range(1000):
        services.put(Queued(order, number), services.services[CALL], b"")
    services.put(Queued(order, "STOP"), services.services[STOP], b"")
    assert order == ["STOP"]
    world.running.until(lambda: len(order) > 1000)
    assert order == ["STOP", *range(1000)]


def test_other_calls_wait_while_a_stop_is_read(world, monkeypatch):
    monkeypatch.setattr(loop_services, "HELD_S", LONG_S)
    order, services = world.done, world.services
    answered = world.call(STOP, "Home")
    for number in range(1000):
        services.put(Queued(order, number), services.services[CALL], b"")
    assert answered() == DONE
    assert order.index("Home") < 10, "some were carried out before the handshake was read"
    world.running.until(lambda: len(order) == 1001)


def test_a_client_that_does_not_send_its_stop_delays_others_by_a_moment_only(world, monkeypatch):
    monkeypatch.setattr(loop_services, "HELD_S", 0.01)
    world.connect(STOP)
    assert world.call(CALL, "Home")() == DONE


def test_a_datagram_comes_between_two_calls(world):
    order, services = [], world.services
    for number in range(100):
        services.put(Queued(order, number), services.services[CALL], b"")
    here, there = socket.socketpair()
    there.send(b"x")
    world.running.loop.add_reader(here, lambda: order.append(("datagram", here.recv(1))))
    world.running.until(lambda: len(order) == 101)
    assert order.index(("datagram", b"x")) < 5
    world.running.loop.remove_reader(here)
    here.close()
    there.close()


def test_few_datagrams_are_handled_before_a_waiting_stop(world, monkeypatch):
    """The kernel has a thousand of them, and a STOP whose handshake was answered."""
    monkeypatch.setattr(loop_services, "HELD_S", LONG_S)
    stop = world.connect(STOP, persistent="1")
    handshakes = []
    reader = threading.Thread(target=lambda: handshakes.append(received(stop)), daemon=True)
    reader.start()
    world.running.until(lambda: handshakes)
    handled = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as attacker:
        attacker.bind(("127.0.0.9", 0))
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        peer = Peer(world.running.loop, "127.255.255.255", port, lambda datagram, sender: handled.append(
            bool(world.done)), lambda text: None, "127.0.0.1")
        peer.open()
        for _ in range(200):
            attacker.sendto(b"x", ("127.0.0.1", port))
        stop.sendall(request("Home"))
        world.running.until(lambda: len(handled) == 200)
        peer.close()
    assert handled.count(False) <= 60


@pytest.mark.parametrize("name", [CALL, STOP])
def test_a_call_is_answered(world, name):
    assert world.call(name, "Home")() == DONE
    assert world.done == ["Home"]


@pytest.mark.parametrize("name", [CALL, STOP])
@pytest.mark.parametrize(("zone", "text"), [("refused", b"not now"), ("bug", b"internal error: 'of the handler'")])
def test_a_call_that_fails_gets_the_reason(world, name, zone, text):
    answer = world.call(name, zone)()
    assert answer[:1] == b"\0" and text in answer
    assert world.call(name, "Home")() == DONE


def test_what_waits_for_the_disk_waits_in_another_thread(world):
    on_disk, waiting = threading.Event(), threading.Event()

    def wait(result):
        waiting.set()
        assert on_disk.wait(TIMEOUT_S)
        if result == "full":
            raise rospy.ServiceException("the disk is full")
        return srv.SetLoggerLevelResponse()

    world.services.add("/core/mark", Service, lambda r: r.logger, wait)
    saved, failed = world.call("/core/mark", "Home"), world.call("/core/mark", "full")
    world.running.until(waiting.is_set)
    assert world.call(STOP, "Home")() == DONE
    on_disk.set()
    assert saved() == DONE
    assert b"the disk is full" in failed()


def test_a_refusal_that_quotes_half_a_character_is_an_answer(world):
    def refuse(_request):
        raise rospy.ServiceException("no field '\ud800'")

    world.services.add("/core/act", Service, refuse)
    assert b"no field '?'" in world.call("/core/act", "Home")()


def test_a_persistent_connection_takes_many_calls(world):
    sock, answers = world.connect(CALL, persistent="1"), []

    def ask():
        received(sock)
        sock.sendall(request("one") + request("two")[:3])
        answers.append(sock.recv(5, socket.MSG_WAITALL))
        sock.sendall(request("two")[3:])
        answers.append(sock.recv(5, socket.MSG_WAITALL))

    threading.Thread(target=ask, daemon=True).start()
    world.running.until(lambda: len(answers) == 2)
    assert answers == [DONE, DONE] and world.done == ["one", "two"]


@pytest.mark.parametrize(("name", "header", "text"), [
    (CALL, {"md5sum": "0" * 32}, b"md5sums of /core/score do not match"),
    (CALL, {"service": STOP}, b"not a provider of [/core/stop] at this address"),
    (STOP, {"service": CALL}, b"not a provider of [/core/score] at this address"),
    (CALL, {"service": "/other"}, b"not a provider of [/other]"),
    (CALL, {"probe": "1", "md5sum": "*"}, b"type=roscpp/SetLoggerLevel"),
])
def test_a_handshake_that_begins_no_call_is_answered_and_ended(world, name, header, text):
    sock = world.connect(name, **header)
    world.running.turn()
    sock.settimeout(TIMEOUT_S)
    assert text in received(sock)
    assert sock.recv(1) == b""


@pytest.mark.parametrize("sent", [b"GET / HTTP/1.1\r\n\r\n", struct.pack("<I", 6) + b"\xff" * 6, b"\xff" * 8])
def test_a_connection_without_a_handshake_is_closed(world, sent):
    sock = socket.create_connection((network.get_local_address(), world.port(STOP)), TIMEOUT_S)
    sock.sendall(sent)
    world.running.turn()
    with sock, contextlib.suppress(ConnectionResetError):  # of unread data
        assert sock.recv(1) == b""


def test_silent_connections_keep_nobody_out(world, monkeypatch):
    monkeypatch.setattr(loop_services, "MAX_WAITING", 3)
    silent = [socket.create_connection((network.get_local_address(), world.port(STOP)), TIMEOUT_S) for _ in range(20)]
    assert world.call(STOP, "Home")() == DONE
    for sock in silent[:-3]:
        assert sock.recv(1) == b"", "the oldest gave way"
    for sock in silent:
        sock.close()


def test_a_call_that_waited_too_long_is_refused(world, monkeypatch):
    monkeypatch.setattr(loop_services, "ANSWER_TIMEOUT_S", -1.0)
    assert b"it has too many calls" in world.call(CALL, "Home")()
    assert world.done == []


def test_a_call_whose_client_has_gone_is_not_carried_out(world):
    services = world.services
    for number in range(3):
        services.put(Queued(world.done, number), services.services[CALL], b"")
    gone = world.connect(CALL, persistent="1")
    gone.sendall(request("Home"))
    gone.shutdown(socket.SHUT_RDWR)
    gone.close()
    assert world.call(CALL, "there")() == DONE
    assert world.done == [0, 1, 2, "there"]
