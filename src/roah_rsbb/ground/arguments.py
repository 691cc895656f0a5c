"""The argument parser of all programs without ROS."""

import argparse
import difflib
import os
import re
import sys
from typing import Any, Callable, List, NoReturn, TypeVar

T = TypeVar("T")


# In the environment of what a box with ROS starts.
WITH_ROS = "ROAH_RSBB_WITH_ROS"


def is_without_ros() -> bool:
    """Whether users start this program, or the one that started it, as a command of `roah-rsbb`, installed by pip."""
    if WITH_ROS in os.environ:
        return False
    # team.py is that of `python -m roah_rsbb.tools.team`; also roah-rsbb.exe, roah-rsbb.pyz.
    program = os.path.basename(sys.argv[0])
    return program == "team.py" or program.partition(".")[0] == "roah-rsbb"


def without_ros(*words: str) -> List[str]:
    """Return a command of `roah-rsbb` for another process."""
    # In a single file, Python finds no module by its name.
    here = [sys.argv[0]] if sys.argv[0].endswith(".pyz") else ["-m", "roah_rsbb.tools.team"]
    return [sys.executable, *here, *words]


def called(name: str, command: str = "") -> str:
    """Return a program's name as users type it: `check_robot` in ROS, `roah-rsbb check-robot` if pip installed it.
    `command`: if it is not made of the name."""
    return f"roah-rsbb {command or name.replace('_', '-')}" if is_without_ros() else name


def typed(name: str) -> str:
    """Return how users start a program in a terminal, with ROS or without."""
    return called(name) if is_without_ros() else f"rosrun roah_rsbb {name}"


class Parser(argparse.ArgumentParser):
    """Reports a wrong argument in one line. Its help keeps the line breaks of the given texts.

    It completes the arguments for bash (env-hooks/50.roah_rsbb.bash).
    """

    def __init__(self, prog: str, description: str, epilog: str = "", **options: Any) -> None:
        options.setdefault("formatter_class", argparse.RawDescriptionHelpFormatter)
        super().__init__(prog=prog, description=description, epilog=epilog, allow_abbrev=False, **options)

    def parse_args(self, args: Any = None, namespace: Any = None) -> argparse.Namespace:
        """Parse the arguments. If bash asks for completions, print these instead and end the program."""
        if "_ARGCOMPLETE" in os.environ:
            import argcomplete

            argcomplete.autocomplete(self)
        return super().parse_args(args, namespace)

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Of a wrong choice, say which one was probably meant."""
        known = [] if action.choices is None or value in action.choices else action.choices
        choices = {str(choice).lower(): choice for choice in known}
        for near in difflib.get_close_matches(str(value).lower(), choices, 1):
            raise argparse.ArgumentError(action, f"no '{value}': did you mean '{choices[near]}'?")
        super()._check_value(action, value)

    def error(self, message: str) -> NoReturn:
        """Print the error, and end the program with status 2."""
        self.exit(2, f"{self.prog}: {message} (see --help)\n")


def number(low: float, high: float) -> Callable[[str], float]:
    """A type for argparse: a number from `low` to `high`."""
    def number_between(text: str) -> float:
        try:
            value = float(re.sub(r"^(-?\d+),(\d{1,2})$", r"\1.\2", text))  # a decimal comma; 1,000 may be a thousand
        except ValueError:
            value = float("nan")
        if not low <= value <= high:  # also true for NaN
            raise argparse.ArgumentTypeError(f"{text!r} is not a number from {low:g} to {high:g}")
        return value
    return number_between


def read_by(read: Callable[[str], T]) -> Callable[[str], T]:
    """A type for argparse: the value that `read` returns. If it raises ValueError, the user sees that text."""
    def read_argument(text: str) -> T:
        try:
            return read(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from None
    return read_argument


def add_password(to: "argparse._ArgumentGroup") -> None:
    """Add the ways to give one team's password (`comm.ciphers.own_password`)."""
    password = to.add_mutually_exclusive_group()
    password.add_argument("--password", help="the team's password, for tests (see below)")
    password.add_argument("--password-file", metavar="FILE", help="a file whose first line is the password")


def add_network(to: "argparse._ArgumentGroup") -> None:
    """Add where a participant is in the network of the robots."""
    to.add_argument("--host", default="10.255.255.255", metavar="BROADCAST",
                    help="the network's broadcast address; 'ip -4 addr' shows it as brd (default: %(default)s)")
    to.add_argument("--port", type=public_port, default=6666, help="public UDP port (default: %(default)s)")
    to.add_argument("--bind", default="0.0.0.0", metavar="HOST",
                    help="local address, if participants share a machine (default: %(default)s)")


def public_port(text: str) -> int:
    """A type for argparse: a public UDP port, with space for private ports above it."""
    if not text.isdecimal() or not 1 <= int(text) <= 65000:
        raise argparse.ArgumentTypeError(f"{text!r} is not a UDP port from 1 to 65000. Private ports are above it")
    return int(text)
