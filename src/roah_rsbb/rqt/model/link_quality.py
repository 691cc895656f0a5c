"""The quality of a robot's link: its longest recent silence.

The core publishes when it last heard a robot, ten times a second; a robot sends each second (docs/protocol.md,
"Timing"). So the longest silence shows how many of its messages were lost in a row.
"""

import collections
from typing import Deque, Dict, Hashable, NamedTuple, Optional

from roah_rsbb.wording.language import tr, tr_later

# Older silences are ignored, seconds.
WINDOW_S = 10.0
# A gap between two messages of the core that is longer than this says nothing about robots, seconds.
MISSED_S = 1.0


class _Level(NamedTuple):
    up_to_s: float
    text: str


# A robot sends each second; after 3 s without a message the core warns.
LEVELS = (_Level(1.6, tr_later("▮▮▮ good")), _Level(3.0, tr_later("▮▮▯ gaps")), _Level(10.0, tr_later("▮▯▯ poor")))
SILENT = tr_later("▯▯▯ silent")


class _Robot:
    def __init__(self, heard_s: float) -> None:
        self.heard_s = heard_s
        self.gaps: Deque[tuple] = collections.deque()  # (when it ended, how long it was)


class LinkQuality:
    """Watches all robots. Times are seconds of the box's clock."""

    def __init__(self) -> None:
        self._robots: Dict[Hashable, _Robot] = {}
        self._clock_s: Optional[float] = None

    def observe(self, clock_s: float, heard_s: Dict[Hashable, float]) -> None:
        """Record when each robot was last heard, as of `clock_s`. Robots that are missing are forgotten."""
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
        """Return the longest silence that ended within the window or still lasts; None: unknown robot."""
        robot = self._robots.get(name)
        if robot is None:
            return None
        return max([self._clock_s - robot.heard_s, *(length for _, length in robot.gaps)])


def text(longest_silence_s: Optional[float]) -> str:
    """Return it as bars and a word, with the number if something is wrong."""
    if longest_silence_s is None:
        return ""
    for number, level in enumerate(LEVELS):
        if longest_silence_s <= level.up_to_s:
            return f"{tr(level.text)}, {longest_silence_s:.1f} s" if number else tr(level.text)
    return tr(SILENT)
