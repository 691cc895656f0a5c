"""The box of a competition, without ROS: all that its folder says, in one program.

The web pages are its face: the first address that is printed opens them, and pairs this computer as the organiser's.
Terminals use 'roah-rsbb referee'. It ends with Ctrl-C; runs continue when it is started again. If it ends unexpectedly,
it starts again by itself and continues its runs.
"""

import argparse
import logging
import pathlib
import sys
import textwrap
from typing import Dict, List, Optional

from roah_rsbb.arguments import Parser, called
from roah_rsbb.box.program import settings as settings_of
from roah_rsbb.durable import close_to_others
from roah_rsbb.params import BadParams

# Seconds after which the loop's thread gets Python's lock from another thread. Usual are 0.005: too long for STOP.
SWITCH_S = 0.0005
ALONE = "--unsupervised"

_EPILOG = """\
settings, given as name:=value; those in FOLDER/competition.launch are their defaults:
{settings}

Parameters of the core that no launch file has, such as allowed_skew:=0.2, can be given, too (docs/ros_interface.md).
"""


def _parser() -> argparse.ArgumentParser:
    parser = Parser(called("run"), __doc__.strip())
    parser.add_argument("folder", metavar="FOLDER", help="the competition's folder, made by 'roah-rsbb new'")
    parser.add_argument("settings", metavar="name:=value", nargs="*", help="settings of this start (see below)")
    parser.add_argument("--no-browser", action="store_true", help="do not open the pages in a browser")
    parser.add_argument(ALONE, action="store_true",
                        help="do not start the box again if it ends unexpectedly, because systemd does that")
    return parser


def _explained(known: Dict[str, settings_of.Argument]) -> str:
    lines = [line for name, found in known.items()
             for line in textwrap.wrap(f"{name}: {found.doc} (default: {found.default or 'empty'})", 110,
                                       initial_indent="  ", subsequent_indent="      ")]
    return _EPILOG.format(settings="\n".join(lines))


def log_to_terminal() -> None:
    """Let the lines of the log appear on the standard error."""
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(message)s", datefmt="%H:%M:%S")
    logging.getLogger("tornado").setLevel(logging.ERROR)


def settings(folder: str, words: List[str]) -> settings_of.BoxSettings:
    """Return the settings of a box. Raises `BadParams`."""
    defaults = {name: found.default for name, found in settings_of.of_box().items()}
    path = pathlib.Path(folder)
    return settings_of.BoxSettings({**defaults, **settings_of.of_folder(path), **settings_of.of_words(words)})


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    given = sys.argv[1:] if arguments is None else arguments
    parser = _parser()
    parser.epilog = _explained(settings_of.of_box())
    options = parser.parse_args(given)
    log_to_terminal()
    close_to_others()
    try:
        found = settings(options.folder, options.settings)
        if not options.unsupervised:
            from roah_rsbb.box.program.supervisor import supervise

            sys.exit(supervise([sys.executable, "-m", "roah_rsbb.tools.team", "run", ALONE, *given],
                               found.path("log_dir")))
        from roah_rsbb.box.program.serving import serve

        sys.setswitchinterval(SWITCH_S)
        sys.exit(serve(found, not options.no_browser))
    except BadParams as error:
        sys.exit(f"{parser.prog}: {error}")
