"""env-hooks/50.roah_rsbb.bash: what bash offers for `rosrun roah_rsbb ...`."""

import os
import pathlib
import re
import subprocess
from typing import List

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
HOOK = ROOT / "env-hooks" / "50.roah_rsbb.bash"
# Presses TAB at the end of the line in $1. `compopt` works only within a completion.
TAB = """
. "$HOOK"
compopt() { :; }
COMP_LINE=$1 COMP_POINT=${#1} COMP_TYPE=9 COMPREPLY=()
read -ra COMP_WORDS <<<"$1"
[[ $1 != *' ' ]] || COMP_WORDS+=("")
COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
"$(complete -p "${COMP_WORDS[0]}" | sed 's/.*-F \\([^ ]*\\) .*/\\1/')"
printf '%s\\n' "${COMPREPLY[@]}"
"""


@pytest.fixture(name="tab")
def _tab(tmp_path: pathlib.Path):
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "roah_rsbb").symlink_to(ROOT / "scripts")
    environment = {
        **os.environ, "HOOK": str(HOOK), "CMAKE_PREFIX_PATH": f"/nowhere:{tmp_path}",
    }

    def tab(line: str) -> List[str]:
        return subprocess.run(
            ["bash", "--norc", "-c", TAB, "bash", line], env=environment, check=True, text=True,
            stdout=subprocess.PIPE,
        ).stdout.split()

    return tab


def test_programs_that_the_guides_name_are_offered(tab) -> None:
    guides = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    named = {name for guide in guides for name in re.findall("rosrun roah_rsbb ([a-z_]+)", guide.read_text())}
    panels_and_nodes = {name for name in named if name.startswith("roah_rsbb_")}
    assert named - panels_and_nodes <= set(tab("rosrun roah_rsbb "))


def test_every_program_that_is_offered_exists(tab) -> None:
    assert {name for name in tab("rosrun roah_rsbb ") if not (ROOT / "scripts" / name).exists()} == set()


@pytest.mark.parametrize("line, offered", [
    ("rosrun roah_rsbb ref", ["referee"]),
    ("roah-rsbb ref", ["referee"]),
    ("rosrun --debug roah_rsbb ref", ["referee"]),
    ("rosrun --prefix nice roah_rsbb ref", ["referee"]),
    # Programs for launch files are offered after their first letters.
    ("rosrun roah_rsbb roah_rsbb_sc", ["roah_rsbb_scoring"]),
    ("rosrun roah_rsbb panel ov", ["overview"]),
    ("rosrun roah_rsbb referee sta", ["status", "start"]),
    ("roah-rsbb referee sta", ["status", "start"]),
    ("rosrun roah_rsbb   referee  run 'Home A' --op", ["--operations"]),
    ("rosrun roah_rsbb referee run 'Home A' --operations a", ["automatic"]),
    ("roah-rsbb referee judges ha", ["hand-back"]),
    ("rosrun roah_rsbb demo --no", ["--no-window"]),
    ("rosrun roah_rsbb no_such_program --", []),
])
def test_tab(tab, line: str, offered: List[str]) -> None:
    assert tab(line) == offered


def test_the_short_name_starts_a_program_without_rosrun(tmp_path: pathlib.Path) -> None:
    programs = tmp_path / "lib" / "roah_rsbb"
    programs.mkdir(parents=True)
    (programs / "comm").write_text("#!/bin/sh\nprintf '<%s>' \"$@\"\nexit 4\n")
    (programs / "comm").chmod(0o755)

    def short(*words: str) -> "subprocess.CompletedProcess[str]":
        return subprocess.run(
            ["bash", "--norc", "-c", '. "$0" && roah-rsbb "$@"', str(HOOK), *words], text=True, check=False,
            env={"PATH": "/usr/bin:/bin", "CMAKE_PREFIX_PATH": str(tmp_path)}, capture_output=True,
        )

    started = short("comm", "status", "Home A")
    assert (started.stdout, started.returncode) == ("<status><Home A>", 4)
    (programs / "check_robot").symlink_to(programs / "comm")
    for name in ("check-robot", "check_robot"):
        assert short(name, "--only", "run-hnf").stdout == "<--only><run-hnf>"
    for unknown in (["no_such_program"], []):
        refused = short(*unknown)
        assert (refused.returncode, refused.stderr.count("usage: roah-rsbb PROGRAM")) == (2, 1)
