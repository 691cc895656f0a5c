"""The box's end: waits for a standby, pairs with it, and gives it the copy of the journal.

It runs in threads of its own, in a process of its own: the core never waits for a standby.
"""

import contextlib
import os
import secrets
import socket
import ssl
import threading
import time
from typing import Callable, List, Optional, Tuple

from roah_rsbb.journal import epochs
from roah_rsbb.journal.copy_folder import CannotWriteCopy
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.model.reason import say
from roah_rsbb.standby import pairing
from roah_rsbb.standby.channel import (
    MAX_BYTES_OF_STRANGERS,
    TIMEOUT_S,
    BadMessage,
    Channel,
    Lost,
    Message,
    box_context,
    connect,
    wake,
)
from roah_rsbb.standby.pair import Side, Word, hashed, is_same, rejoin_proof, seal, unseal
from roah_rsbb.standby.pairing import (
    FOLDER,
    KEY_BYTES,
    NONCE_BYTES,
    Exchange,
    PairedStandby,
    Partner,
    partners_of,
    read_standby,
    write_standby,
)
from roah_rsbb.standby.remote import CoreState, RemoteCopy

# Connections of strangers that are served at a time.
MAX_STRANGERS = 8
# The system may refuse to accept a connection: one that was given up, or no file descriptor is left.
ACCEPT_AGAIN_S = 0.1
MAX_NAME = 60
# Referees are warned for this long of a standby that replaced another one.
REPLACED_S = 1800.0
_NOT_CONNECTED = say("the standby is not connected. It connects by itself: check that it runs, and its cable")
_NONE_YET = say("no standby is connected since this computer took over. Enter 'standby rejoin' on the computer that "
                "was the box, or pair another computer")
_NOT_PAIRED = say("no standby is paired yet. Enter on the box: {command}")
_BROKEN = say("{why} ({error})")
_REPLACED = say("The standby is {standby} now, instead of {other}. If none of you paired it, a stranger has all "
                "results and passwords: pair your standby again, and give the teams new passwords")


class BoxEnd:
    """Serves one standby."""

    def __init__(
        self, log_dir: str, host: str, port: int, on_event: Callable[[str], None],
        on_word: Callable[[bytes], bytes] = lambda word: b"", core: Callable[[], CoreState] = CoreState,
        on_taken: Callable[[], None] = lambda: None, utc: Callable[[], float] = time.time,
    ) -> None:
        """`on_event` is called in any thread with a text for the log, and `on_word` with a word of an end of a pair; it
        returns the answer, or nothing. `core` returns the state of the core, and `on_taken` is called when the standby
        becomes the box, because it was handed over. `utc`: UTC seconds. Raises OSError."""
        self._log_dir = log_dir
        self._core, self._on_taken = core, on_taken
        self._on_word = on_word
        self.folder = os.path.join(log_dir, FOLDER)
        os.makedirs(self.folder, mode=0o700, exist_ok=True)
        self._context, self._fingerprint = box_context(self.folder)
        self._on_event = on_event
        self._utc = utc
        self._codes = pairing.PairingCode(log_dir, utc)
        self._lock = threading.Lock()  # of codes, the pairing and the channel
        self._channel: Optional[Channel] = None
        self._strangers = _Strangers()
        self._ended = threading.Event()
        self._standby = read_standby(log_dir)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            self._socket.bind((host, port))
            self._socket.listen(MAX_STRANGERS)
        except OSError as error:
            self._socket.close()
            raise OSError(f"{host}, TCP port {port}, where a standby connects: {error.strerror}. End the program that "
                          "has it, or start the box with another standby_port") from None
        self.port = self._socket.getsockname()[1]
        threading.Thread(target=self._accept, name="standby", daemon=True).start()

    @property
    def is_connected(self) -> bool:
        """Whether the standby is connected."""
        return self._channel is not None

    @property
    def is_paired(self) -> bool:
        """Whether there is a standby, which may be off."""
        return self._standby is not None and bool(self._standby.key_sha256)

    @property
    def name(self) -> str:
        """Name and address of the standby; empty: there is none."""
        return self._standby.described if self.is_paired else ""

    @property
    def notice(self) -> str:
        """What every referee must know of the pairing; empty: nothing. It is shown for `REPLACED_S`."""
        standby = self._standby
        if not self.is_paired or not self._is_replaced_lately(standby):
            return ""
        return _REPLACED(standby=standby.described, other=standby.replaced)

    def close(self) -> None:
        """End all connections."""
        self._ended.set()
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()
        self._end_channel()

    def open_copy(self) -> RemoteCopy:
        """Open the copy on the standby. Raises `CannotWriteCopy`."""
        with self._lock:
            channel = self._channel
        if not self.is_paired:
            raise CannotWriteCopy(_NOT_PAIRED(command=pairing.command(self._log_dir)))
        if channel is None:
            raise CannotWriteCopy(_NONE_YET if self._standby.is_awaited else _NOT_CONNECTED)
        return RemoteCopy(lambda message: self._ask(channel, message), core=self._core, on_taken=self._on_taken)

    def _ask(self, channel: Channel, message: Message) -> Message:
        try:
            channel.send(message)
            return channel.receive()
        except (Lost, BadMessage) as error:
            self._drop(channel)
            raise CannotWriteCopy(_BROKEN(why=_NOT_CONNECTED, error=str(error))) from None

    # -- strangers, each in a thread ----------------------------------------------------------------

    def _accept(self) -> None:
        while True:
            try:
                plain, (host, _port) = self._socket.accept()
            except OSError:
                if self._ended.wait(ACCEPT_AGAIN_S):
                    return
                continue
            try:
                plain.settimeout(TIMEOUT_S)
                connection = self._context.wrap_socket(plain, server_side=True, do_handshake_on_connect=False)
            except OSError:
                plain.close()
                continue
            self._strangers.add(connection)
            threading.Thread(target=self._serve, args=(connection, host), name="stranger", daemon=True).start()

    def _serve(self, connection: ssl.SSLSocket, host: str) -> None:
        is_known = False
        try:
            connection.do_handshake()
            is_known = self._greet(Channel(connection), host)
        except (Lost, BadMessage, OSError):
            pass
        finally:
            self._strangers.remove(connection)
            if not is_known:
                wake(connection)
                connection.close()

    def _greet(self, channel: Channel, host: str) -> bool:
        """Pair, or recognise the standby; returns whether the channel is in use now."""
        hello = channel.receive(MAX_BYTES_OF_STRANGERS)
        if hello.get("do") == "pair":
            self._pair(channel, hello, host)
            return False
        if hello.get("do") == "word":
            answer = self._on_word(str(hello.get("word")).encode("ascii", "replace"))
            channel.send({"word": answer.decode("ascii")})
            return False
        if hello.get("do") == "rejoin":
            channel.send(self._rejoined(hello))
            return False
        if hello.get("do") != "copy":
            return False
        key_sha256 = hashed(str(hello.get("key")))
        if not self._is_of_standby(key_sha256):
            channel.send({"refused": "this standby is not paired with the box: another one was paired, or none is. "
                                     "On the box, 'standby status' says which one is. Pair it again, with a new code"})
            return False
        if epochs.standing_in(os.path.join(self._log_dir, JOURNAL)).is_superseded:
            channel.send({"refused": "this box is superseded: its journal must not replace the one of its successor"})
            return False
        channel.send({})
        with self._lock:
            if not self._is_of_standby(key_sha256):
                return False  # another one was paired meanwhile
            self._note_host(host)
            name, before, self._channel = self._standby.name, self._channel, channel
        if before is not None:
            before.close()
        self._on_event(f"The standby {name} is connected from {host}")
        return True

    def _is_of_standby(self, key_sha256: str) -> bool:
        return self.is_paired and is_same(key_sha256, self._standby.key_sha256)

    def _note_host(self, host: str) -> None:
        """Save where the standby is: the box asks it before it starts again."""
        noted = self._standby._replace(host=host, port=self.port, is_awaited=False)
        if noted != self._standby:
            self._standby = noted
            with contextlib.suppress(OSError):
                write_standby(self._log_dir, noted)

    def _rejoined(self, hello: Message) -> Message:
        """Prove to the box before a takeover that this box took over."""
        partner = partners_of(self._log_dir).get(str(hello.get("pair")))
        try:
            nonce = bytes.fromhex(str(hello.get("nonce")))
        except ValueError:
            raise BadMessage("nonce") from None
        if partner is None or partner.own_side is not Side.STANDBY or len(nonce) != NONCE_BYTES:
            return {"refused": "this box did not take over from that one"}
        return {"proof": rejoin_proof(partner.secret, nonce, self._fingerprint)}

    def _pair(self, channel: Channel, hello: Message, host: str) -> None:
        nonce = secrets.token_bytes(NONCE_BYTES)
        channel.send({"nonce": nonce.hex()})
        proof = str(channel.receive(MAX_BYTES_OF_STRANGERS).get("proof"))
        try:
            exchange = Exchange(self._fingerprint, bytes.fromhex(str(hello.get("nonce"))), nonce)
        except ValueError:
            raise BadMessage("nonce") from None
        with self._lock:
            had_code = bool(self._codes.valid())
            own = self._codes.take(exchange, proof)
        if not own:
            if had_code:
                self._on_event(f"A computer at {host} tried to be paired as the standby, with a wrong code")
            channel.send({"refused": "the code is wrong, or is not valid any more. 'standby code' on the box makes a "
                                     "new one. A standby that is paired needs no code"})
            return
        key = secrets.token_hex(KEY_BYTES)
        name = _plain(str(hello.get("name"))) or host
        standby = PairedStandby(name, hashed(key), host, self.port, paired_utc=self._utc(), replaced=self._replaced())
        try:
            with self._lock:
                write_standby(self._log_dir, standby)
                self._standby = standby
        except OSError as error:
            channel.send({"refused": f"the box cannot save the pairing: {error.strerror}"})
            return
        self._end_channel()  # an earlier standby is no longer paired
        channel.send({"proof": own, "key": key})
        self._on_event(self.notice or f"The standby {self.name} is paired")

    def _replaced(self) -> str:
        """Return which standby is replaced by the next one. A stranger who is paired twice does not hide the first."""
        standby = self._standby
        if not self.is_paired:
            return ""
        return standby.replaced if self._is_replaced_lately(standby) else standby.described

    def _is_replaced_lately(self, standby: PairedStandby) -> bool:
        return bool(standby.replaced) and abs(self._utc() - standby.paired_utc) < REPLACED_S

    # -- the channel --------------------------------------------------------------------------------

    def _end_channel(self) -> None:
        with self._lock:
            before, self._channel = self._channel, None
        if before is not None:
            before.close()

    def _drop(self, channel: Channel) -> None:
        with self._lock:
            if self._channel is channel:
                self._channel = None
        channel.close()


class _Strangers:
    """Connections that are not the standby's yet. The oldest ends if there are too many, so that connections which say
    nothing keep nobody out."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._connections: List[ssl.SSLSocket] = []

    def add(self, connection: ssl.SSLSocket) -> None:
        """Serve one more."""
        with self._lock:
            self._connections.append(connection)
            if len(self._connections) > MAX_STRANGERS:
                wake(self._connections.pop(0))

    def remove(self, connection: ssl.SSLSocket) -> None:
        """It was served."""
        with self._lock:
            if connection in self._connections:
                self._connections.remove(connection)


def _plain(name: str) -> str:
    return "".join(sign for sign in name if sign.isprintable())[:MAX_NAME].strip()


# -- words over TCP -----------------------------------------------------------------------------------

# It runs in the process that makes the copy. It passes what it hears on to the core of this computer, which decides.

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
