"""Node roah_rsbb_web: serves the public display and other pages to browsers, and live data to programs (docs/web.md).

Everything comes through the door of the box. Reading is open: it shows what is public. Devices that are paired may do
more. It can end and start again at any time. If its port is taken, it logs this once with the remedy, and retries.
While another gateway runs, it waits and changes nothing. It also serves the tablet's page, on a port of its own
(docs/tablet.md).

Parameters (private): web and tablet (what is served: the pages, and the tablet's page; default: only the pages);
rsbb_host. Of the pages: web_port (TCP, 0: any free one), web_host (address at which it is served; default: all, or this
computer's alone if rsbb_host is), web_names (further names of this computer, separated by spaces), title (of the
competition), log_dir (for the list of paired devices, for what displays show and for the codes of teams), team_pages
(who sees the state of a team's robot: all, or code), web_logos (folder with the logos of the teams; empty: none),
web_cert and web_key (PEM files of a certificate, see docs/web.md, "Encryption"; empty: the pages are not encrypted). Of
the tablet: rsbb_port, bind_host; tablet_port (TCP, 0: any free one), tablet_host (as web_host), map_file (as map_saver
writes it).
"""

import asyncio
import importlib.util
import pathlib
import sys
from typing import Any, Callable, List, Mapping

import rosgraph
import rosgraph.names
import rospkg
import rospy

from roah_rsbb.client.places import DoorPlaces
from roah_rsbb.document.calls import Call, Caller
from roah_rsbb.durable import close_to_others
from roah_rsbb.model.document import Document
from roah_rsbb.model.referee import Refused
from roah_rsbb.model.web_calls import WEB_CALLS
from roah_rsbb.ros.command_line import run_node
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.ros.params import NodeParams

NEWS_S = 60.0  # longest wait for news of the box


class WebNode:
    """The node. Raises `BadParams` at the start."""

    def __init__(self) -> None:
        # These need tornado; see `main`.
        from roah_rsbb.tablet.tablet_page import TabletPage
        from roah_rsbb.web.gateway import Gateway, GatewayHost

        resource = pathlib.Path(rospkg.RosPack().get_path("roah_rsbb"), "resource")
        params = NodeParams()
        has_pages, has_tablet = params.flag("web", True), params.flag("tablet", False)
        params.done()
        address = rosgraph.network.get_local_address()
        names = [*str(rospy.get_param("~web_names", "")).lower().split(), address]
        self._ros = RosLoop()
        asyncio.set_event_loop(self._ros.loop)  # tornado uses the thread's loop
        self._parts: List[Any] = []
        if has_pages:
            self._parts.append(Gateway(self._ros.loop, NodeParams(), GatewayHost(
                resource, rospy.get_name(), address, self._make_client,
                lambda url: rospy.set_param("~url", url), names)))
        if has_tablet:
            self._parts.append(TabletPage(self._ros.loop, NodeParams(), str(resource), names,
                                          lambda url: rospy.set_param("~tablet_url", url)))

    def _make_client(self, on_change: Callable[[], object], calls: Mapping[str, Call]) -> Any:
        from roah_rsbb.client.client import Client, Offer

        return Client(Document, DoorPlaces(rosgraph.get_master_uri()).find, on_change, self._ros.loop, "referee",
                      Offer(calls, rospy.get_name()))

    def run(self) -> None:
        """Run until shut down."""
        for part in self._parts:
            part.start()
        self._ros.run()
        for part in self._parts:
            part.stop()
        self._ros.close()


def wait_for_other() -> None:
    """Return when no other gateway offers its calls to the box. Call it before the node is registered with the ROS
    master, which would end the other one if both have the same name. Ends the process if it is interrupted before."""
    from roah_rsbb.client.client import NOT_OFFERED, Client, Offer

    mappings = rosgraph.names.load_mappings(sys.argv)
    name = mappings.get("__name", "roah_rsbb_web")
    if not _has_pages(name, mappings):
        return
    client: Client[Document] = Client(Document, DoorPlaces(rosgraph.get_master_uri()).find,
                                      offer=Offer({call: _starting for call in WEB_CALLS}, f"/{name}"))
    client.start()
    other, news = "", 0
    try:
        while client.not_offered and (other or not news or not client.why):  # without a box, nobody knows of another
            news = client.wait_news(news, NEWS_S)
            if client.not_offered not in ("", NOT_OFFERED, other):
                other = client.not_offered
                print(f"roah_rsbb_web: another gateway is running ({other}). This one serves nothing and takes nothing "
                      "over, but waits until that one has ended. If that is the wrong one, end it with 'rosnode kill "
                      f"{other.partition(' ')[0]}'", file=sys.stderr, flush=True)
    except KeyboardInterrupt:
        sys.exit(0)
    finally:
        client.close()
    if other:
        print("roah_rsbb_web: the other gateway has ended", file=sys.stderr, flush=True)


def _starting(found: Mapping[str, Any], caller: Caller) -> Any:
    raise Refused(["the web pages are just starting: try again"])


def _has_pages(name: str, mappings: Mapping[str, Any]) -> bool:
    """Whether this gateway serves the pages; otherwise, only the tablet's page."""
    try:
        default = rosgraph.Master(name).getParam(f"/{name}/web")
    except (rosgraph.MasterException, OSError):
        default = True
    return str(mappings.get("_web", default)).lower() != "false"


class WithoutTornado:
    """The node where tornado is missing. It waits: restarting it again and again would fill the log."""

    def run(self) -> None:
        """Log the remedy and run until shut down."""
        rospy.logfatal("The web pages need tornado: install it with 'sudo apt install python3-tornado', then restart "
                       "this node with 'rosnode kill %s'. Runs are not affected", rospy.get_name())
        loop = RosLoop()
        loop.run()
        loop.close()


def main() -> None:
    """Entry point of the node."""
    close_to_others()
    has_tornado = importlib.util.find_spec("tornado") is not None
    run_node("roah_rsbb_web", __doc__, WebNode if has_tornado else WithoutTornado,
             before=wait_for_other if has_tornado else lambda: None, disable_signals=True)
