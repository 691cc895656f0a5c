"""The settings of a box without ROS: those of its launch files, which are read as data.

Names, defaults and explanations stand once, in `launch/roah_rsbb.launch`. The launch file of a competition's folder
changes some of them, and `name:=value` on the command line the others, as roslaunch has it. Parameters of the core that
no launch file names, such as allowed_skew, can be given, too.
"""

import contextlib
import os
import pathlib
import re
from typing import Container, Dict, List, Sequence, Set

from roah_rsbb.ground.installed import shipped_file
from roah_rsbb.ground.params import BadParams, Params
from roah_rsbb.rulebook.errors import LaunchArgument, Report, arguments
from roah_rsbb.wording.texts import did_you_mean

LAUNCH = "competition.launch"
_OF_ALL = "launch/roah_rsbb.launch"
# Names of parameters that the launch files give another name.
_ARGUMENTS = {"title": "web_title", "parameters_dir": "modules_dir"}
# Of the launch files, but not of a box without ROS.
_OF_ROS = ("gui", "part")
_SUBSTITUTION = re.compile(r"\$\(([^)]*)\)")


def of_box() -> Dict[str, LaunchArgument]:
    """Return the arguments of a box. Raises `BadParams`."""
    return {name: found for name, found in _arguments(shipped_file(_OF_ALL)).items()
            if name not in _OF_ROS}


def defaults() -> Dict[str, str]:
    """Return the values of these arguments that nobody changed. Raises `BadParams`."""
    return {name: found.default for name, found in of_box().items()}


def of_folder(folder: pathlib.Path, without: Container[str] = ()) -> Dict[str, str]:
    """Return what the launch file of a competition's folder sets, `without` these settings. Raises `BadParams`."""
    path = folder / LAUNCH
    if not path.is_file():
        raise BadParams(f"{path} is missing: make a competition's folder with 'roah-rsbb new {folder}', or with ROS "
                        f"'rosrun roah_rsbb new_competition {folder}'")
    return {name: found.default for name, found in _arguments(path, without).items()}


def of_words(words: Sequence[str]) -> Dict[str, str]:
    """Return what a command line sets, in words such as rsbb_host:=192.168.1.255. Others are left out."""
    return dict(word.split(":=", 1) for word in words if ":=" in word)


def _arguments(path: pathlib.Path, without: Container[str] = ()) -> Dict[str, LaunchArgument]:
    report = Report()
    found = {name: argument._replace(default=_value(path, name, argument.default))
             for name, argument in arguments(report, str(path)).items() if name not in without}
    if report.errors:
        raise BadParams("\n".join(map(str, report.errors)))
    return found


def _value(path: pathlib.Path, name: str, text: str) -> str:
    """Return the value of an argument, with the substitutions of roslaunch that the launch files of a competition have.
    Raises `BadParams` for others."""
    def value_of(found: "re.Match[str]") -> str:
        command, _, what = found[1].partition(" ")
        if command == "dirname":
            return str(path.parent.resolve())
        if (command, what) == ("find", "roah_rsbb"):
            return str(shipped_file(_OF_ALL).parents[1])
        if command in ("env", "optenv"):
            variable, _, instead = what.partition(" ")
            return os.environ.get(variable, instead)
        raise BadParams(f"{path}: only roslaunch can compute $({found[1]}) for {name}: give {name}:=value")

    return _SUBSTITUTION.sub(value_of, text)


class BoxSettings(Params):
    """The settings of a box as its parameters. `unknown` says which nobody asked for."""

    def __init__(self, values: Dict[str, str]) -> None:
        super().__init__()
        self._values = values
        self._asked: Set[str] = set()

    def given(self, name: str) -> str:
        """Return a setting as it was written; empty: it is not set."""
        self._asked.add(name)
        return self._values.get(name, "")

    def full_name(self, name: str) -> str:
        """See `Params`."""
        return _ARGUMENTS.get(name, name)

    def unknown(self, known: Sequence[str]) -> List[str]:
        """Return a text for each setting that nobody asked for and that is not among `known`."""
        names = {*known, *self._asked}
        return [f"there is no setting {name}{did_you_mean(name, sorted(names))}"
                for name in self._values if name not in names and name not in _OF_ROS]

    def _get(self, name: str, default: object) -> object:
        name = _ARGUMENTS.get(name, name)
        self._asked.add(name)
        return self._values.get(name, default)

    def _plain(self, name: str, default: object) -> object:
        found = self._get(name, default)
        return _plain(found) if isinstance(found, str) else found


def of_competition(folder: str, given: Dict[str, str]) -> BoxSettings:
    """Return the settings of a competition's box: those `given`, else those of its folder, else the defaults. Without
    a folder (empty), it has none. Raises `BadParams`."""
    of_launch_file = of_folder(pathlib.Path(folder), given) if folder else {}
    return BoxSettings({**defaults(), **of_launch_file, **given})


def _plain(text: str) -> object:
    """Return the value that roslaunch makes of a text."""
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    for kind in (int, float):
        with contextlib.suppress(ValueError):
            return kind(text)
    return text
