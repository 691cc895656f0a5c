"""Words as datagrams: nobody but the ends of the pair can make one."""

import pytest

from roah_rsbb.standby.pair import Side, Word, pair_name, seal, unseal

SECRET, OTHER = "5" * 64, "6" * 64
SECRETS = {pair_name(secret): secret for secret in (SECRET, OTHER)}
WORD = Word(Side.STANDBY, 2, claims=True, asks=False, cut=1234)


def test_a_word_arrives():
    assert unseal(SECRETS, seal(SECRET, WORD)) == (pair_name(SECRET), WORD)
    assert unseal(SECRETS, seal(OTHER, WORD)) == (pair_name(OTHER), WORD)


def test_a_word_of_another_pair():
    assert unseal({pair_name(OTHER): OTHER}, seal(SECRET, WORD)) is None


def test_a_word_whose_sender_does_not_have_the_key():
    forged = seal(OTHER, WORD).replace(pair_name(OTHER).encode(), pair_name(SECRET).encode())
    assert unseal(SECRETS, forged) is None


@pytest.mark.parametrize("place", range(0, len(seal(SECRET, WORD)), 7))
def test_a_word_that_was_changed(place):
    data = bytearray(seal(SECRET, WORD))
    data[place] ^= 1
    assert unseal(SECRETS, bytes(data)) is None


@pytest.mark.parametrize("data", [b"", b" ", b"\xff \xff \xff", b"a b c", seal(SECRET, WORD)[:-1],
                                  seal(SECRET, WORD._replace(epoch=0)), seal(SECRET, WORD._replace(cut=-1))])
def test_an_invalid_word(data):
    assert unseal(SECRETS, data) is None
