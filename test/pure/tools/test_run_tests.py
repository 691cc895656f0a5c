"""tools/run_tests, with a stand-in for make."""

import os
import pathlib
import shutil
import signal
import subprocess
import sys

import pytest

TOOLS = pathlib.Path(__file__).resolve().parents[3] / "tools"
# The stand-in runs a script that has the name of the target.
MAKE = """#!/bin/bash
for target; do :; done
[ ! -e "$HERE/$target" ] || . "$HERE/$target"
"""
RESULT = """<testsuite><testcase classname="test_some" name="test_it"><failure>
test/pure/test_some.py:12: in test_it
    assert 1 == 2
E   assert 1 == 2
test/pure/test_some.py:12: AssertionError</failure></testcase></testsuite>"""


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


def test_the_failures_in_a_result_file_are_listed_with_place_and_command(tree):
    write = f"cat > $HERE/build/test/pure_rest.xml <<'END'\n{RESULT}\nEND\nexit 1"
    done = tree.run("pure_rest", test_pure=write)
    assert done.stdout[done.stdout.index("--- pure_rest"):].splitlines()[1:4] == [
        "  test_some.test_it (test/pure/test_some.py:12)", "      assert 1 == 2",
        "  again: source build/devel/setup.bash; /usr/bin/python3 -m pytest test/pure/test_some.py -k test_it",
    ]


def test_pytest_is_asked_for_a_result_file(tree):
    done = tree.run("pure_rest", "lint", test_pure="echo $PYTEST_ADDOPTS", lint="echo options: $PYTEST_ADDOPTS")
    assert done.returncode == 0
    log = tree.path / "build" / "test"
    assert (log / "pure_rest.log").read_text().strip() == f"--junitxml={log / 'pure_rest.xml'}"
    assert (log / "lint.log").read_text().strip() == "options:"


def test_results_of_an_earlier_run_do_not_count(tree):
    tree.run("ros", test_ros="mkdir -p $HERE/build/rostest; echo old > $HERE/build/rostest/failed.txt; exit 1")
    done = tree.run("ros", test_ros="echo new; exit 1")
    assert "  new" in done.stdout
    assert "old" not in done.stdout


def test_parts_can_be_chosen_and_left_out(tree):
    assert "Running ros, pure_box;" in tree.run("pure_box", "ros").stdout
    assert "lint" not in tree.run("--without", "lint").stdout
    assert "unknown part: nothing" in tree.run("nothing").stdout


def test_skipped_tests_are_reported_with_the_reason(tree):
    done = tree.run("net", test_net="echo 'SKIPPED [1] no network namespaces'")
    assert "net: SKIPPED [1] no network namespaces" in done.stdout


def test_an_interrupt_ends_the_parts(tree):
    os.mkfifo(str(tree.path / "begun"))
    (tree.path / "test-ros").write_text("echo > $HERE/begun; sleep 60")
    process = subprocess.Popen(
        tree.command("ros"), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=tree.environment)
    (tree.path / "begun").read_text()  # ends when the part has begun
    process.send_signal(signal.SIGINT)
    output, _ = process.communicate()
    assert process.returncode == 130
    assert "interrupted" in output
