"""Calls of services without rospy, with a master and nodes that do what real ones seldom do."""

import contextlib
import io
import socket
import struct
import threading
from typing import Any, Callable, Dict, Iterator
from xmlrpc.server import SimpleXMLRPCServer

import pytest

from roah_rsbb.referee import ros_client
from roah_rsbb.referee.ros_client import Late, RosError, ServiceError

CALLER = "/referee_1"
# For answers that come, however busy the machine is; and for those that never come.
LIMIT_S, SHORT_S = 30.0, 0.3


class Text:
    """A message of the tests."""

    _type, _md5sum = "tests/Text", "0123"

    def __init__(self, text: str = "") -> None:
        self.text = text

    def serialize(self, buffer: io.BytesIO) -> None:
        """Write it as messages of ROS are."""
        buffer.write(struct.pack("<I", len(self.text.encode())) + self.text.encode())

    def deserialize(self, data: bytes) -> "Text":
        """Read it."""
        assert struct.unpack("<I", data[:4])[0] == len(data) - 4
        self.text = data[4:].decode()
        return self


class Greet:
    """A service of the tests."""

    _md5sum, _request_class, _response_class = "4567", Text, Text


@contextlib.contextmanager
def server(talk: Callable[[socket.socket], None]) -> Iterator[int]:
    """A TCP server whose connections `talk` handles. Yields its port."""
    with socket.socket() as listening, contextlib.ExitStack() as connections:
        listening.bind(("127.0.0.1", 0))
        listening.listen(5)

        def serve() -> None:
            with contextlib.suppress(OSError):
                while True:
                    connection = connections.enter_context(listening.accept()[0])
                    talk(connection)

        threading.Thread(target=serve, daemon=True).start()
        yield listening.getsockname()[1]
        listening.shutdown(socket.SHUT_RDWR)  # wakes `accept`


class Node:
    """A master whose only node is on the same port: the XML-RPC server of Python's library."""

    def __init__(self) -> None:
        self.port = 0  # of the node's topics and services
        self.asked: list = []

    def lookupService(self, caller: str, name: str) -> Any:
        self.asked.append((caller, name))
        return (1, "", f"rosrpc://127.0.0.1:{self.port}") if name != "/missing" else (-1, "no <such> service", "")


@pytest.fixture(name="node")
def _node() -> Iterator[Node]:
    node = Node()
    with SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False) as master:
        master.register_instance(node)
        node.uri = f"http://localhost:{master.server_address[1]}/"
        threading.Thread(target=master.serve_forever, args=[0.02], daemon=True).start()
        yield node
        master.shutdown()


def call(node: Node, service: str = "/web/pair", text: str = "Home A", limit_s: float = LIMIT_S) -> Any:
    """Call a service of the node."""
    return ros_client.call(node.uri, CALLER, service, Greet, text, limit_s=limit_s)


def read_header(connection: socket.socket) -> Dict[str, str]:
    """Read the connection header of the other side."""
    stream = connection.makefile("rb")
    (left,) = struct.unpack("<I", stream.read(4))
    fields = {}
    while left:
        (size,) = struct.unpack("<I", stream.read(4))
        name, _, value = stream.read(size).decode().partition("=")
        fields[name] = value
        left -= 4 + size
    return fields


def header(**fields: str) -> bytes:
    """Return a connection header."""
    lines = [f"{name}={value}".encode() for name, value in fields.items()]
    text = b"".join(struct.pack("<I", len(line)) + line for line in lines)
    return struct.pack("<I", len(text)) + text


def block(message: Any) -> bytes:
    """Return a message with its size."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return struct.pack("<I", len(buffer.getvalue())) + buffer.getvalue()


def test_a_service_is_called(node: Node) -> None:
    heard = []

    def talk(connection: socket.socket) -> None:
        heard.append(read_header(connection))
        connection.sendall(header(callerid="/node"))
        (size,) = struct.unpack("<I", connection.recv(4))
        heard.append(Text().deserialize(connection.recv(size)).text)
        for byte in b"\1" + block(Text("done")):  # in pieces
            connection.sendall(bytes([byte]))

    with server(talk) as node.port:
        assert call(node, text="Home & <A> ä").text == "done"
    assert heard == [{"callerid": CALLER, "service": "/web/pair", "md5sum": Greet._md5sum}, "Home & <A> ä"]
    assert node.asked == [(CALLER, "/web/pair")]


def test_an_error_of_a_service_is_its_text(node: Node) -> None:
    def talk(connection: socket.socket) -> None:
        read_header(connection)
        connection.sendall(header(callerid="/node"))
        connection.recv(4096)
        connection.sendall(b"\0" + struct.pack("<I", 9) + "nö, wait".encode())

    with server(talk) as node.port, pytest.raises(ServiceError, match="^nö, wait$"):
        call(node)


def mute(_connection: socket.socket) -> None:
    """Accept a connection and send nothing."""


@pytest.mark.parametrize("talk, error, reason", [
    (mute, Late, "does not answer"),
    (lambda connection: connection.shutdown(socket.SHUT_RDWR), RosError, "closed|reset"),
    (lambda connection: connection.sendall(header(error="another md5sum")), RosError, "^another md5sum$"),
    (lambda connection: connection.sendall(b"SSH-2.0-OpenSSH_9.2"), RosError, "does not speak TCPROS"),
])
def test_whatever_does_not_serve_is_reported(node: Node, talk: Any, error: type, reason: str) -> None:
    with server(talk) as node.port, pytest.raises(error, match=reason):
        call(node, limit_s=SHORT_S if error is Late else LIMIT_S)


@pytest.mark.parametrize("talk, error, reason", [
    (mute, Late, "does not answer"),
    (lambda connection: connection.sendall(b"HTTP/1.0 403 refused\r\n\r\n"), RosError, "403"),
    (lambda connection: connection.sendall(b"HTTP/1.0 200 OK\r\nContent-Length: 3\r\n\r\n<a>"), RosError, "XML-RPC"),
    (lambda connection: connection.sendall(b"HTTP/1.0 200 OK\r\nContent-Length: 4\r\n\r\n<a/>"), RosError, "XML-RPC"),
    (lambda connection: connection.sendall(b"SSH-2.0-OpenSSH_9.2\r\n"), RosError, "SSH"),
])
def test_what_is_not_a_master_is_reported(talk: Any, error: type, reason: str) -> None:
    with server(talk) as port, pytest.raises(error, match=reason):
        ros_client.call(f"http://127.0.0.1:{port}", CALLER, "/web/pair", Greet, "",
                        limit_s=SHORT_S if error is Late else LIMIT_S)


@pytest.mark.parametrize("uri", ["", "127.0.0.1:11311", "http://127.0.0.1", "http://127.0.0.1:port", "http://[::1"])
def test_a_wrong_address_is_reported(uri: str) -> None:
    with pytest.raises(RosError):
        ros_client.call(uri, CALLER, "/web/pair", Greet, "", limit_s=LIMIT_S)


def test_the_reason_of_the_master_is_reported(node: Node) -> None:
    with pytest.raises(RosError, match="^no <such> service$"):
        call(node, "/missing")


def test_a_caller_has_a_name_that_ros_allows() -> None:
    assert ros_client.caller_name("referee").startswith("/referee_")
    assert ros_client.caller_name("référée")[1:].replace("_", "").isalnum()
