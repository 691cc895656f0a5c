"""Checks whether windows can be opened here, and on which screens. It imports Qt, which may be missing or broken, only
in a child process."""

import faulthandler
import importlib
import os
from typing import List, NamedTuple

NO_DISPLAY = "No display: no window can be opened. Use 'rosrun roah_rsbb referee', or gui:=none."


class Screen(NamedTuple):
    """The place of a screen on the desktop, in pixels."""

    left: int
    top: int
    width: int
    height: int

    def __str__(self) -> str:
        return f"{self.width}x{self.height}+{self.left}+{self.top}"


def has_display() -> bool:
    """Whether Qt can open windows here. Call it before this process has threads or a QApplication."""
    return bool(screens())


def screens() -> List[Screen]:
    """Return the screens on which Qt can open windows; none: it cannot. Call it when `has_display` may be called."""
    # Qt aborts a process that cannot open a window, so a child process tries first.
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        _try(writing)
    os.close(writing)
    with os.fdopen(reading) as said:
        found = [Screen(*map(int, line.split())) for line in said]
    _, status = os.waitpid(child, 0)
    return found if status == 0 else []


def _try(writing: int) -> None:
    """Write the screens if windows can be opened, and end this process with 0."""
    faulthandler.disable()  # Qt may abort: that is an answer, too
    try:
        nothing = os.open(os.devnull, os.O_RDWR)
        for standard in (0, 1, 2):
            os.dup2(nothing, standard)
        application = importlib.import_module("roah_rsbb.rqt.qt").QApplication([])
        for screen in application.screens():
            os.write(writing, "{} {} {} {}\n".format(*screen.geometry().getRect()).encode())
        os._exit(0)
    finally:
        os._exit(1)
