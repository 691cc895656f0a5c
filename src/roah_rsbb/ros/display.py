"""Checks whether windows can be opened here. It imports Qt, which may be missing or broken, only in a child process."""

import faulthandler
import importlib
import os

NO_DISPLAY = "No display: no window can be opened. Use 'rosrun roah_rsbb referee', or gui:=none."


def has_display() -> bool:
    """Whether Qt can open windows here. Call it before this process has threads or a QApplication."""
    # Qt aborts a process that cannot open a window, so a child process tries first.
    child = os.fork()
    if child == 0:
        _try()
    _, status = os.waitpid(child, 0)
    return status == 0


def _try() -> None:
    """End this process with 0 if it can open windows."""
    faulthandler.disable()  # Qt may abort: that is an answer, too
    try:
        nothing = os.open(os.devnull, os.O_RDWR)
        for standard in (0, 1, 2):
            os.dup2(nothing, standard)
        application = importlib.import_module("roah_rsbb.rqt.qt").QApplication([])
        os._exit(0 if application else 1)
    finally:
        os._exit(1)
