"""Both ends over real connections on the loopback: pairing, keys, and what strangers get."""

import contextlib
import errno
import hashlib
import json
import os
import queue
import socket
import ssl
import subprocess
import sys
import threading

import pytest

import roah_rsbb
from helpers.copied import contents
from helpers.journals import Writer
from helpers.small_disk import CannotMount, SmallDisk
from roah_rsbb.ground import durable
from roah_rsbb.journal import log
from roah_rsbb.journal.contents import superseded_value
from roah_rsbb.journal.copy_folder import CannotReadJournal
from roah_rsbb.journal.copy_follower import Follower, JournalSegments
from roah_rsbb.journal.epochs import raise_epoch
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.journal.records import Kind
from roah_rsbb.standby import channel as channels
from roah_rsbb.standby import standby_end
from roah_rsbb.standby.box_end import MAX_STRANGERS, REPLACED_S, BoxEnd, Herald
from roah_rsbb.standby.channel import LENGTH, MAX_BYTES_OF_STRANGERS, decode
from roah_rsbb.standby.pair import Side, hashed, rejoin_key, unseal
from roah_rsbb.standby.pairing import (
    MAX_GUESSES,
    VALID_S,
    PairedStandby,
    command,
    make_code,
    partners_of,
    read_box,
    read_standby,
    write_standby,
)
from roah_rsbb.standby.remote import CoreState
from roah_rsbb.standby.standby_end import CannotPair, StandbyEnd, is_alive, pair, rejoin

HOST = "127.0.0.1"
# A standby in a process of its own, until a line comes.
FOLLOW = """
import json, sys, threading
sys.path[:], package = json.loads(sys.argv[1])
import roah_rsbb
roah_rsbb.__path__ = package
from roah_rsbb.standby.standby_end import StandbyEnd, pair
folder, host, port, code = sys.argv[2:]
end = StandbyEnd(folder, pair(folder, host, int(port), code), lambda state: print(state, flush=True))
threading.Thread(target=end.run, daemon=True).start()
sys.stdin.readline()
end.end()
"""


@pytest.fixture(name="proofs", autouse=True)
def _proofs(monkeypatch):
    """Proofs of a code that take no time, until a test undoes this."""
    real = hashlib.scrypt
    with monkeypatch.context() as proofs:
        proofs.setattr(hashlib, "scrypt", lambda *given, **how: real(*given, **{**how, "n": 2}))
        yield proofs


class Ends:
    """A box with a journal, and the folder of a standby."""

    def __init__(self, folder):
        self.log_dir, self.far = folder / "log", folder / "far"
        self.writer = Writer(self.log_dir)
        self.events = queue.Queue()
        self.states = queue.Queue()
        self.core = CoreState()
        self.taken = threading.Event()
        self.heard = queue.Queue()
        self.takes_over = True
        self.utc = 1e9
        self._cleanup = contextlib.ExitStack()
        self._cleanup.callback(self.writer.journal.close)
        self.box = None
        self.start_box()

    def start_box(self):
        port = 0 if self.box is None else self.box.port
        self.box = BoxEnd(str(self.log_dir), HOST, port, self.events.put, core=lambda: self.core,
                          on_taken=self.taken.set, utc=lambda: self.utc)
        self._cleanup.callback(self.box.close)
        self.follower = Follower(str(self.log_dir), self.box.open_copy)
        self._cleanup.callback(self.follower.close)

    def code(self):
        return make_code(str(self.log_dir), lambda: self.utc)

    def pair(self, code=None):
        return pair(str(self.far), HOST, self.box.port, code or self.code())

    def follow(self):
        """Start a standby; returns its end."""
        end = StandbyEnd(str(self.far), read_box(str(self.far)), self.states.put, lambda: self.heard.put("heard"),
                         on_hand_over=lambda: self.takes_over)
        thread = threading.Thread(target=end.run, daemon=True)
        thread.start()
        self._cleanup.callback(thread.join, 60.0)
        self._cleanup.callback(end.end)
        self.join = lambda: thread.join(60.0)
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


def test_a_standby_is_paired_once(ends):
    """Both ends may restart: the certificate and the key stay."""
    ends.pair()
    ends.box.close()
    ends.start_box()
    assert ends.box.is_paired and ends.box.name == f"{socket.gethostname()} at {HOST}"
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
    assert ends.follower.progress.missing_bytes > 0
    ends.start_box()
    ends.wait_connected()
    assert ends.is_complete()


def test_a_standby_that_is_lost_is_not_connected(ends):
    """Nothing is handed over to it."""
    ends.pair()
    end = ends.follow()
    ends.wait_connected()
    assert ends.is_complete() and ends.box.is_connected
    end.end()
    ends.join()
    ends.writer.entry("/notification", "now")
    ends.follower.step()
    assert "the standby is not connected" in ends.follower.progress.trouble
    assert not ends.box.is_connected


def test_the_copy_of_a_hung_core_does_not_speak_for_it(ends):
    """The copy is kept and the connection is alive, but the box is not heard."""
    ends.pair()
    ends.follow()
    ends.wait_connected()
    assert ends.is_complete() and ends.heard.get(timeout=60.0)
    ends.core = CoreState(is_alive=False)
    assert ends.is_complete(), "the standby hears of it at once"
    while ends.states.get(timeout=60.0) != f"the core of the box at {HOST} does not answer":
        pass
    while not ends.heard.empty():
        ends.heard.get()
    ends.writer.entry("/notification", "written before it hung")
    assert ends.is_complete() and ends.heard.empty()
    ends.core = CoreState()
    assert ends.is_complete() and ends.heard.get(timeout=60.0)
    assert ends.states.get(timeout=60.0) == ""


@pytest.mark.parametrize("takes_over", [True, False])
def test_the_box_hands_over(ends, takes_over):
    ends.pair()
    end = ends.follow()
    ends.wait_connected()
    ends.takes_over = takes_over
    assert ends.is_complete() and not ends.taken.is_set()
    ends.core = CoreState(is_alive=False, hand_over=True)
    assert ends.is_complete()
    assert ends.taken.is_set() == takes_over
    if takes_over:
        ends.join()
        assert end.was_handed_over, "it follows nobody any more"
    else:
        assert ends.is_complete() and not end.was_handed_over


def test_the_word_of_a_computer_whose_core_hangs_does_not_claim(ends):
    """A takeover by command is not refused because of it."""
    box = ends.pair()
    ends.follow()
    ends.wait_connected()
    is_hung = []
    herald = Herald(str(ends.log_dir), (HOST, 9), lambda: not is_hung)
    ends.box.close()
    ends.box = BoxEnd(str(ends.log_dir), HOST, ends.box.port, ends.events.put, herald.answer)
    ends._cleanup.callback(ends.box.close)
    assert is_alive(box, 5.0)
    is_hung.append(1)
    assert not is_alive(box, 5.0)


def test_a_standby_that_was_never_connected(ends):
    ends.follower.step()
    assert "no standby is paired yet" in ends.follower.progress.trouble
    ends.pair()
    ends.follower.step()
    assert "the standby is not connected" in ends.follower.progress.trouble


def test_a_wrong_code(ends):
    code = ends.code()
    with pytest.raises(CannotPair, match="the code is wrong"):
        ends.pair("AAAA-AAAA")
    assert not ends.box.is_paired and read_box(str(ends.far)) is None
    assert "tried to be paired as the standby, with a wrong code" in ends.events.get(timeout=60.0)
    ends.pair(code)


def test_a_code_is_used_once_and_for_some_guesses(ends):
    code = ends.code()
    for _ in range(MAX_GUESSES):
        with pytest.raises(CannotPair):
            ends.pair("AAAA-AAAA")
    with pytest.raises(CannotPair):
        ends.pair(code)
    code = ends.code()
    ends.pair(code)
    with pytest.raises(CannotPair):
        ends.pair(code)


def test_a_code_that_cannot_be_removed_is_used_once(ends, monkeypatch):
    """Such as on a disk that is read-only."""
    code = ends.code()
    with monkeypatch.context() as patch:
        patch.setattr("roah_rsbb.standby.pairing.os.unlink", lambda path: os.stat(f"{path}/"))
        ends.pair(code)
    assert "code.json" in os.listdir(ends.box.folder)
    with pytest.raises(CannotPair):
        ends.pair(code)


@pytest.mark.parametrize("age", [-1.0, VALID_S])
def test_there_is_a_code_for_some_minutes_only(ends, age):
    code = ends.code()
    ends.utc += age
    with pytest.raises(CannotPair, match="is not valid any more. 'standby code' on the box makes a new one"):
        ends.pair(code)
    ends.utc += VALID_S - 1.0 - age
    ends.pair(code)


def test_without_a_code_nobody_is_paired_and_nothing_is_logged(ends):
    """A stranger cannot fill the log, nor make the box compute."""
    for code in ("AAAA-AAAA", " "):
        with pytest.raises(CannotPair, match="the code is wrong"):
            ends.pair(code)
    assert not ends.box.is_paired and ends.events.empty()


@pytest.mark.parametrize("content", ["", "{", "[]", '{"code": "AAAA-AAAA"}', '{"code": "AAAA-AAAA", "utc": "x"}'])
def test_a_damaged_code(ends, content):
    (ends.log_dir / "standby" / "code.json").write_text(content)
    with pytest.raises(CannotPair, match="the code is wrong"):
        ends.pair("AAAA-AAAA")


def test_no_code_is_logged_or_reported(ends):
    """Every user of the computer can read the log, and whoever reaches the ROS master reads the topics."""
    used = [ends.code() for _ in range(2)]
    ends.follower.step()
    reported = [ends.follower.progress.trouble]
    assert f"Enter on the box: {command(ends.log_dir)}" in reported[0]
    for code in used[1], None:
        ends.pair(code)
        reported += [ends.events.get(timeout=60.0), ends.box.notice, ends.box.name]
    ends.follow()
    reported.append(ends.events.get(timeout=60.0))
    used.append(ends.code())
    assert not any(code in text for code in used for text in reported)


def test_a_new_standby_replaces_the_old_one(ends):
    first = ends.pair()
    ends.pair()
    channel, _ = channels.connect(HOST, ends.box.port)
    channel.send({"do": "copy", "key": first.key})
    assert "another one was paired" in channel.receive()["refused"]
    channel.close()


def name_standby(ends, monkeypatch, name):
    monkeypatch.setattr(standby_end.socket, "gethostname", lambda: name)
    ends.pair()


def test_every_referee_reads_that_a_standby_was_replaced(ends, monkeypatch):
    name_standby(ends, monkeypatch, "second")
    assert ends.box.notice == "" and ends.events.get(timeout=60.0) == f"The standby second at {HOST} is paired"
    name_standby(ends, monkeypatch, "stranger")
    assert ends.box.notice.startswith(f"The standby is stranger at {HOST} now, instead of second at {HOST}. If none of")
    assert ends.events.get(timeout=60.0) == ends.box.notice
    ends.utc += REPLACED_S - 1.0
    # Also after a restart, and after another pairing, which must not hide the first one.
    ends.box.close()
    ends.start_box()
    assert "stranger" in ends.box.notice
    name_standby(ends, monkeypatch, "disguise")
    assert f"disguise at {HOST} now, instead of second at {HOST}" in ends.box.notice
    ends.utc += REPLACED_S
    assert ends.box.notice == ""
    name_standby(ends, monkeypatch, "third")
    assert f"third at {HOST} now, instead of disguise at {HOST}" in ends.box.notice


def test_a_standby_that_connects_while_another_one_is_paired(ends, monkeypatch):
    """Its key was right, but is not any more: it gets nothing."""
    first = ends.pair()
    send = channels.Channel.send
    is_sent = threading.Event()

    def pair_before(channel, message):
        if message == {}:
            monkeypatch.setattr(channels.Channel, "send", send)
            ends.pair()
            is_sent.set()
        send(channel, message)

    monkeypatch.setattr(channels.Channel, "send", pair_before)
    channel, _ = channels.connect(HOST, ends.box.port)
    send(channel, {"do": "copy", "key": first.key})
    assert channel.receive() == {} and is_sent.is_set()
    with pytest.raises(channels.Lost):
        channel.receive()
    channel.close()
    assert not ends.box.is_connected


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

    message = {"content": b"x" * 1_000_000}
    channels.Channel(Slow()).send(message)
    assert decode(bytes(passed[LENGTH.size:])) == message


def test_a_journal_that_cannot_be_read_does_not_end_the_connection(ends, monkeypatch):
    ends.pair()
    ends.follow()
    ends.wait_connected()
    for number in range(12):
        ends.writer.entry("/notification", number)

    def failing(*args):
        yield next(parts(*args))._replace(is_last=False)
        raise CannotReadJournal("disk I/O error")

    parts = JournalSegments.parts
    with monkeypatch.context() as patch:
        patch.setattr(JournalSegments, "parts", failing)
        ends.follower.step()
        assert ends.follower.progress.trouble == "disk I/O error"
    assert ends.is_complete()
    assert ends.events.empty(), "the standby was connected all the time"


def test_a_standby_whose_disk_is_full_stays_connected_and_catches_up(ends, monkeypatch):
    ends.pair()
    ends.follow()
    ends.wait_connected()
    assert ends.is_complete()
    write, is_full = log.Files.write, True

    def write_if_possible(fd, content, at):
        if is_full and str(ends.far) in os.readlink(f"/proc/self/fd/{fd}"):
            raise OSError(errno.ENOSPC, "No space left on device")
        write(fd, content, at)

    monkeypatch.setattr(log.Files, "write", staticmethod(write_if_possible))
    for _ in range(3):
        ends.writer.entry("/notification", "now")
        ends.follower.step()
        assert ends.follower.progress.trouble == f"the standby reports: the disk is full. Free space for {ends.far}"
    is_full = False
    assert ends.is_complete()
    assert ends.events.empty(), "the standby was connected all the time"
    states = [ends.states.get(timeout=60.0) for _ in range(3)]
    assert states == ["", f"the disk is full. Free space for {ends.far}", ""], "each state once"


@pytest.mark.parametrize("breaks", [True, False], ids=("ext4", "tmpfs"))
def test_a_disk_of_a_standby_that_is_full(ends, tmp_path, breaks, proofs):
    proofs.undo()  # the standby is a process of its own
    try:
        disk = SmallDisk(ends.far, 6000, breaks)
    except (CannotMount, OSError) as error:
        pytest.skip(f"no file system can be mounted here: {error}")
    program = [*disk.inside, sys.executable, "-c", FOLLOW, json.dumps([sys.path, list(roah_rsbb.__path__)]),
               str(ends.far), HOST, str(ends.box.port), ends.code()]
    with contextlib.ExitStack() as cleanup:
        cleanup.callback(disk.close)
        running = subprocess.Popen(program, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   text=True)
        cleanup.callback(lambda: running.communicate("\n"))
        states = iter(running.stdout.readline, "")
        ends.wait_connected()
        ends.follower.step()
        assert next(states) == "\n"
        disk.fill(leave=20_000)
        for _ in range(3):
            for _ in range(100):
                ends.writer.entry("/notification", "x" * 300)
            ends.follower.step()
            assert ends.follower.progress.trouble == f"the standby reports: the disk is full. Free space for {ends.far}"
            disk.fill()
        assert next(states) == f"the disk is full. Free space for {ends.far}\n"
        disk.free()
        ends.follower.step()
        assert not ends.follower.progress.trouble
        assert next(states) == "\n"
        assert running.poll() is None
        assert ends.events.empty(), "the standby was connected all the time"


def test_a_full_disk_replaces_no_standby(ends, monkeypatch):
    """The box would have a new standby that does not know its key."""
    ends.pair()
    before = read_standby(str(ends.log_dir))
    monkeypatch.setattr(durable, "has_space", lambda folder: False)
    with pytest.raises(CannotPair, match="the disk is full: free space for"):
        ends.pair()
    assert read_standby(str(ends.log_dir)) == before


@pytest.mark.parametrize("name", ["certificate.pem", "key.pem"])
def test_a_damaged_certificate(ends, name):
    """The box starts. The standby has to be paired again, and says so."""
    ends.pair()
    ends.box.close()
    (ends.log_dir / "standby" / name).write_text("damaged")
    ends.start_box()
    ends.follow()
    assert "another box answers" in ends.states.get(timeout=60.0)


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
    monkeypatch.setattr("roah_rsbb.standby.pairing.PairingCode.take", lambda *_: "0" * 64)
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
    ends.code()
    files = [ends.far / "box.json", *(ends.log_dir / "standby").iterdir()]
    assert len(files) == 5
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
    raise_epoch(str(ends.far / JOURNAL), 0.0, "second")
    write_standby(str(ends.far), PairedStandby("the box before", hashed(rejoin_key(hashed(box.key))), HOST, box.port,
                                               is_awaited=True))


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
    assert (to_old.side, to_old.epoch, to_old.claims, to_old.cut) == (Side.STANDBY, 2, True, 2)
    assert (to_new.side, to_new.epoch, to_new.claims) == (Side.BOX, 1, True)
    assert is_alive(read_box(str(ends.far)), 5.0)
    ends.writer.entry(Kind.EPOCH, superseded_value(2, 1, HOST), port=None)
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
    # It runs, and connects by itself: nobody has to make it the standby again.
    ends.box.close()
    ends.start_box()
    ends.follower.step()
    assert ends.follower.progress.trouble.startswith("the standby is not connected. It connects by itself")


def test_another_standby_of_a_box_that_took_over(ends, tmp_path):
    """It was paired, so nobody has to make the old box the standby."""
    taken_over(ends)
    ends.box.close()
    ends.log_dir, ends.far = ends.far, tmp_path / "third"
    ends.start_box()
    ends.pair()
    assert f"instead of the box before at {HOST}" in ends.box.notice
    ends.follower.step()
    assert ends.follower.progress.trouble.startswith("the standby is not connected. It connects by itself")


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
    ends.writer.entry(Kind.EPOCH, superseded_value(2, 1, HOST), port=None)
    channel, _ = channels.connect(HOST, ends.box.port)
    channel.send({"do": "copy", "key": box.key})
    assert "superseded" in channel.receive()["refused"]
    channel.close()


def test_a_box_notes_where_its_standby_is(ends):
    ends.pair()
    write_standby(str(ends.log_dir), read_standby(str(ends.log_dir))._replace(host="", port=0))
    ends.box.close()
    ends.start_box()
    ends.follow()
    ends.wait_connected()
    found = read_standby(str(ends.log_dir))
    assert (found.host, found.port) == (HOST, ends.box.port)
