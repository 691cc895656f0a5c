"""Where clients find the door of a box of ROS: in a file of its computer, and in a parameter (`client/places.py`)."""

import contextlib
import logging
import os
import threading
import time
from typing import Callable, NamedTuple

import rosgraph
import rospy

from roah_rsbb.box.box_door import BoxDoor
from roah_rsbb.client.places import PARAM, NotFound, file_of, read_place, write_place
from roah_rsbb.web.serving import ANY_HOST

RETRY_S = 1.0

_log = logging.getLogger(__name__)


class NodePlace(NamedTuple):
    """Where a node serves, as its environment and its arguments say."""

    bind: str
    remote: str  # its name for other computers
    door_file: str  # empty: the box has none, because its master is elsewhere, or has another box
    address: str  # in addresses of web pages


def place_of_node() -> NodePlace:
    """Return that of this node. Call it after `rospy.init_node`. Looks the master's name up, which may take seconds."""
    return NodePlace(rosgraph.network.get_bind_address(), rosgraph.network.get_host_name(),
                     file_of(rosgraph.get_master_uri()) if rospy.resolve_name(PARAM) == PARAM else "",
                     rosgraph.network.get_local_address())


def publish_door(place: NodePlace, door: BoxDoor, port: int) -> None:
    """Set the parameter, in a thread."""
    publish_param(PARAM, lambda: {"url": f"ws://{place.remote}:{port}/door", "token": door.token})


def publish_param(name: str, value: Callable[[], object]) -> None:
    """Set a parameter, until it succeeds. In a thread, because the master may hang. `value` may wait."""
    def run() -> None:
        said = ""
        while not rospy.is_shutdown():
            try:
                rospy.set_param(name, value())
                return
            except Exception as error:  # one of those of a master
                if str(error) != said:
                    said = str(error)
                    _log.error("Some panels cannot find this box, which tries again: %s", error)
                time.sleep(RETRY_S)

    threading.Thread(target=run, name=name, daemon=True).start()


class OpenDoor:
    """The door of a node that is no box, such as a replay."""

    def __init__(self, door: BoxDoor) -> None:
        self._door, self._place = door, place_of_node()

    def open(self) -> None:
        """Let clients in, and say where. Logs what prevents it: the original interface remains."""
        host, path = self._place.bind, self._place.door_file
        try:
            port = self._door.open(host)
            if path:
                write_place(path, f"ws://{'127.0.0.1' if host == ANY_HOST else host}:{port}/door", self._door.token)
            publish_door(self._place, self._door, port)
        except OSError as error:
            _log.error("Panels cannot follow this box: %s", error)

    def close(self) -> None:
        """End all connections. The file goes, unless another box has written its own."""
        self._door.close()
        with contextlib.suppress(OSError, NotFound):
            if self._place.door_file and read_place(self._place.door_file).token == self._door.token:
                os.unlink(self._place.door_file)
