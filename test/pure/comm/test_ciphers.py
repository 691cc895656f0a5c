"""Keys and ciphers against what the original derived and encrypted."""

import pytest

from helpers import golden
from roah_rsbb.comm.ciphers import Cipher, Key, cipher_by_label

KEYS = [record for record in golden.load("keys") if record["password"]]  # the original allows an empty one
ENCRYPTING = [cipher for cipher in Cipher if cipher is not Cipher.NONE]


@pytest.mark.parametrize("record", KEYS, ids=lambda r: "{password}-{cipher}".format(**r))
def test_key_is_the_originals(record, monkeypatch):
    used = []
    monkeypatch.setattr("roah_rsbb.comm.ciphers._AesCipher", lambda aes, mode, backend: used.append(aes))
    Key(record["password"])._context(cipher_by_label(record["cipher"]), bytes(16))
    assert used[0].key.hex() == record["key_hex"]


@pytest.mark.parametrize("cipher", ENCRYPTING, ids=lambda c: c.label)
@pytest.mark.parametrize("size", [0, 1, 15, 16, 17, 1000])
def test_decrypts_what_it_encrypts(cipher, size):
    key = Key("PASSWORD")
    sent = key.encrypt(cipher, b"x" * size)
    iv, ciphertext = sent[:cipher.iv_size], sent[cipher.iv_size:]
    assert len(ciphertext) == (size // 16 + 1) * 16
    assert key.decrypt(cipher, iv, ciphertext) == b"x" * size


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
    with pytest.raises(ValueError, match="IV of 16 bytes, not 8"):
        Key("PASSWORD").encrypt(Cipher.AES_128_CBC, b"", iv=bytes(8))
