"""A ROS master that refuses calls from web pages, and that silent connections do not block.

Start it before the launch file, which then uses it:

    rosrun roah_rsbb protected_master

A page in a browser on any computer that reaches an ordinary master can make the browser send calls that end nodes or
redirect their services. In all other respects it is the master of ROS. ROS_MASTER_URI sets its port.
"""

import signal
import sys

import rosgraph
import rosmaster.main
from rosgraph.network import parse_http_host_and_port
from rosgraph.rosenv import DEFAULT_MASTER_PORT

from roah_rsbb.ros import connections
from roah_rsbb.ros.node import explain


def main() -> None:
    """Run the program."""
    explain(__doc__, "")
    uri = rosgraph.get_master_uri()
    _, port = parse_http_host_and_port(uri)
    if rosgraph.is_master_online():
        print(f"protected_master: another ROS master runs at {uri}: end it first", file=sys.stderr)
        sys.exit(1)
    connections.protect()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    rosmaster.main.rosmaster_main(["rosmaster", "--core", "-p", str(port or DEFAULT_MASTER_PORT)])
