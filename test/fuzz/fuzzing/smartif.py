"""SmartIF: messages of a controller to the devices node (docs/devices.md, "The SmartIF protocol")."""

import json
from typing import Dict, Iterator, List

from fuzzing.reader import Reader
from fuzzing.target import Step, Target
from roah_rsbb.devices.smartif import (
    FROM_CONTROLLER,
    MAX_STRING,
    TO_CONTROLLER,
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

_LONGEST = 4096  # bytes that are read at once
_KEPT = 2 * MAX_STRING + 16  # bytes that a decoder may keep at most


def _feed(decoder: SmartIfDecoder, data: bytes, messages: List) -> bool:
    """Take some bytes as the client does; False: they are garbage."""
    try:
        found = decoder.feed(data)
        while found:
            messages += found
            found = decoder.feed(b"")
    except Garbage as garbage:
        assert len(str(garbage)) < 300
        return False
    return True


def steps(data: bytes) -> Iterator[Step]:
    """Bytes are messages, or Garbage; however the network cuts them."""
    reader = Reader(data)
    parsers = FROM_CONTROLLER if reader.flag() else TO_CONTROLLER
    cut, stream = 1 + reader.byte(), reader.rest()[:_LONGEST]
    at_once: List = []
    whole = SmartIfDecoder(parsers)
    understood: List[bool] = []
    yield lambda: understood.append(_feed(whole, stream, at_once))
    assert whole.pending < _KEPT or not understood[0]

    in_pieces: List = []
    pieces = SmartIfDecoder(parsers)
    for begin in range(0, len(stream), cut):
        if not _feed(pieces, stream[begin:begin + cut], in_pieces):
            break
        assert pieces.pending < _KEPT
    assert in_pieces == at_once
    for message in at_once:
        is_ring(message)
        if isinstance(message, Set):
            device_of(message)


def home_steps(data: bytes) -> Iterator[Step]:
    """The saved state that the devices node finds."""
    try:
        saved = json.loads(data.decode("utf-8", "ignore"))
    except (ValueError, RecursionError):
        return
    home = Home()
    before = home.saved()
    taken: List[bool] = []
    yield lambda: taken.append(home.restore(saved))
    if not taken[0]:
        assert home.saved() == before
    for message in home.all():
        encode(message)


def seeds() -> List[bytes]:
    """Messages of both sides, whole and torn."""
    from_controller = [
        encode(DeviceEvent("E", "47", "1")), encode(Busy("10.0.0.1:5")), encode(Changed("11", 1, 2**32 - 1)),
        encode(DeviceEvent("N", "", "x" * 1024)), b"2E\x04\x01", b"2X", b"E\xff\xff", b"E\x00\x02\xff\xfe",
        b"\0" * 100, b"E\xff\xff" + bytes(4000),
    ]
    to_controller = [encode(Set(device, value)) for device, value in (("11", 1), ("77", 10_000), ("x", 2**32 - 1))]
    many = [b"1" + b"\0" * 10, b"2E" + b"\0" * 4, b"E\0\0"]
    return (
        [b"\x01\x00" + data for data in from_controller] + [b"\x01\xff" + b"".join(from_controller[:3])]
        + [b"\x00\x02" + data for data in to_controller] + [b"\x01\x06" + data * 1000 for data in many]
        + [b"\x00\x06" + b"I\0\0\0\0\0\0" * 600]
    )


def home_seeds() -> List[bytes]:
    """Saved states, and invalid data."""
    states: List[object] = [
        Home().saved(), {"values": {"dimmer": 1e400}, "bell": [1, 2], "door": 1}, {"values": {"dimmer": "1" * 5000}},
        {"values": [], "bell": 1}, [], 1, None, {"values": {"nothing": 1}, "bell": ["1", "2"], "door": False},
        {"values": {}, "bell": ["9" * 5000, "0"], "door": None}, {"values": {"switch_1": [1]}, "bell": "12"},
    ]
    return [json.dumps(state).encode() for state in states]


_HOME_WORDS: Dict[str, object] = Home().saved()
SMARTIF = Target("smartif", steps, seeds, (b"E", b"1", b"2E", b"2N", b"I", b"\x00\x02", b"47", b"\x04\x00", b"\xff"))
HOME = Target(
    "home", home_steps, home_seeds,
    tuple(f'"{word}":'.encode() for word in (*_HOME_WORDS, *Home().values)) + (b"[", b"{", b"1e999", b"NaN", b"null"),
)
