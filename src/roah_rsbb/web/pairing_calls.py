"""The calls of the gateway, which it offers through the door of the box (docs/door.md, "Calls of the web pages"): codes
for devices and the list of paired devices (docs/web.md, "Pairing"), and the codes of teams ("Pages of teams")."""

import asyncio
import concurrent.futures
import logging
from typing import Any, Callable, Dict, Mapping

from roah_rsbb.document.calls import PAIR, PAIRED, REVOKE, TEAM_CODES, Call, Caller, InThread
from roah_rsbb.model.fields import is_encodable
from roah_rsbb.model.reason import Refused
from roah_rsbb.web.pairing import CODE_VALID_S, ORGANISER, ROLES, Grant
from roah_rsbb.web.server import WebServer
from roah_rsbb.wording.device import CODES_NOT_SAVED
from roah_rsbb.wording.texts import did_you_mean

# A disk may take so long, and whoever calls hears of it.
DISK_S = 3.0
_HANGS = "the disk takes no data"
# Characters of a text. The longest name of a zone is shorter.
MAX_TEXT = 500

_log = logging.getLogger(__name__)


class PairingCalls:
    """Pairs devices, and gives teams their codes. Everything is done in the loop's thread; only disks are waited for in
    others."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, server: Callable[[], WebServer], url: Callable[[], str],
    ) -> None:
        """`server` is asked with each call; `url`: of the pages, for devices; empty: they are not served yet."""
        self._loop, self._find_server, self._url = loop, server, url

    @property
    def _server(self) -> WebServer:
        return self._find_server()

    def named(self) -> Dict[str, Call]:
        """Return all calls by their names."""
        return {PAIR: self._pair, PAIRED: self._paired, REVOKE: self._revoke, TEAM_CODES: self._team_codes}

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
        problem, url = self._problem(*grant), self._url()
        if problem or not url:
            raise Refused([problem or "the web pages are not served yet: their log names the remedy"])
        code = self._server.codes.make(self._server.now(), grant)
        return {"code": code.typed, "url": f"{url}pair#{code.link}", "valid": CODE_VALID_S}

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
            _wait(self._server.sessions.kept.newest, "ended, but not saved ({error}): it would be valid again after a "
                  "restart. Free or repair the disk of log_dir, and try again")
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


def _wait(kept: "concurrent.futures.Future[None]", refusal: str) -> None:
    """Wait in a thread until something is on the disk. Raises `Refused` if it is not: a text with the error."""
    try:
        kept.result(DISK_S)
    except concurrent.futures.TimeoutError:
        raise Refused([refusal.format(error=_HANGS)]) from None
    except OSError as error:
        raise Refused([refusal.format(error=error)]) from None


def _text(found: Mapping[str, Any], name: str) -> str:
    """Return a text in the arguments of a call; empty: it is not among them. Raises `Refused`."""
    value = found.get(name, "")
    if not isinstance(value, str) or len(value) > MAX_TEXT or not is_encodable(value):
        raise Refused([f"{name} is not a text of at most {MAX_TEXT} characters"])
    return value
