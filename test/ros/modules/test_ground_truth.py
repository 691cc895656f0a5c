"""Ground truth from tf2, the check of it, and the dummy ground truth, over real topics."""

import contextlib
import math
import pathlib
import re
import tempfile
import unittest
from typing import Optional

import rospy
import tf2_ros
from geometry_msgs.msg import Quaternion, TransformStamped, Vector3
from support.programs import Program, own
from support.waiting import wait_until

from roah_rsbb.bmbox.framework.ground_truth import NoPose, Pose3, rotation
from roah_rsbb.bmbox.host.ground_truth_of_frames import FramesGroundTruth, GroundTruthConfig, Marker, load
from roah_rsbb.ros.modules.dummy_ground_truth import default_file
from roah_rsbb.ros.modules.tf_frames import TfFrames

# Frames of the test itself, which nobody else publishes.
WORLD = "test_world"
FLAT = rotation(0.0)
# Frames are as old as a test says; half a second would be gone before a busy machine looks.
MAXIMUM_AGE_S = 5.0


def config(reference: str = WORLD, **markers: Marker) -> GroundTruthConfig:
    return GroundTruthConfig(reference, MAXIMUM_AGE_S, markers, {})


class GroundTruthCase(unittest.TestCase):
    """Each test uses a different frame, so that tests are independent."""

    @classmethod
    def setUpClass(cls) -> None:
        cls.broadcaster = tf2_ros.TransformBroadcaster()
        cls.static = tf2_ros.StaticTransformBroadcaster()

    def setUp(self) -> None:
        self.frame = self.id().rsplit(".", 1)[1]
        self.tf = TfFrames()
        self.truth = FramesGroundTruth(config(robot=Marker(self.frame)), self.tf)
        self.addCleanup(self.truth.close)
        # A message that comes before its subscriber is there is lost: begin when one arrives.
        first = self.frame + "_first"
        self.began = rospy.get_time()
        wait_until(lambda: (self.publish(0.0, frame=first), self.tf.sees(first))[1], "a frame arrives")
        # All times of a test are compared with this one, however slow the test is.
        self.began = rospy.get_time()

    def message(self, stamp: float, *place: float, frame: str = "", turn=FLAT, parent: str = WORLD) -> TransformStamped:
        message = TransformStamped()
        message.header.stamp = rospy.Time.from_sec(stamp)
        message.header.frame_id = parent
        message.child_frame_id = frame or self.frame
        message.transform.translation = Vector3(*(place or (0.0, 0.0, 0.0)))
        message.transform.rotation = Quaternion(*turn)
        return message

    def publish(self, ago_s: float, *place: float, **fields) -> float:
        """Publish a frame of so many seconds before the test; returns the time."""
        stamp = self.began - ago_s
        self.broadcaster.sendTransform(self.message(stamp, *place, **fields))
        return stamp

    def wait_seen(self, stamp: float) -> None:
        """Wait until the test's frame of this time has arrived."""
        wait_until(lambda: self.tf.gap(self.frame, stamp) == 0.0, "the frame arrives")

    def shown(self, ago_s: float, *place: float, **fields) -> float:
        """Publish, and wait until it has arrived."""
        stamp = rospy.Time.from_sec(self.publish(ago_s, *place, **fields)).to_sec()
        self.wait_seen(stamp)
        return stamp

    def assert_pose(self, pose: Pose3, *expected: float) -> None:
        for value, wanted in zip(pose, expected):
            self.assertAlmostEqual(value, wanted, places=5)

    def assert_no_pose(self, pattern: str, at_utc: Optional[float] = None) -> None:
        with self.assertRaisesRegex(NoPose, pattern):
            self.truth.pose("robot", at_utc)


class TestFrames(GroundTruthCase):
    """What tf adds to test/pure/bmbox/host/test_ground_truth_of_frames.py: its times, its trees, and its errors."""

    def test_frames_in_between_are_gone_through(self) -> None:
        # The camera is at (1, 1), turned to the left by a quarter: 2 m before it is (1, 3).
        now = rospy.get_time()
        self.broadcaster.sendTransform([
            self.message(now, 1.0, 1.0, 1.0, frame="test_camera", turn=rotation(math.pi / 2)),
            self.message(now, 2.0, 0.0, 0.0, parent="test_camera"),
        ])
        pose = wait_until(self.pose_or_none, "camera and marker arrive")
        self.assert_pose(pose, 1.0, 3.0, 1.0, math.pi / 2)

    def pose_or_none(self) -> Optional[Pose3]:
        with contextlib.suppress(NoPose):
            return self.truth.pose("robot")
        return None

    def test_a_static_frame_is_never_too_old(self) -> None:
        self.static.sendTransform(self.message(rospy.get_time() - 1000.0, 3.0, 0.0, 0.0))
        pose = wait_until(self.pose_or_none, "the static frame arrives")
        self.assert_pose(pose, 3.0, 0.0, 0.0, 0.0)
        self.assert_pose(self.truth.pose("robot", rospy.get_time() - 5.0), 3.0, 0.0, 0.0, 0.0)

    def test_between_two_poses_it_is_where_it_must_have_been(self) -> None:
        """A name with a slash is the same frame."""
        begin = self.shown(3.0, 1.0, 0.0, 0.0, frame="/" + self.frame)
        end = self.shown(1.0, 2.0, 4.0, 0.0, turn=rotation(1.0))
        # A quarter of the way.
        self.assert_pose(self.truth.pose("robot", begin + (end - begin) / 4), 1.25, 1.0, 0.0, 0.25)
        self.assert_pose(self.truth.pose("robot", end + 2.0), 2.0, 4.0, 0.0, 1.0)  # the latest one must do
        self.assert_no_pose("was not seen at", at_utc=end + 60.0)

    def test_nothing_is_invented_in_a_gap(self) -> None:
        begin = self.shown(9.5, 1.0, 0.0, 0.0)
        self.truth.use(self.truth.config._replace(maximum_age_s=2.0))
        self.shown(0.0, 2.0, 0.0, 0.0)
        self.assert_no_pose(rf"^robot: frame '{self.frame}' was not seen at \d\d:\d\d:\d\d UTC", at_utc=begin + 4.5)
        self.assert_pose(self.truth.pose("robot", begin), 1.0, 0.0, 0.0, 0.0)

    def test_a_frame_that_is_too_old_is_named_with_its_age(self) -> None:
        self.shown(8.0, 1.0, 2.0, 0.0)
        self.assert_no_pose(rf"^robot: frame '{self.frame}' was last seen (8|9|1\d)\.\d s ago: check that the cameras")

    def test_a_reference_frame_that_was_never_seen_is_named(self) -> None:
        self.shown(0.0)
        self.truth.use(config("test_nowhere", robot=Marker(self.frame)))
        self.assert_no_pose("^robot: reference frame 'test_nowhere' was never seen: start the motion-capture system")

    def test_a_frame_without_connection_is_named(self) -> None:
        self.shown(0.0, parent="test_island")
        self.assert_no_pose(f"^robot: frame '{self.frame}' has no connection with '{WORLD}': ")

    def test_frames_that_were_never_seen_together_are_named(self) -> None:
        self.publish(3.0, frame="test_tripod")
        self.shown(1.0, parent="test_tripod")
        self.assert_no_pose(f"^robot: frame '{self.frame}' and the frames between it and '{WORLD}' were not seen")

    def test_nan_and_infinity_are_not_a_pose(self) -> None:
        # tf2 itself refuses some of them: then the frame was never seen.
        self.publish(0.0, math.nan, 0.0, 0.0)
        self.publish(0.0, 0.0, 0.0, 0.0, turn=(0.0, 0.0, 0.0, 0.0))
        stamp = rospy.Time.from_sec(self.publish(0.0, math.inf, 0.0, 0.0)).to_sec()
        self.wait_seen(stamp)
        self.assert_no_pose(f"^robot: frame '{self.frame}' ")


class TestDummy(unittest.TestCase):
    """The dummy ground truth, and the program that checks."""

    def setUp(self) -> None:
        self.truth = FramesGroundTruth(load(default_file()), TfFrames())
        self.addCleanup(self.truth.close)

    def states(self) -> dict:
        return {(state.team, state.subject): state for state in self.truth.states()}

    def test_all_frames_are_there_and_some_are_lost_again_and_again(self) -> None:
        wait_until(lambda: not any(state.trouble for state in self.states().values()), self.states)
        self.assert_lost("person", "mocap_person")
        wait_until(lambda: not any(state.trouble for state in self.states().values()), self.states)

    def assert_lost(self, subject: str, frame: str) -> None:
        def only_losses() -> str:
            """What is wrong with the frame, if that is wrong with no other than those that are lost together."""
            troubled = {name: state.trouble for (_, name), state in self.states().items() if state.trouble}
            return troubled.get(subject, "") if set(troubled) <= {"person", "positioner"} else ""

        trouble = wait_until(only_losses, f"{subject} is lost")
        self.assertRegex(trouble, f"^{subject}: frame '{frame}' was last seen at")

    def test_poses_are_those_of_the_world_whatever_the_markers_are(self) -> None:
        table = wait_until(lambda: self.states()["", "table"].pose, "the table is seen")
        self.assertEqual(tuple(round(value, 3) for value in table), (4.0, 1.0, 0.8, 0.3))
        robot = wait_until(self.robot_of_others, "the robot is seen")
        self.assertAlmostEqual(robot.z, 0.0, places=5)

    def robot_of_others(self) -> Optional[Pose3]:
        with contextlib.suppress(NoPose):
            return self.truth.for_team("Others").pose("robot")
        return None

    def test_the_check_says_of_each_marker_where_it_is(self) -> None:
        found = self.check(0, "--wait", "30")
        self.assertRegex(found, r"(?m)^seen     table: mocap_table at x 4\.000 y 1\.000 z 0\.800 m, theta 0\.300 rad$")
        self.assertRegex(found, r"(?m)^seen     robot of TestingTeam: mocap_robot at x")
        self.assertEqual(len(re.findall("(?m)^seen ", found)), 6)

    def test_the_check_names_what_is_missing_and_the_remedy(self) -> None:
        text = pathlib.Path(default_file()).read_text(encoding="utf-8")
        found = self.check(1, self.file(text.replace("mocap_table", "mocap_tabel")), "--wait", "1")
        self.assertRegex(found, "(?m)^MISSING  table: frame 'mocap_tabel' was never seen: put the marker into")

    def test_the_check_of_a_wrong_file_names_the_line(self) -> None:
        found = self.check(1, self.file("reference_frame: testbed\nmaximum_age: soon\nmarkers: {}\n"))
        self.assertRegex(found, r"the configuration is invalid\n.*yaml:2: found the text 'soon' as maximum_age")

    def test_the_check_without_ros_says_so(self) -> None:
        found = self.check(1, ROS_MASTER_URI="http://127.0.0.1:1")
        self.assertRegex(found, "no ROS master: start roscore")

    def test_a_dummy_with_wrong_parameters_names_them(self) -> None:
        for name, value, pattern in (
            ("rate", "0", "found 0, expected a number"), ("lose", "hat", "found hat, expected some of robot, person"),
            ("ground_truth_file", "/nowhere.yaml", "no file '/nowhere.yaml'"),
        ):
            program = Program(
                own("roah_rsbb_dummy_ground_truth"), "__name:=wrong_dummy", f"_{name}:={value}"
            )
            self.addCleanup(program.close)
            self.assertEqual(program.wait_ended(), 1)
            self.assertRegex(program.text, pattern)
            rospy.delete_param(f"/wrong_dummy/{name}")

    def file(self, text: str) -> str:
        with tempfile.NamedTemporaryFile("w", suffix=".yaml", delete=False, encoding="utf-8") as file:
            file.write(text)
        self.addCleanup(pathlib.Path(file.name).unlink)
        return file.name

    def check(self, status: int, *arguments: str, **environment: str) -> str:
        """Run check_ground_truth. Returns its output."""
        program = Program(own("check_ground_truth"), *arguments, **environment)
        self.addCleanup(program.close)
        self.assertEqual(program.wait_ended(), status, program.text)
        return program.text
