"""Node roah_devices_dummy: a simulated SmartIF controller, and commands to operate it.

It prints the messages that it receives. The commands ring, open and close can be typed at its terminal, called as
services ~ring and ~door, or given as the argument of this program.

Parameters (private): bind_host (127.0.0.1), port (6665, TCP).
"""

import argparse
import logging
import sys
from typing import List

import rosgraph
import rospy
from std_srvs.srv import Empty, EmptyResponse

from roah_rsbb.devices.dummy_server import DummyServer
from roah_rsbb.ground.arguments import Parser
from roah_rsbb.ground.params import BadParams
from roah_rsbb.ros import connections
from roah_rsbb.ros.node import NodeParams, RosLoop
from roah_rsbb.srv import Bool, BoolResponse

NODE = "/roah_devices_dummy"
DOOR = "/devices/door_win_detect/mock"
WORDS = ("ring", "open", "close")
RETRY_S = 3.0

_log = logging.getLogger(__name__)


class DevicesDummyNode:
    """The node. Raises `BadParams` at the start."""

    def __init__(self) -> None:
        params = NodeParams()
        host = params.text("bind_host", "127.0.0.1")
        port = params.whole("port", 6665, 0, 65535)
        params.done()
        self._ros = RosLoop()
        self._server = DummyServer(host, port, lambda text: _log.info("%s", text))
        self._reported = ""

    def run(self) -> None:
        """Run until shut down."""
        self._opening = self._ros.loop.create_task(self._open())
        rospy.Service("~ring", Empty, self._ring)
        rospy.Service("~door", Bool, self._door)
        if sys.stdin is not None and sys.stdin.isatty():
            _log.info("Type %s", ", ".join(WORDS))
            self._ros.loop.add_reader(sys.stdin.fileno(), self._typed)
        self._ros.run()
        self._server.close()
        self._ros.close()

    async def _open(self) -> None:
        try:
            await self._server.open()
        except OSError as error:
            text = f"{self._server.host}:{self._server.port} cannot be opened: {error.strerror}"
            if text != self._reported:
                self._reported = text
                _log.error("%s. Choose another port (parameter ~port). Retrying every %.0f s", text, RETRY_S)
            self._ros.loop.call_later(RETRY_S, lambda: self._ros.loop.create_task(self._open()))
            return
        rospy.set_param("~served_port", self._server.port)
        _log.info("A dummy SmartIF controller is at %s:%d", self._server.host, self._server.port)

    def _ring(self, _request: object) -> EmptyResponse:
        if not self._ros.call(self._server.ring):
            raise rospy.ServiceException("no client is connected: check the node roah_devices")
        return EmptyResponse()

    @staticmethod
    def _door(request: object) -> BoolResponse:
        try:
            rospy.ServiceProxy(DOOR, Bool)(request.data)
        except rospy.ServiceException as error:
            raise rospy.ServiceException(f"the devices node refused it: {error}") from None
        return BoolResponse()

    def _typed(self) -> None:
        line = sys.stdin.readline()
        if not line:
            self._ros.loop.remove_reader(sys.stdin.fileno())
            return
        word = line.strip()
        if word in WORDS:
            # In another thread, because the call returns to the loop.
            self._ros.loop.run_in_executor(None, _operate_and_log, word, rospy.get_name())
        elif word:
            _log.warning("unknown command '%s': type %s", word, ", ".join(WORDS))


def operate(word: str, node: str = NODE) -> None:
    """Make a running dummy server ring its bell, or open or close its door; rospy.ServiceException on failure."""
    if word == "ring":
        rospy.ServiceProxy(f"{node}/ring", Empty)()
    else:
        rospy.ServiceProxy(f"{node}/door", Bool)(word == "open")


def _operate_and_log(word: str, node: str) -> None:
    try:
        operate(word, node)
    except rospy.ServiceException as error:
        _log.warning("%s", error)


def _words(arguments: List[str]) -> argparse.Namespace:
    parser = Parser("roah_devices_dummy", __doc__)
    parser.add_argument("word", nargs="?", choices=WORDS,
                        help="command for the running dummy server; without it: be the server")
    parser.add_argument("--node", default=NODE, help="name of the running node (default: %(default)s)")
    return parser.parse_args(arguments)


def main() -> None:
    """Entry point of the node, and of its commands."""
    options = _words(rospy.myargv()[1:])
    if options.word:
        if not rosgraph.is_master_online():
            sys.exit("roah_devices_dummy: no ROS master: start the launch file, or set ROS_MASTER_URI")
        try:
            operate(options.word, options.node)
        except rospy.ServiceException as error:
            sys.exit(f"roah_devices_dummy: {error}")
        return
    connections.init_node("roah_devices_dummy", disable_signals=True)
    try:
        DevicesDummyNode().run()
    except BadParams as error:
        for line in str(error).splitlines():
            _log.critical("%s", line)
        sys.exit(1)
