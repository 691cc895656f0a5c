"""docs/protocol.md describes what the code does: bytes, tables and numbers."""

import hashlib
import pathlib
import re

import pytest
from cryptography.hazmat.backends import default_backend
from cryptography.hazmat.primitives.ciphers import Cipher as AesCipher
from cryptography.hazmat.primitives.ciphers import algorithms, modes

from helpers import golden
from roah_rsbb.comm import frame
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.core.link.link import SILENT_S
from roah_rsbb.core.link.skew import WINDOW_S
from roah_rsbb.core.robots import MAX_NAME
from roah_rsbb.core.runs import machine
from roah_rsbb.core.settings import Settings
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BURST_COUNT, BURST_INTERVAL_S, PERIOD_S, BoxState, RobotState
from roah_rsbb.robot.link import SILENCE_S, STALE_S
from roah_rsbb.robot.machine import Act, box_transition

PAGE = (pathlib.Path(__file__).resolve().parents[3] / "docs" / "protocol.md").read_text(encoding="utf-8")
FLAT_PAGE = " ".join(PAGE.split())  # so that the page may be wrapped anywhere
KEEP = "–"
RETRY = "PREPARE (retry)"


def block_bytes(name):
    """The bytes at the beginning of each line of the page's block ```name."""
    text = re.search(rf"^```{name}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL).group(1)
    return bytes.fromhex("".join(re.match(r"(?:[0-9a-f]{2}(?: |$))+", line).group() for line in text.splitlines()))


def table(first_line):
    """The cells of the rows below a table's head."""
    lines = PAGE[PAGE.index(first_line):].split("\n\n")[0].splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def test_the_plain_frame_byte_by_byte():
    beacon = pb.RobotBeacon(team_name="MyTeam", robot_name="MyRobot", time=pb.Time(sec=1447000001, nsec=987654000))
    assert block_bytes("beacon") == frame.encode(beacon)


def test_the_encrypted_frame_byte_by_byte():
    recorded = golden.frame("bstate_prepare_ack_aes-128-cbc_pw8")
    frame_bytes, key, padded = (block_bytes(name) for name in ("frame", "key", "plain"))
    iv, ciphertext = frame_bytes[8:24], frame_bytes[24:]
    assert frame_bytes == recorded["frame"][:2] + bytes(2) + recorded["frame"][4:]  # the reserved bytes: nothing

    digest = b"PASSWORD"  # as the page says
    for _ in range(8):
        digest = hashlib.sha256(digest).digest()
    assert key == digest
    decryptor = AesCipher(algorithms.AES(key[:16]), modes.CBC(iv), backend=default_backend()).decryptor()
    assert padded == decryptor.update(ciphertext) + decryptor.finalize()
    assert padded[24:] == bytes([8] * 8) and len(padded) == 32

    message = frame.decode_private(frame_bytes, Key("PASSWORD"))
    assert message == pb.BenchmarkState(
        benchmark_type="HWV", benchmark_state=pb.BenchmarkState.PREPARE,
        acknowledgement=pb.Time(sec=1447000000, nsec=123456789),
    )
    assert frame.encode(message, Cipher.AES_128_CBC, Key("PASSWORD"), iv) == frame_bytes


def test_the_types_of_messages_and_ciphers():
    rows = table("| message | type | channel | direction |")
    kinds = {(kind.DESCRIPTOR.name, str(kind.MSG_TYPE), channel)
             for channel, kinds in (("public", frame.PUBLIC_TYPES), ("private", frame.PRIVATE_TYPES)) for kind in kinds}
    assert {(name, number, channel) for name, number, channel, _ in rows} == kinds
    assert ", ".join(f"{cipher.value} {cipher.label}" for cipher in Cipher) in FLAT_PAGE


def numbered_fields(name):
    """Number and name of each field in the page's table of message `name`; `_2` continues the name before it."""
    part = PAGE[PAGE.index(f"\n**{name}** "):]
    for row in re.findall(r"^\| ([\d, ]+) \| (`.*?`) \|", part[:part.index("\n\n**", 1)], re.MULTILINE):
        names = re.findall(r"`(\w+)`", row[1])
        for number, field in zip(row[0].split(", "), names):
            stem = re.sub(r"_[^_]+$", "", names[0])
            yield int(number), stem + field if field.startswith("_") else field


@pytest.mark.parametrize("message", [pb.RoahRsbbBeacon, pb.BenchmarkState, pb.RobotState])
def test_the_fields_of_messages(message):
    fields = [(field.number, field.name) for field in message.DESCRIPTOR.fields]
    assert sorted(numbered_fields(message.DESCRIPTOR.name)) == sorted(fields)


def test_the_robots_states():
    acts = {
        Act.KEEP: KEEP, Act.PREPARE: "PREPARING", Act.EXECUTE: "EXECUTING with the goal",
        Act.EXECUTE_NO_GOAL: "EXECUTING, there is no goal", Act.HALT: "STOP, halt", Act.END: "STOP", Act.ERROR: "error",
    }
    rows = table("| | STOP | PREPARING | WAITING_GOAL | EXECUTING | RESULT_TX |")
    assert [row[0] for row in rows] == [state.name for state in BoxState]
    for received, row in zip(BoxState, rows):
        for state, cell in zip(RobotState, row[1:]):
            usual, _, in_hnf = cell.partition("; in HNF ")
            assert usual == acts[box_transition("HOPF", received, state).act]
            assert (in_hnf or usual) == acts[box_transition("HNF", received, state).act]


def test_the_boxes_states():
    cells = {
        machine.Reaction.KEEP: KEEP, machine.Reaction.EXECUTE: "GOAL_TX, or WAITING_RESULT without a goal",
        machine.Reaction.AWAIT_RESULT: "WAITING_RESULT", machine.Reaction.RETRY: RETRY,
        machine.Reaction.RETRY_WITH_GOAL: f"{RETRY}, or {KEEP} without a goal",
        machine.Reaction.GOAL_DONE: "next goal: PREPARE; after the last: STOP",
    }
    rows = table("| | STOP | PREPARE | GOAL_TX | WAITING_RESULT |")
    assert [row[0] for row in rows] == [state.name for state in RobotState]
    for robot, row in zip(RobotState, rows):
        assert row[1:] == [cells[machine.REACTIONS[box, robot]] for box in BoxState]


@pytest.mark.parametrize("said", [
    f"clock skew of {Settings().allowed_skew} s or more",
    f"largest value of the last {WINDOW_S} s",
    f"EXECUTING for {Settings().check_messages_saved_timeout:g} s with `messages_saved` 0",
    f"no RobotState for {SILENT_S:g} s",
    f"no beacon of a robot for {Settings().robot_timeout:g} s",
    f"defaults 10.255.255.255 and {Settings().rsbb_port}",
    f"send at most {Settings().max_datagram} bytes",
    {10: "ten"}[BURST_COUNT] + f" times at intervals of {BURST_INTERVAL_S * 1000:g} ms, then each second",
    f"no datagram from the box for {SILENCE_S:g} s",
    f"continues for {STALE_S:g} s",
    f"1 to {MAX_NAME} characters",
    f"{Settings().listen_duration:g} s at the start",
])
def test_the_numbers(said):
    assert said in FLAT_PAGE and PERIOD_S == 1
