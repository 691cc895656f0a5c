"""`roah-rsbb COMMAND`: the programs for teams that installed this package with pip, without ROS."""

import importlib
import sys
from typing import List, Optional

# Command -> its module, and what it does.
COMMANDS = {
    "check-robot": ("roah_rsbb.check.program", "check a robot: plays the box against it, and reports what works"),
    "capture": ("roah_rsbb.capture.program", "show the datagrams on the network"),
    "dummy-robot": ("roah_rsbb.robot.dummy", "a simulated robot"),
    "dummy-box": ("roah_rsbb.check.dummy_box", "the referee's box for a laptop: leads a robot through a run"),
}


def _usage() -> str:
    lines = [f"  {name:<13}{what}" for name, (_, what) in COMMANDS.items()]
    return "\n".join([
        "usage: roah-rsbb COMMAND [ARGUMENT...]", "", "Programs for teams. They need no ROS.", "", "commands:", *lines,
        "", "'roah-rsbb COMMAND --help' explains a command."])


def main(arguments: Optional[List[str]] = None) -> None:
    """Run a command with its arguments (default: those of the process)."""
    given = sys.argv[1:] if arguments is None else arguments
    if given and given[0] in ("-h", "--help"):
        print(_usage())
        return
    if not given or given[0] not in COMMANDS:
        wrong = f"roah-rsbb: no command '{given[0]}'\n" if given else ""
        print(f"{wrong}{_usage()}", file=sys.stderr)
        sys.exit(2)
    importlib.import_module(COMMANDS[given[0]][0]).main(given[1:])
