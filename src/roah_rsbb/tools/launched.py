"""Ends a roslaunch that was started in a session of its own."""

import contextlib
import os
import signal
import subprocess


def end(launch: subprocess.Popen, limit_s: float) -> None:
    """Ask roslaunch to end its nodes, as Ctrl-C does, and wait. After `limit_s` seconds, kill it and its nodes."""
    with contextlib.suppress(ProcessLookupError):
        launch.send_signal(signal.SIGINT)
    try:
        launch.wait(limit_s)
    except subprocess.TimeoutExpired:
        os.killpg(launch.pid, signal.SIGKILL)
        launch.wait()
