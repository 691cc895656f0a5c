"""docs/robot_without_ros.md: what it tells teams is what the code does, and its example completes benchmarks."""

import asyncio
import contextlib
import hashlib
import importlib.util
import pathlib
import re

import pytest
from cryptography.hazmat.backends import default_backend
from cryptography.hazmat.primitives.ciphers import Cipher as AesCipher
from cryptography.hazmat.primitives.ciphers import algorithms, modes

from helpers import golden
from helpers.small_box import BROADCAST, PASSWORD, ROBOT, TEAM, SmallBox
from roah_rsbb.comm import frame
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.core.link.link import SILENT_S
from roah_rsbb.core.link.skew import WINDOW_S
from roah_rsbb.core.robots import MAX_NAME
from roah_rsbb.core.settings import Settings
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BURST_COUNT, BURST_INTERVAL_S, PERIOD_S, BoxState, RobotState
from roah_rsbb.robot.link import STALE_S
from roah_rsbb.robot.machine import Act, box_step
from roah_rsbb.robot.watch import SILENCE_S

DOCS = pathlib.Path(__file__).resolve().parents[3] / "docs"
PAGE = (DOCS / "robot_without_ros.md").read_text(encoding="utf-8")
FLAT_PAGE = " ".join(PAGE.split())  # so that it may be wrapped anywhere
EXAMPLE = DOCS / "examples" / "my_robot.py"


def block(name):
    """The text of the page's block ```name."""
    return re.search(rf"^```{name}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL).group(1)


def block_bytes(name):
    """The bytes at the beginning of each line of a block."""
    lines = block(name).splitlines()
    return bytes.fromhex("".join(re.match(r"(?:[0-9a-f]{2}(?: |$))+", line).group() for line in lines))


def table(first_line):
    """The cells of the rows below a table's head; empty cells at the ends of lines left away."""
    lines = PAGE[PAGE.index(first_line):].split("\n\n")[0].splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


# -- the example ------------------------------------------------------------------------------------


@pytest.fixture
def example():
    spec = importlib.util.spec_from_file_location("my_robot", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.WORK_S = 0.01
    return module


@pytest.fixture
def run_program(example, monkeypatch):
    """Runs the program on the network of a box until `body(box)` has ended."""
    run = asyncio.run

    def run_on(box, body):
        async def together(robot):
            task = asyncio.get_event_loop().create_task(robot)
            async with box:
                await body(box)
            task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await task

        monkeypatch.setattr("sys.argv", ["my_robot.py", TEAM, BROADCAST, "--port", str(box.port), "--bind", ROBOT])
        monkeypatch.setattr("asyncio.run", lambda robot: run(together(robot)))
        example.main()
    return run_on


def test_the_page_shows_the_example_as_it_is_and_it_is_short():
    text = EXAMPLE.read_text(encoding="utf-8")
    assert block("python") == text
    assert len(text.splitlines()) < 60


@pytest.mark.parametrize("code, goals, result", [
    ("HGTKMH", [{}], ""),
    ("HWV", [{}], ""),
    ("HOPF", [{}, {}], '{class: "cups", instance: "red_cup", x: 0.42, y: 0.17, theta: 1.57}'),
    ("HPPF", [{}], '{person_name: "Annie", x: 1.2, y: 0.8, theta: 3.14}'),
    ("HNF", [{"generic_goal": "[1, 2, 3]"}, {"target_pose_x": 4, "target_pose_y": 5, "target_pose_theta": 6}], ""),
    ("HGMF", [{"generic_goal": "[1, 2, 3]"}], ""),
    ("HOMF", [{"initial_state": [True, False], "switches": [2, 1]}], ""),
])
def test_the_example_completes(run_program, monkeypatch, capsys, code, goals, result):
    monkeypatch.setenv("ROAH_RSBB_KEY", PASSWORD)
    box = SmallBox(code, list(goals))
    run_program(box, SmallBox.run_through)
    assert [message.generic_result for message in box.finished] == [result] * len(goals)
    assert all(message.messages_saved > 0 for message in box.received if message.robot_state == RobotState.EXECUTING)
    assert box.logged["notifications"] == (["going to the door"] if code == "HWV" else [])
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == f"{code}: preparing" and lines[1].startswith(f"{code}: executing")
    assert lines[-1] == "stopped: the box sent STOP"
    if result:
        assert f"`generic_result` = `{result}`" in FLAT_PAGE


def test_the_example_follows_a_person_until_it_is_stopped(run_program, monkeypatch, capsys):
    monkeypatch.setenv("ROAH_RSBB_KEY", PASSWORD)

    async def stop_while_it_follows(box):
        await box.until(lambda: box.received)
        box.start()
        await box.until(lambda: box.robot_state is RobotState.EXECUTING)
        await asyncio.sleep(0.1)  # ten times as long as its work
        assert box.robot_state is RobotState.EXECUTING
        box.stop()
        await box.until(lambda: box.robot_state is RobotState.STOP)

    run_program(SmallBox("HPFF"), stop_while_it_follows)
    assert "stopped: the box sent STOP" in capsys.readouterr().out


@pytest.mark.parametrize("password, host, told", [
    (None, BROADCAST, "password is empty"), (PASSWORD, "no such host", "no known host"),
])
def test_the_example_says_why_it_cannot_begin(example, monkeypatch, capsys, password, host, told):
    monkeypatch.delenv("ROAH_RSBB_KEY", raising=False)
    if password is not None:
        monkeypatch.setenv("ROAH_RSBB_KEY", password)
    monkeypatch.setattr("sys.argv", ["my_robot.py", TEAM, host, "--bind", ROBOT])
    with pytest.raises(SystemExit):
        example.main()
    assert told in capsys.readouterr().err


# -- what the page says -----------------------------------------------------------------------------


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


def test_the_states():
    acts = {
        Act.KEEP: "–", Act.PREPARE: "PREPARING", Act.EXECUTE: "EXECUTING with the goal",
        Act.EXECUTE_NO_GOAL: "EXECUTING, there is no goal", Act.HALT: "STOP, halt", Act.END: "STOP", Act.ERROR: "error",
    }
    rows = table("| | STOP | PREPARING | WAITING_GOAL | EXECUTING | RESULT_TX |")
    assert [row[0] for row in rows] == [state.name for state in BoxState]
    for received, row in zip(BoxState, rows):
        for state, cell in zip(RobotState, row[1:]):
            usual, _, in_hnf = cell.partition("; in HNF ")
            assert usual == acts[box_step("HOPF", received, state).act]
            assert (in_hnf or usual) == acts[box_step("HNF", received, state).act]


def test_the_types_of_messages_and_ciphers():
    rows = table("| message | type | channel | direction |")
    kinds = {(kind.DESCRIPTOR.name, str(kind.MSG_TYPE), channel)
             for channel, kinds in (("public", frame.PUBLIC_TYPES), ("private", frame.PRIVATE_TYPES)) for kind in kinds}
    assert {(name, number, channel) for name, number, channel, _ in rows} == kinds
    assert ", ".join(f"{cipher.value} {cipher.label}" for cipher in Cipher) in FLAT_PAGE


@pytest.mark.parametrize("said", [
    f"is {Settings().allowed_skew} s or more",
    f"arrival of {WINDOW_S} s",
    f"EXECUTING for {Settings().check_messages_saved_timeout:g} s with `messages_saved` 0",
    f"nothing heard for {SILENT_S:g} s",
    f"Blocked for {SILENT_S:g} s",
    f"Not heard for {Settings().robot_timeout:g} s",
    f"port {Settings().rsbb_port} unless",
    f"send at most {Settings().max_datagram} bytes",
    {10: "ten"}[BURST_COUNT] + f" times at intervals of {BURST_INTERVAL_S * 1000:g} ms, then each second",
    f"Hear it for {SILENCE_S:g} s",
    f"goes on for {STALE_S:g} s",
    f"1 to {MAX_NAME} characters",
])
def test_the_numbers(said):
    assert said in FLAT_PAGE and PERIOD_S == 1


def test_its_links_lead_somewhere():
    headings = re.findall(r"^#+ (.*)$", PAGE, re.MULTILINE)
    anchors = {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}
    targets = re.findall(r"\]\((.*?)\)", FLAT_PAGE)
    assert len(targets) > 5
    for target in targets:
        assert target[1:] in anchors if target.startswith("#") else (DOCS / target).exists(), target
