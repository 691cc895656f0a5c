"""docs/robot_without_ros.md: its numbers are those of the code, and its example completes benchmarks."""

import asyncio
import contextlib
import importlib.util
import pathlib
import re

import pytest

from helpers.small_box import BROADCAST, PASSWORD, ROBOT, TEAM, SmallBox
from roah_rsbb.core.link.link import SILENT_S
from roah_rsbb.core.settings import Settings
from roah_rsbb.protocol import RobotState

DOCS = pathlib.Path(__file__).resolve().parents[3] / "docs"
PAGE = (DOCS / "robot_without_ros.md").read_text(encoding="utf-8")
FLAT_PROTOCOL = " ".join((DOCS / "protocol.md").read_text(encoding="utf-8").split())
FLAT_PAGE = " ".join(PAGE.split())  # so that the page may be wrapped anywhere
EXAMPLE = DOCS / "examples" / "my_robot.py"


def block(name):
    """The text of the page's block ```name."""
    return re.search(rf"^```{name}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL).group(1)


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
    """Run the program on the network of a box until `body(box)` has ended."""
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


def test_the_page_shows_the_example_unchanged_and_it_is_short():
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
        assert f"`generic_result` = `{result}`" in FLAT_PROTOCOL


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


@pytest.mark.parametrize("password, host, reported", [
    (None, BROADCAST, "password is empty"), (PASSWORD, "no such host", "nor a known host"),
])
def test_the_example_says_why_it_cannot_begin(example, monkeypatch, capsys, password, host, reported):
    monkeypatch.delenv("ROAH_RSBB_KEY", raising=False)
    if password is not None:
        monkeypatch.setenv("ROAH_RSBB_KEY", password)
    monkeypatch.setattr("sys.argv", ["my_robot.py", TEAM, host, "--bind", ROBOT])
    with pytest.raises(SystemExit):
        example.main()
    assert reported in capsys.readouterr().err


# -- what the page says -----------------------------------------------------------------------------

@pytest.mark.parametrize("said", [
    f"by {Settings().allowed_skew} s or more",
    f"EXECUTING for {Settings().check_messages_saved_timeout:g} s with `messages_saved` 0",
    f"no message for {SILENT_S:g} s",
    f"Blocked for {SILENT_S:g} s",
    f"arrives for {Settings().robot_timeout:g} s",
])
def test_the_numbers(said):
    assert said in FLAT_PAGE
