"""The supervisor of a box without ROS."""

import signal
import subprocess
import sys
import textwrap

import pytest

LIMIT_S = 60.0
# The box: it notes its start, and ends as the test wants it to.
BOX = """
import os, signal, sys, time
with open("starts", "a") as file:
    file.write(os.environ["ROAH_RSBB_LAUNCH"] + "\\n")
starts = len(open("starts").readlines())
print("started", starts, *sys.argv[1:], flush=True)
"""
# `copies` is a program instead of that which copies.
SUPERVISOR = """
import sys
from roah_rsbb.box.program import supervisor
from roah_rsbb.journal.copy_follower import CopySettings
command, copies = ([sys.executable, "-c", open(name).read()] for name in ("box.py", "copies.py"))
supervisor.without_ros = lambda *words: copies if words[0] == "copies" else [*command, *words]
supervisor.COPYING_PAUSE_S = supervisor.PAUSE_S = 0.0
settings = CopySettings(".", "stick", 0, "0.0.0.0", "none", "127.255.255.255", 6666, "")
sys.exit(supervisor.supervise(command, [*command, "again"], lambda memory: settings))
"""


@pytest.fixture
def supervised(tmp_path):
    """Start a supervisor over a box with this code; returns the process."""
    found = []

    def start(code, copies="sys.exit(1)"):
        (tmp_path / "copies.py").write_text("import os, signal, sys, time\n" + textwrap.dedent(copies), "utf-8")
        (tmp_path / "box.py").write_text(BOX + textwrap.dedent(code), "utf-8")
        found.append(subprocess.Popen(
            [sys.executable, "-c", SUPERVISOR], cwd=str(tmp_path), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            text=True))
        return found[0]

    yield start
    for process in found:
        process.kill()
        process.communicate()


def starts(tmp_path):
    return (tmp_path / "starts").read_text("utf-8").split()


def test_a_killed_box_is_started_again_within_the_same_launch(supervised, tmp_path):
    process = supervised("if starts < 3: os.kill(os.getpid(), signal.SIGKILL)")
    out, error = process.communicate(timeout=LIMIT_S)
    assert (process.returncode, out.split()) == (0, ["started", "1", "started", "2", "again", "started", "3", "again"])
    assert error.count("ended unexpectedly") == 2
    assert len(set(starts(tmp_path))) == 1


@pytest.mark.parametrize("status", [0, 1, 2])
def test_a_box_that_ends_by_itself_is_not(supervised, tmp_path, status):
    process = supervised(f"sys.exit({status})")
    process.communicate(timeout=LIMIT_S)
    assert process.returncode == status
    assert len(starts(tmp_path)) == 1


def test_a_box_that_only_a_signal_ended_is_started_again(supervised, tmp_path):
    process = supervised("sys.exit(143 if starts == 1 else 0)")
    process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0 and len(starts(tmp_path)) == 2


def test_no_terminal_stops_the_box(supervised):
    process = supervised("""
        os.kill(os.getpid(), signal.SIGTSTP)
        os.kill(os.getppid(), signal.SIGTSTP)
        """)
    process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGQUIT])
def test_whoever_ends_the_supervisor_ends_the_box(supervised, tmp_path, number):
    process = supervised("""
        signal.signal(signal.SIGTERM, lambda *_: (open("ended", "w").close(), sys.exit(0)))
        print("ready", flush=True)
        while True:
            time.sleep(60)
        """)
    assert [process.stdout.readline() for _ in range(2)] == ["started 1\n", "ready\n"]
    process.send_signal(number)
    process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0
    assert (tmp_path / "ended").exists()
    assert len(starts(tmp_path)) == 1


def test_a_box_that_does_not_answer_is_replaced(supervised, tmp_path):
    process = supervised("""
        from roah_rsbb.ground.signs_of_life import Lifeline
        if starts == 1:
            Lifeline(".").send()
            time.sleep(1000)
        """)
    out, error = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0 and out == "started 1\nstarted 2 again\n"
    assert "has not answered for 2 s" in error


def test_after_a_crash_it_tries_until_the_box_runs_again(supervised, tmp_path):
    process = supervised("""
        from roah_rsbb.ground.signs_of_life import Lifeline
        if starts == 1:
            Lifeline(".").send()
            os.kill(os.getpid(), signal.SIGKILL)
        sys.exit([1, 2, 0][starts - 2])  # somebody edits a file of the competition just now
        """)
    _, error = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0
    assert len(starts(tmp_path)) == 4
    assert error.count("Repair what it says is wrong") == 2


def test_the_journal_is_copied_from_the_first_sign_of_life_until_the_box_has_ended(supervised, tmp_path):
    """Whatever ends the program that copies, the next one is started."""
    process = supervised("""
        from roah_rsbb.ground.signs_of_life import Lifeline
        ends, lifeline = [], Lifeline(".")
        signal.signal(signal.SIGTERM, lambda *_: ends.append(1))
        open("copying", "a").write("box ")
        while not ends:
            lifeline.send()
            time.sleep(0.01)
        open("copying", "a").write("ended ")
        """, copies="""
        open("copying", "a").write("copies ")
        if open("copying").read().count("copies") < 3:
            os.kill(os.getpid(), signal.SIGKILL)
        ends = []
        signal.signal(signal.SIGTERM, lambda *_: ends.append(1))
        print("copying", flush=True)
        while not ends:
            time.sleep(0.01)
        open("copying", "a").write("complete")
        """)
    assert [process.stdout.readline() for _ in range(2)] == ["started 1\n", "copying\n"]
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0
    assert (tmp_path / "copying").read_text("utf-8") == "box copies copies copies ended complete"
