"""Measures what one hostile sender costs others: floods on another run's private channel, silent TCP connections.

Run as a program, it is the sender: `hostile.py KIND RATE SECONDS PORT PASSWORD HOST`, with a kind of `FLOODS`. It
prints a line when the flood begins, and how much it has sent at the end.
"""

import contextlib
import os
import pathlib
import socket
import subprocess
import sys
import time
from typing import Iterator, List
from urllib.parse import urlparse

PERIOD_S = 0.002
ATTACKER = "127.0.9.9"
SILENT = 200
SETTLE_S = 1.0  # until the node has accepted the connections
STRINGS = 300
# Rate per second of each kind of flood.
FLOODS = {"garbage": 10000, "replays": 10000, "new strings": 500}
RECORDED = 100


@contextlib.contextmanager
def flood(kind: str, port: int, password: str, host: str, seconds: float) -> Iterator[None]:
    """Flood the private channel `port` of the robot at `host`."""
    arguments = map(str, (kind, FLOODS[kind], seconds, port, password, host))
    with subprocess.Popen([sys.executable, __file__, *arguments], stdout=subprocess.PIPE, text=True) as process:
        process.stdout.readline()
        yield
        if process.poll() is not None:
            print(f"bench: the flood of {kind} ended before the measurement", file=sys.stderr)
        process.terminate()


@contextlib.contextmanager
def silent_connections(*uris: str) -> Iterator[None]:
    """Open connections to these ports that send nothing."""
    with contextlib.ExitStack() as opened:
        for uri in uris:
            address = urlparse(uri)
            for _ in range(SILENT):
                opened.enter_context(socket.create_connection((address.hostname, address.port)))
        time.sleep(SETTLE_S)
        yield


def _datagrams(kind: str, count: int, password: str) -> List[bytes]:
    from roah_rsbb.comm import frame
    from roah_rsbb.comm.ciphers import Cipher, Key
    from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
    from roah_rsbb.protocol import RobotState

    if kind == "garbage":
        return [b"\2\2\0\0\0\0\0\x50" + os.urandom(80) for _ in range(1000)]
    key, now_ns = Key(password), time.time_ns()
    made = []
    for number in range(count):
        message = pb.RobotState(messages_saved=1, robot_state=int(RobotState.EXECUTING))
        message.time.sec, message.time.nsec = divmod(now_ns + 2_000_000 * number, 1_000_000_000)
        if kind == "new strings":
            message.notifications.extend(f"{number}.{i}" for i in range(STRINGS))
        made.append(frame.encode(message, Cipher.AES_128_CBC, key))
    return made


def main() -> None:
    """Run the program."""
    kind, rate, seconds, port, password, host = sys.argv[1:]
    rate, seconds, port = int(rate), float(seconds), int(port)
    stock = _datagrams(kind, RECORDED if kind == "replays" else int(rate * seconds), password)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as robot, \
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as attacker:
        robot.bind((host, 0))
        attacker.bind((ATTACKER, 0))
        if kind == "replays":
            for datagram in stock:
                robot.sendto(datagram, ("127.0.0.1", port))
                time.sleep(0.01)
        sender = robot if kind == "new strings" else attacker
        print("begun", flush=True)
        began, sent = time.monotonic(), 0
        while time.monotonic() - began < seconds:
            for number in range(sent, int((time.monotonic() - began) * rate)):
                with contextlib.suppress(OSError):
                    sender.sendto(stock[number % len(stock)], ("127.0.0.1", port))
                sent = number + 1
            time.sleep(PERIOD_S)
    print(f"sent {sent} in {seconds:g} s", flush=True)


if __name__ == "__main__":
    sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
    main()
