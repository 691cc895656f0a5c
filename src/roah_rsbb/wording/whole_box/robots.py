"""The robots that the box hears, and the quality of their links: the longest recent silence.

The core publishes since when a robot is silent, once it missed a message; a robot sends each second (docs/protocol.md,
"Timing"). So the longest silence shows how many of its messages were lost in a row.
"""

import collections
import math
from typing import Deque, Dict, Hashable, List, NamedTuple, Optional, Tuple

from roah_rsbb.model.document import Document
from roah_rsbb.wording import times
from roah_rsbb.wording.language import number, tr, tr_later

COLUMNS = (
    tr_later("Team"), tr_later("Robot"), tr_later("Link"), tr_later("Clock skew"), tr_later("Run in zone"),
    tr_later("Last heard"),
)
LINK, SKEW = 2, 3  # columns that are explained
NO_RUN = "–"

# Older silences are ignored, seconds.
WINDOW_S = 10.0
# Between two looks, of which pages without readers have one a second; after a longer time, nothing is known, seconds.
MISSED_S = 2.5


class _Level(NamedTuple):
    up_to_s: float
    text: str


# A robot sends each second; after 3 s without a message the core warns.
LEVELS = (_Level(1.6, tr_later("▮▮▮ good")), _Level(3.0, tr_later("▮▮▯ gaps")), _Level(10.0, tr_later("▮▯▯ poor")))
SILENT = tr_later("▯▯▯ silent")


class _Robot:
    def __init__(self) -> None:
        self.since: Optional[float] = None
        self.gaps: Deque[Tuple[float, float]] = collections.deque()  # (when it ended, how long it was)


class LinkQuality:
    """Watches all robots. Times: seconds of the box's clock. Let it look each second, and when the document changes."""

    def __init__(self) -> None:
        self._robots: Dict[Hashable, _Robot] = {}
        self._mono = -math.inf

    def look(self, document: Document, mono: float) -> None:
        """Look at the robots of a document at the moment `mono`."""
        self.observe(mono, {name: robot.silent_since for name, robot in document.robots.items()})

    def observe(self, mono: float, silent: Dict[Hashable, Optional[float]]) -> None:
        """Record since when each robot is silent, at the moment `mono`; None: it is not. Robots that are missing are
        forgotten."""
        if not 0.0 <= mono - self._mono <= MISSED_S:
            self._robots.clear()
        self._mono = mono
        self._robots = {name: self._robots.get(name) or _Robot() for name in silent}
        for name, robot in self._robots.items():
            since = silent[name]
            if robot.since is not None and since != robot.since:
                robot.gaps.append((mono, (mono if since is None else since) - robot.since))
            robot.since = since
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
    for level in LEVELS:
        if longest_silence_s <= level.up_to_s:
            silence = number(f"{longest_silence_s:.1f} s")
            return tr(level.text) if level is LEVELS[0] else f"{tr(level.text)}, {silence}"
    return tr(SILENT)


def explanations() -> Dict[int, str]:
    """Return what some columns mean, by their index."""
    return {
        LINK: tr("Longest silence of the robot in the last {time:.0f} s. It sends every second.", time=WINDOW_S),
        SKEW: tr("The robot's clock minus the box's: + is ahead, - is behind"),
    }


def rows(document: Document, mono: float, links: LinkQuality) -> List[Tuple[str, ...]]:
    """Return the texts of all columns for each robot, in alphabetical order, at the moment `mono`."""
    return [(
        robot.team, robot.robot, text(links.longest_silence_s(name)), times.skew(robot.skew),
        document.zone_of(name) or NO_RUN,
        times.ago(0.0 if robot.silent_since is None else mono - robot.silent_since),
    ) for name, robot in sorted(document.robots.items(), key=lambda item: item[1][:2])]
