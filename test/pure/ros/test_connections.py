"""Strangers' connections to a node's TCP ports, calls for another node, and publishers that rospy would lose."""

import http.client
import queue
import socket
import struct
import threading

import pytest

rosgraph = pytest.importorskip("rosgraph")
masterslave = pytest.importorskip("rospy.impl.masterslave")
registration = pytest.importorskip("rospy.impl.registration")
tcpros_base = pytest.importorskip("rospy.impl.tcpros_base")

from roah_rsbb.ros import connections  # noqa: E402  (only with ROS)

TIMEOUT_S = 30.0
HEADER = b"callerid=/me"
HANDSHAKE = struct.pack("<II", len(HEADER) + 4, len(HEADER)) + HEADER


@pytest.fixture(autouse=True)
def _protected(monkeypatch):
    for owner, name in ((tcpros_base.TCPServer, "run"), (rosgraph.xmlrpc, "SilenceableXMLRPCRequestHandler"),
                        (rosgraph.xmlrpc, "ThreadingXMLRPCServer"), (masterslave.ROSHandler, "shutdown"),
                        (registration.RegManager, "publisher_update")):
        monkeypatch.setattr(owner, name, getattr(owner, name))  # restored after the test
    connections.protect()


@pytest.fixture
def port(monkeypatch):
    """The port of rospy's server for topics and services. It answers a handshake with an error."""
    monkeypatch.setattr(tcpros_base, "_error_connection_handler", lambda sock, address, header: "no such service")
    monkeypatch.setattr(connections, "DEADLINE_S", 10 * TIMEOUT_S)
    server = tcpros_base.TCPROSServer()
    server.start_server()
    yield server.tcp_ros_server.port
    server.shutdown()


@pytest.fixture
def connect():
    """Open connections to a port of this machine."""
    opened = []

    def connect_to(port, *parts):
        sock = socket.create_connection(("127.0.0.1", port), TIMEOUT_S)
        opened.append(sock)
        for part in parts:
            sock.sendall(part)
        return sock

    yield connect_to
    for sock in opened:
        sock.close()


def is_answered(sock):
    """Whether rospy answers a handshake, which it does after it read all of it."""
    return b"no topic or service name detected" in sock.recv(4096)


def is_closed(sock):
    """Whether the server closes the connection. With unread data, this is a reset."""
    try:
        return sock.recv(4096) == b""
    except ConnectionResetError:
        return True


def test_a_handshake_is_answered_beside_200_silent_connections(port, connect):
    silent = [connect(port) for _ in range(200)]
    assert is_answered(connect(port, HANDSHAKE))
    for sock in silent:
        sock.setblocking(False)
        with pytest.raises(BlockingIOError):
            sock.recv(1)  # it is still open: the answer did not wait for it to end


@pytest.mark.parametrize("begin", [b"", b"\x10", HANDSHAKE[:4], HANDSHAKE[:-1]])
def test_no_part_of_a_handshake_keeps_others_waiting(port, connect, begin):
    connect(port, begin)
    assert is_answered(connect(port, HANDSHAKE))


def test_a_handshake_may_come_in_pieces(port, connect):
    sock = connect(port)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    for byte in HANDSHAKE[:-1]:
        sock.sendall(bytes([byte]))
        assert is_answered(connect(port, HANDSHAKE))
    sock.sendall(HANDSHAKE[-1:])
    assert is_answered(sock)


@pytest.mark.parametrize("sent", [b"GET / HTTP/1.1\r\n\r\n", b"POST / HTTP/1.1\r\n", b"\xff\xff\xff\xff"])
def test_a_connection_without_a_handshake_is_closed_at_once(port, connect, sent):
    assert is_closed(connect(port, sent))


@pytest.mark.parametrize("begin", [b"", HANDSHAKE[:-1]])
def test_a_silent_connection_is_closed_after_the_deadline(port, connect, begin, monkeypatch):
    monkeypatch.setattr(connections, "DEADLINE_S", 0.1)
    assert is_closed(connect(port, begin))


def test_of_too_many_silent_connections_the_oldest_gives_way(port, connect, monkeypatch):
    monkeypatch.setattr(connections, "MAX_WAITING", 3)
    silent = [connect(port) for _ in range(5)]
    assert is_closed(silent[0])
    assert is_closed(silent[1])
    assert is_answered(connect(port, HANDSHAKE))


# -- XML-RPC ----------------------------------------------------------------------------------------


class Api(rosgraph.xmlrpc.XmlRpcHandler):
    """A node's TCP server for other nodes."""

    def __init__(self):
        self.ready = threading.Event()
        self.calls = []

    def _ready(self, uri):
        self.ready.set()

    def shutdown(self, caller, reason):
        """As the master calls it."""
        self.calls.append(reason)
        return 1, "", 0


@pytest.fixture
def api():
    """A node's XML-RPC server, and the received calls."""
    api = Api()
    node = rosgraph.xmlrpc.XmlRpcNode(0, api)
    node.start()
    assert api.ready.wait(TIMEOUT_S)
    api.port, server = node.port, node.server
    yield api
    # node.shutdown() only closes the socket, on which the server's thread then spins until the process ends.
    node.is_shutdown = True
    server.shutdown()
    server.server_close()


CALL = (b"<?xml version='1.0'?><methodCall><methodName>shutdown</methodName><params>"
        b"<param><value><string>/x</string></value></param><param><value><string>bye</string></value></param>"
        b"</params></methodCall>")


def call(port, **headers):
    """The status of a call that shuts a node down."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=TIMEOUT_S)
    connection.request("POST", "/", CALL, {name.replace("_", "-"): value for name, value in headers.items()})
    status = connection.getresponse().status
    connection.close()
    return status


@pytest.mark.parametrize("headers", [{}, {"Content_Type": "text/xml"}, {"Content_Type": "text/xml; charset=utf-8"}])
def test_programs_call(api, headers):
    assert call(api.port, **headers) == 200
    assert api.calls == ["bye"]


@pytest.mark.parametrize("headers", [
    {"Content_Type": "text/plain;charset=UTF-8"}, {"Content_Type": "application/x-www-form-urlencoded"},
    {"Content_Type": "multipart/form-data; boundary=x"},
    {"Content_Type": "text/xml", "Origin": "http://example.org"}, {"Content_Type": "text/xml", "Origin": "null"},
    {"Content_Type": "text/xml", "Referer": "http://example.org/"},
    {"Content_Type": "text/xml", "Sec_Fetch_Site": "cross-site"},
])
def test_web_pages_do_not(api, headers):
    assert call(api.port, **headers) == 403
    assert api.calls == []


def test_a_huge_request_is_refused_before_it_is_read(api, connect):
    sock = connect(api.port, b"POST / HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n")
    assert b"413" in sock.recv(4096)


def test_a_call_is_answered_beside_silent_connections(api, connect, monkeypatch):
    monkeypatch.setattr(connections, "MAX_WAITING", 20)
    silent = [connect(api.port) for _ in range(30)]
    assert call(api.port) == 200
    assert is_closed(silent[0])


def test_a_silent_connection_to_the_api_is_closed_after_the_deadline(api, connect, monkeypatch):
    monkeypatch.setattr(connections._RequestHandler, "timeout", 0.1)
    assert is_closed(connect(api.port, b"POST / HTTP/1.1\r\n"))


def test_a_program_may_keep_its_connection(api, monkeypatch):
    monkeypatch.setattr(connections._RequestHandler, "timeout", TIMEOUT_S)
    connection = http.client.HTTPConnection("127.0.0.1", api.port, timeout=TIMEOUT_S)
    for _ in range(2):
        connection.request("POST", "/", CALL, {"Content-Type": "text/xml"})
        response = connection.getresponse()
        response.read()
        assert response.status == 200
    connection.close()


@pytest.mark.parametrize(("reason", "ends"), [
    ("[/roah_rsbb_core] Reason: new node registered with same name", True),
    ("[/roah_rsbb_comm] Reason: new node registered with same name", False),
    ("user request", True), ("", True),
])
def test_a_node_is_not_ended_in_place_of_another_one(monkeypatch, reason, ends):
    ended = []
    monkeypatch.setattr(masterslave, "signal_shutdown", ended.append)
    handler = masterslave.ROSHandler("/roah_rsbb_core", "http://127.0.0.1:1")
    handler._shutdown = lambda why: True
    assert handler.shutdown("/master", reason)[0] == 1
    assert len(ended) == ends


def test_a_publisher_that_starts_while_a_subscriber_registers_is_not_lost():
    """The answer to the registration, which is older, is read after the master's update."""
    connected = queue.Queue()

    class Handler:
        done = False

        def _connect_topic(self, topic, uri):
            connected.put((topic, uri))
            return 1, "", 0

    handler = Handler()
    manager = registration.RegManager(handler)
    manager.publisher_update("/name", ["http://new/"])
    manager.publisher_update("/name", [])
    manager.publisher_update("/other", ["http://one/"])
    manager.publisher_update("/other", ["http://one/", "http://two/"])
    thread = threading.Thread(target=manager.run)
    thread.start()
    try:
        found = sorted(connected.get(timeout=60) for _ in range(3))
    finally:
        handler.done = True
        thread.join()
    assert found == [("/name", "http://new/"), ("/other", "http://one/"), ("/other", "http://two/")]
    assert connected.empty()
