"""Calls the action roah_rsbb/run of robots that prefer it to topics and services.

All methods run in the executor. As long as the robot offers no such action, nothing happens.
"""

import time
from typing import Any, Callable, Optional, Set, Tuple

from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Pose2D
from rclpy.action import ActionClient
from rclpy.node import Node
from roah_rsbb_msgs.action import Run

from roah_rsbb.robot.goals import Goal, HopfResult, HppfResult, Pose, Result
from roah_rsbb.rulebook.registry import ResultForm, profile_of
from roah_rsbb_comm.names import RUN

LOOK_S = 0.2
# Time limit for a cancelled goal to end; after that, the next one is sent.
CANCEL_S = 5.0
_ENDS = {GoalStatus.STATUS_ABORTED: "aborted", GoalStatus.STATUS_CANCELED: "cancelled"}


class RunAction:
    """One goal of the action for each PREPARE and each EXECUTE."""

    def __init__(
        self, node: Node, ended: Callable[[Run.Goal, Run.Result], None], feedback: Callable[[Run.Feedback], None]
    ) -> None:
        """`ended` is called when the robot has succeeded, `feedback` with the robot's feedback."""
        self._node = node
        self._log = node.get_logger()
        self._client = ActionClient(node, Run, RUN)
        self._ended = ended
        self._feedback = feedback
        self._wanted: Optional[Run.Goal] = None  # the present goal
        self._sent: Optional[Run.Goal] = None  # the goal that the robot has and has not ended
        self._handle: Any = None  # of `_sent`, once accepted
        self._servers: Set[bytes] = set()  # the robot's action server when `_sent` was sent
        self._ends_by_mono = 0.0  # when a cancelled `_sent` must have ended
        node.create_timer(LOOK_S, self._look)

    def begin(self, goal: Run.Goal) -> None:
        """The box asks for this."""
        self.stop()
        self._wanted = goal
        self._send()

    def stop(self) -> None:
        """The box stopped the robot."""
        if self._wanted is None:
            return
        self._wanted = None
        self._ends_by_mono = time.monotonic() + CANCEL_S
        if self._handle is not None:
            self._handle.cancel_goal_async()

    def _look(self) -> None:
        if self._sent is not None and (not self._client.server_is_ready() or self._found_servers() - self._servers):
            self._log.warning(
                "the robot's action server has ended during a goal: it gets the goal again once it is back")
            self._sent = self._handle = None
        if self._sent is not None and self._sent is not self._wanted and time.monotonic() > self._ends_by_mono:
            self._log.error(f"the robot has not ended its goal {CANCEL_S:.0f} s after it was cancelled. The next one "
                            "is sent without waiting")
            self._sent = self._handle = None
        self._send()

    def _send(self) -> None:
        if self._wanted is None or self._sent is not None or not self._client.server_is_ready():
            return
        goal = self._sent = self._wanted
        self._servers = self._found_servers()
        asked = self._client.send_goal_async(goal, lambda message: self._hear(goal, message.feedback))
        asked.add_done_callback(lambda done: self._answered(goal, done.result()))

    def _found_servers(self) -> Set[bytes]:
        """The identities of the action's servers. A killed one is found for 20 s, also when it is back as another."""
        topic = self._node.resolve_topic_name(f"{RUN}/_action/feedback")
        return {bytes(found.endpoint_gid) for found in self._node.get_publishers_info_by_topic(topic)}

    def _hear(self, goal: Run.Goal, feedback: Run.Feedback) -> None:
        if goal is self._wanted:
            self._feedback(feedback)

    def _answered(self, goal: Run.Goal, handle: Any) -> None:
        if not handle.accepted:
            self._end(goal, "rejected")
            return
        handle.get_result_async().add_done_callback(lambda done: self._over(goal, done.result()))
        if goal is not self._wanted:
            handle.cancel_goal_async()
        if goal is self._sent:
            self._handle = handle

    def _over(self, goal: Run.Goal, answer: Any) -> None:
        if answer.status == GoalStatus.STATUS_SUCCEEDED and goal is self._wanted:
            self._ended(goal, answer.result)
            self._end(goal)
        else:
            self._end(goal, _ENDS.get(answer.status, "lost"))

    def _end(self, goal: Run.Goal, trouble: str = "") -> None:
        """The robot has ended a goal, which may be an earlier one."""
        if goal is self._wanted:
            if trouble:
                self._log.error(f"the robot's goal was {trouble}: the robot does nothing until the box stops it")
            self._wanted = None  # it is not sent again
        if goal is self._sent:
            self._sent = self._handle = None
        self._send()


def action_goal(phase: int, benchmark: str, goal: Optional[Goal]) -> Run.Goal:
    """The action's goal for a phase, with the box's goal if there is one."""
    message = Run.Goal(phase=phase, benchmark=benchmark)
    if goal is not None:
        message.goal = goal.text or ""
        message.initial_state, message.switches = list(goal.initial_state), list(goal.switches)
        message.object_type = goal.object_id or 0
        if goal.pose is not None:
            message.pose = Pose2D(x=goal.pose.x, y=goal.pose.y, theta=goal.pose.theta)
    return message


def service_and_result(benchmark: str, result: Run.Result) -> Tuple[str, Result]:
    """The service of `end_execute` that fits a benchmark, and the action's result in the client's form."""
    form = profile_of(benchmark).result
    pose = Pose(result.pose.x, result.pose.y, result.pose.theta)
    if form is ResultForm.OBJECT:
        return "end_execute/object", HopfResult(result.object_class, result.object_name, pose)
    if form is ResultForm.PERSON:
        return "end_execute/person", HppfResult(result.person_name, pose)
    if result.result and form in (ResultForm.ANY, ResultForm.TEXT):
        return "end_execute/text", result.result
    return "end_execute", None
