"""Node roah_rsbb_comm (executable comm): what a team runs on a robot with ROS 2 (docs/team_ros2.md)."""

import os
from typing import Any, Callable, List

from google.protobuf import text_format
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor
from rclpy.executors import SingleThreadedExecutor
from rclpy.logging import LoggingSeverity
from rclpy.node import Node
from roah_rsbb_msgs.action import Run
from roah_rsbb_msgs.srv import Override, OverrideGoal

from roah_rsbb.comm.ciphers import PASSWORD_VARIABLE, Cipher, cipher_by_label, own_password, password_in
from roah_rsbb.protocol import RobotState
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.goals import Result
from roah_rsbb.robot.machine import IllegalEvent, override_goal_message, override_message
from roah_rsbb.robot.runner import SessionRunner
from roah_rsbb.rulebook.registry import DEVICES, STRINGS, TABLET, ResultForm, profile_of
from roah_rsbb_comm.interface import Interface, Requests
from roah_rsbb_comm.node_loop import CannotStart, NodeLoop, run_node
from roah_rsbb_comm.run_action import RunAction, action_goal, service_and_result

# Sent where any result will do: the original box waits for one.
ANY_RESULT = "done"
# The services that end EXECUTE, the usual one first.
_WITHOUT, _OBJECT, _PERSON, _TEXT = (f"end_execute{kind}" for kind in ("", "/object", "/person", "/text"))
END_SERVICES = {
    ResultForm.NONE: (_WITHOUT,), ResultForm.OBJECT: (_OBJECT,), ResultForm.PERSON: (_PERSON,),
    ResultForm.ANY: (_WITHOUT, _TEXT), ResultForm.TEXT: (_TEXT, _WITHOUT),
}


class CommNode:
    """The node, from its parameters to its end. Raises CannotStart, ValueError or OSError at the start."""

    def __init__(self, node: Node) -> None:
        self._log = node.get_logger()
        labels = [cipher.label for cipher in Cipher if cipher is not Cipher.NONE]
        team = _text(node, "team_name", "", "name of the team, exactly as in the schedule")
        robot = _text(node, "robot_name", "Robot", "name of the robot; robots of one team have different names")
        host = _text(node, "rsbb_host", "10.255.255.255",
                     "broadcast address of the network with the box ('ip address' shows it as brd), or the box's")
        port = _declared(node, "rsbb_port", 6666, "public UDP port of the box", integer_range=[
            IntegerRange(from_value=1, to_value=65535, step=1)])
        bind_host = _text(node, "bind_host", "0.0.0.0", "own address, if box and robots share a computer")
        cipher = _text(node, "rsbb_cypher", Cipher.AES_128_CBC.label, f"cipher: {', '.join(labels)}")
        if not team:
            raise CannotStart("set the parameter team_name to your team's name, exactly as in the schedule: "
                              "ros2 run roah_rsbb_comm comm --ros-args -p team_name:=MyTeam")
        if cipher not in labels:
            raise CannotStart(f"parameter rsbb_cypher: found {cipher}, expected one of {', '.join(labels)}")
        self._ros = NodeLoop(node, SingleThreadedExecutor())
        self._runner = SessionRunner(
            self._ros.loop, team, _password(node), self._on_effect, self._log.warning, robot=robot, rsbb_host=host,
            rsbb_port=port, bind_host=bind_host, cipher=cipher_by_label(cipher),
        )
        self._session = self._runner.session
        self._action = RunAction(node, self._action_ended, self._action_feedback)
        self._interface = Interface(node, Requests(
            end_prepare=lambda: self._ask(self._session.end_prepare),
            end_execute=lambda service, result: self._ask(lambda: self._end_execute(service, result)),
            add_string=lambda field, text: self._ask(lambda: self._add_string(field, text)),
            set_device=lambda name, value: self._ask(lambda: self._set_device(name, value)),
            display_map=lambda display: self._ask(lambda: self._display_map(display)),
            messages_saved=lambda count: self._ros.post(lambda: self._set_messages_saved(count)),
            override=lambda request: self._ask(lambda: self._override(request)),
            override_goal=lambda request: self._ask(lambda: self._override_goal(request)),
        ))
        self._log.info(f"Robot {robot} of team {team} looks for the RSBB on {host}:{port}")

    def run(self) -> int:
        """Run until the end; returns the exit status."""
        self._runner.open()
        status = self._ros.run()
        self._runner.close()
        self._ros.close()
        return status

    # Requests of the robot's programs, in the loop.

    def _ask(self, action: Callable[[], None]) -> None:
        """From the executor: call the session in the loop. Effects are carried out at once."""

        def do() -> None:
            action()
            self._runner.wake()

        self._ros.call(do)

    def _end_execute(self, service: str, result: Result) -> None:
        progress = self._session.progress
        form = profile_of(progress.benchmark or "").result
        if progress.state is RobotState.EXECUTING and service not in END_SERVICES[form]:
            raise IllegalEvent(f"{service} does not fit {progress.benchmark}: call {END_SERVICES[form][0]}")
        if form is ResultForm.ANY:
            result = result or ANY_RESULT
        self._session.end_execute(result or None)

    def _add_string(self, field: str, text: str) -> None:
        self._check_use(field, field)
        self._session.add_string(field, text)

    def _set_device(self, name: str, value: Any) -> None:
        self._check_use(DEVICES, "devices")
        self._session.set_device(name, value)

    def _display_map(self, display: bool) -> None:
        self._check_use(TABLET, "commands of the tablet")
        self._session.display_map(display)

    def _check_use(self, use: str, called: str) -> None:
        """Refuse what the present benchmark does not use. The session refuses everything outside of a run."""
        benchmark = self._session.progress.benchmark
        if benchmark is not None and use not in profile_of(benchmark).uses:
            raise IllegalEvent(f"{benchmark} does not use {called}, and the box would ignore it")

    def _set_messages_saved(self, count: int) -> None:
        self._session.progress.messages_saved = count

    def _override(self, request: Override.Request) -> None:
        self._session.override(self._ros.loop.time(), override_message(
            request.benchmark_type, request.benchmark_state,
            (request.acknowledgement.sec, request.acknowledgement.nanosec), request.initial_state, request.switches,
        ))

    def _override_goal(self, request: OverrideGoal.Request) -> None:
        self._session.override(self._ros.loop.time(), override_goal_message(
            request.benchmark, request.benchmark_state,
            (request.acknowledgement.sec, request.acknowledgement.nanosec), request.goal,
        ))

    # Answers of the robot's action, in the executor.

    def _action_ended(self, goal: Run.Goal, result: Run.Result) -> None:
        if goal.phase == Run.Goal.PREPARE:
            self._log_refusal("the end of PREPARE", self._session.end_prepare)
        else:
            service, fitting = service_and_result(goal.benchmark, result)
            self._log_refusal("the result", lambda: self._end_execute(service, fitting))

    def _action_feedback(self, feedback: Run.Feedback) -> None:
        if feedback.messages_saved:
            self._ros.post(lambda: self._set_messages_saved(feedback.messages_saved))
        texts = (feedback.notification, feedback.activation_event, feedback.visitor, feedback.final_command)
        for field, text in zip(STRINGS, texts):
            if text:
                self._log_refusal(field, lambda field=field, text=text: self._add_string(field, text))

    def _log_refusal(self, what: str, action: Callable[[], None]) -> None:
        try:
            self._ask(action)
        except (IllegalEvent, ValueError) as error:
            self._log.error(f"{what} of the robot's action is refused: {error}")

    # Effects, in the loop.

    def _on_effect(self, effect: fx.Effect) -> None:
        if isinstance(effect, fx.BenchmarkIs):
            self._set_messages_saved(0)  # the count belongs to one benchmark
        # First the topics: a STOP must not wait for anything.
        self._interface.show(effect, self._session.progress.goal)
        if isinstance(effect, fx.Prepare):
            self._begin_action(Run.Goal.PREPARE, effect.benchmark, None)
        elif isinstance(effect, fx.Execute):
            self._begin_action(Run.Goal.EXECUTE, effect.benchmark, effect.goal)
        elif isinstance(effect, fx.Stop):
            self._ros.in_executor(self._action.stop)
            self._log.info(f"Stop: {effect.why}")
        elif isinstance(effect, fx.ProblemIs):
            self._log_report(effect)
        elif isinstance(effect, (fx.SendBeacon, fx.SendState, fx.WouldSendState)):
            self._debug(effect)

    def _log_report(self, report: fx.ProblemIs) -> None:
        # A call of rclpy's logger may not change its severity: each line of code has one.
        if report.over:
            self._log.info(report.text)
        else:
            self._log.warning(report.text)

    def _begin_action(self, phase: int, benchmark: str, goal: Any) -> None:
        message = action_goal(phase, benchmark, goal)
        self._ros.in_executor(lambda: self._action.begin(message))

    def _debug(self, effect: Any) -> None:
        """Log what is sent, or would be sent without the override, at level debug."""
        if self._log.is_enabled_for(LoggingSeverity.DEBUG):
            what = "Not sent, because of the override" if isinstance(effect, fx.WouldSendState) else "Sent"
            text = text_format.MessageToString(effect.message, as_one_line=True, as_utf8=True)
            self._log.debug(f"{what}: {type(effect.message).__name__} {text}")


def _declared(node: Node, name: str, default: Any, description: str, **more: List[Any]) -> Any:
    """Declare a parameter that cannot change while the node runs, and return its value."""
    return node.declare_parameter(name, default, ParameterDescriptor(
        description=f"{description}. Restart the node to change it", read_only=True, **more)).value


def _text(node: Node, name: str, default: str, description: str) -> str:
    return _declared(node, name, default, description)


def _password(node: Node) -> str:
    """The team's password, from a file, the environment, or a parameter. Raises CannotStart or ValueError."""
    file = os.path.expanduser(_text(node, "rsbb_key_file", "", "file whose first line is the team's password"))
    # Everybody in the ROS domain could read a declared parameter.
    key = node.declare_parameter("rsbb_key", "", ParameterDescriptor(
        description="the team's password; better use rsbb_key_file")).value
    node.undeclare_parameter("rsbb_key")
    if file:
        return password_in(file, node.get_logger().warning)
    if key:
        node.get_logger().warning("Other users of this computer can see the password in the arguments of the node. "
                                  "Write it into a file that only you can read (chmod 600), and set rsbb_key_file")
        return key
    password = own_password(None, None)
    if not password:
        raise CannotStart("set the parameter rsbb_key_file to a file whose first line is the team's password, or the "
                          f"environment variable {PASSWORD_VARIABLE} to the password")
    return password


def main() -> None:
    """Entry point of the node."""
    run_node("roah_rsbb_comm", CommNode)
