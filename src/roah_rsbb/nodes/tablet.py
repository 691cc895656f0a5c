"""Node roah_rsbb_tablet: serves the tablet's page to browsers, and sends touches to the box.

It works with missing parts: without a network or a free port it retries, and without a map there is still the call
button. It logs each problem once, with the remedy.

Parameters (private): rsbb_host, rsbb_port, bind_host; tablet_port (TCP, 0: any free one), tablet_host (address at which
it is served; default: all, or this computer's alone if rsbb_host is), map_file (as map_saver writes it).
"""

import asyncio
import os
from typing import Callable, Dict, Optional

import rospkg
import rospy

from roah_rsbb.comm import sockets
from roah_rsbb.ros.command_line import run_node
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.ros.params import Params
from roah_rsbb.tablet import maps
from roah_rsbb.tablet.pages import Pages
from roah_rsbb.tablet.radio import TabletRadio
from roah_rsbb.tablet.server import TabletServer
from roah_rsbb.tablet.state import TabletState

RETRY_S = 3.0
LOOPBACK = "127.0.0.1"


class TabletNode:
    """The node. Raises `BadParams` at the start."""

    def __init__(self) -> None:
        resource = os.path.join(rospkg.RosPack().get_path("roah_rsbb"), "resource")
        params = Params()
        self._rsbb_host = params.text("rsbb_host", "10.255.255.255")
        rsbb_port = params.whole("rsbb_port", 6666, 1, 65000)
        bind_host = params.text("bind_host", sockets.ANY_HOST)
        map_file = params.path("map_file", os.path.join(resource, "maps", "dummy.yaml"))
        self._tablet_port = params.whole("tablet_port", 8080, 0, 65535)
        everywhere = LOOPBACK if self._rsbb_host.startswith("127.") else sockets.ANY_HOST
        self._tablet_host = params.text("tablet_host", everywhere)
        params.done()

        self._ros = RosLoop()
        asyncio.set_event_loop(self._ros.loop)  # tornado uses the thread's loop
        self._reported: Dict[str, str] = {}
        plan = _load_map(map_file)
        state = TabletState()
        self._radio = TabletRadio(
            self._ros.loop, state, self._on_box, lambda text: rospy.logwarn("%s", text), self._rsbb_host, rsbb_port,
            bind_host,
        )
        self._server = TabletServer(
            self._ros.loop, Pages(state, plan), plan, os.path.join(resource, "tablet"),
            self._radio.changed, self._on_presence,
        )

    def run(self) -> None:
        """Run until shut down."""
        self._retry_until_open("radio", self._radio.open)
        self._retry_until_open("server", self._open_server)
        self._ros.run()
        self._server.close()
        self._radio.close()
        self._ros.close()

    def _retry_until_open(self, what: str, open_it: Callable[[], None]) -> None:
        try:
            open_it()
        except OSError as error:
            if self._reported.get(what) != str(error):
                self._reported[what] = str(error)
                rospy.logerr("%s. Retrying every %.0f s", error, RETRY_S)
            self._ros.loop.call_later(RETRY_S, self._retry_until_open, what, open_it)

    def _open_server(self) -> None:
        port = self._server.open(self._tablet_host, self._tablet_port)
        hosts = [self._tablet_host]
        if self._tablet_host == sockets.ANY_HOST:
            network = sockets.source_host(self._rsbb_host)
            hosts = [network, LOOPBACK] if network not in (None, LOOPBACK) else [LOOPBACK]
        addresses = [f"http://{host}:{port}/" for host in hosts]
        rospy.set_param("~url", addresses[0])
        rospy.loginfo("The tablet's page: open %s", " or, on this computer, ".join(addresses))

    def _on_box(self, changed: bool) -> None:
        if changed:
            self._server.publish()

    def _on_presence(self, there: bool) -> None:
        self._radio.present = there


def _load_map(map_file: str) -> Optional[maps.Map]:
    try:
        return maps.load(map_file)
    except maps.MapError as error:
        rospy.logerr("The tablet has no map: %s", error)
        return None


def main() -> None:
    """Entry point of the node."""
    run_node("roah_rsbb_tablet", __doc__, TabletNode, disable_signals=True)
