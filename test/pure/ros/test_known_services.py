"""Calls of services: the address is remembered, and asked for again when nobody answers there. Each call ends."""

import contextlib
import socket
import threading

import pytest
import rospy
from rosgraph.network import write_ros_handshake_header
from rospy.exceptions import TransportInitError
from rospy.impl import tcpros_base
from std_srvs.srv import Trigger, TriggerResponse

from roah_rsbb.ros import known_services
from roah_rsbb.ros.known_services import KnownService


class Network:
    """The ROS master and the nodes that offer the service, without ROS."""

    def __init__(self):
        self.alive, self.asked, self.sent = "rosrpc://box:1", 0, []
        self.ends_answers = self.master_is_gone = False
        self.answers = threading.Event()  # cleared: the node at the first address hangs
        self.answers.set()

    def address(self, _proxy):
        self.asked += 1
        if self.master_is_gone:
            raise rospy.ServiceException("unable to contact master")
        return self.alive

    def transport(self, *_of):
        network = self

        class Transport:
            buff_size = 0

            def connect(self, host, port, address, timeout):
                if address != network.alive:
                    raise TransportInitError("connection refused")
                self.address = address

            def send_message(self, request, _number):
                network.sent.append(request)

            def receive_once(self):
                if network.ends_answers:
                    raise rospy.exceptions.TransportTerminated("the node was killed")
                if self.address == "rosrpc://box:1":
                    network.answers.wait()
                return [TriggerResponse(True, self.address)]

            def close(self):
                pass

        return Transport()


@pytest.fixture(autouse=True)
def _nothing_is_known(monkeypatch):
    monkeypatch.setattr(KnownService, "_addresses", {})
    monkeypatch.setattr(KnownService, "_last", {})


@pytest.fixture
def network(monkeypatch):
    network = Network()
    monkeypatch.setattr(KnownService, "_ask_master", lambda *of: network.address(*of))
    monkeypatch.setattr(known_services, "_TimedTransport", network.transport)
    return network


def call() -> str:
    return KnownService("/core/start", Trigger)().message


def test_the_master_is_asked_once(network):
    assert [call() for _ in range(3)] == ["rosrpc://box:1"] * 3
    assert network.asked == 1


def test_a_restarted_node_is_found_and_called_once(network):
    call()
    network.alive = "rosrpc://box:2"
    assert call() == "rosrpc://box:2"
    assert network.asked == 2
    assert len(network.sent) == 2, "one for each call"
    assert call() == "rosrpc://box:2"
    assert network.asked == 2


def test_a_call_that_was_sent_is_not_repeated(network):
    call()
    network.ends_answers = True
    with pytest.raises(rospy.ServiceException, match="killed"):
        call()
    assert len(network.sent) == 2
    assert network.asked == 1


def test_a_node_that_is_gone_is_an_error(network):
    call()
    network.alive = "nowhere"
    network.address = lambda *_of: "rosrpc://box:1"
    with pytest.raises(rospy.ServiceException, match="unable to connect"):
        call()
    assert len(network.sent) == 1


def test_a_master_that_is_gone_is_not_needed(network):
    KnownService("/core/start", Trigger).learn()
    network.master_is_gone = True
    assert call() == "rosrpc://box:1"
    network.ends_answers = True
    with pytest.raises(rospy.ServiceException, match="killed"):
        call()
    network.ends_answers = False
    assert call() == "rosrpc://box:1", "also after a call that got no answer"
    network.alive = "rosrpc://box:2"
    with pytest.raises(rospy.ServiceException, match="unable to connect"):
        call()


def test_a_service_that_nobody_knows_is_an_error(network):
    network.master_is_gone = True
    with pytest.raises(rospy.ServiceException, match="unable to contact master"):
        call()


def test_while_a_node_hangs_the_next_call_finds_another_one(network):
    call()
    network.answers.clear()
    answered = []
    hanging = threading.Thread(target=lambda: answered.append(call()))
    hanging.start()
    while len(network.sent) < 2:
        pass
    assert network.asked == 1
    network.alive = "rosrpc://box:2"
    assert call() == "rosrpc://box:2"
    network.answers.set()
    hanging.join()
    assert answered == ["rosrpc://box:1"]


@contextlib.contextmanager
def hanging_node(says_hello):
    """A node that accepts connections and never answers a call; `says_hello`: it answers what comes before a call."""
    with socket.create_server(("127.0.0.1", 0)) as server, contextlib.ExitStack() as taken:
        def serve():
            with contextlib.suppress(OSError):  # the test is over
                while True:
                    connection = taken.enter_context(server.accept()[0])
                    if says_hello:
                        write_ros_handshake_header(connection, {
                            "callerid": "/node", "md5sum": Trigger._md5sum, "type": Trigger._type,
                            "request_type": "std_srvs/TriggerRequest", "response_type": "std_srvs/TriggerResponse"})

        thread = threading.Thread(target=serve)
        thread.start()
        try:
            yield f"127.0.0.1:{server.getsockname()[1]}"
        finally:
            server.shutdown(socket.SHUT_RDWR)
            thread.join()


@pytest.mark.parametrize("says_hello", [False, True])
def test_a_call_of_a_node_that_hangs_ends(monkeypatch, says_hello):
    monkeypatch.setattr(known_services, "STEP_S", 0.1)
    monkeypatch.setattr(tcpros_base, "_use_tcp_keepalive", True)  # rospy asks the master for it once in a process
    with hanging_node(says_hello) as address:
        monkeypatch.setattr(KnownService, "_ask_master", lambda _proxy: f"rosrpc://{address}")
        with pytest.raises(rospy.ServiceException, match="transport error" if says_hello else "unable to connect"):
            call()


def test_a_question_to_a_master_that_hangs_ends(monkeypatch):
    monkeypatch.setattr(known_services, "STEP_S", 0.1)
    with hanging_node(False) as address:
        monkeypatch.setenv("ROS_MASTER_URI", f"http://{address}")
        with pytest.raises(rospy.ServiceException, match="unable to contact master"):
            call()
