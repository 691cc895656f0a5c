"""Node roah_devices_dummy: a SmartIF controller that only pretends, and the commands to operate it.

It prints what it is told. At a terminal it takes ring, open and close; so do its services ~ring and ~door, and
this program with such a word.

Parameters (private): bind_host (127.0.0.1), port (6665, TCP).
"""

import argparse
import sys
from typing import List

import rosgraph
import rospy
from std_srvs.srv import Empty, EmptyResponse

from roah_rsbb.devices.dummy_server import DummyServer
from roah_rsbb.ros import connections
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.ros.params import BadParams, Params
from roah_rsbb.srv import Bool, BoolResponse

NODE = "/roah_devices_dummy"
DOOR = "/devices/door_win_detect/mock"
WORDS = ("ring", "open", "close")
RETRY_S = 3.0


class DevicesDummyNode:
    """The node, from its parameters to its end. Raises `BadParams` at the start."""

    def __init__(self) -> None:
        params = Params()
        host = params.text("bind_host", "127.0.0.1")
        port = params.whole("port", 6665, 0, 65535)
        params.done()
        self._ros = RosLoop()
        self._server = DummyServer(host, port, lambda text: rospy.loginfo("%s", text))
        self._told = ""

    def run(self) -> None:
        """Run until shut down."""
        self._opening = self._ros.loop.create_task(self._open())
        rospy.Service("~ring", Empty, self._ring)
        rospy.Service("~door", Bool, self._door)
        if sys.stdin is not None and sys.stdin.isatty():
            rospy.loginfo("Type %s", ", ".join(WORDS))
            self._ros.loop.add_reader(sys.stdin.fileno(), self._typed)
        self._ros.run()
        self._server.close()
        self._ros.close()

    async def _open(self) -> None:
        try:
            await self._server.open()
        except OSError as error:
            text = f"{self._server.host}:{self._server.port} cannot be served: {error.strerror}"
            if text != self._told:
                self._told = text
                rospy.logerr("%s. Set another port (parameter ~port); trying again every %.0f s", text, RETRY_S)
            self._ros.loop.call_later(RETRY_S, lambda: self._ros.loop.create_task(self._open()))
            return
        rospy.set_param("~served_port", self._server.port)
        rospy.loginfo("A dummy SmartIF controller is at %s:%d", self._server.host, self._server.port)

    def _ring(self, _request: object) -> EmptyResponse:
        if not self._ros.call(self._server.ring):
            raise rospy.ServiceException("nobody is connected who could hear the bell: look at the node roah_devices")
        return EmptyResponse()

    @staticmethod
    def _door(request: object) -> BoolResponse:
        try:
            rospy.ServiceProxy(DOOR, Bool)(request.data)
        except rospy.ServiceException as error:
            raise rospy.ServiceException(f"the devices node does not take it: {error}") from None
        return BoolResponse()

    def _typed(self) -> None:
        line = sys.stdin.readline()
        if not line:
            self._ros.loop.remove_reader(sys.stdin.fileno())
            return
        word = line.strip()
        if word in WORDS:
            # Off the loop: the call comes back into it.
            self._ros.loop.run_in_executor(None, _operate_and_tell, word, rospy.get_name())
        elif word:
            rospy.logwarn("there is no '%s': type %s", word, ", ".join(WORDS))


def operate(word: str, node: str = NODE) -> None:
    """Have a dummy server that runs ring its bell, or open or close its door; rospy.ServiceException if not."""
    if word == "ring":
        rospy.ServiceProxy(f"{node}/ring", Empty)()
    else:
        rospy.ServiceProxy(f"{node}/door", Bool)(word == "open")


def _operate_and_tell(word: str, node: str) -> None:
    try:
        operate(word, node)
    except rospy.ServiceException as error:
        rospy.logwarn("%s", error)


def _words(arguments: List[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="roah_devices_dummy", description=__doc__)
    parser.add_argument("word", nargs="?", choices=WORDS,
                        help="have the dummy server that runs do this; without it: be that server")
    parser.add_argument("--node", default=NODE, help="the name of the node that runs (default: %(default)s)")
    return parser.parse_args(arguments)


def main() -> None:
    """Entry point of the node, and of its commands."""
    options = _words(rospy.myargv()[1:])
    if options.word:
        if not rosgraph.is_master_online():
            sys.exit("roah_devices_dummy: no ROS master answers: start the launch file, or set ROS_MASTER_URI")
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
            rospy.logfatal("%s", line)
        sys.exit(1)
