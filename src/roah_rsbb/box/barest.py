"""The barest core: it sends STOP to all robots in runs, and does nothing else.

A core that hangs or crashes soon after each start would be started without end, while its robots execute and no STOP
reaches them. After three of them, the next one does not read the journal, the configuration or anything else that may be
the reason. It has the open channels from the supervisor (`Signs.kept`), sends STOP, never PREPARE, until a person
starts the box again. With a standby, which takes over instead, there is none.
"""

import asyncio
import contextlib
import json
import logging
import time
from typing import Callable, List, NamedTuple

from roah_rsbb.comm.channels import MakePeer, PrivateChannel
from roah_rsbb.comm.ciphers import Key
from roah_rsbb.comm.peer import Peer
from roah_rsbb.comm.sender import StateSender
from roah_rsbb.model.messages import BoxMessage, RobotReport
from roah_rsbb.platform import new_loop
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.radio import wire_convert
from roah_rsbb.radio.radio import CoreRadio, Network
from roah_rsbb.radio.report_reader import ReportReader
from roah_rsbb.signs_of_life import Signs

# So many cores failed in succession: the next one is the barest.
AFTER_FAILURES = 3
# Before the port of a channel, in the names of what is kept.
PREFIX = "channel/"
# How often it sends what is due, and how often it says what it is.
LOOK_S, SAY_S = 0.05, 10.0
SAID = ("The box failed %d times in succession. It only sends STOP now, to %s, and refuses all else. Stop the "
        "robots by hand if they move, repair what the lines above say, end this program and start it again: the runs "
        "are in the journal")

_log = logging.getLogger(__name__)


class KeptChannel(NamedTuple):
    """A private channel, as the core before kept it."""

    port: int
    robot: str
    password: str
    host: str
    benchmark: str  # code


def keep_channels(signs: Signs, radio: CoreRadio) -> None:
    """Keep the channels that are open now for the next core. Call it once a second."""
    names = set()
    for port, channel in radio.open_channels().items():
        names.add(f"{PREFIX}{port}")
        signs.keep(f"{PREFIX}{port}", json.dumps(channel))
    for name in signs.keeps(PREFIX):
        if name not in names:
            signs.drop(name)


def kept_channels(signs: Signs) -> List[KeptChannel]:
    """The channels that the core before kept."""
    return [KeptChannel(int(name[len(PREFIX):]), *map(str, json.loads(value)))
            for name, value in signs.kept.items() if name.startswith(PREFIX)]


class _Stopping:
    """The channel of one robot, which is sent STOP."""

    def __init__(self, loop: asyncio.AbstractEventLoop, network: Network, kept: KeptChannel,
                 make_peer: MakePeer) -> None:
        self.robot, self._loop = kept.robot, loop
        self._channel = PrivateChannel(
            loop, network.rsbb_host, kept.port, Key(kept.password), self._heard, lambda text: None,
            cipher=network.cipher, bind_host=network.bind_host, broadcast=network.broadcast,
            max_datagram=network.max_datagram, read=ReportReader(time.monotonic), make_peer=make_peer)
        self._sender, self._stop = StateSender(), wire_convert.state_message(BoxMessage(kept.benchmark, BoxState.STOP))
        self.is_stopped = False
        self._channel.open()
        self._channel.remote = kept.host or None
        self._sender.changed(loop.time())
        self.look()

    def look(self) -> None:
        """Send what is due."""
        if self._sender.due(self._loop.time()):
            self._channel.send(self._stop)

    def _heard(self, message: object, address: object) -> None:
        """Acknowledge the robot's messages, or it repeats them. Nobody else knows its password."""
        if isinstance(message, RobotReport):
            self._channel.remote = address[0]  # type: ignore[index]
            self.is_stopped = message.state is RobotState.STOP
            wire_convert.acknowledge(self._stop, message.time)
            self._sender.reply(self._loop.time())
            self.look()


def serve(signs: Signs, network: Network, failures: int, is_ended: Callable[[], object],
          make_peer: MakePeer = Peer) -> None:
    """Send STOP until `is_ended`. `failures`: of cores in succession."""
    loop = new_loop()
    asyncio.set_event_loop(loop)
    robots: List[_Stopping] = []
    for kept in kept_channels(signs):
        try:
            robots.append(_Stopping(loop, network, kept, make_peer))
        except (OSError, ValueError, KeyError) as error:
            _log.critical("%s cannot be stopped (%s): stop it by hand", kept.robot, error)
    with contextlib.suppress(KeyboardInterrupt), contextlib.closing(loop):
        loop.run_until_complete(_work(signs, robots, failures, is_ended))


async def _work(signs: Signs, robots: List[_Stopping], failures: int, is_ended: Callable[[], object]) -> None:
    said_mono = float("-inf")
    while not is_ended():
        for robot in robots:
            robot.look()
        signs.send()
        if time.monotonic() >= said_mono + SAY_S:
            said_mono = time.monotonic()
            _log.critical(SAID, failures, ", ".join(
                f"{robot.robot} ({'stopped' if robot.is_stopped else 'does not say that it stopped'})"
                for robot in robots) or "nobody, because no run was connected")
        await asyncio.sleep(LOOK_S)
