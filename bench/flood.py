#!/usr/bin/python3
"""A flood, in a process of its own: `flood.py datagrams HOST PORT…`, `flood.py calls HOST PORT ZONE…`,
`flood.py connections HOST PORT…`, or on the channel of a run `flood.py copies|strings HOST PORT PASSWORD ROBOT`. It
prints a line when it has begun, and its rate (1/s) when it is terminated.

The senders of real floods are other computers, so it has the lowest priority.
"""

import contextlib
import errno
import io
import itertools
import os
import selectors
import signal
import socket
import struct
import sys
import time
from typing import Callable, Dict, List, Tuple

ATTACKER = "127.0.9.9"
# Per second.
DATAGRAMS = 50_000
CONNECTIONS = 290
# On the channel of a run: copies of the robot's datagrams, and datagrams of the robot with many new strings each.
ON_CHANNEL = {"copies": 10_000, "strings": 500}
COPIED, STRINGS = 100, 300
# Open at the same time, each with a call that waits for its answer.
CALLS = 1000
# Connections that a flood keeps open.
KEPT = 5000
PERIOD_S = 0.002
_LENGTH = struct.Struct("<I")


class _Ended(Exception):
    """The flood is terminated."""


def _paced(rate: float, send: Callable[[int], None]) -> float:
    """Call `send` with rising numbers, at this rate (1/s), until the process is terminated; returns the real rate."""
    began, sent = time.monotonic(), 0
    try:
        while True:
            due = int((time.monotonic() - began) * rate)
            # After a pause of the process it continues at its rate.
            for number in range(sent, min(due, sent + int(rate * 10 * PERIOD_S) + 1)):
                send(number)
                sent = number + 1
            if due - sent > rate:
                began, sent = time.monotonic(), 0
            time.sleep(PERIOD_S)
    except _Ended:
        return sent / max(1e-9, time.monotonic() - began)


def _datagrams(host: str, ports: List[int]) -> float:
    """Garbage and beacons of robots without a team, to each port in turn."""
    from roah_rsbb.comm import frame
    from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

    stock = [b"\2\2\0\0\0\0\0\x50" + os.urandom(80) for _ in range(1000)]
    for number in range(1000):
        beacon = pb.RobotBeacon(team_name=f"Nobody{number}", robot_name="robot")
        beacon.time.sec, beacon.time.nsec = divmod(time.time_ns(), 1_000_000_000)
        stock.insert(2 * number, frame.encode(beacon))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as attacker:
        attacker.bind((ATTACKER, 0))

        def send(number: int) -> None:
            with contextlib.suppress(OSError):
                attacker.sendto(stock[number % len(stock)], (host, ports[number % len(ports)]))

        send(0)
        print("begun", flush=True)
        return _paced(DATAGRAMS, send)


def _on_channel(kind: str, host: str, port: int, password: str, robot: str) -> float:
    from roah_rsbb.comm import frame
    from roah_rsbb.comm.ciphers import Cipher, Key
    from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
    from roah_rsbb.protocol import RobotState

    key, began_ns = Key(password), time.time_ns()

    def made(number: int, strings: int) -> bytes:
        message = pb.RobotState(messages_saved=1, robot_state=int(RobotState.EXECUTING))
        message.time.sec, message.time.nsec = divmod(began_ns + 2_000_000 * number, 1_000_000_000)
        message.notifications.extend(f"{number}.{i}" for i in range(strings))
        return frame.encode(message, Cipher.AES_128_CBC, key)

    stock = [made(number, 0) for number in range(COPIED)]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as own, \
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as attacker:
        own.bind((robot, 0))
        attacker.bind((ATTACKER, 0))

        def send(number: int) -> None:
            with contextlib.suppress(OSError):
                if kind == "strings":
                    own.sendto(made(number, STRINGS), (host, port))
                else:
                    attacker.sendto(stock[number % COPIED], (host, port))

        for datagram in stock:
            own.sendto(datagram, (host, port))
            time.sleep(0.01)
        print("begun", flush=True)
        return _paced(ON_CHANNEL[kind], send)


class _Calls:
    """Calls of /core/set_score by many connections. Each answer is followed by the next call."""

    def __init__(self, address: Tuple[str, int], zones: List[str]) -> None:
        from rosgraph.network import encode_ros_handshake_header

        from roah_rsbb.msg import Score
        from roah_rsbb.srv import ZoneScore, ZoneScoreRequest

        self._address = address
        self._handshake = encode_ros_handshake_header({
            "callerid": "/roah_rsbb_bench_flood", "service": "/core/set_score", "md5sum": ZoneScore._md5sum,
            "type": ZoneScore._type})
        self._bodies = []
        for zone, value in itertools.product(zones, (1, 2)):
            buff = io.BytesIO()
            ZoneScoreRequest(zone, Score("Penalized Behaviors", "Stops working", value)).serialize(buff)
            self._bodies.append(_LENGTH.pack(len(buff.getvalue())) + buff.getvalue())
        self._selector = selectors.DefaultSelector()
        self.answered = self.refused = 0

    def run(self) -> None:
        for _ in range(CALLS):
            self._begin()
        print("begun", flush=True)
        while True:
            for key, _ in self._selector.select():
                self._continue(key.fileobj, key.data)

    def _begin(self) -> None:
        connection = socket.create_connection(self._address)
        connection.sendall(self._handshake)
        self._selector.register(connection, selectors.EVENT_READ, {"asked": False, "data": b""})

    def _continue(self, connection: socket.socket, state: Dict[str, object]) -> None:
        try:
            data = connection.recv(65536)
        except OSError:
            data = b""
        state["data"] += data
        if data and not state["asked"]:
            if len(state["data"]) >= 4 and len(state["data"]) >= 4 + _LENGTH.unpack(state["data"][:4])[0]:
                state["asked"] = True
                connection.sendall(self._bodies[self.answered % len(self._bodies)])
        elif not data or state["asked"]:
            self.answered += 1 if data[:1] == b"\1" else 0
            if data[:1] != b"\1":
                self.refused += 1
            self._selector.unregister(connection)
            connection.close()
            self._begin()


def _connections(host: str, ports: List[int]) -> float:
    """Connections of one address to each port in turn. Most say nothing; the others send half a request."""
    opened: List[socket.socket] = []

    def send(number: int) -> None:
        if len(opened) >= KEPT:
            opened.pop(0).close()
        connection = socket.socket()
        connection.setblocking(False)
        try:
            connection.bind((ATTACKER, 0))
            if connection.connect_ex((host, ports[number % len(ports)])) not in (0, errno.EINPROGRESS):
                raise OSError
            if number % 4 == 0:
                connection.send(b"GET / HTTP/1.1\r\n")
            opened.append(connection)
        except OSError:
            connection.close()

    send(0)
    print("begun", flush=True)
    return _paced(CONNECTIONS, send)


def main() -> None:
    """Run the program."""
    os.setpriority(os.PRIO_PROCESS, 0, 19)

    def end(*_signal: object) -> None:
        raise _Ended

    signal.signal(signal.SIGTERM, end)
    kind, *arguments = sys.argv[1:]
    if kind == "datagrams":
        rate = _datagrams(arguments[0], [int(port) for port in arguments[1:]])
    elif kind == "connections":
        rate = _connections(arguments[0], [int(port) for port in arguments[1:]])
    elif kind in ON_CHANNEL:
        rate = _on_channel(kind, arguments[0], int(arguments[1]), *arguments[2:])
    else:
        calls, began = _Calls((arguments[0], int(arguments[1])), arguments[2:]), time.monotonic()
        try:
            calls.run()
        except _Ended:
            rate = calls.answered / (time.monotonic() - began)
            if calls.refused:
                print(f"bench: {calls.refused} calls of the flood were refused", file=sys.stderr)
    print(rate, flush=True)


if __name__ == "__main__":
    main()
