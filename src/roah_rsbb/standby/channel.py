"""One encrypted TCP connection between box and standby.

The box has a certificate that it signed itself. The standby knows its fingerprint since they were paired, so nobody
else has to sign it. The standby proves who it is with its key, within the encrypted connection.
"""

import contextlib
import datetime
import hashlib
import json
import os
import socket
import ssl
import struct
from typing import Any, Callable, Dict, List, Tuple

from cryptography import x509
from cryptography.hazmat.backends import default_backend
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

from roah_rsbb.ground import durable
from roah_rsbb.journal import log
from roah_rsbb.journal.copy_folder import FILES, FileContent, Held, Part

# -- messages -----------------------------------------------------------------------------------------

# A message of the box is a request. The standby answers all of them in their order. Requests can be repeated: what is
# missing is computed from what the standby says it has.

LENGTH = struct.Struct(">I")
# A part of the journal, or a file beside it. Before a standby is known, messages are small.
MAX_BYTES = 50_000_000
MAX_BYTES_OF_STRANGERS = 4096

# Files of the box's computer that a standby needs, by their names in the copy.
PASSWORDS, NETWORK, MODULES = "passwords.yaml", "network.json", "modules.zip"
# No other names are written: a message must not reach outside the folder.
NAMES = frozenset((*FILES, PASSWORDS, NETWORK, MODULES))

Message = Dict[str, Any]
# In the JSON, the key of an object that stands for so many bytes.
_BYTES = "bytes"


class BadMessage(Exception):
    """What arrived is not a message of this protocol."""


def encode(message: Message) -> bytes:
    """Return a message, whose values may be bytes, without its length."""
    found: List[bytes] = []

    def follows(value: object) -> Dict[str, int]:
        if not isinstance(value, bytes):
            raise TypeError(value)
        found.append(value)
        return {_BYTES: len(value)}

    text = json.dumps(message, separators=(",", ":"), default=follows).encode("ascii")
    return b"".join((text, b"\n", *found)) if found else text


def decode(data: bytes) -> Message:
    """Read a message. Raises `BadMessage`."""
    text, _, rest = data.partition(b"\n")
    at = 0

    def read(value: Message) -> object:
        nonlocal at
        if value.keys() != {_BYTES}:
            return value
        begin, at = at, at + value[_BYTES]
        return rest[begin:at]

    try:
        message = json.loads(text.decode("ascii"), object_hook=read)
    except (ValueError, TypeError, RecursionError):
        raise BadMessage("it is not JSON, or not all of it arrived") from None
    if not isinstance(message, dict) or at != len(rest):
        raise BadMessage("it is not an object")
    return message


def held_of(message: Message) -> Dict[str, Held]:
    """Return what a copy has, by the names of the segments. Raises `BadMessage`."""
    try:
        return {str(name): Held(int(size), int(crc)) for name, (size, crc) in message["held"].items()}
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        raise BadMessage(f"held: {error!r}") from None


def part_of(message: Message) -> Part:
    """Return the part of a segment in a message. Raises `BadMessage`."""
    try:
        part = Part(*(message[name] for name in Part._fields))
    except KeyError as error:
        raise BadMessage(f"part: {error!r}") from None
    types = tuple(map(type, part))
    if types != (str, int, bytes, bool) or part.at < 0 or log.name_of(part.segment) is None:
        raise BadMessage("part of something else")
    return part


def files_of(message: object) -> FileContent:
    """Return the files in a message, by their names. Raises `BadMessage`."""
    if not isinstance(message, dict) or not NAMES.issuperset(message):
        raise BadMessage("files with other names")
    if not all(isinstance(content, bytes) for content in message.values()):
        raise BadMessage("files without contents")
    return message


# -- the connection -----------------------------------------------------------------------------------

# An end that is silent for this long is lost. A stick or disk of the standby may be slow.
TIMEOUT_S = 5.0
# A message is sent in parts of this size, each within the time: all of a large one takes longer on a slow network.
PART_BYTES = 1 << 16
CERTIFICATE, KEY = "certificate.pem", "key.pem"
_VALID_DAYS = 3650
ANY_HOST = "0.0.0.0"


class Lost(Exception):
    """The connection ended. The text says why."""


class Channel:
    """Messages over a socket. All methods raise `Lost` or `BadMessage`."""

    def __init__(self, connection: socket.socket) -> None:
        connection.settimeout(TIMEOUT_S)
        # The end of a large message must not wait until its beginning was acknowledged.
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._connection = connection

    def send(self, message: Message) -> None:
        """Send a message."""
        data = encode(message)
        parts = memoryview(LENGTH.pack(len(data)) + data)
        with self._losing():
            for begin in range(0, len(parts), PART_BYTES):
                self._connection.sendall(parts[begin:begin + PART_BYTES])

    def receive(self, limit: int = MAX_BYTES) -> Message:
        """Wait for a message of at most `limit` bytes."""
        (length,) = LENGTH.unpack(self._read(LENGTH.size))
        if length > limit:
            raise BadMessage(f"it has {length} bytes")
        return decode(self._read(length))

    def close(self) -> None:
        """Close the connection. Threads that wait in it are woken."""
        wake(self._connection)
        self._connection.close()

    def _read(self, size: int) -> bytes:
        data = bytearray()
        while len(data) < size:
            with self._losing():
                part = self._connection.recv(min(size - len(data), 1 << 16))
            if not part:
                raise Lost("the other end closed the connection")
            data += part
        return bytes(data)

    @staticmethod
    @contextlib.contextmanager
    def _losing():
        try:
            yield
        except socket.timeout:
            raise Lost(f"no answer within {TIMEOUT_S:g} s") from None
        except OSError as error:
            raise Lost(error.strerror or str(error)) from None


def wake(connection: socket.socket) -> None:
    """Let all threads that wait in a connection find that it has ended."""
    with contextlib.suppress(OSError):
        # The method of an encrypted connection would switch to plain text first.
        socket.socket.shutdown(connection, socket.SHUT_RDWR)


def box_context(folder: str) -> Tuple[ssl.SSLContext, bytes]:
    """Return the box's end of TLS, and the fingerprint of its certificate, which is created in the folder if it is
    missing or damaged. Raises OSError."""
    paths = [os.path.join(folder, name) for name in (CERTIFICATE, KEY)]
    if not all(map(os.path.exists, paths)):
        _create_certificate(*paths)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    try:
        context.load_cert_chain(*paths)
    except ssl.SSLError:  # the standby has to be paired again, and says so
        _create_certificate(*paths)
        context.load_cert_chain(*paths)
    with open(paths[0], encoding="ascii") as file:
        return context, _fingerprint(ssl.PEM_cert_to_DER_cert(file.read()))


def connect(
    host: str, port: int, timeout: float = TIMEOUT_S, source: str = ANY_HOST,
    on_socket: Callable[[socket.socket], None] = lambda _: None,
) -> Tuple[Channel, bytes]:
    """Connect to a box; returns the channel and the fingerprint of the box's certificate, which the caller must
    compare. `source`: own address to use. `on_socket` gets the socket first: another thread that calls its `shutdown`
    ends the attempt. Raises `Lost`."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE  # the fingerprint is compared instead
    try:
        plain = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        try:
            plain.settimeout(timeout)
            plain.bind((source, 0))
            on_socket(plain)
            plain.connect((host, port))
            connection = context.wrap_socket(plain)
        except BaseException:
            plain.close()
            raise
    except OSError as error:
        raise Lost(error.strerror or str(error)) from None
    return Channel(connection), _fingerprint(connection.getpeercert(binary_form=True) or b"")


def _fingerprint(certificate: bytes) -> bytes:
    return hashlib.sha256(certificate).digest()


def _create_certificate(certificate_path: str, key_path: str) -> None:
    backend = default_backend()  # cryptography 2.8 requires it; later versions ignore it
    key = ec.generate_private_key(ec.SECP256R1(), backend)
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "roah_rsbb box")])
    # Nobody checks the dates: the clock of a computer without a battery may be years behind.
    begin = datetime.datetime(2020, 1, 1)
    certificate = (
        x509.CertificateBuilder().subject_name(name).issuer_name(name).public_key(key.public_key())
        .serial_number(x509.random_serial_number()).not_valid_before(begin)
        .not_valid_after(begin + datetime.timedelta(days=_VALID_DAYS)).sign(key, hashes.SHA256(), backend))
    durable.write_file(key_path, key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()))
    durable.write_file(certificate_path, certificate.public_bytes(serialization.Encoding.PEM))
