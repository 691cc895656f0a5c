"""Keeps a connection to the SmartIF controller, on asyncio: as long as it runs, whatever the controller does."""

import asyncio
import contextlib
import os
import socket
from typing import Callable, Optional

from roah_rsbb.devices.home import Home, is_ring
from roah_rsbb.devices.smartif import FROM_CONTROLLER, Busy, Decoder, Garbage, Message, Set, encode

RETRY_S = 0.2
CONNECT_S = 3.0
# A message is a few bytes: the rest of one that does not come so long does not come at all.
REST_S = 5.0
# A second client is told so at once: a connection that is left alone so long is ours.
SETTLE_S = 0.3
# A controller that is gone without a word is found out in about ten seconds.
KEEPALIVE = (("TCP_KEEPIDLE", 5), ("TCP_KEEPINTVL", 2), ("TCP_KEEPCNT", 3), ("TCP_USER_TIMEOUT", 10000))
# What a controller that stopped reading may leave unread, in bytes.
MAX_UNREAD = 65536


class SmartIfClient:
    """The connection of a `Home`. Callbacks come in the loop's thread.

    `on_ring()`: the bell was rung. `on_status(connected, text)`: when it changed, and why; text names the remedy.
    """

    def __init__(
        self, host: str, port: int, home: Home, on_ring: Callable[[], None], on_status: Callable[[bool, str], None],
    ) -> None:
        self._host, self._port = host, port
        self._where = f"the SmartIF controller at {host}:{port}"
        self._home = home
        self._on_ring = on_ring
        self._on_status = on_status
        self._told = (False, "")
        self._writer: Optional[asyncio.StreamWriter] = None

    @property
    def connected(self) -> bool:
        """Whether the controller is reached."""
        return self._told[0]

    def send(self, message: Set) -> None:
        """Tell the controller; without a connection nothing is lost, because all is told at the next one."""
        writer = self._writer
        if writer is None or writer.is_closing():
            return
        writer.write(encode(message))
        if writer.transport.get_write_buffer_size() > MAX_UNREAD:
            writer.transport.abort()

    async def run(self) -> None:
        """Run until cancelled."""
        while True:
            self._tell(False, await self._session())
            await asyncio.sleep(RETRY_S)

    async def _session(self) -> str:
        """One connection, from its beginning to its end; returns why it ended."""
        try:
            reader, writer = await asyncio.wait_for(asyncio.open_connection(self._host, self._port), CONNECT_S)
        except asyncio.TimeoutError:
            return f"{self._where} does not answer: is it on, and is smartif_host right?"
        except OSError as error:
            return f"{self._where} cannot be reached ({_reason(error)}): is it on, and is smartif_host right?"
        settled = asyncio.get_event_loop().call_later(SETTLE_S, self._tell, True, f"connected to {self._where}")
        try:
            _watch_over(writer)
            self._writer = writer
            for message in self._home.all():
                self.send(message)
            return await self._read(reader)
        except Garbage as error:
            return f"{self._where} does not speak SmartIF ({error}): is smartif_port right?"
        except OSError as error:
            return f"the connection to {self._where} broke ({_reason(error)})"
        finally:
            settled.cancel()
            self._writer = None
            writer.transport.abort()

    async def _read(self, reader: asyncio.StreamReader) -> str:
        decoder = Decoder(FROM_CONTROLLER)
        while True:
            limit = REST_S if decoder.pending else None
            try:
                data = await asyncio.wait_for(reader.read(4096), limit)
            except asyncio.TimeoutError as error:
                if getattr(error, "errno", None):
                    raise  # from Python 3.11 on, what the connection's own supervision found is one, too
                return f"{self._where} sent only half of a message"
            if not data:
                return f"{self._where} closed the connection"
            messages = decoder.feed(data)
            while messages:
                for message in messages:
                    if isinstance(message, Busy):
                        return f"{self._where} serves another client, at {message.address}: end that one"
                    self._take(message)
                messages = decoder.feed(b"")

    def _take(self, message: Message) -> None:
        self._tell(True, f"connected to {self._where}")
        if is_ring(message):
            self._on_ring()

    def _tell(self, connected: bool, text: str) -> None:
        if (connected, text) != self._told:
            self._told = (connected, text)
            self._on_status(connected, text)


def _watch_over(writer: asyncio.StreamWriter) -> None:
    connection = writer.get_extra_info("socket")
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in KEEPALIVE:
        with contextlib.suppress(OSError, AttributeError):  # not every system has all of them
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)


def _reason(error: OSError) -> str:
    return os.strerror(error.errno) if error.errno else str(error)
