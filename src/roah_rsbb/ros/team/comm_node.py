"""Node roah_rsbb_comm (type comm): what a team runs on its robot (docs/ros_interface.md, "Team's side").

It communicates with boxes of any generation, and offers topics and services to the robot's programs.

Parameters (private): team_name (required), robot_name, rsbb_key_file (a file whose first line is the team's password)
or rsbb_key (the password), rsbb_host (broadcast address of the network with the box, or the box's), rsbb_port,
bind_host, rsbb_cypher, generation (year of the original package that the team's code was built with: 2015, 2018, 2019
or 2020); for tests clock_offset (s), loss (share of datagrams).
"""

import logging
import os
import random
import time
from typing import Callable, Optional

import rospy
from google.protobuf import text_format

from roah_rsbb.comm.ciphers import Cipher, cipher_by_label, password_in
from roah_rsbb.ground.params import BadParams, Params
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import WireTime
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.machine import IllegalEvent, override_goal_message, override_message
from roah_rsbb.robot.runner import SessionRunner
from roah_rsbb.ros.node import NodeParams, RosLoop, run_node
from roah_rsbb.ros.team.comm_interface import CommInterface, RobotRequests
from roah_rsbb.ros.team.generations import DEFAULT, GENERATIONS, report_refused, types_of
from roah_rsbb.srv import Override, OverrideGoal, OverrideGoalResponse, OverrideResponse

DEFAULT_KEY = "DefaultKey"
# The launch files put it before the password: roslaunch prints and logs all parameters, but none with a control
# character.
NOT_PRINTED = "\x7f"

# At level Debug (of this logger or of rosout), it shows what is sent. Its name is documented for teams. It passes
# records on to rosout, which writes to the console and /rosout.
_sent_log = logging.getLogger("ros.roah_rsbb_comm_ros")
_sent_log.parent = logging.getLogger("rosout")


class CommNode:
    """The node, from its parameters to its end. Raises BadParams, ValueError or OSError at the start."""

    def __init__(self) -> None:
        params = NodeParams()
        labels = [cipher.label for cipher in Cipher if cipher is not Cipher.NONE]
        team, robot = params.text("team_name"), params.text("robot_name", "Robot")
        key = _password(params)
        host, port = params.text("rsbb_host", "10.0.0.1"), params.whole("rsbb_port", 6666, 1, 65535)
        bind_host = params.text("bind_host", "0.0.0.0")
        cipher = cipher_by_label(params.choice("rsbb_cypher", Cipher.AES_128_CBC.label, labels))
        generation = params.text("generation", DEFAULT)
        if generation not in GENERATIONS:
            raise BadParams(f"parameter generation: found {generation}, expected one of {', '.join(GENERATIONS)}")
        # For tests only: a wrong clock, and loss of datagrams.
        offset = params.number("clock_offset", 0.0, lowest=-1e9, highest=1e9)
        loss = params.number("loss", 0.0, highest=1.0)
        params.done()

        report_refused(generation, lambda text: rospy.logwarn("%s", text))
        self._ros = RosLoop()
        self._runner = SessionRunner(
            self._ros.loop, team, key, self._on_effect, lambda text: rospy.logwarn("%s", text), robot=robot,
            rsbb_host=host, rsbb_port=port, bind_host=bind_host, cipher=cipher,
            clock=lambda: time.time() + offset, passes=lambda: random.random() >= loss,
        )
        self._session = self._runner.session
        session = self._session
        self._interface = CommInterface(RobotRequests(
            end_prepare=lambda: self._ask(session.end_prepare),
            end_execute=lambda result: self._ask(lambda: session.end_execute(result)),
            add_string=lambda field, text: self._ask(lambda: session.add_string(field, text)),
            set_device=lambda name, value: self._ask(lambda: session.set_device(name, value)),
            display_map=lambda display: self._ask(lambda: session.display_map(display)),
            messages_saved=lambda count: self._ros.post(lambda: self._set_messages_saved(count)),
        ), types_of(generation))
        rospy.loginfo("Robot %s of team %s looks for the RSBB on %s:%d", robot, team, host, port)

    def run(self) -> int:
        """Run until shut down; returns the exit status."""
        self._runner.open()
        rospy.Service("/roah_rsbb/override", Override, self._on_override)
        rospy.Service("/roah_rsbb/override_goal", OverrideGoal, self._on_override_goal)
        self._ros.run()
        self._runner.close()
        self._interface.close()
        self._ros.close()
        return 0

    def _ask(self, action: Callable[[], None]) -> None:
        """Call the session in the loop's thread; effects are sent immediately."""

        def do() -> None:
            action()
            self._runner.wake()

        try:
            self._ros.call(do)
        except IllegalEvent as error:
            raise rospy.ServiceException(str(error)) from None

    def _set_messages_saved(self, count: int) -> None:
        self._session.progress.messages_saved = count

    def _on_effect(self, effect: fx.Effect) -> None:
        if isinstance(effect, fx.ProblemIs):
            log = rospy.loginfo if effect.over else rospy.logwarn
            log("%s", effect.text)
        elif isinstance(effect, fx.Stop):
            rospy.loginfo("Stop: %s", effect.why)
        elif isinstance(effect, fx.BenchmarkIs):
            self._set_messages_saved(0)  # the count belongs to one benchmark
        elif isinstance(effect, (fx.SendBeacon, fx.SendState, fx.WouldSendState)):
            self._debug(effect)
        self._interface.show(effect, self._session.progress.goal)

    @staticmethod
    def _debug(effect: fx.Effect) -> None:
        """Log what is sent, or would be sent without the override."""
        what = "Not sent, because of the override" if isinstance(effect, fx.WouldSendState) else "Sent"
        _sent_log.debug("%s: %s %s", what, type(effect.message).__name__, _OneLine(effect.message))

    def _on_override(self, request: object) -> OverrideResponse:
        self._override(lambda: override_message(
            request.benchmark_type, request.benchmark_state, _wire_time(request.acknowledgement),
            request.initial_state, request.switches,
        ))
        return OverrideResponse()

    def _on_override_goal(self, request: object) -> OverrideGoalResponse:
        self._override(lambda: override_goal_message(
            request.benchmark, request.benchmark_state, _wire_time(request.acknowledgement), request.goal,
        ))
        return OverrideGoalResponse()

    def _override(self, made: Callable[[], Optional[pb.BenchmarkState]]) -> None:
        self._ask(lambda: self._session.override(self._ros.loop.time(), made()))


def _wire_time(time: rospy.Time) -> WireTime:
    return time.secs, time.nsecs


def _password(params: Params) -> str:
    """Read the team's password. Raises ValueError if its file cannot be read."""
    file = os.path.expanduser(str(rospy.get_param("~rsbb_key_file", "")))
    if file:
        return password_in(file, lambda text: rospy.logwarn("%s", text))
    if rospy.has_param("~rsbb_key"):
        rospy.logwarn("Everybody on this ROS master can read the password in the parameter rsbb_key, and roslaunch "
                      "logs its arguments. Write the password into a file that only you can read (chmod 600), and set "
                      "rsbb_key_file to its path instead")
        key = params.secret("rsbb_key")
        return key[len(NOT_PRINTED):] if key.startswith(NOT_PRINTED) else key
    rospy.logerr("Set the parameter rsbb_key_file to a file with the team's password from the organisers, or rsbb_key "
                 "to the password. The default '%s' does not work in competitions", DEFAULT_KEY)
    return DEFAULT_KEY


class _OneLine:
    """A message as text, formatted only when needed."""

    def __init__(self, message: object) -> None:
        self._message = message

    def __str__(self) -> str:
        return text_format.MessageToString(self._message, as_one_line=True, as_utf8=True)


def main() -> None:
    """Entry point of the node."""
    run_node("roah_rsbb_comm", __doc__, CommNode, (BadParams, ValueError, OSError), disable_signals=True)
