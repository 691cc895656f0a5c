"""Measures STOP and START beside a disk that hangs, as for a snapshot. Needs root: it mounts a disk."""

import contextlib
import os
import random
import subprocess
import time
from typing import Dict, Iterator
from unittest import mock

from fleet import Fleet
from processes import Measured, wait
from reaction import PAUSE_S
from table import Results
from without_ros import BoxWithoutRos

from roah_rsbb.protocol import BoxState, RobotState

# Longer than a core may hang.
LONG_S = 6.0


class BoxOnADisk(BoxWithoutRos):
    """A box with a disk of its own for log_dir and HOME, as on a laptop. Use it as a context manager."""

    def _started(self, profile: str, settings: Dict[str, object]) -> Measured:
        disk = self._folder / "disk"
        self.log_dir.mkdir()
        for command in (["truncate", "-s", "64M", disk], ["mkfs.ext4", "-q", disk],
                        ["mount", "-o", "loop", disk, self.log_dir]):
            subprocess.run(list(map(str, command)), check=True)
        with mock.patch.dict(os.environ, HOME=str(self.log_dir)):
            return super()._started(profile, settings)

    def __exit__(self, *error: object) -> None:
        self.process.close()
        subprocess.run(["umount", "-l", str(self.log_dir)], check=True)
        super().__exit__(*error)

    @contextlib.contextmanager
    def frozen(self) -> Iterator[None]:
        """The disk takes no writes."""
        subprocess.run(["fsfreeze", "-f", str(self.log_dir)], check=True)
        try:
            yield
        finally:
            subprocess.run(["fsfreeze", "-u", str(self.log_dir)], check=True)

    def stop(self, zone: int) -> None:
        """A referee's STOP through the door."""
        self._client.stop(f"zone {zone}", "").result()


def measure(results: Results, box: BoxOnADisk, fleet: Fleet, rounds: int) -> None:
    """Stop all runs, each while the disk has been standing still for a moment; `rounds` times."""
    dice, taken = random.Random(8), []  # type: random.Random, List[float]
    for _ in range(rounds):
        for zone, robot in enumerate(fleet.robots):
            with box.frozen():
                time.sleep(dice.uniform(*PAUSE_S))
                taken.append(fleet.ask(lambda z=zone: box.stop(z), robot, BoxState.STOP))
            wait(lambda r=robot: r.state is RobotState.STOP, "the robot stops")
            box.command_when_allowed("start", zone)
            wait(lambda r=robot: r.box_state is BoxState.WAITING_RESULT, "the robot executes")
    results.add_spread("STOP beside a disk that hangs", "ms", taken, {0.99: 50})
    before = box.process.ended_mono
    with box.frozen():
        time.sleep(LONG_S)
        last = fleet.ask(lambda: box.stop(0), fleet.robots[0], BoxState.STOP)
    results.add(f"STOP beside a disk that has hung for {LONG_S:g} s", "ms", last, 50)
    if before is not None or box.process.ended_mono is not None:
        raise SystemExit(f"bench: the box ended:\n{box.process.text[-2000:]}")
