"""Keys from passwords, and the four ciphers of private channels (docs/protocol.md, "Frame" and "Key").

Messages are not authenticated: a wrong password causes a wrong padding or, once in 256 datagrams, a meaningless
payload.
"""

import enum
import hashlib
import os
import shlex
import threading
from typing import Callable, Dict, Optional, Tuple

from cryptography.hazmat.backends import default_backend
from cryptography.hazmat.primitives.ciphers import Cipher as _AesCipher
from cryptography.hazmat.primitives.ciphers import algorithms, modes

from roah_rsbb.ground import linux

BLOCK_SIZE = 16
"""Bytes of an AES block and of an initialisation vector; also the longest padding."""

_KEY_ITERATIONS = 8
_BACKEND = default_backend()  # cryptography 2.8 requires it; later versions ignore it
_PADDINGS = [bytes([count]) * count for count in range(BLOCK_SIZE + 1)]


class Cipher(enum.IntEnum):
    """How a frame's payload is encrypted; the number is part of the frame's header."""

    NONE = 0
    AES_128_ECB = 1
    AES_128_CBC = 2
    AES_256_ECB = 3
    AES_256_CBC = 4

    @property
    def label(self) -> str:
        """The name used in parameters and messages, such as ``aes-128-cbc``."""
        return self.name.lower().replace("_", "-")

    @property
    def iv_size(self) -> int:
        """Bytes of the initialisation vector before the ciphertext: 16 for CBC, else 0."""
        return _IV_SIZES[self]


_IV_SIZES = 0, 0, BLOCK_SIZE, 0, BLOCK_SIZE  # by number


def cipher_by_label(label: str) -> Cipher:
    """Find a cipher by its label, as in parameter ``~rsbb_cypher``; ValueError names the choices."""
    for cipher in Cipher:
        if cipher.label == label and cipher is not Cipher.NONE:
            return cipher
    choices = ", ".join(cipher.label for cipher in Cipher if cipher is not Cipher.NONE)
    raise ValueError(f"unknown cipher {label!r}: choose one of {choices}")


class _Stream:
    """One direction of a cipher. It is set up once for all datagrams, because that takes longer than its use.

    Each call continues the previous one. So in CBC mode one more block comes first. Decrypted, the initialisation
    vector gives a meaningless block, and then the plain text. Encrypted, a random block gives another random one, which
    is the initialisation vector of what follows.
    """

    __slots__ = ("_context", "_lock")

    def __init__(self, aes: algorithms.AES, cipher: Cipher, encrypts: bool, iv: bytes = bytes(BLOCK_SIZE)) -> None:
        aes_cipher = _AesCipher(aes, modes.CBC(iv) if cipher.iv_size else modes.ECB(), backend=_BACKEND)
        self._context = aes_cipher.encryptor() if encrypts else aes_cipher.decryptor()
        self._lock = threading.Lock()

    def run(self, blocks: bytes) -> bytes:
        """Process whole blocks, from any thread."""
        with self._lock:
            return self._context.update(blocks)


class Key:
    """The keys of all four ciphers, derived from a team's password.

    EVP_BytesToKey with SHA-256, no salt and 8 iterations over the password's UTF-8 bytes (docs/protocol.md, "Key").
    A SHA-256 digest is as long as the longest key, so only the first round is needed. The protocol does not use the
    initialisation vector of further rounds.
    """

    __slots__ = ("_aes_128", "_aes_256", "_random_bytes", "_streams")

    def __init__(self, password: str, random_bytes: Callable[[int], bytes] = os.urandom) -> None:
        """ValueError if the password is empty or not valid Unicode; the error never shows the password.

        `random_bytes` makes the initialisation vectors.
        """
        try:
            digest = password.encode("utf-8")
        except UnicodeEncodeError:
            digest = b""  # raised below, because the encoder's error contains the password
        if not digest:
            raise ValueError("the password is empty or not valid Unicode text: give each team a password, "
                             "because private channels are always encrypted")
        for _ in range(_KEY_ITERATIONS):
            digest = hashlib.sha256(digest).digest()
        self._aes_128 = algorithms.AES(digest[:16])
        self._aes_256 = algorithms.AES(digest)
        self._streams: Dict[Tuple[Cipher, bool], _Stream] = {}
        self._random_bytes = random_bytes

    def __repr__(self) -> str:
        return "Key(...)"

    def encrypt(self, cipher: Cipher, plain: bytes, iv: Optional[bytes] = None) -> bytes:
        """Return the initialisation vector (none for ECB) and the ciphertext of `plain` with PKCS#7 padding.

        `iv` is for tests that compare bytes; the default is random. ValueError for a wrong length of it.
        """
        padded = plain + _PADDINGS[BLOCK_SIZE - len(plain) % BLOCK_SIZE]
        if iv is None:
            return self._stream(cipher, encrypts=True).run(self._random_bytes(cipher.iv_size) + padded)
        _check_iv(cipher, iv)
        return iv + _Stream(self._aes(cipher), cipher, True, iv).run(padded)

    def decrypt(self, cipher: Cipher, iv: bytes, ciphertext: bytes) -> Optional[bytes]:
        """Return the plain text, or None if the padding shows that another key was used.

        `ciphertext` consists of whole blocks. Checking the padding need not take constant time, because there is no
        answer to an undecryptable datagram. ValueError for wrong lengths.
        """
        _check_iv(cipher, iv)
        if not ciphertext or len(ciphertext) % BLOCK_SIZE:
            raise ValueError(f"{len(ciphertext)} bytes are not whole blocks of {BLOCK_SIZE}")
        return self.decrypt_body(cipher, iv + ciphertext)

    def decrypt_body(self, cipher: Cipher, body: bytes) -> Optional[bytes]:
        """Like `decrypt`, for initialisation vector and ciphertext in one, whose length was checked."""
        padded = self._stream(cipher, encrypts=False).run(body)
        count = padded[-1]
        if not 1 <= count <= BLOCK_SIZE or not padded.endswith(_PADDINGS[count]):
            return None
        return padded[cipher.iv_size:-count]

    def _stream(self, cipher: Cipher, encrypts: bool) -> _Stream:
        stream = self._streams.get((cipher, encrypts))
        if stream is None:
            stream = self._streams[cipher, encrypts] = _Stream(self._aes(cipher), cipher, encrypts)
        return stream

    def _aes(self, cipher: Cipher) -> algorithms.AES:
        return self._aes_128 if cipher in (Cipher.AES_128_ECB, Cipher.AES_128_CBC) else self._aes_256


def _check_iv(cipher: Cipher, iv: bytes) -> None:
    if len(iv) != cipher.iv_size:
        raise ValueError(f"{cipher.label} needs an IV of {cipher.iv_size} bytes, not {len(iv)}")


# -- a team's own password, for programs of the team --------------------------------------------------

PASSWORD_VARIABLE = "ROAH_RSBB_KEY"
"""The environment variable that holds a team's password."""


def _as_typed(text: str) -> str:
    """Decode an argument or a variable as UTF-8, which keys are made of (docs/protocol.md, "Key").

    Python decodes them by the locale, and a terminal may send UTF-8 in a locale that is ASCII or Latin-1.
    """
    try:
        return os.fsencode(text).decode("utf-8")
    except UnicodeError:
        return text


def own_password(password: Optional[str], file: Optional[str]) -> Optional[str]:
    """Find a team's password: the argument, the first line of `file`, or the environment; None if there is none.

    Raises ValueError, which names the file, if it cannot be read.
    """
    if password is None and file is None:
        password = os.environ.get(PASSWORD_VARIABLE)
    if password is not None:
        return _as_typed(password)
    if file is None:
        return None
    try:
        with open(file, encoding="utf-8") as opened:
            return opened.readline().rstrip("\r\n")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        raise ValueError(f"cannot read the password file {file}: {reason}") from None


def password_in(file: str, on_warning: Callable[[str], object]) -> str:
    """Read a team's password from the first line of a file, for a node (parameter rsbb_key_file).

    `on_warning` is called with what is wrong with the file's rights. Raises ValueError, which names the file.
    """
    password = own_password(None, file)
    if not password:
        raise ValueError(f"parameter rsbb_key_file: the first line of {file} is empty, expected the password")
    mode = linux.open_to_others(file)
    if mode:
        on_warning(f"Other users of this computer can read the password in {file} (mode {mode:04o}): chmod 600 "
                   f"{shlex.quote(file)}")
    return password
