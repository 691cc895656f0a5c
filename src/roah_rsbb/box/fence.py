"""Keeps two computers from being the box at the same time (docs/standby.md, "How it works").

It says the words of `standby/pair.py` to the other ends of the box's pairs, and hears theirs, by UDP on the port of the
standby. Everything here runs in the loop's thread. Without a pair, nothing is opened or sent.

A core that was not running for a while (it was stopped, or its computer was) may not be the box any more. `check`
notices that before anything leaves the core. Then it asks the other ends, without the loop, so that nothing else
happens. If one of them is the box now, the process ends there and then.
"""

import asyncio
import contextlib
import os
import sys
from typing import Callable, Dict, Optional, Tuple

from roah_rsbb.comm.channels import MakePeer
from roah_rsbb.comm.peer import Address, Peer
from roah_rsbb.ground.linux import running_s
from roah_rsbb.journal import epochs
from roah_rsbb.journal.log_dir import begin_thread
from roah_rsbb.standby.pair import AWAY_S, SAY_S, Claim, Side, State, Word, seal, unseal
from roah_rsbb.standby.pairing import BOX_FILE, FOLDER, PAIRED, Partner, partners_of

# A standby may be paired at any time.
LOOK_S = 1.0

# Epoch, cut and address of the box that took over.
OnSuperseded = Callable[[int, int, str], None]


def end_superseded(away_s: float, host: str) -> None:
    """End the process at once, without a message by ROS."""
    print(f"This core was not running for {away_s:.1f} s. The box at {host} has taken over meanwhile: this core ends, "
          "and has sent and recorded nothing since. If roslaunch starts it again, it stays superseded", file=sys.stderr,
          flush=True)
    os._exit(1)


class Fence:
    """The core's end of all pairs to which this computer belongs."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, log_dir: str, journal: str, rsbb_host: str, bind_host: str,
        standby_port: int, on_superseded: OnSuperseded, on_trouble: Callable[[str], None],
        clock: Callable[[], float] = running_s, end: Callable[[float, str], None] = end_superseded,
        make_peer: MakePeer = Peer, begin: Callable[[Callable[[], None]], None] = begin_thread,
        live: Callable[[], object] = lambda: None,
    ) -> None:
        """`journal`: path of the core's journal. `standby_port`: 0: none. `end` ends the process of a core that was
        superseded while it was not running, and is given for how many seconds, and by which address. `make_peer`
        replaces `Peer`, for another network. `begin` runs a function that may wait for the disk. `live` says that
        the core lives while it asks without its loop."""
        self._begin, self._is_looking, self._live = begin, False, live
        self._loop = loop
        self._log_dir = log_dir
        self._rsbb_host, self._bind_host, self._port = rsbb_host, bind_host, standby_port
        self._on_superseded, self._on_trouble = on_superseded, on_trouble
        self._clock, self._end, self._make_peer = clock, end, make_peer
        self._ran = clock()  # when the loop's thread was running last
        self._is_asking_again = False
        self._files: Tuple[Optional[int], ...] = ()
        self._found: Dict[str, Partner] = {}
        self._look_at_files()
        self._partners = self._found
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
        self._peer = self._make_peer(
            self._loop, self._rsbb_host, port, self._hear, lambda text: None, bind_host=self._bind_host)
        try:
            self._peer.open()
        except OSError as error:
            self._peer = None
            self._decided.set_result(None)
            self._on_trouble(f"A standby that takes over would not be heard: {error}")
            return
        self._ran = self._clock()
        self._tick()

    def close(self) -> None:
        """Close the socket."""
        if self._timer is not None:
            self._timer.cancel()
        if self._peer is not None:
            self._peer.close()
            self._peer = None

    async def ask(self) -> None:
        """Wait until it is decided whether this computer is the box."""
        await self._decided
        self._ran = self._clock()

    def check(self) -> None:
        """Call this in the loop's thread before anything leaves the core, at least once in `AWAY_S`. It does not return
        if another computer became the box while this process was not running."""
        now = self._clock()
        away_s, self._ran = now - self._ran, now
        if away_s >= AWAY_S and self._peer is not None and not self._is_asking_again:
            self._ask_again(away_s)
            self._ran = self._clock()

    def _ask_again(self, away_s: float) -> None:
        if self._claim.state is State.SUPERSEDED:
            return
        self._is_asking_again = True
        self._look_at_files()
        self._use_files()
        self._peer.wait(0.0)  # an answer that came before is no answer now
        self._claim.ask_again()
        while self._claim.state is State.ASKING:
            self._live()  # a core that was stopped for a moment is not ended for this
            self._say_due()
            self._peer.wait(SAY_S / 2)
        self._is_asking_again = False
        if self._claim.by is not None:
            self._end(away_s, self._partners[self._claim.by.pair].host)

    # -- steps --------------------------------------------------------------------------------------

    def _tick(self) -> None:
        self.check()
        self._timer = self._loop.call_later(SAY_S, self._tick)
        now = self._loop.time()
        if now >= self._looked + LOOK_S and not self._is_looking:
            self._looked, self._is_looking = now, True
            self._begin(self._look_in_thread)
        self._say_due()
        self._note_decision()

    def _say_due(self) -> None:
        for name, word in self._claim.tick(self._loop.time()):
            self._say(name, word, self._peer.rsbb_host, self._partners[name].host)

    def _hear(self, datagram: bytes, sender: Address) -> None:
        self.check()
        heard = unseal({name: partner.secret for name, partner in self._partners.items()}, datagram)
        if heard is None:
            return
        name, word = heard
        was_superseded = self._claim.state is State.SUPERSEDED
        answer = self._claim.hear(name, word)
        if answer is not None:
            self._say(name, answer, sender[0])
        if self._claim.state is State.SUPERSEDED and not was_superseded and not self._is_asking_again:
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

    def _look_at_files(self) -> None:
        """Read the pairs if their files changed."""
        paths = os.path.join(self._log_dir, FOLDER, PAIRED), os.path.join(self._log_dir, BOX_FILE)
        found = tuple(map(_changed, paths))
        if found != self._files:
            # A standby that was never connected has no copy, and cannot have taken over.
            self._found = {name: partner for name, partner in partners_of(self._log_dir).items() if partner.host}
            self._files = found

    def _look_in_thread(self) -> None:
        """The loop does not wait for a disk that hangs."""
        self._look_at_files()
        with contextlib.suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(self._use_files)

    def _use_files(self) -> None:
        self._is_looking, self._partners = False, self._found
        self._claim.use(self._sides())


def _changed(path: str) -> Optional[int]:
    try:
        return os.stat(path).st_mtime_ns
    except OSError:
        return None
