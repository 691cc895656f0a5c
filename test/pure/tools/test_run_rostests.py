"""tools/run_rostests, with a stand-in for rostest."""

import pathlib
import subprocess
import sys

import pytest

PROGRAM = pathlib.Path(__file__).resolve().parents[3] / "tools" / "run_rostests"

# The stand-in runs the test "file" as a shell script. `cases` writes a result as rostest does.
ROSTEST = """#!/bin/bash
cases() {
  mkdir -p "$ROS_TEST_RESULTS_DIR/roah_rsbb"
  echo "<testsuite>$1</testsuite>" > "$ROS_TEST_RESULTS_DIR/roah_rsbb/rosunit-some.xml"
  echo "<testsuite><testcase name='testsome'>$2</testcase></testsuite>" \
    > "$ROS_TEST_RESULTS_DIR/roah_rsbb/rostest-some.xml"
}
good() { cases "<testcase name='a'/>"; }
. "$1"
"""


class Runner:
    """A folder with tests, and the program on it."""

    def __init__(self, path: pathlib.Path) -> None:
        self.path = path
        (path / "bin").mkdir()
        self.add("bin/rostest", ROSTEST)

    def add(self, name: str, text: str) -> None:
        """Add a program."""
        (self.path / name).write_text(text)
        (self.path / name).chmod(0o755)

    def start(self, *options: str, **tests: str) -> "subprocess.Popen[str]":
        """Start the program on tests of these names and texts."""
        paths = []
        for name, text in tests.items():
            paths.append(self.path / f"{name}.test")
            paths[-1].write_text(text + "\n")
        return subprocess.Popen(
            [sys.executable, str(PROGRAM), "--results", str(self.path / "results"), *options, *map(str, paths)],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            env={"PATH": f"{self.path / 'bin'}:/usr/bin:/bin", "HERE": str(self.path)},
        )

    def run(self, *options: str, **tests: str) -> "subprocess.CompletedProcess[str]":
        """Run the program on tests of these names and texts."""
        process = self.start(*options, **tests)
        output, _ = process.communicate()
        return subprocess.CompletedProcess([], process.returncode, output)


@pytest.fixture
def runner(tmp_path: pathlib.Path) -> Runner:
    return Runner(tmp_path)


def test_all_passed(runner: Runner) -> None:
    done = runner.run(one="good", two="good")
    assert done.returncode == 0
    assert done.stdout.splitlines()[-1].startswith("rostests: 2 of 2 passed in ")
    assert sorted(line.split(" (")[0] for line in done.stdout.splitlines()[:-1]) == ["ok     one", "ok     two"]


@pytest.mark.parametrize("text, why", [
    ("cases '<testcase><failure/></testcase><testcase><error/></testcase><testcase/>'", "2 test cases failed"),
    ("cases '' '<failure>it left no result</failure>'", "1 test cases failed"),
    ("good; exit 3", "rostest ended with status 3"),
    ("cases '<testcase'", "its result rosunit-some.xml cannot be read"),
    ("cases ''", "it ran no test case"),
    # rostest ended the program before it could complete its result.
    ("cases '<testcase' '<failure>max time [300.0s] allotted for test [some] of type [a/b]</failure>'",
     "it exceeded its time limit of 300 s"),
    ("true", "it ran no test case"),
])
def test_a_test_that_failed_fails_the_run_with_its_reason(runner: Runner, text: str, why: str) -> None:
    done = runner.run(one="good", two=text)
    assert done.returncode == 1
    assert any(line.startswith("FAILED two (") and line.endswith(f": {why}") for line in done.stdout.splitlines())
    assert done.stdout.splitlines()[-1].startswith("rostests: 1 of 2 passed in ")
    assert done.stdout.splitlines()[-1].endswith("; failed: two")


def test_a_test_that_hangs_fails(runner: Runner) -> None:
    done = runner.run("--time-limit", "0.3", one="sleep 60")
    assert done.returncode == 1
    assert "it did not end within 0.3 s" in done.stdout


def test_a_program_whose_imports_fail_ends_the_run(runner: Runner) -> None:
    runner.add("bin/rostest", "#!/usr/bin/python3\nimport a_module_that_is_missing\n")
    process = runner.start(one="good")
    try:
        output, _ = process.communicate(timeout=60.0)
    finally:
        process.kill()
    assert process.returncode != 0
    assert "a_module_that_is_missing" in output
    assert "the process that forks has ended" in output or "Broken pipe" in output


def test_results_of_an_earlier_run_do_not_count(runner: Runner) -> None:
    assert runner.run(one="good").returncode == 0
    assert "it ran no test case" in runner.run(one="true").stdout


def test_a_test_that_is_not_there_is_named(runner: Runner) -> None:
    done = subprocess.run(
        [sys.executable, str(PROGRAM), "nothing.test"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        env={"PATH": f"{runner.path / 'bin'}:/usr/bin:/bin"}, check=False,
    )
    assert done.returncode == 2
    assert "nothing.test" in done.stdout
