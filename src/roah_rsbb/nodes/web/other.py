"""A second gateway waits until the first one has ended: it would take over /web/pair, and the ROS master would even end
the first one if both have the same name."""

import socket
import sys
from typing import Any, Dict, Optional

import rosgraph
import rosgraph.names
import rosgraph.network
import rospy

from roah_rsbb.ros.live_core import wait_while

PAIR = "/web/pair"
# A gateway that does not answer within this time hangs, but may continue.
ANSWER_S = 2.0


def wait_for_other() -> None:
    """Return when no other gateway runs. Call it before the node is registered with the ROS master.

    Ends the process if it is interrupted before.
    """
    mappings = rosgraph.names.load_mappings(sys.argv)
    name = mappings.get("__name", "roah_rsbb_web")
    master = rosgraph.Master(name)
    if not _has_pages(master, name, mappings):
        return
    wait_while(lambda: running(master, mappings.get(PAIR, PAIR)),
               "roah_rsbb_web: another gateway is running: {other}. This one serves nothing and takes nothing over, "
               "but waits until that one has ended. If that is the wrong one, end it with 'rosnode kill {name}'",
               "roah_rsbb_web: the other gateway has ended")


def _has_pages(master: rosgraph.Master, name: str, mappings: Dict[str, Any]) -> bool:
    """Whether this gateway serves the pages; otherwise, only the tablet's page."""
    try:
        default = master.getParam(f"/{name}/web")
    except (rosgraph.MasterException, OSError):
        default = True
    return str(mappings.get("_web", default)).lower() != "false"


def running(master: rosgraph.Master, pair: str = PAIR) -> Optional[str]:
    """Return name and address of the gateway that runs; None: there is none, or no ROS master."""
    try:
        uri = master.lookupService(pair)
        provider = next((nodes[0] for name, nodes in master.getSystemState()[2] if name == pair and nodes), "a node")
        host, port = rospy.core.parse_rosrpc_uri(uri)
    except (rosgraph.MasterException, rospy.ROSException, OSError, ValueError):
        return None
    return f"{provider} at {host}" if _answers(host, port, pair) else None


def _answers(host: str, port: int, pair: str) -> bool:
    """Whether a gateway is there. One that was killed stays known to the master, and another program may have its
    port."""
    try:
        with socket.create_connection((host, port), ANSWER_S) as connection:
            rosgraph.network.write_ros_handshake_header(
                connection, {"callerid": "/roah_rsbb_web", "service": pair, "md5sum": "*", "probe": "1"})
            answer = connection.recv(65536)
    except socket.timeout:
        return True
    except OSError:
        return False
    return pair.encode() in answer and b"error=" not in answer
