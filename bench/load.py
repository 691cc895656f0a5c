"""Measures the box under the load of many robots: resources, losses and late answers."""

import time
from typing import Dict, List, NamedTuple

import rospy
from fleet import REGULAR_S, Fleet
from processes import Box
from table import quantile

from roah_rsbb.protocol import BoxState

PERIOD_S = 0.05  # robots at the highest rate of the protocol
ORIGINAL_PERIOD_S = 0.2  # rate of the original box and robots
SETTLE_S = 2.5
WARM_S = 0.5  # time until all robots send evenly


class Load(NamedTuple):
    """Measurements of a box over some time."""

    datagrams_s: float
    cpu_percent: float
    memory_mb: float
    lost: int  # dropped by the kernel because the box did not read them, or never answered
    late: int
    answers: int
    waited_percent: float  # share of the time waiting for a processor that other processes used
    unsent: int  # datagrams that the bench could not send
    message_kb: float  # /core/to_gui, the largest one
    jitter_ms: List[float]  # deviation of each interval between two /core/to_gui from 100 ms
    grown_mb: float


class Pace:
    """Follows /core/to_gui and reads only the clock of each message: sizes and times."""

    def __init__(self) -> None:
        self.sizes: List[int] = []
        self.clocks: List[float] = []
        self._subscriber = rospy.Subscriber("/core/to_gui", rospy.AnyMsg, self._take, buff_size=4 * 1024 * 1024)

    def _take(self, message: rospy.AnyMsg) -> None:
        clock = rospy.Time(int.from_bytes(message._buff[:4], "little"), int.from_bytes(message._buff[4:8], "little"))
        self.sizes.append(len(message._buff))
        self.clocks.append(clock.to_sec())

    def close(self) -> None:
        self._subscriber.unregister()

    @property
    def rate(self) -> float:
        """Messages a second."""
        spans = len(self.clocks) - 1
        return spans / (self.clocks[-1] - self.clocks[0]) if spans > 0 else 0.0

    @property
    def jitter_ms(self) -> List[float]:
        return [abs(b - a - 0.1) * 1e3 for a, b in zip(self.clocks, self.clocks[1:])]


def measure(box: Box, fleet: Fleet, seconds: float, period_s: float = PERIOD_S) -> Load:
    """Measure while all robots in runs send for this time."""
    fleet.keep_sending(period_s)
    time.sleep(WARM_S)
    pace, memory, before = Pace(), box.process.memory_mb(), _counts(fleet)
    dropped, waited, began = box.dropped(), box.process.waited_s(), time.monotonic()
    cpu = box.process.cpu_percent(seconds)
    after = _counts(fleet)
    took = time.monotonic() - began
    waited = 100.0 * (box.process.waited_s() - waited) / took
    pace.close()
    memory_after = box.process.memory_mb()
    fleet.keep_sending(REGULAR_S)
    return Load(
        (after["sent"] - before["sent"]) / took, cpu, memory_after,
        box.dropped() - dropped + _unanswered(fleet), after["late"] - before["late"],
        after["answers"] - before["answers"], waited, after["unsent"] - before["unsent"],
        max(pace.sizes, default=0) / 1e3, pace.jitter_ms, memory_after - memory,
    )


def _counts(fleet: Fleet) -> Dict[str, int]:
    names = ("sent", "late", "answers", "unsent")
    return {name: sum(getattr(robot, name) for robot in fleet.robots) for name in names}


def _unanswered(fleet: Fleet) -> int:
    """Robots whose last datagram is never acknowledged. The box acknowledges once a second."""
    last = [(robot, robot.sent_ns[-1]) for robot in fleet.robots if robot.port is not None]
    until = time.monotonic() + SETTLE_S
    while time.monotonic() < until:
        missing = sum(robot.acknowledged_ns < sent_ns for robot, sent_ns in last)
        if not missing:
            return 0
        time.sleep(0.05)
    return missing


def still_executing(fleet: Fleet) -> bool:
    """Check that all runs are still active. Otherwise the measurement is invalid."""
    return all(robot.box_state is BoxState.WAITING_RESULT for robot in fleet.robots if robot.port is not None)


def add(results, name: str, load: Load, cpu_target=None, memory_target=None) -> None:
    """Add the measurements of a load to the results."""
    results.add(f"{name}: datagrams a second", "1/s", load.datagrams_s)
    results.add(f"{name}: CPU", "% of a core", load.cpu_percent, cpu_target)
    results.add(f"{name}: memory", "MB", load.memory_mb, memory_target)
    results.add(f"{name}: lost in the box", "datagrams", load.lost, 0)
    results.add(f"{name}: answers later than 50 ms", "% of answers", 100.0 * load.late / max(1, load.answers))
    results.add(f"{name}: /core/to_gui", "kB", load.message_kb)
    results.add(f"{name}: waited for a core that others used", "% of the time", load.waited_percent)
    results.add(f"{name}: jitter of the 10 Hz tick, 99 %", "ms", quantile(load.jitter_ms, 0.99))
    if load.unsent:
        results.add(f"{name}: not sent by the bench itself", "datagrams", load.unsent, 0)
