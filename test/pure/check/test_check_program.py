"""The program check_robot: its arguments, and a short check on loopback."""

import json
import os
import pathlib
import re
import subprocess
import sys

import pytest

from helpers.small_box import BOX, BROADCAST, PASSWORD, ROBOT, free_ports
from roah_rsbb.check import program
from roah_rsbb.check.report import Cause
from roah_rsbb.check.scenarios import SCENARIOS

ROOT = pathlib.Path(__file__).resolve().parents[3]
USUAL = ["--team", "Team", "--password", PASSWORD, "--host", BROADCAST, "--bind", BOX]


def error_of(capsys, *arguments):
    with pytest.raises(SystemExit) as ended:
        program.read_options(arguments)
    assert ended.value.code == 2
    return capsys.readouterr().err


@pytest.mark.parametrize("arguments, said", [
    (["--password", "P"], "--team is missing: give the team's name"),
    (["--team", "T"], "the password is missing: use --password-file or the environment variable ROAH_RSBB_KEY"),
    (["--team", "T", "--password-file", "/nowhere/key"], "cannot read the password file /nowhere/key"),
    ([*USUAL, "--benchmarks", "HNF,HVW"], "no benchmark 'HVW': did you mean 'HWV'?"),
    ([*USUAL, "--benchmarks", ","], "no benchmark is given: choose from HGTKMH"),
    ([*USUAL, "--only", "stop-executin"], "no scenario 'stop-executin': did you mean 'stop-executing'?"),
    ([*USUAL, "--port", "70000"], "'70000' is not a UDP port from 1 to 65000"),
    ([*USUAL, "--patience", "-1"], "'-1' is not a number from 1 to 3600"),
    ([*USUAL, "--html", "/nowhere/report.html"], "folder /nowhere is missing. Create it, or give another path"),
    ([*USUAL, "--json", "/"], "/ cannot be written: give another path"),
    ([*USUAL[:4], "--host", "no host"], "--host 'no host' is neither an IPv4 address nor a known host"),
    ([*USUAL, "--cipher", "rot13"], "rot13"),
    ([*USUAL, "--level", "some"], "invalid choice: 'some'"),
])
def test_wrong_arguments_name_the_remedy(capsys, monkeypatch, arguments, said):
    monkeypatch.delenv("ROAH_RSBB_KEY", raising=False)
    assert said in error_of(capsys, *arguments)


def test_the_password_is_never_part_of_a_report_or_of_the_options_shown():
    options = program.read_options(USUAL)[1]
    assert options.password == PASSWORD
    assert options.second_host == "127.0.0.101"


def test_scenarios_are_listed_without_a_team(capsys):
    program.main(["--list"])
    assert re.search(r"^stop-executing +basic +STOP in EXECUTING", capsys.readouterr().out, re.MULTILINE)


def test_every_page_of_a_cause_exists():
    for cause in Cause:
        page, _, anchor = cause.page.partition("#")
        headings = re.findall(r"^#+ (.*)$", (ROOT / page).read_text(encoding="utf-8"), re.MULTILINE)
        anchors = {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}
        assert anchor in anchors, (cause, sorted(anchors))


def test_the_pages_name_every_scenario():
    names = [one.name for one in SCENARIOS]
    guide = (ROOT / "docs" / "check_robot.md").read_text(encoding="utf-8")
    field = (ROOT / "docs" / "robots_in_the_field.md").read_text(encoding="utf-8")
    own = [name for name in names if not name.startswith("run-")]
    assert [name for name in own if f"`{name}`" not in guide] == []
    assert [name for name in names if f"| `{name}` |" not in field] == ["run-hgtkmh"]  # the scenario "run"
    assert set(re.findall(r"^\| `([\w-]+)` \|", field, re.MULTILINE)) <= set(names)


def test_a_short_check_on_loopback(tmp_path):
    """The program, with real sockets and clocks, beside the program dummy_robot."""
    port = str(free_ports())
    environment = {**os.environ, "ROAH_RSBB_KEY": PASSWORD}
    code = f"import roah_rsbb; roah_rsbb.__path__ = {list(__import__('roah_rsbb').__path__)!r}; "

    def start(module, *arguments):
        return subprocess.Popen(
            [sys.executable, "-c", f"{code}from {module} import main; main()", "--team", "Team", "--host", BROADCAST,
             "--port", port, *arguments], env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    robot = start("roah_rsbb.robot.dummy", "--bind", ROBOT)
    try:
        check = start("roah_rsbb.check.program", "--bind", BOX, "--only", "clock", "--json", str(tmp_path / "r.json"))
        printed, _ = check.communicate(timeout=60)
        assert check.returncode in (0, 4), printed  # 4: this machine was too busy
        assert "The robot's clock" in printed and PASSWORD not in printed
        found = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))
        assert [one["name"] for one in found["scenarios"]] == ["find", "clock"]
        assert found["robot"] == "DummyRobot"
    finally:
        robot.kill()
        robot.communicate()
