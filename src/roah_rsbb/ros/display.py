"""Checks whether windows can be opened here. It does not import Qt, which may be missing or broken."""

import subprocess
import sys

# Qt aborts a process that cannot open a window, so a child process tries first.
_TRY = "from roah_rsbb.rqt.qt import QApplication; QApplication([])"
NO_DISPLAY = "No display: no window can be opened. Use 'rosrun roah_rsbb referee', or gui:=none."


def has_display() -> bool:
    """Whether Qt can open windows here."""
    tried = subprocess.run(
        [sys.executable, "-c", _TRY], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    return tried.returncode == 0
