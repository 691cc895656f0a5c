"""Every command in the documentation names programs, options, launch files and arguments that there are."""

import importlib.util
import os
import re
import shlex
import shutil

import pages
import programs
import pytest
from pages import ROOT

from roah_rsbb.tools.team import COMMANDS as COMMANDS_WITHOUT_ROS

# Programs that a venue's computer has, and this one perhaps not: they are taken on trust.
ELSEWHERE = {"apt-get", "apt-key", "catkin_make", "chronyc", "curl", "git", "pip", "sudoedit", "systemctl", "ufw",
             "xset"}
IN_THE_SHELL = {".", "cd", "export", "source", "echo", "set", "umask"}
COMMANDS = [(f"{block.where}: {command}", command) for page in pages.NAMES for block in pages.blocks(page)
            if block.language == "sh" for command in pages.commands(block)]


def parts(command):
    """The single commands in a line, as words."""
    lexer = shlex.shlex(command, posix=True, punctuation_chars="|&;<>()")
    lexer.whitespace_split = True
    lexer.commenters = "#"
    words = []
    for token in lexer:
        if set(token) <= set("|&;()"):
            yield words
            words = []
        else:
            words.append(token)
    yield words


def without_settings(words):
    """A command without NAME=value, sudo and redirections before and behind it."""
    words = list(words)
    while words and (re.fullmatch(r"[A-Za-z_]\w*=.*", words[0]) or words[0] == "sudo"):
        words.pop(0)
    for sign in ("<", ">", ">>"):
        if sign in words:
            words = words[:words.index(sign)]
    return words


def check_rosrun(package, script, *given):
    if package != "roah_rsbb":
        return
    assert script in programs.SCRIPTS, f"no script {script}"
    said = programs.helps()[script].text
    word = next((each for each in given if not each.startswith("-")), "")
    if script in ("panel", "referee", "results", "standby") and word:
        assert re.search(rf"\b{word}\b", said), f"{script} has no command {word}"
        if any(each.startswith("--") for each in given):
            said += programs.help_of(script, word).text
    check_options(said, given)


def check_options(said, given):
    for each in given:
        option = re.match(r"--[a-z][\w-]*", each)
        if option:
            assert option.group() in programs.options(said), f"no option {option.group()}"
        setting = re.match(r"_([a-z]\w*):=", each)
        if setting:
            assert re.search(rf"\b{setting.group(1)}\b", said), f"no parameter {setting.group(1)}"


def check_roslaunch(*given):
    given = [each for each in given if not each.startswith("-")]
    folder = "launch"
    if given[0] == "roah_rsbb_comm_ros":
        folder, name, settings = "roah_rsbb_comm_ros/launch", given[1], given[2:]
    elif given[0] == "roah_rsbb":
        name, settings = given[1], given[2:]
        assert name in programs.LAUNCH_FILES, f"no launch file {name}"
    elif given[0] == "roah_rsbb_comm_ros":
        name, settings = given[1], given[2:]
        known = programs.arguments(f"../roah_rsbb_comm_ros/launch/{name}")
        assert {setting.partition(":=")[0] for setting in settings} <= known, f"{name} has the arguments {known}"
        return
    else:
        # A competition's own: it takes what roah_rsbb.launch takes.
        assert given[0].endswith("competition.launch"), f"roslaunch {given[0]}"
        name, settings = "roah_rsbb.launch", given[1:]
    for setting in settings:
        argument = setting.partition(":=")[0]
        assert argument in programs.arguments(name, folder) or setting == "…", f"{name} has no argument {argument}"


def check_python(*given):
    if given[0] == "-m" and given[1].startswith("roah_rsbb"):
        assert importlib.util.find_spec(given[1]) is not None, f"no module {given[1]}"
    elif given[0] == "bench/run.py" or given[0].startswith("tools/"):
        assert (ROOT / given[0]).exists()


def check(words):
    """AssertionError if there is anything in this command that there is not."""
    words = without_settings(words)
    if not words:
        return
    program, given = words[0], words[1:]
    if program == "rosrun":
        check_rosrun(*given)
    elif program == "roslaunch":
        check_roslaunch(*given)
    elif program == "make":
        assert {each for each in given if "=" not in each} <= programs.make_targets(), f"make {given}"
    elif re.fullmatch(r".*python3?", program):
        check_python(*given)
    elif program == "roah-rsbb":
        assert given[0] in COMMANDS_WITHOUT_ROS, f"no command {given[0]}"
        said = programs.help_without_ros(given[0]).text
        check_options(said, given[1:])
        for each in given[1:]:
            name, is_setting, _ = each.partition(":=")
            assert not is_setting or re.search(rf"\b{name}\b", said), f"{given[0]} has no setting {name}"
    elif "/" in program:
        assert os.access(str(ROOT / program), os.X_OK), f"no program {program}"
    elif program not in IN_THE_SHELL | ELSEWHERE:
        assert shutil.which(program), f"no program {program}"


@pytest.mark.parametrize("where, command", COMMANDS, ids=[where for where, _ in COMMANDS])
def test_a_command_can_be_given(where, command):
    for words in parts(command):
        check(words)


def test_there_are_commands():
    assert len(COMMANDS) > 50


@pytest.mark.parametrize("command", [
    "rosrun roah_rsbb no_such_script", "rosrun roah_rsbb preflight --no-such-option",
    "rosrun roah_rsbb panel no_such_panel", "rosrun roah_rsbb referee no_such_command",
    "rosrun roah_rsbb referee run Home --no-such-option",
    "roah-rsbb no-such-command", "roah-rsbb demo --no-such-option", "roah-rsbb run DIR no_such_setting:=1",
    "rosrun roah_rsbb roah_rsbb_core _no_such_parameter:=1", "roslaunch roah_rsbb no_such.launch",
    "roslaunch roah_rsbb roah_rsbb.launch no_such_argument:=1", "cd /tmp && make no-such-target",
    "no_such_program", "tools/no_such_tool", "A=1 sudo no_such_program", "python3 -m roah_rsbb.no_such_module",
    "roslaunch other.launch", "true | no_such_program",
])
def test_a_command_that_cannot_be_given_is_found(command):
    with pytest.raises(AssertionError):
        for words in parts(command):
            check(words)
