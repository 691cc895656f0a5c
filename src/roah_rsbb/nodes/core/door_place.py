"""Where clients find the door of a box of ROS: in a file of its computer, and in a parameter (`client/places.py`)."""

import concurrent.futures
import contextlib
import logging
import os
import threading
import time
from typing import Callable, Mapping, NamedTuple, Sequence

from roah_rsbb.box.box_door import BoxDoor
from roah_rsbb.client.places import PARAM, door_file_in, file_of
from roah_rsbb.document.place import NotFound, read_place, write_place
from roah_rsbb.web.serving import ANY_HOST, ServeError

RETRY_S = 1.0
# The parameters with the addresses of web pages are below it.
PAGES = "/roah_rsbb_web"

_log = logging.getLogger(__name__)


class DoorHosts(NamedTuple):
    """Where a node serves, as its environment and its arguments say."""

    bind: str
    remote: str  # its name for other computers
    master_uri: str  # empty: the box has no file for it, because it is not the only one at this master
    address: str = ""  # in addresses of its web pages


def hosts_of_node() -> DoorHosts:
    """Return those of this node. Call it after `rospy.init_node`."""
    import rosgraph
    import rospy

    return DoorHosts(rosgraph.network.get_bind_address(), rosgraph.network.get_host_name(),
                     rosgraph.get_master_uri() if rospy.resolve_name(PARAM) == PARAM else "",
                     rosgraph.network.get_local_address())


class PublishedDoor:
    """The door of a node's box, and where it is. Only `publish` needs ROS."""

    def __init__(self, door: BoxDoor, hosts: DoorHosts, known: Sequence[str] = (),
                 on_paths: Callable[[Sequence[str]], object] = lambda paths: None, log_dir: str = "") -> None:
        """`known`: the paths of the files, if the box had them before. `on_paths` gets them, in a thread. `log_dir`:
        there is another file, for what belongs to the box; empty: there is none."""
        self._door, self._hosts, self._on_paths, self._log_dir = door, hosts, on_paths, log_dir
        self._paths: Sequence[str] = known
        self._port = 0
        self._is_closed = False

    def open(self) -> None:
        """Let clients in, and say in files where. Logs what prevents it, with the remedy: the original interface
        remains."""
        host = self._hosts.bind
        try:
            self._port = self._door.open(host)
        except ServeError as error:
            _log.error("No panel can follow this box: %s", error)
            return
        if self._hosts.master_uri or self._log_dir:
            self._publish(lambda: self._write_places(_url("127.0.0.1" if host == ANY_HOST else host, self._port)))

    def publish(self) -> None:
        """Set the parameter. In any thread, after `open` and `rospy.init_node`."""
        import rospy

        if self._port:
            self._publish(lambda: rospy.set_param(
                PARAM, {"url": _url(self._hosts.remote, self._port), "token": self._door.token}))

    def publish_pages(self, urls: Mapping[str, "concurrent.futures.Future[str]"]) -> None:
        """Set the parameters with the addresses of web pages when these are served. As `publish`."""
        import rospy

        for name, url in urls.items():
            self._publish(lambda name=name, url=url: rospy.set_param(f"{PAGES}/{name}", url.result()))

    def _write_places(self, url: str) -> None:
        self._paths = self._paths or [path for path in (
            file_of(self._hosts.master_uri) if self._hosts.master_uri else "",
            door_file_in(self._log_dir) if self._log_dir else "") if path]
        for path in self._paths:
            write_place(path, url, self._door.token)
        self._on_paths(self._paths)

    def close(self) -> None:
        """End all connections. The file goes, so that nobody looks for a box that is over."""
        self._is_closed = True
        self._door.close()
        for path in self._paths:
            with contextlib.suppress(OSError, NotFound):
                if read_place(path).token == self._door.token:  # another box may have written its own
                    os.unlink(path)

    def _publish(self, where: Callable[[], object]) -> None:
        """Publish where the door is, until it succeeds. In a thread, because a disk or a master may hang."""
        def run() -> None:
            said = ""
            while not self._is_closed:
                try:
                    where()
                    return
                except Exception as error:  # of a disk, of a name server, or one of those of a master
                    if str(error) != said:
                        said = str(error)
                        _log.error("Some panels cannot find this box, which tries again: %s", error)
                    time.sleep(RETRY_S)

        threading.Thread(target=run, name="door", daemon=True).start()


def _url(host: str, port: int) -> str:
    return f"ws://{host}:{port}/door"
