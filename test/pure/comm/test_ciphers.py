"""Keys and ciphers, compared with those of the original."""

import os
import random
import threading

import pytest
from cryptography.hazmat.backends import default_backend
from cryptography.hazmat.primitives import ciphers as library
from cryptography.hazmat.primitives import padding

from helpers import golden
from roah_rsbb.comm.ciphers import BLOCK_SIZE, Cipher, Key, cipher_by_label, own_password

KEYS = [record for record in golden.load("keys") if record["password"]]  # the original allows an empty one
ENCRYPTING = [cipher for cipher in Cipher if cipher is not Cipher.NONE]


@pytest.mark.parametrize("record", KEYS, ids=lambda r: "{password}-{cipher}".format(**r))
def test_key_is_the_originals(record, monkeypatch):
    used = []
    monkeypatch.setattr("roah_rsbb.comm.ciphers._AesCipher", lambda aes, mode, backend: used.append(aes))
    with pytest.raises(AttributeError):  # there is no cipher
        Key(record["password"]).encrypt(cipher_by_label(record["cipher"]), b"")
    assert used[0].key.hex() == record["key_hex"]


@pytest.mark.parametrize("cipher", ENCRYPTING, ids=lambda c: c.label)
@pytest.mark.parametrize("size", [0, 1, 15, 16, 17, 1000])
def test_decrypts_what_it_encrypts(cipher, size):
    key = Key("PASSWORD")
    sent = key.encrypt(cipher, b"x" * size)
    iv, ciphertext = sent[:cipher.iv_size], sent[cipher.iv_size:]
    assert len(ciphertext) == (size // 16 + 1) * 16
    assert key.decrypt(cipher, iv, ciphertext) == b"x" * size


def _library(record, iv):
    """A cipher that is set up for one datagram alone."""
    cipher = cipher_by_label(record["cipher"])
    mode = library.modes.CBC(iv) if cipher.iv_size else library.modes.ECB()
    return library.Cipher(library.algorithms.AES(bytes.fromhex(record["key_hex"])), mode, default_backend())


@pytest.mark.parametrize("record", KEYS[:4], ids=lambda r: r["cipher"])
def test_each_datagram_is_by_itself_whatever_came_before(record):
    cipher, key, rng = cipher_by_label(record["cipher"]), Key(record["password"]), random.Random(1)
    for size in [rng.randrange(200) for _ in range(50)]:
        plain, iv = rng.getrandbits(8 * 200).to_bytes(200, "big")[:size], os.urandom(cipher.iv_size)
        padder, encryptor = padding.PKCS7(128).padder(), _library(record, iv).encryptor()
        expected = encryptor.update(padder.update(plain) + padder.finalize()) + encryptor.finalize()
        assert key.encrypt(cipher, plain, iv) == iv + expected
        assert key.decrypt(cipher, iv, expected) == plain
        key.decrypt(cipher, iv, os.urandom(BLOCK_SIZE * rng.randrange(1, 4)))


def test_threads_do_not_disturb_each_other():
    key, wrong = Key("PASSWORD"), []
    begin = threading.Barrier(4)

    def work(number):
        begin.wait()
        for size in range(600):
            plain = bytes([number]) * size
            sent = key.encrypt(Cipher.AES_128_CBC, plain)
            if key.decrypt(Cipher.AES_128_CBC, sent[:16], sent[16:]) != plain:
                wrong.append((number, size))

    threads = [threading.Thread(target=work, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_each_datagram_has_its_own_iv():
    key = Key("PASSWORD")
    assert key.encrypt(Cipher.AES_128_CBC, b"same") != key.encrypt(Cipher.AES_128_CBC, b"same")


@pytest.mark.parametrize("padding", [b"\x00", b"\x11" * 17, b"\x10" * 15, b"\x01\x02", b"\x02\x03\x03"])
def test_refuses_a_wrong_padding(padding):
    key = Key("PASSWORD")
    plain = (b"x" * 32 + padding)[-32:]
    ciphertext = key.encrypt(Cipher.AES_128_ECB, plain)[:32]  # without the block of right padding
    assert key.decrypt(Cipher.AES_128_ECB, b"", ciphertext) is None


def test_another_password_does_not_decrypt():
    sent = Key("PASSWORD").encrypt(Cipher.AES_128_ECB, b"x" * 20)
    for word in ("password", "PASSWORD "):
        assert Key(word).decrypt(Cipher.AES_128_ECB, b"", sent) != b"x" * 20


def test_labels():
    assert [cipher.label for cipher in Cipher] == [
        "none", "aes-128-ecb", "aes-128-cbc", "aes-256-ecb", "aes-256-cbc"]
    assert [cipher_by_label(cipher.label) for cipher in ENCRYPTING] == ENCRYPTING


@pytest.mark.parametrize("label", ["none", "", "aes-192-cbc", "AES-128-CBC"])
def test_an_unknown_label_is_answered_with_the_choices(label):
    with pytest.raises(ValueError, match="aes-128-ecb, aes-128-cbc, aes-256-ecb, aes-256-cbc"):
        cipher_by_label(label)


@pytest.mark.parametrize("password", ["", "secret\ud800"])
def test_refuses_a_password_that_gives_no_key(password):
    with pytest.raises(ValueError, match="password is empty or not valid") as caught:
        Key(password)
    error = caught.value
    assert "secret" not in repr(error) + repr(error.__cause__) + repr(error.__context__)


def test_never_shows_the_password_or_the_key():
    key = Key("PASSWORD")
    assert repr(key) == str(key) == "Key(...)"
    assert not hasattr(key, "__dict__")


def test_refuses_an_iv_of_the_wrong_length():
    key = Key("PASSWORD")
    with pytest.raises(ValueError, match="aes-128-cbc needs an IV of 16 bytes, not 8"):
        key.encrypt(Cipher.AES_128_CBC, b"", iv=bytes(8))
    with pytest.raises(ValueError, match="aes-256-ecb needs an IV of 0 bytes, not 16"):
        key.decrypt(Cipher.AES_256_ECB, bytes(16), bytes(16))


@pytest.mark.parametrize("size", [0, 1, 15, 17])
def test_refuses_incomplete_blocks_and_continues(size):
    key = Key("PASSWORD")
    sent = key.encrypt(Cipher.AES_128_CBC, b"before")
    with pytest.raises(ValueError, match=f"{size} bytes are not whole blocks of 16"):
        key.decrypt(Cipher.AES_128_CBC, bytes(16), bytes(size))
    assert key.decrypt(Cipher.AES_128_CBC, sent[:16], sent[16:]) == b"before"


# -- a team's own password: from the argument, a file or the environment ------------------------------

def test_ones_own_password(tmp_path, monkeypatch):
    monkeypatch.delenv("ROAH_RSBB_KEY", raising=False)
    assert own_password(None, None) is None
    monkeypatch.setenv("ROAH_RSBB_KEY", "e")
    assert own_password(None, None) == "e"
    (tmp_path / "f").write_text("p q\nx\n", encoding="utf-8")
    assert own_password(None, str(tmp_path / "f")) == "p q"
    assert own_password("o", None) == "o"
    with pytest.raises(ValueError, match="No such file"):
        own_password(None, str(tmp_path / "none"))
