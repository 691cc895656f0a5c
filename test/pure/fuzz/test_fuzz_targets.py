"""Reading foreign data raises only the documented errors, and costs little (test/fuzz)."""

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzing.target import LIMIT_BYTES, LIMIT_S, Target, TooCostly
from fuzzing.targets import TARGETS
from helpers.examples import ALL, examples

# Inputs for each target; a file on a disk costs more than a datagram.
EXAMPLES = {"box": 40, "start": 60, "read": 8, "configuration": 60, "lines": 40}
USUAL_EXAMPLES = 100
# `make fuzz` holds the limit itself. Beside other tests the same work takes up to twice the processor time, and what
# these tests guard against, work that grows with the square of the input, takes far more.
BUSY_LIMIT_S = 4 * LIMIT_S


def _changed(seed, changes):
    """An input with pieces put in, taken out, or written over."""
    data = bytearray(seed)
    for where, kind, piece in changes:
        at = where % (len(data) + 1)
        if kind == "insert":
            data[at:at] = piece
        elif kind == "delete":
            del data[at:at + 1 + len(piece)]
        else:
            data[at:at + len(piece)] = piece
    return bytes(data)


def _inputs(target):
    pieces = st.sampled_from(target.tokens) | st.binary(max_size=8)
    changes = st.lists(
        st.tuples(st.integers(0, 70_000), st.sampled_from(["insert", "delete", "replace"]), pieces), max_size=6)
    return st.one_of(
        st.builds(_changed, st.sampled_from(target.all_seeds()), changes),
        st.lists(pieces, max_size=60).map(b"".join),
        st.binary(max_size=300),
    )


@pytest.mark.random
@pytest.mark.parametrize("name", sorted(TARGETS))
def test_whatever_is_read(name):
    target = TARGETS[name]

    @examples(EXAMPLES.get(name, USUAL_EXAMPLES))
    @given(_inputs(target))
    def check(data):
        target.check(data, BUSY_LIMIT_S)

    check()


@pytest.mark.random
@pytest.mark.parametrize("name", sorted(TARGETS))
def test_every_input_to_begin_with_and_every_stored_one(name):
    target = TARGETS[name]
    for data in [*target.seeds()[::1 if ALL else 4], *target.stored_inputs()]:
        target.check(data, BUSY_LIMIT_S)


def _busy():
    began = time.process_time()
    while time.process_time() < began + 1.5 * LIMIT_S:
        pass


def test_what_takes_too_long_is_found():
    target = Target("slow", lambda data: iter([lambda: None, _busy]), list)
    with pytest.raises(TooCostly, match="step 1 takes"):
        target.check(b"")
    target._replace(is_timed=False).check(b"")


def test_what_takes_too_much_memory_is_found():
    target = Target("large", lambda data: iter([lambda: bytes(LIMIT_BYTES + 1)]), list)
    with pytest.raises(TooCostly, match=r"10\.0 MB"):
        target.check(b"")


def test_what_was_slow_only_once_is_not_too_slow():
    """Others use this computer, too."""
    calls = []

    def once():
        calls.append(None)
        if len(calls) == 1:
            _busy()

    seconds, _ = Target("once", lambda data: iter([once]), list).check(b"")
    assert seconds < LIMIT_S
    assert len(calls) > 2
