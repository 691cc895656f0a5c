"""The standby's end: connects to the box, pairs once, and keeps the copy."""

import contextlib
import secrets
import socket
import threading
from typing import Callable, Optional, Tuple

from roah_rsbb.ground import durable
from roah_rsbb.journal.contents import FIRST
from roah_rsbb.standby.channel import ANY_HOST, MAX_BYTES_OF_STRANGERS, BadMessage, Channel, Lost, connect
from roah_rsbb.standby.pair import Side, Word, hashed, is_same, pair_name, rejoin_key, rejoin_proof, seal, unseal
from roah_rsbb.standby.pairing import (
    BOX,
    NONCE_BYTES,
    STANDBY,
    Exchange,
    PairedBox,
    PairedStandby,
    read_standby,
    write_box,
)
from roah_rsbb.standby.remote import OPEN, TAKES_OVER, CoreState, Receiver

RETRY_S = 1.0


class CannotPair(Exception):
    """The standby cannot use this box. The text says why, and what to do. Another attempt needs the organiser."""


def pair(folder: str, host: str, port: int, code: str) -> PairedBox:
    """Pair with a box, and save that. Raises `CannotPair` or OSError."""
    if not durable.has_space(folder):  # the box would forget its standby for one that cannot save the key
        raise CannotPair(f"the disk is full: free space for {folder}")
    channel, fingerprint = _connect(host, port)
    try:
        nonce = secrets.token_bytes(NONCE_BYTES)
        channel.send({"do": "pair", "name": socket.gethostname(), "nonce": nonce.hex()})
        exchange = Exchange(fingerprint, nonce, bytes.fromhex(str(channel.receive(MAX_BYTES_OF_STRANGERS)["nonce"])))
        channel.send({"proof": exchange.proof(code, STANDBY)})
        answer = channel.receive(MAX_BYTES_OF_STRANGERS)
        if "refused" in answer:
            raise CannotPair(str(answer["refused"]))
        if not is_same(exchange.proof(code, BOX), str(answer.get("proof"))):
            raise CannotPair(f"{host} is not the box that shows this code: check the address and the network")
        box = PairedBox(host, port, fingerprint.hex(), str(answer["key"]))
    except (BadMessage, KeyError, ValueError):
        raise CannotPair(f"{host}:{port} does not answer as a box does: check the address and the port") from None
    except Lost as error:
        raise CannotPair(f"the connection to {host}:{port} ended ({error}): check the network, and try again") from None
    finally:
        channel.close()
    write_box(folder, box)
    return box


def rejoin(log_dir: str, folder: str) -> PairedBox:
    """Make the box that has its journal in `log_dir` the standby of the box that took over from it.

    `folder`: of the new copy. Raises `CannotPair` or OSError.
    """
    standby: Optional[PairedStandby] = read_standby(log_dir)
    if standby is None or not standby.host:
        raise CannotPair(f"{log_dir} is not the log_dir of a box that had a standby")
    channel, fingerprint = _connect(standby.host, standby.port)
    try:
        nonce = secrets.token_bytes(NONCE_BYTES)
        channel.send({"do": "rejoin", "pair": pair_name(standby.key_sha256), "nonce": nonce.hex()})
        answer = channel.receive(MAX_BYTES_OF_STRANGERS)
    except (BadMessage, Lost):
        answer = {}
    finally:
        channel.close()
    if not is_same(rejoin_proof(standby.key_sha256, nonce, fingerprint), str(answer.get("proof"))):
        raise CannotPair(f"{standby.host}:{standby.port} is not the box that took over from this one: pair with the "
                         "present box, with a new code")
    box = PairedBox(standby.host, standby.port, fingerprint.hex(), rejoin_key(standby.key_sha256))
    write_box(folder, box)
    return box


def _connect(host: str, port: int) -> Tuple[Channel, bytes]:
    try:
        return connect(host, port)
    except Lost as error:
        raise CannotPair(f"no box answers at {host}:{port} ({error}). Check the address and the cable, and that the "
                         f"box was started with standby_port:={port}") from None


def is_alive(box: PairedBox, timeout: float) -> bool:
    """Whether the box of the standby answers at its address, and claims to be the box."""
    secret = hashed(box.key)
    try:
        channel, fingerprint = connect(box.host, box.port, timeout)
    except Lost:
        return False
    try:
        if fingerprint.hex() != box.fingerprint:
            return False
        channel.send({"do": "word", "word": seal(secret, Word(Side.STANDBY, FIRST, claims=False)).decode("ascii")})
        answer = str(channel.receive(MAX_BYTES_OF_STRANGERS).get("word")).encode("ascii", "replace")
    except (Lost, BadMessage):
        return True
    finally:
        channel.close()
    heard = unseal({pair_name(secret): secret}, answer)
    return heard is None or heard[1].claims


def is_open(host: str, port: int, timeout: float) -> bool:
    """Whether a box, or anything else, answers there."""
    try:
        channel, _ = connect(host, port, timeout)
    except Lost:
        return False
    channel.close()
    return True


class StandbyEnd:
    """Keeps the copy. Call `run` in one thread."""

    def __init__(
        self, folder: str, box: PairedBox, on_state: Callable[[str], None], on_heard: Callable[[], None] = lambda: None,
        bind_host: str = ANY_HOST, on_hand_over: Callable[[], bool] = lambda: False,
    ) -> None:
        """`on_state` is called with each change of the state: what is wrong, or empty if the copy is kept.

        `on_heard` is called with each message of the box while its core answers. `bind_host`: own address, which the
        box notes. `on_hand_over` is called when the box's computer hands over, and returns whether this one can be
        the box. Then `run` ends.
        """
        self._bind_host = bind_host
        self._on_heard, self._on_hand_over = on_heard, on_hand_over
        self.was_handed_over = False  # the box's computer knows that this one is the box now
        self._box = box
        self._receiver = Receiver(folder)
        self._on_state = on_state
        self._state: Optional[str] = None
        self._channel: Optional[Channel] = None
        self._connecting: Optional[socket.socket] = None
        self._ended = threading.Event()

    def run(self) -> None:
        """Keep the copy until `end` is called. Raises `CannotPair` if the box refuses this standby."""
        try:
            while not self._ended.is_set():
                self._report(self._follow())
                self._ended.wait(RETRY_S)
        finally:
            self._receiver.close()

    def end(self) -> None:
        """From any thread: end `run`."""
        self._ended.set()
        connecting, channel = self._connecting, self._channel
        if connecting is not None:
            with contextlib.suppress(OSError):
                connecting.shutdown(socket.SHUT_RDWR)
        if channel is not None:
            channel.close()

    def _follow(self) -> str:
        """Serve the box until the connection ends; returns why it ended."""
        host = self._box.host
        try:
            self._channel, fingerprint = connect(
                host, self._box.port, source=self._bind_host, on_socket=self._on_socket)
        except Lost as error:
            return f"the box at {host} does not answer ({error})"
        channel = self._channel
        try:
            if fingerprint.hex() != self._box.fingerprint:
                return f"another box answers at {host}: pair with it, or check the network"
            channel.send({"do": "copy", "key": self._box.key})
            answer = channel.receive(MAX_BYTES_OF_STRANGERS)
            if "refused" in answer:
                raise CannotPair(str(answer["refused"]))
            while True:
                request = channel.receive()
                core = CoreState(bool(request.get("is_alive", True)), bool(request.get("hand_over", False)))
                if core.is_alive:
                    self._on_heard()
                answer = self._receiver.answer(request)
                if core.hand_over and "error" not in answer and self._on_hand_over():
                    answer[TAKES_OVER] = True
                channel.send(answer)
                if answer.get(TAKES_OVER):
                    self.was_handed_over = True
                    self._ended.set()
                    return ""
                # A copy that can be opened need not be writable: the disk may be full.
                if not core.is_alive and "error" not in answer:
                    self._report(f"the core of the box at {host} does not answer")
                elif "error" in answer or request.get("do") != OPEN:
                    self._report(str(answer.get("error", "")))
        except (Lost, BadMessage) as error:
            return f"the connection to the box at {host} ended ({error})"
        finally:
            channel.close()
            self._receiver.close()

    def _on_socket(self, connecting: socket.socket) -> None:
        self._connecting = connecting
        if self._ended.is_set():
            raise Lost("it is not needed any more")

    def _report(self, state: str) -> None:
        if state != self._state and not self._ended.is_set():
            self._state = state
            self._on_state(state)
