"""Each part of what the core has of ROS fails by itself: the others work, and the log says what does not."""

import os
import pathlib
import tempfile
import threading
import xmlrpc.client
from socketserver import ThreadingMixIn
from typing import Any, Tuple
from xmlrpc.server import SimpleXMLRPCServer

import rosgraph
import rospy
from support.box_case import NetworkCase
from support.own_core import OTHER_CORE, PARAMS
from support.programs import Program, own
from support.waiting import wait_until

from roah_rsbb.srv import Zone


class _Server(ThreadingMixIn, SimpleXMLRPCServer):
    daemon_threads = True


class RefusingMaster:
    """A ROS master that registers no service of one node; it asks the real one all else."""

    def __init__(self, refused: str) -> None:
        self._refused, self._real = refused, os.environ["ROS_MASTER_URI"]
        self._server = _Server(("127.0.0.1", 0), logRequests=False, allow_none=True)
        self.uri = f"http://127.0.0.1:{self._server.server_address[1]}"
        self._server.register_instance(self)
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def _dispatch(self, method: str, given: Tuple[Any, ...]) -> Any:
        if (method, given[0]) == ("registerService", self._refused):
            return -1, "refused by the test", 0
        return getattr(xmlrpc.client.ServerProxy(self._real), method)(*given)

    def close(self) -> None:
        self._server.shutdown()
        self._server.server_close()


class TestParts(NetworkCase):
    def test_without_the_home_devices_in_ros_all_else_is_there(self) -> None:
        master = self._leaving(RefusingMaster("/roah_devices"))
        rospy.set_param("/roah_devices/smartif_host", "127.0.0.1")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        core = self._leaving(Program(own("roah_rsbb_core"), "--unsupervised", *OTHER_CORE, *(
            f"_{name}:={value}" for name, value in {
                **PARAMS, "log_dir": pathlib.Path(folder.name, "log"), "devices": True}.items()),
            ROS_MASTER_URI=master.uri, ROS_HOME=folder.name))
        stop = rospy.ServiceProxy("/other/core/stop", Zone)
        wait_until(lambda: "/other/core/stop" in dict(rosgraph.Master("/test").getSystemState()[2]),
                   lambda: f"its services are there; it printed\n{core.text}")
        with self.assertRaisesRegex(rospy.ServiceException, "nothing to stop"):
            stop("Home")
        wait_until(lambda: rospy.has_param("/other/roah_rsbb_door"), lambda: f"its door is; it printed\n{core.text}")
        wait_until(lambda: "ROS: the home devices cannot be used" in core.text, lambda: f"it says so: {core.text}")
        self.assertIn("/other/core/to_gui", dict(rosgraph.Master("/test").getSystemState()[0]))
