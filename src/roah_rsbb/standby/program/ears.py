"""Hears the box in every way while the standby keeps the copy, and decides on an automatic takeover.

It runs in a thread of its own. It answers the words of the pair, so that a box that starts again need not wait.
"""

import asyncio
import threading
import time
from typing import Callable, Dict, NamedTuple, Optional

from roah_rsbb.comm.channels import Network, PublicChannel
from roah_rsbb.comm.peer import Address, Peer
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.standby.pair import BoxSilence, Side, Word
from roah_rsbb.standby.pairing import hashed
from roah_rsbb.standby.partners import PairedBox
from roah_rsbb.standby.program.network import answers, is_connected
from roah_rsbb.standby.words import pair_name, seal, unseal

LOOK_S = 0.25
# A takeover that is not possible is tried again after this time.
RETRY_S = 2.0
# This computer must have been connected for so long without hearing the box. It hears a box several times a second, but
# when its own cable is plugged in again, the witness may answer first.
CONNECTED_S = 1.0


class Automatic(NamedTuple):
    """When a standby takes over by itself."""

    silence_s: float
    witness: str = ""  # a third host that must answer; empty: the cable must be plugged in


class Ears:
    """Hears the box until `end` is called."""

    def __init__(
        self, box: PairedBox, network_of: Callable[[], Dict[str, str]], epoch_of: Callable[[], int],
        automatic: Optional[Automatic], on_silence: Callable[[], None], on_state: Callable[[str], None],
    ) -> None:
        """`network_of` returns where to listen, or nothing while it is unknown. `epoch_of` returns the epoch of the
        copy. `on_silence` is called when the standby shall take over, `on_state` with what prevents that."""
        self._secret = hashed(box.key)
        self._port = box.port
        self._network_of, self._epoch_of = network_of, epoch_of
        self._automatic, self._on_silence, self._on_state = automatic, on_silence, on_state
        self._silence = BoxSilence()
        self._last_mono = time.monotonic()  # when the box was heard, or this began
        self._is_heard = threading.Event()
        self._connected_mono: Optional[float] = None  # since when this computer is connected, while the box is silent
        self._state = ""  # the last one that was reported
        self._loop = asyncio.new_event_loop()
        self._peer: Optional[Peer] = None
        self._beacons: Optional[PublicChannel] = None
        self._thread = threading.Thread(target=self._run, name="ears", daemon=True)

    def start(self) -> None:
        """Start to listen."""
        self._thread.start()

    def end(self) -> None:
        """From any other thread: stop listening, and wait for it."""
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()

    def heard(self) -> None:
        """From any thread: the box was heard on the copy's connection."""
        self._loop.call_soon_threadsafe(self._hear_box)

    def wait_silent(self, seconds: float) -> bool:
        """From any other thread: wait until the box has been silent for that long, or is heard. Returns whether it is
        silent."""
        self._is_heard.clear()
        left = self._last_mono + seconds - time.monotonic()
        return left <= 0 or not self._is_heard.wait(left)

    # -- in the thread ------------------------------------------------------------------------------

    def _run(self) -> None:
        self._loop.call_soon(self._look)
        self._loop.run_forever()
        for channel in (self._peer, self._beacons):
            if channel is not None:
                channel.close()
        self._loop.close()

    def _hear_box(self) -> None:
        self._silence.hear(self._loop.time())
        self._last_mono = time.monotonic()
        self._is_heard.set()

    def _look(self) -> None:
        trouble = self._open() if self._peer is None else ""
        again, wanted = LOOK_S, self._automatic
        if wanted is not None:
            # To find out whether it is connected may take a while. What comes meanwhile is heard before the next look.
            if self._may_take_over(wanted):
                self._on_silence()
                return
            if not self._silence.lasts(self._loop.time(), wanted.silence_s - CONNECTED_S):
                self._connected_mono = None
            else:
                reason = self._why_not()
                trouble = trouble or reason
                if reason:
                    self._connected_mono, again = None, RETRY_S
                elif self._connected_mono is None:
                    self._connected_mono = self._loop.time()
        if trouble != self._state:
            self._state = trouble
            if trouble:
                self._on_state(trouble)
        self._loop.call_later(again, self._look)

    def _may_take_over(self, wanted: Automatic) -> bool:
        now = self._loop.time()
        return (self._silence.lasts(now, wanted.silence_s) and self._connected_mono is not None
                and now - self._connected_mono >= CONNECTED_S)

    def _why_not(self) -> str:
        """Return why an automatic takeover would be wrong: this computer may be the one that is cut off."""
        if self._beacons is None:
            return "the box is silent, but this standby does not know its network yet: no automatic takeover"
        if self._automatic.witness:
            return "" if answers(self._automatic.witness) else (
                f"the box is silent, but {self._automatic.witness} does not answer either: no automatic takeover. "
                "Check the cable of this computer")
        return "" if is_connected(self._beacons.addr) else (
            "the box is silent, but the cable of this computer is not plugged in: no automatic takeover")

    def _open(self) -> str:
        """Open both sockets, once the network is known; returns why this is not possible."""
        network = self._network_of()
        if not network:
            return ""
        host, bind_host = network["rsbb_host"], network["bind_host"]
        try:
            if self._beacons is None:
                beacons = PublicChannel(
                    self._loop, Network(host, int(network["rsbb_port"]), bind_host), self._on_public, lambda _: None)
                beacons.open()
                self._beacons = beacons
            peer = Peer(self._loop, host, self._port, self._on_word, lambda _: None, bind_host=bind_host)
            peer.open()
            self._peer = peer
        except OSError as error:
            return f"the box's network cannot be heard: {error}"
        return ""

    def _on_public(self, message: object, _sender: Address) -> None:
        if isinstance(message, pb.RoahRsbbBeacon):
            self._hear_box()

    def _on_word(self, datagram: bytes, sender: Address) -> None:
        heard = unseal({pair_name(self._secret): self._secret}, datagram)
        if heard is None or heard[1].side is not Side.BOX:
            return
        if heard[1].claims:
            self._hear_box()
        if heard[1].asks:
            self._peer.send(seal(self._secret, Word(Side.STANDBY, self._epoch_of(), claims=False)), sender[0])
