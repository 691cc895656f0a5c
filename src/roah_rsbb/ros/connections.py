"""Protects a node from foreign TCP connections, and from calls that are meant for another node.

rospy reads the first bytes of a new connection in the thread that accepts connections, without a timeout. One client
that connects and sends nothing (a port scan, a browser) blocks every service of the node, including STOP.
`protect` replaces that part of rospy in this process, before the node starts:

- The TCP port for topics and services passes a connection on once its whole handshake has arrived. A connection
  without a handshake is closed after `DEADLINE_S`.
- The XML-RPC port closes a connection that sends nothing for `DEADLINE_S`. It refuses requests of web browsers, because
  a page on the internet can make a browser on the referee's computer send requests to ROS.
- If too many connections are waiting, the oldest is closed.
- When a node starts again after a crash, the master asks whatever has the port of the crashed one to shut down. That
  may now be this node: it ignores a request that names another one.

It also keeps a publisher that starts in the moment in which a subscriber registers: rospy could lose it for good.

`init_node` also keeps the log lines of a node from calling the master. rospy would subscribe to a parameter with each
line, and for the master, that registers the node. A node that was just replaced and logs a line while it ends would
replace its successor, which would then end, too.
"""

import collections
import contextlib
import errno
import logging
import re
import resource
import selectors
import socket
import struct
import sys
import threading
import time
from http import HTTPStatus
from typing import Any, Callable, List, NamedTuple, Optional, Tuple

import rosgraph.xmlrpc
import rospy
from rospy.impl import masterslave, paramserver, registration, tcpros_base

# The field of a service call's handshake with the name that the referee typed: most requests have no field for it.
REFEREE_HEADER = "referee"

# Set by users of ROS who want log lines without the list of the node's topics.
_LINES_WITHOUT_TOPICS = "/rosout_disable_topics_generation"

# A client on the same network sends its handshake within milliseconds.
DEADLINE_S = 5.0
# Seconds. ROS programs keep a connection for their next call.
KEEP_ALIVE_S = 300.0
# Connections that may wait at once. A computer opens a few dozen when it starts.
MAX_WAITING = 256
# Bytes. A handshake has names, a checksum and a message definition.
MAX_HANDSHAKE = 65536
# Bytes. Larger than any parameter or list of publishers.
MAX_REQUEST = 10_000_000

_SIZE = struct.Struct("<I")
_log = logging.getLogger(__name__)
_OnConnection = Callable[[socket.socket, Tuple[str, int]], None]


def init_node(name: str, **options: Any) -> None:
    """`rospy.init_node` for every node of this package."""
    if sys.stdout is not None:
        # rospy does not flush: in a file or a pipe its log lines would come late, or never after a kill.
        sys.stdout.reconfigure(line_buffering=True)
    protect()
    rospy.init_node(name, **options)  # noqa: TID251
    logging.getLogger("roah_rsbb").parent = logging.getLogger("rosout")  # what this package logs are lines of the node
    known = rospy.get_param(_LINES_WITHOUT_TOPICS, False)
    paramserver.get_param_server_cache().set(_LINES_WITHOUT_TOPICS, known)


def protect() -> None:
    """Protect the servers that rospy starts in this process from now on."""
    tcpros_base.TCPServer.run = _serve
    rosgraph.xmlrpc.SilenceableXMLRPCRequestHandler = _RequestHandler
    rosgraph.xmlrpc.ThreadingXMLRPCServer = _XmlRpcServer
    masterslave.ROSHandler.shutdown = _shutdown
    registration.RegManager.publisher_update = _publisher_update
    # Waiting connections must not use up the file descriptors that a run's log needs.
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft != hard:
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))


# -- topics and services ----------------------------------------------------------------------------


def _serve(server: Any) -> None:
    """Replace `TCPServer.run`."""
    server.is_shutdown = False
    Handshakes(server.server_sock, server.inbound_handler).serve(lambda: server.is_shutdown)


class _Waiting(NamedTuple):
    sock: socket.socket
    address: Tuple[str, int]
    until_mono: float


class Handshakes:
    """Accepts connections, and hands each over once its handshake has arrived. Nothing in here blocks."""

    def __init__(self, server_sock: socket.socket, on_connection: _OnConnection) -> None:
        """`on_connection(socket, address)` is called in a thread of its own; it reads the handshake."""
        self._server_sock = server_sock
        self._on_connection = on_connection
        self._waiting: collections.OrderedDict[int, _Waiting] = collections.OrderedDict()  # oldest first
        self._selector = selectors.DefaultSelector()

    def serve(self, is_shutdown: Callable[[], bool]) -> None:
        """Run until the server's socket is closed."""
        self._server_sock.setblocking(False)
        self._server_sock.listen(socket.SOMAXCONN)
        self._selector.register(self._server_sock, selectors.EVENT_READ)
        try:
            while not is_shutdown() and self._server_sock.fileno() >= 0:
                for key, _ in self._selector.select(1.0):
                    if key.data is None:
                        self._accept()
                    elif key.fd in self._waiting:
                        self._look(key.fd)
                self._close_late()
        finally:
            for fd in list(self._waiting):
                self._drop(fd)
            self._selector.close()

    def _accept(self) -> None:
        try:
            sock, address = self._server_sock.accept()
        except OSError as error:
            if error.errno in (errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.ENOBUFS):
                self._drop_oldest()
                time.sleep(0.01)  # the connection stays in the queue, so that the selector returns at once
            return
        sock.setblocking(True)
        # Linux wakes the selector only when that many bytes have arrived, or the other side has closed.
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVLOWAT, _SIZE.size)
        self._waiting[sock.fileno()] = _Waiting(sock, address, time.monotonic() + DEADLINE_S)
        self._selector.register(sock, selectors.EVENT_READ, data=sock)
        if len(self._waiting) > MAX_WAITING:
            self._drop_oldest()

    def _look(self, fd: int) -> None:
        """Handle a waiting connection on which data arrived, or which was closed."""
        sock, address, _ = self._waiting[fd]
        wanted = _wanted(sock)
        if wanted is None:
            self._drop(fd)
        elif wanted > 0:
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVLOWAT, wanted)
        else:
            self._forget(fd)
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVLOWAT, 1)
            thread = threading.Thread(target=self._hand_over, args=(sock, address), daemon=True)
            try:
                thread.start()
            except RuntimeError:  # too many threads
                sock.close()

    def _hand_over(self, sock: socket.socket, address: Tuple[str, int]) -> None:
        try:
            self._on_connection(sock, address)
        except OSError as error:
            _log.warning("connection from %s: %s", address[0], error)
            sock.close()

    def _close_late(self) -> None:
        now_mono = time.monotonic()
        for fd, waiting in list(self._waiting.items()):
            if now_mono < waiting.until_mono:
                return  # the rest arrived later
            self._drop(fd)

    def _drop_oldest(self) -> None:
        if self._waiting:
            self._drop(next(iter(self._waiting)))

    def _drop(self, fd: int) -> None:
        self._forget(fd).sock.close()

    def _forget(self, fd: int) -> _Waiting:
        self._selector.unregister(fd)
        return self._waiting.pop(fd)


def _wanted(sock: socket.socket) -> Optional[int]:
    """Return how many bytes must arrive before the next check. 0: the handshake is complete. None: no handshake."""
    try:
        start = sock.recv(_SIZE.size, socket.MSG_PEEK | socket.MSG_DONTWAIT)
        if len(start) < _SIZE.size:
            return None  # closed by the other side
        total = _SIZE.size + _SIZE.unpack(start)[0]
        if total > MAX_HANDSHAKE:
            return None
        came = len(sock.recv(total, socket.MSG_PEEK | socket.MSG_DONTWAIT))
    except OSError:
        return None
    if came == total:
        return 0
    known = sock.getsockopt(socket.SOL_SOCKET, socket.SO_RCVLOWAT)
    return None if known == total else total  # woken again with fewer bytes: the other side has closed


# -- XML-RPC ----------------------------------------------------------------------------------------


class _RequestHandler(rosgraph.xmlrpc.SilenceableXMLRPCRequestHandler):
    """Reads requests of ROS programs only, and waits no longer than the deadline for each."""

    timeout = DEADLINE_S

    def do_POST(self) -> None:
        """Answer a call, or refuse it."""
        if is_browser(self.headers):
            self._refuse(HTTPStatus.FORBIDDEN, "calls from web pages are refused")
        elif self._size() > MAX_REQUEST:
            self._refuse(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, "the request is too large")
        else:
            super().do_POST()
            self.connection.settimeout(KEEP_ALIVE_S)

    def _size(self) -> int:
        try:
            return int(self.headers.get("Content-Length", 0))
        except ValueError:
            return MAX_REQUEST + 1

    def _refuse(self, status: HTTPStatus, why: str) -> None:
        self.close_connection = True
        self.send_error(status, why)


_shutdown_of_rospy = masterslave.ROSHandler.shutdown
# The master's reason begins with the node that it means (rosmaster.registrations.shutdown_node_task).
_NAMED = re.compile(r"\[(/\S+)\] Reason: ")


def _shutdown(handler: Any, caller_id: str, msg: str = "") -> Tuple[int, str, int]:
    """Replace `ROSHandler.shutdown`."""
    named = _NAMED.match(str(msg))
    if named is not None and named[1] != handler.name:
        _log.warning("%s asked %s to shut down on the port of %s: ignored", caller_id, named[1], handler.name)
        return 1, "ignored: this is another node", 0
    return _shutdown_of_rospy(handler, caller_id, msg)


def _publisher_update(manager: Any, topic: str, uris: List[str]) -> None:
    """Replace `RegManager.publisher_update`.

    rospy uses the last list of a topic's publishers only. But the answer to a registration can be read after the
    update that the master sent later. A publisher that has really gone costs one attempt to connect if its process
    ended; if its computer is gone, rospy tries on in a thread, as it does with each list.
    """
    with manager.cond:
        waiting = [uri for name, known in manager.updates if name == topic for uri in known]
        manager.updates.append((topic, list(dict.fromkeys([*uris, *waiting]))))
        manager.cond.notify_all()


def is_browser(headers: Any) -> bool:
    """Whether an HTTP request comes from a web page.

    Browsers name the page in a POST, and a page cannot suppress that. Without permission of the other site, they do
    not send XML to it. Programs of ROS send XML, and name no page.
    """
    kind = headers.get("Content-Type", "text/xml").split(";")[0].strip().lower()
    marks = ("Origin", "Referer", "Sec-Fetch-Site", "Sec-Fetch-Mode")
    return kind not in ("text/xml", "application/xml") or any(headers.get(mark) is not None for mark in marks)


class _XmlRpcServer(rosgraph.xmlrpc.ThreadingXMLRPCServer):
    """Serves each connection in a thread, but not more than `MAX_WAITING` at once."""

    def __init__(self, *args: Any, **options: Any) -> None:
        self._open: collections.OrderedDict[socket.socket, None] = collections.OrderedDict()  # oldest first
        self._lock = threading.Lock()
        super().__init__(*args, **options)

    def process_request(self, request: socket.socket, client_address: Any) -> None:
        """Serve a new connection. If there are too many, close the oldest."""
        oldest: List[socket.socket] = []
        with self._lock:
            self._open[request] = None
            while len(self._open) > MAX_WAITING:
                oldest.append(self._open.popitem(last=False)[0])
        for sock in oldest:
            with contextlib.suppress(OSError):
                sock.shutdown(socket.SHUT_RDWR)  # its thread then reads the end of the data, and closes it
        try:
            super().process_request(request, client_address)
        except RuntimeError:  # too many threads
            self.shutdown_request(request)

    def shutdown_request(self, request: socket.socket) -> None:
        """Forget a connection that has ended."""
        with self._lock:
            self._open.pop(request, None)
        super().shutdown_request(request)
