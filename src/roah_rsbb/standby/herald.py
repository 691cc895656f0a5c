"""Carries the words of a pair over TCP, in case a firewall or a changed address blocks the core's datagrams.

It runs in the process that makes the copy. It passes what it hears on to the core of this computer, which decides.
"""

import contextlib
import os
import socket
import threading
from typing import Callable, Tuple

from roah_rsbb.journal import epochs
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.standby.channel import Lost, connect
from roah_rsbb.standby.messages import MAX_BYTES_OF_STRANGERS, BadMessage
from roah_rsbb.standby.pair import Word
from roah_rsbb.standby.partners import Partner, partners_of
from roah_rsbb.standby.words import seal, unseal

PERIOD_S = 1.0


class Herald:
    """Says the box's word to the other ends of its pairs, and answers theirs."""

    def __init__(self, log_dir: str, core: Tuple[str, int], is_alive: Callable[[], bool] = lambda: True) -> None:
        """`core`: address and UDP port at which the core of this computer hears words. `is_alive`: whether it answers:
        one that hangs is not the box, whatever the journal says."""
        self._log_dir = log_dir
        self._core, self._is_alive = core, is_alive
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._work, name="herald", daemon=True)

    def start(self) -> None:
        """Start to say the box's word, in a thread."""
        self._thread.start()

    def end(self) -> None:
        """End the thread soon."""
        self._ended.set()

    def answer(self, datagram: bytes) -> bytes:
        """Take a word, in any thread; returns the answer; empty: no end of a pair said it."""
        partners = partners_of(self._log_dir)
        heard = unseal({name: partner.secret for name, partner in partners.items()}, datagram)
        if heard is None:
            return b""
        self._pass_on(datagram)
        return self._word(partners[heard[0]])

    def say(self) -> None:
        """Say the box's word to all partners, and take their answers."""
        for partner in partners_of(self._log_dir).values():
            if partner.host:
                with contextlib.suppress(Lost, BadMessage):
                    self._say_to(partner)

    def _work(self) -> None:
        while not self._ended.wait(PERIOD_S):
            self.say()

    def _say_to(self, partner: Partner) -> None:
        channel, _ = connect(partner.host, partner.port, PERIOD_S)
        try:
            channel.send({"do": "word", "word": self._word(partner).decode("ascii")})
            answer = str(channel.receive(MAX_BYTES_OF_STRANGERS).get("word"))
            if answer:
                self._pass_on(answer.encode("ascii", "replace"))
        finally:
            channel.close()

    def _word(self, partner: Partner) -> bytes:
        standing = epochs.standing_in(os.path.join(self._log_dir, JOURNAL))
        return seal(partner.secret, Word(partner.own_side, standing.epoch,
                                         claims=not standing.is_superseded and self._is_alive(), cut=standing.cut))

    def _pass_on(self, datagram: bytes) -> None:
        with contextlib.suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            sender.sendto(datagram, self._core)
