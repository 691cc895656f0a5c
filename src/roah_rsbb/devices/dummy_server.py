"""A simulated SmartIF controller (asyncio). It accepts one client and rejects a second one."""

import asyncio
from typing import Callable, Optional

from roah_rsbb.devices.smartif import RING, TO_CONTROLLER, Busy, Garbage, Set, SmartIfDecoder, device_of, encode


class DummyServer:
    """Reports received messages by `report(text)`. `open` raises OSError."""

    def __init__(self, host: str, port: int, report: Callable[[str], None]) -> None:
        """`port` 0: any free port; after `open`, the attribute `port` has its number."""
        self.host, self.port = host, port
        self._report = report
        self._server: Optional[asyncio.AbstractServer] = None
        self._client: Optional[asyncio.StreamWriter] = None

    async def open(self) -> None:
        """Start listening."""
        self._server = await asyncio.start_server(self._serve, self.host, self.port)
        self.port = self._server.sockets[0].getsockname()[1]

    def close(self) -> None:
        """Stop listening, and disconnect the client."""
        if self._server is not None:
            self._server.close()
        if self._client is not None:
            self._client.transport.abort()

    def ring(self) -> bool:
        """Ring the bell; returns False if no client is connected."""
        if self._client is None:
            self._report("the bell rings, but no client is connected")
            return False
        self._report("the bell rings")
        self._client.write(encode(RING))
        return True

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        address = _address(writer)
        if self._client is not None:
            self._report(f"{address} is rejected: {_address(self._client)} is connected")
            writer.write(encode(Busy(_address(self._client))))
            writer.close()
            return
        self._client = writer
        self._report(f"{address} is connected")
        try:
            why = await self._receive(reader)
        except Garbage as error:
            why = f"it does not use the SmartIF protocol: {error}"
        except OSError as error:
            why = f"the connection broke: {error}"
        finally:
            self._client = None
            writer.close()
        self._report(f"{address} is disconnected ({why})")

    async def _receive(self, reader: asyncio.StreamReader) -> str:
        decoder = SmartIfDecoder(TO_CONTROLLER)
        while True:
            data = await reader.read(4096)
            if not data:
                return "it closed the connection"
            messages = decoder.feed(data)
            while messages:
                for message in messages:
                    self._report(_text(message))
                messages = decoder.feed(b"")


def _text(message: Set) -> str:
    known = device_of(message)
    if known is None:
        return f"unknown device or value: id {message.device_id!r}, value {message.value}"
    return f"{known[0]} is set to {known[1]}"


def _address(writer: asyncio.StreamWriter) -> str:
    host, port = writer.get_extra_info("peername")[:2]
    return f"{host}:{port}"
