"""Node roah_rsbb_modules: runs the modules of functionality benchmarks (docs/module_protocol.md).

Parameters (private): benchmarks (codes with blanks between them, to distribute modules over processes; default: all),
parameters_dir (for each benchmark a YAML file with parameters, and a Python file if the competition has rules of its
own; ground_truth.yaml; and a folder for each zone with parameters or ground truth of its own). Files may be changed,
added and removed at any time: changes take effect at the next start of a run or the next request for a pose.
"""

import os
import time
from typing import Callable, List

import rospy

from roah_rsbb.bmbox.host.ground_truth_of_frames import ZonesGroundTruth
from roah_rsbb.bmbox.host.host import ModulesHost, chosen_benchmarks
from roah_rsbb.model.modules import ModulesState
from roah_rsbb.msg import ModuleRuns
from roah_rsbb.msg import ModulesState as ModulesStateMsg
from roah_rsbb.ros.modules.convert import modules_state_message, runs_of
from roah_rsbb.ros.modules.dummy_ground_truth import default_file
from roah_rsbb.ros.modules.tf_frames import TfFrames
from roah_rsbb.ros.node import NodeParams, RosLoop, run_node

# The last message is sent within milliseconds, unless a subscriber hangs.
LEAVE_S = 1.0
POLL_S = 0.02


class ModulesNode:
    """The node: connects a `ModulesHost` to topics. Everything except topics happens in one thread."""

    def __init__(self) -> None:
        params = NodeParams()
        folder = params.path("parameters_dir", os.path.dirname(default_file()))
        codes = chosen_benchmarks(params, folder)
        params.done()
        self._ros = RosLoop()
        self._publisher = rospy.Publisher("/modules/state", ModulesStateMsg, queue_size=1, latch=True)
        self._host = ModulesHost(
            self._ros.loop, folder, codes, ZonesGroundTruth(folder, TfFrames), self._send)

    def run(self) -> None:
        """Run until shut down."""
        self._host.start()
        rospy.Subscriber("/core/module_runs", ModuleRuns, self._on_runs, queue_size=10, tcp_nodelay=True)
        self._ros.run()
        _and_wait(self._publisher, self._host.close)
        self._ros.close()

    def _on_runs(self, message: ModuleRuns) -> None:
        runs = runs_of(message)
        self._ros.post(lambda: self._host.take(runs))

    def _send(self, state: ModulesState) -> None:
        try:
            self._publisher.publish(modules_state_message(state))
        except rospy.ROSException as error:
            if not rospy.core.is_shutdown_requested():
                rospy.logerr_throttle(1.0, f"{self._publisher.name} could not be published: {error}")


def _and_wait(publisher: rospy.Publisher, publish: Callable[[], object]) -> None:
    """Publish, and wait until it is sent: rospy sends in its own threads, which end with the node."""
    def sent() -> List[int]:
        _, _, connections = publisher.impl.get_stats()
        return [count for _, _, count, is_open in connections if is_open]

    before = sum(sent())
    deadline = time.monotonic() + LEAVE_S
    publish()
    while sum(sent()) < before + len(sent()) and time.monotonic() < deadline:
        time.sleep(POLL_S)


def main() -> None:
    """Entry point of the node."""
    run_node("roah_rsbb_modules", __doc__, ModulesNode, disable_signals=True)
