"""Runs the commands that the documentation marks, and compares their output."""

import os
import re
import subprocess

import pages
import pytest
from pages import ROOT

LIMIT_S = 60.0
# The search of `rosrun` takes three times the CPU of the program. `make test-install` runs programs with the real one.
ROSRUN = f'rosrun() {{ [ "$1" = roah_rsbb ] && "{ROOT}/scripts/$2" "${{@:3}}"; }}\n'
MARKED = [page for page in pages.NAMES if any(block.mark for block in pages.blocks(page))]


def fits(expected, printed):
    """Whether a text matches a page; … stands for anything in a line, or alone for any lines."""
    pattern = "".join(
        "(?:.*\n)*?" if line.strip() == "…" else re.escape(line).replace(re.escape("…"), ".*?") + "\n"
        for line in expected.splitlines())
    return re.fullmatch(pattern, printed) is not None


def run(block, folder):
    """Run a block's commands as they would be typed. Returns their output."""
    wanted = re.fullmatch(r"(?:exit (\d+))?", block.given)
    assert wanted, f"{block.where}: mark 'run: {block.given}'"
    ended = subprocess.run(
        ["bash", "-e", "-o", "pipefail", "-c", ROSRUN + block.text], cwd=str(folder), stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=LIMIT_S, check=False,
        env={**os.environ, "ROS_MASTER_URI": "http://127.0.0.1:1", "TZ": "UTC", "LC_ALL": "C.UTF-8"})
    assert ended.returncode == int(wanted.group(1) or 0), f"{block.where} printed\n{ended.stdout}"
    return ended.stdout


@pytest.mark.parametrize("page", MARKED)
def test_what_is_to_be_run_runs(page, tmp_path):
    printed = None
    for block in pages.blocks(page):
        if block.mark == "file":
            path = tmp_path / block.given
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.text, encoding="utf-8")
        elif block.mark == "run":
            printed = run(block, tmp_path)
        elif block.mark == "prints":
            assert printed is not None, f"{block.where}: nothing was run before it"
            assert fits(block.text, printed), f"{block.where}: this was printed:\n{printed}"


def test_commands_to_run_are_found():
    assert "docs/organiser.md" in MARKED


@pytest.mark.parametrize("expected, printed, fit", [
    ("a\nb\n", "a\nb\n", True), ("a\n", "a\nb\n", False), ("a … c\n", "a b c\n", True), ("a … c\n", "a\nc\n", False),
    ("a\n…\nd\n", "a\nb\nc\nd\n", True), ("…\n", "", True), ("a.c\n", "abc\n", False),
])
def test_what_fits(expected, printed, fit):
    assert fits(expected, printed) is fit
