"""The names of topics, services and the action, without the namespace of the node, and their QoS."""

from rclpy.qos import DurabilityPolicy, QoSProfile
from roah_rsbb_msgs.msg import BenchmarkState

from roah_rsbb.protocol import RobotState

PREFIX = "roah_rsbb/"
RUN = f"{PREFIX}run"

STATES = {
    RobotState.STOP: BenchmarkState.STOP,
    RobotState.PREPARING: BenchmarkState.PREPARE,
    RobotState.WAITING_GOAL: BenchmarkState.PREPARE,
    RobotState.EXECUTING: BenchmarkState.EXECUTE,
    RobotState.RESULT_TX: BenchmarkState.EXECUTE,
}


def latched() -> QoSProfile:
    """For topics with a state: a subscriber that starts later receives the newest message."""
    return QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def unlatched() -> QoSProfile:
    """For topics with events."""
    return QoSProfile(depth=10)
