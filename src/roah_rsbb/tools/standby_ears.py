"""Hears the box in every way while the standby keeps the copy, and decides on an automatic takeover.

It runs in a thread of its own. It answers the words of the pair, so that a box that starts again need not wait.
"""

import asyncio
import threading
import time
from typing import Callable, Dict, NamedTuple, Optional

from roah_rsbb.comm.channels import PublicChannel
from roah_rsbb.comm.peer import Address, Peer
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.standby.pair import Side, Silence, Word
from roah_rsbb.standby.pairing import hashed
from roah_rsbb.standby.partners import PairedBox
from roah_rsbb.standby.words import pair_name, seal, unseal
from roah_rsbb.tools.standby_network import answers, is_connected

LOOK_S = 0.25
# A takeover that is not possible is tried again after this time.
RETRY_S = 2.0


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
        self._silence = Silence()
        self._last_mono = time.monotonic()  # when the box was heard, or this began
        self._is_heard = threading.Event()
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
        if self._beacons is None:
            self._open()
        again = LOOK_S
        wanted = self._automatic
        if wanted is not None and self._silence.lasts(self._loop.time(), wanted.silence_s):
            trouble = self._why_not()
            if not trouble:
                self._on_silence()
                return
            self._on_state(trouble)
            again = RETRY_S
        self._loop.call_later(again, self._look)

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

    def _open(self) -> None:
        network = self._network_of()
        if not network:
            return
        try:
            beacons = PublicChannel(
                self._loop, network["rsbb_host"], int(network["rsbb_port"]), self._on_public, lambda _: None,
                bind_host=network["bind_host"])
            beacons.open()
            self._beacons = beacons
            self._peer = Peer(self._loop, network["rsbb_host"], self._port, self._on_word, lambda _: None,
                              bind_host=network["bind_host"])
            self._peer.open()
        except OSError as error:
            self._on_state(f"the box's network cannot be heard: {error}")

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
