"""Programs that open windows: `rosrun roah_rsbb panel`, and `roah_rsbb_gui`, which the launch files start. They load Qt
only when they need it.

`roah_rsbb_gui` starts the window of a client (`roah_rsbb_client.launch`) and reopens it after a crash. roslaunch's
respawn would try forever on a machine that cannot open windows. A window that was closed stays closed, unless it
belongs to the box.
"""

import argparse
import importlib.util
import os
import signal
import subprocess
import sys
import time
from functools import partial
from typing import List, NamedTuple, Optional

from roah_rsbb.ground.arguments import Parser
from roah_rsbb.ros import display
from roah_rsbb.rqt.panels import PANELS

# -- rosrun roah_rsbb panel -----------------------------------------------------------------------------

ALL = "window"
# Programs of the original have this before the name of their panel. They are links to `panel`.
ORIGINAL = "roah_rsbb_"
_ZONE = """\
It shows the zone of the client in whose namespace it runs: __ns:=/some_client. Without __ns it selects its own zone.
docs/referee.md explains the panels.
"""


def show_panel() -> None:
    """Show what the command line asks for, until it is closed or ROS ends."""
    words = [word for word in sys.argv[1:] if ":=" not in word]  # ROS adds words such as __name:=x
    program = os.path.basename(sys.argv[0])
    if program.startswith(ORIGINAL):
        words.insert(0, program[len(ORIGINAL):])
    choices = {name: panel.what for name, panel in PANELS.items()}
    choices[ALL] = "All panels in one window, which needs no rqt"
    listed = "\n".join(f"  {name:18}{what}" for name, what in choices.items())
    parser = Parser("panel", f"Opens one of the referee's panels:\n\n{listed}", _ZONE)
    parser.add_argument("panel", nargs="?", choices=choices, metavar="PANEL", help="one of the names above")
    chosen = parser.parse_args(words).panel
    if chosen is None:
        parser.print_help()
    elif chosen == ALL:
        show_window()
    else:
        from roah_rsbb.rqt import application, windows

        application.show(f"{ORIGINAL}{chosen}", partial(windows.PanelWindow, chosen))


def show_window(of_launch: bool = False) -> None:
    """Show our own window until it is closed or ROS ends. `of_launch`: see `Window`."""
    from roah_rsbb.rqt import application, windows

    application.show("roah_rsbb_window", partial(windows.Window, of_launch=of_launch))


# -- roah_rsbb_gui --------------------------------------------------------------------------------------

RQT_MODULES = ("rqt_gui", "rqt_gui_py", "qt_gui")
NO_RQT = "rqt is not installed: install ros-noetic-rqt-gui and ros-noetic-rqt-gui-py, or use gui:=window"
# A locked rqt (qt_gui 0.4.2) crashes at every start except the first, when it replaces the layout that it imported
# before. It therefore gets its own settings file, which is cleared at the start.
_RUN_RQT = (
    "from rqt_gui.main import Main; from roah_rsbb.rqt.application import run_rqt; "
    "run_rqt(Main(filename='rqt', settings_filename='roah_rsbb_rqt'))"
)
# rqt caches its list of plugins: make it search again. The layout is frozen and locked, so that no panel is closed
# accidentally. For another layout, start rqt yourself.
RQT = [sys.executable, "-c", _RUN_RQT, "--clear-config", "--force-discover", "--lock-perspective", "--freeze-layout"]
WINDOW = [sys.executable, "-c", "from roah_rsbb.rqt.programs import show_window; show_window(of_launch=True)"]

REOPEN_S = 1.0
# A window that ends sooner has failed; after this many failures in a row the program gives up.
SHORT_LIFE_S = 5.0
MAX_SHORT_LIVES = 5
# A window that has not ended so long after a signal is killed. Its own limits (application.py) are shorter.
KILL_S = 2.5


class WindowChoice(NamedTuple):
    """The program to start."""

    command: Optional[List[str]]  # None: nothing
    text: str = ""  # for the log
    code: int = 0  # exit code when there is nothing to start


def choose(gui: str, has_display: bool, has_rqt: bool) -> WindowChoice:
    """Return what `gui` (auto, rqt or window) means on this machine."""
    if not has_display:
        return WindowChoice(None, display.NO_DISPLAY)
    if gui == "window" or (gui == "auto" and not has_rqt):
        return WindowChoice(WINDOW)
    return WindowChoice(RQT) if has_rqt else WindowChoice(None, NO_RQT, 1)


class Keeper:
    """Keeps a program running until it exits normally or a signal ends this process."""

    def __init__(self, command: List[str], reopen: bool) -> None:
        """`reopen`: start it again after a normal exit, too."""
        self._command = command
        self._reopen = reopen
        self._child: Optional[subprocess.Popen] = None
        self._ending = False

    def run(self) -> int:
        """Run the program. Returns its last exit code."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._end)
        signal.signal(signal.SIGALRM, lambda *_: self._send(signal.SIGKILL))
        short_lives = 0
        while True:
            started = time.monotonic()
            self._child = subprocess.Popen(self._command)
            if self._ending:  # the signal came before there was a child
                self._send(signal.SIGTERM)
            code = self._child.wait()
            signal.setitimer(signal.ITIMER_REAL, 0)  # it must not come while Python ends, without its handlers
            if self._ending or (code == 0 and not self._reopen):
                return 0 if self._ending else code
            short_lives = short_lives + 1 if time.monotonic() - started < SHORT_LIFE_S else 0
            if short_lives >= MAX_SHORT_LIVES:
                _say(f"The window failed {short_lives} times in a row (exit code {code}): giving up")
                return code
            _say(f"The window {'was closed' if code == 0 else f'crashed (exit code {code})'}: opening it again")
            time.sleep(REOPEN_S)
            if self._ending:
                return 0

    def _end(self, *_) -> None:
        """End the program by SIGTERM: at its very start, Python can lose a SIGINT."""
        if not self._ending:
            signal.setitimer(signal.ITIMER_REAL, KILL_S)
        self._ending = True
        self._send(signal.SIGTERM)

    def _send(self, number: int) -> None:
        if self._child is not None:
            self._child.send_signal(number)


def keep_window_open() -> None:
    """Choose the window and keep it open."""
    parser = Parser("roah_rsbb_gui", "Opens the windows of a referee's client.")
    parser.add_argument("--gui", choices=("auto", "rqt", "window"), default="auto")
    parser.add_argument("--reopen", type=_bool, default=False, metavar="true|false",
                        help="reopen the window also after it was closed")
    parser.add_argument("--perspective", metavar="FILE", help="layout of the panels in rqt")
    arguments, rest = parser.parse_known_args(sys.argv[1:])
    has_rqt = all(importlib.util.find_spec(name) is not None for name in RQT_MODULES)
    choice = choose(arguments.gui, display.has_display(), has_rqt)
    if choice.text:
        _say(choice.text)
    if choice.command is None:
        sys.exit(choice.code)
    layout = ["--perspective-file", arguments.perspective] if choice.command is RQT and arguments.perspective else []
    sys.exit(Keeper(choice.command + layout + rest, arguments.reopen).run())


def _bool(text: str) -> bool:
    if text.lower() not in ("true", "1", "false", "0"):
        raise argparse.ArgumentTypeError(f"{text!r} is not true or false")
    return text.lower() in ("true", "1")


def _say(text: str) -> None:
    print(f"[roah_rsbb_gui] {text}", file=sys.stderr, flush=True)
