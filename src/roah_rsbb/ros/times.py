"""Times for ROS messages. A ROS time or duration holds less than a clock or a robot may say."""

import rospy

from roah_rsbb.protocol import WireTime, wire_ns

# What a ROS time and a ROS duration can hold, in seconds.
_MAX_TIME = 2**32 - 1
_MAX_DURATION = 2**31 - 1


def ros_time(utc: float) -> rospy.Time:
    """A UTC time in seconds; one that a ROS time cannot hold becomes the nearest that it can."""
    return rospy.Time.from_sec(min(max(utc, 0.0), _MAX_TIME))


def ros_wire_time(wire_time: WireTime) -> rospy.Time:
    """A wire time, exactly; one that a ROS time cannot hold becomes the nearest that it can."""
    nanoseconds = min(max(wire_ns(wire_time), 0), _MAX_TIME * 1_000_000_000)
    return rospy.Time(*divmod(nanoseconds, 1_000_000_000))


def ros_duration(seconds: float) -> rospy.Duration:
    """A duration in seconds; one that a ROS duration cannot hold becomes the nearest that it can."""
    return rospy.Duration.from_sec(min(max(seconds, -_MAX_DURATION), _MAX_DURATION))
