"""`roah-rsbb COMMAND`: the programs that pip installs, without ROS."""

import difflib
import importlib
import importlib.util
import sys
from typing import List, Optional

# Command -> its package, its module, and what it does.
COMMANDS = {
    "demo": ("box", "box.program.demo", "a demonstration: a box with dummy robots, on this computer alone"),
    "new": ("box", "tools.competition.program", "create or check the folder of a competition"),
    "rulebook": ("box", "tools.competition.rules", "show and check the rules of a competition"),
    "preflight": ("box", "tools.preflight", "check the set-up before a competition"),
    "run": ("box", "box.program.main", "the box of a competition"),
    "referee": ("box", "referee.program", "the referee in a terminal"),
    "dummy-robot": ("robot", "robot.dummy", "a simulated robot"),
    "check-robot": ("check", "check.program", "check a robot: plays the box against it, and reports what works"),
    "capture": ("check", "capture.program", "show the datagrams on the network"),
    "dummy-box": ("check", "check.dummy_box", "a box for a team: leads one robot through a run"),
    "standby": ("box", "standby.program.main", "a second computer that takes over when the box is lost"),
    "results": ("box", "results.program.main", "show and export the runs of a competition"),
}
# Not for users: processes of a box.
INTERNAL = {"modules": ("box", "box.program.modules_process", ""), "copies": ("box", "standby.program.copying", ""),
            "barest": ("box", "box.program.barest", ""), "guard": ("box", "standby.program.guard", "")}


def _usage() -> str:
    lines = [f"  {name:<13}{what}" for name, (_, _, what) in COMMANDS.items()]
    return "\n".join([
        "usage: roah-rsbb [COMMAND [ARGUMENT...]]", "", "Programs that need no ROS. Without a command, a page in the "
        "browser leads to them.", "", "commands:", *lines,
        "", "'roah-rsbb COMMAND --help' explains a command."])


def main(arguments: Optional[List[str]] = None) -> None:
    """Run a command with its arguments (default: those of the process)."""
    given = sys.argv[1:] if arguments is None else arguments
    if given and given[0] in ("-h", "--help"):
        print(_usage())
        return
    if not given and importlib.util.find_spec("roah_rsbb.box") is not None:
        importlib.import_module("roah_rsbb.box.program.start_page").main()
        return
    commands = {**COMMANDS, **INTERNAL}
    if not given or given[0] not in commands:
        near = difflib.get_close_matches(given[0].lower(), COMMANDS, 1) if given else []
        meant = f": did you mean '{near[0]}'?" if near else ""
        wrong = f"roah-rsbb: no command '{given[0]}'{meant}\n" if given else ""
        print(f"{wrong}{_usage()}", file=sys.stderr)
        sys.exit(2)
    package, module, _ = commands[given[0]]
    try:
        program = importlib.import_module(f"roah_rsbb.{module}")
    except ModuleNotFoundError as error:
        wheel = "roah-rsbb" if package == "box" else f"roah-rsbb-{package}"
        sys.exit(f"roah-rsbb: {given[0]} is in the package {wheel}, which is not here ({error}): install "
                 f"its wheel, or 'ROAH_RSBB_PACKAGE={package} pip install ./roah_rsbb' where the source is")
    program.main(given[1:])


if __name__ == "__main__":
    main()
