"""The core's end of the pair, in its loop, which must never wait."""

import asyncio
import contextlib
import socket
import threading
import time

import pytest

from roah_rsbb.box.fence import Fence
from roah_rsbb.comm.peer import Peer
from roah_rsbb.standby import pair
from roah_rsbb.standby.pair import AWAY_S, Side, Word, pair_name, seal, unseal
from roah_rsbb.standby.pairing import PairedStandby, write_standby

OWN, STANDBY = "127.0.0.1", "127.0.0.3"
SECRET = "00"


class Away:
    """A core whose time the test makes, and the other end of its pair."""

    def __init__(self, tmp_path, cleanup, is_decided=True):
        self.now, self.ends, self.signs, self.has_answered = 0.0, [], [], threading.Event()
        self.other = cleanup.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        self.other.bind((STANDBY, 0))
        port = self.other.getsockname()[1]
        write_standby(str(tmp_path), PairedStandby("laptop", SECRET, STANDBY, port))
        self.loop = cleanup.enter_context(contextlib.closing(asyncio.new_event_loop()))
        self.fence = Fence(
            self.loop, str(tmp_path), str(tmp_path / "journal"), "127.255.255.255", OWN, port,
            lambda *by: self.ends.append("superseded in the usual way"), None, lambda: self.now,
            lambda away_s, host: self.ends.append((away_s, host)), live=lambda: self.signs.append(time.monotonic()))
        self.words, self.answer = [], Word(Side.STANDBY, 1, claims=False)
        self.port = port
        threading.Thread(target=self._answer, daemon=True).start()
        self.fence.open()
        cleanup.callback(self.fence.close)
        if is_decided:
            self.loop.run_until_complete(self.fence.ask())
        self.words.clear()

    def _answer(self):
        with contextlib.suppress(OSError):
            while True:
                heard = unseal({pair_name(SECRET): SECRET}, self.other.recv(1024))
                if heard is not None and heard[1].side is Side.BOX:
                    self.words.append(heard[1])
                    if heard[1].asks and self.answer is not None:
                        self.other.sendto(seal(SECRET, self.answer), (OWN, self.port))
                        self.has_answered.set()


@pytest.fixture
def away(tmp_path, monkeypatch):
    monkeypatch.setattr(pair, "ASK_AGAIN_S", 0.3)
    with contextlib.ExitStack() as cleanup:
        yield Away(tmp_path, cleanup)


def test_a_core_that_was_stopped_ends_if_another_box_took_over(away):
    away.answer = Word(Side.STANDBY, 2, claims=True)
    away.now = AWAY_S - 0.1
    away.fence.check()
    assert not away.words and not away.ends, "it was running"
    away.now += 7.0
    away.fence.check()
    assert away.ends == [(7.0, STANDBY)], "it writes no entry, as a box does that hears its successor"


def test_a_core_that_was_stopped_may_hear_its_successor_first(away):
    """The word waits at its socket."""
    away.answer = Word(Side.STANDBY, 2, claims=True)
    away.other.sendto(seal(SECRET, away.answer), (OWN, away.port))
    away.now = 7.0
    away.loop.run_until_complete(asyncio.sleep(2 * pair.SAY_S))
    assert away.ends[0] == (7.0, STANDBY)


def test_a_core_that_was_stopped_while_it_asked_asks_again(tmp_path, monkeypatch):
    """The answer that waits at its socket is older."""
    monkeypatch.setattr(pair, "ASK_AGAIN_S", 0.3)
    with contextlib.ExitStack() as cleanup:
        away = Away(tmp_path, cleanup, is_decided=False)
        assert away.has_answered.wait(60.0)
        away.answer = Word(Side.STANDBY, 2, claims=True)
        away.now = 7.0
        away.fence.check()
        assert away.ends == [(7.0, STANDBY)]


@pytest.mark.parametrize("answer", [Word(Side.STANDBY, 1, claims=False), None])
def test_a_core_that_was_stopped_continues_if_nobody_took_over(away, answer):
    away.answer = answer
    away.now = 60.0
    away.fence.check()
    assert away.words and not away.ends
    assert away.signs, "it lives while it asks: whoever watches it has no more patience"
    away.words.clear()
    away.fence.check()
    assert not away.words, "it asks once"


def test_a_core_without_a_standby_asks_nobody(tmp_path):
    now, ends = [0.0], []
    with contextlib.closing(asyncio.new_event_loop()) as loop:
        fence = Fence(loop, str(tmp_path), str(tmp_path / "journal"), "127.255.255.255", OWN, 0, None, None,
                      lambda: now[0], lambda *by: ends.append(by))
        fence.open()
        loop.run_until_complete(fence.ask())
        now[0] = 1000.0
        fence.check()
    assert not ends


def test_no_name_is_looked_up_for_a_word(tmp_path, monkeypatch):
    """rsbb_host may be a name, which is looked up once."""
    sent = []
    monkeypatch.setattr(Peer, "send", lambda _self, _datagram, host: sent.append(host))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind((OWN, 0))
        port = free.getsockname()[1]
    write_standby(str(tmp_path), PairedStandby("laptop", "00", STANDBY, port))
    with contextlib.closing(asyncio.new_event_loop()) as loop:
        fence = Fence(loop, str(tmp_path), str(tmp_path / "journal"), "localhost", OWN, port, lambda *_: None, None)
        fence.open()
        loop.run_until_complete(fence.ask())
        fence.close()
    assert set(sent) == {OWN, STANDBY}
