"""Names of run logs."""

import re

import pytest

from roah_rsbb.run_logs.writer import log_name, unused


def _name(team="Alpha", robot=""):
    return log_name(1_800_000_000.0, team, robot, 2, 3, "uuid")


def test_a_name_says_when_and_whose_run_it_is():
    assert re.fullmatch(r"online_log_2027-01-1\d_\d\d-\d\d-00_Alpha_round2_run3_uuid\.bag", _name())


def test_where_several_robots_of_a_team_run_at_once_it_says_which():
    assert "_Alpha_r1_round2" in _name(robot="r1")


@pytest.mark.parametrize("team, robot, who", [
    ("A b", "", "A-b"), ("Ä/..:x", "", "Ä-..-x"), ("Alpha", "../../etc", "Alpha_..-..-etc"),
    ("Alpha", "r 1:ä", "Alpha_r-1--"),
    ("Alpha", "x" * 100, "Alpha_" + "x" * 40), ("Alpha", "ä" * 100, "Alpha_" + "-" * 40),
])
def test_nothing_is_in_it_that_a_file_system_minds(team, robot, who):
    name = _name(team, robot)
    assert f"_{who}_round2" in name
    assert "/" not in name
    assert len(name.encode()) < 255


def test_no_two_runs_share_a_log(tmp_path):
    path = str(tmp_path / _name())
    assert unused(path, 6667, {}) == path
    other = path.replace(".bag", "_port6668.bag")
    assert unused(path, 6668, {path: 1}) == other
    with open(path, "w"):
        assert unused(path, 6668, {}) == other
