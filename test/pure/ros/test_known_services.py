"""Calls of services: the address is remembered, and asked for again when nobody answers there."""

import threading

import pytest
import rospy
from rospy.exceptions import TransportInitError
from rospy.impl import tcpros_service
from std_srvs.srv import Trigger, TriggerResponse

from roah_rsbb.ros.known_services import KnownService


class Network:
    """The ROS master and the nodes that offer the service, without ROS."""

    def __init__(self):
        self.alive, self.asked, self.sent = "rosrpc://box:1", 0, []
        self.ends_answers = False
        self.answers = threading.Event()  # cleared: the node at the first address hangs
        self.answers.set()

    def address(self, _proxy, _request):
        self.asked += 1
        return self.alive

    def transport(self, *_of):
        network = self

        class Transport:
            buff_size = 0

            def connect(self, host, port, address):
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


@pytest.fixture
def network(monkeypatch):
    network = Network()
    monkeypatch.setattr(KnownService, "_addresses", {})
    monkeypatch.setattr(rospy.ServiceProxy, "_get_service_uri", lambda *of: network.address(*of))
    monkeypatch.setattr(tcpros_service, "TCPROSTransport", network.transport)
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
