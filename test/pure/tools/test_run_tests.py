"""tools/run_tests, with a stand-in for make."""

import pathlib
import shutil
import subprocess
import sys

import pytest

TOOLS = pathlib.Path(__file__).resolve().parents[3] / "tools"
# The stand-in runs a script that has the name of the target.
MAKE = """#!/bin/bash
for target; do :; done
[ ! -e "$HERE/$target" ] || . "$HERE/$target"
"""


class Tree:
    """A source tree with the program, and what its parts do."""

    def __init__(self, path: pathlib.Path) -> None:
        self.path = path
        (path / "tools").mkdir()
        for name in ("run_tests", "failures.py"):
            shutil.copy(str(TOOLS / name), str(path / "tools" / name))
        (path / "bin").mkdir()
        (path / "bin" / "make").write_text(MAKE)
        (path / "bin" / "make").chmod(0o755)
        self.environment = {"PATH": f"{path / 'bin'}:/usr/bin:/bin", "HERE": str(path)}

    def command(self, *options: str):
        return [sys.executable, str(self.path / "tools" / "run_tests"), *options]

    def run(self, *options: str, **parts: str):
        for target, script in parts.items():
            (self.path / target.replace("_", "-")).write_text(script + "\n")
        return subprocess.run(
            self.command(*options), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=self.environment,
            check=False,
        )


@pytest.fixture
def tree(tmp_path):
    return Tree(tmp_path)


def test_all_parts_pass(tree):
    done = tree.run(test_ros="echo of ros")
    assert done.returncode == 0
    assert sum(line.startswith("ok") for line in done.stdout.splitlines()) == 11
    assert "11 of 11 parts passed in " in done.stdout
    assert "of ros" in (tree.path / "build" / "test" / "ros.log").read_text()
    assert "of ros" in (tree.path / "build" / "test" / "all.log").read_text()


def test_a_part_that_fails_stops_no_other_and_its_output_ends_the_report(tree):
    done = tree.run(test_install="echo it is not installed; exit 3", lint="echo ran > $HERE/lint_ran")
    assert done.returncode == 1
    assert (tree.path / "lint_ran").exists()
    end = done.stdout[done.stdout.index("--- install"):]
    assert end.splitlines()[:2] == [
        "--- install: make test-install  (output: build/test/install.log)", "  it is not installed",
    ]
    assert "10 of 11 parts passed in " in end
    assert "; failed: install" in end


def test_skipped_tests_are_reported_with_the_reason(tree):
    done = tree.run("net", test_net="echo 'SKIPPED [1] no network namespaces'")
    assert "net: SKIPPED [1] no network namespaces" in done.stdout
