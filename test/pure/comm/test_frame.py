"""Decoding: everything recorded, and everything that is not a frame."""

import struct

import pytest
from google.protobuf import json_format
from google.protobuf.message import EncodeError
from hypothesis import given
from hypothesis import strategies as st

from helpers import golden
from helpers.examples import examples
from roah_rsbb.comm import frame
from roah_rsbb.comm.ciphers import Cipher, Key, cipher_by_label
from roah_rsbb.comm.frame import BadDatagram, FrameFault
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

KEY = Key(golden.PASSWORD)
FRAMES = [record for record in golden.load("frames") if record["channel"] == "public" or record["password"]]

# The recorded datagrams that kill or disturb the original, and what they are here.
REASONS = {
    "zero_length": FrameFault.TOO_SHORT,
    "truncated_header_5": FrameFault.TOO_SHORT,
    "header_only_8": FrameFault.TOO_SHORT,
    "payload_size_too_big": FrameFault.SIZE,
    "payload_size_too_small": FrameFault.SIZE,
    "payload_size_excl_msg_header": FrameFault.SIZE,
    "payload_size_little_endian": FrameFault.SIZE,
    "unknown_msg_type": FrameFault.UNKNOWN_TYPE,
    "benchmarking_team_toplevel": FrameFault.UNKNOWN_TYPE,
    "encrypted_on_public": FrameFault.ENCRYPTED,
    "unknown_cipher_on_public": FrameFault.UNKNOWN_CIPHER,
    "plaintext_on_private_len_of_last_plain": FrameFault.PLAIN,
    "unknown_cipher_on_private": FrameFault.UNKNOWN_CIPHER,
    "wrong_cipher_id": FrameFault.UNDECRYPTABLE,
    "bit_flip_iv": FrameFault.UNDECRYPTABLE,
    "ciphertext_truncated_1": FrameFault.SIZE,
    "cipher_iv_only": FrameFault.SIZE,
    "cipher_iv_short": FrameFault.SIZE,
    "encrypted_empty_plaintext": FrameFault.TOO_SHORT,
    "encrypted_2byte_plaintext": FrameFault.TOO_SHORT,
    "public_type_on_private": FrameFault.WRONG_CHANNEL,
    "garbage_protobuf": FrameFault.MALFORMED,
    "missing_required_time": FrameFault.INCOMPLETE,
    "invalid_utf8": FrameFault.NOT_UTF8,
    "version_0": FrameFault.OTHER_VERSION,
    "version_255_reserved_set": FrameFault.OTHER_VERSION,
}
# Bad for some original, good here: any cipher of the right key, all generations, any size.
GOOD = {
    "other_cipher_right_key": "RobotState",
    "rsbb_beacon_2015_no_door_win_detect": "RoahRsbbBeacon",
    "unknown_field": "RobotBeacon",
    "oversize_encrypted_1024": "RobotState",
    "oversize_65k": "RobotBeacon",
}


def decode(datagram, channel, key=KEY):
    return frame.decode_public(datagram) if channel == "public" else frame.decode_private(datagram, key)


def plain(protobuf, kind=pb.RobotBeacon):
    payload = struct.pack(">HH", kind.COMP_ID, kind.MSG_TYPE) + protobuf
    return struct.pack(">BBHI", 2, 0, 0, len(payload)) + payload


def refused(datagram, channel="public", key=KEY):
    with pytest.raises(BadDatagram) as caught:
        decode(datagram, channel, key)
    return caught.value


@pytest.mark.parametrize("record", FRAMES, ids=lambda r: r["name"])
def test_decodes_the_originals_frames(record):
    message = decode(bytes.fromhex(record["frame_hex"]), record["channel"], Key(record["password"] or "-"))
    assert message == json_format.ParseDict(record["fields"], getattr(pb, record["message_type"])())


@pytest.mark.parametrize("name", golden.SESSIONS)
def test_decodes_the_recorded_sessions(name):
    for record in golden.load(name):
        channel = "public" if record["dport"] == 6666 else "private"
        message = decode(bytes.fromhex(record["hex"]), channel)
        assert message.DESCRIPTOR.name == record["decoded"]["type"]
        assert message == json_format.ParseDict(record["decoded"]["fields"], type(message)())


def test_a_plain_frame_of_an_empty_password_is_refused():
    record = golden.frame("rstate_private_empty_password_is_plain")
    assert refused(record["frame"], "private").reason is FrameFault.PLAIN


@pytest.mark.parametrize("record", golden.load("bad_frames"), ids=lambda r: r["name"])
def test_recorded_bad_datagrams(record, capfd):
    datagram = bytes.fromhex(record["datagram_hex"])
    if record["name"] in GOOD:
        assert decode(datagram, record["channel"]).DESCRIPTOR.name == GOOD[record["name"]]
    else:
        assert refused(datagram, record["channel"]).reason is REASONS[record["name"]]
    assert capfd.readouterr() == ("", "")  # protobuf's C++ library writes a line per datagram if asked


def test_the_payload_size_may_leave_out_iv_and_padding_and_nothing_else():
    datagram = golden.frame("rstate_hwv_aes-128-cbc_pw8")["frame"]
    real = len(datagram) - 8
    accepted = []
    plain = len(frame.decrypt(datagram, KEY))
    assert real - 32 <= plain < real - 16
    for size in (0, real - 33, plain, real - 16, real, real + 1, 0xFFFFFFFF):
        try:
            frame.decode_private(datagram[:4] + struct.pack(">I", size) + datagram[8:], KEY)
        except BadDatagram as bad:
            assert bad.reason is FrameFault.SIZE
        else:
            accepted.append(size)
    assert accepted == [plain, real - 16, real]


@pytest.mark.long
def test_a_wrong_password_has_one_reason_whatever_the_padding():
    message = pb.RobotState(time=pb.Time(sec=1, nsec=2), messages_saved=0, robot_state=pb.RobotState.STOP)
    wrong = Key("wrong")
    datagrams = [frame.encode(message, Cipher.AES_128_CBC, KEY, iv.to_bytes(16, "big")) for iv in range(2000)]
    bad = [refused(datagram, "private", wrong) for datagram in datagrams]
    assert {error.reason for error in bad} == {FrameFault.UNDECRYPTABLE}
    assert len({error.detail for error in bad}) == 2  # some paddings looked right


def test_a_private_message_in_the_open_is_refused():
    state = pb.BenchmarkState(benchmark_type="HWV", benchmark_state=pb.BenchmarkState.STOP)
    bad = refused(frame.encode(state))
    assert bad.reason is FrameFault.WRONG_CHANNEL
    assert "BenchmarkState" in bad.detail


def test_a_frame_of_version_1_is_named():
    protobuf = pb.RobotBeacon(team_name="a", robot_name="b", time=pb.Time(sec=1, nsec=2)).SerializeToString()
    assert refused(struct.pack(">HHI", 6666, 30, len(protobuf)) + protobuf).reason is FrameFault.VERSION_1


@pytest.mark.parametrize("protobuf, missing", [
    (b"", "team_name, robot_name, time "),
    (b"\x0a\x01a\x12\x01b\x1a\x02\x08\x01", "time.nsec "),
])
def test_missing_fields_are_named(protobuf, missing):
    bad = refused(plain(protobuf))
    assert bad.reason is FrameFault.INCOMPLETE
    assert "RobotBeacon without " + missing in bad.detail


def test_an_unknown_state_is_a_missing_field():
    state = b"\x0a\x04\x08\x01\x10\x02\x10\x00\x18\x05"  # robot_state 5
    payload = struct.pack(">HH", 6666, 40) + state
    body = KEY.encrypt(Cipher.AES_128_ECB, payload)
    bad = refused(struct.pack(">BBHI", 2, 1, 0, len(body)) + body, "private")
    assert bad.reason is FrameFault.INCOMPLETE
    assert "RobotState without robot_state" in bad.detail


def test_many_missing_fields_are_not_all_listed():
    bad = refused(plain(b"\x0a\x00" * 900, pb.RoahRsbbBeacon))
    assert bad.reason is FrameFault.INCOMPLETE
    assert len(bad.detail) < 300


GOOD_BEACON = b"\x0a\x01a\x12\x01b\x1a\x04\x08\x01\x10\x02"


@pytest.mark.parametrize("protobuf, reason", [
    (b"\x0a\x01a\x12\x02\xc3(" + GOOD_BEACON[6:], FrameFault.NOT_UTF8),
    (b"\x0a\x03\xed\xa0\x80" + GOOD_BEACON[3:], FrameFault.NOT_UTF8),  # a surrogate
    (GOOD_BEACON + b"\x0c", FrameFault.MALFORMED),  # a stray end of group: C++ would stop there in silence
    (GOOD_BEACON + b"\x0b\x0c", FrameFault.MALFORMED),
    (GOOD_BEACON + b"\x0f", FrameFault.MALFORMED),
    (GOOD_BEACON + b"\x00\x00", FrameFault.MALFORMED),
    (GOOD_BEACON + b"\x28" + b"\xff" * 10 + b"\x01", FrameFault.MALFORMED),
    (GOOD_BEACON + b"\x28\xff", FrameFault.MALFORMED),
    (GOOD_BEACON + b"\x29" + b"1234567", FrameFault.MALFORMED),
    (GOOD_BEACON + b"\x2d" + b"123", FrameFault.MALFORMED),
    (GOOD_BEACON + b"\x2a\xff\xff\xff\xff\x0f", FrameFault.MALFORMED),
    (GOOD_BEACON + b"\xfa\xff\xff\xff\xff\xff\xff\xff\x7f\x00", FrameFault.MALFORMED),
    (b"\x8a\x00\x01a" + GOOD_BEACON[3:], FrameFault.MALFORMED),  # a tag longer than need be
    (GOOD_BEACON[:8] + b"\x05\x08\x01\x10\x02\x1c", FrameFault.MALFORMED),  # inside the time
    (b"\x0b" * 65000, FrameFault.MALFORMED),
    (b"\x08\x01" * 32000, FrameFault.MALFORMED),
    (b"\xff" * 65000, FrameFault.MALFORMED),
])
def test_malformed_protobufs(protobuf, reason, capfd):
    assert refused(plain(protobuf)).reason is reason
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("field", [
    b"\x28", b"\x28\xff", b"\x291234567", b"\x2d123", b"\x2a", b"\x2a\x02a", b"\xff"])
def test_a_message_that_ends_too_early(field):
    assert "ends within a field" in refused(plain(GOOD_BEACON + field)).detail


def test_text_in_inner_messages_is_checked():
    bad = refused(plain(b"\x0a\x08\x0a\x01\xff\x12\x01b\x18\x01", pb.RoahRsbbBeacon))
    assert (bad.reason, bad.detail) == (FrameFault.NOT_UTF8, "team_name of RoahRsbbBeacon")


@pytest.mark.parametrize("protobuf", [
    GOOD_BEACON + b"\xa2\x06\x03xyz" + b"\x29" + b"12345678" + b"\x2d" + b"1234" + b"\x28\x80\x80\x01",
    GOOD_BEACON + GOOD_BEACON,  # the last one counts
    b"\x0a\x81\x00a" + GOOD_BEACON[3:],  # a length longer than need be
])
def test_unusual_but_well_formed(protobuf):
    assert frame.decode_public(plain(protobuf)).team_name == "a"


def test_any_time_is_decoded():
    for sec in (-(2 ** 63), -1, 2 ** 32, 2 ** 63 - 1):
        beacon = pb.RobotBeacon(team_name="a", robot_name="b", time=pb.Time(sec=sec, nsec=-sec - 1))
        assert frame.decode_public(frame.encode(beacon)).time.sec == sec


def decode_or_bad(datagram):
    """Decode a datagram as the channels do. The result is a message or BadDatagram."""
    for channel in ("public", "private"):
        try:
            message = decode(datagram, channel)
        except BadDatagram:
            continue
        assert message.IsInitialized()
        for field, value in message.ListFields():
            assert isinstance(value, str) or not field.name.endswith("name")


@pytest.mark.parametrize("record", [record for record in FRAMES if len(record["frame_hex"]) < 300],
                         ids=lambda r: r["name"])
def test_truncations_and_bit_flips(record):
    datagram = bytes.fromhex(record["frame_hex"])
    for size in range(len(datagram)):
        assert refused(datagram[:size], record["channel"]).reason is not None
    for bit in range(len(datagram) * 8):
        flipped = bytearray(datagram)
        flipped[bit // 8] ^= 1 << bit % 8
        decode_or_bad(bytes(flipped))


@pytest.mark.long
def test_bit_flips_in_the_protobuf_of_a_beacon():
    protobuf = bytes.fromhex(golden.frame("rsbb_beacon_many_teams_extremes")["payload_protobuf_hex"])
    for bit in range(len(protobuf) * 8):
        flipped = bytearray(protobuf)
        flipped[bit // 8] ^= 1 << bit % 8
        decode_or_bad(plain(bytes(flipped), pb.RoahRsbbBeacon))


@examples(200)
@given(st.binary(max_size=300))
def test_random_bytes(datagram):
    decode_or_bad(datagram)


@examples(300)
@given(st.sampled_from(frame.PUBLIC_TYPES + frame.PRIVATE_TYPES), st.binary(max_size=200),
       st.sampled_from(list(Cipher)))
def test_random_protobufs(kind, protobuf, cipher):
    payload = struct.pack(">HH", kind.COMP_ID, kind.MSG_TYPE) + protobuf
    body = payload if cipher is Cipher.NONE else KEY.encrypt(cipher, payload)
    decode_or_bad(struct.pack(">BBHI", 2, cipher, 0, len(body)) + body)


def test_a_robots_message_has_room_for_a_datagram_of_strings_and_not_for_many_more():
    """Each new string is recorded. Hundreds in one datagram would take the box longer than a tick."""
    state = pb.RobotState(time=pb.Time(sec=1, nsec=0), messages_saved=0, robot_state=0)
    state.notifications.extend("x" for _ in range(329))
    assert decode(frame.encode(state, Cipher.AES_128_CBC, KEY), "private") == state
    state.notifications.extend("x" for _ in range(100))
    bad = refused(frame.encode(state, Cipher.AES_128_CBC, KEY), "private")
    assert (bad.reason, bad.detail) == (FrameFault.MALFORMED, "RobotState: it has more than 400 fields")


# -- encoding: the original's bytes, given its initialisation vector ----------------------------------

ALL_FRAMES = golden.load("frames")
ROBOT_STATE = pb.RobotState(time=pb.Time(sec=1, nsec=2), messages_saved=0, robot_state=pb.RobotState.STOP)


def message_of(record):
    """The message, built from the values by name and not from its bytes."""
    return json_format.ParseDict(record["fields"], getattr(pb, record["message_type"])())


def cipher_of(record):
    return Cipher.NONE if record["cipher"] == "none" else cipher_by_label(record["cipher"])


@pytest.mark.parametrize("record", ALL_FRAMES, ids=lambda r: r["name"])
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
