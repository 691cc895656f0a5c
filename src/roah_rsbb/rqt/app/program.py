"""`roah-rsbb window`: the referee's window without ROS."""

import os
import sys
from functools import partial
from typing import List, Optional

from roah_rsbb import platform
from roah_rsbb.arguments import Parser, called

NAME = "window"  # of its settings
_MORE = """\
It finds the box of this user on this computer. ROAH_RSBB_DOOR names the file of the door of another one
(docs/door.md). docs/referee.md explains the panels.
"""
NO_DISPLAY = "no display: no window can be opened here. Use 'roah-rsbb referee' in a terminal"


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    parser = Parser(called("window"), "The referee's window, with all panels. It needs no ROS.", _MORE)
    parser.add_argument("--utc", action="store_true", help="show times in UTC (default: the venue's time)")
    options = parser.parse_args(arguments)
    if not (platform.has_display() or os.environ.get("QT_QPA_PLATFORM")):
        sys.exit(f"{called('window')}: {NO_DISPLAY}")
    # Late: help needs no Qt.
    from roah_rsbb.rqt import interruptible  # noqa: F401
    from roah_rsbb.rqt.qt import NoQt

    try:
        from roah_rsbb.rqt.app.application import show
        from roah_rsbb.rqt.app.window import Window
        from roah_rsbb.rqt.app.without_ros import HostWithoutRos
    except NoQt as error:
        sys.exit(f"{called('window')}: {error}")
    host = HostWithoutRos(NAME, options.utc)
    show(host, NAME, partial(Window, host))
