"""Keeps a connection to the SmartIF controller, and reconnects after any failure (asyncio)."""

import asyncio
import contextlib
import os
import socket
from typing import Callable, Optional

from roah_rsbb.devices.home import Home, is_ring
from roah_rsbb.devices.smartif import FROM_CONTROLLER, Busy, Garbage, Message, Set, SmartIfDecoder, encode

RETRY_S = 0.2
# A controller that is started at the same time, such as the dummy, may not be there yet: this is no fault.
STARTS_S = 3.0
CONNECT_S = 3.0
# Time limit for the rest of a message, which has only a few bytes.
REST_S = 5.0
# The controller rejects a second client immediately: after this time the connection counts as accepted.
SETTLE_S = 0.3
# Detect a silent loss of the controller in about ten seconds.
KEEPALIVE = (("TCP_KEEPIDLE", 5), ("TCP_KEEPINTVL", 2), ("TCP_KEEPCNT", 3), ("TCP_USER_TIMEOUT", 10000))
# Largest amount of unread data (bytes), in case the controller stops reading.
MAX_UNREAD = 65536


class SmartIfClient:
    """The connection of a `Home`. Callbacks are called in the loop's thread.

    `on_ring()`: the bell rang. `on_status(connected, text)`: the status changed; the text says why, with the remedy.
    """

    def __init__(
        self, host: str, port: int, home: Home, on_ring: Callable[[], None], on_status: Callable[[bool, str], None],
    ) -> None:
        self._host, self._port = host, port
        self._where = f"the SmartIF controller at {host}:{port}"
        self._home = home
        self._on_ring = on_ring
        self._on_status = on_status
        self._status = (False, "")
        self._has_met = False  # the controller was reached
        self._writer: Optional[asyncio.StreamWriter] = None

    @property
    def connected(self) -> bool:
        """Whether the controller is connected."""
        return self._status[0]

    def send(self, message: Set) -> None:
        """Send a message. Without a connection, nothing is lost: a new connection begins with all values."""
        writer = self._writer
        if writer is None or writer.is_closing():
            return
        writer.write(encode(message))
        if writer.transport.get_write_buffer_size() > MAX_UNREAD:
            writer.transport.abort()

    async def run(self) -> None:
        """Run until cancelled."""
        loop = asyncio.get_event_loop()
        reported_from = loop.time() + STARTS_S
        while True:
            why = await self._session()
            if self._has_met or loop.time() >= reported_from:
                self._report(False, why)
            await asyncio.sleep(RETRY_S)

    async def _session(self) -> str:
        """Run one connection; returns why it ended."""
        try:
            reader, writer = await asyncio.wait_for(asyncio.open_connection(self._host, self._port), CONNECT_S)
        except asyncio.TimeoutError:
            return f"{self._where} does not answer: check that it is on, and check smartif_host"
        except OSError as error:
            return f"{self._where} cannot be reached ({_reason(error)}): check that it is on, and check smartif_host"
        settled = asyncio.get_event_loop().call_later(SETTLE_S, self._report, True, f"connected to {self._where}")
        try:
            self._has_met = True
            _enable_keepalive(writer)
            self._writer = writer
            for message in self._home.all():
                self.send(message)
            return await self._read(reader)
        except Garbage as error:
            return f"{self._where} does not use the SmartIF protocol ({error}): check smartif_port"
        except OSError as error:
            return f"the connection to {self._where} broke ({_reason(error)})"
        finally:
            settled.cancel()
            self._writer = None
            writer.transport.abort()

    async def _read(self, reader: asyncio.StreamReader) -> str:
        decoder = SmartIfDecoder(FROM_CONTROLLER)
        while True:
            limit = REST_S if decoder.pending else None
            try:
                data = await asyncio.wait_for(reader.read(4096), limit)
            except asyncio.TimeoutError as error:
                if getattr(error, "errno", None):
                    raise  # since Python 3.11, a failed keepalive is a TimeoutError, too
                return f"{self._where} sent an incomplete message"
            if not data:
                return f"{self._where} closed the connection"
            messages = decoder.feed(data)
            while messages:
                for message in messages:
                    if isinstance(message, Busy):
                        return f"{self._where} is connected to another client at {message.address}: end that client"
                    self._take(message)
                messages = decoder.feed(b"")

    def _take(self, message: Message) -> None:
        self._report(True, f"connected to {self._where}")
        if is_ring(message):
            self._on_ring()

    def _report(self, connected: bool, text: str) -> None:
        if (connected, text) != self._status:
            self._status = (connected, text)
            self._on_status(connected, text)


def _enable_keepalive(writer: asyncio.StreamWriter) -> None:
    connection = writer.get_extra_info("socket")
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in KEEPALIVE:
        with contextlib.suppress(OSError, AttributeError):  # some systems lack some of them
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)


def _reason(error: OSError) -> str:
    return os.strerror(error.errno) if error.errno else str(error)
