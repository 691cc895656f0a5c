"""Services that the loop itself reads, carries out and answers (docs/architecture.md, "STOP has its own lane").

rospy serves each call in two threads. With a thousand calls, or beside a flood of datagrams, every step of a thread
waits for the interpreter's lock, and the call then waits behind all others in the loop. Here, only what waits for the
disk is in a thread. Urgent services have a TCP port, and so a queue of the kernel, of their own. They are carried out
as soon as they are read. Of the other calls the loop carries out one in each of its turns, and none while an urgent one
is being read.
"""

import asyncio
import collections
import concurrent.futures
import contextlib
import errno
import io
import socket
import struct
from typing import Any, Callable, Deque, Dict, NamedTuple, Optional

import genpy
import rosgraph.network
import rospy
from rospy.impl import tcpros_service

from roah_rsbb.ground.loop import ANSWER_TIMEOUT_S
from roah_rsbb.ros.connections import DEADLINE_S, MAX_HANDSHAKE, MAX_WAITING

# Connections that are accepted in a turn of the loop.
MAX_ACCEPTS = 8
# How long other calls wait for the request of an urgent one at most. Its client sends it as soon as it has the answer
# to its handshake.
HELD_S = 0.05
# Calls that wait for the disk at the same time.
MAX_THREADS = 64
_MAX_READ = 65536  # bytes, in a turn of the loop
# Bytes. A longer text is refused with the reason; this is to keep the memory.
_MAX_REQUEST = 16 * 1024 * 1024
_LENGTH = struct.Struct("<I")
_ANSWER = struct.Struct("<BI")  # whether the call succeeded; the length of the answer, or of the text why not


class _Registered(tcpros_service.ServiceImpl):
    """A service that rospy registers with the ROS master, at an address that is not that of rospy's own server."""

    def __init__(self, name: str, kind: type, handle: Callable[[Any], Any], wait: Optional[Callable[[Any], Any]],
                 port: "_Port") -> None:
        self.wait = wait
        self.port = port
        super().__init__(name, kind, handle)

    @property
    def uri(self) -> str:
        """The address at which clients call it."""
        return self.port.uri

    @uri.setter
    def uri(self, _shared: str) -> None:
        """rospy sets the address of its own server."""


class _Call(NamedTuple):
    """A request that waits for its turn."""

    connection: "_Connection"
    service: _Registered
    body: bytes
    until_mono: float


class LoopServices:
    """The services of a node. Call everything in the loop's thread, or before the loop runs."""

    def __init__(self, loop: asyncio.AbstractEventLoop, check: Callable[[], None] = lambda: None) -> None:
        """`check` is called before an answer leaves: see `Fence.check`."""
        self.loop = loop
        self.check = check
        self.services: Dict[str, _Registered] = {}
        self._ports = {is_urgent: _Port(self, is_urgent) for is_urgent in (False, True)}
        self._calls: Deque[_Call] = collections.deque()
        self._turn: Optional[asyncio.Handle] = None  # in which the next call is carried out
        self._held_until_mono = float("-inf")
        self._threads = concurrent.futures.ThreadPoolExecutor(MAX_THREADS, "answers")

    def add(self, name: str, kind: type, handle: Callable[[Any], Any], wait: Optional[Callable[[Any], Any]] = None,
            is_urgent: bool = False) -> _Registered:
        """Offer a service, and return it. `handle(request)` is called in the loop's thread, and returns the answer.

        With `wait`, it returns something else: `wait` is called with that in another thread, where it may block, and
        returns the answer. Both may raise ServiceException.
        """
        service = _Registered(name, kind, handle, wait, self._ports[is_urgent])
        self.services[service.resolved_name] = service  # first: whoever asks the master may call at once
        tcpros_service.get_service_manager().register(service.resolved_name, service)
        return service

    def close(self) -> None:
        """End all connections."""
        for port in self._ports.values():
            port.close()
        self._threads.shutdown(wait=False)

    def put(self, connection: "_Connection", service: _Registered, body: bytes) -> None:
        """Carry a request out: at once if it is urgent, else when it is its turn."""
        if service.port.is_urgent:
            connection.carry_out(service, body)
            self._release()
        else:
            self._calls.append(_Call(connection, service, body, self.loop.time() + ANSWER_TIMEOUT_S))
            self._wake()

    def hold(self) -> None:
        """Let calls wait: an urgent one is being read."""
        self._held_until_mono = self.loop.time() + HELD_S

    def in_thread(self, work: Callable[[], bytes], done: Callable[[bytes], None]) -> None:
        """Call `work` in another thread, then `done` with its result in the loop's thread."""
        def run() -> None:
            result = work()
            with contextlib.suppress(RuntimeError):  # the loop has ended
                self.loop.call_soon_threadsafe(done, result)

        self._threads.submit(run)

    def _release(self) -> None:
        self._held_until_mono = float("-inf")
        if self._turn is not None:
            self._turn.cancel()
            self._turn = None
        self._wake()

    def _wake(self) -> None:
        if self._turn is None and self._calls:
            self._turn = self.loop.call_soon(self._carry_out_next)

    def _carry_out_next(self) -> None:
        self._turn = None
        if self.loop.time() < self._held_until_mono:
            self._turn = self.loop.call_at(self._held_until_mono, self._carry_out_next)
            return
        call = self._calls.popleft()
        self._wake()
        if self.loop.time() > call.until_mono:
            call.connection.answer(_failed(
                f"{rospy.get_name()} did not answer within {ANSWER_TIMEOUT_S:.0f} s: it has too many calls"))
        else:
            call.connection.carry_out(call.service, call.body)


class _Port:
    """A TCP port at which services are called."""

    def __init__(self, services: LoopServices, is_urgent: bool) -> None:
        self.is_urgent = is_urgent
        self._services = services
        # Connections whose handshake has not arrived, oldest first, and all others.
        self._silent: collections.OrderedDict[_Connection, None] = collections.OrderedDict()
        self._served: Dict[_Connection, None] = {}
        self._listening = socket.socket(socket.AF_INET6 if rosgraph.network.use_ipv6() else socket.AF_INET)
        self._listening.bind((rosgraph.network.get_bind_address(), 0))
        self._listening.listen(socket.SOMAXCONN)
        self._listening.setblocking(False)
        port = self._listening.getsockname()[1]
        self.uri = f"{rospy.core.ROSRPC}{rosgraph.network.get_host_name()}:{port}"
        services.loop.add_reader(self._listening, self._accept)

    def close(self) -> None:
        """End all connections."""
        self._services.loop.remove_reader(self._listening)
        self._listening.close()
        for connection in (*self._silent, *self._served):
            connection.close()

    def serve(self, connection: "_Connection") -> None:
        """Note that the handshake of a connection has arrived."""
        self._silent.pop(connection, None)
        self._served[connection] = None

    def forget(self, connection: "_Connection") -> None:
        """Note that a connection was closed."""
        self._silent.pop(connection, None)
        self._served.pop(connection, None)

    def _accept(self) -> None:
        for _ in range(MAX_ACCEPTS):
            try:
                sock, _ = self._listening.accept()
            except OSError as error:
                if error.errno in (errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.ENOBUFS):
                    self._drop_oldest()
                return
            connection = _Connection(self._services, self, sock)
            self._silent[connection] = None
            connection.read()  # its handshake has probably arrived
            if len(self._silent) > MAX_WAITING:
                self._drop_oldest()

    def _drop_oldest(self) -> None:
        if self._silent:
            next(iter(self._silent)).close()


class _Connection:
    """A connection of a client: its handshake, then a request, or several if it is persistent."""

    def __init__(self, services: LoopServices, port: _Port, sock: socket.socket) -> None:
        self._services = services
        self._port = port
        self._sock = sock
        self._data = bytearray()
        self._header: Dict[str, str] = {}
        self._service: Optional[_Registered] = None
        self._deadline = services.loop.call_later(DEADLINE_S, self.close)
        sock.setblocking(False)
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        services.loop.add_reader(sock, self.read)

    @property
    def _is_open(self) -> bool:
        return self._sock.fileno() >= 0

    @property
    def _is_persistent(self) -> bool:
        return self._header.get("persistent", "").lower() in ("1", "true")

    def close(self) -> None:
        """End it. Has no effect if it has ended."""
        if self._is_open:
            self._deadline.cancel()
            self._services.loop.remove_reader(self._sock)
            self._sock.close()
            self._port.forget(self)

    def read(self) -> None:
        """Take what has arrived."""
        try:
            data = self._sock.recv(_MAX_READ)
        except (BlockingIOError, InterruptedError):
            return
        except OSError:
            data = b""
        self._data += data
        if not data:
            self.close()
        while self._is_open and len(self._data) >= _LENGTH.size:
            whole = _LENGTH.size + _LENGTH.unpack_from(self._data)[0]
            if whole > (MAX_HANDSHAKE if self._service is None else _MAX_REQUEST):
                self.close()
            if len(self._data) < whole:
                return
            part = bytes(self._data[:whole])
            del self._data[:whole]
            if self._service is None:
                self._begin(part)
            else:
                self._deadline.cancel()
                self._services.put(self, self._service, part[_LENGTH.size:])

    def _begin(self, handshake: bytes) -> None:
        """Take the handshake."""
        try:
            self._header = rosgraph.network.decode_ros_handshake_header(handshake)
        except (rosgraph.network.ROSHandshakeException, ValueError, struct.error):
            self.close()
            return
        name, checksum = self._header.get("service", ""), self._header.get("md5sum", "")
        service = self._services.services.get(name)
        if service is None or service.port is not self._port:
            self._refuse(f"[{rospy.get_caller_id()}] is not a provider of [{name}] at this address")
        elif checksum not in (rospy.names.SERVICE_ANYTYPE, service.service_class._md5sum):
            self._refuse(f"md5sums of {name} do not match: [{checksum}] vs. [{service.service_class._md5sum}]")
        else:
            self._service = service
            self._port.serve(self)
            self._write(rosgraph.network.encode_ros_handshake_header(service.protocol.get_header_fields()))
            if self._header.get("probe") == "1":
                self.close()
            elif self._is_persistent:
                self._deadline.cancel()
            elif self._port.is_urgent:
                self._services.hold()

    def _refuse(self, why: str) -> None:
        self._write(rosgraph.network.encode_ros_handshake_header({"error": why}))
        self.close()

    def carry_out(self, service: _Registered, body: bytes) -> None:
        """Carry a request out, and answer it."""
        if not self._is_open:
            return  # nobody waits for it

        def handle() -> Any:
            request = service.request_class()
            request.deserialize(body)
            request._connection_header = self._header
            return service.handler(request)

        if service.wait is None:
            self.answer(_answer_of(service, handle))
            return
        results = []
        failed = _answer_of(service, lambda: results.append(handle()))
        if results:
            self._services.in_thread(lambda: _answer_of(service, lambda: service.wait(results[0])), self.answer)
        else:
            self.answer(failed)

    def answer(self, answer: bytes) -> None:
        """Send an answer."""
        self._services.check()
        self._write(answer)
        if not self._is_persistent:
            self.close()

    def _write(self, data: bytes) -> None:
        """Send a few bytes. A client that takes none has gone."""
        with contextlib.suppress(OSError):
            if self._sock.send(data) == len(data):
                return
        self.close()


def _answer_of(service: _Registered, make: Callable[[], Any]) -> bytes:
    """Return what the client is sent: what `make` returns, or why it failed."""
    buff = io.BytesIO()
    try:
        answer = make()
        if answer is not None:
            answer.serialize(buff)
    except (rospy.ServiceException, genpy.DeserializationError) as error:
        return _failed(str(error))
    except Exception as error:  # the client must not wait for ever
        rospy.logerr("internal error, please report it: %s", service.resolved_name, exc_info=True)
        return _failed(f"internal error: {error}")
    return _ANSWER.pack(True, len(buff.getvalue())) + buff.getvalue()


def _failed(why: str) -> bytes:
    text = f"service cannot process request: {why}".encode("utf-8", errors="replace")  # it quotes what came
    return _ANSWER.pack(False, len(text)) + text
