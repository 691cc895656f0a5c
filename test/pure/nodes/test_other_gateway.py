"""Whether another gateway runs, as the ROS master and a connection show it."""

import socket
import threading

import pytest

network = pytest.importorskip("rosgraph.network")
pytest.importorskip("rospy")

from roah_rsbb.nodes.web import other  # noqa: E402  (only with ROS)

TIMEOUT_S = 30.0


class Master:
    """A ROS master that knows a gateway at this port."""

    def __init__(self, port):
        self._port = port

    def lookupService(self, name):
        return f"rosrpc://127.0.0.1:{self._port}"

    def getSystemState(self):
        return [[], [], [["/rosout/get_loggers", ["/rosout"]], [other.PAIR, ["/first"]]]]


@pytest.fixture
def listening():
    with socket.create_server(("127.0.0.1", 0)) as sock:
        sock.settimeout(TIMEOUT_S)
        yield sock


def answering(listening, answer):
    def serve():
        connection, _ = listening.accept()
        with connection:
            connection.recv(65536)
            connection.sendall(answer)

    threading.Thread(target=serve, daemon=True).start()
    return other.running(Master(listening.getsockname()[1]))


def header(**fields):
    return network.encode_ros_handshake_header(fields)


def test_one_that_answers_runs(listening):
    assert answering(listening, header(service=other.PAIR, callerid="/first")) == "/first at 127.0.0.1"


@pytest.mark.parametrize("answer", [header(error=f"/new is not a provider of {other.PAIR}"), b"SSH-2.0\n", b""])
def test_another_program_at_its_port_is_no_gateway(listening, answer):
    assert answering(listening, answer) is None


def test_one_that_was_killed_does_not_run(listening):
    port = listening.getsockname()[1]
    listening.close()
    assert other.running(Master(port)) is None


def test_one_that_hangs_may_continue(listening, monkeypatch):
    monkeypatch.setattr(other, "ANSWER_S", 0.05)
    assert other.running(Master(listening.getsockname()[1])) == "/first at 127.0.0.1"


def test_without_a_master_none_runs(monkeypatch):
    class Gone:
        def lookupService(self, name):
            raise ConnectionRefusedError

    assert other.running(Gone()) is None
