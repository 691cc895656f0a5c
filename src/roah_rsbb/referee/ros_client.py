"""Calls services of ROS without rospy, whose import alone takes longer than a whole command should.

The caller is not a node: the master does not know it, and it has no servers. Each connection has a time limit.
"""

import os
import queue
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


class RosError(Exception):
    """A connection failed, or something is missing. The text is the reason."""


class Late(RosError):
    """There was no answer within the time limit."""


class ServiceError(RosError):
    """The service answered with an error, which is the text."""


class Connection:
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


def call(master_uri: str, caller: str, service: str, kind: Any, *request: object, limit_s: float) -> Any:
    """Call a service of a node of a ROS master and return its answer; raises `RosError`, `Late`, `ServiceError`.
    `caller`: the name that the node shows as the sender."""
    until = time.monotonic() + limit_s
    address = urlsplit(xml_rpc(master_uri, "lookupService", [caller, service], until))
    connection = Connection(address.hostname or "", address.port or 0, until)
    try:
        connection.handshake({"callerid": caller, "service": service, "md5sum": kind._md5sum}, until)
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


def caller_name(program: str) -> str:
    """Return a name of ROS that no other process has."""
    name = f"{program}_{socket.gethostname()}_{os.getpid()}_{int(time.time() * 1000)}"
    return "/" + "".join(letter if letter.isalnum() and letter.isascii() else "_" for letter in name)


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


def xml_rpc(uri: str, method: str, arguments: List[Any], until: float) -> Any:
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
