"""A web server that takes TLS and recognises connections without it (docs/web.md, "Encryption")."""

import asyncio
import contextlib
import socket
import ssl
from typing import Any, Dict, Optional

from tornado import httpserver, iostream

from roah_rsbb.web.limits import ConnectionPlaces
from roah_rsbb.web.serving import IDLE_S, BoundedServer

# The first byte of a connection with TLS: a handshake record.
_HANDSHAKE = b"\x16"


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
