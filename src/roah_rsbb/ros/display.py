"""Whether windows can be opened here. Nothing of Qt is imported: it may not even work."""

import subprocess
import sys

# Qt aborts the process that it cannot give a window to: so another process tries first.
_TRY = "from python_qt_binding.QtWidgets import QApplication; QApplication([])"
NO_DISPLAY = "No display: no window is opened. On a machine without one use 'rosrun roah_rsbb referee', or gui:=none."


def has_display() -> bool:
    """Whether Qt can open windows here."""
    tried = subprocess.run(
        [sys.executable, "-c", _TRY], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    return tried.returncode == 0
