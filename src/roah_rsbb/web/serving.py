"""A web server that bad clients cannot keep from serving others: few connections, short requests, clear errors.

The gateway and the tablet's page use it. `Guarded` is what every handler does first: it refuses requests for other
names, and too many of them. `EncryptedServer` takes connections with and without TLS at one port (docs/web.md,
"Encryption").
"""

import asyncio
import base64
import contextlib
import copy
import errno
import functools
import hashlib
import logging
import os
import re
import socket
import ssl
import struct
import zlib
from typing import Any, Callable, Dict, List, Optional, Tuple

from tornado import httpserver, httputil, iostream, netutil, web, websocket

from roah_rsbb.comm import sockets
from roah_rsbb.web.limits import STUCK_S, ConnectionPlaces, is_own_host

LOOPBACK = "127.0.0.1"
# How often it is tried to open a port.
RETRY_S = 3.0
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
# The system would otherwise hold megabytes for a reader that does not read.
SEND_BUFFER_BYTES = 64 * 1024
# The first byte of a connection with TLS: a handshake record.
_HANDSHAKE = b"\x16"

TOO_MANY_REQUESTS, _MISDIRECTED = 429, 421

_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Server": "roah_rsbb",
}
# Pages load and run nothing from other sites, have no scripts within the page but the one that is named, and no other
# site may show them in a frame. The WebSocket is named because older browsers do not count it as 'self'.
_POLICY = (
    "default-src 'none'; script-src {scripts}; style-src 'self'; img-src 'self'; font-src 'self'; manifest-src 'self'; "
    "connect-src 'self' ws://{host} wss://{host}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)

_log = logging.getLogger(__name__)


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
        return netutil.bind_sockets(port, None if host == sockets.ANY_HOST else host, socket.AF_INET, BACKLOG)
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


class Guarded(web.RequestHandler):
    """A handler that only answers requests for this computer, and not too many of them."""

    def initialize(self, server: Any) -> None:
        """`server`: that of the pages, which has its names, its limits and a clock."""
        self._server = server

    def prepare(self) -> None:
        """Refuse what no browser in the hall would ask."""
        if not self.is_allowed():
            raise web.HTTPError(TOO_MANY_REQUESTS, reason="Too Many Requests")
        if not is_own_host(self.request.host, self._server.names):
            raise web.HTTPError(_MISDIRECTED, reason="Misdirected Request")

    def is_allowed(self) -> bool:
        """Whether this is not one request too many."""
        return self._server.rates.allows(self._server.now(), self.request.remote_ip or "")

    def set_default_headers(self) -> None:
        set_headers(self, {**_HEADERS, "Content-Security-Policy": policy(self.request)})

    def write_error(self, status_code: int, **_kwargs: Any) -> None:
        """Answer with a line that names the remedy; never with what happened inside."""
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        if status_code == TOO_MANY_REQUESTS:
            self.set_header("Retry-After", "5")
        self.finish({
            _MISDIRECTED: "Open this page by the address of the box's computer, or add its name to web_names.\n",
            TOO_MANY_REQUESTS: "This address asks too often: try again in some seconds.\n",
            404: "There is no such page. The address / lists all pages.\n",
        }.get(status_code, f"{status_code} {self._reason}\n"))


class FileHandler(Guarded, web.StaticFileHandler):
    """The files of the pages."""

    def initialize(self, server: Any, path: str, default_filename: Optional[str] = None) -> None:
        Guarded.initialize(self, server)
        web.StaticFileHandler.initialize(self, path, default_filename)

    def set_extra_headers(self, path: str) -> None:
        self.set_header("Cache-Control", "no-cache")


def policy(request: httputil.HTTPServerRequest, script: str = "") -> str:
    """Return what the answer to a request may load and run. `script`: the text of one within the page."""
    checksum = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return _POLICY.format(scripts=f"'self' 'sha256-{checksum}'" if script else "'self'", host=_plain_host(request))


def _plain_host(request: httputil.HTTPServerRequest) -> str:
    """The host of a request for a header; anything but a host and a port is left out."""
    return request.host if re.fullmatch(r"[\w.:\[\]-]+", request.host, re.ASCII) else "invalid"


class EncryptedServer(BoundedServer):
    """A server that takes TLS. Connections without TLS are given to another server."""

    def initialize(self, *args: Any, context: ssl.SSLContext, plain: httpserver.HTTPServer, **options: Any) -> None:
        """`plain` serves connections without TLS; it must not listen itself."""
        super().initialize(*args, **options)
        self._context = context
        self._plain = plain
        self._silent: Dict[socket.socket, asyncio.TimerHandle] = {}  # connections that sent nothing yet
        self._silent_places: ConnectionPlaces[socket.socket] = ConnectionPlaces(self._drop)

    def stop(self) -> None:
        """Stop listening, and close the connections that sent nothing yet."""
        super().stop()
        for connection in list(self._silent):
            self._drop(connection)

    def _serve(self, connection: socket.socket, address: Any) -> None:
        """Wait for the first byte of a connection."""
        loop = asyncio.get_event_loop()
        self._silent[connection] = loop.call_later(IDLE_S, self._drop, connection)
        loop.add_reader(connection, self._on_first_byte, connection, address)
        self._silent_places.add(connection, address[0])

    def know(self, stream: Optional[iostream.IOStream], address: str) -> None:
        """As `BoundedServer.know`."""
        super().know(stream, address)
        self._silent_places.know(None, address)

    def _drop(self, connection: socket.socket) -> None:
        self._forget(connection)
        connection.close()

    def _forget(self, connection: socket.socket) -> None:
        self._silent.pop(connection).cancel()
        self._silent_places.remove(connection)
        asyncio.get_event_loop().remove_reader(connection)

    def _on_first_byte(self, connection: socket.socket, address: Any) -> None:
        try:
            first = connection.recv(1, socket.MSG_PEEK)
        except (BlockingIOError, InterruptedError):
            return
        except OSError:
            first = b""
        self._forget(connection)
        if not first:
            connection.close()
        elif first == _HANDSHAKE:
            with contextlib.suppress(OSError):  # it has gone
                secured = self._context.wrap_socket(connection, server_side=True, do_handshake_on_connect=False)
                self.handle_stream(iostream.SSLIOStream(secured), address)
        else:
            self._plain.handle_stream(iostream.IOStream(connection), address)


def retry_until_open(loop: asyncio.AbstractEventLoop, open_it: Callable[[], None], reported: str = "") -> None:
    """Call `open_it` until it raises no OSError. Each problem is logged once, with its remedy."""
    try:
        open_it()
    except OSError as error:
        if str(error) != reported:
            _log.error("%s. Retrying every %.0f s", error, RETRY_S)
        loop.call_later(RETRY_S, retry_until_open, loop, open_it, str(error))


def hosts_of(host: str, rsbb_host: str) -> List[str]:
    """Return the addresses at which a port of `host` is reached: that in the robots' network first."""
    if host != sockets.ANY_HOST:
        return [host]
    network = sockets.source_host(rsbb_host)
    return [network, LOOPBACK] if network not in (None, LOOPBACK) else [LOOPBACK]
