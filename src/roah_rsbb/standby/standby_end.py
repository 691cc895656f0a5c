"""The standby's end: connects to the box, pairs once, and keeps the copy."""

import json
import os
import secrets
import socket
import threading
from typing import Callable, NamedTuple, Optional

from roah_rsbb import durable
from roah_rsbb.standby.channel import Channel, Lost, connect
from roah_rsbb.standby.messages import MAX_BYTES_OF_STRANGERS, BadMessage
from roah_rsbb.standby.pairing import BOX, NONCE_BYTES, STANDBY, Exchange, is_same
from roah_rsbb.standby.remote import Receiver

BOX_FILE = "box.json"
RETRY_S = 1.0


class CannotPair(Exception):
    """The standby cannot use this box. The text says why, and what to do. Another attempt needs the organiser."""


class PairedBox(NamedTuple):
    """The box of a standby."""

    host: str
    port: int
    fingerprint: str  # of its certificate
    key: str


def read_box(folder: str) -> Optional[PairedBox]:
    """Return the box with which a standby is paired; None: none."""
    try:
        with open(os.path.join(folder, BOX_FILE), encoding="utf-8") as file:
            found = json.load(file)
        return PairedBox(str(found["host"]), int(found["port"]), str(found["fingerprint"]), str(found["key"]))
    except (OSError, ValueError, KeyError, TypeError):
        return None


def pair(folder: str, host: str, port: int, code: str) -> PairedBox:
    """Pair with a box, and save that. Raises `CannotPair`, `Lost` or OSError."""
    channel, fingerprint = connect(host, port)
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
    finally:
        channel.close()
    os.makedirs(folder, mode=0o700, exist_ok=True)
    durable.write_file(os.path.join(folder, BOX_FILE), json.dumps(box._asdict()).encode("ascii"))
    return box


def is_alive(box: PairedBox, timeout: float) -> bool:
    """Whether the box of the standby answers at its address."""
    try:
        channel, fingerprint = connect(box.host, box.port, timeout)
    except Lost:
        return False
    channel.close()
    return fingerprint.hex() == box.fingerprint


class StandbyEnd:
    """Keeps the copy. Call `run` in one thread."""

    def __init__(self, folder: str, box: PairedBox, on_state: Callable[[str], None]) -> None:
        """`on_state` is called with each change of the state: what is wrong, or empty if the copy is kept."""
        self._box = box
        self._receiver = Receiver(folder)
        self._on_state = on_state
        self._state: Optional[str] = None
        self._channel: Optional[Channel] = None
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
        channel = self._channel
        if channel is not None:
            channel.close()

    def _follow(self) -> str:
        """Serve the box until the connection ends; returns why it ended."""
        host = self._box.host
        try:
            self._channel, fingerprint = connect(host, self._box.port)
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
                answer = self._receiver.answer(channel.receive())
                channel.send(answer)
                self._report(str(answer.get("error", "")))
        except (Lost, BadMessage) as error:
            return f"the connection to the box at {host} ended ({error})"
        finally:
            channel.close()
            self._receiver.close()

    def _report(self, state: str) -> None:
        if state != self._state and not self._ended.is_set():
            self._state = state
            self._on_state(state)
