"""A web server that bad clients cannot keep from serving others: few connections, short requests, clear errors.

The gateway and the tablet's page use it.
"""

import asyncio
import copy
import errno
import functools
import os
import socket
import struct
import zlib
from typing import Any, Callable, Dict, List, Optional, Tuple

from tornado import httpserver, iostream, netutil, web, websocket

from roah_rsbb.web.limits import ConnectionPlaces

ANY_HOST = "0.0.0.0"
MAX_MESSAGE_BYTES = 1024
# An objection of 300 characters, in any script, and who objects.
_MAX_BODY_BYTES = 4 * 1024
_MAX_HEADER_BYTES = 16 * 1024
IDLE_S = 30.0
# A connection that a paired device has used is closed later: its STOP should not wait for a new one.
DEVICE_IDLE_S = 3600.0
# Connections that the system accepts for us before we do. Others are tried again by their clients after 1, 3, 7 s.
BACKLOG = 4096
# Accepted connections of which so many are served in a turn of the loop. Those that wait too long are closed.
SERVED_AT_ONCE = 8
# Messages of which the frame is kept: as many as readers in several languages get at the same time.
FRAMES = 16
# Longer messages are compressed for readers that understand it.
DEFLATED_BYTES = 1024
_TEXT_AND_FINAL, _DEFLATED = 0x81, 0x40
_PING = 0x9
# A reader that has not taken a message for so long is gone, or does not read.
STUCK_S = 20.0
# The system would otherwise hold megabytes for a reader that does not read.
SEND_BUFFER_BYTES = 64 * 1024


class ServeError(OSError):
    """A page cannot be served. The text, without the error number, names the remedy."""

    def __str__(self) -> str:
        return str(self.strerror)


class BoundedServer(httpserver.HTTPServer):
    """Serves a limited number of connections. If there are too many, the address with the most loses its oldest one
    that was not kept.

    Otherwise slow connections would use up all file descriptors of the process, and no browser could connect.
    """

    def initialize(self, *args: Any, **options: Any) -> None:
        super().initialize(*args, max_body_size=_MAX_BODY_BYTES, max_header_size=_MAX_HEADER_BYTES,
                           idle_connection_timeout=IDLE_S, body_timeout=IDLE_S, **options)
        self._waiting: ConnectionPlaces[iostream.IOStream] = ConnectionPlaces(lambda stream: stream.close())

        self._patient = copy.copy(self.conn_params)
        self._patient.header_timeout = DEVICE_IDLE_S
        self._accepted: ConnectionPlaces[Tuple[socket.socket, Any]] = ConnectionPlaces(lambda one: one[0].close())
        self._is_serving = False

    def stop(self) -> None:
        """Stop listening, and close the connections that are not served yet."""
        super().stop()
        for one in self._accepted:
            self._accepted.remove(one)
            one[0].close()

    def _handle_connection(self, connection: socket.socket, address: Any) -> None:
        """Take a connection that Tornado has accepted. To serve it takes much longer than to accept it: under a flood
        the backlog would be full, and paired devices could not connect."""
        self._accepted.add((connection, address), address[0])
        if not self._is_serving:
            self._is_serving = True
            asyncio.get_event_loop().call_soon(self._serve_some)

    def _serve_some(self) -> None:
        for _ in range(SERVED_AT_ONCE):
            one = self._accepted.take()
            if one is None:
                self._is_serving = False
                return
            self._serve(*one)
        asyncio.get_event_loop().call_soon(self._serve_some)

    def _serve(self, connection: socket.socket, address: Any) -> None:
        super()._handle_connection(connection, address)

    def start_request(self, server_conn: Any, request_conn: Any) -> Any:
        """Wait for the next request of a connection."""
        if getattr(request_conn.stream, "is_of_device", False):
            request_conn.params = self._patient
        return super().start_request(server_conn, request_conn)

    def handle_stream(self, stream: iostream.IOStream, address: Any) -> Any:
        """Serve a connection."""
        # Tornado sets its own callback for connections that it serves.
        for waiting in self._waiting:
            if waiting.closed():
                self._waiting.remove(waiting)
        self._waiting.add(stream, address[0])
        return super().handle_stream(stream, address)

    def keep(self, stream: Optional[iostream.IOStream]) -> None:
        """Stop counting a connection, such as one of a page that is open: pages have their own limit."""
        self._waiting.remove(stream)

    def know(self, stream: Optional[iostream.IOStream], address: str) -> None:
        """Note that a connection is that of a paired device. Connections from its address have reserved places."""
        self._accepted.know(None, address)
        self._waiting.know(stream, address)
        if stream is not None:
            stream.is_of_device = True


class _BoundedProtocol(websocket.WebSocketProtocol13):
    """Takes one frame in each turn of the loop. Tornado would take all that have arrived in one turn: a stream of pings
    or fragments would stop everything else. And it would keep all answers to pings until they are read."""

    async def _receive_frame(self) -> None:
        await super()._receive_frame()
        await asyncio.sleep(0)

    def _handle_message(self, opcode: int, data: bytes) -> Any:
        if opcode == _PING and self.stream.writing():
            return None  # the answer to a later one will do (RFC 6455, 5.5.3)
        return super()._handle_message(opcode, data)


class BoundedSocket(websocket.WebSocketHandler):
    """A WebSocket that takes no more time or memory than others, whatever arrives, and whether or not it is read.

    A kind that sends much calls `begin` when it is open, `write_frames` only while it is not busy, and has `on_sent`,
    called when what was written is taken, and `on_lost`, called when the connection is closed instead.
    """

    busy_since: Optional[float] = None  # loop's time at which something was written that is not taken yet; None: all is

    def on_sent(self) -> None:
        """Write what is next."""

    def on_lost(self) -> None:
        """Free the place."""

    def begin(self, keep: Callable[[Optional[iostream.IOStream]], None]) -> None:
        """Limit what the system holds for it. `keep`: see `BoundedServer.keep`."""
        stream = self._stream()
        if stream is not None and stream.socket is not None:
            stream.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER_BYTES)
        self.set_nodelay(True)
        keep(stream)

    def write_frames(self, frames: bytes, now: float) -> bool:
        """Write frames of `frame`; returns whether that was possible. Tornado's `write_message` would make them again
        for each reader, and start a task."""
        connection = self.ws_connection
        if connection is None or connection.client_terminated or connection.server_terminated:
            self.on_lost()
            return False
        try:
            sent = connection.stream.write(frames)
        except iostream.StreamClosedError:
            self.on_lost()
            return False
        if not sent.done():
            self.busy_since = now
            sent.add_done_callback(self._on_sent)
            return True
        return self._is_sent(sent)

    def is_stuck(self, now: float) -> bool:
        """Whether it takes nothing any more: it is gone, or does not read."""
        return self.busy_since is not None and now - self.busy_since > STUCK_S

    def end(self) -> None:
        """Close the connection at once: `close` would wait behind what is not taken."""
        self.on_lost()
        stream = self._stream()
        if stream is not None:
            stream.close()

    def _stream(self) -> Optional[iostream.IOStream]:
        return getattr(self.ws_connection, "stream", None)

    def _on_sent(self, sent: "asyncio.Future[None]") -> None:
        self.busy_since = None
        if self._is_sent(sent):
            self.on_sent()

    def _is_sent(self, sent: "asyncio.Future[None]") -> bool:
        """Whether it was sent; otherwise, the connection is closed."""
        if sent.cancelled() or sent.exception() is not None:
            self.on_lost()
            return False
        return True

    def get_websocket_protocol(self) -> Optional[websocket.WebSocketProtocol]:
        """Return what reads the connection."""
        found = super().get_websocket_protocol()
        if found is not None:
            found.__class__ = _BoundedProtocol  # its constructor differs between tornado 5 and 6
        return found


def bind(host: str, port: int, what: str, name: str) -> List[socket.socket]:
    """Bind a TCP port (0: any free one) on IPv4, like everything else. Other programs cannot share the address.

    Raises `ServeError`. `what` is served; `name` is the beginning of the parameters NAME_host and NAME_port.
    """
    try:
        return netutil.bind_sockets(port, None if host == ANY_HOST else host, socket.AF_INET, BACKLOG)
    except OSError as error:
        raise ServeError(
            error.errno, f"cannot serve {what} on {host}:{port}: {_remedy(error, port, name)}") from error


def set_headers(handler: web.RequestHandler, headers: Dict[str, str]) -> None:
    """Set the headers of an answer."""
    for name, value in headers.items():
        handler.set_header(name, value)


@functools.lru_cache(FRAMES)
def frame(text: str, is_deflated: bool = False) -> bytes:
    """Return the WebSocket frame of a message (RFC 6455, 5.2). A server's frames are not masked.

    `is_deflated`: for readers with permessage-deflate (RFC 7692). Each message is compressed by itself, so that all of
    them share the frame.
    """
    data, first = text.encode(), _TEXT_AND_FINAL
    if is_deflated and len(data) > DEFLATED_BYTES:
        compressor = zlib.compressobj(1, zlib.DEFLATED, -zlib.MAX_WBITS)
        data = (compressor.compress(data) + compressor.flush(zlib.Z_SYNC_FLUSH))[:-4]
        first |= _DEFLATED
    if len(data) < 126:
        length = struct.pack("!B", len(data))
    elif len(data) < 1 << 16:
        length = struct.pack("!BH", 126, len(data))
    else:
        length = struct.pack("!BQ", 127, len(data))
    return bytes([first]) + length + data


def _remedy(error: OSError, port: int, name: str) -> str:
    if error.errno == errno.EADDRINUSE:
        return (f"another program uses the port: end it ('ss -tlpn sport = :{port}' shows it), or choose another "
                f"{name}_port")
    if error.errno == errno.EACCES:
        return f"not permitted: choose a {name}_port above 1023"
    if error.errno == errno.EADDRNOTAVAIL:
        return f"that is not an address of this machine: correct {name}_host"
    return os.strerror(error.errno or 0)
