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
import datetime
import importlib.util
import pathlib
from typing import Any, List, Set

import rosgraph
import rospkg
import rospy

from roah_rsbb.client.places import DoorPlaces
from roah_rsbb.comm import sockets
from roah_rsbb.durable import close_to_others
from roah_rsbb.model.document import Document
from roah_rsbb.nodes.web.opening import LOOPBACK, hosts_of, retry_until_open
from roah_rsbb.nodes.web.other import wait_for_other
from roah_rsbb.params import BadParams, Params
from roah_rsbb.ros.command_line import run_node
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.ros.params import NodeParams
from roah_rsbb.web.displays.listed import FILE as DISPLAYS_FILE
from roah_rsbb.web.displays.listed import Displays
from roah_rsbb.web.kept_file import open_kept
from roah_rsbb.web.limits import own_names
from roah_rsbb.web.pairing import FILE as SESSIONS_FILE
from roah_rsbb.web.pairing import Sessions
from roah_rsbb.web.store import Store
from roah_rsbb.web.teams.codes import FILE as CODES_FILE
from roah_rsbb.web.teams.codes import TeamCodes
from roah_rsbb.wording import catalogues

# How often it is checked why the pages show nothing new.
WHY_S = 5.0
# How often the files of the certificate are checked.
CERTIFICATE_S = 60.0


class WebPart:
    """Serves the pages."""

    def __init__(self, ros: RosLoop, params: Params, resource: pathlib.Path, names: list) -> None:
        """`resource`: the folder with the pages and languages; `names`: further names of this computer."""
        # These need tornado; see `main`.
        from roah_rsbb.client.client import Client
        from roah_rsbb.nodes.web.pairing import PairingServices
        from roah_rsbb.web.calls import PageCalls
        from roah_rsbb.web.displays.logos import read_logos
        from roah_rsbb.web.server import WebServer
        from roah_rsbb.web.teams.requests import CODE, TEAM_PAGES

        self._rsbb_host = params.text("rsbb_host", "10.255.255.255")
        everywhere = LOOPBACK if self._rsbb_host.startswith("127.") else sockets.ANY_HOST
        self._host = params.text("web_host", everywhere)
        self._port = params.whole("web_port", 8081, 0, 65535)
        title = str(rospy.get_param("~title", ""))
        log_dir = params.path("log_dir", "~/.ros/roah_rsbb")
        files = [params.path(name) if rospy.get_param(f"~{name}", "") else "" for name in ("web_cert", "web_key")]
        logos = params.path("web_logos") if rospy.get_param("~web_logos", "") else ""
        team_pages = params.choice("team_pages", CODE, list(TEAM_PAGES))
        params.done()
        if any(files) and not all(files):
            raise BadParams("web_cert and web_key belong together: give both, or none of them")

        self._ros = ros
        self._reported = ""  # of the certificate
        sessions = open_kept(log_dir, SESSIONS_FILE, Sessions, [], rospy.logerr, "pair the devices again")
        team_codes = open_kept(log_dir, CODES_FILE, TeamCodes, {}, rospy.logerr, "the teams have new codes")
        displays = open_kept(log_dir, DISPLAYS_FILE, Displays, {}, rospy.logerr, "set what the displays show again")
        self._certificate = _certificate(*files) if all(files) else None
        self._client: Client[Document] = Client(
            Document, DoorPlaces(rosgraph.get_master_uri()).find, lambda: self._server.follow(), self._ros.loop,
            "referee")
        store = Store(
            self._client, _languages(resource / "languages"), title, logos=read_logos(logos, rospy.logwarn))
        self._why: Set[str] = set()  # it was not connected; these were logged
        self._server = WebServer(self._ros.loop, store, str(resource / "web"), own_names(names), sessions,
                                 PageCalls(self._client, rospy.get_name()).carry_out,
                                 self._certificate and self._certificate.context, displays, team_codes, team_pages)
        self._url = ""  # for paired devices
        PairingServices(self._ros, self._server, self._server.desk.zones, lambda: self._url)

    def start(self) -> None:
        """Serve as soon as that is possible."""
        self._client.start()
        self._ros.loop.call_later(WHY_S, self._say_why)
        retry_until_open(self._ros.loop, self._open)

    def stop(self) -> None:
        """End."""
        self._server.close()
        self._client.close()

    def _say_why(self) -> None:
        """Log once why there is nothing new of the box."""
        self._ros.loop.call_later(WHY_S, self._say_why)
        why = self._client.why
        if not why:
            self._why.clear()
        elif why not in self._why:
            self._why.add(why)
            rospy.logwarn("The pages show nothing new, and paired devices cannot act: %s", why)

    def _open(self) -> None:
        if self._certificate is not None:
            self._certificate.renew()
        port = self._server.open(self._host, self._port)
        scheme = "http" if self._certificate is None else "https"
        addresses = [f"{scheme}://{host}:{port}/" for host in hosts_of(self._host, self._rsbb_host)]
        self._url = f"{scheme}://{self._referees_host()}:{port}/"
        rospy.set_param("~url", addresses[0])
        rospy.loginfo("The web pages: open %s", " or, on this computer, ".join(addresses))
        if self._certificate is not None:
            self._check_certificate()

    def _check_certificate(self) -> None:
        """Load a certificate that was replaced, and report once what is wrong with it."""
        self._ros.loop.call_later(CERTIFICATE_S, self._check_certificate)
        try:
            if self._certificate.renew():
                rospy.loginfo("The web pages use the new certificate")
            trouble = self._certificate.trouble(datetime.datetime.utcnow(), self._referees_host())
        except OSError as error:
            trouble = f"{error}. The certificate before it stays in use"
        if trouble and trouble != self._reported:
            rospy.logerr("The web pages: %s", trouble)
        self._reported = trouble

    def _referees_host(self) -> str:
        """The address of this computer for referees: that of ROS. The firewall may keep out the robots' network."""
        host = rosgraph.network.get_local_address()
        is_local = host == "localhost" or host.startswith("127.")
        if is_local or self._host != sockets.ANY_HOST:
            return hosts_of(self._host, self._rsbb_host)[0]
        return host


def _languages(folder: pathlib.Path) -> dict:
    """The languages of the files, by name."""
    return {path.stem: catalogues.translation(path.stem, catalogues.read(path)) for path in sorted(folder.glob("*.ts"))}


def _certificate(certificate: str, key: str) -> Any:
    from roah_rsbb.web.certificate import Certificate, CertificateFiles  # needs cryptography, which takes memory

    return Certificate(CertificateFiles(certificate, key))


class WebNode:
    """The node. Raises `BadParams` at the start."""

    def __init__(self) -> None:
        from roah_rsbb.nodes.web.tablet import TabletPart  # needs tornado; see `main`

        resource = pathlib.Path(rospkg.RosPack().get_path("roah_rsbb"), "resource")
        params = NodeParams()
        has_pages, has_tablet = params.flag("web", True), params.flag("tablet", False)
        params.done()
        names = [*str(rospy.get_param("~web_names", "")).lower().split(), rosgraph.network.get_local_address()]
        self._ros = RosLoop()
        asyncio.set_event_loop(self._ros.loop)  # tornado uses the thread's loop
        self._parts: List[Any] = [WebPart(self._ros, NodeParams(), resource, names)] if has_pages else []
        if has_tablet:
            self._parts.append(TabletPart(self._ros, NodeParams(), str(resource), names))

    def run(self) -> None:
        """Run until shut down."""
        for part in self._parts:
            part.start()
        self._ros.run()
        for part in self._parts:
            part.stop()
        self._ros.close()


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
             before=wait_for_other, disable_signals=True)
