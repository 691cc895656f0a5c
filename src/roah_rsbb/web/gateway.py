"""The gateway: serves the public display and other pages to browsers, and live data to programs (docs/web.md).

A box runs it in its own process (`WebParts` in `box/program/parts.py`).
"""

import asyncio
import datetime
import logging
import pathlib
from typing import Any, Callable, Iterable, Mapping, NamedTuple, Set

from roah_rsbb.comm import sockets
from roah_rsbb.document.calls import Call
from roah_rsbb.ground.params import BadParams, Params
from roah_rsbb.web.calls import BoxCommanded, PageCalls
from roah_rsbb.web.displays.listed import FILE as DISPLAYS_FILE
from roah_rsbb.web.displays.listed import Displays
from roah_rsbb.web.displays.logos import read_logos
from roah_rsbb.web.kept_file import open_kept
from roah_rsbb.web.limits import own_names
from roah_rsbb.web.opening import LOOPBACK, hosts_of, retry_until_open
from roah_rsbb.web.pairing import FILE as SESSIONS_FILE
from roah_rsbb.web.pairing import Sessions
from roah_rsbb.web.pairing_calls import PairingCalls
from roah_rsbb.web.server import WebServer
from roah_rsbb.web.store import Store
from roah_rsbb.web.teams.codes import FILE as CODES_FILE
from roah_rsbb.web.teams.codes import TeamCodes
from roah_rsbb.web.teams.requests import CODE, TEAM_PAGES
from roah_rsbb.wording import language

# How often it is checked why the pages show nothing new.
WHY_S = 5.0
# How often the files of the certificate are checked.
CERTIFICATE_S = 60.0

_log = logging.getLogger(__name__)


class GatewayHost(NamedTuple):
    """What a program gives the gateway that it runs."""

    resource: pathlib.Path  # the folder with the pages and languages
    name: str  # of this program, for the box's records
    address: str  # of this computer, for referees
    # Makes the client of the box, or what stands for one in the box's process. It gets what is called in the loop's
    # thread after each change, and the gateway's calls, by name.
    make_client: Callable[[Callable[[], object], Mapping[str, Call]], BoxCommanded]
    publish_url: Callable[[str], None]  # gets the pages' address, once they are served
    names: Iterable[str] = ()  # further names of this computer


class Gateway:
    """Serves the pages. Call everything in the loop's thread."""

    def __init__(self, loop: asyncio.AbstractEventLoop, params: Params, host: GatewayHost) -> None:
        """Raises `BadParams`."""
        self._rsbb_host = params.text("rsbb_host", "10.255.255.255")
        everywhere = LOOPBACK if self._rsbb_host.startswith("127.") else sockets.ANY_HOST
        self._host = params.text("web_host", everywhere)
        self._port = params.whole("web_port", 8081, 0, 65535)
        title = params.text("title", "")
        log_dir = params.path("log_dir", "~/.ros/roah_rsbb")
        files = [params.path(name, "") for name in ("web_cert", "web_key")]
        logos = params.path("web_logos", "")
        team_pages = params.choice("team_pages", CODE, list(TEAM_PAGES))
        params.done()
        if any(files) and not all(files):
            raise BadParams("web_cert and web_key belong together: give both, or none of them")

        self._loop, self._around = loop, host
        self._reported = ""  # of the certificate
        sessions = open_kept(log_dir, SESSIONS_FILE, Sessions, [], _log.error, "pair the devices again")
        team_codes = open_kept(log_dir, CODES_FILE, TeamCodes, {}, _log.error, "the teams have new codes")
        displays = open_kept(log_dir, DISPLAYS_FILE, Displays, {}, _log.error, "set what the displays show again")
        self._certificate = _certificate(*files) if all(files) else None
        self._url = ""  # for paired devices
        calls = PairingCalls(loop, lambda: self._server, lambda: self._url)
        self._client = host.make_client(lambda: self._server.follow(), calls.named())
        languages = language.translations(sorted((host.resource / "languages").glob("*.ts")))
        store = Store(self._client, languages, title, logos=read_logos(logos, _log.warning))
        self._why: Set[str] = set()  # it was not connected; these were logged
        self._server = WebServer(loop, store, str(host.resource / "web"), own_names(host.names), sessions,
                                 PageCalls(self._client, host.name).carry_out,
                                 self._certificate and self._certificate.context, displays, team_codes, team_pages,
                                 calls.named())

    def start(self) -> None:
        """Serve as soon as that is possible."""
        self._client.start()
        self._loop.call_later(WHY_S, self._say_why)
        retry_until_open(self._loop, self._open)

    def stop(self) -> None:
        """End."""
        self._server.close()
        self._client.close()

    def _say_why(self) -> None:
        """Log once why there is nothing new of the box."""
        self._loop.call_later(WHY_S, self._say_why)
        why = self._client.why
        if not why:
            self._why.clear()
        elif why not in self._why:
            self._why.add(why)
            _log.warning("The pages show nothing new, and paired devices cannot act: %s", why)

    def _open(self) -> None:
        if self._certificate is not None:
            self._certificate.renew()
        port = self._server.open(self._host, self._port)
        scheme = "http" if self._certificate is None else "https"
        addresses = [f"{scheme}://{host}:{port}/" for host in hosts_of(self._host, self._rsbb_host)]
        self._url = f"{scheme}://{self._referees_host()}:{port}/"
        self._around.publish_url(addresses[0])
        _log.info("The web pages: open %s", " or, on this computer, ".join(addresses))
        if self._certificate is not None:
            self._check_certificate()

    def _check_certificate(self) -> None:
        """Load a certificate that was replaced, and report once what is wrong with it."""
        self._loop.call_later(CERTIFICATE_S, self._check_certificate)
        try:
            if self._certificate.renew():
                _log.info("The web pages use the new certificate")
            trouble = self._certificate.trouble(datetime.datetime.utcnow(), self._referees_host())
        except OSError as error:
            trouble = f"{error}. The certificate before it stays in use"
        if trouble and trouble != self._reported:
            _log.error("The web pages: %s", trouble)
        self._reported = trouble

    def _referees_host(self) -> str:
        """The address of this computer for referees. The firewall may keep out the robots' network."""
        host = self._around.address
        is_local = host == "localhost" or host.startswith("127.")
        if is_local or self._host != sockets.ANY_HOST:
            return hosts_of(self._host, self._rsbb_host)[0]
        return host


def _certificate(certificate: str, key: str) -> Any:
    # It needs cryptography, which takes memory.
    from roah_rsbb.web.encryption.certificate import Certificate, CertificateFiles

    return Certificate(CertificateFiles(certificate, key))
