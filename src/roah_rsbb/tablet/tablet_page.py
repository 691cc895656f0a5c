"""The tablet's page: serves it on a port of its own, and sends touches to the box (docs/tablet.md).

It works with missing parts: without a network or a free port it retries, and without a map it offers only the call
button.
"""

import asyncio
import logging
import os
from typing import Callable, Iterable, Optional

from roah_rsbb.comm import sockets
from roah_rsbb.comm.channels import MakePeer, Network
from roah_rsbb.ground.params import Params
from roah_rsbb.tablet import maps
from roah_rsbb.tablet.pages import Pages
from roah_rsbb.tablet.radio import TabletRadio
from roah_rsbb.tablet.server import TabletServer
from roah_rsbb.tablet.state import ShownTablet
from roah_rsbb.web.limits import own_names
from roah_rsbb.web.opening import LOOPBACK, hosts_of, retry_until_open

_log = logging.getLogger(__name__)


class TabletPage:
    """Serves the tablet's page. Call everything in the loop's thread."""

    def __init__(self, loop: asyncio.AbstractEventLoop, params: Params, resource: str, names: Iterable[str],
                 publish_url: Callable[[str], None], make_peer: Optional[MakePeer] = None) -> None:
        """`resource`: the folder with the page and the default map; `names`: further names of this computer.
        `publish_url` is called with the page's address, once it is served. `make_peer` replaces `Peer`, for another
        network. Raises `BadParams`."""
        self._loop, self._publish_url = loop, publish_url
        self._rsbb_host = params.text("rsbb_host", "10.255.255.255")
        rsbb_port = params.whole("rsbb_port", 6666, 1, 65000)
        bind_host = params.text("bind_host", sockets.ANY_HOST)
        map_file = params.path("map_file", os.path.join(resource, "maps", "dummy.yaml"))
        self._port = params.whole("tablet_port", 8080, 0, 65535)
        everywhere = LOOPBACK if self._rsbb_host.startswith("127.") else sockets.ANY_HOST
        self._host = params.text("tablet_host", everywhere)
        params.done()
        plan = _load_map(map_file)
        state = ShownTablet()
        self._radio = TabletRadio(
            loop, state, self._on_box, lambda text: _log.warning("%s", text),
            Network(self._rsbb_host, rsbb_port, bind_host), make_peer,
        )
        self._server = TabletServer(
            loop, Pages(state, plan), plan, os.path.join(resource, "tablet"), own_names(names),
            self._radio.changed, self._on_presence,
        )

    def start(self) -> None:
        """Serve as soon as that is possible."""
        retry_until_open(self._loop, self._radio.open)
        retry_until_open(self._loop, self._open_server)

    def stop(self) -> None:
        """Stop serving, and stop sending to the box."""
        self._server.close()
        self._radio.close()

    def _open_server(self) -> None:
        port = self._server.open(self._host, self._port)
        addresses = [f"http://{host}:{port}/" for host in hosts_of(self._host, self._rsbb_host)]
        self._publish_url(addresses[0])
        _log.info("The tablet's page: open %s", " or, on this computer, ".join(addresses))

    def _on_box(self, changed: bool) -> None:
        if changed:
            self._server.publish()

    def _on_presence(self, there: bool) -> None:
        self._radio.present = there


def _load_map(map_file: str) -> Optional[maps.Map]:
    try:
        return maps.load(map_file)
    except maps.MapError as error:
        _log.error("The tablet has no map: %s", error)
        return None
