"""The programs under the names that their users type."""

import json
import subprocess
import sys

import pytest

import roah_rsbb
from roah_rsbb.tools.team import COMMANDS


def start(tmp_path, *arguments, name="roah-rsbb", ending="main()\n"):
    """Run the command as pip installs it: a script of this name."""
    script = tmp_path / name
    script.write_text(f"import sys; sys.path[:] = {sys.path!r}\n"
                      f"import roah_rsbb; roah_rsbb.__path__ = {list(roah_rsbb.__path__)!r}\n"
                      f"from roah_rsbb.tools.team import main\n{ending}", encoding="utf-8")
    return subprocess.run([sys.executable, str(script), *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True)


# All commands in one process: each start costs a third of a second.
ASK_ALL = """
import contextlib, io, json
from roah_rsbb.tools.team import COMMANDS

said = {}
for command in COMMANDS:
    for option in ("--help", "--no-such-option"):
        with io.StringIO() as text, contextlib.redirect_stdout(text), contextlib.redirect_stderr(text):
            try:
                main([command, option])
            except SystemExit as ended:
                said[f"{command} {option}"] = [ended.code, text.getvalue()]
print(json.dumps(said))
"""


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    """The exit status and the output of each command with --help, and with an unknown option."""
    done = start(tmp_path_factory.mktemp("team"), ending=ASK_ALL)
    return json.loads(done.stdout)


@pytest.mark.parametrize("command", COMMANDS)
def test_help_and_errors_name_the_command_as_it_was_typed(said, command):
    name = f"roah-rsbb {command}"
    status, text = said[f"{command} --help"]
    assert status == 0 and text.startswith(f"usage: {name} "), text
    status, text = said[f"{command} --no-such-option"]
    assert status == 2 and f"{name}: " in text, text


def test_a_program_of_ros_has_its_own_name(tmp_path):
    explained = start(tmp_path, "check-robot", "--help", name="check_robot")
    assert explained.stdout.startswith("usage: check_robot "), explained.stdout


def test_an_unknown_command_is_an_error_that_lists_all(tmp_path):
    ended = start(tmp_path, "check_robots")
    assert ended.returncode == 2 and "no command 'check_robots': did you mean 'check-robot'?" in ended.stdout
    assert all(f"  {command} " in ended.stdout for command in COMMANDS)


def test_a_command_of_a_package_that_is_not_installed_names_it(tmp_path):
    ended = start(tmp_path, "check-robot", ending="sys.modules['roah_rsbb.check'] = None\nmain()\n")
    assert ended.returncode == 1 and "check-robot is in the package roah-rsbb-check, which is not here" in ended.stdout
