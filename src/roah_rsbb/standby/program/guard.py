"""Ends what the standby prepared, when the program that keeps the copy is gone: nobody could take over with it.

After the takeover it is the box, and continues whatever happens to that program.
"""

import os
import signal
import subprocess
import sys
import time
from typing import List, Optional, Sequence

from roah_rsbb.ground.arguments import is_without_ros, without_ros
from roah_rsbb.standby.pairing import is_standby

GUARD = "guard"  # of `roah-rsbb`; not for users
LOOK_S = 0.5


def guarded(folder: str, command: Sequence[str]) -> List[str]:
    """Return the command that runs a command under a guard. `folder`: of the standby."""
    start = without_ros(GUARD) if is_without_ros() else [sys.executable, "-m", "roah_rsbb.standby.program.guard"]
    return [*start, folder, str(os.getpid()), *command]


def main(arguments: Optional[Sequence[str]] = None) -> None:
    """Run a command to its end, and end with its exit status. `arguments`: those of `guarded` after its start."""
    folder, keeper, *command = sys.argv[1:] if arguments is None else arguments
    process = subprocess.Popen(command)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: process.send_signal(signal.SIGINT))
    is_asked = False
    while process.poll() is None:
        if os.getppid() != int(keeper) and not is_asked and is_standby(folder):
            process.send_signal(signal.SIGINT)
            is_asked = True
        time.sleep(LOOK_S)
    sys.exit(process.returncode)


if __name__ == "__main__":
    main()
