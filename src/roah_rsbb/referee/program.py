"""The referee in a terminal: `rosrun roah_rsbb referee`, over ssh and in scripts.

It shows what the core publishes and gives the core's commands, as the panels do. The core decides what is allowed. The
exit status shows the result.
"""

import os
import signal
import sys

from roah_rsbb.referee.args import parser
from roah_rsbb.referee.exits import Exit


def _interrupt(_number: int, _frame: object) -> None:
    raise KeyboardInterrupt


def _hang_up(_number: int, _frame: object) -> None:
    """Leave the run connected when the terminal is closed, so that another referee can take it over."""
    raise SystemExit(128 + signal.SIGHUP)


def main() -> None:
    """Entry point of `rosrun roah_rsbb referee`."""
    top = parser()
    options = top.parse_args([word for word in sys.argv[1:] if ":=" not in word])  # ROS takes name:=value for itself
    if options.command is None:
        top.print_help(sys.stderr)
        sys.exit(int(Exit.USAGE))
    signal.signal(signal.SIGTERM, _interrupt)
    if signal.getsignal(signal.SIGHUP) is signal.SIG_DFL:  # not under nohup
        signal.signal(signal.SIGHUP, _hang_up)
    try:
        # Imported late: rospy and the messages take most of the time to start, and help or a wrong option need none.
        from roah_rsbb.referee.commands import carry_out
        from roah_rsbb.referee.output import Output

        status = int(carry_out(options, Output(options.json)))
    except KeyboardInterrupt:
        status = int(Exit.INTERRUPTED)
    except SystemExit as hung_up:
        status = hung_up.code
    sys.stdout.flush()
    # Threads that still wait for a silent master or core would delay the end.
    os._exit(status)
