"""One encrypted TCP connection between box and standby.

The box has a certificate that it signed itself. The standby knows its fingerprint since they were paired, so nobody
else has to sign it. The standby proves who it is with its key, within the encrypted connection.
"""

import contextlib
import datetime
import hashlib
import os
import socket
import ssl
from typing import Callable, Tuple

from cryptography import x509
from cryptography.hazmat.backends import default_backend
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

from roah_rsbb.ground import durable
from roah_rsbb.standby.messages import LENGTH, MAX_BYTES, BadMessage, Message, decode, encode

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
