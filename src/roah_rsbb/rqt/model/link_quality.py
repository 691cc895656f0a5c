"""The quality of a robot's link: its longest recent silence.

The core publishes since when a robot is silent, once it missed a message; a robot sends each second (docs/protocol.md,
"Timing"). So the longest silence shows how many of its messages were lost in a row.
"""

import collections
from typing import Deque, Dict, Hashable, NamedTuple, Optional

from roah_rsbb.wording.language import tr, tr_later

# Older silences are ignored, seconds.
WINDOW_S = 10.0
# Between two looks; after a longer time, nothing is known, seconds.
MISSED_S = 1.0


class _Level(NamedTuple):
    up_to_s: float
    text: str


# A robot sends each second; after 3 s without a message the core warns.
LEVELS = (_Level(1.6, tr_later("▮▮▮ good")), _Level(3.0, tr_later("▮▮▯ gaps")), _Level(10.0, tr_later("▮▯▯ poor")))
SILENT = tr_later("▯▯▯ silent")


class _Robot:
    def __init__(self) -> None:
        self.since: Optional[float] = None
        self.gaps: Deque[tuple] = collections.deque()  # (when it ended, how long it was)


class LinkQuality:
    """Watches all robots. Times are moments of the box's clock, in seconds."""

    def __init__(self) -> None:
        self._robots: Dict[Hashable, _Robot] = {}
        self._mono: Optional[float] = None

    def observe(self, mono: float, silent: Dict[Hashable, Optional[float]]) -> None:
        """Record since when each robot is silent, at the moment `mono`; None: it is not. Robots that are missing are
        forgotten."""
        if self._mono is None or not 0.0 <= mono - self._mono <= MISSED_S:
            self._robots.clear()
        self._mono = mono
        self._robots = {name: self._robots.get(name) or _Robot() for name in silent}
        for name, robot in self._robots.items():
            if robot.since is not None and silent[name] != robot.since:
                robot.gaps.append((mono, (mono if silent[name] is None else silent[name]) - robot.since))
            robot.since = silent[name]
            while robot.gaps and mono - robot.gaps[0][0] > WINDOW_S:
                robot.gaps.popleft()

    def longest_silence_s(self, name: Hashable) -> Optional[float]:
        """Return the longest silence that ended within the window or still lasts, 0.0 if there was none; None: unknown
        robot."""
        robot = self._robots.get(name)
        if robot is None:
            return None
        return max([0.0 if robot.since is None else self._mono - robot.since, *(length for _, length in robot.gaps)])


def text(longest_silence_s: Optional[float]) -> str:
    """Return it as bars and a word, with the number if something is wrong."""
    if longest_silence_s is None:
        return ""
    for number, level in enumerate(LEVELS):
        if longest_silence_s <= level.up_to_s:
            return f"{tr(level.text)}, {longest_silence_s:.1f} s" if number else tr(level.text)
    return tr(SILENT)
