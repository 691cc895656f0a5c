"""Ciphertexts that were taken before are known, and new ones are not."""

import os
import pathlib

import pytest

from roah_rsbb.comm.channels import BITS_PER_ENTRY, Seen


def test_what_was_added_is_known_and_nothing_else():
    seen = Seen(2**16)
    texts = [os.urandom(32) for _ in range(2**16 // BITS_PER_ENTRY)]
    mistaken = 0
    for text in texts:
        mistaken += seen.place(text) in seen
        seen.add(seen.place(text))
        assert seen.place(text) in seen
    assert all(seen.place(text) in seen for text in texts)
    # One in 2,000 is expected of the full filter, and fewer while it fills.
    assert mistaken <= 20
    assert sum(seen.place(os.urandom(32)) in seen for _ in range(2000)) <= 20


@pytest.mark.long
def test_a_full_filter_is_kept_while_the_next_one_fills():
    seen = Seen(2**12)
    capacity = 2**12 // BITS_PER_ENTRY
    texts = [os.urandom(32) for _ in range(3 * capacity)]
    for number, text in enumerate(texts):
        seen.add(seen.place(text))
        assert all(seen.place(last) in seen for last in texts[max(0, number - capacity + 1):number + 1])
    assert sum(seen.place(text) in seen for text in texts[:capacity]) <= capacity // 10
    assert sum(seen.place(os.urandom(32)) in seen for _ in range(2000)) <= 40


def test_a_filter_that_is_hardly_filled_takes_hardly_any_memory():
    statm = pathlib.Path("/proc/self/statm")
    before = int(statm.read_text("ascii").split()[1])
    seen = Seen(2**30)
    seen.add(seen.place(b"first"))
    pages = int(statm.read_text("ascii").split()[1]) - before
    assert pages * os.sysconf("SC_PAGE_SIZE") < seen._bits // 8 // 10
    assert seen.place(b"first") in seen
