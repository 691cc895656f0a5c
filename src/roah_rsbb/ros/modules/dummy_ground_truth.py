"""Node roah_rsbb_dummy_ground_truth: simulates a motion-capture system, for the dummy set-up.

Publishes each marker of the ground truth's configuration to /tf, with the poses of `DummyWorld`. A zone with its own
ground_truth.yaml, in its folder beside the given file, is a test bed of its own. Parameters (private):
ground_truth_file; rate (Hz); seed; to misbehave: lose (invisible subjects, such as "person robot"), lose_every and
lose_for (seconds: they are only invisible during the first lose_for of each lose_every seconds; lose_every 0: always).
"""

import contextlib
import math
import os
import threading
from typing import FrozenSet, List, Tuple

import rospkg
import rospy
import tf2_ros
from geometry_msgs.msg import Quaternion, TransformStamped, Vector3

from roah_rsbb.bmbox.framework.ground_truth import rotation
from roah_rsbb.bmbox.framework.rule_files import own_file, zone_folders
from roah_rsbb.bmbox.host.dummy_world import DummyWorld, SeenMarker, seen_markers
from roah_rsbb.bmbox.host.ground_truth_of_frames import FILE_NAME, load
from roah_rsbb.ground.params import BadParams
from roah_rsbb.model.modules import RunForModule
from roah_rsbb.msg import ModuleRuns
from roah_rsbb.ros.modules.convert import runs_of
from roah_rsbb.ros.node import NodeParams, run_node
from roah_rsbb.rulebook.errors import ConfigErrors

NOTHING = "nothing"
# The zones without their own file.
ALL_OTHERS = ""


def default_file() -> str:
    """The path of the default configuration."""
    return os.path.join(rospkg.RosPack().get_path("roah_rsbb"), "config", "modules", FILE_NAME)


class _Losses:
    """Which subjects are invisible, and when."""

    def __init__(self, subjects: FrozenSet[str], every_s: float, for_s: float) -> None:
        self._subjects, self._every_s, self._for_s = subjects, every_s, for_s

    def now(self, since_start_s: float) -> FrozenSet[str]:
        if self._every_s and math.fmod(since_start_s, self._every_s) >= self._for_s:
            return frozenset()
        return self._subjects


class DummyGroundTruthNode:
    """The node. Raises `BadParams` or `ConfigErrors` at the start."""

    def __init__(self) -> None:
        params = NodeParams()
        path = params.path("ground_truth_file", default_file())
        rate = params.number("rate", 20.0, lowest=1.0, highest=200.0)
        seed = params.whole("seed", 0, 0, 2**31 - 1)
        every_s = params.number("lose_every", 0.0)
        for_s = params.number("lose_for", 5.0)
        lost = frozenset(params.text("lose", NOTHING).split()) - {NOTHING}
        params.done()
        folder, name = os.path.split(path)
        zones = [zone for zone in zone_folders(folder) if os.path.lexists(own_file(folder, zone, name))]
        configs = {zone: load(own_file(folder, zone, name)) for zone in zones}
        configs[ALL_OTHERS] = load(path)
        known = list(dict.fromkeys(subject for config in configs.values() for subject in config.markers))
        unknown = sorted(lost - set(known))
        if unknown:
            raise BadParams(f"parameter {rospy.resolve_name('~lose')}: found {', '.join(unknown)}, expected some of "
                            + ", ".join(known))
        self._test_beds = {zone: (config, DummyWorld(seed)) for zone, config in configs.items()}
        self._losses = _Losses(lost, every_s, for_s)
        self._rate = rospy.Rate(rate)
        self._runs: Tuple[RunForModule, ...] = ()
        self._lock = threading.Lock()
        self._broadcaster = tf2_ros.TransformBroadcaster()
        rospy.Subscriber("/core/module_runs", ModuleRuns, self._on_runs, queue_size=1)

    def _on_runs(self, message: ModuleRuns) -> None:
        runs = runs_of(message)
        with self._lock:
            self._runs = runs

    def run(self) -> None:
        """Publish until the node is shut down."""
        start_s = rospy.get_time()
        while not rospy.is_shutdown():
            now = rospy.Time.now()
            self._publish(now, self._losses.now(now.to_sec() - start_s))
            with contextlib.suppress(rospy.ROSInterruptException):
                self._rate.sleep()

    def _publish(self, now: rospy.Time, lost: FrozenSet[str]) -> None:
        with self._lock:
            runs = self._runs
        transforms: List[TransformStamped] = []
        for zone, (config, world) in self._test_beds.items():
            here = [run for run in runs if (run.zone if run.zone in self._test_beds else ALL_OTHERS) == zone]
            world.step(now.to_sec(), here)
            transforms += [self._transform(now, config.reference_frame, seen)
                           for seen in seen_markers(config, world, here) if seen.subject not in lost]
        self._broadcaster.sendTransform(transforms)

    @staticmethod
    def _transform(now: rospy.Time, reference_frame: str, seen: SeenMarker) -> TransformStamped:
        message = TransformStamped()
        message.header.stamp = now
        message.header.frame_id = reference_frame
        message.child_frame_id = seen.frame
        message.transform.translation = Vector3(*seen.pose[:3])
        message.transform.rotation = Quaternion(*rotation(seen.pose.theta))
        return message


def main() -> None:
    """Entry point of the node."""
    run_node("roah_rsbb_dummy_ground_truth", __doc__, DummyGroundTruthNode, (BadParams, ConfigErrors))
