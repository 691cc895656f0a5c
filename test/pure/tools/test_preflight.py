"""preflight looks at the files that the box will get."""

import argparse

import pytest

pytest.importorskip("rospkg")

from roah_rsbb.tools import preflight  # noqa: E402


def completed(**given):
    options = argparse.Namespace(**{**dict.fromkeys(
        ("competition", "benchmarks_file", "schedule_file", "passwords_file", "log_dir",
         "modules_dir")), **given})
    preflight.complete(options, "/shipped")
    return options.benchmarks_file, options.schedule_file, options.passwords_file, options.log_dir


def test_without_a_competition_the_shipped_files():
    assert completed() == (
        "/shipped/benchmarks.yaml", "/shipped/schedule.yaml", "/shipped/passwords.yaml", "~/.ros/roah_rsbb")


def test_a_competitions_files():
    assert completed(competition="/erl") == (
        "/erl/benchmarks.yaml", "/erl/schedule.yaml", "/erl/passwords.yaml", "/erl/log")


def test_what_is_given_counts():
    assert completed(competition="/erl", schedule_file="/other.yaml", log_dir="/log") == (
        "/erl/benchmarks.yaml", "/other.yaml", "/erl/passwords.yaml", "/log")


def test_a_competitions_modules_are_checked_where_it_has_some(tmp_path):
    options = argparse.Namespace(**dict.fromkeys(
        ("competition", "benchmarks_file", "schedule_file", "passwords_file", "log_dir", "modules_dir")))
    options.competition = str(tmp_path)
    preflight.complete(options, "/shipped")
    assert options.modules_dir == "/shipped/modules"
    (tmp_path / "modules").mkdir()
    options.modules_dir = None
    preflight.complete(options, "/shipped")
    assert options.modules_dir == str(tmp_path / "modules")
