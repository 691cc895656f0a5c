"""`rosrun roah_rsbb panel`: opens one panel alone, or our own window with all of them."""

import os
import sys
from functools import partial

from roah_rsbb.ground.arguments import Parser
from roah_rsbb.rqt.app.panel_list import PANELS

WINDOW = "window"
# Programs of the original have this before the name of their panel. They are links to `panel`.
ORIGINAL = "roah_rsbb_"
_ZONE = """\
It shows the zone of the client in whose namespace it runs: __ns:=/some_client. Without __ns it selects its own zone.
docs/referee.md explains the panels.
"""


def main() -> None:
    """Show what the command line asks for, until it is closed or ROS ends."""
    words = [word for word in sys.argv[1:] if ":=" not in word]  # ROS adds words such as __name:=x
    program = os.path.basename(sys.argv[0])
    if program.startswith(ORIGINAL):
        words.insert(0, program[len(ORIGINAL):])
    choices = {**PANELS, WINDOW: "All panels in one window, which needs no rqt"}
    listed = "\n".join(f"  {name:18}{what}" for name, what in choices.items())
    parser = Parser("panel", f"Opens one of the referee's panels:\n\n{listed}", _ZONE)
    parser.add_argument("panel", nargs="?", choices=choices, metavar="PANEL", help="one of the names above")
    chosen = parser.parse_args(words).panel
    if chosen is None:
        parser.print_help()
    elif chosen == WINDOW:
        show_window()
    else:
        # Late, because help needs no Qt.
        from roah_rsbb.rqt.app.application import show
        from roah_rsbb.rqt.app.standalone import PanelWindow
        from roah_rsbb.rqt.with_ros.host import HostWithRos

        host = HostWithRos()
        show(host, f"{ORIGINAL}{chosen}", partial(PanelWindow, host, chosen))


def show_window(of_launch: bool = False) -> None:
    """Show our own window until it is closed or ROS ends. `of_launch`: see `Window`."""
    from roah_rsbb.rqt.app.application import show  # late: one panel needs not all of them
    from roah_rsbb.rqt.app.window import Window
    from roah_rsbb.rqt.with_ros.host import HostWithRos

    host = HostWithRos()
    show(host, "roah_rsbb_window", partial(Window, host, of_launch=of_launch))
