"""The frames of tf2, which a motion-capture system publishes, as `Frames`. `TfFrames` may be used from any thread.

As a program, it is the process with the benchmarking modules of a box with ROS: as without
(`box/program/modules_process.py`), but its ground truth comes from tf. For that it is the node roah_rsbb_modules, as
soon as the ROS master answers.
"""

import bisect
import collections
import os
import signal
import sys
import threading
import time
from typing import Any, Deque, Dict, Iterable, List, Optional, Tuple

import rospy
import tf2_ros
from tf2_msgs.msg import TFMessage

from roah_rsbb.bmbox.framework.ground_truth import Pose3, yaw
from roah_rsbb.bmbox.host.ground_truth_of_frames import (
    FILE_NAME,
    KEPT_S,
    Frames,
    GroundTruthConfig,
    NotAtOnce,
    NoTransform,
)
from roah_rsbb.box.program import modules_process
from roah_rsbb.ros import connections
from roah_rsbb.ros.messages import ros_time

# Number of remembered times of publication per frame; at 200 Hz as long as tf2 keeps frames.
_STAMPS_KEPT = 2000
# The time of static frames, and a request for the latest pose.
_STATIC = rospy.Time()
NAME = "roah_rsbb_modules"


class _Stamps:
    """Times at which frames were published, because tf2 interpolates across gaps without notice."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._by_frame: Dict[str, Deque[float]] = {}

    def watch(self, frames: Iterable[str]) -> None:
        """Record these frames from now on."""
        with self._lock:
            old = self._by_frame
            self._by_frame = {frame: old.get(frame, collections.deque(maxlen=_STAMPS_KEPT)) for frame in frames}

    def on_tf(self, message: TFMessage) -> None:
        """Record the times in a message of /tf."""
        with self._lock:
            for transform in message.transforms:
                # Like tf2, ignore a leading '/', which early versions of ROS had.
                stamps = self._by_frame.get(transform.child_frame_id.lstrip("/"))
                if stamps is not None:
                    stamps.append(transform.header.stamp.to_sec())

    def gap(self, frame: str, at_utc: float) -> Optional[float]:
        """Seconds between a time and the nearest publication of the frame; None if it was never published."""
        with self._lock:
            stamps = sorted(self._by_frame.get(frame, ()))
        if not stamps:
            return None
        after = bisect.bisect_left(stamps, at_utc)
        return min(abs(stamp - at_utc) for stamp in stamps[max(after - 1, 0) : after + 1])


class TfFrames(Frames):
    """The frames of tf. Before `rospy.init_node`, it sees none."""

    REMEDY_REFERENCE = (
        f"start the motion-capture system, check that it publishes ('rostopic hz /tf'), and check the name in "
        f"{FILE_NAME}")
    REMEDY_MARKER = f"put the marker into the cameras' view, or check the name in {FILE_NAME} ('rosrun tf tf_monitor')"

    def __init__(self) -> None:
        self._buffer = tf2_ros.Buffer(rospy.Duration.from_sec(KEPT_S), debug=False)
        self._stamps = _Stamps()
        self._subscribers: List[Any] = []
        self._listen()

    def _listen(self) -> None:
        if not self._subscribers and rospy.rostime.is_rostime_initialized():
            self._subscribers = [tf2_ros.TransformListener(self._buffer),
                                 rospy.Subscriber("/tf", TFMessage, self._stamps.on_tf)]

    def use(self, config: GroundTruthConfig) -> None:
        """See `Frames`."""
        self._stamps.watch(marker.frame for _, _, marker in config.all_markers())

    def close(self) -> None:
        """See `Frames`."""
        for subscriber in self._subscribers:
            subscriber.unregister()

    def now_utc(self) -> float:
        """See `Frames`."""
        return rospy.get_time() if rospy.rostime.is_rostime_initialized() else time.time()

    def sees(self, frame: str) -> bool:
        """See `Frames`."""
        self._listen()
        # As in tf.TransformListener.frameExists; can_transform(frame, frame) is true for any name.
        return self._buffer._frameExists(frame)

    def gap(self, frame: str, at_utc: float) -> Optional[float]:
        """See `Frames`."""
        return self._stamps.gap(frame, at_utc)

    def lookup(self, reference: str, frame: str, at_utc: Optional[float]) -> Tuple[Pose3, Optional[float]]:
        """See `Frames`."""
        try:
            found = self._buffer.lookup_transform(reference, frame, _STATIC if at_utc is None else ros_time(at_utc))
        except tf2_ros.ExtrapolationException as error:
            raise NotAtOnce(str(error)) from None
        except tf2_ros.TransformException as error:
            raise NoTransform(str(error)) from None
        place, turn, stamp = found.transform.translation, found.transform.rotation, found.header.stamp
        pose = Pose3(place.x, place.y, place.z, yaw((turn.x, turn.y, turn.z, turn.w)))
        return pose, None if stamp == _STATIC else stamp.to_sec()


def _join() -> None:
    connections.init_node(NAME, disable_signals=True)
    rospy.on_shutdown(lambda: os.kill(os.getpid(), signal.SIGTERM))  # the box starts the next one


def main() -> None:
    """Run the modules until the box ends this process."""
    threading.Thread(target=_join, name="ROS", daemon=True).start()
    modules_process.main(sys.argv[1:], TfFrames)


if __name__ == "__main__":
    main()
