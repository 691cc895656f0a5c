"""Small entries record how a large state changes: what was written is what is read."""

import json

from hypothesis import given
from hypothesis import strategies as st

from helpers.examples import examples
from roah_rsbb.journal.records import COMPLETE_EVERY, ChangesReader, ChangesWriter

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-3, 3) | st.text("ab\n", max_size=150),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from("abc"), inner, max_size=3),
    max_leaves=12,
)


@examples()
@given(st.lists(VALUES, max_size=8))
def test_the_reader_follows_the_writer(states):
    writer, reader = ChangesWriter(), ChangesReader()
    for state in states:
        value = writer.entry(state)
        if value is not None:
            reader.take(json.loads(json.dumps(value)))
        assert reader.state == state


def test_after_a_missing_entry_the_state_is_not_known_until_the_next_complete_one():
    writer, reader = ChangesWriter(), ChangesReader()
    entries = [writer.entry({"count": i, "text": "unchanged"}) for i in range(COMPLETE_EVERY + 2)]
    assert [i for i, entry in enumerate(entries) if isinstance(entry["change"], list)] == [0, COMPLETE_EVERY]
    del entries[5]
    known = [reader.take(entry) is not None for entry in entries]
    assert known == [True] * 5 + [False] * (COMPLETE_EVERY - 6) + [True] * 2
    assert reader.state == {"count": COMPLETE_EVERY + 1, "text": "unchanged"}


def test_a_damaged_entry_is_like_a_missing_one():
    writer, reader = ChangesWriter(), ChangesReader()
    reader.take(writer.entry({"a": 1}))
    writer.entry({"a": 2})
    assert reader.take({"number": 2, "change": {"a": [[[7, [1]]], []]}}) is None
    assert reader.take(writer.entry({"a": 3})) is None
    assert reader.take("nonsense") is None
