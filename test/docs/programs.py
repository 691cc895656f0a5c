"""The help of the package's programs and launch files. Each is asked only once."""

import concurrent.futures
import functools
import os
import pathlib
import re
import sys
import tempfile
from typing import Dict, List, NamedTuple, Set
from xml.etree import ElementTree

from pages import ROOT
from roslaunch import arg_dump

sys.path.append(str(ROOT / "test" / "ros"))
from support.forking import start

SCRIPTS = sorted(path.name for path in (ROOT / "scripts").iterdir() if not path.is_symlink())
LAUNCH_FILES = sorted(path.name for path in (ROOT / "launch").iterdir())
AT_ONCE = 3
LIMIT_S = 60.0
# Nobody must be there: help that waits for a ROS master, a display or a key is none.
_NOBODY = {"ROS_MASTER_URI": "http://127.0.0.1:1", "DISPLAY": "", "WAYLAND_DISPLAY": ""}


class Said(NamedTuple):
    """The exit status and the output of a program."""

    status: int
    text: str


def ask(*command: str) -> Said:
    """Run a program that answers at once."""
    with open(os.devnull, "rb") as nothing, tempfile.TemporaryFile() as output:
        program = start(command, (nothing.fileno(), output.fileno(), output.fileno()), **_NOBODY)
        status = program.wait(LIMIT_S)
        output.seek(0)
        return Said(status, output.read().decode("utf-8"))


def _ask_all(questions: Dict[str, List[str]]) -> Dict[str, Said]:
    with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
        return dict(zip(questions, pool.map(lambda command: ask(*command), questions.values())))


@functools.lru_cache(maxsize=None)
def helps() -> Dict[str, Said]:
    """The --help output of each script."""
    return _ask_all({name: [str(ROOT / "scripts" / name), "--help"] for name in SCRIPTS})


@functools.lru_cache(maxsize=None)
def help_of(script: str, word: str) -> Said:
    """The --help output of a script's command, such as `referee run --help`."""
    return ask(str(ROOT / "scripts" / script), word, "--help")


@functools.lru_cache(maxsize=None)
def help_without_ros(command: str) -> Said:
    """The --help output of a command of `roah-rsbb`."""
    return ask(sys.executable, "-m", "roah_rsbb.tools.team", command, "--help")


def ros_args(launch_file: str) -> Dict[str, str]:
    """The help of `roslaunch --ros-args` for each argument of a launch file."""
    path = str(ROOT / "launch" / launch_file)
    return {name: doc for name, (doc, _) in arg_dump.get_args([path]).items()}


def arguments(launch_file: str, folder: str = "launch") -> Set[str]:
    """The arguments that a launch file takes."""
    root = ElementTree.parse(str(ROOT / folder / launch_file)).getroot()
    return {arg.get("name") for arg in root.findall("arg")}


def options(text: str) -> Set[str]:
    """The options that a help names."""
    return set(re.findall(r"(?<![\w-])--?[a-zA-Z][\w-]*", text))


def make_targets() -> Set[str]:
    """The targets of `make`."""
    makefile = pathlib.Path(ROOT / "Makefile").read_text(encoding="utf-8")
    return set(re.findall(r"^([a-z0-9-]+):.*##", makefile, re.MULTILINE))
