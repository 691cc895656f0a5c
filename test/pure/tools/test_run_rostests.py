"""tools/run_rostests, with a stand-in for rostest."""

import os
import pathlib
import signal
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from typing import Any, List

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
# run_rostests forks a rostest in Python. This one becomes the stand-in above.
FORKED_ROSTEST = """#!/usr/bin/python3
import os, sys
os.execv(f"{sys.path[0]}/executed", sys.argv)
"""
# One that starts a node as roslaunch does, and waits until the node has written its note.
STARTS_A_NODE = """#!/usr/bin/python3
import os
import roslaunch.nodeprocess

here = os.environ["HERE"]
os.mkfifo(f"{here}/begun")
with open(f"{here}/node.log", "w") as log:
    node = roslaunch.nodeprocess.subprocess.Popen(
        [f"{here}/node", "of the test"], cwd=here, stdout=log, env={**os.environ, "OF": "the node"}, close_fds=True,
        preexec_fn=os.setsid)
open(f"{here}/begun").close()
assert node.poll() is None
"""
NODE = """#!/usr/bin/python3
import os, sys, time

is_forked = "forking_parent" in open("/proc/self/cmdline").read()
print(sys.argv[1:], os.environ["OF"], os.getcwd(), os.getsid(0) == os.getpid(), is_forked, flush=True)
with open("pid", "w") as file:
    file.write(str(os.getpid()))
open("begun", "w").close()
time.sleep(60)
"""
both = pytest.mark.parametrize("runner", ["executed", "forked"], indirect=True)


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
            env={"PATH": f"{self.path / 'bin'}:/usr/bin:/bin", "HERE": str(self.path), "ROS_HOSTNAME": "elsewhere",
                 "ROS_MASTER_URI": "http://elsewhere:11311"},
        )

    def run(self, *options: str, **tests: str) -> "subprocess.CompletedProcess[str]":
        """Run the program on tests of these names and texts."""
        process = self.start(*options, **tests)
        output, _ = process.communicate()
        return subprocess.CompletedProcess([], process.returncode, output)

    def lines(self, name: str) -> List[str]:
        """What the tests wrote into a file."""
        return (self.path / name).read_text().split()


@pytest.fixture
def runner(tmp_path: pathlib.Path, request: Any) -> Runner:
    made = Runner(tmp_path)
    if getattr(request, "param", "executed") == "forked":
        made.add("bin/executed", ROSTEST)
        made.add("bin/rostest", FORKED_ROSTEST)
    return made


def ended(pid: int) -> bool:
    """Whether a process is gone, or only waits for somebody to ask how it ended."""
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] == "Z"
    except OSError:
        return True


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


def test_what_a_failed_test_and_its_nodes_printed_is_shown(runner: Runner) -> None:
    logs = "cd $ROS_LOG_DIR; mkdir run; echo of a node > run/core-1.log; echo env > rostest-1.log"
    done = runner.run(one=f"echo of the test; mkdir -p $ROS_LOG_DIR; {logs}; false", two="echo of a good one; good")
    assert "of the test" in done.stdout
    assert "of a node" in done.stdout
    assert "env" not in done.stdout.split()
    assert "of a good one" not in done.stdout


FAILURE = """<testcase classname="__main__.TestSome" name="test_it"><failure type="AssertionError">1 != 2 : the state
the second line
  File "/usr/lib/python3.11/unittest/case.py", line 57, in run
    self._callTestMethod(testMethod)
  File "/home/me/roah/test/ros/some_test.py", line 12, in test_it
    self.check()
  File "/home/me/roah/test/ros/helper.py", line 34, in check
    self.assertEqual(1, 2, "the state")
</failure></testcase>"""


def test_each_failure_is_listed_at_the_end(runner: Runner) -> None:
    done = runner.run(one="good", two=f"cases '{FAILURE}'")
    end = done.stdout[done.stdout.rindex("two: 1 test cases failed"):].splitlines()
    assert end[1:4] == [
        "  TestSome.test_it (test/ros/helper.py:34)", "      1 != 2 : the state", "      the second line",
    ]
    assert end[4].startswith("  again: source build/devel/setup.bash; tools/run_rostests ")
    assert end[4].endswith("two.test")
    (folder,) = (runner.path / "rostest_failed").iterdir()
    assert (end[5], (folder / "output.txt").is_file()) == (f"  its logs: {os.path.relpath(str(folder))}", True)
    assert (runner.path / "results" / "failed.txt").read_text().splitlines() == end[:-1]


@both
def test_a_result_file_of_all_tests(runner: Runner) -> None:
    runner.run("--junit", str(runner.path / "new" / "all.xml"), one="good", two=f"cases '{FAILURE}'")
    suite = ElementTree.parse(str(runner.path / "new" / "all.xml")).getroot()
    assert (suite.get("tests"), suite.get("failures")) == ("2", "1")
    found = {case.get("name"): "".join(failure.text for failure in case.iter("failure")) for case in suite}
    assert found["one"] == ""
    assert "1 != 2 : the state" in found["two"]


def test_what_a_test_leaves_in_the_temporary_directory_is_removed(runner: Runner) -> None:
    done = runner.run(one="echo $TMPDIR > $HERE/tmp; touch $TMPDIR/left; good")
    assert done.returncode == 0
    assert not pathlib.Path(*runner.lines("tmp")).exists()


def test_the_longest_test_of_the_run_before_starts_first(runner: Runner) -> None:
    note = "echo {0} >> $HERE/order; good"
    tests = {name: note.format(name) for name in "abc"}
    runner.run(**tests)
    took = runner.path / "results" / "b" / "seconds"
    took.write_text(f"{float(took.read_text()) + 1000}\n")
    runner.run("--jobs", "1", **tests)
    assert runner.lines("order")[3] == "b"


@both
def test_a_test_that_hangs_is_ended(runner: Runner) -> None:
    (runner.path / "pid").touch()  # on a busy machine, the test may be ended before it writes
    done = runner.run("--time-limit", "0.3", one="echo $$ > $HERE/pid; sleep 60")
    assert done.returncode == 1
    assert "it did not end within 0.3 s" in done.stdout
    assert all(ended(int(pid)) for pid in runner.lines("pid"))


@both
def test_what_a_test_left_running_is_ended(runner: Runner) -> None:
    done = runner.run(one="setsid sleep 60 & echo $! > $HERE/pid; good")
    assert done.returncode == 0
    assert ended(int(*runner.lines("pid")))


def test_a_node_is_a_fork_and_ends_with_its_test(runner: Runner) -> None:
    runner.add("bin/rostest", STARTS_A_NODE)
    runner.add("node", NODE)
    done = runner.run(one="")
    assert "it ran no test case" in done.stdout
    assert (runner.path / "node.log").read_text() == f"['of the test'] the node {runner.path} True True\n"
    assert ended(int(*runner.lines("pid")))


@both
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_ends_all_tests(runner: Runner, number: int) -> None:
    os.mkfifo(str(runner.path / "begun"))
    long = "echo $$ > $HERE/pid; echo > $HERE/begun; sleep 60"
    process = runner.start("--jobs", "1", one=long, two="touch $HERE/two")
    (runner.path / "begun").read_text()  # ends when the first one has begun
    process.send_signal(number)
    output, _ = process.communicate()
    assert process.returncode == 130
    assert "interrupted" in output
    assert ended(int(*runner.lines("pid")))
    assert not (runner.path / "two").exists()


@both
def test_tests_side_by_side_have_slots_and_folders_of_their_own(runner: Runner) -> None:
    # Each opens the pipe at one end, so both continue only when both are running.
    os.mkfifo(str(runner.path / "meet"))
    folders = "$ROS_HOME $ROS_LOG_DIR $ROS_TEST_RESULTS_DIR"
    note = f"echo $ROAH_TEST_SLOT $ROS_IP >> $HERE/slots; echo {folders} >> $HERE/folders; good"
    one, two = f"echo > $HERE/meet; {note}", f"read < $HERE/meet; {note}"
    done = runner.run("--jobs", "2", "--busy", "9999", one=one, two=two)
    assert done.returncode == 0
    assert len(set(runner.lines("slots"))) == 4, "the addresses of ROS are different, too"
    assert len(set(runner.lines("folders"))) == 6


def test_on_a_busy_machine_one_test_runs_after_the_other(runner: Runner) -> None:
    alone = "mkdir $HERE/alone && sleep 0.5 && rmdir $HERE/alone && good"
    done = runner.run("--jobs", "2", "--busy", "0", one=alone, two=alone)
    assert done.returncode == 0, done.stdout


def test_two_runs_on_one_machine_have_slots_of_their_own(runner: Runner) -> None:
    os.mkfifo(str(runner.path / "meet"))
    note = "echo $ROAH_TEST_SLOT >> $HERE/slots; good"
    first = runner.start(one=f"echo > $HERE/meet; {note}")
    second = runner.run(two=f"read < $HERE/meet; {note}")
    first.communicate()
    assert (first.returncode, second.returncode) == (0, 0)
    assert len(set(runner.lines("slots"))) == 2


@both
def test_the_environment_of_the_shell_does_not_reach_the_master(runner: Runner) -> None:
    done = runner.run(one='[ -z "$ROS_MASTER_URI$ROS_HOSTNAME" ] && [ ${ROS_IP%.*} = 127.77.0 ] && good')
    assert done.returncode == 0


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
