"""Encoding: the original's bytes, given its initialisation vector."""

import pytest
from google.protobuf import json_format
from google.protobuf.message import EncodeError

from helpers import golden
from roah_rsbb.comm import frame
from roah_rsbb.comm.ciphers import Cipher, Key, cipher_by_label
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

FRAMES = golden.load("frames")
ROBOT_BEACON = pb.RobotBeacon(team_name="a", robot_name="b", time=pb.Time(sec=1, nsec=2))
ROBOT_STATE = pb.RobotState(time=pb.Time(sec=1, nsec=2), messages_saved=0, robot_state=pb.RobotState.STOP)


def message_of(record):
    """The message, built from the values by name and not from its bytes."""
    return json_format.ParseDict(record["fields"], getattr(pb, record["message_type"])())


def cipher_of(record):
    return Cipher.NONE if record["cipher"] == "none" else cipher_by_label(record["cipher"])


@pytest.mark.parametrize("record", FRAMES, ids=lambda r: r["name"])
def test_encodes_the_originals_bytes(record):
    key = Key(record["password"]) if record["password"] else None
    message, cipher = message_of(record), cipher_of(record)
    expected = bytes.fromhex(record["frame_hex"])
    expected = expected[:2] + b"\0\0" + expected[4:]  # the original's reserved bytes are uninitialised
    assert frame.encode(message, cipher, key, bytes.fromhex(record["iv_hex"])) == expected
    assert frame.encoded_size(message, cipher) == len(expected)


@pytest.mark.parametrize("cipher", list(Cipher), ids=lambda c: c.label)
def test_encoded_size_is_the_size_of_the_datagram(cipher):
    state = pb.RobotState()
    state.CopyFrom(ROBOT_STATE)
    for size in range(17):  # each remainder of a cipher's block
        state.generic_result = "x" * size
        assert frame.encoded_size(state, cipher) == len(frame.encode(state, cipher, Key("PASSWORD"))), size


def test_refuses_a_message_that_is_only_part_of_a_datagram():
    with pytest.raises(ValueError, match="BenchmarkingTeam is not sent"):
        frame.encode(pb.BenchmarkingTeam(team_name="a", robot_name="b", rsbb_port=1))


def test_refuses_a_cipher_without_key():
    with pytest.raises(ValueError, match="aes-128-cbc needs a key"):
        frame.encode(ROBOT_STATE, Cipher.AES_128_CBC)


def test_refuses_an_incomplete_message():
    with pytest.raises(EncodeError):
        frame.encode(pb.RobotBeacon(team_name="a"))


def test_channels_know_their_messages():
    assert set(frame.PUBLIC_TYPES) == {pb.RoahRsbbBeacon, pb.RobotBeacon, pb.TabletBeacon}
    assert set(frame.PRIVATE_TYPES) == {pb.BenchmarkState, pb.RobotState}
