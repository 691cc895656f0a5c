"""How well a robot is heard: how long it was silent at most, of late.

The core publishes when it last heard a robot, ten times a second; a robot sends each second (docs/protocol.md,
"Timing"). So the longest silence tells how many of its messages were lost in a row.
"""

import collections
from typing import Deque, Dict, Hashable, NamedTuple, Optional

# What is longer ago does not matter any more, seconds.
WINDOW_S = 10.0
# The core was not heard ourselves: what happened meanwhile is not known.
MISSED_S = 1.0


class _Level(NamedTuple):
    up_to_s: float
    text: str


# A robot sends each second; after 3 s without a message the core warns.
LEVELS = (_Level(1.6, "▮▮▮ good"), _Level(3.0, "▮▮▯ gaps"), _Level(10.0, "▮▯▯ poor"))
SILENT = "▯▯▯ silent"


class _Robot:
    def __init__(self, heard_s: float) -> None:
        self.heard_s = heard_s
        self.gaps: Deque[tuple] = collections.deque()  # (when it ended, how long it was)


class LinkQuality:
    """Watches all robots. Times are the box's clock, seconds."""

    def __init__(self) -> None:
        self._robots: Dict[Hashable, _Robot] = {}
        self._clock_s: Optional[float] = None

    def observe(self, clock_s: float, heard_s: Dict[Hashable, float]) -> None:
        """At `clock_s` the robots had last been heard at `heard_s`; a robot that is not there is forgotten."""
        if self._clock_s is None or not 0.0 <= clock_s - self._clock_s <= MISSED_S:
            self._robots.clear()
        self._clock_s = clock_s
        self._robots = {name: self._robots.get(name) or _Robot(heard) for name, heard in heard_s.items()}
        for name, robot in self._robots.items():
            if heard_s[name] != robot.heard_s:
                robot.gaps.append((clock_s, heard_s[name] - robot.heard_s))
                robot.heard_s = heard_s[name]
            while robot.gaps and clock_s - robot.gaps[0][0] > WINDOW_S:
                robot.gaps.popleft()

    def longest_silence_s(self, name: Hashable) -> Optional[float]:
        """The longest silence that ended within the window or still goes on; None: that robot is not known."""
        robot = self._robots.get(name)
        if robot is None:
            return None
        return max([self._clock_s - robot.heard_s, *(length for _, length in robot.gaps)])


def text(longest_silence_s: Optional[float]) -> str:
    """The same as bars and a word, with the number where something is wrong."""
    if longest_silence_s is None:
        return ""
    for number, level in enumerate(LEVELS):
        if longest_silence_s <= level.up_to_s:
            return f"{level.text}, {longest_silence_s:.1f} s" if number else level.text
    return SILENT
