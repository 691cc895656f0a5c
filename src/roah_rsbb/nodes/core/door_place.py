"""Where clients find the door of a box of ROS: in a file of its computer, and in a parameter (`client/places.py`)."""

import contextlib
import os
import threading
import time
import xmlrpc.client
from http.client import HTTPException
from typing import Callable

import rosgraph
import rospy

from roah_rsbb.box.box_door import BoxDoor
from roah_rsbb.client.places import PARAM, file_of
from roah_rsbb.document.place import NotFound, read_place, write_place
from roah_rsbb.web.serving import ANY_HOST, ServeError

RETRY_S = 1.0


class PublishedDoor:
    """The door of a node's box, and where it is."""

    def __init__(self, door: BoxDoor, on_path: Callable[[str], object] = lambda path: None) -> None:
        """`on_path` gets the path of the file, in a thread."""
        self._door, self._on_path = door, on_path
        self._path = ""  # of the file

    def open(self) -> None:
        """Let clients in, and publish where. Logs what prevents it, with the remedy: the original interface remains."""
        host = rosgraph.network.get_bind_address()
        try:
            port = self._door.open(host)
        except ServeError as error:
            rospy.logerr("No panel can follow this box: %s", error)
            return
        local, remote = "127.0.0.1" if host == ANY_HOST else host, rosgraph.network.get_host_name()
        _publish(lambda: rospy.set_param(PARAM, {"url": _url(remote, port), "token": self._door.token}))
        if rospy.resolve_name(PARAM) == PARAM:  # the file is that of the only box at this master
            _publish(lambda: self._write_place(_url(local, port)))

    def _write_place(self, url: str) -> None:
        self._path = file_of(rosgraph.get_master_uri())
        if self._path:
            write_place(self._path, url, self._door.token)
            self._on_path(self._path)

    def close(self) -> None:
        """End all connections. The file goes, so that nobody looks for a box that is over."""
        self._door.close()
        if self._path:
            with contextlib.suppress(OSError, NotFound):
                if read_place(self._path).token == self._door.token:  # another box may have written its own
                    os.unlink(self._path)


def _url(host: str, port: int) -> str:
    return f"ws://{host}:{port}/door"


def _publish(where: Callable[[], object]) -> None:
    """Publish where the door is, until it succeeds. In a thread, because a disk or a master may hang."""
    def run() -> None:
        while not rospy.is_shutdown():
            try:
                where()
                return
            except (OSError, rospy.ROSException, xmlrpc.client.Error, HTTPException) as error:
                rospy.logerr_throttle_identical(60.0, f"Some panels cannot find this box, which tries again: {error}")
                time.sleep(RETRY_S)

    threading.Thread(target=run, name="door", daemon=True).start()
