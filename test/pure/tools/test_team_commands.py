"""The programs under the names that their users type."""

import subprocess
import sys

import pytest

import roah_rsbb
from roah_rsbb.tools.team import COMMANDS


def start(tmp_path, *arguments, name="roah-rsbb"):
    """Run the command as pip installs it: a script of this name."""
    script = tmp_path / name
    script.write_text(f"import sys; sys.path[:] = {sys.path!r}\n"
                      f"import roah_rsbb; roah_rsbb.__path__ = {list(roah_rsbb.__path__)!r}\n"
                      "from roah_rsbb.tools.team import main\nmain()\n", encoding="utf-8")
    return subprocess.run([sys.executable, str(script), *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True)


@pytest.mark.parametrize("command", COMMANDS)
def test_help_and_errors_name_the_command_as_it_was_typed(tmp_path, command):
    name = f"roah-rsbb {command}"
    explained = start(tmp_path, command, "--help")
    assert explained.returncode == 0 and explained.stdout.startswith(f"usage: {name} "), explained.stdout
    wrong = start(tmp_path, command, "--no-such-option")
    assert wrong.returncode == 2 and f"{name}: " in wrong.stdout, wrong.stdout


def test_a_program_of_ros_has_its_own_name(tmp_path):
    explained = start(tmp_path, "check-robot", "--help", name="check_robot")
    assert explained.stdout.startswith("usage: check_robot "), explained.stdout


def test_an_unknown_command_is_an_error_that_lists_all(tmp_path):
    ended = start(tmp_path, "check_robots")
    assert ended.returncode == 2 and "no command 'check_robots'" in ended.stdout
    assert all(f"  {command} " in ended.stdout for command in COMMANDS)
