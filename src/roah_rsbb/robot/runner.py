"""A `Session` with real sockets and clocks: carries out effects that need them, and passes all effects on.

`client.RobotClient` and the ROS node use it. Call all methods in the thread of the asyncio loop.
"""

import asyncio
import logging
import os
import time
from typing import Any, Callable, Optional

from roah_rsbb.comm.channels import MakePeer, Network, PrivateChannel, PublicChannel, Seen
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.comm.sockets import ANY_HOST
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.session import Address, Session

_log = logging.getLogger(__name__)

# Size of a filter that remembers what a box sends in many hours.
SEEN_BITS = 2**22


def always() -> bool:
    """Lose no datagram."""
    return True


class SessionRunner:
    """The robot's session with its public channel and, during a run, its private one."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        team: str,
        password: str,
        on_effect: Callable[[fx.Effect], None],
        on_complaint: Callable[[str], None],
        robot: str = "Robot",
        rsbb_host: str = "10.255.255.255",
        rsbb_port: int = 6666,
        bind_host: str = ANY_HOST,
        cipher: Cipher = Cipher.AES_128_CBC,
        clock: Callable[[], float] = time.time,
        passes: Callable[[], bool] = always,
        make_peer: Optional[MakePeer] = None,
        random_bytes: Callable[[int], bytes] = os.urandom,
    ) -> None:
        """Raises ValueError for an empty name or password, and for `Cipher.NONE`. Opens nothing yet.

        `on_effect` is called with every effect after it was carried out, `on_complaint` with a text about the network
        or an invalid datagram. `clock` returns the robot's time in seconds since 1970. `passes` is called for each
        datagram that is sent or received; False drops it, to simulate a bad network. `make_peer` replaces `Peer`, for
        another network. `random_bytes`: see `Key`.
        """
        if cipher is Cipher.NONE:
            raise ValueError("a private channel must be encrypted: choose another cipher than none")
        self.session = Session(team, robot, loop.time())
        self._loop = loop
        self._on_effect = on_effect
        self._on_complaint = on_complaint
        self._clock = clock
        self._passes = passes
        self._key = Key(password, random_bytes)
        self._make_peer = make_peer
        self._network = Network(rsbb_host, rsbb_port, bind_host, cipher)
        self._public = PublicChannel(loop, self._network, self._public_message, on_complaint, make_peer=make_peer)
        self._private: Optional[PrivateChannel] = None
        self._seen = Seen(SEEN_BITS)
        self._bad_datagrams = 0  # of the box on the private channel
        self._timer: Optional[asyncio.TimerHandle] = None
        self._woken = False

    def open(self) -> None:
        """Start. Raises OSError whose text names the remedy."""
        self._public.open()
        self._poll()

    def close(self) -> None:
        """Stop without informing the box; has no effect if closed."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        self._close_private()
        self._public.close()

    def wake(self) -> None:
        """Carry out effects soon. Call this after each use of the session's methods.

        The effects follow when the caller has returned to the loop. So simultaneous requests are sent together, and a
        handler of effects may make further requests.
        """
        if not self._woken:
            self._woken = True
            self._loop.call_soon(self._poll)

    def _poll(self) -> None:
        self._woken = False
        if not self._public.is_open:
            return
        for effect in self.session.poll(self._loop.time(), self._clock()):
            self._do(effect)
            try:
                self._on_effect(effect)
            except Exception:
                # An error there must not stop the session: the next effect may be a stop.
                _log.exception("a handler of the robot's effects failed")
        if self._timer is not None:
            self._timer.cancel()
        self._timer = self._loop.call_at(self.session.deadline(), self._poll)

    def _do(self, effect: fx.Effect) -> None:
        if isinstance(effect, fx.SendState):
            if self._private is not None and self._passes():
                self._private.send(effect.message)
        elif isinstance(effect, fx.SendBeacon):
            if self._passes():
                self._public.send(effect.message)
        elif isinstance(effect, fx.OpenChannel):
            self._open_private(effect)
        elif isinstance(effect, fx.CloseChannel):
            self._close_private()

    def _open_private(self, where: fx.OpenChannel) -> None:
        self._close_private()
        channel = PrivateChannel(
            self._loop, self._network, where.port, self._key, self._private_message, self._private_complaint,
            seen=self._seen, make_peer=self._make_peer,
        )
        channel.remote = where.host
        try:
            channel.open()
        except OSError as error:
            self.session.channel_failed(f"the box gave this robot a port that it cannot use: {error}")
            self.wake()
            return
        self._private = channel
        self._bad_datagrams = 0

    def _close_private(self) -> None:
        if self._private is not None:
            self._private.close()
            self._private = None

    def _public_message(self, message: Any, sender: Address) -> None:
        if self._passes():
            self.session.public_message(self._loop.time(), message, sender)
            self._poll()

    def _private_message(self, message: Any, sender: Address) -> None:
        if self._passes():
            if self._private is not None and self.session.link is not None and sender[0] == self.session.link.host:
                self._private.remember()
            self.session.private_message(self._loop.time(), message, sender)
            self._poll()

    def _private_complaint(self, text: str) -> None:
        """A summary of invalid datagrams, or a failure to send; the counts distinguish them."""
        self._on_complaint(text)
        link = self.session.link
        if self._private is None or link is None:
            return
        totals = self._private.complaints.totals()
        bad_datagrams = sum(count for (host, _), count in totals.items() if host == link.host)
        if bad_datagrams > self._bad_datagrams:
            self._bad_datagrams = bad_datagrams
            self.session.private_undecodable(self._loop.time(), link.host)
            self.wake()
