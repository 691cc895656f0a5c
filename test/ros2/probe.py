"""A node of the test: what a program of a team sees of the comm node."""

import threading
from typing import Any, Dict, List

import rclpy
from geometry_msgs.msg import Pose2D
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from roah_rsbb_msgs.msg import Benchmark, BenchmarkState, DevicesState, GoalHGMF, GoalOMF, TabletState
from std_msgs.msg import Empty
from std_msgs.msg import String as StringMsg
from support.waiting import happened, wait_until

LATCHED = QoSProfile(depth=20, durability=DurabilityPolicy.TRANSIENT_LOCAL)
EVENTS = {"devices/bell": Empty, "tablet/call": Empty, "tablet/position": Pose2D}
# The state is the last: a node learns of the subscriptions in this order, and always has a state to send.
TOPICS = {
    "benchmark": Benchmark, "benchmark/name": StringMsg, "devices/state": DevicesState, "tablet/state": TabletState,
    "goal/text": StringMsg, "goal/waypoint": Pose2D, "goal/placement": GoalHGMF, "goal/switches": GoalOMF,
    "benchmark/state": BenchmarkState,
}


class Probe:
    """Receives all topics, and calls services."""

    def __init__(self, name: str = "probe", namespace: str = "") -> None:
        self.prefix = f"{namespace}/roah_rsbb/"
        self._state = f"{self.prefix}benchmark/state"
        self.node = rclpy.create_node(name)
        self.heard: Dict[str, List[Any]] = {topic: [] for topic in (*EVENTS, *TOPICS)}
        for topics, qos in ((EVENTS, QoSProfile(depth=20)), (TOPICS, LATCHED)):
            for topic, kind in topics.items():
                self.node.create_subscription(
                    kind, self.prefix + topic, lambda message, topic=topic: self._hear(topic, message), qos)
        self._clients: Dict[str, Any] = {}
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self._thread = threading.Thread(target=self.executor.spin, daemon=True)
        self._thread.start()

    def _hear(self, topic: str, message: Any) -> None:
        self.heard[topic].append(message)
        happened()

    def call(self, name: str, kind: type, **fields: Any) -> Any:
        """Call a service and return its answer."""
        client = self._clients.get(name)
        if client is None:
            client = self._clients[name] = self.node.create_client(kind, self.prefix + name)
            self._wait_known()
        assert client.wait_for_service(60.0), f"{name} is missing"
        asked = client.call_async(kind.Request(**fields))
        asked.add_done_callback(lambda _: happened())
        wait_until(asked.done, f"{name} answers")
        return asked.result()

    def wait(self, topic: str, condition: Any, what: str = "") -> Any:
        """Wait until the newest message of a topic fulfils a condition, and return it."""
        def newest() -> Any:
            heard = self.heard[topic]
            return heard[-1] if heard and condition(heard[-1]) else None
        return wait_until(newest, lambda: f"{topic} {what}; heard {self.heard[topic][-3:]}")

    def _wait_known(self) -> None:
        """Wait until the comm node knows the clients so far. On a busy computer it may be asked before, and ROS 2 then
        loses its answer after 0.1 s (rmw_fastrtps, issue 842)."""
        heard: List[Any] = []
        self.node.create_subscription(
            BenchmarkState, self._state, lambda message: (heard.append(message), happened()), LATCHED)
        wait_until(lambda: heard, "the comm node knows the probe")

    def wait_heard_by(self) -> None:
        """Wait until the comm node knows all subscriptions: from here on the probe misses nothing."""
        self.wait("benchmark/state", lambda _: True)

    def wait_state(self, state: int) -> None:
        """Wait for STOP, PREPARE or EXECUTE."""
        self.wait("benchmark/state", lambda message: message.benchmark_state == state, f"is {state}")

    def close(self) -> None:
        self.executor.shutdown(timeout_sec=2.0)
        self._thread.join(2.0)
        self.node.destroy_node()
