"""Datagrams that anybody on the network can send to the box (docs/protocol.md, "Frame")."""

import struct
from typing import Iterator, List

from fuzzing.reader import Reader
from fuzzing.target import Step, Target
from helpers import golden
from roah_rsbb.comm import frame
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.comm.frame import BadDatagram
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.radio import wire_convert

KEY = Key(golden.PASSWORD)
_IV = bytes(range(16))
# The first byte of an input for a private channel: the number of a cipher that the rest is encrypted with, or this.
_AS_IT_IS = 0
_CIPHERS = (Cipher.AES_128_CBC, Cipher.AES_128_ECB, Cipher.AES_256_ECB, Cipher.AES_256_CBC)
_LARGEST = 65507  # bytes of a datagram
_LONG_AS_TEXT = 3000


def public_steps(data: bytes) -> Iterator[Step]:
    """A datagram on the public channel: either a message that can be encoded again, or BadDatagram."""
    messages: List[object] = []

    def receive() -> None:
        try:
            message = frame.decode_public(data[:_LARGEST])
        except BadDatagram as bad:
            assert len(str(bad)) < 300
            return
        messages.append(message)
        if isinstance(message, pb.RobotBeacon):
            wire_convert.time_of(message.time)
        elif isinstance(message, pb.TabletBeacon):
            wire_convert.tablet_of(message)

    yield receive
    for message in messages:
        assert frame.decode_public(frame.encode(message)) == message or _has_nan(message)


def private_steps(data: bytes) -> Iterator[Step]:
    """A datagram on a private channel, with or without the team's key."""
    datagram = _private_datagram(data)
    messages: List[object] = []

    def receive() -> None:
        try:
            message = frame.decode_private(datagram, KEY)
        except BadDatagram as bad:
            assert len(str(bad)) < 300
            return
        messages.append(message)
        if isinstance(message, pb.RobotState):
            wire_convert.report_of(message).lines()

    yield receive
    for message in messages:
        if len(str(message)) > _LONG_AS_TEXT:
            continue  # sent again, its packed fields may be too many
        again = frame.decode_private(frame.encode(message, Cipher.AES_128_CBC, KEY), KEY)
        assert again == message or _has_nan(message)


def _private_datagram(data: bytes) -> bytes:
    reader = Reader(data)
    number = reader.byte() % (len(_CIPHERS) + 1)
    if number == _AS_IT_IS:
        return reader.rest()[:_LARGEST]
    cipher = _CIPHERS[number - 1]
    payload = KEY.encrypt(cipher, reader.rest()[:_LARGEST - 48], _IV[:cipher.iv_size])
    return struct.pack(">BBHI", frame.VERSION, cipher, 0, len(payload)) + payload


def _has_nan(message: object) -> bool:
    """Whether it contains NaN, which is unequal even to itself."""
    return message != message or "nan" in str(message)


# -- inputs to begin with ---------------------------------------------------------------------------------


def _recorded(channel: str) -> List[bytes]:
    records = golden.load("frames") + golden.load("bad_frames")
    return [
        bytes.fromhex(record.get("frame_hex") or record["datagram_hex"])
        for record in records if record["channel"] == channel
    ]


def public_seeds() -> List[bytes]:
    """Recorded datagrams, and large ones."""
    many = pb.RoahRsbbBeacon()
    for number in range(200):
        many.benchmarking_teams.add(team_name=f"team {number}", robot_name="r", rsbb_port=number)
    beacon = pb.RobotBeacon(team_name="t" * 32_000, robot_name="r" * 32_000, time=pb.Time(sec=-1, nsec=2**62))
    payload = struct.pack(">HH", 6666, 10) + many.SerializePartialToString()
    header = struct.pack(">BBHI", 2, 0, 0, len(payload))
    empty = struct.pack(">HH", 6666, 10) + b"\x0a\x00" * 32_000
    return _recorded("public") + [
        frame.encode(beacon), header + payload, struct.pack(">BBHI", 2, 0, 0, len(empty)) + empty, bytes(_LARGEST),
    ]


def private_seeds() -> List[bytes]:
    """Recorded datagrams, their contents (which the target encrypts), and large ones."""
    plain = [
        struct.pack(">HH", 6666, 20 if record["message_type"] == "BenchmarkState" else 40)
        + bytes.fromhex(record["payload_protobuf_hex"])
        for record in golden.load("frames")
        if record["message_type"] in ("BenchmarkState", "RobotState") and record.get("payload_protobuf_hex")
    ]
    at_all = {"time": pb.Time(sec=1, nsec=0), "messages_saved": 1, "robot_state": 4}
    large = [
        pb.RobotState(notifications=[str(number) for number in range(390)], **at_all),
        pb.RobotState(visitor=["v" * 60_000], **at_all),
        pb.RobotState(generic_result="[" * 60_000, object_pose_x=float("nan"), **at_all),
        pb.RobotState(activation_event=["\0\n\x7f\u2028" * 10], devices_dimmer=2**32 - 1, **at_all),
    ]
    plain += [struct.pack(">HH", 6666, 40) + message.SerializeToString() for message in large]
    plain.append(struct.pack(">HH", 6666, 40) + b"\x42\x00" * 32_000)
    return [b"\0" + datagram for datagram in _recorded("private")] + [
        bytes([1 + number % 4]) + payload for number, payload in enumerate(plain)
    ]


_TOKENS = (
    b"\x02\x00\x00\x00", b"\x02\x02\x00\x00", b"\x1a\x0a\x00\x0a", b"\x1a\x0a\x00\x1e", b"\x1a\x0a\x00\x23",
    b"\x1a\x0a\x00\x14", b"\x1a\x0a\x00\x28", b"\x0a\x00", b"\x42\x00", b"\xff" * 9 + b"\x01", b"\xff" * 10,
    b"\x0a\x0b\x08" + b"\xff" * 9 + b"\x01", b"\x18\x04", b"\x10\x01", b"\xc3\x28", b"\xed\xa0\x80", b"\x0b", b"\x0c",
)

PUBLIC = Target("public", public_steps, public_seeds, _TOKENS)
PRIVATE = Target("private", private_steps, private_seeds, _TOKENS)
