"""The referee in a terminal: `rosrun roah_rsbb referee` or `roah-rsbb referee`, over ssh and in scripts.

Like the panels, it shows what the core publishes and sends commands to the core. The core decides what is allowed. The
exit status shows the result.
"""

import contextlib
import os
import signal
import sys
import time
from typing import TYPE_CHECKING, List, Optional

# All else is imported later: before, a STOP leaves.
from roah_rsbb.ground.arguments import is_without_ros
from roah_rsbb.referee.at_once import EarlyStop, Exit, send_stop

if TYPE_CHECKING:
    import argparse

ONE_WISH_S = 0.5  # between two signals


class Interrupts:
    """Handles Ctrl-C and SIGTERM. Signals that come together are one wish: `timeout` and terminals send each to the
    process and to its group."""

    def __init__(self) -> None:
        self._last_mono = float("-inf")

    def __call__(self, _number: int, _frame: object) -> None:
        now_mono = time.monotonic()
        is_another, self._last_mono = now_mono - self._last_mono >= ONE_WISH_S, now_mono
        if is_another:
            raise KeyboardInterrupt


def _hang_up(number: int, _frame: object) -> None:
    """Leave the run connected when the terminal is closed, so that another referee can take it over."""
    raise SystemExit(128 + number)


def options_of(words: List[str], sent: Optional[EarlyStop] = None) -> "argparse.Namespace":
    """Read a command line, of which a STOP may be `sent`. Raises SystemExit after help and for wrong options."""
    from roah_rsbb.referee.commands import parser

    top = parser()
    options = top.parse_args([word for word in words if ":=" not in word])  # ROS adds words such as __name:=x
    if options.command is None:
        top.print_help(sys.stderr)
        sys.exit(int(Exit.USAGE))
    options.sent = sent
    return options


def carry_out(options: "argparse.Namespace") -> int:
    """Carry out the command and return the exit status."""
    try:
        from roah_rsbb.referee import commands
        from roah_rsbb.referee.terminal import Output

        return int(commands.carry_out(options, Output(options.json, options.utc)))
    except KeyboardInterrupt:
        return int(Exit.INTERRUPTED)
    except SystemExit as hung_up:
        return hung_up.code


def _open_streams() -> None:
    """Open those that were closed before the start, as by `stop >&-`: a STOP must not fail because of them."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), mode, encoding="utf-8"))


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    _open_streams()
    words = sys.argv[1:] if arguments is None else arguments
    try:
        sent = send_stop(words, is_without_ros())
    except KeyboardInterrupt:
        sys.exit(int(Exit.NO_CORE))

    options = options_of(words, sent)
    interrupt = Interrupts()
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, interrupt)
    if signal.getsignal(signal.SIGHUP) is signal.SIG_DFL:  # not under nohup
        signal.signal(signal.SIGHUP, _hang_up)
    status = carry_out(options)
    for stream in (sys.stdout, sys.stderr):  # Python 3.8 buffers both, unless they are a terminal
        with contextlib.suppress(OSError):
            stream.flush()
    # A thread that is still resolving the name of a computer would delay the end.
    os._exit(status)
