"""The box's end: waits for a standby, pairs with it, and gives it the copy of the journal.

It runs in threads of its own, in a process of its own: the core never waits for a standby.
"""

import contextlib
import os
import secrets
import socket
import ssl
import threading
from typing import Callable, List, Optional, TypeVar

from roah_rsbb.copies.copy import CannotWriteCopy
from roah_rsbb.journal import epochs
from roah_rsbb.journal.file import FILE_NAME
from roah_rsbb.standby.channel import TIMEOUT_S, Channel, Lost, box_context, wake
from roah_rsbb.standby.messages import MAX_BYTES_OF_STRANGERS, BadMessage, Message
from roah_rsbb.standby.pair import Side
from roah_rsbb.standby.pairing import KEY_BYTES, NONCE_BYTES, Codes, Exchange, hashed, is_same
from roah_rsbb.standby.partners import FOLDER, PairedStandby, partners_of, read_box, read_standby, write_standby
from roah_rsbb.standby.remote import RemoteCopy
from roah_rsbb.standby.words import rejoin_proof

T = TypeVar("T")

# Connections of strangers that are served at a time.
MAX_STRANGERS = 8
# The system may refuse to accept a connection: one that was given up, or no file descriptor is left.
ACCEPT_AGAIN_S = 0.1
MAX_NAME = 60
_NOT_CONNECTED = "the standby is not connected. Check that it runs and that its cable is plugged in"
_NONE_YET = ("no standby is connected since this computer took over. Enter 'standby rejoin' on the computer that was "
             "the box, start 'standby follow', or pair another computer")


class BoxEnd:
    """Serves one standby."""

    def __init__(
        self, log_dir: str, host: str, port: int, on_event: Callable[[str], None],
        on_word: Callable[[bytes], bytes] = lambda word: b"",
    ) -> None:
        """`on_event` is called in any thread with a text for the log, and `on_word` with a word of an end of a pair; it
        returns the answer, or nothing. Raises OSError."""
        self._log_dir = log_dir
        self._on_word = on_word
        self.folder = os.path.join(log_dir, FOLDER)
        os.makedirs(self.folder, mode=0o700, exist_ok=True)
        self._context, self._fingerprint = box_context(self.folder)
        self._on_event = on_event
        self._codes = Codes()
        self._lock = threading.Lock()  # of codes, the pairing and the channel
        self._channel: Optional[Channel] = None
        self._was_connected = False
        self._strangers = _Strangers()
        self._ended = threading.Event()
        standby = read_standby(log_dir)
        self.name, self._key_sha256 = ("", "") if standby is None else (standby.name, standby.key_sha256)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            self._socket.bind((host, port))
            self._socket.listen(MAX_STRANGERS)
        except OSError:
            self._socket.close()
            raise
        self.port = self._socket.getsockname()[1]
        threading.Thread(target=self._accept, name="standby", daemon=True).start()

    @property
    def code(self) -> str:
        """The code to pair with."""
        return self._codes.code

    @property
    def is_paired(self) -> bool:
        """Whether there is a standby, which may be off."""
        return bool(self._key_sha256)

    def close(self) -> None:
        """End all connections."""
        self._ended.set()
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()
        self._use(None)

    def open_copy(self) -> RemoteCopy:
        """Open the copy on the standby. Raises `CannotWriteCopy`."""
        with self._lock:
            channel = self._channel
        if not self.is_paired:
            raise CannotWriteCopy("no standby is paired yet. The log of roah_rsbb_backup shows the code")
        if channel is None:
            took_over = read_box(self._log_dir) is not None and not self._was_connected
            raise CannotWriteCopy(_NONE_YET if took_over else _NOT_CONNECTED)
        return RemoteCopy(lambda message: self._doing(channel, lambda: channel.send(message)),
                          lambda: self._doing(channel, channel.receive))

    def _doing(self, channel: Channel, step: Callable[[], T]) -> T:
        try:
            return step()
        except (Lost, BadMessage) as error:
            self._drop(channel)
            raise CannotWriteCopy(f"{_NOT_CONNECTED} ({error})") from None

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
        with self._lock:
            is_right = self.is_paired and is_same(hashed(str(hello.get("key"))), self._key_sha256)
        if not is_right:
            channel.send({"refused": "this standby is not paired with the box: pair it again, with a new code"})
            return False
        if epochs.standing_in(os.path.join(self._log_dir, FILE_NAME)).is_superseded:
            channel.send({"refused": "this box is superseded: its journal must not replace the one of its successor"})
            return False
        channel.send({})
        self._note_host(host)
        self._was_connected = True
        self._use(channel)
        self._on_event(f"The standby {self.name} is connected from {host}")
        return True

    def _note_host(self, host: str) -> None:
        """Save where the standby is: the box asks it before it starts again."""
        standby = read_standby(self._log_dir)
        if standby is not None and (standby.host, standby.port) != (host, self.port):
            with contextlib.suppress(OSError):
                write_standby(self._log_dir, standby._replace(host=host, port=self.port))

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
            own = self._codes.take(exchange, proof)
        if not own:
            self._on_event(f"A standby at {host} used a wrong code. The code is now {self.code}")
            channel.send({"refused": "the code is wrong, or was used before. The box's log shows the present one. A "
                                     "standby that is paired needs no code"})
            return
        key = secrets.token_hex(KEY_BYTES)
        name = _plain(str(hello.get("name"))) or host
        try:
            write_standby(self._log_dir, PairedStandby(name, hashed(key), host, self.port))
        except OSError as error:
            channel.send({"refused": f"the box cannot save the pairing: {error.strerror}"})
            return
        with self._lock:
            self.name, self._key_sha256 = name, hashed(key)
        self._use(None)  # an earlier standby is no longer paired
        channel.send({"proof": own, "key": key})
        self._on_event(f"The standby {name} at {host} is paired. The code for another one is {self.code}")

    # -- the channel --------------------------------------------------------------------------------

    def _use(self, channel: Optional[Channel]) -> None:
        with self._lock:
            before, self._channel = self._channel, channel
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
