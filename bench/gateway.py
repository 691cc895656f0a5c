"""Measures the gateway for browsers: from a change in the core to its readers, and what it costs gateway and core."""

import json
import os
import pathlib
import random
import socket
import subprocess
import sys
import time
from typing import List, NamedTuple, Optional

from addresses import BOX_HOST, BROADCAST
from processes import ROOT, Box, Measured, wait

VIEWERS = pathlib.Path(__file__).resolve().parent / "viewers.py"
SETTLE_S = 2.0
# Pauses between changes are random, so that they meet every moment of the core's 10 Hz tick.
LONGEST_PAUSE_S = 0.6


class Cost(NamedTuple):
    """What changes took and cost."""

    late_ms: List[float]  # of each reader and change
    core_percent: float
    gateway_percent: float


class Gateway:
    """The node roah_rsbb_web."""

    def __init__(self) -> None:
        with socket.socket() as free:
            free.bind((BOX_HOST, 0))
            self.port = free.getsockname()[1]
        self.process = Measured(
            sys.executable, str(ROOT / "scripts" / "roah_rsbb_web"), f"_rsbb_host:={BROADCAST}",
            f"_web_port:={self.port}", f"_log_dir:={os.environ['ROS_HOME']}/web")
        wait(self._answers, "the gateway answers")

    def close(self) -> None:
        """End the node."""
        self.process.close()

    def _answers(self) -> bool:
        try:
            socket.create_connection((BOX_HOST, self.port), 1.0).close()
        except OSError:
            return False
        return True


class Viewers:
    """A process with many readers."""

    def __init__(self, port: int, count: int) -> None:
        self._process = subprocess.Popen(
            [sys.executable, str(VIEWERS), str(port), str(count)], stdout=subprocess.PIPE, text=True)
        if self._process.stdout.readline() != "ready\n":
            raise SystemExit("bench: the readers could not connect to the gateway")

    def close(self) -> None:
        """End the process."""
        self._process.terminate()
        self._process.wait()

    def times(self) -> List[float]:
        """Wait until all readers got the next change; returns when (monotonic seconds)."""
        return json.loads(self._process.stdout.readline())


def change(box: Box, gateway: Optional[Gateway], viewers: Optional[Viewers], count: int) -> Cost:
    """Move a zone to its other event and back, `count` times."""
    time.sleep(SETTLE_S)
    dice, late_ms = random.Random(5), []
    began, core = time.monotonic(), box.process.cpu_s()
    served = gateway.process.cpu_s() if gateway else 0.0
    for number in range(count):
        at = time.monotonic()
        box.command("previous" if number % 2 else "next", 0)
        if viewers is not None:
            late_ms += [(when - at) * 1e3 for when in viewers.times()]
        time.sleep(max(0.0, at + dice.uniform(0.2, LONGEST_PAUSE_S) - time.monotonic()))
    seconds = time.monotonic() - began
    return Cost(late_ms, 100.0 * (box.process.cpu_s() - core) / seconds,
                100.0 * ((gateway.process.cpu_s() if gateway else 0.0) - served) / seconds)
