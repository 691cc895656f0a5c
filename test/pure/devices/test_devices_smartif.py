"""The SmartIF protocol: encoding, and decoding of any bytes."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.examples import examples
from roah_rsbb.devices.smartif import (
    FROM_CONTROLLER,
    MAX_STRING,
    OUTPUTS,
    TO_CONTROLLER,
    BadSetting,
    Busy,
    Changed,
    DeviceEvent,
    Garbage,
    Home,
    Set,
    SmartIfDecoder,
    device_of,
    encode,
    is_ring,
)

TEXTS = st.text(max_size=30).filter(lambda text: len(text.encode("utf-8", "replace")) <= 90).map(
    lambda text: text.encode("utf-8", "replace").decode("utf-8")
)
NUMBERS = st.integers(0, 2**32 - 1)
HEARD = st.one_of(
    st.builds(Busy, TEXTS), st.builds(Changed, TEXTS, NUMBERS, NUMBERS),
    st.builds(DeviceEvent, st.sampled_from("NED"), TEXTS, TEXTS),
)
SAID = st.builds(Set, TEXTS, NUMBERS)


def pieces(data, cuts):
    """`data` cut at these places."""
    edges = [0, *sorted(cut % (len(data) + 1) for cut in cuts), len(data)]
    return [data[begin:end] for begin, end in zip(edges, edges[1:])]


@pytest.mark.parametrize("message, data", [
    (Set("77", 10000), b"I\0\x0277\0\0\x27\x10"),
    (Busy("10.0.0.9"), b"E\0\x0810.0.0.9"),
    (Changed("11", 1, 2), b"1\0\x0211\0\0\0\x01\0\0\0\x02"),
    (DeviceEvent("E", "47", "1"), b"2E\0\x0247\0\x011"),
])
def test_messages_are_these_bytes(message, data):
    """Written out from docs/devices.md, "The SmartIF protocol"."""
    assert encode(message) == data
    assert SmartIfDecoder(TO_CONTROLLER if isinstance(message, Set) else FROM_CONTROLLER).feed(data) == [message]


@pytest.mark.parametrize("parsers, kind", [(FROM_CONTROLLER, HEARD), (TO_CONTROLLER, SAID)])
@examples()
@given(st.data(), st.lists(st.integers(0, 2000), max_size=8))
def test_pieces_of_any_size_make_the_same_messages(parsers, kind, data, cuts):
    messages = data.draw(st.lists(kind, max_size=6))
    decoder = SmartIfDecoder(parsers)
    sent = b"".join(encode(message) for message in messages)
    assert [m for piece in pieces(sent, cuts) for m in decoder.feed(piece)] == messages
    assert decoder.pending == 0


@examples()
@given(st.binary(max_size=4000), st.lists(st.integers(0, 4000), max_size=8))
def test_any_bytes_are_messages_or_garbage_and_nothing_grows(data, cuts):
    decoder = SmartIfDecoder(FROM_CONTROLLER)
    for piece in pieces(data, cuts):
        try:
            decoder.feed(piece)
        except Garbage:
            return
        assert decoder.pending <= 2 * MAX_STRING + 8 + len(piece)


@examples()
@given(HEARD, st.integers(1, 200))
def test_the_rest_of_an_incomplete_message_is_awaited(message, missing):
    data = encode(message)
    cut = max(0, len(data) - missing)
    decoder = SmartIfDecoder(FROM_CONTROLLER)
    assert decoder.feed(data[:cut]) == []
    assert decoder.pending == cut
    assert decoder.feed(data[cut:]) == [message]


@examples()
@given(st.lists(HEARD, max_size=4), st.binary(max_size=50))
def test_messages_before_garbage_count(messages, more):
    decoder = SmartIfDecoder(FROM_CONTROLLER)
    assert decoder.feed(b"".join(map(encode, messages)) + b"?" + more) == messages if messages else True
    with pytest.raises(Garbage, match=r"begins with b'\?': expected 'E', '1', '2'"):
        decoder.feed(b"" if messages else b"?" + more)


@pytest.mark.parametrize("data, text", [
    (b"E\xff\xff", "65535 bytes"), (b"1\x04\x01", "1025 bytes"), (b"2X", "kind b'X'"),
    (b"2E\0\x0247\xff\xff", "65535 bytes"), (b"I\0\x0211\0\0\0\x01", "begins with b'I'"), (b"HTTP/1.1 400", "b'H'"),
])
def test_garbage_is_found_before_anything_is_waited_for(data, text):
    with pytest.raises(Garbage) as raised:
        SmartIfDecoder(FROM_CONTROLLER).feed(data)
    assert text in str(raised.value)


@pytest.mark.parametrize("size", [MAX_STRING - 1, MAX_STRING])
def test_long_texts_are_read(size):
    event = DeviceEvent("N", "a" * size, "b" * size)
    assert SmartIfDecoder(FROM_CONTROLLER).feed(encode(event) * 3) == [event] * 3


@pytest.mark.parametrize("message", [Set("11", -1), Set("11", 2**32), Busy("x" * (MAX_STRING + 1))])
def test_texts_that_do_not_fit_are_not_sent(message):
    with pytest.raises(ValueError):
        encode(message)


# -- the known state of the home devices --------------------------------------------------------------

@pytest.mark.parametrize("device, value, message", [
    ("switch_1", 1, Set("11", 1)), ("switch_2", 1, Set("33", 1)), ("switch_3", 0, Set("40", 0)),
    ("dimmer", 70, Set("58", 70)), ("dimmer", 100, Set("58", 100)),
    ("blinds", 35, Set("77", 3500)), ("blinds", 100, Set("77", 10000)), ("blinds", 0, Set("77", 0)),
])
def test_what_the_controller_receives(device, value, message):
    """Ids and scales of docs/devices.md, "The SmartIF protocol"."""
    home = Home()
    assert home.set(device, value) == message
    assert home.values[device] == value
    assert message in home.all()
    assert device_of(message) == (device, value)


def test_all_is_every_device_once():
    assert sorted(message.device_id for message in Home().all()) == ["11", "33", "40", "58", "77"]


@pytest.mark.parametrize("device, value", [
    ("dimmer", 101), ("blinds", 255), ("blinds", -1), ("switch_1", 2), ("dimmer", 10**12),
])
def test_other_values_are_refused_and_change_nothing(device, value):
    home = Home()
    with pytest.raises(BadSetting, match=f"{device} cannot be set to {value}: it takes 0 to {OUTPUTS[device].highest}"):
        home.set(device, value)
    assert home.values == Home().values


@pytest.mark.parametrize("message, rings", [
    (DeviceEvent("E", "47", "1"), True), (DeviceEvent("E", "47", "0"), False), (DeviceEvent("N", "47", "1"), False),
    (DeviceEvent("D", "47", "1"), False), (DeviceEvent("E", "11", "1"), False), (Changed("47", 1, 1), False),
])
def test_a_ring_is_one_message_only(message, rings):
    assert is_ring(message) is rings


@pytest.mark.parametrize("message", [Set("47", 1), Set("77", 10001), Set("77", 50), Set("58", 101), Set("11", 2)])
def test_messages_for_no_device(message):
    assert device_of(message) is None


def test_saved_state_is_restored():
    home, other = Home(), Home()
    home.set("blinds", 40)
    home.set("switch_2", 1)
    home.bell, home.door = (2**31 + 5, 999_999_999), True
    assert other.restore(json.loads(json.dumps(home.saved())))
    assert (other.values, other.bell, other.door) == (home.values, home.bell, home.door)


@pytest.mark.parametrize("saved", [
    None, 5, "x", {}, [], {"values": {"dimmer": 101}, "bell": ["0", "0"], "door": False},
    {"values": {"dimmer": float("inf")}, "bell": ["0", "0"], "door": False},
    {"values": {"radio": 1}, "bell": ["0", "0"], "door": False}, {"values": {}, "bell": ["x", "0"], "door": False},
    {"values": {}, "bell": ["-1", "0"], "door": False}, {"values": {"dimmer": 5}, "bell": ["0"], "door": False},
    {"values": {"dimmer": 5}, "bell": ["0", "0"]}, {"values": 3, "bell": ["0", "0"], "door": False},
])
def test_what_cannot_be_restored_changes_nothing(saved):
    home = Home()
    home.set("dimmer", 7)
    assert not home.restore(saved)
    assert home.values["dimmer"] == 7
