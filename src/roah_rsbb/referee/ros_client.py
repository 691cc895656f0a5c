"""Calls services and reads topics of ROS without rospy, whose import alone takes longer than a whole command should.

A `Client` is not a node: the master does not know it, and it has no servers. It opens connections to the master and to
the nodes, and each of them has a time limit.
"""

import os
import queue
import select
import socket
import struct
import threading
import time
import xmlrpc.client
from http.client import HTTPException
from io import BytesIO
from typing import Any, Callable, Dict, List, NoReturn, Optional, Tuple
from urllib.parse import urlsplit
from xml.parsers.expat import ExpatError
from xmlrpc.client import ProtocolError, ServerProxy

_SIZE = struct.Struct("<I")
_PIECE = 1 << 18  # bytes to read at once
# Bytes of a message or answer. More than any of ours, less than the memory of a computer.
_MAX_BYTES = 1 << 28
_SUCCESS = 1  # the status of an answer to an XML-RPC call
_LIMIT_S = 2.0  # for the connections of a topic


class RosError(Exception):
    """A connection failed, or something is missing. The text is the reason."""


class Late(RosError):
    """There was no answer within the time limit."""


class ServiceError(RosError):
    """The service answered with an error, which is the text."""


class _Socket:
    """A TCP connection whose every operation ends at a moment, in monotonic seconds."""

    def __init__(self, host: str, port: int, until: float) -> None:
        error: Optional[OSError] = None
        for family, kind, protocol, _, address in _addresses(host, port, until):
            self.socket = socket.socket(family, kind, protocol)
            try:
                self.socket.settimeout(_left(until))
                self.socket.connect(address)
                return
            except socket.timeout:
                self.close()
                raise Late("does not answer") from None
            except OSError as failed:
                self.close()
                error = failed
        raise RosError(str(error))

    def close(self) -> None:
        """Close the connection."""
        self.socket.close()

    def write(self, data: bytes, until: float) -> None:
        """Send all of `data`."""
        self.socket.settimeout(_left(until))
        try:
            self.socket.sendall(data)
        except OSError as error:
            _fail(error)

    def read(self, until: float, most: int = _PIECE) -> bytes:
        """Return the next bytes; raises `RosError` when the other side has closed the connection."""
        self.socket.settimeout(_left(until))
        try:
            data = self.socket.recv(most)
        except OSError as error:
            _fail(error)
        if not data:
            raise RosError("the connection was closed")
        return data

    def read_exactly(self, size: int, until: float) -> bytes:
        """Return this many bytes."""
        parts = []
        while size:
            part = self.read(until, min(size, _PIECE))
            parts.append(part)
            size -= len(part)
        return b"".join(parts)

    def read_block(self, until: float) -> bytes:
        """Return the bytes that follow their number."""
        return self.read_exactly(_size_of(self.read_exactly(_SIZE.size, until)), until)

    def handshake(self, fields: Dict[str, str], until: float) -> None:
        """Exchange the connection headers of TCPROS. Raises `RosError` if the node refuses the connection."""
        lines = [f"{name}={value}".encode() for name, value in fields.items()]
        header = b"".join(_SIZE.pack(len(line)) + line for line in lines)
        self.write(_SIZE.pack(len(header)) + header, until)
        answer = BytesIO(self.read_block(until))
        while True:
            size = answer.read(_SIZE.size)
            if len(size) < _SIZE.size:
                return
            name, _, value = answer.read(_SIZE.unpack(size)[0]).decode(errors="replace").partition("=")
            if name == "error":
                raise RosError(value)


class Client:
    """Reaches the nodes of a ROS master under the name `caller`, which nodes show as the sender of a call."""

    def __init__(self, master_uri: str, caller: str, remapped: Optional[Dict[str, str]] = None) -> None:
        """`remapped`: other names of topics and services."""
        self.master_uri = master_uri
        self.caller = caller
        self._remapped = remapped or {}

    def published(self, limit_s: float = _LIMIT_S) -> Dict[str, List[str]]:
        """Return the topics that have publishers, and the names of these nodes; raises `RosError`."""
        state = _xml_rpc(self.master_uri, "getSystemState", [self.caller], time.monotonic() + limit_s)
        topics: Dict[str, List[str]] = dict(state[0])
        return {name: topics[actual] for name, actual in self._names(topics)}

    def _names(self, topics: Dict[str, List[str]]) -> List[Tuple[str, str]]:
        renamed = [(name, actual) for name, actual in self._remapped.items() if actual in topics]
        return [(name, name) for name in topics if name not in self._remapped] + renamed

    def call(self, service: str, kind: Any, *request: object, limit_s: float) -> Any:
        """Call a service and return its answer; raises `RosError`, `Late`, `ServiceError`."""
        until = time.monotonic() + limit_s
        name = self._remapped.get(service, service)
        address = urlsplit(_xml_rpc(self.master_uri, "lookupService", [self.caller, name], until))
        connection = _Socket(address.hostname or "", address.port or 0, until)
        try:
            connection.handshake({"callerid": self.caller, "service": name, "md5sum": kind._md5sum}, until)
            buffer = BytesIO()
            kind._request_class(*request).serialize(buffer)
            connection.write(_SIZE.pack(len(buffer.getvalue())) + buffer.getvalue(), until)
            is_done = connection.read_exactly(1, until) != b"\0"
            answer = connection.read_block(until)
        finally:
            connection.close()
        if not is_done:
            raise ServiceError(answer.decode(errors="replace"))
        return kind._response_class().deserialize(answer)

    def follow(self, topic: str, kind: Any, limit_s: float = _LIMIT_S) -> "Subscription":
        """Connect to the first publisher of a topic that answers; raises `RosError`."""
        until = time.monotonic() + limit_s
        name = self._remapped.get(topic, topic)
        error = RosError("nobody publishes it")
        for node in self.published(limit_s).get(topic, ()):
            try:
                uri = _xml_rpc(self.master_uri, "lookupNode", [self.caller, node], until)
                _, host, port = _xml_rpc(uri, "requestTopic", [self.caller, name, [["TCPROS"]]], until)
                return Subscription(self._subscribed(name, kind, _Socket(host, port, until), until), kind)
            except RosError as failed:
                error = failed
        raise error

    def _subscribed(self, name: str, kind: Any, connection: _Socket, until: float) -> socket.socket:
        header = {"callerid": self.caller, "topic": name, "md5sum": kind._md5sum, "type": kind._type,
                  "tcp_nodelay": "1"}
        try:
            connection.handshake(header, until)
        except RosError:
            connection.close()
            raise
        return connection.socket


class Subscription:
    """A connection to a topic's publisher."""

    def __init__(self, connected: socket.socket, kind: Any) -> None:
        self._socket = connected
        self._socket.setblocking(False)
        self._kind = kind
        self._buffer = bytearray()

    def fileno(self) -> int:
        """For `wait`."""
        return self._socket.fileno()

    def close(self) -> None:
        """End the connection."""
        self._socket.close()

    def take(self) -> Any:
        """Return the newest message that has arrived, or None. Raises `RosError` when the publisher is gone."""
        gone: Optional[RosError] = None
        while gone is None:
            try:
                data = self._socket.recv(_PIECE)
            except BlockingIOError:
                break
            except OSError as error:
                gone = RosError(str(error))
            else:
                self._buffer += data
                gone = None if data else RosError("the publisher has closed the connection")
        newest = self._newest()
        if newest is not None:
            return self._kind().deserialize(newest)
        if gone is not None:
            raise gone
        return None

    def _newest(self) -> Optional[bytes]:
        newest, at = None, 0
        while len(self._buffer) - at >= _SIZE.size:
            end = at + _SIZE.size + _size_of(self._buffer[at:at + _SIZE.size])
            if end > len(self._buffer):
                break
            newest, at = (at + _SIZE.size, end), end
        found = None if newest is None else bytes(self._buffer[slice(*newest)])
        del self._buffer[:at]
        return found


def wait(subscriptions: List[Subscription], limit_s: float) -> None:
    """Wait until something has arrived at one of them, but not longer than `limit_s`."""
    select.select(subscriptions, (), (), max(0.0, limit_s))


def caller_name(program: str) -> str:
    """Return a name of ROS that no other process has."""
    name = f"{program}_{socket.gethostname()}_{os.getpid()}_{int(time.time() * 1000)}"
    return "/" + "".join(letter if letter.isalnum() and letter.isascii() else "_" for letter in name)


def remapped(words: List[str]) -> Dict[str, str]:
    """Return the names of topics and services that words such as /from:=/to give them."""
    pairs = (word.partition(":=") for word in words if ":=" in word and not word.startswith("_"))
    return {"/" + name.lstrip("/"): "/" + other.lstrip("/") for name, _, other in pairs}


# -- connections ----------------------------------------------------------------------------------


def _left(until: float) -> float:
    left = until - time.monotonic()
    if left <= 0:
        raise Late("does not answer")
    return left


def _fail(error: OSError) -> NoReturn:
    if isinstance(error, socket.timeout):
        raise Late("does not answer") from None
    raise RosError(str(error)) from None


def _size_of(data: bytes) -> int:
    size: int = _SIZE.unpack(data)[0]
    if size > _MAX_BYTES:
        raise RosError("the other side does not speak TCPROS")
    return size


def _addresses(host: str, port: int, until: float) -> List[Any]:
    """Return the addresses of a computer. The system may look for a name longer than the limit allows."""

    def resolve() -> List[Any]:
        # bytes: for a str, Python would load its tables of international names
        return socket.getaddrinfo(host.encode(), port, type=socket.SOCK_STREAM)

    try:
        return limited(_left(until), resolve)
    except Late:
        raise Late("has a name that cannot be found") from None
    except (OSError, UnicodeError) as error:
        raise RosError(f"{host}: {error}") from None


def limited(limit_s: float, job: Callable[[], Any]) -> Any:
    """Return or raise what `job` does, or raise `Late` after `limit_s`. A late job continues in its thread."""
    done: queue.Queue[Tuple[Any, Optional[Exception]]] = queue.Queue()

    def work() -> None:
        try:
            done.put((job(), None))
        except Exception as error:
            done.put((None, error))

    threading.Thread(target=work, daemon=True).start()
    try:
        result, error = done.get(timeout=limit_s)
    except queue.Empty:
        raise Late("does not answer") from None
    if error is not None:
        raise error
    return result


# -- XML-RPC --------------------------------------------------------------------------------------


def _xml_rpc(uri: str, method: str, arguments: List[Any], until: float) -> Any:
    """Call a master or node and return the value of its answer; raises `RosError`."""
    try:
        address = urlsplit(uri)
        is_whole = bool(address.hostname and address.port)
    except ValueError as error:
        raise RosError(str(error)) from None
    if not is_whole:
        raise RosError(f"'{uri}' is not an address such as http://computer:11311")
    try:
        status, message, value = limited(_left(until), lambda: getattr(ServerProxy(uri), method)(*arguments))
    except ProtocolError as error:
        raise RosError(f"the answer is HTTP {error.errcode}") from None
    except (OSError, HTTPException) as error:
        raise RosError(str(error)) from None
    except (xmlrpc.client.Error, ExpatError, ValueError, TypeError):
        raise RosError("the other side does not speak XML-RPC") from None
    if status != _SUCCESS:
        raise RosError(str(message))
    return value
