#!/usr/bin/python3
"""Readers of the gateway's live data, in a process of their own: viewers.py PORT COUNT.

Prints "ready" when all have their snapshot. After each change it prints the monotonic times at which readers got it.
The readers do no more than find the messages in the stream: browsers run on other machines.
"""

import asyncio
import json
import sys
import time
from typing import List

HANDSHAKE = (
    b"GET /api/v1/events HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n\r\n"
)
PING, PONG = 9, b"\x8a\x80\0\0\0\0"
CHANGE = b'{"type":"change"'


class Reader(asyncio.Protocol):
    """One reader."""

    def __init__(self, readers: "Readers") -> None:
        self._readers = readers
        self._data = b""
        self._is_open = False

    def connection_made(self, transport: asyncio.Transport) -> None:
        """Open the WebSocket."""
        self._transport = transport
        transport.write(HANDSHAKE)

    def data_received(self, data: bytes) -> None:
        """Find the messages."""
        now = time.monotonic()
        self._data += data
        if not self._is_open:
            head, found, rest = self._data.partition(b"\r\n\r\n")
            if not found:
                return
            if b" 101 " not in head:
                raise SystemExit(f"viewers: {head.decode()}")
            self._is_open, self._data = True, rest
        while self._take(now):
            pass

    def _take(self, now: float) -> bool:
        if len(self._data) < 2:
            return False
        length, begin = self._data[1] & 127, 2
        if length > 125:
            begin = 4 if length == 126 else 10
            length = int.from_bytes(self._data[2:begin], "big")
        if len(self._data) < begin + length:
            return False
        if self._data[0] & 15 == PING:
            self._transport.write(PONG)
        elif self._data.startswith(CHANGE, begin):
            self._readers.changed(now)
        elif self._data.startswith(b'{"type":"snapshot"', begin):
            self._readers.opened()
        self._data = self._data[begin + length:]
        return True


class Readers:
    """All readers."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._open = 0
        self._times: List[float] = []

    def opened(self) -> None:
        """A reader has its snapshot."""
        self._open += 1
        if self._open == self._count:
            print("ready", flush=True)

    def changed(self, now: float) -> None:
        """A reader got a change."""
        self._times.append(now)
        if len(self._times) == self._count:
            print(json.dumps(self._times), flush=True)
            self._times = []


async def main(port: int, count: int) -> None:
    """Read until the gateway ends."""
    readers = Readers(count)
    loop = asyncio.get_running_loop()
    for _ in range(count):
        await loop.create_connection(lambda: Reader(readers), "127.0.0.1", port)
    await asyncio.Event().wait()


asyncio.run(main(int(sys.argv[1]), int(sys.argv[2])))
