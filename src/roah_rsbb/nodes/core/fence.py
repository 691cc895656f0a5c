"""Keeps two computers from being the box at the same time (docs/standby.md, "How it works").

It says the words of `standby/pair.py` to the other ends of the box's pairs, and hears theirs, by UDP on the port of the
standby. Everything here runs in the loop's thread. Without a pair, nothing is opened or sent.
"""

import asyncio
import os
from typing import Callable, Dict, Optional, Tuple

from roah_rsbb.comm.peer import Address, Peer
from roah_rsbb.journal import epochs
from roah_rsbb.standby.pair import SAY_S, Claim, Side, State, Word
from roah_rsbb.standby.partners import BOX_FILE, FOLDER, PAIRED, Partner, partners_of
from roah_rsbb.standby.words import seal, unseal

# A standby may be paired at any time.
LOOK_S = 1.0

# Epoch, cut and address of the box that took over.
OnSuperseded = Callable[[int, int, str], None]


class Fence:
    """The core's end of all pairs to which this computer belongs."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, log_dir: str, journal: str, rsbb_host: str, bind_host: str,
        standby_port: int, on_superseded: OnSuperseded, on_trouble: Callable[[str], None],
    ) -> None:
        """`journal`: path of the core's journal. `standby_port`: 0: none."""
        self._loop = loop
        self._log_dir = log_dir
        self._rsbb_host, self._bind_host, self._port = rsbb_host, bind_host, standby_port
        self._on_superseded, self._on_trouble = on_superseded, on_trouble
        self._files: Tuple[Optional[int], ...] = ()
        self._partners: Dict[str, Partner] = {}
        self._look_at_files()
        standing = epochs.standing_in(journal)
        self.by = standing.by if standing.is_superseded else ""  # address of the box that took over before this start
        self._claim = Claim(standing.epoch, standing.cut, self._sides(), standing.is_superseded)
        self._peer: Optional[Peer] = None
        self._timer: Optional[asyncio.TimerHandle] = None
        self._decided = loop.create_future()
        self._looked = loop.time()

    def open(self) -> None:
        """Begin to say and to hear words, if there is a pair or can be one."""
        port = self._port or next((partner.port for partner in self._partners.values()), 0)
        if not port:
            self._decided.set_result(None)
            return
        self._peer = Peer(self._loop, self._rsbb_host, port, self._hear, lambda text: None, bind_host=self._bind_host)
        try:
            self._peer.open()
        except OSError as error:
            self._peer = None
            self._decided.set_result(None)
            self._on_trouble(f"A standby that takes over would not be heard: {error}")
            return
        self._tick()

    def close(self) -> None:
        """Close the socket."""
        if self._timer is not None:
            self._timer.cancel()
        if self._peer is not None:
            self._peer.close()

    async def ask(self) -> None:
        """Wait until it is decided whether this computer is the box."""
        await self._decided

    # -- steps --------------------------------------------------------------------------------------

    def _tick(self) -> None:
        self._timer = self._loop.call_later(SAY_S, self._tick)
        now = self._loop.time()
        if now >= self._looked + LOOK_S:
            self._looked = now
            if self._look_at_files():
                self._claim.use(self._sides())
        for name, word in self._claim.tick(now):
            self._say(name, word, self._peer.rsbb_host, self._partners[name].host)
        self._note_decision()

    def _hear(self, datagram: bytes, sender: Address) -> None:
        heard = unseal({name: partner.secret for name, partner in self._partners.items()}, datagram)
        if heard is None:
            return
        name, word = heard
        was_superseded = self._claim.state is State.SUPERSEDED
        answer = self._claim.hear(name, word)
        if answer is not None:
            self._say(name, answer, sender[0])
        if self._claim.state is State.SUPERSEDED and not was_superseded:
            # A word that came by TCP was passed on by this computer, so the sender's address says nothing.
            self._on_superseded(word.epoch, word.cut, self._partners[name].host)
        self._note_decision()

    def _say(self, name: str, word: Word, *hosts: str) -> None:
        datagram = seal(self._partners[name].secret, word)
        for host in sorted({host for host in hosts if host}):
            self._peer.send(datagram, host)

    def _note_decision(self) -> None:
        if self._claim.state is not State.ASKING and not self._decided.done():
            self._decided.set_result(None)

    def _sides(self) -> Dict[str, Side]:
        return {name: partner.own_side for name, partner in self._partners.items()}

    def _look_at_files(self) -> bool:
        """Read the pairs if their files changed. Returns whether they did."""
        paths = os.path.join(self._log_dir, FOLDER, PAIRED), os.path.join(self._log_dir, BOX_FILE)
        found = tuple(map(_changed, paths))
        if found == self._files:
            return False
        self._files = found
        # A standby that was never connected has no copy, and cannot have taken over.
        self._partners = {name: partner for name, partner in partners_of(self._log_dir).items() if partner.host}
        return True


def _changed(path: str) -> Optional[int]:
    try:
        return os.stat(path).st_mtime_ns
    except OSError:
        return None
