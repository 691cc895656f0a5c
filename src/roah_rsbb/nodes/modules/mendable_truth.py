"""Ground truth from tf2, whose file may be mended while modules use it."""

from typing import List, Optional, Sequence, Tuple

from roah_rsbb.bmbox.framework import ground_truth_config
from roah_rsbb.bmbox.framework.ground_truth import GroundTruth, NoPose, Pose3
from roah_rsbb.nodes.modules.ground_truth_tf import TfGroundTruth
from roah_rsbb.nodes.modules.watched_file import WatchedFile


class MendableTruth(GroundTruth):
    """What modules are given. Made after `rospy.init_node`."""

    def __init__(self, path: str) -> None:
        self._file = WatchedFile(path, lambda: ground_truth_config.load(path))
        self._tf: Optional[TfGroundTruth] = None
        self._use()

    def look(self) -> None:
        """Go by the file as it is now."""
        if self._file.look():
            self._use()

    def pose(self, frame: str, at_utc: Optional[float] = None) -> Pose3:
        """See GroundTruth.pose."""
        return self.of_team("").pose(frame, at_utc)

    def for_team(self, team: str) -> GroundTruth:
        """See GroundTruth.for_team."""
        return _OfTeam(self, team)

    def of_team(self, team: str) -> GroundTruth:
        """The ground truth by the file as it is now; raises NoPose."""
        self.look()
        if self._file.problems or self._tf is None:
            raise NoPose("; ".join(self._file.problems))
        return self._tf.for_team(team)

    def check(self, subjects: Sequence[str]) -> Tuple[List[str], List[str]]:
        """What keeps a benchmark from these subjects' poses: problems and warnings, see TfGroundTruth.check."""
        if not subjects:
            return [], []
        self.look()
        if self._file.problems or self._tf is None:
            return self._file.problems, []
        return self._tf.check(subjects)

    def _use(self) -> None:
        if self._file.problems:
            return
        if self._tf is None:
            self._tf = TfGroundTruth(self._file.content())
        else:
            self._tf.use(self._file.content())


class _OfTeam(GroundTruth):
    def __init__(self, truth: MendableTruth, team: str) -> None:
        self._truth = truth
        self._team = team

    def pose(self, frame: str, at_utc: Optional[float] = None) -> Pose3:
        return self._truth.of_team(self._team).pose(frame, at_utc)
