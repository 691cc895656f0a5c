"""This package as it is installed: the configuration files and pages that it ships (in a wheel, below share/, or in the
source), and whether Python has imported another copy of it than the one that pip installed."""

import importlib.metadata
import os
import pathlib
import sys
from typing import Optional

PACKAGE = pathlib.Path(__file__).resolve().parents[1]
_PLACES = (PACKAGE / "shipped_files", PACKAGE.parents[1], *(up / "share" / "roah_rsbb" for up in PACKAGE.parents))


class NotShipped(Exception):
    """The files are missing. The text says what to do."""


def shipped_file(path: str) -> pathlib.Path:
    """The place of a file of the top folder, such as launch/roah_rsbb.launch; raises NotShipped."""
    for place in _PLACES:
        if (place / path).is_file():
            return place / path
    raise NotShipped(f"the shipped {path} is missing near {PACKAGE}: install the package again")


def shipped_folder() -> pathlib.Path:
    """The folder `config` with benchmarks.yaml and modules/, beside the folder `resource`; raises NotShipped."""
    return shipped_file("config/benchmarks.yaml").parent


def is_shipped(path: str) -> bool:
    """Whether a file is a part of the program, which nobody but its installation writes."""
    try:
        return shipped_folder().resolve() in pathlib.Path(path).resolve().parents
    except NotShipped:
        return False


def pages_folder() -> Optional[pathlib.Path]:
    """The folder with docs/, whose pages the findings name. None: the pages are not installed."""
    places = (*_PLACES, pathlib.Path("/usr/share/doc/roah-rsbb"))
    # Debian packages compress long pages.
    return next((place for place in places if any((place / "docs").glob("protocol.md*"))), None)


def replaced() -> str:
    """Return a warning if PYTHONPATH puts another roah_rsbb before the one of this virtual environment; else "".

    Sourcing ROS sets PYTHONPATH, and ROS has a copy of this package.
    """
    prefix = pathlib.Path(sys.prefix).resolve()
    if sys.prefix == sys.base_prefix or prefix in PACKAGE.parents or not os.environ.get("PYTHONPATH"):
        return ""
    for installed in importlib.metadata.distributions():
        home = pathlib.Path(str(installed.locate_file("roah_rsbb"))).resolve()
        if installed.metadata["Name"] == "roah-rsbb-robot" and prefix in home.parents:
            return (f"roah_rsbb runs from {PACKAGE}, because PYTHONPATH names that copy. pip installed one in {home}. "
                    "Remedy: 'unset PYTHONPATH' in this terminal, or 'python -I'")
    return ""


def warn_if_replaced() -> None:
    """Print the warning of `replaced` on standard error, if there is one."""
    text = replaced()
    if text:
        print(f"warning: {text}", file=sys.stderr)
