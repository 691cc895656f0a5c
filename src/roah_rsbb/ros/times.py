"""Times for ROS messages. ROS times have a smaller range than the times that a clock or a robot may send."""


import rospy

from roah_rsbb.protocol import WireTime, wire_ns

# The largest ROS time and ROS duration, seconds.
_MAX_TIME = 2**32 - 1
_MAX_DURATION = 2**31 - 1


def ros_time(utc: float) -> rospy.Time:
    """Return a UTC time in seconds as a ROS time, limited to its range."""
    return rospy.Time.from_sec(min(max(utc, 0.0), _MAX_TIME))


def ros_wire_time(wire_time: WireTime) -> rospy.Time:
    """Return a wire time as a ROS time, exactly, limited to its range."""
    nanoseconds = min(max(wire_ns(wire_time), 0), _MAX_TIME * 1_000_000_000)
    return rospy.Time(*divmod(nanoseconds, 1_000_000_000))


def ros_duration(seconds: float) -> rospy.Duration:
    """Return a duration in seconds as a ROS duration, limited to its range."""
    return rospy.Duration.from_sec(min(max(seconds, -_MAX_DURATION), _MAX_DURATION))
