"""Both ends over real connections on the loopback: pairing, keys, and what strangers get."""

import contextlib
import queue
import socket
import ssl
import threading

import pytest

from helpers.copied import contents
from helpers.journals import Writer
from roah_rsbb.copies import rows
from roah_rsbb.copies.follower import Follower
from roah_rsbb.journal import kinds
from roah_rsbb.journal.epochs import raise_epoch, superseded_value
from roah_rsbb.journal.file import FILE_NAME
from roah_rsbb.standby import channel as channels
from roah_rsbb.standby import standby_end
from roah_rsbb.standby.box_end import MAX_STRANGERS, BoxEnd
from roah_rsbb.standby.herald import Herald
from roah_rsbb.standby.messages import LENGTH, MAX_BYTES_OF_STRANGERS, decode
from roah_rsbb.standby.pair import Side
from roah_rsbb.standby.pairing import MAX_GUESSES, hashed
from roah_rsbb.standby.partners import PairedStandby, partners_of, read_box, read_standby, write_standby
from roah_rsbb.standby.standby_end import CannotPair, StandbyEnd, is_alive, pair, rejoin
from roah_rsbb.standby.words import rejoin_key, unseal

HOST = "127.0.0.1"


class Ends:
    """A box with a journal, and the folder of a standby."""

    def __init__(self, folder):
        self.log_dir, self.far = folder / "log", folder / "far"
        self.writer = Writer(self.log_dir)
        self.events = queue.Queue()
        self.states = queue.Queue()
        self._cleanup = contextlib.ExitStack()
        self._cleanup.callback(self.writer.journal.close)
        self.box = None
        self.start_box()

    def start_box(self):
        port = 0 if self.box is None else self.box.port
        self.box = BoxEnd(str(self.log_dir), HOST, port, self.events.put)
        self._cleanup.callback(self.box.close)
        self.follower = Follower(str(self.log_dir), self.box.open_copy)
        self._cleanup.callback(self.follower.close)

    def pair(self, code=None):
        return pair(str(self.far), HOST, self.box.port, code or self.box.code)

    def follow(self):
        """Start a standby; returns its end."""
        end = StandbyEnd(str(self.far), read_box(str(self.far)), self.states.put)
        thread = threading.Thread(target=end.run, daemon=True)
        thread.start()
        self._cleanup.callback(thread.join, 60.0)
        self._cleanup.callback(end.end)
        return end

    def wait_connected(self):
        while "is connected" not in self.events.get(timeout=60.0):
            pass

    def is_complete(self):
        self.follower.step()
        return not self.follower.progress.trouble and contents(self.far) == contents(self.log_dir)

    def close(self):
        self._cleanup.close()


@pytest.fixture
def ends(tmp_path, monkeypatch):
    monkeypatch.setattr(standby_end, "RETRY_S", 0.02)
    made = Ends(tmp_path)
    yield made
    made.close()


def test_a_paired_standby_gets_the_copy(ends):
    ends.pair(ends.box.code.lower().replace("-", " "))
    ends.follow()
    ends.wait_connected()
    ends.writer.entry("/notification", "now")
    assert ends.is_complete()
    ends.writer.entry("/notification", "later")
    assert ends.is_complete()


def test_a_standby_is_paired_once(ends):
    """Both ends may restart: the certificate and the key stay."""
    ends.pair()
    ends.box.close()
    ends.start_box()
    assert ends.box.is_paired and ends.box.name == socket.gethostname()
    ends.follow()
    ends.wait_connected()
    assert ends.is_complete()


def test_a_connection_that_ends_is_reported_and_made_again(ends):
    ends.pair()
    ends.follow()
    ends.wait_connected()
    assert ends.is_complete()
    ends.box.close()
    ends.writer.entry("/notification", "meanwhile")
    ends.follower.step()
    assert "the standby is not connected" in ends.follower.progress.trouble
    assert ends.follower.progress.missing_entries == 1
    ends.start_box()
    ends.wait_connected()
    assert ends.is_complete()


def test_a_standby_that_was_never_connected(ends):
    ends.follower.step()
    assert "no standby is paired yet" in ends.follower.progress.trouble
    ends.pair()
    ends.follower.step()
    assert "the standby is not connected" in ends.follower.progress.trouble


def test_a_wrong_code(ends):
    code = ends.box.code
    with pytest.raises(CannotPair, match="the code is wrong"):
        ends.pair("AAAA-AAAA")
    assert not ends.box.is_paired and read_box(str(ends.far)) is None
    ends.pair(code)


def test_a_code_is_used_once_and_changes_after_some_guesses(ends):
    code = ends.box.code
    for _ in range(MAX_GUESSES):
        with pytest.raises(CannotPair):
            ends.pair("AAAA-AAAA")
    with pytest.raises(CannotPair):
        ends.pair(code)
    code = ends.box.code
    ends.pair(code)
    with pytest.raises(CannotPair):
        ends.pair(code)


def test_a_new_standby_replaces_the_old_one(ends, tmp_path):
    first = ends.pair()
    ends.pair()
    channel, _ = channels.connect(HOST, ends.box.port)
    channel.send({"do": "copy", "key": first.key})
    assert "not paired" in channel.receive()["refused"]
    channel.close()


@pytest.mark.parametrize("hello", [
    {"do": "copy"}, {"do": "copy", "key": ""}, {"do": "copy", "key": None}, {"do": "open"}, {},
    {"do": "pair", "nonce": "no hex"}, {"do": "pair"}])
def test_a_stranger_gets_nothing(ends, hello):
    """Also while no standby is paired, so that an empty key is not the right one."""
    channel, _ = channels.connect(HOST, ends.box.port)
    channel.send(hello)
    with contextlib.suppress(channels.Lost):
        answer = channel.receive()
        assert set(answer) <= {"refused", "nonce"}
        channel.send({"proof": ""})
        assert set(channel.receive()) <= {"refused"}
    channel.close()
    assert not ends.box.is_paired
    assert ends.box._channel is None


def test_a_stranger_cannot_send_much(ends):
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    with context.wrap_socket(socket.create_connection((HOST, ends.box.port))) as connection:
        connection.sendall(LENGTH.pack(MAX_BYTES_OF_STRANGERS + 1))
        assert connection.recv(1) == b""


def test_strangers_that_say_nothing_keep_nobody_out(ends):
    with contextlib.ExitStack() as strangers:
        for _ in range(MAX_STRANGERS):
            strangers.enter_context(socket.create_connection((HOST, ends.box.port)))
        ends.pair()


def test_a_connection_that_cannot_be_accepted(ends, monkeypatch):
    """Later ones are."""
    accept, tried = socket.socket.accept, threading.Event()

    def failing(listening):
        if listening is ends.box._socket and not tried.is_set():
            tried.set()
            raise ConnectionAbortedError
        return accept(listening)

    monkeypatch.setattr(socket.socket, "accept", failing)
    socket.create_connection((HOST, ends.box.port)).close()
    assert tried.wait(60.0)  # the thread was waiting in the real one
    ends.pair()


def test_a_large_message_on_a_slow_network(monkeypatch):
    """It passes some part of it in the time after which an end is lost, but not all."""
    passed = bytearray()

    class Slow:
        settimeout = setsockopt = lambda *_: None

        @staticmethod
        def sendall(data):
            if len(data) > 100_000:
                raise socket.timeout
            passed.extend(data)

    message = {"rows": "x" * 1_000_000}
    channels.Channel(Slow()).send(message)
    assert decode(bytes(passed[LENGTH.size:])) == message


def test_an_answer_that_nobody_waits_for_any_more(ends, monkeypatch):
    """It must not be taken for the next one: an entry would be confirmed before the standby has it."""
    monkeypatch.setattr(rows, "PART", 5)
    ends.pair()
    ends.follow()
    ends.wait_connected()
    for number in range(12):
        ends.writer.entry("/notification", number)
    missing, reads = rows.JournalRows.missing, []

    def failing(*args):
        reads.append(1)
        if len(reads) == 2:
            raise rows.CannotReadJournal("disk I/O error")
        return missing(*args)

    monkeypatch.setattr(rows.JournalRows, "missing", failing)
    ends.follower.step()
    assert ends.follower.progress.trouble == "disk I/O error"
    assert ends.is_complete()


@pytest.mark.parametrize("name", ["certificate.pem", "key.pem"])
def test_a_damaged_certificate(ends, name):
    """The box starts. The standby has to be paired again, and says so."""
    ends.pair()
    ends.box.close()
    (ends.log_dir / "standby" / name).write_text("damaged")
    ends.start_box()
    ends.follow()
    assert "another box answers" in ends.states.get(timeout=60.0)


def test_the_code_for_another_standby_is_shown(ends):
    ends.pair()
    assert ends.box.code in ends.events.get(timeout=60.0)


def test_no_box_at_the_address(ends):
    ends.box.close()
    with pytest.raises(CannotPair, match=f"no box answers at {HOST}:{ends.box.port} .*standby_port:="):
        ends.pair()


def test_something_else_at_the_address(ends):
    with socket.socket() as other:
        other.bind((HOST, 0))
        other.listen()
        answering = threading.Thread(target=lambda: other.accept()[0].close())
        answering.start()
        with pytest.raises(CannotPair, match="no box answers at"):
            pair(str(ends.far), *other.getsockname(), "AAAA-AAAA")
        answering.join()


def test_somebody_between_both_ends(ends, monkeypatch):
    """They have another certificate. They can pass all messages on, but the proofs do not fit."""
    real = standby_end.connect

    def between(host, port):
        channel, _ = real(host, port)
        return channel, b"another certificate"

    monkeypatch.setattr(standby_end, "connect", between)
    with pytest.raises(CannotPair):
        ends.pair()
    assert not ends.box.is_paired


def test_a_box_that_does_not_know_the_code(ends, monkeypatch):
    monkeypatch.setattr("roah_rsbb.standby.box_end.Codes.take", lambda *_: "0" * 64)
    with pytest.raises(CannotPair, match="is not the box that shows this code"):
        ends.pair()
    assert read_box(str(ends.far)) is None


def test_another_box_at_the_address_gets_no_key(ends):
    ends.pair()
    ends.box.close()
    for path in (ends.log_dir / "standby").glob("*.pem"):
        path.unlink()
    ends.start_box()
    ends.follow()
    assert "another box answers" in ends.states.get(timeout=60.0)
    assert not is_alive(read_box(str(ends.far)), 5.0)


def test_whether_the_box_is_alive(ends):
    box = ends.pair()
    assert is_alive(box, 5.0)
    ends.box.close()
    assert not is_alive(box, 5.0)


def test_secrets_are_for_their_owner(ends):
    ends.pair()
    files = [ends.far / "box.json", *(ends.log_dir / "standby").iterdir()]
    assert len(files) == 4
    assert {path.stat().st_mode & 0o077 for path in files} == {0}


# -- after a takeover ---------------------------------------------------------------------------------


def taken_over(ends):
    """Pair, copy, and take over: the folder of the standby is the log_dir of a box now."""
    box = ends.pair()
    end = ends.follow()
    ends.wait_connected()
    ends.writer.entry("/notification", "now")
    assert ends.is_complete()
    end.end()
    ends.follower.close()
    raise_epoch(str(ends.far / FILE_NAME), 0.0, "second")
    write_standby(str(ends.far), PairedStandby("first", hashed(rejoin_key(hashed(box.key))), HOST, box.port))


def heard_by(core, log_dir):
    """The next word that a core at this socket hears, from the partner of the box in `log_dir`."""
    core.settimeout(60.0)
    secrets = {name: partner.secret for name, partner in partners_of(str(log_dir)).items()}
    return unseal(secrets, core.recv(1024))[1]


@pytest.fixture
def core():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as made:
        made.bind((HOST, 0))
        yield made


def test_words_pass_in_both_directions(ends, core):
    """The new box speaks to the old one, and learns what that one says."""
    taken_over(ends)
    old = Herald(str(ends.log_dir), core.getsockname())
    ends.box._on_word = old.answer
    new = Herald(str(ends.far), core.getsockname())
    new.say()
    to_old, to_new = heard_by(core, ends.log_dir), heard_by(core, ends.far)
    assert (to_old.side, to_old.epoch, to_old.claims, to_old.cut) == (Side.STANDBY, 2, True, 1)
    assert (to_new.side, to_new.epoch, to_new.claims) == (Side.BOX, 1, True)
    assert is_alive(read_box(str(ends.far)), 5.0)
    ends.writer.entry(kinds.EPOCH, superseded_value(2, 1, HOST), port=None)
    assert not is_alive(read_box(str(ends.far)), 5.0)


def test_a_word_of_a_stranger_is_not_passed_on(ends, core):
    ends.pair()
    assert Herald(str(ends.log_dir), core.getsockname()).answer(b"nonsense") == b""
    core.setblocking(False)
    with pytest.raises(BlockingIOError):
        core.recv(1024)


def test_the_old_box_becomes_the_new_standby(ends, tmp_path):
    taken_over(ends)
    ends.writer.entry("/notification", "only in the old journal")
    before = contents(ends.log_dir)
    ends.box.close()
    old, ends.log_dir, ends.far = ends.log_dir, ends.far, tmp_path / "third"
    ends.start_box()
    ends.follower.step()
    assert "'standby rejoin' on the computer that was the box" in ends.follower.progress.trouble
    rejoin(str(old), str(ends.far))
    ends.follow()
    ends.wait_connected()
    assert ends.is_complete()
    assert contents(old) == before, "nothing is merged"


def test_only_the_box_that_took_over_can_be_rejoined(ends, tmp_path):
    with pytest.raises(CannotPair, match="is not the log_dir of a box that had a standby"):
        rejoin(str(ends.log_dir), str(tmp_path / "third"))
    ends.pair()
    with pytest.raises(CannotPair, match="is not the box that took over"):
        rejoin(str(ends.log_dir), str(tmp_path / "third"))
    assert not (tmp_path / "third").exists()


def test_a_superseded_box_gives_no_copy(ends):
    """It would replace the journal of its successor."""
    box = ends.pair()
    ends.writer.entry(kinds.EPOCH, superseded_value(2, 1, HOST), port=None)
    channel, _ = channels.connect(HOST, ends.box.port)
    channel.send({"do": "copy", "key": box.key})
    assert "superseded" in channel.receive()["refused"]
    channel.close()


def test_a_box_notes_where_its_standby_is(ends):
    ends.pair()
    write_standby(str(ends.log_dir), read_standby(str(ends.log_dir))._replace(host="", port=0))
    ends.follow()
    ends.wait_connected()
    found = read_standby(str(ends.log_dir))
    assert (found.host, found.port) == (HOST, ends.box.port)
