"""The gateway: serves the public display and other pages to browsers, and live data to programs (docs/web.md).

It offers calls through the door of the box (docs/door.md, "Calls of the web pages"): codes for devices, the list of
paired devices, the codes of teams. A box runs it in its own process (`WebParts` in `box/program/neighbours.py`).
"""

import asyncio
import concurrent.futures
import datetime
import logging
import pathlib
from typing import Any, Callable, Dict, Iterable, Mapping, NamedTuple, Set

from roah_rsbb.comm import sockets
from roah_rsbb.document.calls import PAIR, PAIRED, REVOKE, TEAM_CODES, Call, Caller, InThread
from roah_rsbb.ground.kept_file import open_kept
from roah_rsbb.ground.params import BadParams, Params
from roah_rsbb.model.actions import ORGANISER, ROLES
from roah_rsbb.model.fields import is_encodable
from roah_rsbb.model.reason import Refused, Template
from roah_rsbb.web.commands import BoxCommanded, PageCalls
from roah_rsbb.web.displays import FILE as DISPLAYS_FILE
from roah_rsbb.web.displays import Displays, read_logos
from roah_rsbb.web.limits import own_names
from roah_rsbb.web.pairing import CODE_VALID_S, Grant, Sessions
from roah_rsbb.web.pairing import FILE as SESSIONS_FILE
from roah_rsbb.web.public_documents import Store
from roah_rsbb.web.server import WebServer
from roah_rsbb.web.serving import LOOPBACK, hosts_of, retry_until_open
from roah_rsbb.web.teams import CODE, TEAM_PAGES, TeamCodes
from roah_rsbb.web.teams import FILE as CODES_FILE
from roah_rsbb.wording import language
from roah_rsbb.wording.device import CODES_NOT_SAVED, ENDED_NOT_SAVED
from roah_rsbb.wording.texts import did_you_mean

# A disk may take so long, and whoever calls hears of it.
DISK_S = 3.0
_HANGS = "the disk takes no data"
# Characters of a text. The longest name of a zone is shorter.
MAX_TEXT = 500

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
        calls: Dict[str, Call] = {
            PAIR: self._pair, PAIRED: self._paired, REVOKE: self._revoke, TEAM_CODES: self._team_codes}
        self._client = host.make_client(lambda: self._server.follow(), calls)
        languages = language.translations(sorted((host.resource / "languages").glob("*.ts")))
        store = Store(self._client, languages, title, logos=read_logos(logos, _log.warning))
        self._why: Set[str] = set()  # it was not connected; these were logged
        self._server = WebServer(loop, store, str(host.resource / "web"), own_names(host.names), sessions,
                                 PageCalls(self._client, host.name).carry_out,
                                 self._certificate and self._certificate.context, displays, team_codes, team_pages,
                                 calls, log_dir)

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

    # -- its calls: everything is done in the loop's thread, only disks are waited for in others ----------

    def _problem(self, role: str, zone: str) -> str:
        """Say why no code can be made; empty: one can."""
        zones = self._server.desk.zones()
        if role not in ROLES:
            return f"no role '{role}'{did_you_mean(role, ROLES)}: choose one of {', '.join(ROLES)}"
        if role == ORGANISER:
            return f"an organiser may act in all zones: leave out zone '{zone}'" if zone else ""
        if not zone:
            return f"a {role} needs a zone"
        if zones and zone not in zones:
            return f"no zone '{zone}'{did_you_mean(zone, zones)}"
        return ""

    def _pair(self, found: Mapping[str, Any], caller: Caller) -> Any:
        grant = Grant(_text(found, "role"), _text(found, "zone"))
        problem = self._problem(*grant)
        if problem or not self._url:
            raise Refused([problem or "the web pages are not served yet: their log names the remedy"])
        code = self._server.codes.make(self._server.now(), grant)
        return {"code": code.typed, "url": f"{self._url}pair#{code.link}", "valid": CODE_VALID_S}

    def _paired(self, found: Mapping[str, Any], caller: Caller) -> Any:
        connected = self._server.connected()
        return {"devices": [
            {"id": one.id, "role": one.grant.role, "zone": one.grant.zone, "person": one.person, "device": one.device,
             "paired": one.paired_utc, "seen": one.seen_utc, "connected": one.id in connected}
            for one in self._server.sessions.listed(self._server.utc())]}

    def _revoke(self, found: Mapping[str, Any], caller: Caller) -> Any:
        ended = self._server.revoke(_text(found, "device"))
        for one in ended:
            _log.info("Pairing ended: %s", one.who)

        def answer() -> Any:
            _wait(self._server.sessions.kept.newest, ENDED_NOT_SAVED)
            return {"revoked": len(ended)}

        return InThread(answer)

    def _team_codes(self, found: Mapping[str, Any], caller: Caller) -> Any:
        server, teams, renews = self._server, self._server.store.teams(), found.get("renew") is True
        kept = asyncio.run_coroutine_threadsafe(server.team_codes.keep(renews), self._loop)

        def answer() -> Any:
            _wait(kept, CODES_NOT_SAVED)
            if renews:
                _log.info("All teams have new codes")
            return {"team_pages": server.team_pages, "teams": teams,
                    "codes": [server.team_codes.code(team) for team in teams]}

        return InThread(answer)


def _certificate(certificate: str, key: str) -> Any:
    # It needs cryptography, which takes memory.
    from roah_rsbb.web.certificate import Certificate, CertificateFiles

    return Certificate(CertificateFiles(certificate, key))


def _wait(kept: "concurrent.futures.Future[None]", refusal: Template) -> None:
    """Wait in a thread until something is on the disk. Raises `Refused` if it is not: a text with the error."""
    try:
        kept.result(DISK_S)
    except concurrent.futures.TimeoutError:
        raise Refused([refusal(error=_HANGS)]) from None
    except OSError as error:
        raise Refused([refusal(error=str(error))]) from None


def _text(found: Mapping[str, Any], name: str) -> str:
    """Return a text in the arguments of a call; empty: it is not among them. Raises `Refused`."""
    value = found.get(name, "")
    if not isinstance(value, str) or len(value) > MAX_TEXT or not is_encodable(value):
        raise Refused([f"{name} is not a text of at most {MAX_TEXT} characters"])
    return value
