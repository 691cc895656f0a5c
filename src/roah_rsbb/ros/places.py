"""Where the box is in a ROS network: the core that runs at the ROS master, and how clients find its door.

A second core would take the place of the first one, and clients would lose their box. The door is found in a file of
the box's computer, and in a parameter (`client/places.py`).
"""

import logging
import socket
import sys
import threading
import time
import xmlrpc.client
from http.client import HTTPConnection, HTTPException
from typing import Any, Callable, NamedTuple, Optional
from xml.parsers.expat import ExpatError

import rosgraph
import rosgraph.names
import rospy

from roah_rsbb.client.places import PARAM, file_of

GUI_TOPIC = "/core/to_gui"
CORE = "roah_rsbb_core"  # name of the core's node
REPLAY = "/roah_rsbb_replay"  # the node that shows an earlier run; it ends when a core starts
ANSWER_S = 5.0
LOOK_S = 1.0
RETRY_S = 1.0

_log = logging.getLogger(__name__)


def live_core(name: str, answer_s: float, if_silent: bool, topic: str = GUI_TOPIC) -> Optional[str]:
    """Return the node that publishes the core's topics, other than a replay; None: there is none. Raises OSError.

    `name`: of the caller. `if_silent`: whether a core counts that does not answer within `answer_s` seconds.
    """
    master = rosgraph.Master(name)
    nodes = (node for one, nodes in master.getSystemState()[0] if one == topic for node in nodes)
    others = (node for node in nodes if node != REPLAY)
    return next((node for node in others if _publishes(master, node, answer_s, if_silent, topic)), None)


def wait_for_other_core(on_look: Callable[[], object]) -> None:
    """Return when no other core answers at this master: one that hangs still has the journal, which says how to end
    it. Call it before the node is registered there. Ends the process if it is interrupted before. `on_look` is called
    whenever it looks."""
    topic = rosgraph.names.resolve_name(rosgraph.names.load_mappings(sys.argv).get(GUI_TOPIC, GUI_TOPIC), "/")

    def other() -> Optional[str]:
        on_look()
        try:
            return live_core("/roah_rsbb_core", ANSWER_S, False, topic)
        except (OSError, rosgraph.MasterException):  # the node waits for the master, or reports why not
            return None

    wait_while(other, "roah_rsbb_core: the core {name} is running at this ROS master. This one takes nothing over, but "
                      "waits until that one has ended. If that is the wrong one, end it: 'rosnode kill {name}'. For a "
                      "second box, use another ROS master", "roah_rsbb_core: the other core has ended")


def wait_while(find: Callable[[], Optional[str]], waits: str, ended: str) -> None:
    """Return when nothing is found any more. `find` returns the node that is waited for, and after a space what else is
    known of it. If there is one, `waits` is printed ({other}: all of that, {name}: the node), and `ended` at the end.
    Ends the process if it is interrupted before."""
    reported = ""
    try:
        while True:
            other = find()
            if other is None:
                break
            if other != reported:
                reported = other
                print(waits.format(other=other, name=other.partition(" ")[0]), file=sys.stderr, flush=True)
            time.sleep(LOOK_S)
    except KeyboardInterrupt:
        sys.exit(0)
    if reported:
        print(ended, file=sys.stderr, flush=True)


class _Impatient(xmlrpc.client.Transport):
    """Calls time out."""

    def __init__(self, answer_s: float) -> None:
        super().__init__()
        self._answer_s = answer_s

    def make_connection(self, host: Any) -> HTTPConnection:
        connection = super().make_connection(host)
        connection.timeout = self._answer_s
        return connection


def _publishes(master: rosgraph.Master, node: str, answer_s: float, if_silent: bool, topic: str) -> bool:
    """Whether a node publishes the core's topics. The master also lists nodes that have crashed. Another process,
    even this one, may now use the port of such a node."""
    try:
        uri = master.lookupNode(node)
        if uri == rospy.get_node_uri():
            return False
        topics = xmlrpc.client.ServerProxy(uri, _Impatient(answer_s)).getPublications(REPLAY)[2]
        return topic in [name for name, _ in topics]
    except socket.timeout:
        return if_silent  # it hangs, or its network does, or this computer is very busy
    except (OSError, HTTPException, xmlrpc.client.Error, ExpatError, ValueError, TypeError, rosgraph.MasterException):
        return False


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


def publish_door(place: NodePlace, port: int, token: str) -> None:
    """Set the parameter, in a thread."""
    publish_param(PARAM, lambda: {"url": f"ws://{place.remote}:{port}/door", "token": token})


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
