#!/usr/bin/python3
"""Readers of the gateway's live data, in a process of their own: viewers.py PORT COUNT [COOKIE]. With the cookie of a
paired device they are phones.

Prints "ready" when all have their snapshot. After each change it prints the monotonic times at which readers got it,
and when it is terminated the bytes a second to each since then.
Real readers are browsers on other computers, so these take as little of this computer as possible: they do not read
the messages, and they have the lowest priority. The kernel notes when the data arrived, so that this changes no time.
"""

import json
import os
import select
import signal
import socket
import struct
import sys
import time
from typing import Dict, List

HANDSHAKE = (
    b"GET /api/v1/%s HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\nOrigin: http://127.0.0.1\r\n"
    b"Cookie: %s\r\n\r\n"
)
PING, PONG = b"\x89\0", b"\x8a\x80\0\0\0\0"
SNAPSHOT, CHANGE = b'{"type":"snapshot"', b'{"type":"change"'
CHUNK = 1 << 18
SO_TIMESTAMPNS = 35  # of Linux; Python has no name for it
_TIME = struct.Struct("@qq")


class Readers:
    """All readers."""

    def __init__(self, port: int, count: int, cookie: str) -> None:
        self._events = select.epoll()
        self._readers: Dict[int, socket.socket] = {}
        for _ in range(count):
            reader = socket.create_connection(("127.0.0.1", port))
            reader.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
            reader.sendall(HANDSHAKE % (b"device" if cookie else b"events", cookie.encode()))
            self._readers[reader.fileno()] = reader
            self._events.register(reader, select.EPOLLIN)
        self._open = self._bytes = 0
        self._began = 0.0
        self._times: List[float] = []

    def read(self) -> None:
        """Read until the gateway ends."""
        while True:
            for number, _ in self._events.poll():
                reader = self._readers[number]
                data, notes, _, _ = reader.recvmsg(CHUNK, socket.CMSG_SPACE(_TIME.size))
                if not data:
                    raise SystemExit("viewers: the gateway closed a connection")
                self._bytes += len(data)
                self._take(reader, data, notes)

    def _take(self, reader: socket.socket, data: bytes, notes: list) -> None:
        # On this computer's loopback, the beginning of a message comes in one piece.
        if data.startswith(PING):
            reader.sendall(PONG)
        if SNAPSHOT in data:
            self._open += 1
            if self._open == len(self._readers):
                self._began, self._bytes = time.monotonic(), 0
                print("ready", flush=True)
        if CHANGE in data:
            self._times.append(_monotonic_of(notes))
            if len(self._times) == len(self._readers):
                print(json.dumps(self._times), flush=True)
                self._times = []

    def end(self, *_signal: object) -> None:
        """End the process."""
        print(self._bytes / (time.monotonic() - self._began) / len(self._readers), flush=True)
        raise SystemExit


def _monotonic_of(notes: list) -> float:
    """When the kernel got the data, as time.monotonic()."""
    ((_, _, stamp),) = notes
    seconds, nanoseconds = _TIME.unpack(stamp)
    return seconds + nanoseconds / 1e9 - (time.time() - time.monotonic())


if __name__ == "__main__":
    os.nice(19)
    readers = Readers(int(sys.argv[1]), int(sys.argv[2]), *sys.argv[3:])
    signal.signal(signal.SIGTERM, readers.end)
    readers.read()
