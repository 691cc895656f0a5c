"""The barest core: it sends STOP to all robots in runs, and refuses all else.

The supervisor starts it after cores that failed in succession: one that is started again and again would leave the
robots executing, and no STOP would reach them. It reads neither journal nor configuration nor parameters, which may be
the reason, but has the open channels from the memory of the supervisor (`signs_of_life.py`). It ends when a person ends
the box. Where there is a standby, it is never started: that one takes over.
"""

import asyncio
import contextlib
import json
import logging
import os
import threading
from functools import partial
from typing import List, Mapping

from roah_rsbb.client.places import OnlyStops, read_place, write_place
from roah_rsbb.comm.channels import MakePeer, Network, PrivateChannel
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.comm.peer import Peer
from roah_rsbb.comm.sender import StateSender
from roah_rsbb.comm.sockets import ANY_HOST, OpenError
from roah_rsbb.ground import linux
from roah_rsbb.ground.signs_of_life import CHANNEL, DOORS, WEB_PORT, Lifeline
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState

LOOK_S = 0.05
# Between two lines on the terminal.
SAY_S = 10.0
# For people, everywhere.
WHY = ("the box failed several times in succession, or its disk hangs. It only sends STOP now, to all robots in runs, "
       "and refuses all else. Stop a robot by hand if it moves. Repair what the box's terminal says, end the box "
       "there, and start it again: the runs are in its journal")
NOT_HEARD = "not heard, because the box that was killed still has its port: see whether it stopped"

_log = logging.getLogger(__name__)


class StoppedRobot:
    """The channel of one robot, which is sent STOP. Raises `ValueError`, `TypeError` or OSError."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, port: str, kept: str, make_peer: MakePeer = Peer, is_deaf: bool = False,
    ) -> None:
        """`port` and `kept`: see `ChannelNotes`. `is_deaf`: another process has the port, and gets what the robot
        says."""
        name, password, host, benchmark, rsbb_host, bind_host, cipher, *options = json.loads(kept)
        network = Network(rsbb_host, 0, bind_host, Cipher(cipher), *options)
        self.name, self.is_stopped, self._is_deaf = name, False, is_deaf
        self._loop, self._sender = loop, StateSender()
        self._stop = pb.BenchmarkState(benchmark_type=benchmark, benchmark_state=int(BoxState.STOP))
        self._stop.acknowledgement.sec = self._stop.acknowledgement.nsec = 0
        self._channel = PrivateChannel(
            loop, network, int(port), Key(password), self._hear, lambda text: None,
            make_peer=partial(make_peer, deaf=True) if is_deaf else make_peer)
        self._channel.remote = host or None
        self._channel.open()
        self._sender.changed(loop.time())

    def __str__(self) -> str:
        said = "stopped" if self.is_stopped else "does not say that it stopped"
        return f"{self.name} ({NOT_HEARD if self._is_deaf else said})"

    def look(self) -> None:
        """Send what is due."""
        if self._sender.due(self._loop.time()):
            self._channel.send(self._stop)

    def close(self) -> None:
        """Send no more."""
        self._channel.close()

    def _hear(self, message: object, address: "tuple[str, int]") -> None:
        """Acknowledge what the robot says, or it repeats that."""
        if not isinstance(message, pb.RobotState):
            return
        self._channel.remote = self._channel.remote or address[0]  # a recorded datagram must not divert STOP
        if self._channel.remote == address[0]:
            self.is_stopped = message.robot_state == RobotState.STOP
            self._stop.acknowledgement.CopyFrom(message.time)
            self._sender.reply(self._loop.time())
            self.look()


def open_robots(loop: asyncio.AbstractEventLoop, kept: Mapping[str, str],
                make_peer: MakePeer = Peer) -> List[StoppedRobot]:
    """Begin to stop the robots of all channels that the core before kept."""
    robots = []
    for name in kept:
        if name.startswith(CHANNEL):
            try:
                robots.append(_opened(loop, name[len(CHANNEL):], kept[name], make_peer))
            except Exception as error:  # whatever is wrong with one, the others get STOP
                _log.critical("The robot on port %s cannot be stopped: %s. Stop it by hand", name[len(CHANNEL):], error)
    return robots


def _opened(loop: asyncio.AbstractEventLoop, port: str, kept: str, make_peer: MakePeer) -> StoppedRobot:
    try:
        return StoppedRobot(loop, port, kept, make_peer)
    except OpenError:  # a box that cannot end still has the port; a robot takes STOP from any port
        return StoppedRobot(loop, port, kept, make_peer, is_deaf=True)


async def work(lifeline: Lifeline, robots: List[StoppedRobot]) -> None:
    """Send STOP without end."""
    loop = asyncio.get_event_loop()
    say_mono = float("-inf")
    while True:
        for robot in robots:
            robot.look()
        lifeline.send()
        if loop.time() >= say_mono + SAY_S:
            say_mono = loop.time()
            _log.critical("This box only sends STOP: %s. Robots: %s", WHY,
                          ", ".join(map(str, robots)) or "none, because no run was connected")
        await asyncio.sleep(LOOK_S)


def _warn_clients(paths: List[str]) -> None:
    """Say where clients look for the door why there is none. In a thread: the disk may be the reason."""
    for path in paths:
        with contextlib.suppress(OSError):
            write_place(path, "", "", WHY)


def _forget_clients(paths: List[str]) -> None:
    for path in paths:
        try:
            read_place(path)
        except OnlyStops:
            with contextlib.suppress(OSError):
                os.unlink(path)
        except Exception:  # another box has written it
            continue


async def _answer_browser(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    content = f"This box only sends STOP: {WHY}.\n".encode()
    with contextlib.suppress(OSError, asyncio.LimitOverrunError, asyncio.IncompleteReadError):
        await asyncio.wait_for(reader.readuntil(b"\r\n\r\n"), SAY_S)
        writer.write(b"HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain; charset=utf-8\r\n"
                     b"Connection: close\r\nContent-Length: %d\r\n\r\n%s" % (len(content), content))
        await writer.drain()
    writer.close()


def main(_arguments: object = None) -> None:
    """Run the program, which the supervisor starts."""
    logging.basicConfig(format="%(asctime)s %(levelname)s %(message)s", datefmt="%H:%M:%S %Z")
    logging.raiseExceptions = False
    linux.ignore_stops()
    linux.end_with_parent()  # the program that follows it may start a full core
    loop, lifeline = asyncio.new_event_loop(), Lifeline()
    asyncio.set_event_loop(loop)
    robots = open_robots(loop, lifeline.kept)
    doors: List[str] = json.loads(lifeline.kept.get(DOORS, "[]"))
    warning = threading.Thread(target=_warn_clients, args=(doors,), daemon=True)
    warning.start()
    working = loop.create_task(work(lifeline, robots))
    linux.on_end(loop, working.cancel)
    with contextlib.suppress(asyncio.CancelledError):
        with contextlib.suppress(OSError, ValueError, KeyError):
            loop.run_until_complete(asyncio.start_server(
                _answer_browser, ANY_HOST, int(lifeline.kept[WEB_PORT])))
        loop.run_until_complete(working)
    if not warning.is_alive():
        _forget_clients(doors)
    lifeline.end()
