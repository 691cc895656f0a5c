"""capture: arbitrary packets from the network, and arbitrary recordings."""

import json
import struct
from typing import Iterator, List

from fuzzing.frames import private_seeds, public_seeds
from fuzzing.reader import Reader
from fuzzing.target import Step, Target
from helpers import golden
from helpers.box_beacon import box_beacon
from roah_rsbb.capture import decoding, listening
from roah_rsbb.capture.decoding import BadRecording, Datagram, Decoder
from roah_rsbb.capture.program import TextLines, json_line
from roah_rsbb.comm.frame import encode

_PORT = 6666
_UTC = 1_800_000_000.5
_MOST = 20  # datagrams of a recording


def _decoder() -> Decoder:
    """One that has heard of a robot on the first private port."""
    decoder = Decoder(_PORT, {"Team": golden.PASSWORD})
    beacon = box_beacon(("Team", "r", _PORT + 1))
    decoder.decode(Datagram(_UTC, "10.0.0.1", _PORT, "10.0.0.255", _PORT, encode(beacon)))
    return decoder


def _show(decoder: Decoder, datagram: Datagram) -> None:
    """Print a datagram as a line without terminal commands, and as a JSON object."""
    decoder.concerns(datagram)
    entry = decoder.decode(datagram)
    line = TextLines().line(entry)
    assert line.isprintable()
    json.dumps(json.loads(json_line(entry)), allow_nan=False)


def packet_steps(data: bytes) -> Iterator[Step]:
    """A packet of the raw socket."""
    decoder = _decoder()

    def take() -> None:
        found = listening.parse_packet(data, _UTC)
        if isinstance(found, Datagram):
            _show(decoder, found)

    yield take


def datagram_steps(data: bytes) -> Iterator[Step]:
    """A datagram, on one of several ports."""
    reader = Reader(data)
    port = _PORT + reader.byte() % 3
    datagram = Datagram(_UTC, "10.0.0.2", reader.choice((port, 5)), "10.0.0.1", port, reader.rest()[:65507])
    decoder = _decoder()
    yield lambda: _show(decoder, datagram)


def recording_steps(data: bytes) -> Iterator[Step]:
    """A recording, line by line."""
    lines = iter(data.decode("utf-8", "replace").splitlines(keepends=True))
    decoder = _decoder()

    def read() -> None:
        try:
            _, datagrams = decoding.read(lines, "recording")
            for _, datagram in zip(range(_MOST), datagrams):
                _show(decoder, datagram)
        except BadRecording as bad:
            assert str(bad).startswith("recording:")

    yield read


# -- inputs to begin with ---------------------------------------------------------------------------------


def _packet(content: bytes, dport: int = _PORT, fragment: int = 0, words: int = 5) -> bytes:
    udp = struct.pack(">HHHH", 6666, dport, 8 + len(content), 0)
    length = words * 4 + len(udp) + len(content)
    header = struct.pack(">BBHHHBBHII", 0x40 + words, 0, length, 0, fragment, 64, 17, 0, 0x0A000002, 0x0A000001)
    return header + bytes(words * 4 - 20) + udp + content


def packet_seeds() -> List[bytes]:
    """Packets of recorded datagrams, fragments, and packets with a wrong length."""
    frames = [seed for seed in public_seeds() if len(seed) < 500][:8]
    whole = _packet(frames[0])
    return [_packet(seed) for seed in frames] + [
        _packet(frames[0], fragment=0x2000), _packet(frames[0], fragment=5), _packet(frames[0], words=15), whole[:-1],
        whole + b"x", b"", b"\x45", _packet(b""), b"\x60" + whole[1:], _packet(bytes(40), dport=_PORT + 1),
    ]


def datagram_seeds() -> List[bytes]:
    """Recorded ones of both channels."""
    return [b"\0\0" + seed for seed in public_seeds()] + [b"\1\0" + seed[1:] for seed in private_seeds()]


def recording_seeds() -> List[bytes]:
    """A recording, and invalid data."""
    head = decoding.header_line(_PORT) + "\n"
    line = decoding.datagram_line(Datagram(_UTC, "10.0.0.2", _PORT, "10.0.0.1", _PORT, public_seeds()[0])) + "\n"
    texts = (
        head + line * 3, head + line[:40], "", "{}", "[", "[" * 3000, head, head + "{}\n",
        head.replace("6666", "1e999"),
        head + line.replace("10.0.0.2", "x"), head + line.replace('"time": 1', '"time": "NaN", "x": 1'),
        head + line.replace('"time": 1', '"time": ' + "9" * 400 + ', "x": 1'), head.replace("1,", '"1",'),
        head + line.replace('"hex": "', '"hex": "0'), head + line.replace('"time": 1', '"time": -1, "x": 1'),
    )
    return [text.encode() for text in texts]


_JSON = (b'"time": ', b'"hex": "', b'"src": "', b'"sport": ', b"NaN", b"1e999", b"-1", b"null", b"[", b"{", b"\n")

PACKETS = Target("packets", packet_steps, packet_seeds, (b"\x45\0", b"\x1a\x0a", b"\x1a\x0b", b"\x20\0", b"\x11"))
DATAGRAMS = Target("datagrams", datagram_steps, datagram_seeds, (b"\x02\0\0\0", b"\x1a\x0a\0\x0a", b"\x1a\x0a\0\x28"))
RECORDING = Target("recording", recording_steps, recording_seeds, _JSON, is_timed=False)
