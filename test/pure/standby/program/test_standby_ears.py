"""The automatic takeover: after a silence on all ways, and only if this computer is connected itself."""

import contextlib
import queue
import socket
import threading

import pytest

from helpers.small_box import free_ports
from roah_rsbb.standby.pair import Side, Word, hashed, pair_name, seal, unseal
from roah_rsbb.standby.pairing import PairedBox
from roah_rsbb.standby.program import ears
from roah_rsbb.standby.program import ears as module
from roah_rsbb.standby.program.ears import Automatic, Ears

BOX, STANDBY, BROADCAST = "127.0.0.2", "127.0.0.1", "127.255.255.255"
SECRET = hashed("key")
SILENCE_S = 0.5


class Heard:
    """A standby on the loopback, what it reports, and a socket of its box."""

    def __init__(self, cleanup, automatic):
        self.port = free_ports()
        self.reports = queue.Queue()
        self.ears = Ears(
            PairedBox(BOX, self.port, "ff", "key"),
            lambda: {"rsbb_host": BROADCAST, "rsbb_port": str(self.port + 1), "bind_host": STANDBY},
            lambda: 3, automatic, lambda: self.reports.put("takeover"), self.reports.put)
        self.ears.start()
        cleanup.callback(self.ears.end)
        self.box = cleanup.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        self.box.bind((BOX, self.port))
        self.box.settimeout(0.1)

    def answer(self, word, secret=SECRET):
        """Say a word until it is answered."""
        for _ in range(600):
            self.box.sendto(seal(secret, word), (STANDBY, self.port))
            with contextlib.suppress(socket.timeout):
                return unseal({pair_name(SECRET): SECRET}, self.box.recv(1024))
        raise AssertionError("no answer")


@pytest.fixture
def listening(monkeypatch):
    monkeypatch.setattr(module, "RETRY_S", 0.1)
    monkeypatch.setattr(module, "CONNECTED_S", 0.1)
    with contextlib.ExitStack() as cleanup:
        yield lambda automatic=None: Heard(cleanup, automatic)


def test_a_box_that_asks_is_answered(listening):
    name, word = listening().answer(Word(Side.BOX, 3, claims=True, asks=True))
    assert (name, word) == (pair_name(SECRET), Word(Side.STANDBY, 3, claims=False))


def test_it_takes_over_after_a_silence(listening, monkeypatch):
    monkeypatch.setattr(module, "is_connected", lambda host: host == BROADCAST)
    heard = listening(Automatic(SILENCE_S))
    heard.ears.heard()
    assert heard.reports.get(timeout=60.0) == "takeover"


def test_words_of_the_box_end_the_silence_but_its_end_does_not(listening, monkeypatch):
    monkeypatch.setattr(module, "is_connected", lambda host: True)
    heard = listening(Automatic(SILENCE_S))
    heard.answer(Word(Side.BOX, 3, claims=False, asks=True))
    assert not heard.ears._silence.lasts(float("inf"), 0.0), "it was superseded, and is no box"
    heard.answer(Word(Side.BOX, 3, claims=True, asks=True))
    assert heard.reports.get(timeout=60.0) == "takeover"


def test_a_box_that_was_never_heard(listening, monkeypatch):
    monkeypatch.setattr(module, "is_connected", lambda host: True)
    heard = listening(Automatic(0.0))
    heard.answer(Word(Side.BOX, 3, claims=False, asks=True))  # some time passed
    with pytest.raises(queue.Empty):
        heard.reports.get(timeout=4 * module.LOOK_S)


@pytest.mark.parametrize("witness, asked, text", [
    ("", "is_connected", "the cable of this computer is not plugged in"),
    ("10.0.0.1", "answers", "10.0.0.1 does not answer either")])
def test_the_computer_that_is_cut_off_does_not_take_over(listening, monkeypatch, witness, asked, text):
    is_cut_off = [True]
    monkeypatch.setattr(module, asked, lambda host: not is_cut_off[0])
    heard = listening(Automatic(SILENCE_S, witness))
    heard.ears.heard()
    assert text in heard.reports.get(timeout=60.0)
    is_cut_off[0] = False
    while heard.reports.get(timeout=60.0) != "takeover":
        pass


def test_a_standby_that_is_connected_again_hears_the_box_before_it_takes_over(listening, monkeypatch):
    """The witness may answer before the next word of the box comes."""
    monkeypatch.setattr(module, "CONNECTED_S", 60.0)
    asked = queue.Queue()
    is_cut_off = [True]
    monkeypatch.setattr(module, "answers", lambda host: asked.put(host) or not is_cut_off[0])
    heard = listening(Automatic(SILENCE_S, "10.0.0.1"))
    heard.ears.heard()
    assert "does not answer either" in heard.reports.get(timeout=60.0)
    is_cut_off[0] = False
    while not asked.empty():
        asked.get()
    for _ in range(3):
        asked.get(timeout=60.0)
    heard.answer(Word(Side.BOX, 3, claims=True, asks=True))
    assert heard.reports.empty()


def test_a_trouble_is_reported_once(listening, monkeypatch):
    asked = queue.Queue()
    monkeypatch.setattr(module, "answers", lambda host: asked.put(host))
    heard = listening(Automatic(SILENCE_S, "10.0.0.1"))
    heard.ears.heard()
    for _ in range(4):
        asked.get(timeout=60.0)
    assert heard.reports.qsize() == 1


def test_a_port_that_is_in_use_is_tried_again(monkeypatch):
    """Also if only the one for words is."""
    reports = queue.Queue()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other, contextlib.ExitStack() as cleanup:
        other.bind((STANDBY, 0))
        port = other.getsockname()[1]
        ears = Ears(PairedBox(BOX, port, "ff", "key"),
                    lambda: {"rsbb_host": BROADCAST, "rsbb_port": str(port + 1), "bind_host": STANDBY},
                    lambda: 3, None, lambda: None, reports.put)
        ears.start()
        cleanup.callback(ears.end)
        assert "cannot be heard" in reports.get(timeout=60.0)
        other.close()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as box:
            box.bind((BOX, port))
            box.settimeout(0.1)
            asking = seal(SECRET, Word(Side.BOX, 3, claims=True, asks=True))
            for _ in range(600):
                box.sendto(asking, (STANDBY, port))
                with contextlib.suppress(OSError):
                    assert box.recv(1024)
                    return
    raise AssertionError("no answer")


def test_a_request_waits_until_the_box_is_silent_or_heard(listening):
    heard = listening()
    heard.answer(Word(Side.BOX, 3, claims=True, asks=True))
    assert heard.ears.wait_silent(0.3)
    assert heard.ears.wait_silent(0.0), "it has been silent before"
    waiting = []
    thread = threading.Thread(target=lambda: waiting.append(heard.ears.wait_silent(600.0)))
    thread.start()
    while thread.is_alive():
        heard.answer(Word(Side.BOX, 3, claims=True, asks=True))
    assert waiting == [False]


def test_the_loopback_is_connected():
    assert ears.is_connected("127.255.255.255")
    assert not ears.is_connected("no address")


def test_an_address_that_this_computer_cannot_have(tmp_path):
    with pytest.raises(ears.NoAddress):
        ears.take_address("no address", str(tmp_path))


def test_the_announcement_of_an_address():
    frame = ears.gratuitous_arp("10.0.0.2", bytes(range(6)))
    assert len(frame) == 42 and frame[:6] == b"\xff" * 6 and frame[6:12] == frame[22:28] == bytes(range(6))
    assert frame[12:22] == bytes.fromhex("0806 0001 0800 06 04 0001")
    assert frame[28:32] == frame[38:42] == bytes([10, 0, 0, 2])


def test_a_ping():
    assert ears.answers("127.0.0.1")
    assert not ears.answers("no address")
