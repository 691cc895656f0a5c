"""Detects when Python has imported a copy of this package other than the one that pip installed."""

import importlib.metadata
import os
import pathlib
import sys


def replaced() -> str:
    """Return a warning if PYTHONPATH puts another roah_rsbb before the one of this virtual environment; else "".

    Sourcing ROS sets PYTHONPATH, and ROS has a copy of this package.
    """
    running = pathlib.Path(__file__).resolve().parent
    prefix = pathlib.Path(sys.prefix).resolve()
    if sys.prefix == sys.base_prefix or prefix in running.parents or not os.environ.get("PYTHONPATH"):
        return ""
    for installed in importlib.metadata.distributions():
        home = pathlib.Path(str(installed.locate_file("roah_rsbb"))).resolve()
        if installed.metadata["Name"] == "roah-rsbb-robot" and prefix in home.parents:
            return (f"roah_rsbb runs from {running}, because PYTHONPATH names that copy. pip installed one in {home}. "
                    "Remedy: 'unset PYTHONPATH' in this terminal, or 'python -I'")
    return ""


def warn_if_replaced() -> None:
    """Print the warning of `replaced` on standard error, if there is one."""
    text = replaced()
    if text:
        print(f"warning: {text}", file=sys.stderr)
