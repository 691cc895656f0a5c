"""The frames of a simulated motion-capture system, for set-ups without a real one.

`seen_markers` is what it sees in a `DummyWorld`. The node of the dummy set-up publishes that to tf. `DummyFrames` gives
it to modules in the same process.
"""

import collections
import time
from typing import Callable, Deque, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.bmbox.framework.dummy_world import DummyWorld
from roah_rsbb.bmbox.framework.ground_truth import Pose3, Source, compose, inverse
from roah_rsbb.bmbox.framework.ground_truth_config import GroundTruthConfig, Marker
from roah_rsbb.bmbox.host.ground_truth_of_frames import KEPT_S, Frames, NoTransform
from roah_rsbb.model.modules import RunForModule

# Interval of the simulated measurements: the robot moves 6 cm in it.
STEP_S = 0.02


class SeenMarker(NamedTuple):
    """A marker that the system sees."""

    subject: str
    frame: str
    pose: Pose3  # of the marker itself, in the reference frame


def seen_markers(config: GroundTruthConfig, world: DummyWorld, runs: Sequence[RunForModule]) -> List[SeenMarker]:
    """Return all markers in a world during these runs."""
    poses = world.poses()
    team = next((run.team for run in runs if run.running), "")
    return [SeenMarker(subject, marker.frame, compose(poses[subject], inverse(marker.transform)))
            for subject, marker in worn_markers(config, team) if subject in poses]


def worn_markers(config: GroundTruthConfig, team: str) -> Iterator[Tuple[str, Marker]]:
    """Return each frame once, with its subject. A frame that teams share belongs to the running team's robot.

    Without motion capture, nothing carries markers.
    """
    if config.source is not Source.MOTION_CAPTURE:
        return iter(())
    by_frame: Dict[str, Tuple[str, Marker]] = {}
    for owner, subject, marker in config.all_markers():
        if owner == team or marker.frame not in by_frame:
            by_frame[marker.frame] = (subject, marker)
    return iter(by_frame.values())


class DummyFrames(Frames):
    """What the system saw in the last seconds. The world catches up whenever it is asked, so it needs no timer."""

    REMEDY_MARKER = f"the simulated motion capture has {', '.join(DummyWorld().poses())} only"

    def __init__(self, seed: int = 0, utc: Callable[[], float] = time.time) -> None:
        self._world = DummyWorld(seed)
        self._utc = utc
        self._config: Optional[GroundTruthConfig] = None
        self._runs: Tuple[RunForModule, ...] = ()
        self._kept: Deque[Tuple[float, Dict[str, Pose3]]] = collections.deque()  # by time (UTC seconds), then by frame

    def use(self, config: GroundTruthConfig) -> None:
        """See `Frames`."""
        self._config = config
        self._step(self._utc())

    def take(self, runs: Sequence[RunForModule]) -> None:
        """See `Frames`."""
        self._catch_up()
        self._runs = tuple(runs)
        # A module may measure at once what the referee has moved.
        self._step(self._utc())

    def now_utc(self) -> float:
        """See `Frames`."""
        return self._utc()

    def sees(self, frame: str) -> bool:
        """See `Frames`."""
        self._catch_up()
        return frame == self._config.reference_frame or frame in self._kept[-1][1]

    def gap(self, frame: str, at_utc: float) -> Optional[float]:
        """See `Frames`."""
        self._catch_up()
        return min((abs(utc - at_utc) for utc, poses in self._kept if frame in poses), default=None)

    def lookup(self, reference: str, frame: str, at_utc: Optional[float]) -> Tuple[Pose3, Optional[float]]:
        """See `Frames`."""
        self._catch_up()
        when = self._utc() if at_utc is None else at_utc
        found = min(((utc, poses) for utc, poses in self._kept if frame in poses),
                    key=lambda seen: abs(seen[0] - when), default=None)
        if found is None:
            raise NoTransform(f"nothing carries '{frame}'")
        return found[1][frame], found[0]

    def _catch_up(self) -> None:
        """Simulate what happened since the last call. After a longer time than is kept, or if the clock was set back,
        the world continues from now."""
        last, now = self._kept[-1][0], self._utc()
        if not last <= now <= last + KEPT_S:
            self._kept.clear()
            last = now - STEP_S
        while last < now:
            last = min(last + STEP_S, now)
            self._step(last)

    def _step(self, utc: float) -> None:
        self._world.step(utc, self._runs)
        seen = seen_markers(self._config, self._world, self._runs)
        while self._kept and self._kept[-1][0] >= utc:  # the same time with other runs, or the clock was set back
            self._kept.pop()
        self._kept.append((utc, {marker.frame: marker.pose for marker in seen}))
        while self._kept[0][0] < utc - KEPT_S:
            self._kept.popleft()
