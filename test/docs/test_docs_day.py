"""Runs every line of the tables "The day is edited" and "A run is wrong" of docs/organiser.md, in their order, against
a box without ROS."""

import os
import re
import subprocess
import sys

import pytest
from pages import ROOT
from test_docs_runs import LIMIT_S

# As without ROS: the same programs by their short names.
ROSRUN = ('rosrun() { shift; [ $1 != new_competition ] || set -- new "${@:2}"; '
          f'{sys.executable} -m roah_rsbb.tools.team "$@"; }}\n')
LINE = re.compile(r"^\| ([^|]+) \| `(rosrun roah_rsbb referee [^`]+)`", re.MULTILINE)
NEW = ("rosrun roah_rsbb new_competition day --teams 'Brass Butlers, CopperKettle, HomeAlone' "
       "--benchmarks HGTKMH,HWV,HNF --days 2037-11-28,2037-11-29 --begin 10:00 --time-zone Europe/Berlin")
# What is different after a line, by a part of the line: in the schedule file, else in what it printed.
WRITTEN = {
    "Task 40": "HGTKMH, team: Brass Butlers, round: 1, run: 1, scheduled_time: 2037-11-28 10:40:00 +01:00",
    "Task 14:20": "HGTKMH, team: Brass Butlers, round: 1, run: 1, scheduled_time: 2037-11-28 14:20:00 +01:00",
    "Task -10": "HGTKMH, team: Brass Butlers, round: 1, run: 1, scheduled_time: 2037-11-28 14:10:00 +01:00",
    "move Task 4 ": "2037-11-29 16:00:00 +01:00", "repeat": "run: 2", "insert": "2037-11-29 17:00:00 +01:00",
    "add-team": "team: TeaAtFive",
}


@pytest.fixture
def typed(tmp_path):
    """Types a line in the folder in which a box runs; returns what it printed."""
    env = {**os.environ, "HOME": str(tmp_path), "LC_ALL": "C.UTF-8"}
    env.pop("ROS_MASTER_URI", None)

    def typed(line):
        done = subprocess.run(["bash", "-e", "-c", ROSRUN + line], cwd=str(tmp_path), env=env, text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              timeout=LIMIT_S, check=False)
        assert done.returncode == 0, f"{line} printed\n{done.stdout}"
        return done.stdout
    typed(NEW)
    box = subprocess.Popen(
        [sys.executable, "-m", "roah_rsbb.tools.team", "run", "day", "--no-browser", "rsbb_host:=127.255.255.255",
         "bind_host:=127.0.0.1", "devices:=false", "tablet:=false", "web:=false",
         f"rsbb_port:={20000 + os.getpid() % 9999}"],
        cwd=str(tmp_path), env=env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        text=True)
    try:
        said = ""
        while "Listening on UDP" not in said:
            said = box.stdout.readline()
            assert said, "the box has ended"
        yield typed
    finally:
        box.terminate()
        box.communicate(timeout=LIMIT_S)


def lines_of(title):
    """What happens, and the command, of each line of the table below a title."""
    page = (ROOT / "docs" / "organiser.md").read_text(encoding="utf-8")
    lines = LINE.findall(page.partition(f"### {title}\n")[2].partition("\n### ")[0])
    assert len(lines) > 12
    return lines


# What is said of the run and of its event after a line, by a part of the line.
OF_RUN = {
    "move": "team HomeAlone, round 1, run 1: stopped, counts", "undo": "team Brass Butlers, round 1",
    "sign-off": "signed off by Olga", "reopen": "reopened, not signed off again yet",
    "annul": "does not count: annulled",
}


def test_each_line_of_the_table_puts_a_wrong_run_right(typed):
    for command in ("open-sheet", "start", "stop", "disconnect"):
        typed(f"rosrun roah_rsbb referee {command} Task")
    for number, (what, line) in enumerate(lines_of("A run is wrong")):
        if "--to" in line:
            typed("rosrun roah_rsbb referee undo Task --run last --reason 'try the next line' --by Olga")
        said = typed(line)
        shown = typed("rosrun roah_rsbb referee runs Task")
        for part, words in OF_RUN.items():
            expected = "corrected at" if "signed off again" in what else words
            assert f" {part} " not in line or expected in shown, f"{number}: {what}: {shown}{said}"
    said = typed("rosrun roah_rsbb referee sheet Task --run last")
    for words in ("Annulled: it counts nothing: the door was locked – Olga", "Objection 1 of HomeAlone", "Version 1"):
        assert words in said, said
    assert "→ next" in typed("rosrun roah_rsbb referee schedule Task"), "its attempt is there again"


def test_each_line_of_the_table_does_what_it_says(typed, tmp_path):
    lines = lines_of("The day is edited")
    schedule, before = tmp_path / "day" / "schedule.yaml", ""
    for what, line in lines:  # on days that are not over
        said = typed(line.replace("2026-", "2037-") + (" --yes" if " day " in line and " list" not in line else ""))
        text = re.sub(" +", " ", schedule.read_text(encoding="utf-8"))
        changes = " day " in line and not any(word in line for word in ("list", "withdraw"))
        assert (text != before) == changes, f"{what}: {said}"
        for part, words in WRITTEN.items():
            assert part not in line or words in text, f"{what}: {said}"
        before = text
    assert "team: TeaAtFive" in before and (tmp_path / "day" / "schedule.yaml~9").exists()
