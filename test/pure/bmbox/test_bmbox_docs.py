"""The authors' page shows the real files, and its examples run."""

import asyncio
import json
import pathlib
import re
import unittest.mock

import pytest

from roah_rsbb.bmbox.framework.ground_truth import Pose3
from roah_rsbb.bmbox.framework.rehearsal import Poses, rehearse
from roah_rsbb.robot.goals import Goal
from roah_rsbb.rulebook.errors import ConfigErrors

ROOT = pathlib.Path(__file__).resolve().parents[3]
PAGE = (ROOT / "docs" / "write_a_benchmark.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def test_the_rules_are_those_of_the_file():
    assert blocks("python")[0] == (ROOT / "src/roah_rsbb/bmbox/stb.py").read_text(encoding="utf-8")


def test_the_parameters_are_those_of_the_file():
    assert blocks("yaml")[0] == (ROOT / "config/modules/STB.yaml").read_text(encoding="utf-8")


def test_the_rules_of_a_competition_run(tmp_path):
    """Also after a crash, the note has the time at which the run began."""
    _, _, parameters, _ = blocks("yaml")
    (tmp_path / "FetchMug.yaml").write_text(parameters, encoding="utf-8")
    path = tmp_path / "FetchMug.py"
    path.write_text(blocks("python")[1], encoding="utf-8")
    rehearsal = rehearse(str(path), Poses(robot=Pose3(1.5, 5.0, 0.0, 0.0)))
    noted = rehearsal.run.steps[0].request.note
    for colour in ("red", "green"):
        rehearsal.answer()
        rehearsal.result(f"{{colour: {colour}}}")
        rehearsal.restart()
        assert json.loads(noted) == rehearsal.score["began"]
    assert rehearsal.finished
    assert rehearsal.score["fetched"] == 1
    assert rehearsal.score["blue", "distance"] == 3.0


def test_parameters_with_errors_are_not_rehearsed(tmp_path):
    (tmp_path / "FetchMug.yaml").write_text("colours: red\ntable: [1, 2]\n", encoding="utf-8")
    path = tmp_path / "FetchMug.py"
    path.write_text(blocks("python")[1], encoding="utf-8")
    with pytest.raises(ConfigErrors) as errors:
        rehearse(str(path))
    assert [(error.file, error.line) for error in errors.value.errors] == [
        (str(tmp_path / "FetchMug.yaml"), line) for line in (1, 2)]


def test_the_robot_without_ros_does_both_benchmarks():
    page = {}
    exec(compile(blocks("python")[2], "write_a_benchmark.md", "exec"), page)
    robot = page["MyRobot"]()
    robot.client = unittest.mock.Mock()
    assert asyncio.run(robot.execute("SetTable", None)) is None
    robot.client.notify.assert_called_once_with("setting the table")
    for colour in ("red", "blue"):
        result = asyncio.run(robot.execute("FetchMug", Goal(text=f"{{fetch: {colour}}}")))
        assert json.loads(result) == {"colour": colour}


def test_the_rehearsal_runs():
    exec(compile(blocks("python")[4], "write_a_benchmark.md", "exec"), {})


def test_every_file_that_is_named_exists():
    for name in re.findall(r"\]\(([^)#]+)\)", PAGE):
        assert (ROOT / "docs" / name).exists(), name
