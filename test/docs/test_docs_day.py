"""Runs every line of the table "The day is edited" of docs/organiser.md, in its order, against a box without ROS."""

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


def test_each_line_of_the_table_does_what_it_says(typed, tmp_path):
    page = (ROOT / "docs" / "organiser.md").read_text(encoding="utf-8")
    lines = LINE.findall(page[page.index("### The day is edited"):page.index("### Changes during the competition")])
    assert len(lines) > 15
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
